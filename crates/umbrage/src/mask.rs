//! Projective masks: a texture for each light and blocker, drawn in one colour, and the passes that take it away from receivers.
//! Where to look is [`umbrage_core::fit::fit_mask`]; how to look it up inline is the WGSL module `mask`.

use crate::ShadowError;
use crate::caster::{CasterStreams, CasterVertices, GpuCasterView, caster_shader, unclipped};
use crate::layers::Layers;
use glam::{Mat4, Vec4};
use std::num::NonZeroU64;
use umbrage_core::layout_mask::GpuMask;
use umbrage_core::wgsl::assemble;

/// 1 where the blocker covers.
pub const MASK_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R8Unorm;

/// Masks of equal size, a layer for each light and blocker.
#[derive(Debug)]
pub struct MaskMaps {
    layers: Layers,
}

impl MaskMaps {
    /// Makes `layers` masks, one at least. Memory: a byte a texel.
    ///
    /// # Errors
    /// [`ShadowError::TooLarge`] names the device's limits.
    pub fn new(device: &wgpu::Device, size_texel: u32, layers: u32) -> Result<Self, ShadowError> {
        let limits = device.limits();
        let (limit, layer_limit) = (limits.max_texture_dimension_2d, limits.max_texture_array_layers);
        let layers = layers.max(1);
        if size_texel == 0 || size_texel > limit || layers > layer_limit {
            return Err(ShadowError::TooLarge { size_texel, layers, limit, layer_limit });
        }
        let size = [size_texel, size_texel];
        Ok(Self { layers: Layers::new(device, "umbrage masks", size, layers, MASK_FORMAT) })
    }

    /// All masks, as shaders read them.
    pub fn array(&self) -> &wgpu::TextureView {
        self.layers.array()
    }

    /// Memory, bytes.
    pub fn memory_bytes(&self) -> u64 {
        self.layers.memory_bytes()
    }
}

/// Looks masks up: blended between texels, or the nearest.
pub fn mask_sampler(device: &wgpu::Device, linear: bool) -> wgpu::Sampler {
    let filter = if linear { wgpu::FilterMode::Linear } else { wgpu::FilterMode::Nearest };
    device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("umbrage mask"),
        mag_filter: filter,
        min_filter: filter,
        ..Default::default()
    })
}

/// Pipelines that draw blockers: without depth, light or clipping in depth.
#[derive(Debug)]
pub struct MaskPipelines {
    /// Vertex streams as in [`CasterStreams`], the first two.
    pub solid: wgpu::RenderPipeline,
    /// All three, and group 1 as in [`crate::CasterPipelines::cut_out_layout`].
    pub cut_out: wgpu::RenderPipeline,
    /// Group 0: a [`GpuCasterView`], a uniform buffer with a dynamic offset.
    pub view_layout: wgpu::BindGroupLayout,
}

fn uniform(
    binding: u32,
    dynamic: bool,
    bytes: usize,
    visibility: wgpu::ShaderStages,
) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility,
        ty: wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset: dynamic,
            min_binding_size: NonZeroU64::new(bytes as u64),
        },
        count: None,
    }
}

fn module(device: &wgpu::Device, label: &str, text: String) -> wgpu::ShaderModule {
    device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(label),
        source: wgpu::ShaderSource::Wgsl(text.into()),
    })
}

fn mask_shader(deform: &str) -> String {
    [&caster_shader(deform), include_str!("../wgsl/mask_caster.wgsl")].join("\n")
}

fn receiver_shader(deform: &str) -> String {
    let library = assemble(&["mask"]).unwrap_or_else(|e| format!("// {e}\n"));
    [&library, deform, include_str!("../wgsl/mask_receiver.wgsl")].join("\n")
}

impl GpuCasterView {
    /// What a mask is drawn with.
    pub fn of_mask(clip_from_world: Mat4, time_s: f32) -> Self {
        Self { clip_from_world, time_s, ..bytemuck::Zeroable::zeroed() }
    }
}

impl MaskPipelines {
    /// Makes them. `cut_out_layout` is [`crate::CasterPipelines::cut_out_layout`].
    pub fn new(
        device: &wgpu::Device,
        cut_out_layout: &wgpu::BindGroupLayout,
        vertices: &CasterVertices<'_>,
    ) -> Self {
        let shader = module(device, "umbrage mask", mask_shader(vertices.deform));
        let attribute = vertices.attribute();
        let visibility = wgpu::ShaderStages::VERTEX_FRAGMENT;
        let view_layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("umbrage mask view"),
            entries: &[uniform(0, true, size_of::<GpuCasterView>(), visibility)],
        });
        let pipeline = |groups: &[Option<&wgpu::BindGroupLayout>], cut_out: bool| {
            let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some("umbrage mask"),
                bind_group_layouts: groups,
                immediate_size: 0,
            });
            let buffers = [
                Some(vertices.positions(&attribute)),
                Some(CasterStreams::INSTANCES),
                Some(CasterStreams::UV_ALPHA),
            ];
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some("umbrage mask"),
                layout: Some(&layout),
                vertex: wgpu::VertexState {
                    module: &shader,
                    entry_point: Some(if cut_out { "vs_cut_out" } else { "vs_solid" }),
                    compilation_options: Default::default(),
                    buffers: if cut_out { &buffers } else { &buffers[..2] },
                },
                primitive: wgpu::PrimitiveState { unclipped_depth: unclipped(device), ..Default::default() },
                depth_stencil: None,
                multisample: Default::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &shader,
                    entry_point: Some(if cut_out { "fs_mask_cut_out" } else { "fs_mask" }),
                    compilation_options: Default::default(),
                    targets: &[Some(MASK_FORMAT.into())],
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        Self {
            solid: pipeline(&[Some(&view_layout)], false),
            cut_out: pipeline(&[Some(&view_layout), Some(cut_out_layout)], true),
            view_layout,
        }
    }
}

/// Records the pass that draws one mask: empties it, then lets `draw` draw its blocker.
pub fn record_mask_pass(
    encoder: &mut wgpu::CommandEncoder,
    masks: &MaskMaps,
    layer: u32,
    timestamps: Option<wgpu::RenderPassTimestampWrites<'_>>,
    draw: impl FnOnce(&mut wgpu::RenderPass<'_>),
) {
    let Some(view) = masks.layers.layer(layer) else { return };
    let mut recorded = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("mask"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                store: wgpu::StoreOp::Store,
            },
        })],
        depth_stencil_attachment: None,
        timestamp_writes: timestamps,
        occlusion_query_set: None,
        multiview_mask: None,
    });
    draw(&mut recorded);
}

/// Mirrors `Receiving` of `wgsl/mask_receiver.wgsl`; see there for what each field means.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct GpuReceiving {
    /// World to clip space of the picture.
    pub clip_from_world: Mat4,
    /// Place and 1, or the direction towards it and 0.
    pub eye: Vec4,
    /// The same of the light.
    pub light: Vec4,
    /// What deforming receivers know of time, seconds.
    pub time_s: f32,
    /// Nothing.
    pub pad: [f32; 3],
}

/// What of a mask's shadow is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shadowed {
    /// Where it takes all of the light; the stencil is marked.
    Core,
    /// Where it takes a part, and the stencil is not marked.
    Fringe,
}

/// Pipelines that draw receivers over V once more for each mask.
#[derive(Debug)]
pub struct SubtractPipelines {
    core: wgpu::RenderPipeline,
    fringe: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
}

impl SubtractPipelines {
    /// Bytes from one mask to the next in the buffer of [`Self::group`]: every device allows dynamic offsets of this many.
    pub const STRIDE: u32 = 256;

    /// For V of `v_format` and a depth with a stencil of `format`. Vertices are deformed as they were where the surfaces were drawn.
    pub fn new(
        device: &wgpu::Device,
        format: wgpu::TextureFormat,
        v_format: wgpu::TextureFormat,
        vertices: &CasterVertices<'_>,
    ) -> Self {
        let shader = module(device, "umbrage receivers", receiver_shader(vertices.deform));
        let attribute = vertices.attribute();
        let both = wgpu::ShaderStages::VERTEX_FRAGMENT;
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("umbrage receivers"),
            entries: &[
                uniform(0, false, size_of::<GpuReceiving>(), both),
                uniform(1, true, size_of::<GpuMask>(), both),
                wgpu::BindGroupLayoutEntry {
                    binding: 2,
                    visibility: wgpu::ShaderStages::FRAGMENT,
                    ty: wgpu::BindingType::Texture {
                        sample_type: wgpu::TextureSampleType::Float { filterable: true },
                        view_dimension: wgpu::TextureViewDimension::D2Array,
                        multisampled: false,
                    },
                    count: None,
                },
                wgpu::BindGroupLayoutEntry {
                    binding: 3,
                    visibility: wgpu::ShaderStages::FRAGMENT,
                    ty: wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
                    count: None,
                },
            ],
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("umbrage receivers"),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = |shadowed: Shadowed| {
            let is_core = shadowed == Shadowed::Core;
            let mark =
                if is_core { wgpu::StencilOperation::IncrementClamp } else { wgpu::StencilOperation::Keep };
            let once = wgpu::StencilFaceState {
                compare: wgpu::CompareFunction::Equal,
                pass_op: mark,
                ..Default::default()
            };
            let component = |operation, src_factor| wgpu::BlendComponent {
                src_factor,
                dst_factor: wgpu::BlendFactor::One,
                operation,
            };
            // V less what is taken; of fringes the darkest.
            let color = if is_core {
                component(wgpu::BlendOperation::ReverseSubtract, wgpu::BlendFactor::One)
            } else {
                component(wgpu::BlendOperation::Min, wgpu::BlendFactor::One)
            };
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some("umbrage receivers"),
                layout: Some(&pipeline_layout),
                vertex: wgpu::VertexState {
                    module: &shader,
                    entry_point: Some("vs_receiver"),
                    compilation_options: Default::default(),
                    buffers: &[Some(vertices.positions(&attribute)), Some(CasterStreams::INSTANCES)],
                },
                primitive: Default::default(),
                depth_stencil: Some(wgpu::DepthStencilState {
                    format,
                    depth_write_enabled: Some(false),
                    // Drawn a second time, a surface lies exactly where it lay. What lies before it is not there: a hole that
                    // a texture cuts, or a face that is not drawn from behind.
                    depth_compare: Some(wgpu::CompareFunction::Equal),
                    stencil: wgpu::StencilState {
                        front: once,
                        back: once,
                        read_mask: 0xff,
                        write_mask: 0xff,
                    },
                    bias: wgpu::DepthBiasState::default(),
                }),
                multisample: Default::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &shader,
                    entry_point: Some(if is_core { "fs_core" } else { "fs_fringe" }),
                    compilation_options: Default::default(),
                    targets: &[Some(wgpu::ColorTargetState {
                        format: v_format,
                        blend: Some(wgpu::BlendState { color, alpha: color }),
                        write_mask: wgpu::ColorWrites::ALL,
                    })],
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        Self { core: pipeline(Shadowed::Core), fringe: pipeline(Shadowed::Fringe), layout }
    }

    /// Group 0: `receiving` holds a [`GpuReceiving`], `list` [`GpuMask`]s [`Self::STRIDE`] bytes apart; a dynamic offset picks one.
    pub fn group(
        &self,
        device: &wgpu::Device,
        receiving: &wgpu::Buffer,
        list: &wgpu::Buffer,
        masks: &MaskMaps,
        sampler: &wgpu::Sampler,
    ) -> wgpu::BindGroup {
        let mask = wgpu::BufferBinding {
            buffer: list,
            offset: 0,
            size: NonZeroU64::new(size_of::<GpuMask>() as u64),
        };
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("umbrage receivers"),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: receiving.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Buffer(mask) },
                wgpu::BindGroupEntry {
                    binding: 2,
                    resource: wgpu::BindingResource::TextureView(masks.array()),
                },
                wgpu::BindGroupEntry { binding: 3, resource: wgpu::BindingResource::Sampler(sampler) },
            ],
        })
    }

    /// The pipeline that draws it. Vertex streams as in [`CasterStreams`], the first two.
    pub fn of(&self, shadowed: Shadowed) -> &wgpu::RenderPipeline {
        match shadowed {
            Shadowed::Core => &self.core,
            Shadowed::Fringe => &self.fringe,
        }
    }
}

/// Records the pass that makes V of one light: all lit, then `draw` draws receivers for each mask, first all cores, then all
/// fringes. Its stencil is cleared; depth is kept.
pub fn record_subtract(
    encoder: &mut wgpu::CommandEncoder,
    depth_stencil: &wgpu::TextureView,
    v: &wgpu::TextureView,
    timestamps: Option<wgpu::RenderPassTimestampWrites<'_>>,
    draw: impl FnOnce(&mut wgpu::RenderPass<'_>),
) {
    let mut recorded = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("subtract"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: v,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color::WHITE),
                store: wgpu::StoreOp::Store,
            },
        })],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: depth_stencil,
            depth_ops: None,
            stencil_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0), store: wgpu::StoreOp::Store }),
        }),
        timestamp_writes: timestamps,
        occlusion_query_set: None,
        multiview_mask: None,
    });
    recorded.set_stencil_reference(0);
    draw(&mut recorded);
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::mem::offset_of;

    #[test]
    fn shaders_validate_and_the_mirror_has_their_offsets() {
        for text in [mask_shader(crate::caster::NO_DEFORM), receiver_shader(crate::caster::NO_DEFORM)] {
            let module =
                naga::front::wgsl::parse_str(&text).unwrap_or_else(|e| panic!("{}", e.emit_to_string(&text)));
            naga::valid::Validator::new(
                naga::valid::ValidationFlags::all(),
                naga::valid::Capabilities::empty(),
            )
            .validate(&module)
            .unwrap_or_else(|e| panic!("{}", e.emit_to_string(&text)));
            let Some((_, ty)) = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some("Receiving"))
            else {
                continue;
            };
            let naga::TypeInner::Struct { members, span } = &ty.inner else { panic!("no struct") };
            let shader: Vec<_> = members[..4].iter().map(|m| m.offset as usize).collect();
            let mirror = [
                offset_of!(GpuReceiving, clip_from_world),
                offset_of!(GpuReceiving, eye),
                offset_of!(GpuReceiving, light),
                offset_of!(GpuReceiving, time_s),
            ];
            assert_eq!((shader.as_slice(), *span as usize), (&mirror[..], size_of::<GpuReceiving>()));
        }
        assert!(receiver_shader(crate::caster::NO_DEFORM).contains("struct Receiving"));
    }
}
