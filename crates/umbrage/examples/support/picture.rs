//! Pictures without a window.

use super::{Example, Gpu, Result, Target};

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

/// Draws an example at these times, one after the other: the last picture, rows of RGBA, top first, and the example's report.
pub fn picture<E: Example>(
    gpu: &Gpu,
    size_px: [u32; 2],
    plain: bool,
    times_s: &[f32],
) -> Result<(Vec<u8>, String)> {
    let mut example = E::new(gpu, FORMAT, plain)?;
    let texture = gpu.texture(size_px, FORMAT, wgpu::TextureUsages::COPY_SRC);
    let view = texture.create_view(&Default::default());
    for time_s in times_s {
        example.draw(gpu, &Target { view: &view, size_px }, *time_s)?;
        gpu.check()?;
    }
    let rgba = read(gpu, &texture)?;
    gpu.check()?;
    Ok((rgba, example.report()))
}

/// Waits, and copies the texture's rows without padding.
fn read(gpu: &Gpu, texture: &wgpu::Texture) -> Result<Vec<u8>> {
    let row = 4 * texture.width();
    let padded = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("read-back"),
        size: u64::from(padded) * u64::from(texture.height()),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(padded), rows_per_image: None };
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let to = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
    encoder.copy_texture_to_buffer(texture.as_image_copy(), to, texture.size());
    gpu.queue.submit([encoder.finish()]);
    let (said, answer) = std::sync::mpsc::channel();
    buffer.map_async(wgpu::MapMode::Read, .., move |result| {
        // Nobody listens only where waiting failed, which is said already.
        let _ = said.send(result);
    });
    gpu.device.poll(wgpu::PollType::wait_indefinitely())?;
    answer.recv()??;
    let bytes = buffer.get_mapped_range(..)?;
    Ok(bytes.chunks_exact(padded as usize).flat_map(|padded| &padded[..row as usize]).copied().collect())
}
