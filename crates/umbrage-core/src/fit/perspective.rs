//! Perspective shadow maps: the map is drawn in the space that the eye's own projection leaves (Stamminger and Drettakis
//! 2002, "Perspective Shadow Maps").
//!
//! There the light is at `L`, what is seen lies in a unit cube, and the map is the view from `L` towards the cube's
//! middle. What of that view reaches the texels is its plane through `L` across the way to the middle: `w` is 0 on it.
//! Pulled back through the eye's projection this plane goes through the light, so it is a line on the light's image plane:
//! the `c` of [`Window`](super::window::Window). The paper's singular cases go away with it:
//!
//! - A light behind the eye has an `L` of negative `w`, and depth along its rays runs the wrong way. The plane is the
//!   same, and depth is the light's own.
//! - A light in the plane of the eye has its `L` at infinity. The plane is then found as the limit, without division.
//! - An eye far too close to something spends the whole map on it. The paper moves the eye back; here several such moves
//!   are tried, and that with the greatest least density is taken.

use super::FitOptions;
use super::seen::Seen;
use super::window::Window;
use glam::{DMat4, DVec3, DVec4};

/// How far back the eye is moved, in units of the geometric mean of what it sees nearest and farthest.
const MOVES: [f64; 10] = [0.0, 0.03, 0.1, 0.2, 0.4, 0.7, 1.0, 2.0, 4.0, 10.0];

/// The best warp; `None` where there is none.
pub(super) fn window(seen: &Seen, options: &FitOptions) -> Option<Window> {
    let depths = seen.points.iter().map(|p| seen.eye.depth(p.p));
    let (near, far) = depths.fold((f64::INFINITY, 0.0f64), |(n, f), d| (n.min(d), f.max(d)));
    let mean = (near.max(far * 1e-6) * far).sqrt();
    let warps = MOVES.iter().filter_map(|back| c_of(seen, back * mean, near, far));
    let windows = warps.filter_map(|c| Window::best(seen, c, options));
    windows.max_by(|a, b| a.least.total_cmp(&b.least))
}

/// The line on the image plane where `w` is 0, for the eye moved back by so many metres.
fn c_of(seen: &Seen, back: f64, near: f64, far: f64) -> Option<DVec3> {
    let eye = &seen.eye;
    let origin = eye.position - eye.forward * back;
    let far = far + back;
    let near = (near + back).clamp(far * 1e-6, far * (1.0 - 1e-6));
    let row = |axis: DVec3, scale: f64| (axis * scale).extend(-axis.dot(origin) * scale);
    let depth = row(eye.forward, 1.0);
    // Depth from -1 to 1, as in the paper.
    let z = depth * ((far + near) / (far - near)) - DVec4::W * (2.0 * far * near / (far - near));
    let post_from_light =
        DMat4::from_cols(row(eye.right, 1.0 / eye.half.x), row(eye.up, 1.0 / eye.half.y), z, depth)
            .transpose();

    let places = seen.points.iter().map(|p| post_from_light.project_point3(p.p));
    let (low, high) = places.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(a, b), p| (a.min(p), b.max(p)));
    let middle = 0.5 * (low + high);
    let spot = seen.space.tan_outer.is_some();
    let light = post_from_light * if spot { DVec4::W } else { DVec4::Z };
    let light = light / light.abs().max_element();
    // From the light to the middle, without dividing by the light's w; the plane across it through the light.
    let way = middle * light.w - light.truncate();
    let plane = (way * light.w).extend(-way.dot(light.truncate()));
    let pulled = post_from_light.transpose() * plane;
    // It goes through the light, so one of the four numbers is 0.
    let c = if spot {
        DVec3::new(pulled.x, pulled.y, -pulled.z)
    } else {
        DVec3::new(pulled.x, pulled.y, pulled.w)
    };
    c.is_finite().then_some(c)
}
