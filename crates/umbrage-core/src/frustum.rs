//! What a view can see: six planes, and boxes against them.

use crate::bounds::Aabb;
use crate::depth::DepthConvention;
use glam::{Mat4, Vec4, Vec4Swizzles};

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

    /// May any part of the box be inside? Never false for a box that is; seldom true for one that is not.
    pub fn may_see(&self, bounds_world: &Aabb) -> bool {
        if bounds_world.is_empty() {
            return false;
        }
        self.planes_world.iter().all(|plane| {
            let farthest =
                glam::Vec3::select(plane.xyz().cmpge(glam::Vec3::ZERO), bounds_world.max, bounds_world.min);
            plane.dot(farthest.extend(1.0)) >= 0.0
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::projection::{orthographic, perspective};
    use glam::Vec3;

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
}
