//! The transform chain of a shadow lookup: from a point in object, world or eye space to a texel and a depth.
//!
//! `texture_from_world = S * clip_from_light * light_from_world`, where S, the scale-bias matrix, turns clip space
//! into texture space: after division by w, x and y are the place in the map (0..1) and z is what the map stores.
//! (Segal and others 1992, "Fast Shadows and Lighting Effects Using Texture Mapping"; Everitt, Rege and Cebenoyan
//! 2001, "Hardware Shadow Mapping", "Setting Up the Transformations".) All of it is linear before the division, so
//! it may be evaluated per vertex and interpolated with perspective, or per pixel: the results are the same.

use crate::depth::DepthConvention;
use glam::{Mat4, UVec2, Vec2, Vec3, Vec4};

/// Which corner of the map is (0, 0).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextureOrigin {
    /// WebGPU, Direct3D, Metal, and Vulkan where its viewport has a negative height: rows run down, clip-space y runs up.
    TopLeft,
    /// OpenGL: both run up.
    BottomLeft,
}

/// Where the centre of a texel lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TexelCenter {
    /// Everything since Direct3D 10: the centre of texel 0 is at 0.5 / size, for the rasteriser and the sampler.
    Half,
    /// Direct3D 9: the rasteriser puts pixel centres on whole numbers, so what it draws lands half a texel
    /// up and left of where the sampler looks for it.
    Direct3d9,
}

/// The scale-bias matrix S: clip space to texture space.
pub fn texture_from_clip(depth: DepthConvention, origin: TextureOrigin) -> Mat4 {
    let y = match origin {
        TextureOrigin::TopLeft => -0.5,
        TextureOrigin::BottomLeft => 0.5,
    };
    let (z_scale, z_offset) = match depth {
        DepthConvention::OpenGl => (0.5, 0.5),
        DepthConvention::ZeroToOne | DepthConvention::Reversed => (1.0, 0.0),
    };
    Mat4::from_cols(
        Vec4::new(0.5, 0.0, 0.0, 0.0),
        Vec4::new(0.0, y, 0.0, 0.0),
        Vec4::new(0.0, 0.0, z_scale, 0.0),
        Vec4::new(0.5, 0.5, z_offset, 1.0),
    )
}

/// The half-texel correction that goes left of S for a `size` texel map.
pub fn texel_center_offset(center: TexelCenter, size_texel: UVec2) -> Mat4 {
    match center {
        TexelCenter::Half => Mat4::IDENTITY,
        TexelCenter::Direct3d9 => Mat4::from_translation((0.5 / size_texel.as_vec2()).extend(0.0)),
    }
}

/// A uniform bias in the lookup matrix: moves every receiver towards the light by `bias_depth` of stored depth
/// (0..1, the whole depth range is 1) after the division.
///
/// It knows nothing of slope, so it must be as large as the steepest receiver needs and leaks where that is more
/// than the caster's distance (Everitt, Rege and Cebenoyan 2001, "Why Is Polygon Offset Needed?").
pub fn matrix_bias(bias_depth: f32, depth: DepthConvention) -> Mat4 {
    Mat4::from_translation(Vec3::new(0.0, 0.0, -depth.away() * bias_depth))
}

/// World space to texture space.
pub fn texture_from_world(clip_from_world: Mat4, depth: DepthConvention, origin: TextureOrigin) -> Mat4 {
    texture_from_clip(depth, origin) * clip_from_world
}

/// Object space to texture space: for one lookup matrix an object, evaluated per vertex.
pub fn texture_from_object(texture_from_world: Mat4, world_from_object: Mat4) -> Mat4 {
    texture_from_world * world_from_object
}

/// Eye space to texture space: for renderers that keep their surfaces in eye space.
pub fn texture_from_view(texture_from_world: Mat4, world_from_view: Mat4) -> Mat4 {
    texture_from_world * world_from_view
}

/// A point in texture space, divided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Located {
    /// Place in the map, 0..1 when inside.
    pub uv: Vec2,
    /// Depth in the convention of the map, 0..1 when between near and far.
    pub depth: f32,
    /// Inside the map and in front of the light. Behind the light the division would show a phantom: the point
    /// mirrored through the light.
    pub inside: bool,
}

/// Applies a lookup matrix to a point of the space that it comes from.
pub fn locate(texture_from_here: &Mat4, p_here: Vec3) -> Located {
    let p = *texture_from_here * p_here.extend(1.0);
    let inside = p.w > 0.0;
    let p = p / if inside { p.w } else { 1.0 };
    let uv = Vec2::new(p.x, p.y);
    Located { uv, depth: p.z, inside: inside && uv.cmpge(Vec2::ZERO).all() && uv.cmple(Vec2::ONE).all() }
}

/// The texel that holds a place of the map: whole numbers, clamped to the map.
pub fn texel_at(uv: Vec2, size_texel: UVec2) -> UVec2 {
    (uv * size_texel.as_vec2()).floor().max(Vec2::ZERO).as_uvec2().min(size_texel - UVec2::ONE)
}

/// The place of a texel's centre in the map.
pub fn texel_center(texel: UVec2, size_texel: UVec2) -> Vec2 {
    (texel.as_vec2() + 0.5) / size_texel.as_vec2()
}

#[cfg(test)]
#[path = "lookup_tests.rs"]
mod tests;
