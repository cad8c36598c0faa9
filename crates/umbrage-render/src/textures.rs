//! Pictures on the GPU, with all their smaller sizes.

use crate::RenderOptions;
use std::collections::HashMap;
use umbrage_scene::{Image, Scene, TextureRef, Wrap};
use wgpu::util::TextureBlitter;

/// Is a picture colour, or are its numbers meant as they are?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Encoding {
    /// sRGB colour, decoded when sampled.
    Color,
    /// Plain numbers: normals, roughness.
    Data,
}

impl Encoding {
    fn format(self) -> wgpu::TextureFormat {
        match self {
            Self::Color => wgpu::TextureFormat::Rgba8UnormSrgb,
            Self::Data => wgpu::TextureFormat::Rgba8Unorm,
        }
    }
}

/// Textures and samplers of a scene, each made once.
#[derive(Debug)]
pub struct Textures {
    views: HashMap<(usize, Encoding), wgpu::TextureView>,
    samplers: HashMap<([Wrap; 2], bool), wgpu::Sampler>,
    white: wgpu::TextureView,
    plain: wgpu::Sampler,
}

fn address(wrap: Wrap) -> wgpu::AddressMode {
    match wrap {
        Wrap::Repeat => wgpu::AddressMode::Repeat,
        Wrap::Mirror => wgpu::AddressMode::MirrorRepeat,
        Wrap::Clamp => wgpu::AddressMode::ClampToEdge,
    }
}

fn sampler(device: &wgpu::Device, wrap: [Wrap; 2], linear: bool) -> wgpu::Sampler {
    let filter = if linear { wgpu::FilterMode::Linear } else { wgpu::FilterMode::Nearest };
    device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("material"),
        address_mode_u: address(wrap[0]),
        address_mode_v: address(wrap[1]),
        mag_filter: filter,
        min_filter: filter,
        mipmap_filter: if linear { wgpu::MipmapFilterMode::Linear } else { wgpu::MipmapFilterMode::Nearest },
        ..Default::default()
    })
}

/// Uploads a picture and lets the GPU make its smaller sizes.
fn upload(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    encoder: &mut wgpu::CommandEncoder,
    image: &Image,
    encoding: Encoding,
) -> wgpu::TextureView {
    let size = wgpu::Extent3d { width: image.width, height: image.height, depth_or_array_layers: 1 };
    let levels = size.max_mips(wgpu::TextureDimension::D2);
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some(&image.name),
        size,
        mip_level_count: levels,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: encoding.format(),
        usage: wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_DST
            | wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    });
    write(queue, &texture, 0, image);
    let level = |base_mip_level| {
        texture.create_view(&wgpu::TextureViewDescriptor {
            base_mip_level,
            mip_level_count: Some(1),
            ..Default::default()
        })
    };
    if levels > 1 {
        let blitter = wgpu::util::TextureBlitterBuilder::new(device, encoding.format())
            .sample_type(wgpu::FilterMode::Linear)
            .build();
        halve(device, encoder, &blitter, (1..levels).map(|smaller| (level(smaller - 1), level(smaller))));
    }
    texture.create_view(&Default::default())
}

fn halve(
    device: &wgpu::Device,
    encoder: &mut wgpu::CommandEncoder,
    blitter: &TextureBlitter,
    steps: impl Iterator<Item = (wgpu::TextureView, wgpu::TextureView)>,
) {
    for (from, to) in steps {
        blitter.copy(device, encoder, &from, &to);
    }
}

fn write(queue: &wgpu::Queue, texture: &wgpu::Texture, layer: u32, image: &Image) {
    queue.write_texture(
        wgpu::TexelCopyTextureInfo {
            texture,
            mip_level: 0,
            origin: wgpu::Origin3d { x: 0, y: 0, z: layer },
            aspect: wgpu::TextureAspect::All,
        },
        &image.rgba,
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * image.width), rows_per_image: None },
        wgpu::Extent3d { width: image.width, height: image.height, depth_or_array_layers: 1 },
    );
}

impl Textures {
    /// Uploads every picture that a material of the scene uses.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, scene: &Scene) -> Self {
        let mut encoder =
            device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("textures") });
        let white = Image { name: "white".into(), width: 1, height: 1, rgba: vec![255; 4] };
        let white = upload(device, queue, &mut encoder, &white, Encoding::Data);
        let mut textures = Self {
            views: HashMap::new(),
            samplers: HashMap::new(),
            white,
            plain: sampler(device, [Wrap::Clamp; 2], false),
        };
        for material in &scene.materials {
            for (texture, encoding) in [
                (material.base_color_texture, Encoding::Color),
                (material.emissive_texture, Encoding::Color),
                (material.metallic_roughness_texture, Encoding::Data),
                (material.normal_texture, Encoding::Data),
            ] {
                let Some(texture) = texture else { continue };
                textures.views.entry((texture.image, encoding)).or_insert_with(|| {
                    upload(device, queue, &mut encoder, &scene.images[texture.image], encoding)
                });
                let key = (texture.wrap, texture.linear);
                textures.samplers.entry(key).or_insert_with(|| sampler(device, texture.wrap, texture.linear));
            }
        }
        queue.submit([encoder.finish()]);
        textures
    }

    /// View and sampler of a texture, or of plain white.
    pub fn get(
        &self,
        texture: Option<TextureRef>,
        encoding: Encoding,
    ) -> (&wgpu::TextureView, &wgpu::Sampler) {
        let found = texture.and_then(|texture| {
            let view = self.views.get(&(texture.image, encoding))?;
            Some((view, self.samplers.get(&(texture.wrap, texture.linear))?))
        });
        found.unwrap_or((&self.white, &self.plain))
    }
}

/// The slides of all lights in one array. A slide fills its light's cone whatever its shape, so each is scaled to the
/// square layer.
pub fn slides(device: &wgpu::Device, queue: &wgpu::Queue, images: &[&Image]) -> wgpu::TextureView {
    let side = images.iter().map(|i| i.width.max(i.height)).max().unwrap_or(1).clamp(1, 2048);
    let layers = images.len().max(1) as u32;
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("slides"),
        size: wgpu::Extent3d { width: side, height: side, depth_or_array_layers: layers },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: Encoding::Color.format(),
        usage: wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_DST
            | wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    for (layer, image) in images.iter().enumerate() {
        if image.width == side && image.height == side {
            write(queue, &texture, layer as u32, image);
            continue;
        }
        let from = upload(device, queue, &mut encoder, image, Encoding::Color);
        let to = texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2),
            base_array_layer: layer as u32,
            array_layer_count: Some(1),
            ..Default::default()
        });
        let blitter = wgpu::util::TextureBlitterBuilder::new(device, Encoding::Color.format())
            .sample_type(wgpu::FilterMode::Linear)
            .build();
        blitter.copy(device, &mut encoder, &from, &to);
    }
    queue.submit([encoder.finish()]);
    texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        ..Default::default()
    })
}

/// The given V of all lights in one array; without any, a texel that no shader reads.
pub fn given(device: &wgpu::Device, queue: &wgpu::Queue, options: &RenderOptions) -> wgpu::TextureView {
    let layers = options.given.as_ref().map_or(&[][..], |given| &given.of_light);
    let [width, height] = if layers.is_empty() { [1, 1] } else { options.size.to_array() };
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("given V"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: layers.len().max(1) as u32 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba32Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for (z, v) in (0..).zip(layers) {
        let texels: Vec<[f32; 4]> = v.iter().map(|v| v.extend(1.0).to_array()).collect();
        queue.write_texture(
            wgpu::TexelCopyTextureInfo {
                texture: &texture,
                mip_level: 0,
                origin: wgpu::Origin3d { x: 0, y: 0, z },
                aspect: wgpu::TextureAspect::All,
            },
            bytemuck::cast_slice(&texels),
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(16 * width), rows_per_image: None },
            wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        );
    }
    texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        ..Default::default()
    })
}
