//! How far an answer is from the truth, error by error. Every picture is a list of pixels, rows from the top.

mod distance;
mod errors;
mod flicker;
mod flip;
mod gap;
mod hidden;
mod penumbra;

pub use distance::distance_to_change;
pub use errors::{Errors, Judged, LEAST_REACH_PX};
pub use flicker::{Frame, flicker};
pub use flip::flip;
pub use gap::Contacts;
pub use hidden::hides_change;
pub use penumbra::Edges;

use crate::{Emitter, Ray, Rays, Seen};
use glam::{DVec3, Vec3};

/// Values of V* that differ by more than this are a change.
pub(crate) const CHANGE: f32 = 1e-3;

/// Grey of a colour: the mean of its channels.
pub(crate) fn grey(v: Vec3) -> f32 {
    (v.x + v.y + v.z) / 3.0
}

/// The ray from a surface to the light's middle.
pub(crate) fn to_light(rays: &Rays<'_>, emitter: &Emitter, seen: &Seen) -> Ray {
    let origin_world = seen.p_world + seen.normal_world.as_dvec3() * rays.offset_m();
    let to = emitter.center(origin_world);
    Ray { origin_world, way: to.way, from_m: 0.0, to_m: to.distance_m - rays.offset_m() }
}

/// Does a place lie on the plane of a surface, within a share of a pixel's width?
pub(crate) fn is_on_plane(seen: &Seen, p_world: DVec3, tolerance_m: f64) -> bool {
    (p_world - seen.p_world).dot(seen.normal_world.as_dvec3()).abs() <= tolerance_m
}
