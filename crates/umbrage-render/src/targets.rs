//! Textures that a frame is drawn to.

use crate::pipelines::{COLOR, GBUFFER, OBJECT, format_of};
use crate::{RenderError, RenderOptions};

/// The targets of one picture.
#[derive(Debug)]
pub struct Targets {
    /// What is read back.
    pub output: wgpu::Texture,
    /// The same, to draw to.
    pub output_view: wgpu::TextureView,
    /// Depth of the surfaces, with the stencil where there is one.
    pub depth: wgpu::TextureView,
    /// The same without, to be read; only where there is a G-buffer.
    pub depth_only: Option<wgpu::TextureView>,
    /// Depth of what is lit at once, where that is drawn after the G-buffer.
    pub lit_depth: Option<wgpu::TextureView>,
    /// Surfaces; `None` when everything is lit at once and nobody asks for them.
    pub gbuffer: Option<wgpu::TextureView>,
    /// Each pixel's object, where it is kept.
    pub objects: Option<wgpu::TextureView>,
    /// Surfaces and depth to be read back, where there is a G-buffer.
    pub surfaces: Option<[wgpu::Texture; 2]>,
    /// Colour with several samples, resolved into the output.
    pub multisampled: Option<wgpu::TextureView>,
}

/// Which targets there are.
#[derive(Clone, Copy, Debug)]
pub struct TargetNeeds {
    /// Are surfaces drawn into a G-buffer?
    pub gbuffer: bool,
    /// Are surfaces lit as they are drawn, into the picture itself?
    pub lit_at_once: bool,
    /// Is each pixel's object kept beside the G-buffer?
    pub objects: bool,
    /// Format of depth.
    pub depth: wgpu::TextureFormat,
}

impl Targets {
    /// The depth of what is lit as it is drawn.
    pub fn forward_depth(&self) -> &wgpu::TextureView {
        self.lit_depth.as_ref().unwrap_or(&self.depth)
    }

    /// Makes them.
    ///
    /// # Errors
    /// [`RenderError::Size`] when the device's textures are smaller.
    pub fn new(
        device: &wgpu::Device,
        options: &RenderOptions,
        needs: &TargetNeeds,
    ) -> Result<Self, RenderError> {
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
        let deferred = needs.gbuffer;
        let samples = if needs.lit_at_once { options.samples } else { 1 };
        let output =
            make("output", format_of(options.view, options.colors_light()), 1, drawn | Usage::COPY_SRC);
        let read = drawn | Usage::TEXTURE_BINDING | Usage::COPY_SRC;
        let of_surfaces = if deferred { 1 } else { samples };
        let depth = make("depth", needs.depth, of_surfaces, if deferred { read } else { drawn });
        let lit_depth =
            (deferred && needs.lit_at_once).then(|| make("lit depth", needs.depth, samples, drawn));
        let gbuffer = deferred.then(|| make("gbuffer", GBUFFER, 1, read));
        let view = |texture: &wgpu::Texture| texture.create_view(&Default::default());
        Ok(Self {
            output_view: output.create_view(&Default::default()),
            depth: view(&depth),
            depth_only: deferred.then(|| {
                depth.create_view(&wgpu::TextureViewDescriptor {
                    aspect: wgpu::TextureAspect::DepthOnly,
                    ..Default::default()
                })
            }),
            lit_depth: lit_depth.as_ref().map(view),
            objects: (deferred && needs.objects)
                .then(|| view(&make("objects", OBJECT, 1, drawn | Usage::TEXTURE_BINDING))),
            gbuffer: gbuffer.as_ref().map(view),
            multisampled: (samples > 1).then(|| view(&make("samples", COLOR, samples, drawn))),
            surfaces: gbuffer.map(|gbuffer| [gbuffer, depth]),
            output,
        })
    }
}
