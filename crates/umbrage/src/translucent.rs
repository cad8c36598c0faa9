//! Maps of the light that translucent casters colour, and the two passes that draw them.

use crate::caster::{
    CasterStreams, CasterVertices, caster_shader, channels, depth_bias, depth_compare, record_caster_pass,
};
use crate::format::SCRATCH_DEPTH;
use crate::layers::Layers;
use crate::{ChosenFormat, ShadowError, ShadowMaps};
use umbrage_core::plan::Pass;

/// What goes through is kept in steps of 1/255.
pub const COLORS: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// Beside the maps of what blocks light, a layer for each view of the colours that translucent casters give to it, and one of
/// the nearest of these casters.
#[derive(Debug)]
pub struct TranslucentMaps {
    colors: Layers,
    nearest: ShadowMaps,
}

impl TranslucentMaps {
    /// Makes `layers` of each, of `size_texel` by `size_texel`; `format` is that of the maps that they stand beside, which must be
    /// [keeping their scratch depth](ShadowMaps::keeping_scratch).
    ///
    /// # Errors
    /// [`ShadowError::TooLarge`] names the device's limits.
    pub fn new(
        device: &wgpu::Device,
        format: &ChosenFormat,
        size_texel: u32,
        layers: u32,
    ) -> Result<Self, ShadowError> {
        let nearest = ShadowMaps::new(device, format, size_texel, layers)?;
        let size = [size_texel, size_texel];
        Ok(Self { colors: Layers::new(device, "umbrage colours of light", size, layers, COLORS), nearest })
    }

    /// The colours of all layers, to sample.
    pub fn colors(&self) -> &wgpu::TextureView {
        self.colors.array()
    }

    /// The maps of the nearest translucent casters.
    pub fn nearest(&self) -> &ShadowMaps {
        &self.nearest
    }

    /// Memory of both, bytes; the maps beside them are not counted.
    pub fn memory_bytes(&self) -> u64 {
        self.colors.memory_bytes() + self.nearest.memory_bytes()
    }
}

const UV_COLOR: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: 24,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &wgpu::vertex_attr_array![4 => Float32x2, 5 => Float32x4],
};

impl CasterStreams {
    /// Slot 2 of translucent casters: texture coordinates, and the linear colour and alpha that the texture is multiplied by.
    pub const UV_COLOR: wgpu::VertexBufferLayout<'static> = UV_COLOR;
}

/// The text of the shader of translucent casters; `deform` as in [`caster_shader`].
pub fn translucent_shader(deform: &str) -> String {
    let library = umbrage_core::wgsl::assemble(&["through"]).unwrap_or_else(|e| format!("// {e}\n"));
    [library.as_str(), &caster_shader(deform), include_str!("../wgsl/translucent.wgsl")].join("\n")
}

/// Pipelines that draw translucent casters. Groups 0 and 1 are those of [`CasterPipelines`](crate::CasterPipelines) for
/// cut-out casters.
#[derive(Debug)]
pub struct TranslucentPipelines {
    /// For [`record_color_pass`].
    pub color: wgpu::RenderPipeline,
    /// For [`record_nearest_pass`].
    pub nearest: wgpu::RenderPipeline,
}

/// Each colour times what is there.
const MULTIPLY: wgpu::BlendState = {
    let component = wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::Dst,
        dst_factor: wgpu::BlendFactor::Zero,
        operation: wgpu::BlendOperation::Add,
    };
    wgpu::BlendState { color: component, alpha: component }
};

impl TranslucentPipelines {
    /// Makes the pipelines of a planned pass beside maps of `format`; the layouts are those of the
    /// [casters'](crate::CasterPipelines) groups 0 and 1.
    pub fn new(
        device: &wgpu::Device,
        format: &ChosenFormat,
        pass: &Pass,
        groups: [&wgpu::BindGroupLayout; 2],
        vertices: &CasterVertices<'_>,
    ) -> Self {
        let attribute = vertices.attribute();
        let shader = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("umbrage translucent caster"),
            source: wgpu::ShaderSource::Wgsl(translucent_shader(vertices.deform).into()),
        });
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("umbrage translucent caster"),
            bind_group_layouts: &groups.map(Some),
            immediate_size: 0,
        });
        let is_color = format.storage.is_color();
        let constants = [("UMBRAGE_CHANNELS", channels(format.storage))];
        let pipeline = |label, entry_point, writes_depth, target: Option<wgpu::ColorTargetState>| {
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(label),
                layout: Some(&layout),
                vertex: wgpu::VertexState {
                    module: &shader,
                    entry_point: Some("vs_pane"),
                    compilation_options: Default::default(),
                    buffers: &[
                        Some(vertices.positions(&attribute)),
                        Some(CasterStreams::INSTANCES),
                        Some(UV_COLOR),
                    ],
                },
                primitive: Default::default(),
                depth_stencil: Some(wgpu::DepthStencilState {
                    format: if is_color { SCRATCH_DEPTH } else { format.format },
                    depth_write_enabled: Some(writes_depth),
                    depth_compare: Some(depth_compare()),
                    stencil: Default::default(),
                    // As in the map that is tested: a pane that touches its frame keeps its place before or behind it.
                    bias: depth_bias(format.storage, pass),
                }),
                multisample: Default::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &shader,
                    entry_point: Some(entry_point),
                    compilation_options: wgpu::PipelineCompilationOptions {
                        constants: if entry_point == "fs_pane_distance" { &constants } else { &[] },
                        ..Default::default()
                    },
                    targets: &[target][..usize::from(entry_point != "fs_pane_depth")],
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        let multiplied = wgpu::ColorTargetState {
            format: COLORS,
            blend: Some(MULTIPLY),
            write_mask: wgpu::ColorWrites::ALL,
        };
        let nearest = if is_color { "fs_pane_distance" } else { "fs_pane_depth" };
        Self {
            color: pipeline("umbrage colours of light", "fs_pane", false, Some(multiplied)),
            nearest: pipeline(
                "umbrage nearest translucent caster",
                nearest,
                true,
                Some(format.format.into()),
            ),
        }
    }
}

/// Records the pass that colours the light of one layer: white, then `draw` multiplies it by translucent casters. Must follow the
/// pass that draws the same layer of `maps`, before any other of them is drawn: its depth is tested.
pub fn record_color_pass<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    maps: &ShadowMaps,
    translucent: &TranslucentMaps,
    layer: u32,
    pass: &Pass,
    timestamps: Option<wgpu::RenderPassTimestampWrites<'a>>,
    draw: impl FnOnce(&mut wgpu::RenderPass<'_>),
) {
    let (Some(view), Some(map)) = (translucent.colors.layer(layer), maps.layer(layer)) else { return };
    let mut recorded = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(pass.name),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color::WHITE),
                store: wgpu::StoreOp::Store,
            },
        })],
        // Read only.
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: maps.scratch().unwrap_or(map),
            depth_ops: None,
            stencil_ops: None,
        }),
        timestamp_writes: timestamps,
        occlusion_query_set: None,
        multiview_mask: None,
    });
    draw(&mut recorded);
}

/// Records the pass that finds the nearest translucent caster in each texel of a layer.
pub fn record_nearest_pass<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    translucent: &TranslucentMaps,
    layer: u32,
    pass: &Pass,
    timestamps: Option<wgpu::RenderPassTimestampWrites<'a>>,
    draw: impl FnOnce(&mut wgpu::RenderPass<'_>),
) {
    record_caster_pass(encoder, &translucent.nearest, layer, pass, timestamps, draw);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shader_validates_without_optional_capabilities() {
        let text = translucent_shader(crate::caster::NO_DEFORM);
        let module =
            naga::front::wgsl::parse_str(&text).unwrap_or_else(|e| panic!("{}", e.emit_to_string(&text)));
        naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::empty())
            .validate(&module)
            .unwrap_or_else(|e| panic!("{}", e.emit_to_string(&text)));
        assert_eq!(module.entry_points.iter().filter(|e| e.name.contains("pane")).count(), 4);
    }
}
