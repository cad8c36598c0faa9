//! Fits: from a light and what it may shadow to the view that draws its map. No fit ever sees a GPU.

mod directional;
mod point;
mod spot;

use crate::bounds::Aabb;
use crate::depth::DEPTH;
use crate::frustum::Frustum;
use crate::light::{Light, LightError, LightKind};
use crate::lookup::{TextureOrigin, texture_from_world};
use glam::Mat4;

/// One view of a light: all that a pass needs to draw a map and a shader to look it up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadowView {
    /// World to the light's own space (it looks along -Z).
    pub light_from_world: Mat4,
    /// The light's space to clip space, depth as [`DEPTH`] says.
    pub clip_from_light: Mat4,
    /// Where the map begins, metres from the light along its axis.
    pub near_m: f32,
    /// Where the map ends, metres from the light along its axis.
    pub far_m: f32,
    /// Width of a texel at distance 1 m for a cone; at any distance for parallel light. Metres.
    pub texel_m: f32,
    /// Do texels grow with distance?
    pub perspective: bool,
}

impl ShadowView {
    /// World to clip space.
    pub fn clip_from_world(&self) -> Mat4 {
        self.clip_from_light * self.light_from_world
    }

    /// The lookup matrix without any bias: world space to the map's uv (rows down) and stored depth.
    pub fn texture_from_world(&self) -> Mat4 {
        texture_from_world(self.clip_from_world(), DEPTH, TextureOrigin::TopLeft)
    }

    /// What the view can see.
    pub fn frustum(&self) -> Frustum {
        Frustum::from_clip(self.clip_from_world(), DEPTH)
    }

    /// Width of a texel, metres, on a surface that faces the light at `distance_m` along the axis.
    pub fn texel_size_m(&self, distance_m: f32) -> f32 {
        if self.perspective { self.texel_m * distance_m } else { self.texel_m }
    }
}

/// What a fit may choose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FitOptions {
    /// Width and height of the map, texels, 1 or more.
    pub size_texel: u32,
    /// The near plane never comes closer than this share of the far plane's distance. It bounds the loss of
    /// precision of coarse depth formats; casters closer to the light are cut off. 0..1.
    pub least_near: f32,
    /// How far a filter reaches, texels: the map is so much wider on each side than what it is for, so that no lookup has to
    /// leave it. At most a quarter of the map. 0 or more.
    pub border_texel: f32,
}

impl FitOptions {
    /// How much wider the map is than what it is for.
    fn widened(&self) -> f32 {
        1.0 / (1.0 - 2.0 * (self.border_texel / self.size_texel.max(1) as f32).min(0.25))
    }
}

/// Why a light got no view.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// The light itself is not usable.
    #[error(transparent)]
    Light(#[from] LightError),
    /// No caster or receiver lies in the light's reach: there is nothing to draw and all is lit.
    #[error("nothing lies in the light's reach")]
    NothingInReach,
    /// One view cannot hold what this kind of light lights.
    #[error("a {0} light has no single view; fit all of its views")]
    NoView(&'static str),
}

/// Fits the one view of a spot or directional light around boxes in world space.
///
/// # Errors
/// See [`FitError`]; each says what the caller may do. A point light has no single view: see [`fit_all`].
pub fn fit(light: &Light, bounds_world: &[Aabb], options: &FitOptions) -> Result<ShadowView, FitError> {
    light.check()?;
    match light.kind {
        LightKind::Spot { outer_rad, .. } => spot::fit(light, outer_rad, bounds_world, options),
        LightKind::Directional => directional::fit(light, bounds_world, options),
        LightKind::Point => Err(FitError::NoView("point")),
    }
}

/// Fits all views of a light around boxes in world space: one, or the six tiles of a point light in the order +X, -X, +Y, -Y,
/// +Z, -Z of world space (`umbrage_face` in `wgsl/face.wgsl` picks among them).
///
/// # Errors
/// See [`FitError`].
pub fn fit_all(
    light: &Light,
    bounds_world: &[Aabb],
    options: &FitOptions,
) -> Result<Vec<ShadowView>, FitError> {
    light.check()?;
    match light.kind {
        LightKind::Point => point::tiles(light, bounds_world, options),
        _ => Ok(vec![fit(light, bounds_world, options)?]),
    }
}
