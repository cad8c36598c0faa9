//! From the GPU to memory.

use crate::RenderError;
use crate::gpu::Gpu;

/// Waits until the GPU has done all that was submitted.
///
/// # Errors
/// [`RenderError::Gpu`] when the device is lost or reported an error.
pub fn wait(gpu: &Gpu) -> Result<(), RenderError> {
    wait_for(gpu, None)
}

/// Waits until the GPU has done one submission, whatever others are under way.
///
/// # Errors
/// As [`wait`].
pub fn wait_for(gpu: &Gpu, submission_index: Option<wgpu::SubmissionIndex>) -> Result<(), RenderError> {
    let waited = gpu.device.poll(wgpu::PollType::Wait { submission_index, timeout: None });
    gpu.check()?;
    waited.map(|_| ()).map_err(|e| RenderError::Gpu(e.to_string()))
}

/// The bytes of a buffer that can be mapped.
///
/// # Errors
/// [`RenderError::Gpu`] with the device's words.
pub fn map(gpu: &Gpu, buffer: &wgpu::Buffer) -> Result<Vec<u8>, RenderError> {
    let failed = std::sync::Arc::new(std::sync::Mutex::new(None));
    let sink = std::sync::Arc::clone(&failed);
    buffer.map_async(wgpu::MapMode::Read, .., move |result| {
        if let (Err(error), Ok(mut failed)) = (result, sink.lock()) {
            *failed = Some(error.to_string());
        }
    });
    wait(gpu)?;
    if let Some(error) = failed.lock().ok().and_then(|mut failed| failed.take()) {
        return Err(RenderError::Gpu(error));
    }
    let bytes = buffer.get_mapped_range(..).map_err(|e| RenderError::Gpu(e.to_string()))?.to_vec();
    buffer.unmap();
    Ok(bytes)
}

/// The bytes of a buffer that can be copied.
///
/// # Errors
/// [`RenderError::Gpu`] with the device's words.
pub fn buffer(gpu: &Gpu, source: &wgpu::Buffer) -> Result<Vec<u8>, RenderError> {
    let read = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("read back"),
        size: source.size(),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(source, 0, &read, 0, source.size());
    gpu.queue.submit([encoder.finish()]);
    map(gpu, &read)
}

/// The rows of a texture, without padding.
///
/// # Errors
/// [`RenderError::Gpu`] with the device's words.
pub fn texture(gpu: &Gpu, texture: &wgpu::Texture) -> Result<Vec<u8>, RenderError> {
    layer(gpu, texture, 0)
}

/// The rows of one layer of a texture, without padding.
///
/// # Errors
/// [`RenderError::Gpu`] with the device's words.
pub fn layer(gpu: &Gpu, texture: &wgpu::Texture, layer: u32) -> Result<Vec<u8>, RenderError> {
    let (width, height) = (texture.width(), texture.height());
    let format = texture.format();
    let aspect =
        if format.has_depth_aspect() { wgpu::TextureAspect::DepthOnly } else { wgpu::TextureAspect::All };
    let row = format.block_copy_size(Some(aspect)).unwrap_or(4) * width;
    let padded = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("read-back"),
        size: u64::from(padded) * u64::from(height),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    encoder.copy_texture_to_buffer(
        wgpu::TexelCopyTextureInfo {
            texture,
            mip_level: 0,
            origin: wgpu::Origin3d { x: 0, y: 0, z: layer },
            aspect,
        },
        wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(padded),
                rows_per_image: None,
            },
        },
        wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
    );
    gpu.queue.submit([encoder.finish()]);
    let bytes = map(gpu, &buffer)?;
    Ok(bytes.chunks_exact(padded as usize).flat_map(|padded| &padded[..row as usize]).copied().collect())
}
