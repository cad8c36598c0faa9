//! The view of a directional light: one parallel box around everything. (Cascades are a projection of their own.)

use super::{FitError, FitOptions, ShadowView};
use crate::bounds::Aabb;
use crate::depth::DEPTH;
use crate::light::Light;
use crate::projection::orthographic;
use crate::technique::Projection;
use glam::{Mat4, Vec3};

/// The least width of a map as a share of how far from the world's origin it lies: some hundred roundings.
pub(super) const ROUNDING: f32 = 2e-5;

pub(super) fn fit(
    light: &Light,
    bounds_world: &[Aabb],
    options: &FitOptions,
) -> Result<ShadowView, FitError> {
    let light_rotation_from_world = Mat4::from_mat3(light.world_from_light_rotation().transpose());
    let bounds_light = bounds_world
        .iter()
        .filter(|b| !b.is_empty())
        .fold(Aabb::EMPTY, |all, b| all.union(&b.transformed(&light_rotation_from_world)));
    if bounds_light.is_empty() {
        return Err(FitError::NothingInReach);
    }
    let (size, center) = (bounds_light.size(), bounds_light.center());
    // Square texels: the longer side sets their size. A texel of margin keeps the outermost caster inside the map.
    // No map is so small that the rounding of places in the world is a part of it.
    let least_m = ROUNDING * bounds_light.min.abs().max(bounds_light.max.abs()).max_element();
    let least_m = least_m.max(f32::MIN_POSITIVE.sqrt());
    let half_m = 0.5 * size.x.max(size.y).max(size.z * 1e-3).max(least_m);
    let half_m = half_m * options.widened() * (1.0 + 2.0 / options.size_texel.max(4) as f32);
    let depth_m = size.z.max(half_m * 1e-3);
    let near_m = (0.01 * depth_m).max(least_m);
    let back_off_m = bounds_light.max.z + 2.0 * near_m;
    let light_from_world =
        Mat4::from_translation(-Vec3::new(center.x, center.y, back_off_m)) * light_rotation_from_world;
    let far_m = depth_m + 3.0 * near_m;
    Ok(ShadowView {
        light_from_world,
        clip_from_light: orthographic(half_m, half_m, near_m, far_m, DEPTH),
        near_m,
        far_m,
        texel_m: 2.0 * half_m / options.size_texel as f32,
        perspective: false,
        projection: Projection::Fitted,
        fallback: None,
    })
}

#[cfg(test)]
mod tests {
    use super::super::fit;
    use super::*;
    use crate::light::LightKind;
    use crate::lookup::locate;

    #[test]
    fn every_corner_is_inside_at_any_scale_and_direction() {
        let options = FitOptions { size_texel: 512, ..FitOptions::default() };
        for scale in [1e-3f32, 1.0, 1e5] {
            for direction in [Vec3::NEG_Y, Vec3::new(1.0, -2.0, 0.3), Vec3::X] {
                let kind = LightKind::Directional;
                let light = Light { kind, ..Light::default() }.aimed(Vec3::ZERO, direction);
                let seen = [
                    Aabb { min: Vec3::splat(-scale), max: Vec3::splat(scale) },
                    Aabb { min: Vec3::new(4.0, 0.0, 0.0) * scale, max: Vec3::new(5.0, 0.0, 7.0) * scale },
                ];
                let view = fit(&light, &seen, &options).expect("two boxes");
                for corner in seen.iter().flat_map(Aabb::corners) {
                    let at = locate(&view.texture_from_world(), corner);
                    assert!(at.inside && (0.0..=1.0).contains(&at.depth), "{scale} {direction} {at:?}");
                }
            }
        }
    }
}
