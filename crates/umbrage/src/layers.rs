//! A texture array that is drawn layer by layer and read as a whole.

/// Layers of equal size in one texture.
#[derive(Debug)]
pub struct Layers {
    texture: wgpu::Texture,
    layers: Vec<wgpu::TextureView>,
    array: wgpu::TextureView,
}

impl Layers {
    /// Makes `count` layers of `size` pixels, across and down, to be drawn to and sampled. All three are 1 or more and within the
    /// device's limits: the caller checks. Memory: all texels at once.
    pub fn new(
        device: &wgpu::Device,
        label: &str,
        [width, height]: [u32; 2],
        count: u32,
        format: wgpu::TextureFormat,
    ) -> Self {
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: count },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                | wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::COPY_SRC,
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
            texture,
        }
    }

    /// How many there are.
    pub fn count(&self) -> u32 {
        self.layers.len() as u32
    }

    /// One layer, to draw to; `None` past the last.
    pub fn layer(&self, layer: u32) -> Option<&wgpu::TextureView> {
        self.layers.get(layer as usize)
    }

    /// All layers, to sample.
    pub fn array(&self) -> &wgpu::TextureView {
        &self.array
    }

    /// Memory of one layer, bytes.
    pub fn layer_bytes(&self) -> u64 {
        let texel_bytes = self.texture.format().block_copy_size(None).unwrap_or(4);
        u64::from(self.texture.width()) * u64::from(self.texture.height()) * u64::from(texel_bytes)
    }

    /// Memory of all, bytes.
    pub fn memory_bytes(&self) -> u64 {
        self.layer_bytes() * self.layers.len() as u64
    }
}
