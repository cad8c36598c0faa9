//! Fits: from a light and what it may shadow to the view that draws its map. No fit ever sees a GPU.

mod adaptive;
mod convex;
mod directional;
mod lispsm;
mod mask;
mod mask_options;
mod perspective;
mod places;
mod point;
mod seen;
mod spot;
mod window;

pub use mask::{MaskView, Region, fit_mask};
pub use mask_options::{Frame, MaskError, MaskOptions, Ratios};
pub use places::{PlacedViews, fit_places};

use crate::bounds::Aabb;
use crate::camera::Camera;
use crate::density::{Density, Raster, texels_per_metre};
use crate::depth::DEPTH;
use crate::frustum::Frustum;
use crate::light::{Light, LightError, LightKind};
use crate::lookup::{TextureOrigin, texture_from_world};
use crate::technique::Projection;
use glam::{Mat4, UVec2, Vec3};
use seen::Seen;

/// One view of a light: all that a pass needs to draw a map and a shader to look it up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadowView {
    /// World to the light's own space (it looks along -Z).
    pub light_from_world: Mat4,
    /// The light's space to clip space, depth as [`DEPTH`] says. Off centre or warped where the fit follows the eye.
    pub clip_from_light: Mat4,
    /// Where the map begins, metres from the light along its axis.
    pub near_m: f32,
    /// Where the map ends, metres from the light along its axis.
    pub far_m: f32,
    /// Width of a texel at distance 1 m for a cone; at any distance for parallel light. Metres. Where texels differ
    /// (see [`ShadowView::texel_density`]) that of the widest, along its longer side.
    pub texel_m: f32,
    /// Do rays come from a place, so that texels grow with distance? Says nothing of a warp.
    pub perspective: bool,
    /// How the view is laid around the scene: what was asked for, or what it fell back to.
    pub projection: Projection,
    /// Why `projection` is not what was asked for; `None` when it is.
    pub fallback: Option<Fallback>,
}

impl ShadowView {
    /// Is it warped towards the eye, so that near and far do not tell distance from stored depth?
    pub fn is_warped(&self) -> bool {
        matches!(self.projection, Projection::Perspective | Projection::LightSpacePerspective)
    }

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

    /// What may cast into the view: all before the light, but for what lies before a near plane that was asked for.
    pub fn caster_frustum(&self, light: &Light) -> Frustum {
        match light.near_m {
            Some(_) => self.frustum(),
            None => Frustum::from_clip_without_near(self.clip_from_world(), DEPTH),
        }
    }

    /// Texels in a metre of a surface with `normal_world` (unit length) at `p_world`, in a map of `size_texel` a side:
    /// exact for every projection. Whether the map shows the point is not asked.
    pub fn texel_density(&self, p_world: Vec3, normal_world: Vec3, size_texel: u32) -> Density {
        texels_per_metre(&self.raster(size_texel), p_world, normal_world)
    }

    /// The map as something that has texels, for [`crate::density`].
    pub fn raster(&self, size_texel: u32) -> Raster {
        Raster::new(self.clip_from_world(), UVec2::splat(size_texel))
    }

    /// By how much stored depth (0..1) changes for a metre along the light's ray at `p_world`. A map of n bits has steps
    /// of `1 / (2^n - 1)`; a float map has steps of its own size times 6e-8.
    pub fn depth_per_metre(&self, p_world: Vec3) -> f64 {
        let p_light = self.light_from_world.as_dmat4().transform_point3(p_world.as_dvec3());
        let way = if self.perspective { p_light.normalize_or_zero() } else { glam::DVec3::NEG_Z };
        let clip_from_light = self.clip_from_light.as_dmat4();
        let (p, d) = (clip_from_light * p_light.extend(1.0), clip_from_light * way.extend(0.0));
        ((d.z - p.z * (d.w / p.w)) / p.w).abs()
    }

    /// Width of a texel, metres, on a surface that faces the light at `distance_m` along the axis: where texels differ,
    /// no texel is wider.
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
    /// How the view is laid around the scene. Default: [`Projection::Fitted`], which needs no eye.
    pub projection: Projection,
    /// For whom the picture is. Fits other than [`Projection::Fitted`] keep only what it sees, so a map that several
    /// eyes use, or that outlives the eye's next move, must not have one. Default: none.
    pub eye: Option<Eye>,
    /// How many texels stay free on each side of what the map is for, so that no filter has to leave it: the filter's reach and
    /// one more. At most an eighth of the map is taken. 0 or more, default 2.
    pub border_texel: f32,
}

impl FitOptions {
    /// How much wider the map is than what it is for.
    fn widened(&self) -> f32 {
        1.0 / (1.0 - 2.0 * (self.border_texel / self.size_texel.max(1) as f32).min(0.125))
    }
}

impl Default for FitOptions {
    /// Fitted, for a float map of 2048 texels.
    fn default() -> Self {
        Self {
            size_texel: 2048,
            least_near: 1e-4,
            projection: Projection::Fitted,
            eye: None,
            border_texel: 2.0,
        }
    }
}

/// From where, and how, the picture is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eye {
    /// The camera.
    pub camera: Camera,
    /// Width of the picture over its height, above 0.
    pub aspect: f32,
}

/// Why a light's view is laid more plainly around the scene than was asked for. Nothing is wrong with such a view.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, thiserror::Error)]
#[non_exhaustive]
pub enum Fallback {
    /// There is no eye to follow, or its numbers are not usable.
    #[error("no eye is known")]
    NoEye,
    /// Nothing that the eye sees lies in the light's reach.
    #[error("the eye sees nothing that the light reaches")]
    NothingSeen,
    /// A parallel eye has pixels of one size, so a warp has nothing to even out.
    #[error("a parallel camera sees everything in one size")]
    ParallelEye,
    /// The warp would leave the worst pixel no more texels: eye and light look along each other, or all is equally far.
    #[error("a warp brings nothing from here")]
    NoGain,
    /// The six tiles of a point light lie along the world's axes.
    #[error("the tiles of a point light follow no eye")]
    Tiles,
    /// Sizes or distances too different for single precision.
    #[error("single precision cannot hold the view that follows the eye")]
    OutOfNumbers,
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

/// Fits the one view of a spot or directional light around boxes in world space: those of all casters and receivers.
///
/// Fits that follow the eye keep every receiver that it sees, and all casters on rays from the light to those.
/// Where they are not possible or bring nothing the next plainer one is taken, and [`ShadowView::fallback`] says why.
/// Cost on the CPU: proportional to the number of boxes; some microseconds for each where the view follows an eye.
///
/// # Errors
/// See [`FitError`]; each says what the caller may do. A point light has no single view: see [`fit_all`].
pub fn fit(light: &Light, bounds_world: &[Aabb], options: &FitOptions) -> Result<ShadowView, FitError> {
    light.check()?;
    let fitted = match light.kind {
        LightKind::Spot { outer_rad, .. } => spot::fit(light, outer_rad, bounds_world, options)?,
        LightKind::Directional => directional::fit(light, bounds_world, options)?,
        LightKind::Point => return Err(FitError::NoView("point")),
    };
    if options.projection == Projection::Fitted {
        return Ok(fitted);
    }
    let followed = match &options.eye {
        None => Err(Fallback::NoEye),
        Some(eye) => Seen::new(light, bounds_world, eye, options),
    };
    Ok(match followed {
        Ok(seen) => follow(&seen, options)
            .filter(is_usable)
            .unwrap_or(ShadowView { fallback: Some(Fallback::OutOfNumbers), ..fitted }),
        Err(why) => ShadowView { fallback: Some(why), ..fitted },
    })
}

/// A warp counts as a gain from this factor of least density on.
const GAIN: f64 = 1.02;

/// The view that follows the eye.
fn follow(seen: &Seen, options: &FitOptions) -> Option<ShadowView> {
    let adaptive = adaptive::window(seen, options)?;
    let warp = match options.projection {
        Projection::Perspective => perspective::window,
        Projection::LightSpacePerspective => lispsm::window,
        _ => return Some(adaptive.view(seen, Projection::Adaptive, options)),
    };
    let plain =
        |why| Some(ShadowView { fallback: Some(why), ..adaptive.view(seen, Projection::Adaptive, options) });
    if seen.eye.parallel {
        return plain(Fallback::ParallelEye);
    }
    match warp(seen, options) {
        Some(warped) if warped.least > GAIN * adaptive.least => {
            Some(warped.view(seen, options.projection, options))
        }
        _ => plain(Fallback::NoGain),
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
/// Has it numbers that single precision can hold?
fn is_usable(view: &ShadowView) -> bool {
    let matrix = view.clip_from_world();
    matrix.is_finite() && matrix.as_dmat4().determinant() != 0.0 && view.near_m < view.far_m
}

#[cfg(test)]
#[path = "follow_tests.rs"]
mod tests;
