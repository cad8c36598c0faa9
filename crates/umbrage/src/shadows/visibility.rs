//! V of every light for every pixel, found from the caller's depth: for renderers that light later and add nothing to their shaders.

use super::handles::index;
use super::{Frame, Shadows, ShadowsError, depth};
use crate::layers::Layers;
use bytemuck::{Pod, Zeroable};
use glam::Mat4;
use std::num::NonZeroU64;

/// Mirrors `Seen` of `wgsl/visibility.wgsl`; see there for what each field means.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
struct GpuSeen {
    world_from_clip: Mat4,
    clear_depth: f32,
    pad: [f32; 3],
}

/// What finds it.
#[derive(Debug)]
pub(super) struct Visibility {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    seen: wgpu::Buffer,
    written: Option<GpuSeen>,
    /// For the depth that it was made for.
    group: Option<(wgpu::TextureView, wgpu::BindGroup)>,
    layers: Option<(Layers, [u32; 2])>,
}

/// 8 bits a light and pixel, or three times as many where light is coloured.
fn format(colored: bool) -> wgpu::TextureFormat {
    if colored { wgpu::TextureFormat::Rgba8Unorm } else { wgpu::TextureFormat::R8Unorm }
}

impl Visibility {
    fn new(device: &wgpu::Device, text: String, shadows: &wgpu::BindGroupLayout, colored: bool) -> Self {
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("umbrage visibility"),
            source: wgpu::ShaderSource::Wgsl(text.into()),
        });
        let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty,
            count: None,
        };
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("umbrage visibility"),
            entries: &[
                entry(
                    0,
                    wgpu::BindingType::Buffer {
                        ty: wgpu::BufferBindingType::Uniform,
                        has_dynamic_offset: false,
                        min_binding_size: NonZeroU64::new(size_of::<GpuSeen>() as u64),
                    },
                ),
                entry(
                    1,
                    wgpu::BindingType::Texture {
                        sample_type: wgpu::TextureSampleType::Depth,
                        view_dimension: wgpu::TextureViewDimension::D2,
                        multisampled: false,
                    },
                ),
            ],
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("umbrage visibility"),
            bind_group_layouts: &[Some(&layout), Some(shadows)],
            immediate_size: 0,
        });
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("umbrage visibility"),
            layout: Some(&pipeline_layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vs_screen"),
                compilation_options: Default::default(),
                buffers: &[],
            },
            primitive: Default::default(),
            depth_stencil: None,
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("fs_visibility"),
                compilation_options: Default::default(),
                targets: &[Some(format(colored).into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        let seen = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("umbrage visibility"),
            size: size_of::<GpuSeen>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        Self { pipeline, layout, seen, written: None, group: None, layers: None }
    }

    /// Memory, bytes.
    pub fn memory_bytes(&self) -> u64 {
        self.layers.as_ref().map_or(0, |(layers, _)| layers.memory_bytes())
    }

    /// Takes a depth to read, and makes room for V; no cost while both stay as they are.
    fn take(
        &mut self,
        (device, queue): (&wgpu::Device, &wgpu::Queue),
        frame: &Frame,
        view: &wgpu::TextureView,
        lights: u32,
        colored: bool,
    ) -> Result<(), ShadowsError> {
        if self.group.as_ref().is_none_or(|(known, _)| known != view) {
            depth::check(device, view, frame.size_px.to_array(), true)?;
            let read = depth::readable(view);
            let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("umbrage visibility"),
                layout: &self.layout,
                entries: &[
                    wgpu::BindGroupEntry { binding: 0, resource: self.seen.as_entire_binding() },
                    wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(&read) },
                ],
            });
            self.group = Some((view.clone(), group));
        }
        let size_px = frame.size_px.to_array();
        let has = self.layers.as_ref().filter(|(_, size)| *size == size_px).map_or(0, |(v, _)| v.count());
        if has < lights.max(1) {
            let made = Layers::new(device, "umbrage visibility", size_px, lights.max(1), format(colored));
            self.layers = Some((made, size_px));
        }
        let seen = GpuSeen {
            world_from_clip: frame.clip_from_world().as_dmat4().inverse().as_mat4(),
            clear_depth: frame.depth.clear(),
            pad: [0.0; 3],
        };
        if self.written != Some(seen) {
            queue.write_buffer(&self.seen, 0, bytemuck::bytes_of(&seen));
            self.written = Some(seen);
        }
        Ok(())
    }
}

impl Shadows {
    /// Records a pass for each light that writes its V for every pixel of `depth`, the picture's, of any depth format with
    /// `TEXTURE_BINDING` and one sample: after [`Shadows::record_screen`] where techniques need that. V is then in layer
    /// [`Shadows::light_index`] of [`Shadows::visibility`]: red, or red, green and blue where a technique colours light; 1 where the
    /// depth shows nothing. Surfaces' normals are found from neighbouring pixels. Masks do not know whose surface they darken here.
    ///
    /// Cost: a triangle over the picture for each light, with the lookups of its technique.
    ///
    /// # Errors
    /// [`ShadowsError::NotPrepared`]; [`ShadowsError::Buffer`], [`ShadowsError::DepthSize`] and [`ShadowsError::ForeignDevice`] for a
    /// depth that cannot be used.
    pub fn record_visibility(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        depth: &wgpu::TextureView,
    ) -> Result<(), ShadowsError> {
        let Some(frame) = self.frame.filter(|_| self.is_prepared) else {
            return Err(ShadowsError::NotPrepared { call: "record_visibility" });
        };
        let colored = self.declared.pools.iter().any(|pool| pool.colored);
        let mut found = self.visibility.take().unwrap_or_else(|| {
            let text = [self.wgsl(1).as_str(), include_str!("../../wgsl/visibility.wgsl")].join("\n");
            Visibility::new(&self.device, text, &self.layout, colored)
        });
        let lights = self.lights.iter().map(|(key, _)| index(key) as u32 + 1).max().unwrap_or(0);
        let taken = found.take((&self.device, &self.queue), &frame, depth, lights, colored);
        let found = self.visibility.insert(found);
        taken?;
        let (Some((_, group)), Some((layers, _))) = (&found.group, &found.layers) else { return Ok(()) };
        for (key, _) in self.lights.iter() {
            let number = index(key) as u32;
            let Some(view) = layers.layer(number) else { continue };
            let mut recorded = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("visibility"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view,
                    depth_slice: None,
                    resolve_target: None,
                    // Every pixel is written.
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(wgpu::Color::WHITE),
                        store: wgpu::StoreOp::Store,
                    },
                })],
                ..Default::default()
            });
            recorded.set_pipeline(&found.pipeline);
            recorded.set_bind_group(0, group, &[]);
            recorded.set_bind_group(1, &self.group, &[]);
            recorded.draw(0..3, number..number + 1);
        }
        Ok(())
    }

    /// V of all lights as the last [`Shadows::record_visibility`] wrote it, a `texture_2d_array<f32>`; `None` before the first.
    /// Another one after the frame's size or the number of lights grew.
    pub fn visibility(&self) -> Option<&wgpu::TextureView> {
        self.visibility.as_ref()?.layers.as_ref().map(|(layers, _)| layers.array())
    }
}
