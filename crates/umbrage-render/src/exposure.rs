//! How bright the picture is, from the lights alone: the same scene gives the same picture.

use glam::Vec3;
use umbrage::core::{Aabb, Light, LightKind};

/// What a white, matte surface in full light gets in the picture, linear: leaves room for highlights.
const WHITE: f32 = 0.75;

/// Factor from radiance to picture, so that a white matte surface where the lights aim gets [`WHITE`].
///
/// A light's illuminance is taken at the middle of the scene, but never closer than a quarter of the scene's radius, so
/// that a lamp inside of a model does not turn everything else black.
pub fn automatic(lights: &[Light], bounds_world: &Aabb) -> f32 {
    let closest_m = (0.25 * bounds_world.radius()).max(f32::MIN_POSITIVE.sqrt());
    let center = bounds_world.center();
    let key_lux: f32 = lights
        .iter()
        .map(|light| {
            let distance_m = match light.kind {
                LightKind::Directional => 1.0,
                _ => light.position_world.distance(center).max(closest_m),
            };
            light.illuminance_lux(distance_m) * light.color.max_element()
        })
        .fold(0.0, f32::max);
    if key_lux > 0.0 && key_lux.is_finite() { WHITE * std::f32::consts::PI / key_lux } else { 1.0 }
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
            automatic(&[light], &bounds) * intensity / (height * height) / std::f32::consts::PI
        };
        for (height, intensity) in [(2.0, 1.0), (2.0, 5e4), (50.0, 3.0)] {
            assert!((at(height, intensity) - WHITE).abs() < 1e-3, "{height} {intensity}");
        }
        assert_eq!(automatic(&[], &bounds), 1.0);
    }
}
