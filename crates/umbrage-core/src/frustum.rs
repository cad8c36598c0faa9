//! What a view can see: six planes, and boxes against them.

use crate::bounds::Aabb;
use crate::depth::DepthConvention;
use glam::{Mat4, Vec3, Vec4, Vec4Swizzles};

/// The planes of a view's clip volume in world space; a point is inside when each `dot(plane, (p, 1)) >= 0`.
#[derive(Clone, Copy, Debug)]
pub struct Frustum {
    planes_world: [Vec4; 6],
}

impl Frustum {
    /// The planes of a projection (Gribb and Hartmann 2001, "Fast Extraction of Viewing Frustum Planes").
    pub fn from_clip(clip_from_world: Mat4, depth: DepthConvention) -> Self {
        let rows = clip_from_world.transpose();
        let (x, y, z, w) = (rows.x_axis, rows.y_axis, rows.z_axis, rows.w_axis);
        let lowest = if depth == DepthConvention::OpenGl { z + w } else { z };
        Self { planes_world: [w + x, w - x, w + y, w - y, lowest, w - z] }
    }

    /// The same without the near plane: all that lies before the eye. A map that does not clip at its near plane shows that, the
    /// nearest of it flattened onto the plane.
    pub fn from_clip_without_near(clip_from_world: Mat4, depth: DepthConvention) -> Self {
        let mut made = Self::from_clip(clip_from_world, depth);
        made.planes_world[if depth.is_reversed() { 5 } else { 4 }] = clip_from_world.transpose().w_axis;
        made
    }

    /// May any part of the box be inside? Never false for a box that is; seldom true for one that is not.
    pub fn may_see(&self, bounds_world: &Aabb) -> bool {
        if bounds_world.is_empty() {
            return false;
        }
        self.planes_world.iter().all(|plane| {
            let farthest = Vec3::select(plane.xyz().cmpge(Vec3::ZERO), bounds_world.max, bounds_world.min);
            plane.dot(farthest.extend(1.0)) >= 0.0
        })
    }

    /// The same, as far as light goes: only its four sides count.
    pub fn without_depth(mut self) -> Self {
        self.planes_world[4] = Vec4::W;
        self.planes_world[5] = Vec4::W;
        self
    }

    /// May anything of the box be inside, or of what it sweeps when each point `p` of it moves along `way(p)` without end? `way`
    /// is affine. False only when all of it is outside one plane.
    pub fn may_see_swept(&self, bounds_world: &Aabb, way: impl Fn(Vec3) -> Vec3) -> bool {
        if bounds_world.is_empty() {
            return false;
        }
        let corners = bounds_world.corners();
        self.planes_world.iter().all(|plane| {
            corners.iter().any(|p| plane.dot(p.extend(1.0)) >= 0.0 || plane.xyz().dot(way(*p)) > 0.0)
        })
    }
}

/// May any part of a box be inside a cone without end? The box's sphere is asked, so the answer is never false for a box
/// that is, and sometimes true for one that is not. A spot light's map is square: its corners lie outside the cone,
/// and what is only there neither throws nor receives a shadow of that light.
pub fn cone_may_see(apex_world: Vec3, axis_world: Vec3, outer_rad: f32, bounds_world: &Aabb) -> bool {
    if bounds_world.is_empty() {
        return false;
    }
    let to_center = bounds_world.center() - apex_world;
    let along = to_center.dot(axis_world);
    let across = (to_center.length_squared() - along * along).max(0.0).sqrt();
    let (sin, cos) = outer_rad.sin_cos();
    // Signed distance from the cone's surface; behind the apex the apex itself is nearest, and farther than this says.
    cos * across - sin * along <= bounds_world.radius()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::projection::{orthographic, perspective};
    use proptest::prelude::*;

    fn around(center: Vec3) -> Aabb {
        Aabb { min: center - 0.5, max: center + 0.5 }
    }

    #[test]
    fn boxes_on_each_side_are_told_apart() {
        for depth in DepthConvention::ALL {
            for clip in [perspective(0.5, 0.5, 1.0, 50.0, depth), orthographic(5.0, 5.0, 1.0, 50.0, depth)] {
                let frustum = Frustum::from_clip(clip, depth);
                assert!(frustum.may_see(&around(Vec3::new(0.0, 0.0, -10.0))), "{depth:?}");
                for outside in [
                    Vec3::new(20.0, 0.0, -10.0),
                    Vec3::new(-20.0, 0.0, -10.0),
                    Vec3::new(0.0, 20.0, -10.0),
                    Vec3::new(0.0, -20.0, -10.0),
                    Vec3::new(0.0, 0.0, -60.0),
                    Vec3::new(0.0, 0.0, 5.0),
                ] {
                    assert!(!frustum.may_see(&around(outside)), "{depth:?} {outside}");
                }
                assert!(
                    frustum.may_see(&Aabb { min: Vec3::splat(-100.0), max: Vec3::splat(100.0) }),
                    "{depth:?}"
                );
            }
        }
    }

    #[test]
    fn without_a_near_plane_what_is_close_is_seen_and_what_is_behind_is_not() {
        for depth in DepthConvention::ALL {
            let clip = perspective(1.0, 1.0, 5.0, 100.0, depth);
            let at = |z: f32| Aabb { min: Vec3::new(-0.1, -0.1, z - 0.1), max: Vec3::new(0.1, 0.1, z + 0.1) };
            let (closed, open) =
                (Frustum::from_clip(clip, depth), Frustum::from_clip_without_near(clip, depth));
            assert!(!closed.may_see(&at(-2.0)) && open.may_see(&at(-2.0)), "{depth:?}");
            assert!(closed.may_see(&at(-9.0)) && open.may_see(&at(-9.0)), "{depth:?}");
            assert!(!open.may_see(&at(2.0)) && !open.may_see(&at(-200.0)), "{depth:?}");
        }
    }

    proptest! {
        #[test]
        fn a_box_with_a_point_in_the_cone_is_seen(
            x in -9.0f32..9.0, y in -9.0f32..9.0, z in -9.0f32..9.0, half in 0.01f32..2.0, angle in 0.05f32..1.5,
        ) {
            let (bounds, axis) = (around(Vec3::new(x, y, z)), Vec3::new(0.6, 0.0, -0.8));
            let bounds = Aabb { min: bounds.min - half, max: bounds.max + half };
            let inside = |p: Vec3| p.angle_between(axis) <= angle;
            if bounds.corners().into_iter().any(inside) {
                prop_assert!(cone_may_see(Vec3::ZERO, axis, angle, &bounds));
            }
        }
    }

    #[test]
    fn the_corners_of_the_square_around_a_cone_are_not_seen() {
        let at = |x: f32, y: f32| around(Vec3::new(x, y, -10.0));
        let seen = |bounds: Aabb| cone_may_see(Vec3::ZERO, Vec3::NEG_Z, std::f32::consts::FRAC_PI_4, &bounds);
        assert!(seen(at(0.0, 0.0)) && seen(at(9.0, 0.0)) && seen(at(6.5, 6.5)));
        assert!(!seen(at(9.0, 9.0)) && !seen(at(0.0, 14.0)) && !seen(around(Vec3::Z * 5.0)));
    }
}
