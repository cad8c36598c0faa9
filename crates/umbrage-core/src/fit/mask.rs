//! Projective masks: one view for a light and one blocker, in which only the blocker's outline counts.
//!
//! What a blocker takes from a light behind it has the shape of its outline, seen from the light. So a mask holds that outline
//! alone, 1 where the blocker covers, and is laid over any number of receivers by the projection that it was drawn with
//! (Nagy 2000, "Real-Time Shadows on Complex Objects"; Blinn 1988, "Me and My (Fake) Shadow").
//!
//! The axis of the projection goes from the light to the blocker. Its window hugs the blocker, and a ring of texels around
//! it stays empty: a lookup outside of the mask is clamped to that ring and finds nothing.

use super::convex;
use super::mask_options::{Frame, MOST_SPAN_DEG, MaskError, MaskOptions, Ratios};
use crate::bounds::Aabb;
use crate::depth::DEPTH;
use crate::frustum::cone_may_see;
use crate::light::{Light, LightKind};
use crate::lookup::{TextureOrigin, texture_from_world};
use crate::projection::{orthographic, perspective};
use glam::{DMat3, DMat4, DVec2, DVec3, Mat4, Vec2, Vec3, Vec4};

/// Where a receiver is, seen along a mask's axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Region {
    /// Nearer than the blocker's nearest point, or behind the light: the blocker takes nothing from it.
    Before,
    /// As far away as some of the blocker: parts of the outline may lie behind the receiver, and darken it all the same.
    Beside,
    /// Farther than all of the blocker: the mask is exact.
    Beyond,
}

/// The view of one light on one blocker: all that a pass needs to draw the mask and a shader to lay it over receivers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaskView {
    /// World to the light's own space: it looks along -Z, which is the mask's axis. Parallel light has no place; its space
    /// begins before the blocker.
    pub light_from_world: Mat4,
    /// The light's space to clip space, depth as [`DEPTH`] says; the blocker's points are neither clipped nor in the border.
    pub clip_from_light: Mat4,
    /// Do rays come from a place?
    pub perspective: bool,
    /// Where the blocker begins, metres along the axis from the origin of the light's space.
    pub near_m: f32,
    /// Where the blocker ends, metres along the axis.
    pub far_m: f32,
    /// Middle of the window, right and up: tangents of angles from the axis, or metres for parallel light.
    pub center: Vec2,
    /// Half the width and height of what the outline may take up, without the border; in the unit of `center`.
    pub ratio: Vec2,
    /// Width and height of a texel, in the unit of `center`.
    pub texel: Vec2,
    /// Width and height of the mask, texels.
    pub size_texel: u32,
    /// Texels that stay empty on each side.
    pub border_texel: u32,
    /// Box around the blocker: nothing that a ray of light meets before it is darkened.
    pub bounds_world: Aabb,
}

/// What single precision may move a point by, as a share of its distance from the origin or of the mask's width: some ten
/// roundings of a matrix that multiplies it and of the mesh's transform before that.
const ROUNDING: f64 = 32.0 * f32::EPSILON as f64;

/// Room before the nearest and behind the farthest point, as a share of their distance, so that depth clips nothing.
const DEPTH_ROOM: f64 = 1e-3;

impl MaskView {
    /// World to clip space; what the pass draws with.
    pub fn clip_from_world(&self) -> Mat4 {
        (self.clip_from_light.as_dmat4() * self.light_from_world.as_dmat4()).as_mat4()
    }

    /// World to the mask's uv (rows down); w is the depth along the axis, or 1 for parallel light.
    pub fn texture_from_world(&self) -> Mat4 {
        texture_from_world(self.clip_from_world(), DEPTH, TextureOrigin::TopLeft)
    }

    /// `dot(depth_from_world, (p_world, 1))` is how far `p_world` lies along the axis, metres; below 0 behind the light.
    pub fn depth_from_world(&self) -> Vec4 {
        -self.light_from_world.row(2)
    }

    /// The light's place and 1, or the direction towards it and 0.
    pub fn light_point_world(&self) -> Vec4 {
        let world_from_light = self.light_from_world.inverse();
        if self.perspective { world_from_light.w_axis } else { world_from_light.z_axis }
    }

    /// Where a receiver is.
    pub fn region(&self, p_world: Vec3) -> Region {
        let depth_m = self.depth_from_world().dot(p_world.extend(1.0));
        // So that a number that is none is nowhere.
        if depth_m > self.far_m {
            Region::Beyond
        } else if depth_m >= self.near_m && depth_m.is_finite() {
            Region::Beside
        } else {
            Region::Before
        }
    }

    /// How many texels lie in the convex outline of `points_world`, which are in front of the light: how much of the mask the
    /// blocker has. A blocker with holes or dents covers fewer.
    ///
    /// Cost: a sort of the points.
    pub fn texels_on(&self, points_world: impl IntoIterator<Item = Vec3>) -> f64 {
        let clip_from_world = self.clip_from_world().as_dmat4();
        let place = |p: Vec3| {
            let clip = clip_from_world * p.as_dvec3().extend(1.0);
            0.5 * f64::from(self.size_texel) * DVec2::new(clip.x, clip.y) / clip.w
        };
        let outline = convex::hull(&points_world.into_iter().map(place).collect::<Vec<_>>());
        let next = outline.iter().cycle().skip(1);
        0.5 * outline.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum::<f64>()
    }
}

/// The axes of a mask as columns: right, up and forwards, all of unit length and at right angles, in world space. `forward` is
/// a unit vector.
///
/// The world's axis along which `forward` has its smallest component is never near parallel to it: that component is at
/// most 0.58, so the cross product has at least 0.81 of a unit.
fn axes(forward: DVec3) -> DMat3 {
    let size = forward.abs();
    let helper = if size.x <= size.y && size.x <= size.z {
        DVec3::X
    } else if size.y <= size.z {
        DVec3::Y
    } else {
        DVec3::Z
    };
    let right = forward.cross(helper).normalize();
    DMat3::from_cols(right, right.cross(forward), forward)
}

/// Fits the mask of a light and a blocker. `points_world` are the blocker's vertices, those of its convex hull, or the corners
/// of its box: anything whose hull holds it.
///
/// All of the hull is drawn within the free texels, with room for the rounding of single precision, at every size. The
/// light's near and far plane are those of its maps and are not asked for.
///
/// Cost on the CPU: four passes over the points.
///
/// # Errors
/// See [`MaskError`]. After [`MaskError::Unreached`] there is no shadow to draw; after all others a shadow map can
/// still draw it.
pub fn fit_mask(
    light: &Light,
    points_world: impl Iterator<Item = Vec3> + Clone,
    options: &MaskOptions,
) -> Result<MaskView, MaskError> {
    light.check()?;
    options.check()?;
    if let Some(bad) = points_world.clone().find(|p| !p.is_finite()) {
        return Err(MaskError::NotFinite(bad));
    }
    let bounds = Aabb::from_points(points_world.clone());
    if bounds.is_empty() {
        return Err(MaskError::NoPoints);
    }
    let points = points_world.map(Vec3::as_dvec3);
    if !reaches(light, &bounds, points.clone()) {
        return Err(MaskError::Unreached);
    }
    let perspective = light.kind != LightKind::Directional;
    let middle = 0.5 * (bounds.min.as_dvec3() + bounds.max.as_dvec3());
    let place = light.position_world.as_dvec3();
    let forward = match (perspective, options.frame) {
        (false, _) => light.direction_world.as_dvec3(),
        (true, Frame::Mean) => points.clone().map(|p| p - place).sum(),
        (true, Frame::Box) => middle - place,
    };
    // Without a direction the light is in the very middle.
    let forward = forward.try_normalize().ok_or(MaskError::TooNear)?;
    let back_off_m =
        (bounds.max.as_dvec3() - bounds.min.as_dvec3()).length().max(f64::from(f32::MIN_POSITIVE));
    let origin = if perspective { place } else { middle - forward * back_off_m };
    let axes = axes(forward);
    let seen = points.map(|p| axes.transpose() * (p - origin));
    let magnitude_m =
        bounds.corners().map(|p| p.as_dvec3().length()).into_iter().fold(origin.length(), f64::max);
    let extent = Extent::of(seen, perspective, magnitude_m)?;
    let (center, ratio) = extent.window(light, options)?;
    let view = view(origin, axes, perspective, &extent, (center, ratio), options)?;
    Ok(MaskView { bounds_world: bounds, ..view })
}

/// May light fall on any of the points?
fn reaches(light: &Light, bounds: &Aabb, mut points: impl Iterator<Item = DVec3>) -> bool {
    let place = light.position_world;
    let nearest_m = place.clamp(bounds.min, bounds.max).distance(place);
    if light.range_m.is_some_and(|range_m| light.kind != LightKind::Directional && nearest_m > range_m) {
        return false;
    }
    let LightKind::Spot { outer_rad, .. } = light.kind else { return true };
    let along = |p: DVec3| (p - place.as_dvec3()).dot(light.direction_world.as_dvec3());
    cone_may_see(place, light.direction_world.normalize(), outer_rad, bounds)
        && points.any(|p| along(p) > 0.0)
}

/// What the points take up of the light's view.
#[derive(Clone, Copy, Debug)]
struct Extent {
    low: DVec2,
    high: DVec2,
    near_m: f64,
    far_m: f64,
    /// How far rounding may move a point there.
    rounding: f64,
}

impl Extent {
    /// Of points in the light's own space, z forwards. Lengths that they are made of are up to `magnitude_m`.
    fn of(
        points: impl Iterator<Item = DVec3>,
        perspective: bool,
        magnitude_m: f64,
    ) -> Result<Self, MaskError> {
        let most = (0.5 * MOST_SPAN_DEG).to_radians().tan();
        let nothing = Self {
            low: DVec2::INFINITY,
            high: DVec2::NEG_INFINITY,
            near_m: f64::INFINITY,
            far_m: f64::NEG_INFINITY,
            rounding: 0.0,
        };
        let mut all = nothing;
        for p in points {
            let q = if perspective { p.truncate() / p.z } else { p.truncate() };
            if perspective && !(p.z > 0.0 && q.abs().max_element() <= most) {
                return Err(MaskError::TooNear);
            }
            all.low = all.low.min(q);
            all.high = all.high.max(q);
            all.near_m = all.near_m.min(p.z);
            all.far_m = all.far_m.max(p.z);
        }
        let farthest = all.low.abs().max(all.high.abs()).max_element();
        all.rounding = ROUNDING
            * if perspective {
                (1.0 + farthest) * (magnitude_m / all.near_m + 1.0)
            } else {
                magnitude_m + farthest
            };
        // A blocker that rounding could double is no outline.
        if all.rounding.is_finite() && (all.high - all.low).max_element() >= 2.0 * all.rounding {
            Ok(all)
        } else {
            Err(MaskError::OutOfNumbers)
        }
    }

    /// Middle and half size of the window, without the border.
    fn window(&self, light: &Light, options: &MaskOptions) -> Result<(DVec2, DVec2), MaskError> {
        let farthest = self.low.abs().max(self.high.abs());
        let (center, half) = match options.ratios {
            Ratios::Adaptive => (0.5 * (self.low + self.high), 0.5 * (self.high - self.low)),
            Ratios::Symmetric => (DVec2::ZERO, farthest),
            Ratios::Fixed => {
                let fixed = match light.kind {
                    LightKind::Spot { outer_rad, .. } => f64::from(outer_rad).tan(),
                    LightKind::Point => 1.0,
                    LightKind::Directional => f64::from(options.fixed_half_m),
                };
                let factor = (farthest.max_element() + self.rounding) / fixed;
                if factor > 1.0 {
                    return Err(MaskError::TooWide { factor });
                }
                return Ok((DVec2::ZERO, DVec2::splat(fixed)));
            }
        };
        // Seen edge-on a flat blocker has no width and covers no texel; the projection still needs one.
        Ok((center, half.max(DVec2::splat(1e-6 * half.max_element())) + self.rounding))
    }
}

fn view(
    origin: DVec3,
    axes: DMat3,
    is_perspective: bool,
    extent: &Extent,
    (center, ratio): (DVec2, DVec2),
    options: &MaskOptions,
) -> Result<MaskView, MaskError> {
    let size = f64::from(options.size_texel);
    // The places of a mask are rounded as well, by a share of its width.
    let half = ratio * (1.0 + ROUNDING) * size / (size - 2.0 * f64::from(options.border_texel));
    let world_from_light = DMat3::from_cols(axes.x_axis, axes.y_axis, -axes.z_axis);
    let light_from_world = DMat4::from_mat3(world_from_light.transpose()) * DMat4::from_translation(-origin);
    let least_m = DEPTH_ROOM * (extent.near_m.abs() + extent.far_m.abs()).max(f64::from(f32::MIN_POSITIVE));
    let near_m = if is_perspective { extent.near_m * (1.0 - DEPTH_ROOM) } else { extent.near_m - least_m };
    let (half, center) = (half.as_vec2(), center.as_vec2());
    let project = if is_perspective { perspective } else { orthographic };
    let mut clip_from_light = project(half.x, half.y, near_m as f32, (extent.far_m + least_m) as f32, DEPTH);
    let shift = center / half;
    if is_perspective {
        clip_from_light.z_axis += shift.extend(0.0).extend(0.0);
    } else {
        clip_from_light.w_axis -= shift.extend(0.0).extend(0.0);
    }
    let made = MaskView {
        light_from_world: light_from_world.as_mat4(),
        clip_from_light,
        perspective: is_perspective,
        near_m: extent.near_m as f32,
        far_m: extent.far_m as f32,
        center,
        ratio: ratio.as_vec2(),
        texel: 2.0 * half / options.size_texel as f32,
        size_texel: options.size_texel,
        border_texel: options.border_texel,
        bounds_world: Aabb::EMPTY,
    };
    let matrix = made.clip_from_world();
    if matrix.is_finite() && matrix.as_dmat4().determinant() != 0.0 {
        Ok(made)
    } else {
        Err(MaskError::OutOfNumbers)
    }
}

#[cfg(test)]
#[path = "mask_tests.rs"]
mod tests;
