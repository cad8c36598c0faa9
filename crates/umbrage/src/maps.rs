//! The maps of all lights: one depth texture array, a layer for each view.

use crate::{ChosenFormat, ShadowError};

/// Depth maps of equal size and format, one layer for each view, in one texture.
#[derive(Debug)]
pub struct ShadowMaps {
    texture: wgpu::Texture,
    layers: Vec<wgpu::TextureView>,
    array: wgpu::TextureView,
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
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("umbrage shadow maps"),
            size: wgpu::Extent3d { width: size_texel, height: size_texel, depth_or_array_layers: layers },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: format.format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let view = |base_array_layer, count, dimension| {
            texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(dimension),
                base_array_layer,
                array_layer_count: Some(count),
                aspect: wgpu::TextureAspect::DepthOnly,
                ..Default::default()
            })
        };
        Ok(Self {
            layers: (0..layers).map(|layer| view(layer, 1, wgpu::TextureViewDimension::D2)).collect(),
            array: view(0, layers, wgpu::TextureViewDimension::D2Array),
            bytes_per_texel: format.storage.bytes_per_texel(),
            texture,
        })
    }

    /// All layers, to sample.
    pub fn array(&self) -> &wgpu::TextureView {
        &self.array
    }

    /// One layer, to draw to. `None` past the last.
    pub fn layer(&self, layer: u32) -> Option<&wgpu::TextureView> {
        self.layers.get(layer as usize)
    }

    /// Width and height of a map, texels.
    pub fn size_texel(&self) -> u32 {
        self.texture.width()
    }

    /// Memory of all layers, bytes: linear in the number of lights, whatever the scene.
    pub fn memory_bytes(&self) -> u64 {
        let texels = u64::from(self.texture.width()) * u64::from(self.texture.height());
        texels * u64::from(self.texture.depth_or_array_layers()) * u64::from(self.bytes_per_texel)
    }
}

/// The sampler that compares: nearest or linear, clamped to the edge, in the sense of [`umbrage_core::DEPTH`].
pub fn comparison_sampler(device: &wgpu::Device, filter: umbrage_core::technique::Filter) -> wgpu::Sampler {
    let mode = if filter.blends_comparisons() { wgpu::FilterMode::Linear } else { wgpu::FilterMode::Nearest };
    device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("umbrage comparison"),
        mag_filter: mode,
        min_filter: mode,
        compare: Some(crate::caster::depth_compare()),
        ..Default::default()
    })
}
