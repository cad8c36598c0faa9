//! The pass that draws a blocker's outline into its mask.

use super::maps::{MASK_FORMAT, MaskMaps};
use super::{module, uniform};
use crate::caster::{CasterStreams, CasterVertices, GpuCasterView, caster_shader, unclipped};
use glam::Mat4;

/// Pipelines that draw blockers: without depth, light or clipping in depth.
#[derive(Clone, Debug)]
pub struct MaskPipelines {
    /// Vertex streams as in [`CasterStreams`], the first two.
    pub solid: wgpu::RenderPipeline,
    /// All three, and group 1 as in [`crate::CasterPipelines::cut_out_layout`].
    pub cut_out: wgpu::RenderPipeline,
    /// Group 0: a [`GpuCasterView`], a uniform buffer with a dynamic offset.
    pub view_layout: wgpu::BindGroupLayout,
}

pub(super) fn mask_shader(deform: &str) -> String {
    [&caster_shader(deform), include_str!("../../wgsl/mask_caster.wgsl")].join("\n")
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
    let Some(view) = masks.layer(layer) else { return };
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
