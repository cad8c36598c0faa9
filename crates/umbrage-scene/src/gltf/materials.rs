//! Surfaces: factors, and which picture lies where on them.

use super::document::{Document, label};
use super::uri::shown;
use crate::{AlphaMode, Material, Reflectance, TextureRef, Wrap};
use glam::{Affine2, Vec2, Vec3, Vec4};
use gltf::json::Index;
use gltf::json::extensions::texture::TextureTransform;
use gltf::json::material::AlphaMode as JsonAlpha;
use gltf::json::texture::{Info, MagFilter, Sampler, Texture, WrappingMode};
use gltf::json::validation::Checked;

/// Reads a material. Its textures' `image` is the file's own number; see [`super::images`].
pub(super) fn read(
    document: &Document<'_>,
    index: usize,
    warnings: &mut Vec<String>,
) -> Result<Material, String> {
    let json = &document.root.materials[index];
    let pbr = &json.pbr_metallic_roughness;
    let place = label("material", index, json.name.as_ref());
    let mut texture = |info: &Option<Info>| match info {
        Some(info) => {
            let transform = info.extensions.as_ref().and_then(|e| e.texture_transform.as_ref());
            texture(document, info.index, info.tex_coord, transform, &place, warnings)
        }
        None => Ok(None),
    };
    let base_color_texture = texture(&pbr.base_color_texture)?;
    let metallic_roughness_texture = texture(&pbr.metallic_roughness_texture)?;
    let emissive_texture = texture(&json.emissive_texture)?;
    let normal_texture = normal_texture(document, index, warnings)?;
    let strength = json.extensions.as_ref().and_then(|e| e.others.get("KHR_materials_emissive_strength"));
    let strength = strength.and_then(|s| s.get("emissiveStrength")).and_then(serde_json::Value::as_f64);
    Ok(Material {
        name: json.name.clone().unwrap_or_default(),
        base_color: finite4(pbr.base_color_factor.0),
        base_color_texture,
        reflectance: Reflectance::MetallicRoughness {
            metallic: unit(pbr.metallic_factor.0),
            roughness: unit(pbr.roughness_factor.0),
        },
        metallic_roughness_texture,
        normal_texture,
        normal_scale: json.normal_texture.as_ref().map_or(1.0, |n| n.scale).clamp(-1e6, 1e6),
        emissive: (Vec3::from(json.emissive_factor.0) * strength.unwrap_or(1.0) as f32)
            .clamp(Vec3::ZERO, Vec3::splat(1e6)),
        emissive_texture,
        alpha: match json.alpha_mode {
            Checked::Valid(JsonAlpha::Opaque) => AlphaMode::Opaque,
            Checked::Valid(JsonAlpha::Mask) => {
                AlphaMode::Mask { cutoff: json.alpha_cutoff.unwrap_or_default().0.clamp(0.0, 1e6) }
            }
            Checked::Valid(JsonAlpha::Blend) => AlphaMode::Blend,
            Checked::Invalid => {
                return Err(format!("{place}: its alphaMode is none of OPAQUE, MASK and BLEND"));
            }
        },
        double_sided: json.double_sided,
        unlit: json.extensions.as_ref().is_some_and(|e| e.unlit.is_some()),
    })
}

/// A primitive without a material. glTF's own default is a pure metal, which without surroundings to mirror is black;
/// the toolkit's matte white shows shadows.
pub(super) fn unnamed() -> Material {
    Material::default()
}

/// The normal map of a material, for those who need only that.
pub(super) fn normal_texture(
    document: &Document<'_>,
    index: usize,
    warnings: &mut Vec<String>,
) -> Result<Option<TextureRef>, String> {
    let json = &document.root.materials[index];
    let Some(normal) = &json.normal_texture else { return Ok(None) };
    let place = label("material", index, json.name.as_ref());
    // The parser knows the transform of ordinary textures only.
    let transform = normal.extensions.as_ref().and_then(|e| e.others.get("KHR_texture_transform"));
    let transform = match transform {
        Some(value) => Some(
            serde_json::from_value::<TextureTransform>(value.clone())
                .map_err(|e| format!("{place}: KHR_texture_transform of its normal map: {e}; correct it"))?,
        ),
        None => None,
    };
    texture(document, normal.index, normal.tex_coord, transform.as_ref(), &place, warnings)
}

fn unit(value: f32) -> f32 {
    if value.is_nan() { 1.0 } else { value.clamp(0.0, 1.0) }
}

fn finite4(color: [f32; 4]) -> Vec4 {
    Vec4::from(color).clamp(Vec4::ZERO, Vec4::splat(1e6))
}

fn texture(
    document: &Document<'_>,
    index: Index<Texture>,
    tex_coord: u32,
    transform: Option<&TextureTransform>,
    place: &str,
    warnings: &mut Vec<String>,
) -> Result<Option<TextureRef>, String> {
    let json = &document.root.textures[index.value()];
    let Some(image) =
        image_of(document, json).map_err(|e| format!("{place}, texture {}: {e}", index.value()))?
    else {
        warnings
            .push(format!("{place}: texture {} has no image of a known kind; it is left out", index.value()));
        return Ok(None);
    };
    let uv_set = transform.and_then(|t| t.tex_coord).unwrap_or(tex_coord);
    if uv_set > 1 {
        warnings.push(format!(
            "{place}: a texture uses TEXCOORD_{uv_set}; only 0 and 1 are known, it is left out"
        ));
        return Ok(None);
    }
    let sampler = json.sampler.map(|sampler| &document.root.samplers[sampler.value()]);
    Ok(Some(TextureRef {
        image,
        wrap: sampler.map_or([Wrap::Repeat; 2], |s| [wrap(s.wrap_s), wrap(s.wrap_t)]),
        linear: sampler.is_none_or(is_linear),
        uv_set,
        uv_from_texcoord: transform.map_or(Affine2::IDENTITY, uv_from_texcoord),
    }))
}

/// The image of a texture: the WebP one where there is one, else the one that every reader knows.
fn image_of(document: &Document<'_>, json: &Texture) -> Result<Option<usize>, String> {
    let webp = json.extensions.as_ref().and_then(|e| e.others.get("EXT_texture_webp"));
    let source = match webp.and_then(|webp| super::buffers::whole(webp, "source")) {
        Some(source) => source,
        None if json.source.value() == u32::MAX as usize => return Ok(None),
        None => json.source.value() as u64,
    };
    let count = document.root.images.len();
    match usize::try_from(source).ok().filter(|image| *image < count) {
        Some(image) => Ok(Some(image)),
        None => {
            Err(format!("image {source} does not exist, the file has {count}; correct or export it again"))
        }
    }
}

fn wrap(mode: Checked<WrappingMode>) -> Wrap {
    match mode {
        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
        _ => Wrap::Repeat,
    }
}

fn is_linear(sampler: &Sampler) -> bool {
    !matches!(sampler.mag_filter, Some(Checked::Valid(MagFilter::Nearest)))
}

/// Scale, then rotation, then offset. A positive angle turns the uv axes clockwise as seen with v downwards, which
/// turns the picture counter-clockwise.
fn uv_from_texcoord(transform: &TextureTransform) -> Affine2 {
    let all = Affine2::from_scale_angle_translation(
        Vec2::from(transform.scale.0),
        -transform.rotation.0,
        Vec2::from(transform.offset.0),
    );
    if all.is_finite() { all } else { Affine2::IDENTITY }
}

/// How messages name an image: by its name, its file, or its number.
pub(super) fn image_name(document: &Document<'_>, index: usize) -> String {
    let json = &document.root.images[index];
    let name = json.name.clone().filter(|name| !name.is_empty());
    name.or_else(|| json.uri.as_deref().map(|uri| shown(uri).into_owned()))
        .unwrap_or_else(|| format!("image {index}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quarter_turn_is_the_specifications_own_example() {
        // offset [0, 1], a quarter turn, half the size: the lower left quadrant of the picture.
        let transform: TextureTransform =
            serde_json::from_str(r#"{"offset":[0,1],"rotation":1.57079632679,"scale":[0.5,0.5]}"#).unwrap();
        let uv = uv_from_texcoord(&transform);
        for (texcoord, expected) in
            [(Vec2::ZERO, Vec2::Y), (Vec2::X, Vec2::new(0.0, 0.5)), (Vec2::Y, Vec2::new(0.5, 1.0))]
        {
            assert!((uv.transform_point2(texcoord) - expected).length() < 1e-5, "{texcoord}");
        }
    }
}
