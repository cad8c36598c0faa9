//! What all pipelines of a frame read: camera, lights, the matrices of the lookup, maps, slides.

use crate::RenderOptions;
use crate::gpu::Gpu;
use crate::layout::{GpuFrame, GpuLight, MAX_LIGHTS};
use crate::maps::MapSet;
use crate::pipelines::Layouts;
use bytemuck::Zeroable;
use umbrage::ShadowMaps;
use umbrage_scene::Image;

/// Group 0 of mesh and screen pipelines, all but the maps.
#[derive(Debug)]
pub struct FrameBindings {
    layouts: Layouts,
    frame: wgpu::Buffer,
    lights: wgpu::Buffer,
    stand_in: wgpu::TextureView,
    compare: wgpu::Sampler,
    point: wgpu::Sampler,
    slides: wgpu::TextureView,
    slide_sampler: wgpu::Sampler,
    given: wgpu::TextureView,
    /// List, masks and sampler, where masks are looked up.
    masks: Option<(wgpu::Buffer, wgpu::TextureView, wgpu::Sampler)>,
}

impl FrameBindings {
    /// Makes buffers and samplers; uploads slides and what is given. `screen_v` is V that is found on the screen,
    /// `masks` what is looked up inline.
    pub fn new(
        gpu: &Gpu,
        layouts: Layouts,
        options: &RenderOptions,
        slide_images: &[&Image],
        screen_v: Option<wgpu::TextureView>,
        masks: Option<(wgpu::Buffer, wgpu::TextureView, wgpu::Sampler)>,
    ) -> Self {
        let uniform = |label, bytes: usize| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: bytes as u64,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let slide_sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("slide"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        let is_color = layouts.color_maps;
        // A binding cannot be empty: without maps one texel stands in, and no light refers to it.
        let stand_in = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("no maps"),
            size: wgpu::Extent3d { width: 1, height: 1, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: if is_color { wgpu::TextureFormat::R32Float } else { wgpu::TextureFormat::Depth32Float },
            usage: wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        Self {
            frame: uniform("frame", size_of::<GpuFrame>()),
            lights: uniform("lights", size_of::<GpuLight>() * MAX_LIGHTS),
            stand_in: stand_in.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2Array),
                ..Default::default()
            }),
            compare: umbrage::maps::comparison_sampler(&gpu.device),
            point: umbrage::maps::point_sampler(&gpu.device),
            slides: crate::textures::slides(&gpu.device, &gpu.queue, slide_images),
            slide_sampler,
            given: screen_v.unwrap_or_else(|| crate::textures::given(&gpu.device, &gpu.queue, options)),
            masks,
            layouts,
        }
    }

    /// Camera and lights, from the next submission on.
    pub fn write(&self, queue: &wgpu::Queue, frame: &GpuFrame, lights: &[GpuLight]) {
        let mut all = [GpuLight::zeroed(); MAX_LIGHTS];
        all[..lights.len()].copy_from_slice(lights);
        queue.write_buffer(&self.frame, 0, bytemuck::bytes_of(frame));
        queue.write_buffer(&self.lights, 0, bytemuck::cast_slice(&all));
    }

    /// The group, over a set of maps and the matrices that they were drawn with.
    pub fn group(&self, device: &wgpu::Device, set: &MapSet) -> wgpu::BindGroup {
        let maps = set.maps().map_or(&self.stand_in, ShadowMaps::array);
        let nearest = set.translucent().map_or(&self.stand_in, |t| t.nearest().array());
        // Any texture of colours stands in where light has none.
        let colors = set.translucent().map_or(&self.slides, |t| t.colors());
        let entries = [
            self.frame.as_entire_binding(),
            self.lights.as_entire_binding(),
            set.views.buffer.as_entire_binding(),
            wgpu::BindingResource::TextureView(maps),
            wgpu::BindingResource::Sampler(&self.compare),
            wgpu::BindingResource::TextureView(&self.slides),
            wgpu::BindingResource::Sampler(&self.slide_sampler),
            wgpu::BindingResource::TextureView(&self.given),
            wgpu::BindingResource::Sampler(&self.point),
            wgpu::BindingResource::TextureView(nearest),
            wgpu::BindingResource::TextureView(colors),
        ];
        let masks = self.masks.iter().flat_map(|(list, masks, sampler)| {
            [
                list.as_entire_binding(),
                wgpu::BindingResource::TextureView(masks),
                wgpu::BindingResource::Sampler(sampler),
            ]
        });
        let entries: Vec<_> = (0u32..)
            .zip(entries.into_iter().chain(masks))
            .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
            .collect();
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("frame"),
            layout: &self.layouts.frame,
            entries: &entries,
        })
    }
}
