//! This renderer's own pass that draws nothing but depth. It would have one for its early depth, too.

use crate::scene::LAYOUT;
use crate::shadow::Shadow;
use umbrage_core::DEPTH;

/// The map and the pipeline that draws it.
pub struct DepthPass {
    /// What is drawn into, and looked up.
    pub map: wgpu::TextureView,
    /// Depth only.
    pub pipeline: wgpu::RenderPipeline,
}

impl DepthPass {
    /// As the shadow's plan says: which way depth runs, and the offset.
    pub fn new(device: &wgpu::Device, module: &wgpu::ShaderModule, shadow: &Shadow) -> Self {
        let format = wgpu::TextureFormat::Depth32Float;
        let map = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("map"),
            size: wgpu::Extent3d {
                width: shadow.size_texel,
                height: shadow.size_texel,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("map"),
            layout: None,
            vertex: wgpu::VertexState {
                module,
                entry_point: Some("vs_map"),
                compilation_options: Default::default(),
                buffers: &[Some(LAYOUT)],
            },
            primitive: Default::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format,
                depth_write_enabled: Some(true),
                depth_compare: Some(if DEPTH.is_reversed() {
                    wgpu::CompareFunction::Greater
                } else {
                    wgpu::CompareFunction::Less
                }),
                stencil: Default::default(),
                bias: wgpu::DepthBiasState {
                    constant: shadow.pass.offset.constant,
                    slope_scale: shadow.pass.offset.slope,
                    clamp: 0.0,
                },
            }),
            multisample: Default::default(),
            fragment: None,
            multiview_mask: None,
            cache: None,
        });
        let map = map.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            ..Default::default()
        });
        Self { map, pipeline }
    }

    /// Draws the map, or only clears it.
    pub fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        shadow: &Shadow,
        frame: &wgpu::BindGroup,
        casters: Option<(&wgpu::Buffer, u32)>,
    ) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("map"),
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.map,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(shadow.pass.clear_depth),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        if let Some((corners, count)) = casters {
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, frame, &[]);
            pass.set_vertex_buffer(0, corners.slice(..));
            pass.draw(0..count, 0..1);
        }
    }
}
