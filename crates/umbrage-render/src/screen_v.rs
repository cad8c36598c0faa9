//! V that is found on the screen, a layer for each light: what volumes and subtractive masks leave behind.

use glam::UVec2;

/// Its format: V is a bit, or what a blur makes of it.
pub const SCREEN_V: wgpu::TextureFormat = wgpu::TextureFormat::R8Unorm;

/// V of each light for each pixel.
#[derive(Debug)]
pub(crate) struct ScreenV {
    layers: Vec<wgpu::TextureView>,
    array: wgpu::TextureView,
    bytes: u64,
}

impl ScreenV {
    /// For so many lights, one at least.
    pub fn new(device: &wgpu::Device, size: UVec2, lights: usize) -> Self {
        let count = lights.max(1) as u32;
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("visibility"),
            size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: count },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: SCREEN_V,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let view = |base_array_layer, count, dimension| {
            texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(dimension),
                base_array_layer,
                array_layer_count: Some(count),
                ..Default::default()
            })
        };
        Self {
            layers: (0..count).map(|layer| view(layer, 1, wgpu::TextureViewDimension::D2)).collect(),
            array: view(0, count, wgpu::TextureViewDimension::D2Array),
            bytes: u64::from(count) * u64::from(size.x) * u64::from(size.y),
        }
    }

    /// A light's layer.
    pub fn layer(&self, light: usize) -> &wgpu::TextureView {
        &self.layers[light]
    }

    /// All layers.
    pub fn array(&self) -> &wgpu::TextureView {
        &self.array
    }

    /// Memory of a layer, bytes.
    pub fn layer_bytes(&self) -> u64 {
        self.bytes / self.layers.len() as u64
    }

    /// Memory, bytes.
    pub fn memory_bytes(&self) -> u64 {
        self.bytes
    }
}
