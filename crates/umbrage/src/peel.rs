//! Depth peeling: the surfaces that lie behind each other, layer by layer.
//!
//! Layer 0 holds the nearest surface of each texel, layer i + 1 the nearest of those strictly behind layer i (Everitt 2001,
//! "Interactive Order-Independent Transparency"). Beyond the last surface a layer holds the far plane. Each layer costs one
//! drawing of all casters and 4 bytes a texel.

use crate::caster::{CasterPipelines, CasterVertices};
use crate::format::{PEEL_DEPTH, PEEL_STORAGE};
use crate::{ChosenFormat, ShadowError};
use umbrage_core::plan::{Pass, peel_pass};

/// Layers of depth, peeled off one after the other.
#[derive(Debug)]
pub struct Peel {
    texture: wgpu::Texture,
    layers: Vec<wgpu::TextureView>,
    /// Group 1 of the pass that draws what lies behind each layer.
    groups: Vec<wgpu::BindGroup>,
}

impl Peel {
    /// Makes `layers` layers of `size_texel` by `size_texel`, 32-bit float: coarser depths could not tell a surface from one
    /// closely behind it, nor be compared with what the rasteriser computes without a margin.
    ///
    /// # Errors
    /// [`ShadowError::TooLarge`] names the device's limits: `max_texture_dimension_2d` and `max_texture_array_layers`, 256 on
    /// most.
    pub fn new(device: &wgpu::Device, size_texel: u32, layers: u32) -> Result<Self, ShadowError> {
        let limits = device.limits();
        let (limit, layer_limit) = (limits.max_texture_dimension_2d, limits.max_texture_array_layers);
        if size_texel == 0 || size_texel > limit || layers == 0 || layers > layer_limit {
            return Err(ShadowError::TooLarge { size_texel, layers, limit, layer_limit });
        }
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("umbrage peel"),
            size: wgpu::Extent3d { width: size_texel, height: size_texel, depth_or_array_layers: layers },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: PEEL_DEPTH,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                | wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let view = |base_array_layer| {
            texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2),
                base_array_layer,
                array_layer_count: Some(1),
                aspect: wgpu::TextureAspect::DepthOnly,
                ..Default::default()
            })
        };
        let layers: Vec<_> = (0..layers).map(view).collect();
        let layout = layer_layout(device);
        let group = |view| {
            device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("umbrage peeled layer"),
                layout: &layout,
                entries: &[wgpu::BindGroupEntry {
                    binding: 0,
                    resource: wgpu::BindingResource::TextureView(view),
                }],
            })
        };
        let groups = layers.iter().map(group).collect();
        Ok(Self { texture, layers, groups })
    }

    /// All layers: depth as [`umbrage_core::DEPTH`] says, to sample or to copy from.
    pub fn texture(&self) -> &wgpu::Texture {
        &self.texture
    }

    /// How many layers there are.
    pub fn layers(&self) -> u32 {
        self.texture.depth_or_array_layers()
    }

    /// Width and height, texels.
    pub fn size_texel(&self) -> u32 {
        self.texture.width()
    }

    /// Group 1 of pipelines that draw what lies behind a layer. `None` past the last.
    pub fn behind(&self, layer: u32) -> Option<&wgpu::BindGroup> {
        self.groups.get(layer as usize)
    }

    /// Memory of all layers, bytes.
    pub fn memory_bytes(&self) -> u64 {
        4 * u64::from(self.size_texel()).pow(2) * u64::from(self.layers())
    }
}

/// Group 1 of pipelines that draw what lies behind a layer: its depth.
pub fn layer_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("umbrage peeled layer"),
        entries: &[wgpu::BindGroupLayoutEntry {
            binding: 0,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty: wgpu::BindingType::Texture {
                sample_type: wgpu::TextureSampleType::Depth,
                view_dimension: wgpu::TextureViewDimension::D2,
                multisampled: false,
            },
            count: None,
        }],
    })
}

/// Pipelines that peel: those of the nearest layer and those of all layers behind it.
#[derive(Debug)]
pub struct PeelPipelines {
    /// Of layer 0.
    pub nearest: CasterPipelines,
    /// Of layers 1 and up.
    pub behind: CasterPipelines,
}

impl PeelPipelines {
    /// Makes the pipelines; they draw all faces. The arguments are those of [`CasterPipelines::new`].
    pub fn new(
        device: &wgpu::Device,
        cut_out_layout: &wgpu::BindGroupLayout,
        vertices: &CasterVertices<'_>,
    ) -> Self {
        let format =
            ChosenFormat { storage: PEEL_STORAGE, format: PEEL_DEPTH, why: "depth peeling".to_owned() };
        // Neither target's size is part of a pipeline.
        let of =
            |layer| CasterPipelines::new(device, &format, &peel_pass(1, layer), cut_out_layout, vertices);
        Self { nearest: of(0), behind: of(1) }
    }

    /// Those of a layer.
    pub fn of_layer(&self, layer: u32) -> &CasterPipelines {
        if layer == 0 { &self.nearest } else { &self.behind }
    }
}

/// Records one pass for each layer of `peel`, nearest first. `draw` gets the pass and the pipelines of its layer, and draws all
/// casters each time: it sets group 0, group `cut_out_group` of cut-out casters and the
/// vertex streams of [`crate::CasterStreams`], and leaves the layer's group 1 alone.
pub fn record_peel(
    encoder: &mut wgpu::CommandEncoder,
    peel: &Peel,
    pipelines: &PeelPipelines,
    mut draw: impl FnMut(&mut wgpu::RenderPass<'_>, &CasterPipelines),
) {
    for layer in 0..peel.layers() {
        let pass = peel_pass(peel.size_texel(), layer);
        record_peel_layer(encoder, peel, layer, &pass, None, |recorded| {
            draw(recorded, pipelines.of_layer(layer));
        });
    }
}

/// Records the pass of one layer; the layers before it must have been drawn.
pub fn record_peel_layer<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    peel: &Peel,
    layer: u32,
    pass: &Pass,
    timestamps: Option<wgpu::RenderPassTimestampWrites<'a>>,
    draw: impl FnOnce(&mut wgpu::RenderPass<'_>),
) {
    let Some(view) = peel.layers.get(layer as usize) else { return };
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
    if layer > 0 {
        recorded.set_bind_group(1, peel.behind(layer - 1), &[]);
    }
    draw(&mut recorded);
}
