//! Textures that a frame is drawn to.

use crate::pipelines::{COLOR, DEPTH_FORMAT, GBUFFER, format_of};
use crate::{RenderError, RenderOptions};

/// The targets of one picture.
#[derive(Debug)]
pub struct Targets {
    /// What is read back.
    pub output: wgpu::Texture,
    /// The same, to draw to.
    pub output_view: wgpu::TextureView,
    /// Depth of the picture.
    pub depth: wgpu::TextureView,
    /// Surfaces; `None` when everything is lit at once.
    pub gbuffer: Option<wgpu::TextureView>,
    /// Surfaces and depth to be read back, where there is a G-buffer.
    pub surfaces: Option<[wgpu::Texture; 2]>,
    /// Colour with several samples, resolved into the output.
    pub multisampled: Option<wgpu::TextureView>,
}

impl Targets {
    /// Makes them.
    ///
    /// # Errors
    /// [`RenderError::Size`] when the device's textures are smaller.
    pub fn new(device: &wgpu::Device, options: &RenderOptions, deferred: bool) -> Result<Self, RenderError> {
        let (width, height) = (options.size.x, options.size.y);
        let limit = device.limits().max_texture_dimension_2d;
        if width == 0 || height == 0 || width > limit || height > limit {
            return Err(RenderError::Size { width, height, limit });
        }
        let make = |label, format, sample_count, usage| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage,
                view_formats: &[],
            })
        };
        use wgpu::TextureUsages as Usage;
        let drawn = Usage::RENDER_ATTACHMENT;
        let samples = if deferred { 1 } else { options.samples };
        let output =
            make("output", format_of(options.view, options.colors_light()), 1, drawn | Usage::COPY_SRC);
        let read = drawn | Usage::TEXTURE_BINDING | Usage::COPY_SRC;
        let depth = make("depth", DEPTH_FORMAT, samples, if deferred { read } else { drawn });
        let gbuffer = deferred.then(|| make("gbuffer", GBUFFER, 1, read));
        let view = |texture: &wgpu::Texture| texture.create_view(&Default::default());
        Ok(Self {
            output_view: output.create_view(&Default::default()),
            depth: view(&depth),
            gbuffer: gbuffer.as_ref().map(view),
            multisampled: (samples > 1).then(|| view(&make("samples", COLOR, samples, drawn))),
            surfaces: gbuffer.map(|gbuffer| [gbuffer, depth]),
            output,
        })
    }
}
