//! Casters that cannot shadow anything, and so need not be drawn.

use crate::bounds::Aabb;
use crate::light::{Light, LightKind, LightShape};
use glam::{Vec3, Vec4, Vec4Swizzles};

/// Can a flat caster shadow none of the receivers?
///
/// A plane cannot shadow itself. It shadows others only beyond it, as seen from the light; so a floor under
/// everything, a wall behind everything, however large, leaves every V as it is. `plane_world` is (unit normal, minus its
/// distance from the origin); a receiver may reach through it by `tolerance_m`. False when the light lies in the
/// plane. Exact: the answer true never changes a picture; a receiver's box may make it false without need.
pub fn flat_caster_is_idle(
    light: &Light,
    plane_world: Vec4,
    receivers_world: impl IntoIterator<Item = Aabb>,
    tolerance_m: f32,
) -> bool {
    let towards_light = match light.kind {
        LightKind::Directional => plane_world.xyz().dot(-light.direction_world),
        _ => plane_world.dot(light.position_world.extend(1.0)),
    };
    // Part of a wide light may lie on the plane's other side.
    let least = match (light.kind, light.shape) {
        (LightKind::Directional, LightShape::Sun { angle_rad }) => (0.5 * angle_rad).sin(),
        (LightKind::Directional, _) => 0.0,
        _ => tolerance_m + light.shape.bounding_radius_m(),
    };
    if towards_light.abs() <= least {
        return false;
    }
    let plane = plane_world * towards_light.signum();
    receivers_world.into_iter().filter(|b| !b.is_empty()).all(|bounds| {
        let deepest = Vec3::select(plane.xyz().cmpge(Vec3::ZERO), bounds.min, bounds.max);
        plane.dot(deepest.extend(1.0)) >= -tolerance_m
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const FLOOR: Vec4 = Vec4::new(0.0, 1.0, 0.0, 0.0);

    fn crate_at(y: f32) -> Aabb {
        Aabb { min: Vec3::new(-1.0, y, -1.0), max: Vec3::new(1.0, y + 1.0, 1.0) }
    }

    #[test]
    fn a_floor_under_everything_is_idle_whichever_way_it_faces() {
        let lamp = Light::default().aimed(Vec3::Y * 5.0, Vec3::ZERO);
        let sun = Light { kind: LightKind::Directional, ..lamp };
        for light in [lamp, sun] {
            assert!(flat_caster_is_idle(&light, FLOOR, [crate_at(0.0), crate_at(3.0)], 1e-4));
            assert!(flat_caster_is_idle(&light, -FLOOR, [crate_at(0.0)], 1e-4));
            assert!(!flat_caster_is_idle(&light, FLOOR, [crate_at(0.0), crate_at(-0.5)], 1e-4));
        }
    }

    #[test]
    fn a_light_below_or_in_the_plane_is_not_deceived() {
        let below = Light::default().aimed(Vec3::NEG_Y * 5.0, Vec3::ZERO);
        assert!(!flat_caster_is_idle(&below, FLOOR, [crate_at(1.0)], 1e-4));
        assert!(flat_caster_is_idle(&below, FLOOR, [crate_at(-1.0)], 1e-4));
        let inside = Light::default().aimed(Vec3::X * 5.0, Vec3::ZERO);
        assert!(!flat_caster_is_idle(&inside, FLOOR, [crate_at(0.0)], 1e-4));
        let lamp = Light::default().aimed(Vec3::Y * 5.0, Vec3::ZERO);
        let half_below = Light { shape: LightShape::Sphere { radius_m: 6.0 }, ..lamp };
        assert!(!flat_caster_is_idle(&half_below, FLOOR, [crate_at(0.0)], 1e-4));
        let low = Light { kind: LightKind::Directional, ..lamp.aimed(Vec3::new(5.0, 0.02, 0.0), Vec3::ZERO) };
        assert!(flat_caster_is_idle(&low, FLOOR, [crate_at(0.0)], 1e-4));
        let setting = Light { shape: LightShape::Sun { angle_rad: 0.01 }, ..low };
        assert!(!flat_caster_is_idle(&setting, FLOOR, [crate_at(0.0)], 1e-4));
    }
}
