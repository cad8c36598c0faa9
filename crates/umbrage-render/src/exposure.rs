//! How bright the picture is, from the lights alone: the same scene gives the same picture.

use glam::Vec3;
use umbrage::core::{Aabb, Light, LightKind};

/// What a white, matte surface in full light gets in the picture, linear: all that there is.
const WHITE: f32 = 1.0;

/// Factor from radiance to picture, so that a white matte surface at the best lit of `points_world` gets [`WHITE`].
///
/// All lights add up there, each with its cone and falloff, without shadow. No light counts as closer than a quarter of the
/// scene's radius, so that a lamp inside of a model does not turn everything else black. Where no light reaches any of
/// the points, the brightest light counts as if it reached the middle.
pub fn automatic(lights: &[Light], bounds_world: &Aabb, points_world: impl Iterator<Item = Vec3>) -> f32 {
    let closest_m = (0.25 * bounds_world.radius()).max(f32::MIN_POSITIVE.sqrt());
    let center = bounds_world.center();
    let straight = |light: &Light, point: Vec3| {
        let distance_m = match light.kind {
            LightKind::Directional => 1.0,
            _ => light.position_world.distance(point).max(closest_m),
        };
        light.illuminance_lux(distance_m) * light.color.max_element()
    };
    let at =
        |point: Vec3| lights.iter().map(|light| cone(light, point) * straight(light, point)).sum::<f32>();
    let mut key_lux = points_world.chain([center]).map(at).fold(0.0, f32::max);
    if key_lux <= 0.0 {
        key_lux = lights.iter().map(|light| straight(light, center)).fold(0.0, f32::max);
    }
    if key_lux > 0.0 && key_lux.is_finite() { WHITE * std::f32::consts::PI / key_lux } else { 1.0 }
}

/// The cone's share of a light at a point: as `umbrage_cone` of the WGSL library.
fn cone(light: &Light, point: Vec3) -> f32 {
    let LightKind::Spot { inner_rad, outer_rad } = light.kind else { return 1.0 };
    let Some(way) = (point - light.position_world).try_normalize() else { return 1.0 };
    let scale = 1.0 / (inner_rad.cos() - outer_rad.cos()).max(1e-3);
    ((way.dot(light.direction_world.normalize()) - outer_rad.cos()) * scale).clamp(0.0, 1.0).powi(2)
}

/// Ambient light for a share of the key light: what a white matte surface gets of it, in the picture.
pub fn ambient(share: f32) -> Vec3 {
    Vec3::splat(share * WHITE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exposure_undoes_the_unit_and_the_distance() {
        let bounds = Aabb { min: Vec3::splat(-1.0), max: Vec3::splat(1.0) };
        let at = |height: f32, intensity: f32| {
            let light = Light { intensity, ..Light::default() }.aimed(Vec3::Y * height, Vec3::ZERO);
            automatic(&[light], &bounds, std::iter::empty()) * intensity
                / (height * height)
                / std::f32::consts::PI
        };
        for (height, intensity) in [(2.0, 1.0), (2.0, 5e4), (50.0, 3.0)] {
            assert!((at(height, intensity) - WHITE).abs() < 1e-3, "{height} {intensity}");
        }
        assert_eq!(automatic(&[], &bounds, std::iter::empty()), 1.0);
    }

    #[test]
    fn lights_add_up_only_where_their_cones_overlap() {
        let bounds = Aabb { min: Vec3::splat(-1.0), max: Vec3::splat(1.0) };
        let above = |x: f32| Light::spot(Vec3::new(x, 10.0, 0.0), Vec3::new(x, 0.0, 0.0), 0.1, 0.2);
        let one = automatic(&[above(0.0)], &bounds, std::iter::empty());
        let same = automatic(&[above(0.0), above(0.0)], &bounds, std::iter::empty());
        let apart = automatic(&[above(0.0), above(30.0)], &bounds, [Vec3::X * 30.0].into_iter());
        assert!((one / same - 2.0).abs() < 1e-3 && (one / apart - 1.0).abs() < 1e-3, "{one} {same} {apart}");
        let beside = automatic(&[above(30.0)], &bounds, std::iter::empty());
        assert!(beside.is_finite() && beside > 0.0);
    }
}
