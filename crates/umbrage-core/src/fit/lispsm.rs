//! Light-space perspective shadow maps (Wimmer, Scherzer and Purgathofer 2004, "Light Space Perspective Shadow Maps").
//!
//! The warp is a perspective along the eye's direction as the light sees it. Its centre lies before what is seen by
//! `n = (z_n + sqrt(z_n * z_f)) / sin(gamma)`, `gamma` the angle between the eye's and the light's direction: the choice
//! for which the greatest error is least. As `w = sin(gamma) * (y + n)` with `y` the distance on the image plane from
//! the nearest that is seen, `w` is the eye's depth with the light's share left out, and `sqrt(z_n * z_f)`. So it is
//! written here: nothing is divided by `sin(gamma)`, and where that goes to 0 the warp fades to none.
//!
//! A spot light's image plane is that of its own perspective, where rays are parallel. A pixel there is as large as
//! the eye's depth over the light's, `z / along`, and of the eye's depth over `along` the part that changes with the place
//! on the image plane is again the eye's direction across the light's axis.

use super::FitOptions;
use super::seen::Seen;
use super::window::Window;

/// The warp of the paper; `None` where there is none.
pub(super) fn window(seen: &Seen, options: &FitOptions) -> Option<Window> {
    let slope = seen.eye.forward.truncate();
    let nearest = seen.points.iter().map(|p| p.px).fold(f64::INFINITY, f64::min);
    let (low, high) = seen
        .hull
        .iter()
        .map(|q| slope.dot(*q))
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), d| (l.min(d), h.max(d)));
    let farthest = nearest + (high - low);
    let c = slope.extend(nearest - low + (nearest * farthest).sqrt());
    if c.is_finite() { Window::best(seen, c, options) } else { None }
}
