//! The pass that adds up faces of volumes in the picture.

use crate::draw_list::Work;
use crate::options::{RenderOptions, View};
use crate::pipelines::OVERDRAW;
use crate::renderer::Renderer;
use crate::timing::Queries;
use crate::volumes::Volumes;
use std::collections::HashMap;
use umbrage::volume::{Counted, VolumePipelines, Winding};

const OVERDRAW_WGSL: &str = include_str!("../../wgsl/overdraw.wgsl");

/// Pipelines that add up: every face, and what is counted.
#[derive(Debug)]
pub(crate) struct OverdrawPipelines {
    made: HashMap<(Option<Counted>, Winding), wgpu::RenderPipeline>,
}

impl OverdrawPipelines {
    /// Makes them over a depth of `depth`; `None` in other views.
    pub fn of_view(
        device: &wgpu::Device,
        options: &RenderOptions,
        volumes: Option<&Volumes>,
        depth: wgpu::TextureFormat,
    ) -> Option<Self> {
        let volumes = volumes.filter(|_| options.view == View::Volumes)?.pipelines()?;
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("overdraw"),
            source: wgpu::ShaderSource::Wgsl(OVERDRAW_WGSL.into()),
        });
        let mut made = HashMap::new();
        for counted in [None, Some(Counted::Behind), Some(Counted::Before)] {
            for winding in [Winding::AsIs, Winding::Turned] {
                let pipeline = pipeline(device, volumes, &module, depth, counted, winding);
                made.insert((counted, winding), pipeline);
            }
        }
        Some(Self { made })
    }
}

fn pipeline(
    device: &wgpu::Device,
    volumes: &VolumePipelines,
    module: &wgpu::ShaderModule,
    depth: wgpu::TextureFormat,
    counted: Option<Counted>,
    winding: Winding,
) -> wgpu::RenderPipeline {
    let up = counted.is_none_or(Counted::front_counts_up);
    let constants = [("FRONT_COUNTS_UP", f64::from(u8::from(up)))];
    let add = wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::One,
        dst_factor: wgpu::BlendFactor::One,
        operation: wgpu::BlendOperation::Add,
    };
    let target = wgpu::ColorTargetState {
        format: OVERDRAW,
        blend: Some(wgpu::BlendState { color: add, alpha: add }),
        write_mask: wgpu::ColorWrites::RED | wgpu::ColorWrites::GREEN,
    };
    let compare =
        counted.map_or(wgpu::CompareFunction::Always, |counted| counted.depth_compare(volumes.depth()));
    volumes.make(
        device,
        winding,
        None,
        wgpu::DepthStencilState {
            format: depth,
            depth_write_enabled: Some(false),
            depth_compare: Some(compare),
            stencil: Default::default(),
            bias: Default::default(),
        },
        Some(wgpu::FragmentState {
            module,
            entry_point: Some(if counted.is_some() { "fs_count" } else { "fs_faces" }),
            compilation_options: wgpu::PipelineCompilationOptions {
                constants: if counted.is_some() { &constants } else { &[] },
                ..Default::default()
            },
            targets: &[Some(target)],
        }),
    )
}

impl Renderer<'_> {
    /// Adds up the faces of the shown light's volumes over what [`View::Volumes`] drew; `None` in other views. Says what it asks of
    /// the GPU.
    pub(crate) fn record_overdraw(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        queries: &Queries,
        pass: u32,
    ) -> Option<Work> {
        let (overdraw, volumes) = (self.overdraw.as_ref()?, self.volumes.as_ref()?);
        let mut recorded = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("overdraw"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &self.targets.output_view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.targets.depth,
                depth_ops: None,
                stencil_ops: None,
            }),
            timestamp_writes: queries.stamps(pass),
            occlusion_query_set: None,
            multiview_mask: None,
        });
        let light = self.options.shown_light;
        let mut work = Work::default();
        queries.count(&mut recorded, pass, |recorded| {
            let faces = volumes.draw_again(recorded, light, |_, winding| &overdraw.made[&(None, winding)]);
            let counts = volumes
                .draw_again(recorded, light, |counted, winding| &overdraw.made[&(Some(counted), winding)]);
            work = Work {
                draws: faces.draws + counts.draws,
                instances: faces.instances + counts.instances,
                triangles: faces.triangles + counts.triangles,
                vertices: faces.vertices + counts.vertices,
            };
        });
        Some(work)
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_shader_validates() {
        let text = super::OVERDRAW_WGSL;
        let module =
            naga::front::wgsl::parse_str(text).unwrap_or_else(|e| panic!("{}", e.emit_to_string(text)));
        naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::empty())
            .validate(&module)
            .unwrap_or_else(|e| panic!("{}", e.emit_to_string(text)));
    }
}
