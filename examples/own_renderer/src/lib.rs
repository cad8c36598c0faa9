//! Somebody else's renderer: its own corners, its own passes, one sun. Of Umbrage it has `umbrage-core` alone: the fit of a
//! light's view, the view as shaders see it, and the text that looks the map up.
//!
//! Lines that are there for the shadow end with a mark, or stand in `shadow.rs`; a test counts them. The pass that draws depth
//! (`pass.rs`) is the renderer's own.

mod pass;
mod scene;
mod shadow; // shadow

use glam::camera::rh::proj::directx;
use glam::camera::rh::view::look_at_mat4;
use glam::{Mat4, Vec3, Vec4};
use pass::DepthPass;
use std::error::Error;
use umbrage_core::layout::GpuView; // shadow
use umbrage_core::{Aabb, Light, LightKind}; // shadow
use wgpu::util::DeviceExt;

/// A device to draw with.
#[derive(Debug)]
pub struct Gpu {
    /// The adapter's name.
    pub name: String,
    device: wgpu::Device,
    queue: wgpu::Queue,
}

/// The first adapter whose name contains `name`, letters' case aside, with default limits and no optional feature. `None`: the
/// one that wgpu prefers.
///
/// # Errors
/// Says that there is none.
pub fn open(name: Option<&str>) -> Result<Gpu, Box<dyn Error>> {
    let backends = wgpu::Backends::PRIMARY;
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends,
        // Validation layers are for whoever debugs wgpu itself.
        flags: wgpu::InstanceFlags::empty(),
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    let adapter = match name {
        None => pollster::block_on(instance.request_adapter(&Default::default()))
            .map_err(|e| format!("no graphics adapter: {e}; `umbrage doctor` says what to install"))?,
        Some(name) => pollster::block_on(instance.enumerate_adapters(backends))
            .into_iter()
            .find(|adapter| adapter.get_info().name.to_lowercase().contains(&name.to_lowercase()))
            .ok_or_else(|| format!("no graphics adapter's name contains `{name}`"))?,
    };
    let (device, queue) = pollster::block_on(adapter.request_device(&Default::default()))?;
    Ok(Gpu { name: adapter.get_info().name, device, queue })
}

/// What both passes know; mirrors `Frame` of `forward.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Frame {
    clip_from_world: Mat4,
    map_from_world: Mat4,
    to_sun: Vec4,
    shadow: GpuView, // shadow
}

/// A picture of the scene: rows of RGBA, top first. Without `casters` the map stays empty, so that nothing has a shadow.
///
/// # Errors
/// The device's own words.
pub fn draw(gpu: &Gpu, width: u32, height: u32, casters: bool) -> Result<Vec<u8>, Box<dyn Error>> {
    let Gpu { device, queue, .. } = gpu;
    let triangles = scene::triangles();
    let to_sun = Vec3::new(-0.55, 1.0, 0.45).normalize();
    let sun = Light { kind: LightKind::Directional, ..Light::default() }.aimed(to_sun, Vec3::ZERO); // shadow
    let bounds = Aabb::from_points(triangles.iter().map(|v| Vec3::from(v.p_world))); // shadow
    let shadow = shadow::plan_shadow(&sun, &[bounds])?; // shadow

    // This renderer's depth runs forwards. That the map's does not is no concern of its own passes.
    let clip_from_view = directx::perspective(0.7, width as f32 / height as f32, 0.1, 50.0);
    let frame = Frame {
        clip_from_world: clip_from_view * look_at_mat4(Vec3::new(3.5, 4.8, 8.0), Vec3::Y * 0.5, Vec3::Y),
        map_from_world: shadow.fitted.clip_from_world(), // shadow
        to_sun: to_sun.extend(0.0),
        shadow: shadow.view, // shadow
    };
    let buffer = |contents: &[u8], usage| {
        device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
    };
    let corners = buffer(bytemuck::cast_slice(&triangles), wgpu::BufferUsages::VERTEX);
    let frame = buffer(bytemuck::bytes_of(&frame), wgpu::BufferUsages::UNIFORM);
    let text = [shadow.wgsl.as_str(), include_str!("forward.wgsl")].join("\n"); // shadow
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("forward"),
        source: wgpu::ShaderSource::Wgsl(text.into()),
    });
    let depth_pass = DepthPass::new(device, &module, &shadow); // shadow
    let forward = forward_pipeline(device, &module);
    let point = device.create_sampler(&Default::default()); // shadow
    let map_group = bind(device, &depth_pass.pipeline, &[frame.as_entire_binding()]);
    let resources = [
        frame.as_entire_binding(),
        wgpu::BindingResource::TextureView(&depth_pass.map), // shadow
        wgpu::BindingResource::Sampler(&point),              // shadow
    ];
    let forward_group = bind(device, &forward, &resources);

    let count = triangles.len() as u32;
    let picture = target(device, width, height, COLOR, wgpu::TextureUsages::COPY_SRC);
    let depth = target(device, width, height, DEPTH_FORMAT, wgpu::TextureUsages::empty());
    let mut encoder = device.create_command_encoder(&Default::default());
    depth_pass.record(&mut encoder, &shadow, &map_group, casters.then_some((&corners, count))); // shadow
    record_forward(&mut encoder, &picture, &depth, &forward, |pass| {
        pass.set_bind_group(0, &forward_group, &[]);
        pass.set_vertex_buffer(0, corners.slice(..));
        pass.draw(0..count, 0..1);
    });
    read(device, queue, encoder, &picture)
}

/// Group 0 of a pipeline, bindings in order.
fn bind<'a>(
    device: &wgpu::Device,
    pipeline: &wgpu::RenderPipeline,
    resources: &[wgpu::BindingResource<'a>],
) -> wgpu::BindGroup {
    let entry = |(binding, resource): (u32, &wgpu::BindingResource<'a>)| wgpu::BindGroupEntry {
        binding,
        resource: resource.clone(),
    };
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &(0..).zip(resources).map(entry).collect::<Vec<_>>(),
    })
}

const COLOR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;
const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth24Plus;

fn target(
    device: &wgpu::Device,
    width: u32,
    height: u32,
    format: wgpu::TextureFormat,
    usage: wgpu::TextureUsages,
) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: usage | wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    })
}

fn forward_pipeline(device: &wgpu::Device, module: &wgpu::ShaderModule) -> wgpu::RenderPipeline {
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("forward"),
        layout: None,
        vertex: wgpu::VertexState {
            module,
            entry_point: Some("vs_forward"),
            compilation_options: Default::default(),
            buffers: &[Some(scene::LAYOUT)],
        },
        primitive: Default::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Less),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some("fs_forward"),
            compilation_options: Default::default(),
            targets: &[Some(COLOR.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}

fn record_forward(
    encoder: &mut wgpu::CommandEncoder,
    picture: &wgpu::Texture,
    depth: &wgpu::Texture,
    pipeline: &wgpu::RenderPipeline,
    draw: impl FnOnce(&mut wgpu::RenderPass<'_>),
) {
    let sky = wgpu::Color { r: 0.30, g: 0.45, b: 0.65, a: 1.0 };
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("forward"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: &picture.create_view(&Default::default()),
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(sky), store: wgpu::StoreOp::Store },
        })],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &depth.create_view(&Default::default()),
            depth_ops: Some(wgpu::Operations {
                load: wgpu::LoadOp::Clear(1.0),
                store: wgpu::StoreOp::Discard,
            }),
            stencil_ops: None,
        }),
        ..Default::default()
    });
    pass.set_pipeline(pipeline);
    draw(&mut pass);
}

/// Submits, waits, and copies the picture's rows without padding.
fn read(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    mut encoder: wgpu::CommandEncoder,
    picture: &wgpu::Texture,
) -> Result<Vec<u8>, Box<dyn Error>> {
    let row = 4 * picture.width();
    let padded = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("read-back"),
        size: u64::from(padded) * u64::from(picture.height()),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(padded), rows_per_image: None };
    let to = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
    encoder.copy_texture_to_buffer(picture.as_image_copy(), to, picture.size());
    queue.submit([encoder.finish()]);
    let (said, answer) = std::sync::mpsc::channel();
    buffer.map_async(wgpu::MapMode::Read, .., move |result| {
        // Nobody listens only where waiting failed, which is said already.
        let _ = said.send(result);
    });
    device.poll(wgpu::PollType::wait_indefinitely())?;
    answer.recv()??;
    let bytes = buffer.get_mapped_range(..)?;
    Ok(bytes.chunks_exact(padded as usize).flat_map(|padded| &padded[..row as usize]).copied().collect())
}
