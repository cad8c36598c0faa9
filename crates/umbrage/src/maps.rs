//! The maps of all lights: one texture array, a layer for each view.

use crate::format::SCRATCH_DEPTH;
use crate::{ChosenFormat, ShadowError};

/// Maps of equal size and format, one layer for each view, in one texture.
#[derive(Debug)]
pub struct ShadowMaps {
    texture: wgpu::Texture,
    layers: Vec<wgpu::TextureView>,
    array: wgpu::TextureView,
    /// Depth while a map of colour is drawn; one for all layers.
    scratch: Option<wgpu::TextureView>,
    keeps_scratch: bool,
    bytes_per_texel: u32,
}

impl ShadowMaps {
    /// Makes `layers` maps of `size_texel` by `size_texel`.
    ///
    /// # Errors
    /// [`ShadowError::TooLarge`] names the device's limits.
    pub fn new(
        device: &wgpu::Device,
        format: &ChosenFormat,
        size_texel: u32,
        layers: u32,
    ) -> Result<Self, ShadowError> {
        let limits = device.limits();
        let (limit, layer_limit) = (limits.max_texture_dimension_2d, limits.max_texture_array_layers);
        if size_texel == 0 || size_texel > limit || layers == 0 || layers > layer_limit {
            return Err(ShadowError::TooLarge { size_texel, layers, limit, layer_limit });
        }
        let is_color = format.storage.is_color();
        let make = |label, layers, format, usage| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width: size_texel, height: size_texel, depth_or_array_layers: layers },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage,
                view_formats: &[],
            })
        };
        let drawn = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let read = wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_SRC
            | wgpu::TextureUsages::COPY_DST;
        let texture = make("umbrage shadow maps", layers, format.format, drawn | read);
        let scratch = is_color
            .then(|| make("umbrage scratch depth", 1, SCRATCH_DEPTH, drawn).create_view(&Default::default()));
        let aspect = if is_color { wgpu::TextureAspect::All } else { wgpu::TextureAspect::DepthOnly };
        let view = |base_array_layer, count, dimension| {
            texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(dimension),
                base_array_layer,
                array_layer_count: Some(count),
                aspect,
                ..Default::default()
            })
        };
        Ok(Self {
            layers: (0..layers).map(|layer| view(layer, 1, wgpu::TextureViewDimension::D2)).collect(),
            array: view(0, layers, wgpu::TextureViewDimension::D2Array),
            scratch,
            keeps_scratch: false,
            bytes_per_texel: format.storage.bytes_per_texel(),
            texture,
        })
    }

    /// The same maps, whose scratch depth outlives the pass that draws a layer, because a later pass tests it.
    #[must_use]
    pub fn keeping_scratch(self) -> Self {
        Self { keeps_scratch: true, ..self }
    }

    /// What becomes of the scratch depth after a pass.
    pub(crate) fn scratch_store(&self) -> wgpu::StoreOp {
        if self.keeps_scratch { wgpu::StoreOp::Store } else { wgpu::StoreOp::Discard }
    }

    /// All layers, to sample.
    pub fn array(&self) -> &wgpu::TextureView {
        &self.array
    }

    /// One layer, to draw to. `None` past the last.
    pub fn layer(&self, layer: u32) -> Option<&wgpu::TextureView> {
        self.layers.get(layer as usize)
    }

    /// The depth that colour maps are drawn with; `None` where the map is depth itself.
    pub fn scratch(&self) -> Option<&wgpu::TextureView> {
        self.scratch.as_ref()
    }

    /// All layers, to copy from.
    pub fn texture(&self) -> &wgpu::Texture {
        &self.texture
    }

    /// Width and height of a map, texels.
    pub fn size_texel(&self) -> u32 {
        self.texture.width()
    }

    /// Memory of one layer, bytes: what each view of a light adds.
    pub fn layer_bytes(&self) -> u64 {
        u64::from(self.texture.width()) * u64::from(self.texture.height()) * u64::from(self.bytes_per_texel)
    }

    /// Layers.
    pub fn layer_count(&self) -> usize {
        self.layers.len()
    }

    /// Memory of all layers, and of the depth that colour maps are drawn with, bytes: linear in the number of views, whatever
    /// the scene.
    pub fn memory_bytes(&self) -> u64 {
        let texels = u64::from(self.texture.width()) * u64::from(self.texture.height());
        let layers = u64::from(self.texture.depth_or_array_layers()) * u64::from(self.bytes_per_texel);
        let scratch = if self.scratch.is_some() { 4 } else { 0 };
        texels * (layers + scratch)
    }
}

/// The sampler that compares and blends the four nearest comparisons, clamped to the edge, in the sense of
/// [`umbrage_core::DEPTH`].
pub fn comparison_sampler(device: &wgpu::Device) -> wgpu::Sampler {
    device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("umbrage comparison"),
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        compare: Some(crate::caster::depth_compare()),
        ..Default::default()
    })
}

/// The sampler of all other lookups: nearest, clamped to the edge.
pub fn point_sampler(device: &wgpu::Device) -> wgpu::Sampler {
    device.create_sampler(&wgpu::SamplerDescriptor { label: Some("umbrage texels"), ..Default::default() })
}
