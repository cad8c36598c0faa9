//! Every map that a light can have, and the best of some.
//!
//! All points on one ray of a light share a texel. So a map's place is a function of the ray's place `q` on the light's
//! image plane alone, and a projective one: `x = a.(q, 1) / c.(q, 1)`, `y = b.(q, 1) / c.(q, 1)`. Fitted and adaptive
//! maps have a constant `c`; all perspective shadow maps differ from them, and from each other, in `c` alone, but for
//! shift, scale, turn and shear. `c` is above 0 over the convex hull of what is seen, so nothing there is mirrored.
//!
//! Depth is the light's own: `e * (1 - along / far) / w`. On each ray it falls with distance whatever `c` is, so no
//! warp can turn the order of casters round, as eye-space depth does when the light is behind the eye.

use super::seen::{Probe, Seen, border, extent, least_stretch};
use super::{FitOptions, ShadowView};
use crate::technique::Projection;
use glam::{DMat2, DMat4, DVec2, DVec3, DVec4};

/// A projective map of the image plane to the square from -1 to 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Window {
    a: DVec3,
    b: DVec3,
    c: DVec3,
    /// How many texels there are at least, over all probes, along a pixel; up to a factor that all windows of one
    /// `Seen` share.
    pub least: f64,
}

/// `c` may not differ by more than this over what is seen: single precision would not carry it.
const MOST_WARP: f64 = 1e4;
/// Edges of the hull along which an unwarped window may lie.
const EDGES: usize = 12;

impl Window {
    /// Steps on the map (-1 to 1) for steps on the image plane.
    fn steps(&self, q: DVec2) -> DMat2 {
        let q = q.extend(1.0);
        let w = self.c.dot(q);
        let row = |r: DVec3| (r.truncate() - self.c.truncate() * (r.dot(q) / w)) / w;
        DMat2::from_cols(row(self.a), row(self.b)).transpose()
    }

    fn judged(mut self, seen: &Seen) -> Self {
        let texels = |p: &Probe| least_stretch(self.steps(p.q) * p.image_from_px);
        self.least = seen.probes.iter().map(texels).fold(f64::INFINITY, f64::min);
        self
    }

    /// The window over what is seen whose least density is greatest, for a given `c`. `None` where `c` is not above 0
    /// everywhere, or differs too much.
    pub fn best(seen: &Seen, c: DVec3, options: &FitOptions) -> Option<Self> {
        let at_middle = c.dot(seen.middle.extend(1.0));
        let c = c / at_middle;
        let (low, high) = seen.hull.iter().fold((f64::INFINITY, 0.0f64), |(low, high), q| {
            let w = c.dot(q.extend(1.0));
            (low.min(w), high.max(w))
        });
        if !(c.is_finite() && low > 0.0 && high < low * MOST_WARP) {
            return None;
        }
        let tries = if high - low < 1e-9 { upright_and_turned(seen) } else { along_slope(seen, c) };
        let made = tries.into_iter().filter_map(|(x, anchor)| Self::around(seen, c, x, anchor, options));
        made.max_by(|a, b| a.least.total_cmp(&b.least))
    }

    /// The window whose x runs along `x`; lines that leave `anchor` against the slope of `c` stay straight up.
    fn around(seen: &Seen, c: DVec3, x: DVec2, anchor: DVec2, options: &FitOptions) -> Option<Self> {
        let y = x.perp();
        let rows = [x, y].map(|axis| axis.extend(-axis.dot(anchor)));
        let places: Vec<DVec2> = seen
            .hull
            .iter()
            .map(|q| {
                let q = q.extend(1.0);
                DVec2::new(rows[0].dot(q), rows[1].dot(q)) / c.dot(q)
            })
            .collect();
        let (low, high) = extent(&places);
        let middle = 0.5 * (low + high);
        let half = (0.5 * (high - low)).max(DVec2::splat(seen.least_half));
        let scale = (1.0 - 1e-4) * (1.0 - 2.0 * border(options)) / half;
        let a = (rows[0] - c * middle.x) * scale.x;
        let b = (rows[1] - c * middle.y) * scale.y;
        (a.is_finite() && b.is_finite()).then(|| Self { a, b, c, least: 0.0 }.judged(seen))
    }

    /// The view that draws this window.
    pub fn view(&self, seen: &Seen, projection: Projection, options: &FitOptions) -> ShadowView {
        let space = &seen.space;
        let spot = space.tan_outer.is_some();
        let (first, last) = seen.along;
        // Parallel light starts a hundredth of the depth before the first caster.
        let start = if spot { 0.0 } else { first - 0.01 * (last - first) };
        let (near, far) = (first - start, last - start);
        let least_w =
            seen.hull.iter().map(|q| self.c.dot(q.extend(1.0))).fold(f64::INFINITY, f64::min) * (1.0 - 1e-3);
        let row =
            |r: DVec3| if spot { DVec4::new(r.x, r.y, -r.z, 0.0) } else { DVec4::new(r.x, r.y, 0.0, r.z) };
        // Reversed depth: 0 at `far`, at most 1 at `near`, and 1 there where c is least.
        let depth = if spot {
            let e = least_w * near / (1.0 - near / far);
            DVec4::new(0.0, 0.0, e / far, e)
        } else {
            let e = least_w / (far - near);
            DVec4::new(0.0, 0.0, e, e * far)
        };
        let clip_from_light = DMat4::from_cols(row(self.a), row(self.b), depth, row(self.c)).transpose();
        let turned = DMat4::from_mat3(space.light_from_world) * DMat4::from_translation(-space.origin_world);
        let light_from_world = DMat4::from_translation(DVec3::Z * start) * turned;
        let widest = seen.hull.iter().map(|q| 1.0 / least_stretch(self.steps(*q))).fold(0.0, f64::max);
        ShadowView {
            light_from_world: light_from_world.as_mat4(),
            clip_from_light: clip_from_light.as_mat4(),
            near_m: near as f32,
            far_m: far as f32,
            texel_m: (2.0 * widest / f64::from(options.size_texel.max(1))) as f32,
            perspective: spot,
            projection,
            fallback: None,
        }
    }
}

/// The light's own axes, and those along the hull's longest edges.
fn upright_and_turned(seen: &Seen) -> Vec<(DVec2, DVec2)> {
    let next = seen.hull.iter().cycle().skip(1);
    let mut edges: Vec<DVec2> = seen.hull.iter().zip(next).map(|(a, b)| *b - *a).collect();
    edges.sort_by(|a, b| b.length_squared().total_cmp(&a.length_squared()));
    let turned = edges.into_iter().take(EDGES).filter_map(DVec2::try_normalize);
    std::iter::once(DVec2::X).chain(turned).map(|x| (x, seen.middle)).collect()
}

/// Across and along the way in which `c` grows, with the eye's place or the hull's middle straight below.
fn along_slope(seen: &Seen, c: DVec3) -> Vec<(DVec2, DVec2)> {
    let Some(y) = c.truncate().try_normalize() else { return vec![(DVec2::X, seen.middle)] };
    let x = -y.perp();
    let eye = seen.space.image(seen.eye.position);
    let in_front = seen.space.tan_outer.is_none() || seen.eye.position.z < 0.0;
    let anchors = std::iter::once(seen.middle).chain((in_front && eye.is_finite()).then_some(eye));
    anchors.map(|anchor| (x, anchor)).collect()
}
