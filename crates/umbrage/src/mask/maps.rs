//! Masks of equal size in one texture array.

use crate::ShadowError;
use crate::layers::Layers;

/// 1 where the blocker covers.
pub const MASK_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R8Unorm;

/// Masks of equal size, a layer for each light and blocker.
#[derive(Debug)]
pub struct MaskMaps {
    layers: Layers,
    count: u32,
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
        Ok(Self { layers: Layers::new(device, "umbrage masks", size, layers, MASK_FORMAT), count: layers })
    }

    /// All masks, as shaders read them.
    pub fn array(&self) -> &wgpu::TextureView {
        self.layers.array()
    }

    /// How many there are.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Memory of one mask, bytes.
    pub fn layer_bytes(&self) -> u64 {
        self.layers.layer_bytes()
    }

    /// One mask, to draw to; `None` past the last.
    pub(super) fn layer(&self, layer: u32) -> Option<&wgpu::TextureView> {
        self.layers.layer(layer)
    }

    /// Memory of all, bytes.
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
