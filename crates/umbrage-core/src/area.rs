//! An area light as many lights without area: places on it whose shadows are blended (Haeberli and Akeley 1990, "The Accumulation
//! Buffer"; Bjorke 2005, "Shadowing Strategies for HLSL and FX Composer").
//!
//! Places are the same for every surface, so each has maps of its own. They are spread evenly (Hammersley's points), so that the
//! error falls nearly with their number, not with its square root.

use crate::light::{Light, LightKind, LightShape, up_for};
use glam::{Quat, Vec2, Vec3};
use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

/// The digits of a whole number, mirrored behind the point: 0..1.
fn mirrored(mut index: u32, base: u32) -> f32 {
    let (mut value, mut digit) = (0.0f64, 1.0 / f64::from(base));
    while index > 0 {
        value += f64::from(index % base) * digit;
        digit /= f64::from(base);
        index /= base;
    }
    value as f32
}

/// A place of the unit square on the unit disc; areas keep their ratios (Shirley and Chiu 1997, "A Low Distortion Map Between Disk
/// and Square").
fn on_disc(square: Vec2) -> Vec2 {
    let p = 2.0 * square - 1.0;
    if p == Vec2::ZERO {
        return Vec2::ZERO;
    }
    let (radius, angle) = if p.x.abs() > p.y.abs() {
        (p.x, FRAC_PI_4 * p.y / p.x)
    } else {
        (p.y, FRAC_PI_2 - FRAC_PI_4 * p.x / p.y)
    };
    radius * Vec2::new(angle.cos(), angle.sin())
}

/// The radius in a unit ball within which a share of all places lies, if the ball is to look like an even disc from everywhere:
/// their density goes with 1 / sqrt(1 - r^2), whose projection along any direction is constant.
fn radius_in_ball(share: f32) -> f32 {
    let within = |r: f64| (r.asin() - r * (1.0 - r * r).sqrt()) * std::f64::consts::FRAC_2_PI;
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if within(middle) < f64::from(share) { low = middle } else { high = middle }
    }
    (0.5 * (low + high)) as f32
}

/// `count` places of a light, each a light of its kind without area; the light itself when it has none. All have the light's
/// intensity: their visibility is to be averaged.
///
/// `nearest_m` is how near to the light there is anything: the cones of a spot light's places are widened so that from there on each
/// sees all that the light's own cone holds.
pub fn places(light: &Light, count: u32, nearest_m: f32) -> Vec<Light> {
    let count = count.max(1);
    if light.shape == LightShape::Point || count == 1 {
        return vec![Light { shape: LightShape::Point, ..*light }];
    }
    let axes = light.world_from_light_rotation();
    let place = |i: u32| {
        let square = Vec2::new((i as f32 + 0.5) / count as f32, mirrored(i, 2));
        match light.shape {
            LightShape::Point => *light,
            LightShape::Disc { radius_m } => {
                let at = on_disc(square) * radius_m;
                moved(light, axes.x_axis * at.x + axes.y_axis * at.y, nearest_m)
            }
            LightShape::Rectangle { width_m, height_m } => {
                let at = (square - 0.5) * Vec2::new(width_m, height_m);
                moved(light, axes.x_axis * at.x + axes.y_axis * at.y, nearest_m)
            }
            LightShape::Sphere { radius_m } => {
                let (z, angle) = (1.0 - 2.0 * square.x, TAU * square.y);
                let way =
                    Vec3::new((1.0 - z * z).sqrt() * angle.cos(), (1.0 - z * z).sqrt() * angle.sin(), z);
                // The third of Hammersley's coordinates.
                moved(
                    light,
                    way * (radius_m * radius_in_ball(mirrored(i, 3).max(0.5 / count as f32))),
                    nearest_m,
                )
            }
            LightShape::Sun { angle_rad } => {
                let at = on_disc(square);
                // Even over the disc's solid angle, as the sky has it.
                let cos = 1.0 - at.length_squared() * (1.0 - (0.5 * angle_rad.min(PI)).cos());
                let sin = (1.0 - cos * cos).max(0.0).sqrt();
                let side = at.try_normalize().unwrap_or(Vec2::X);
                let direction = -axes.z_axis * cos + (axes.x_axis * side.x + axes.y_axis * side.y) * sin;
                turned(light, direction)
            }
        }
    };
    (0..count).map(place).collect()
}

fn moved(light: &Light, offset: Vec3, nearest_m: f32) -> Light {
    let kind = match light.kind {
        LightKind::Spot { inner_rad, outer_rad } => {
            let wider =
                (outer_rad.tan() + offset.length() / nearest_m.max(1e-6)).atan().min(1.4).max(outer_rad);
            LightKind::Spot { inner_rad, outer_rad: wider }
        }
        other => other,
    };
    Light { position_world: light.position_world + offset, kind, shape: LightShape::Point, ..*light }
}

fn turned(light: &Light, direction_world: Vec3) -> Light {
    let up_world = Quat::from_rotation_arc(light.direction_world.normalize(), direction_world.normalize())
        * light.up_world;
    let up_world = if up_world.is_finite() { up_world } else { up_for(direction_world) };
    Light { direction_world, up_world, shape: LightShape::Point, ..*light }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shaped(kind: LightKind, shape: LightShape) -> Light {
        Light { kind, shape, position_world: Vec3::new(1.0, 2.0, 3.0), ..Light::default() }
    }

    /// From any side, a quarter of the places lies within half of the radius: the ball looks like an even disc.
    #[test]
    fn a_ball_of_places_looks_like_an_even_disc_from_everywhere() {
        let light = shaped(LightKind::Point, LightShape::Sphere { radius_m: 2.0 });
        let all = places(&light, 4096, 1.0);
        for side in [Vec3::X, Vec3::Y, Vec3::new(1.0, -2.0, 0.7).normalize()] {
            for share in [0.25f32, 0.5, 0.75] {
                let within = all.iter().filter(|p| {
                    let offset = p.position_world - light.position_world;
                    offset.reject_from_normalized(side).length() <= 2.0 * share.sqrt()
                });
                let found = within.count() as f32 / all.len() as f32;
                assert!((found - share).abs() < 0.02, "{side}: {found} of all within {share}");
            }
        }
    }

    #[test]
    fn every_place_lies_on_its_light() {
        let spot = LightKind::Spot { inner_rad: 0.1, outer_rad: 0.5 };
        for (shape, kind) in [
            (LightShape::Disc { radius_m: 0.5 }, spot),
            (LightShape::Rectangle { width_m: 2.0, height_m: 0.5 }, spot),
            (LightShape::Sphere { radius_m: 0.5 }, LightKind::Point),
            (LightShape::Sun { angle_rad: 0.2 }, LightKind::Directional),
        ] {
            let light = shaped(kind, shape);
            let all = places(&light, 64, 4.0);
            assert_eq!(all.len(), 64);
            let mean = all.iter().map(|p| p.position_world).sum::<Vec3>() / 64.0;
            assert!(mean.distance(light.position_world) < 0.05, "{shape:?}: the middle is at {mean}");
            for place in &all {
                assert_eq!(place.check(), Ok(()));
                assert_eq!(place.shape, LightShape::Point);
                let offset = place.position_world - light.position_world;
                assert!(offset.length() <= shape.bounding_radius_m() + 1e-5, "{shape:?} {offset}");
                let turned = place.direction_world.angle_between(light.direction_world);
                let sun = if let LightShape::Sun { angle_rad } = shape { 0.5 * angle_rad } else { 0.0 };
                assert!(turned <= sun + 1e-3, "{shape:?} turned by {turned}");
            }
        }
    }

    #[test]
    fn a_point_has_one_place_and_a_widened_cone_holds_the_light_s_own() {
        assert_eq!(places(&Light::default(), 64, 1.0), [Light::default()]);
        let light =
            shaped(LightKind::Spot { inner_rad: 0.1, outer_rad: 0.4 }, LightShape::Disc { radius_m: 0.5 });
        for place in places(&light, 32, 2.0) {
            let LightKind::Spot { outer_rad, .. } = place.kind else { panic!("a spot light") };
            for i in 0..16 {
                let angle = i as f32 * 0.4;
                for depth_m in [2.0f32, 5.0] {
                    let rim = Vec3::new(angle.cos(), 0.0, angle.sin()) * depth_m * 0.4f32.tan();
                    let p = light.position_world + light.direction_world * depth_m + rim;
                    let seen = (p - place.position_world).angle_between(place.direction_world);
                    assert!(seen <= outer_rad + 1e-4, "{seen} {outer_rad}");
                }
            }
        }
    }
}
