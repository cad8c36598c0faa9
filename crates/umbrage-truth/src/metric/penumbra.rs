//! How wide soft edges are, beside what similar triangles say.

use super::{Judged, grey, is_on_plane, to_light};
use crate::emitter::spread_10_90;
use crate::hierarchy::{Rays, Stack};
use crate::{Emitter, Surfaces};
use glam::{DVec2, DVec3, Mat2, Vec2, Vec3};
use umbrage_core::Light;

/// Edges that are measured in a picture at most; they are chosen evenly.
const MOST_EDGES: usize = 2000;
/// A line across an edge ends after this many pixels.
const LONGEST_PX: f32 = 250.0;
/// Pixels of a step along such a line.
const STEP_PX: f32 = 0.25;
/// Half the edge of the square over which V*'s gradient is taken, pixels: wide enough to even out the truth's noise.
const GRADIENT_PX: i32 = 3;

/// An edge of a soft shadow, where V* passes one half.
#[derive(Clone, Copy, Debug)]
struct Edge {
    /// Where it is, pixels from the picture's upper left corner, and which way it becomes lighter; unit length.
    at_px: Vec2,
    to_light_px: Vec2,
    /// Metres across the edge, in the plane across the way to the light, for a pixel along `to_light_px`.
    across_m: f64,
    /// From V 0.1 to 0.9 by similar triangles, metres in the same plane.
    expected_m: f64,
}

/// The soft edges of a picture under one light of some size.
#[derive(Clone, Debug)]
pub struct Edges {
    edges: Vec<Edge>,
    /// A line across an edge ends where the receiver does: beyond it V says nothing of this edge.
    receivers: Vec<bool>,
    width: usize,
    height: usize,
}

impl Edges {
    /// Finds them. There are none under a light that is a point.
    ///
    /// At each, the thing that blocks the light's middle on the dark side says how far off the caster is, `b`; with the
    /// light at `d`, the light's own spread across the edge is thrown with a width of `b / (d - b)` (Fernando 2005,
    /// "Percentage-Closer Soft Shadows").
    pub fn new(rays: &Rays<'_>, surfaces: &Surfaces, light: &Light, judged: &Judged) -> Self {
        let emitter = Emitter::new(light);
        let (width, height) = (surfaces.size.x as usize, surfaces.size.y as usize);
        let mut found = Self { edges: Vec::new(), receivers: judged.receivers().to_vec(), width, height };
        if emitter.is_point() {
            return found;
        }
        let v = |pixel: usize| grey(judged.truth()[pixel]);
        let crossings: Vec<usize> = (0..width * height)
            .filter(|pixel| {
                let crosses = |other: usize| {
                    judged.receivers()[*pixel]
                        && judged.receivers()[other]
                        && (v(*pixel) > 0.5) != (v(other) > 0.5)
                };
                (pixel % width + 1 < width && crosses(pixel + 1))
                    || (pixel / width + 1 < height && crosses(pixel + width))
            })
            .collect();
        let step = crossings.len().div_ceil(MOST_EDGES).max(1);
        let mut stack = Stack::default();
        for pixel in crossings.into_iter().step_by(step) {
            found.edges.extend(edge_at(rays, surfaces, &emitter, judged, pixel, &mut stack));
        }
        found
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.edges.len()
    }

    /// Is there none?
    pub fn is_empty(&self) -> bool {
        self.edges.is_empty()
    }

    /// The median of measured over expected width: 1 is right, 0 a hard edge, above 1 too soft. `None` without edges.
    /// Widths are from V 0.1 to 0.9. An edge that is dark or lit all along its line has none and is left out; so is one
    /// that does not become fully either.
    pub fn ratio(&self, v: &[Vec3]) -> Option<f64> {
        let mut ratios: Vec<f64> = self
            .edges
            .iter()
            .filter_map(|edge| Some(self.width_px(edge, v)? * edge.across_m / edge.expected_m))
            .collect();
        ratios.sort_by(f64::total_cmp);
        (!ratios.is_empty()).then(|| ratios[ratios.len() / 2])
    }

    fn width_px(&self, edge: &Edge, v: &[Vec3]) -> Option<f64> {
        let along = |px: f32| self.blended(edge.at_px + edge.to_light_px * px, v);
        let steps = (LONGEST_PX / STEP_PX) as i32;
        // Both ways from where the truth is half lit to where the answer is, each way as far as the receiver goes.
        let crossing = |level: f32| {
            let mut goes_on = [true; 2];
            (0..steps).find_map(|i| {
                [i, -i - 1].into_iter().zip(&mut goes_on).find_map(|(i, goes_on)| {
                    let a = i as f32 * STEP_PX;
                    let (Some(low), Some(high), true) = (along(a), along(a + STEP_PX), *goes_on) else {
                        *goes_on = false;
                        return None;
                    };
                    (low <= level && high > level).then(|| a + (level - low) / (high - low) * STEP_PX)
                })
            })
        };
        Some(f64::from((crossing(0.9)? - crossing(0.1)?).abs()))
    }

    /// A value between pixel centres; `None` outside of the picture and beside what is no receiver.
    fn blended(&self, at_px: Vec2, v: &[Vec3]) -> Option<f32> {
        let at = at_px - 0.5;
        let corner = at.floor();
        let inside = corner.min_element() >= 0.0
            && corner.x + 1.0 < self.width as f32
            && corner.y + 1.0 < self.height as f32;
        if !inside {
            return None;
        }
        let share = at - corner;
        let pixel = |dx: usize, dy: usize| (corner.y as usize + dy) * self.width + corner.x as usize + dx;
        if ![(0, 0), (1, 0), (0, 1), (1, 1)].into_iter().all(|(dx, dy)| self.receivers[pixel(dx, dy)]) {
            return None;
        }
        let value = |dx: usize, dy: usize| grey(v[pixel(dx, dy)]);
        let row = |dy: usize| value(0, dy) * (1.0 - share.x) + value(1, dy) * share.x;
        Some(row(0) * (1.0 - share.y) + row(1) * share.y)
    }
}

/// The edge near a pixel, if all that is needed of it can be seen.
fn edge_at(
    rays: &Rays<'_>,
    surfaces: &Surfaces,
    emitter: &Emitter,
    judged: &Judged,
    pixel: usize,
    stack: &mut Stack,
) -> Option<Edge> {
    let width = surfaces.size.x as usize;
    let seen = surfaces.seen[pixel]?;
    let flat = |other: usize| {
        let there = surfaces.seen[other]?;
        let same = there.normal_world.dot(seen.normal_world) > 0.999
            && is_on_plane(&seen, there.p_world, 0.1 * surfaces.pixel_m(&seen));
        (same && judged.receivers()[other]).then_some(there)
    };
    let (x, y) = ((pixel % width) as i32, (pixel / width) as i32);
    let at = |dx: i32, dy: i32| {
        let (x, y) = (x + dx, y + dy);
        let inside = x >= 0 && y >= 0 && x < width as i32 && y < surfaces.size.y as i32;
        inside.then(|| y as usize * width + x as usize)
    };
    // The gradient of V* over a square that must be one flat receiver: the slope of a plane through it.
    let mut gradient = Vec2::ZERO;
    for dy in -GRADIENT_PX..=GRADIENT_PX {
        for dx in -GRADIENT_PX..=GRADIENT_PX {
            let other = at(dx, dy)?;
            flat(other)?;
            gradient += Vec2::new(dx as f32, dy as f32) * grey(judged.truth()[other]);
        }
    }
    let to_light_px = gradient.try_normalize()?;
    // From pixels to the plane across the way to the light.
    let way = emitter.center(seen.p_world).way;
    let (right, up) = way.any_orthonormal_pair();
    let on_plane = |p: DVec3| DVec2::new(p.dot(right), p.dot(up)).as_vec2();
    let (dx, dy) = (flat(at(1, 0)?)?.p_world - seen.p_world, flat(at(0, 1)?)?.p_world - seen.p_world);
    let plane_from_px = Mat2::from_cols(on_plane(dx), on_plane(dy));
    let normal_plane = (plane_from_px.inverse().transpose() * to_light_px).try_normalize()?;
    let axis = right * f64::from(normal_plane.x) + up * f64::from(normal_plane.y);
    // The caster, seen from the dark side.
    let at_px = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
    let blocker_m = (0..GRADIENT_PX * 8).find_map(|i| {
        let p = at_px - to_light_px * i as f32;
        let other = at(p.x.floor() as i32 - x, p.y.floor() as i32 - y)?;
        rays.blocker(&to_light(rays, emitter, &flat(other)?), stack).map(|found| found.distance_m)
    })?;
    let distance_m = emitter.center(seen.p_world).distance_m;
    let spread = spread_10_90(emitter, seen.p_world, axis);
    let expected_m = if distance_m.is_finite() {
        spread * blocker_m / (distance_m - blocker_m)
    } else {
        spread * blocker_m
    };
    let across_m = f64::from((plane_from_px * to_light_px).dot(normal_plane)).abs();
    // What is narrower than a pixel or two is measured by nothing that has pixels.
    (expected_m > 2.0 * across_m && expected_m.is_finite()).then_some(Edge {
        at_px,
        to_light_px,
        across_m,
        expected_m,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A picture of 64x8 with one edge at column 32, expected to be 4 m wide, a pixel is 0.5 m across the edge.
    fn one_edge() -> Edges {
        let edge = Edge { at_px: Vec2::new(32.0, 4.0), to_light_px: Vec2::X, across_m: 0.5, expected_m: 4.0 };
        Edges { edges: vec![edge], receivers: vec![true; 64 * 8], width: 64, height: 8 }
    }

    /// V as a ramp around the edge, so many pixels from 0 to 1.
    fn ramp(width_px: f32) -> Vec<Vec3> {
        let v = |i: usize| ((i % 64) as f32 + 0.5 - 32.0) / width_px + 0.5;
        (0..64 * 8).map(|i| Vec3::splat(v(i).clamp(0.0, 1.0))).collect()
    }

    #[test]
    fn widths_are_those_of_the_ramp() {
        // Eight pixels of half a metre between 0.1 and 0.9.
        let right = one_edge().ratio(&ramp(10.0)).expect("an edge");
        assert!((right - 1.0).abs() < 1e-3, "{right}");
        let wide = one_edge().ratio(&ramp(20.0)).expect("an edge");
        assert!((wide - 2.0).abs() < 1e-3, "{wide}");
        let hard = one_edge().ratio(&ramp(0.01)).expect("an edge");
        assert!(hard < 0.11, "{hard}");
    }

    #[test]
    fn what_lies_beyond_the_receiver_is_no_edge() {
        let mut edges = one_edge();
        // V of 0 on something else, ten pixels away.
        let v: Vec<Vec3> = (0..64 * 8).map(|i| if i % 64 < 22 { Vec3::ZERO } else { Vec3::ONE }).collect();
        assert!(edges.ratio(&v).is_some());
        edges.receivers = (0..64 * 8).map(|i| i % 64 != 22).collect();
        assert_eq!(edges.ratio(&v), None);
    }

    #[test]
    fn what_has_no_edge_has_no_width() {
        assert_eq!(one_edge().ratio(&vec![Vec3::ONE; 64 * 8]), None);
        assert_eq!(Edges { edges: Vec::new(), ..one_edge() }.ratio(&ramp(10.0)), None);
    }
}
