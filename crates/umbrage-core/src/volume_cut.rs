//! Volumes and the eye's far plane: where that cuts them, and where they may end before it.
//!
//! Only what is counted behind surfaces is harmed: a volume without its far end is never left again. A device that does not clip
//! depth, or an eye without a far plane, has none of this.

use crate::bounds::Aabb;
use crate::depth::DepthConvention;
use glam::{Mat4, Vec3, Vec4, Vec4Swizzles};

/// The far plane of an eye, `(unit normal away from the eye, minus distance)`, world space, metres: what is before it has a negative
/// distance. `None` for an eye that sees without end, and for a matrix that is none.
pub fn eye_far_plane_world(clip_from_world: Mat4, depth: DepthConvention) -> Option<Vec4> {
    let (z, w) = (clip_from_world.row(2), clip_from_world.row(3));
    let before = if depth.is_reversed() { z } else { w - z };
    let length = before.xyz().length();
    // Of an infinite far plane nothing is left but what rounding makes of it.
    let is_plane = length > 1e-12 * (z.xyz().length() + w.xyz().length()) && length.is_finite();
    let plane = -before / length;
    (is_plane && plane.is_finite()).then_some(plane)
}

/// Does an eye's far plane cut the volume of a caster? Parameters are those of `umbrage_extrude` (`wgsl/extrude.wgsl`): `extrude_m` in
/// metres, where that is 0 the plane that the volume ends on, and without that it has no end. True when in doubt.
pub fn far_plane_cuts(
    eye_far_world: Vec4,
    light_world: Vec4,
    extrude_m: f32,
    far_plane_world: Option<Vec4>,
    caster_world: &Aabb,
) -> bool {
    let end = |p: Vec3| {
        let away = p * light_world.w - light_world.xyz();
        match far_plane_world {
            _ if extrude_m > 0.0 => (p + away.normalize_or_zero() * extrude_m).extend(1.0),
            Some(plane) => {
                let speed = plane.xyz().dot(away);
                (p * speed - away * plane.dot(p.extend(1.0))).extend(speed)
            }
            None => away.extend(0.0),
        }
    };
    let is_before = |p: Vec4| eye_far_world.dot(p) <= 0.0;
    !caster_world.corners().iter().all(|p| is_before(p.extend(1.0)) && is_before(end(*p)))
}

/// An end of a caster's volume just before the eye's far plane, and so behind all that is seen; as
/// [`super::volume::far_plane_world`] gives one. `None` where not all of the light through the caster meets that plane: then only an eye
/// without a far plane shows the whole shadow.
pub fn end_before_eye_far(eye_far_world: Vec4, light_world: Vec4, caster_world: &Aabb) -> Option<Vec4> {
    let corners = caster_world.corners();
    let distance_m = |p: &Vec3| -eye_far_world.dot(p.extend(1.0));
    let farthest_m = corners.iter().map(distance_m).fold(0.0, f32::max);
    let plane = eye_far_world + Vec4::W * (1e-4 * farthest_m);
    let meets = |p: &Vec3| {
        let way = *p * light_world.w - light_world.xyz();
        plane.xyz().dot(way) > 0.02 * way.length() && plane.dot(p.extend(1.0)) < 0.0
    };
    corners.iter().all(meets).then_some(plane)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Camera;
    use crate::projection::{orthographic, perspective};

    fn around(center: Vec3) -> Aabb {
        Aabb { min: center - 0.5, max: center + 0.5 }
    }

    #[test]
    fn the_far_plane_is_found_in_both_conventions_and_an_infinite_one_is_none() {
        let (from, to) = (Vec3::new(1.0, 2.0, 3.0), Vec3::new(-2.0, 0.5, -4.0));
        let view = Camera::look_at(from, to, 0.8, 0.1, 50.0).view_from_world();
        let along = (to - from).normalize();
        for depth in [DepthConvention::ZeroToOne, DepthConvention::Reversed] {
            for clip in [perspective(0.6, 0.4, 0.1, 50.0, depth), orthographic(3.0, 2.0, 0.1, 50.0, depth)] {
                let plane = eye_far_plane_world(clip * view, depth).expect("a plane");
                let at = |m: f32| plane.dot((from + along * m).extend(1.0));
                assert!(plane.xyz().distance(along) < 1e-3, "{depth:?} {plane}");
                assert!(at(50.0).abs() < 0.02 && (at(20.0) + 30.0).abs() < 0.02, "{depth:?} {}", at(50.0));
            }
            let endless = perspective(0.6, 0.4, 0.1, f32::INFINITY, depth) * view;
            assert_eq!(eye_far_plane_world(endless, depth), None, "{depth:?}");
        }
    }

    #[test]
    fn what_is_cut_ends_before_the_plane_or_is_told() {
        // The eye looks along -z, its far plane at z = -50.
        let far = Vec4::new(0.0, 0.0, -1.0, -50.0);
        let caster = around(Vec3::new(0.0, 0.0, -10.0));
        let sun = |direction: Vec3| (-direction.normalize()).extend(0.0);
        let cuts = |light, plane| far_plane_cuts(far, light, 0.0, plane, &caster);
        // Away from the eye: cut, and an end is found before the plane, which is not.
        let away = sun(Vec3::new(0.2, -0.5, -1.0));
        let end = end_before_eye_far(far, away, &caster).expect("an end");
        assert!(cuts(away, None) && !cuts(away, Some(end)));
        assert!(
            far.dot(Vec4::new(0.0, 0.0, -49.9, 1.0)) < 0.0 && end.dot(Vec4::new(0.0, 0.0, -49.9, 1.0)) < 0.0
        );
        // Towards the eye: never cut. Both ways: cut, and no plane helps.
        assert!(!cuts(sun(Vec3::new(0.0, -0.5, 1.0)), None));
        let lamp = Vec3::new(0.0, 0.2, -10.2).extend(1.0);
        assert!(cuts(lamp, None) && end_before_eye_far(far, lamp, &caster).is_none());
        // A length counts before a plane; what lies behind the far plane itself is cut.
        assert!(
            !far_plane_cuts(far, away, 20.0, None, &caster) && far_plane_cuts(far, away, 60.0, None, &caster)
        );
        assert!(far_plane_cuts(far, sun(Vec3::Z), 1.0, None, &around(Vec3::NEG_Z * 60.0)));
    }
}
