//! The pass that draws casters into a map.

use crate::ShadowMaps;
use std::num::NonZeroU64;
use umbrage_core::DEPTH;
use umbrage_core::plan::Pass;

/// The vertex buffers that caster pipelines read.
///
/// Slot 0: positions, `Float32x3`, 12 bytes. Slot 1, per instance: the three rows of `world_from_object`,
/// `3 x Float32x4`, 48 bytes. Slot 2, only for cut-out casters: texture coordinates and alpha factor, `Float32x3`.
#[derive(Clone, Copy, Debug)]
pub struct CasterStreams;

const POSITIONS: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: 12,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &wgpu::vertex_attr_array![0 => Float32x3],
};
const INSTANCES: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: 48,
    step_mode: wgpu::VertexStepMode::Instance,
    attributes: &wgpu::vertex_attr_array![1 => Float32x4, 2 => Float32x4, 3 => Float32x4],
};
const UV_ALPHA: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: 12,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &wgpu::vertex_attr_array![4 => Float32x3],
};

impl CasterStreams {
    /// Slot 0.
    pub const POSITIONS: wgpu::VertexBufferLayout<'static> = POSITIONS;
    /// Slot 1.
    pub const INSTANCES: wgpu::VertexBufferLayout<'static> = INSTANCES;
    /// Slot 2 of cut-out casters.
    pub const UV_ALPHA: wgpu::VertexBufferLayout<'static> = UV_ALPHA;
}

/// The comparison that keeps what is nearest, for depth tests and comparison samplers alike.
pub fn depth_compare() -> wgpu::CompareFunction {
    if DEPTH.is_reversed() { wgpu::CompareFunction::GreaterEqual } else { wgpu::CompareFunction::LessEqual }
}

/// Pipelines that draw casters, and the layouts that they take.
#[derive(Debug)]
pub struct CasterPipelines {
    /// Casters that are no closed solids, or not wholly in front of the light.
    pub open: wgpu::RenderPipeline,
    /// Closed casters wholly in front of the light: what their back faces block, their front faces block too.
    pub closed: wgpu::RenderPipeline,
    /// The same, placed by a mirroring transform, which turns their winding.
    pub closed_mirrored: wgpu::RenderPipeline,
    /// Casters whose texture cuts holes.
    pub cut_out: wgpu::RenderPipeline,
    /// Group 0: `clip_from_world`, a uniform buffer with a dynamic offset.
    pub view_layout: wgpu::BindGroupLayout,
}

impl CasterPipelines {
    /// Group 1 of cut-out casters: base colour texture, its sampler.
    pub fn cut_out_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
        device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("umbrage cut-out caster"),
            entries: &[
                wgpu::BindGroupLayoutEntry {
                    binding: 0,
                    visibility: wgpu::ShaderStages::FRAGMENT,
                    ty: wgpu::BindingType::Texture {
                        sample_type: wgpu::TextureSampleType::Float { filterable: true },
                        view_dimension: wgpu::TextureViewDimension::D2,
                        multisampled: false,
                    },
                    count: None,
                },
                wgpu::BindGroupLayoutEntry {
                    binding: 1,
                    visibility: wgpu::ShaderStages::FRAGMENT,
                    ty: wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
                    count: None,
                },
            ],
        })
    }

    /// Makes the pipelines of a planned pass for maps of `format`. `cut_out_layout` is [`Self::cut_out_layout`].
    pub fn new(
        device: &wgpu::Device,
        format: wgpu::TextureFormat,
        pass: &Pass,
        cut_out_layout: &wgpu::BindGroupLayout,
    ) -> Self {
        let shader = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("umbrage caster"),
            source: wgpu::ShaderSource::Wgsl(include_str!("../wgsl/caster.wgsl").into()),
        });
        let view_layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("umbrage caster view"),
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::VERTEX,
                ty: wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Uniform,
                    has_dynamic_offset: true,
                    min_binding_size: NonZeroU64::new(64),
                },
                count: None,
            }],
        });
        let pipeline = |label, groups: &[Option<&wgpu::BindGroupLayout>], cut_out: bool, cull_mode| {
            let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(label),
                bind_group_layouts: groups,
                immediate_size: 0,
            });
            let buffers = [Some(POSITIONS), Some(INSTANCES), Some(UV_ALPHA)];
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(label),
                layout: Some(&layout),
                vertex: wgpu::VertexState {
                    module: &shader,
                    entry_point: Some(if cut_out { "vs_cut_out" } else { "vs_solid" }),
                    compilation_options: Default::default(),
                    buffers: if cut_out { &buffers } else { &buffers[..2] },
                },
                primitive: wgpu::PrimitiveState { cull_mode, ..Default::default() },
                depth_stencil: Some(wgpu::DepthStencilState {
                    format,
                    depth_write_enabled: Some(true),
                    depth_compare: Some(depth_compare()),
                    stencil: Default::default(),
                    bias: wgpu::DepthBiasState {
                        constant: pass.offset.constant,
                        slope_scale: pass.offset.slope,
                        clamp: 0.0,
                    },
                }),
                multisample: Default::default(),
                fragment: cut_out.then(|| wgpu::FragmentState {
                    module: &shader,
                    entry_point: Some("fs_cut_out"),
                    compilation_options: Default::default(),
                    targets: &[],
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        let solid = [Some(&view_layout)];
        Self {
            open: pipeline("umbrage open caster", &solid, false, None),
            closed: pipeline("umbrage closed caster", &solid, false, Some(wgpu::Face::Back)),
            closed_mirrored: pipeline("umbrage mirrored caster", &solid, false, Some(wgpu::Face::Front)),
            cut_out: pipeline(
                "umbrage cut-out caster",
                &[Some(&view_layout), Some(cut_out_layout)],
                true,
                None,
            ),
            view_layout,
        }
    }
}

/// Records the pass that draws one layer of the maps: clears it, then lets `draw` draw the casters.
pub fn record_caster_pass<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    maps: &ShadowMaps,
    layer: u32,
    pass: &Pass,
    timestamps: Option<wgpu::RenderPassTimestampWrites<'a>>,
    draw: impl FnOnce(&mut wgpu::RenderPass<'_>),
) {
    let Some(view) = maps.layer(layer) else { return };
    let mut recorded = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(pass.name),
        color_attachments: &[],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view,
            depth_ops: Some(wgpu::Operations {
                load: wgpu::LoadOp::Clear(pass.clear_depth),
                store: wgpu::StoreOp::Store,
            }),
            stencil_ops: None,
        }),
        timestamp_writes: timestamps,
        occlusion_query_set: None,
        multiview_mask: None,
    });
    draw(&mut recorded);
}
