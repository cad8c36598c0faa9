//! Which pixels a mask may darken: the part of each receiver's box that lies in the mask's view, seen by the eye.

use glam::{DMat4, DVec3, DVec4, Mat4, UVec2, Vec3};
use umbrage::core::fit::MaskView;
use umbrage::core::{Aabb, DEPTH};

/// Pixels, from the first to past the last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Rect {
    pub min: UVec2,
    pub max: UVec2,
}

impl Rect {
    pub fn whole(size: UVec2) -> Self {
        Self { min: UVec2::ZERO, max: size }
    }

    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    pub fn size(self) -> UVec2 {
        self.max.saturating_sub(self.min)
    }
}

/// Receivers of a mask: a mesh and consecutive instances.
#[derive(Clone, Debug)]
pub(crate) struct ReceiverBatch {
    /// Index of the mesh.
    pub mesh: usize,
    /// Instances: first and past the last.
    pub instances: std::ops::Range<u32>,
    /// The pixels that may lie in the shadow.
    pub on_screen: Rect,
}

/// Room for the rounding of single precision, as a share of the mask's width and depth.
const ROOM: f64 = 1e-3;

/// The shadow of one mask.
#[derive(Debug)]
pub(crate) struct Shadow {
    /// Points of it have a product of 0 or more with each.
    planes: [DVec4; 5],
    /// Where it begins.
    corners: [DVec3; 4],
    clip_from_world: DMat4,
    size: UVec2,
}

impl Shadow {
    /// In a picture of `size`, seen through `clip_from_world`.
    pub fn new(view: &MaskView, clip_from_world: Mat4, size: UVec2) -> Self {
        let mask = view.clip_from_world().as_dmat4();
        let (x, y, w) = (mask.row(0), mask.row(1), mask.row(3) * (1.0 + ROOM));
        let near_m = f64::from(view.near_m) - ROOM * f64::from(view.near_m.abs() + view.far_m.abs());
        let depth = view.depth_from_world().as_dvec4() - DVec4::W * near_m;
        let nearest = if DEPTH.is_reversed() { 1.0 } else { 0.0 };
        let world_from_mask = mask.inverse();
        let wide = 1.0 + ROOM;
        let corners = [(-wide, -wide), (-wide, wide), (wide, -wide), (wide, wide)]
            .map(|(x, y)| world_from_mask.project_point3(DVec3::new(x, y, nearest)));
        let clip_from_world = clip_from_world.as_dmat4();
        Self { planes: [w + x, w - x, w + y, w - y, depth], corners, clip_from_world, size }
    }

    /// The pixels that show what of a box lies in the shadow; `None` where nothing does.
    pub fn on(&self, bounds: &Aabb) -> Option<Rect> {
        // Most boxes lie on the wrong side of one plane.
        let corners = bounds.corners().map(|p| p.as_dvec3().extend(1.0));
        if self.planes.iter().any(|plane| corners.iter().all(|p| plane.dot(*p) < 0.0)) {
            return None;
        }
        let mut points: Vec<DVec3> = faces(bounds).iter().flat_map(|face| self.clip(face)).collect();
        let (low, high) = (bounds.min.as_dvec3() - 1e-6, bounds.max.as_dvec3() + 1e-6);
        points.extend(self.corners.iter().filter(|p| p.cmpge(low).all() && p.cmple(high).all()));
        // All of it is around them: corners of what is convex are on a face of the box, or where it begins.
        let size = self.size.as_dvec2();
        let (mut min, mut max) = (size, DVec3::ZERO.truncate());
        for p in &points {
            let clip = self.clip_from_world * p.extend(1.0);
            if clip.w.is_nan() || clip.w <= 1e-6 * (1.0 + p.length()) {
                return Some(Rect::whole(self.size));
            }
            let at = (DVec3::new(clip.x, -clip.y, 0.0).truncate() / clip.w * 0.5 + 0.5) * size;
            (min, max) = (min.min(at), max.max(at));
        }
        // A pixel more on each side, for the eye's rounding.
        let min = (min - 1.0).floor().max(DVec3::ZERO.truncate()).as_uvec2();
        let max = (max + 1.0).ceil().min(size).max(DVec3::ZERO.truncate()).as_uvec2();
        (!points.is_empty() && min.cmplt(max).all()).then_some(Rect { min, max })
    }

    /// A face without what lies outside (Sutherland and Hodgman 1974).
    fn clip(&self, face: &[DVec3; 4]) -> Vec<DVec3> {
        let mut left = face.to_vec();
        for plane in &self.planes {
            let mut inside = Vec::with_capacity(left.len() + 1);
            for (i, p) in left.iter().enumerate() {
                let q = left[(i + 1) % left.len()];
                let (a, b) = (plane.dot(p.extend(1.0)), plane.dot(q.extend(1.0)));
                if a >= 0.0 {
                    inside.push(*p);
                }
                if (a >= 0.0) != (b >= 0.0) {
                    inside.push(p.lerp(q, a / (a - b)));
                }
            }
            left = inside;
        }
        left
    }
}

fn faces(bounds: &Aabb) -> [[DVec3; 4]; 6] {
    let corner = |x: bool, y: bool, z: bool| {
        let pick = |high: bool, a: f32, b: f32| if high { b } else { a };
        let (a, b) = (bounds.min, bounds.max);
        Vec3::new(pick(x, a.x, b.x), pick(y, a.y, b.y), pick(z, a.z, b.z)).as_dvec3()
    };
    let around = [(false, false), (false, true), (true, true), (true, false)];
    let face = |axis: usize, high: bool| {
        around.map(|(u, v)| match axis {
            0 => corner(high, u, v),
            1 => corner(u, high, v),
            _ => corner(u, v, high),
        })
    };
    [face(0, false), face(0, true), face(1, false), face(1, true), face(2, false), face(2, true)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec2;
    use umbrage::core::fit::{MaskOptions, Region, fit_mask};
    use umbrage::core::{Camera, Light, LightKind};

    /// Of a grid of places in boxes that receive, each that a mask may darken is in a pixel of the rectangle.
    #[test]
    fn no_shadow_lies_outside_and_some_pixels_are_spared() {
        let size = UVec2::new(64, 48);
        let camera = Camera::look_at(Vec3::new(0.0, 5.0, 9.0), Vec3::ZERO, 0.9, 0.1, 60.0);
        let clip_from_world = camera.clip_from_view(4.0 / 3.0, DEPTH) * camera.view_from_world();
        let receivers = [
            Aabb { min: Vec3::new(-6.0, 0.0, -6.0), max: Vec3::new(6.0, 0.0, 6.0) },
            Aabb { min: Vec3::new(-2.0, 0.0, -3.0), max: Vec3::new(2.0, 2.5, -1.0) },
            Aabb { min: Vec3::splat(-0.8), max: Vec3::splat(3.0) },
        ];
        let (mut spared, mut held) = (0, 0);
        for (at, kind) in [
            (Vec3::new(3.0, 7.0, 2.0), LightKind::Point),
            (Vec3::new(-4.0, 3.0, -5.0), LightKind::Point),
            (Vec3::new(1.0, 5.0, 4.0), LightKind::Directional),
        ] {
            let light = Light { kind, ..Light::default() }.aimed(at, Vec3::Y);
            let blocker = Aabb { min: Vec3::new(-0.5, 1.0, -0.5), max: Vec3::new(0.5, 2.0, 0.5) };
            let view =
                fit_mask(&light, blocker.corners().into_iter(), &MaskOptions::default()).expect("a mask");
            let shadow = Shadow::new(&view, clip_from_world, size);
            for bounds in &receivers {
                let rect = shadow.on(bounds);
                spared += usize::from(rect != Some(Rect::whole(size)));
                for i in 0..21 * 21 * 21 {
                    let share = Vec3::new((i % 21) as f32, (i / 21 % 21) as f32, (i / 441) as f32) / 20.0;
                    let p = bounds.min + share * (bounds.max - bounds.min);
                    let place = view.clip_from_world() * p.extend(1.0);
                    let is_over = place.w > 0.0 && place.x.abs().max(place.y.abs()) <= place.w;
                    let clip = clip_from_world * p.extend(1.0);
                    if !is_over || view.region(p) == Region::Before || clip.w < 0.1 {
                        continue;
                    }
                    let at = Vec2::new(clip.x, -clip.y) / clip.w * 0.5 + 0.5;
                    if at.min_element() < 0.0 || at.max_element() >= 1.0 {
                        continue;
                    }
                    let pixel = (at * size.as_vec2()).as_uvec2();
                    let rect = rect.expect("a rectangle");
                    held += 1;
                    assert!(pixel.cmpge(rect.min).all() && pixel.cmplt(rect.max).all(), "{pixel} {rect:?}");
                }
            }
        }
        assert!(spared > 6 && held > 1000, "{spared} {held}");
    }
}
