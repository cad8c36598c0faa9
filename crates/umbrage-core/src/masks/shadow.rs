//! Which pixels a mask may darken: the part of each receiver's box that lies in the mask's view, seen by the eye.

use crate::bounds::Aabb;
use crate::depth::{DEPTH, DepthConvention};
use crate::fit::MaskView;
use crate::frustum::Frustum;
use glam::{DMat4, DVec2, DVec3, DVec4, Mat4, UVec2, Vec3};

/// Pixels of a picture, rows down, from the first to past the last.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Rect {
    /// The first, pixels.
    pub min: UVec2,
    /// Past the last, pixels.
    pub max: UVec2,
}

impl Rect {
    /// All of a picture of `size` pixels.
    pub fn whole(size: UVec2) -> Self {
        Self { min: UVec2::ZERO, max: size }
    }

    /// The smallest rectangle around both.
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Width and height, pixels.
    pub fn size(self) -> UVec2 {
        self.max.saturating_sub(self.min)
    }
}

/// A picture that masks darken: whose eye sees it, and how many pixels it has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Picture {
    /// World to clip space of the eye.
    pub clip_from_world: Mat4,
    /// Which way the depth of that clip space runs; it need not be that of the masks.
    pub depth: DepthConvention,
    /// Width and height, pixels.
    pub size: UVec2,
}

impl Picture {
    /// What its eye sees.
    pub fn frustum(&self) -> Frustum {
        Frustum::from_clip(self.clip_from_world, self.depth)
    }
}

/// Room for the rounding of single precision, as a share of the mask's width and depth.
const ROOM: f64 = 1e-3;

/// The shadow of one mask.
#[derive(Clone, Copy, Debug)]
pub struct Shadow {
    /// Points of it have a product of 0 or more with each.
    planes: [DVec4; 5],
    /// Where it begins.
    corners: [DVec3; 4],
    seen: Frustum,
    clip_from_world: DMat4,
    size: UVec2,
}

impl Shadow {
    /// That of `view`, as `picture` shows it.
    pub fn new(view: &MaskView, picture: &Picture) -> Self {
        let mask = view.clip_from_world().as_dmat4();
        let (x, y, w) = (mask.row(0), mask.row(1), mask.row(3) * (1.0 + ROOM));
        let near_m = f64::from(view.near_m) - ROOM * f64::from(view.near_m.abs() + view.far_m.abs());
        let depth = view.depth_from_world().as_dvec4() - DVec4::W * near_m;
        // The mask's own depth.
        let nearest = if DEPTH.is_reversed() { 1.0 } else { 0.0 };
        let world_from_mask = mask.inverse();
        let wide = 1.0 + ROOM;
        let corners = [(-wide, -wide), (-wide, wide), (wide, -wide), (wide, wide)]
            .map(|(x, y)| world_from_mask.project_point3(DVec3::new(x, y, nearest)));
        Self {
            planes: [w + x, w - x, w + y, w - y, depth],
            corners,
            seen: picture.frustum(),
            clip_from_world: picture.clip_from_world.as_dmat4(),
            size: picture.size,
        }
    }

    /// The pixels that show what of these boxes lies in the shadow; `None` where nothing does.
    ///
    /// Cost on the CPU: as [`Self::on`] for each box, until all pixels are found.
    pub fn over(&self, bounds_world: impl IntoIterator<Item = Aabb>) -> Option<Rect> {
        let mut all: Option<Rect> = None;
        for rect in bounds_world.into_iter().filter_map(|bounds| self.on(&bounds)) {
            let joined = all.map_or(rect, |all| all.union(rect));
            if joined == Rect::whole(self.size) {
                return Some(joined);
            }
            all = Some(joined);
        }
        all
    }

    /// The pixels that show what of a box lies in the shadow; `None` where nothing does, or the eye sees nothing of the box.
    ///
    /// Cost on the CPU: six polygons clipped by five planes, for boxes that are not on the wrong side of one. Nothing on the heap.
    pub fn on(&self, bounds_world: &Aabb) -> Option<Rect> {
        if !self.seen.may_see(bounds_world) {
            return None;
        }
        // Most boxes lie on the wrong side of one plane.
        let corners = bounds_world.corners().map(|p| p.as_dvec3().extend(1.0));
        if self.planes.iter().any(|plane| corners.iter().all(|p| plane.dot(*p) < 0.0)) {
            return None;
        }
        let mut around = Around { min: self.size.as_dvec2(), max: DVec2::ZERO };
        for face in faces(bounds_world) {
            // All of it is around its corners: those of what is convex are on a face of the box, or where it begins.
            let clipped = self.clip(face);
            if !clipped.is_some_and(|left| left.points().iter().all(|p| self.joins(&mut around, *p))) {
                return Some(Rect::whole(self.size));
            }
        }
        let (low, high) = (bounds_world.min.as_dvec3() - 1e-6, bounds_world.max.as_dvec3() + 1e-6);
        let mut inside = self.corners.iter().filter(|p| p.cmpge(low).all() && p.cmple(high).all());
        if !inside.all(|p| self.joins(&mut around, *p)) {
            return Some(Rect::whole(self.size));
        }
        // A pixel more on each side, for the eye's rounding.
        let min = (around.min - 1.0).floor().max(DVec2::ZERO).as_uvec2();
        let max = (around.max + 1.0).ceil().min(self.size.as_dvec2()).max(DVec2::ZERO).as_uvec2();
        let is_empty = around.min.cmpgt(around.max).any();
        (!is_empty && min.cmplt(max).all()).then_some(Rect { min, max })
    }

    /// Takes in the pixel of a point; false where that is none.
    fn joins(&self, around: &mut Around, p: DVec3) -> bool {
        let clip = self.clip_from_world * p.extend(1.0);
        if clip.w.is_nan() || clip.w <= 1e-6 * (1.0 + p.length()) {
            return false;
        }
        let at = (DVec2::new(clip.x, -clip.y) / clip.w * 0.5 + 0.5) * self.size.as_dvec2();
        (around.min, around.max) = (around.min.min(at), around.max.max(at));
        true
    }

    /// A face without what lies outside (Sutherland and Hodgman 1974); `None` where rounding makes more corners of it than it
    /// can have.
    fn clip(&self, face: [DVec3; 4]) -> Option<Polygon> {
        let mut left = Polygon::default();
        face.into_iter().for_each(|p| _ = left.push(p));
        for plane in &self.planes {
            let mut inside = Polygon::default();
            let points = left.points();
            for (i, p) in points.iter().enumerate() {
                let q = points[(i + 1) % points.len()];
                let (a, b) = (plane.dot(p.extend(1.0)), plane.dot(q.extend(1.0)));
                if a >= 0.0 && !inside.push(*p) {
                    return None;
                }
                if (a >= 0.0) != (b >= 0.0) && !inside.push(p.lerp(q, a / (a - b))) {
                    return None;
                }
            }
            left = inside;
        }
        Some(left)
    }
}

/// What points take up on the screen, pixels.
#[derive(Clone, Copy, Debug)]
struct Around {
    min: DVec2,
    max: DVec2,
}

/// A face that five planes may have clipped: each adds a corner at most.
#[derive(Clone, Copy, Debug, Default)]
struct Polygon {
    corners: [DVec3; 12],
    count: usize,
}

impl Polygon {
    fn points(&self) -> &[DVec3] {
        &self.corners[..self.count]
    }

    /// One corner more; false where there is no room for it.
    fn push(&mut self, p: DVec3) -> bool {
        let Some(free) = self.corners.get_mut(self.count) else { return false };
        *free = p;
        self.count += 1;
        true
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
    use crate::camera::Camera;
    use crate::fit::{MaskOptions, Region, fit_mask};
    use crate::light::{Light, LightKind};
    use glam::Vec2;

    /// Of a grid of places in boxes that receive, each that a mask may darken is in a pixel of the rectangle.
    #[test]
    fn no_shadow_lies_outside_and_some_pixels_are_spared() {
        let size = UVec2::new(64, 48);
        let camera = Camera::look_at(Vec3::new(0.0, 5.0, 9.0), Vec3::ZERO, 0.9, 0.1, 60.0);
        for depth in DepthConvention::ALL {
            holds(camera.clip_from_view(4.0 / 3.0, depth) * camera.view_from_world(), depth, size);
        }
    }

    fn holds(clip_from_world: Mat4, depth: DepthConvention, size: UVec2) {
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
            let shadow = Shadow::new(&view, &Picture { clip_from_world, depth, size });
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
