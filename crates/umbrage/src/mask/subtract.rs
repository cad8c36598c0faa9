//! Receivers drawn once more, each mask taking away from V what its blocker covers.

use super::maps::MaskMaps;
use super::{module, uniform};
use crate::caster::{CasterStreams, CasterVertices};
use glam::{Mat4, Vec4};
use std::num::NonZeroU64;
use umbrage_core::DepthConvention;
use umbrage_core::layout_mask::GpuMask;
use umbrage_core::wgsl::assemble;

pub(super) fn receiver_shader(deform: &str) -> String {
    let library = assemble(&["mask"]).unwrap_or_else(|e| format!("// {e}\n"));
    [&library, deform, include_str!("../../wgsl/mask_receiver.wgsl")].join("\n")
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

/// The depth that receivers are drawn over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SubtractDepth {
    /// Its format, one with a stencil: see [`crate::volume::choose_count_format`].
    pub format: wgpu::TextureFormat,
    /// Which way it runs.
    pub convention: DepthConvention,
    /// Were its surfaces drawn by the same arithmetic to the last bit: `clip_from_world * (p_world, 1)`, `p_world` by the rows of
    /// [`CasterStreams`], and the position `@invariant`? Then only what lies at equal depth is darkened. Else all is that lies
    /// behind it by no more than rounding may do, and what lies before it too: leave out receivers that have holes, and say by
    /// `cull_mode` which faces are not drawn. That writes a depth for each pixel, so hidden receivers cost as much as seen ones.
    pub exact: bool,
    /// Faces that are not drawn. Default where all are: `None`.
    pub cull_mode: Option<wgpu::Face>,
}

impl SubtractDepth {
    /// The depth of whoever draws as this library does.
    pub fn exact(format: wgpu::TextureFormat, convention: DepthConvention) -> Self {
        Self { format, convention, exact: true, cull_mode: None }
    }

    /// The depth of somebody else's renderer, which draws front faces only.
    pub fn inexact(format: wgpu::TextureFormat, convention: DepthConvention) -> Self {
        Self { format, convention, exact: false, cull_mode: Some(wgpu::Face::Back) }
    }

    /// What passes. Drawn a second time, a surface lies exactly where it lay, and what lies before it is not there: a hole that
    /// a texture cuts, or a face that is not drawn from behind. Where it lies a few steps off it still has to pass.
    fn compare(self) -> wgpu::CompareFunction {
        match (self.exact, self.convention.is_reversed()) {
            (true, _) => wgpu::CompareFunction::Equal,
            (false, true) => wgpu::CompareFunction::GreaterEqual,
            (false, false) => wgpu::CompareFunction::LessEqual,
        }
    }

    /// Where the depth is another's, receivers are moved towards the eye; see `nearer` of `wgsl/mask_receiver.wgsl`. No edge of a
    /// shadow moves by it, because masks do not know the picture's depth; only what is hidden by that little may darken what
    /// hides it. Polygon offset would not do: its steps know nothing of how far from the origin things are.
    fn entry(self, shadowed: Shadowed) -> &'static str {
        match (shadowed, self.exact) {
            (Shadowed::Core, true) => "fs_core",
            (Shadowed::Core, false) => "fs_core_nearer",
            (Shadowed::Fringe, true) => "fs_fringe",
            (Shadowed::Fringe, false) => "fs_fringe_nearer",
        }
    }

    /// Some steps of a depth that counts in whole ones.
    fn steps(self) -> f64 {
        use wgpu::TextureFormat::{Depth32Float, Depth32FloatStencil8};
        if matches!(self.format, Depth32Float | Depth32FloatStencil8) {
            0.0
        } else {
            8.0 / f64::from(1 << 24)
        }
    }
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

    /// For V of `v_format` over a depth with a stencil. Vertices come, and are deformed, as where the surfaces were drawn.
    pub fn new(
        device: &wgpu::Device,
        depth: SubtractDepth,
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
        let constants = [("TOWARDS_EYE", f64::from(-depth.convention.away())), ("STEPS", depth.steps())];
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
                primitive: wgpu::PrimitiveState { cull_mode: depth.cull_mode, ..Default::default() },
                depth_stencil: Some(wgpu::DepthStencilState {
                    format: depth.format,
                    depth_write_enabled: Some(false),
                    depth_compare: Some(depth.compare()),
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
                    entry_point: Some(depth.entry(shadowed)),
                    compilation_options: wgpu::PipelineCompilationOptions {
                        constants: if depth.exact { &[] } else { &constants },
                        ..Default::default()
                    },
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
