//! The view of a spot light: its cone, with near and far fitted to what is in it.

use super::convex::{Convex, Held};
use super::seen::TIP;
use super::{FitError, FitOptions, ShadowView};
use crate::bounds::Aabb;
use crate::depth::DEPTH;
use crate::light::Light;
use crate::projection::perspective;
use crate::technique::Projection;
use glam::{DVec3, Mat3, Mat4};

/// The axis along which a light looks.
struct Axis {
    direction: DVec3,
    offset: f64,
}

impl Axis {
    fn new(light_from_world: &Mat4) -> Self {
        let row = -light_from_world.as_dmat4().row(2);
        Self { direction: row.truncate(), offset: row.w }
    }

    /// Between which distances along it a box lies, metres: those of its corners, but for the last bit.
    fn along(&self, bounds: &Aabb) -> (f32, f32) {
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let at = self.direction.dot(0.5 * (min + max)) + self.offset;
        let reach = self.direction.abs().dot(0.5 * (max - min));
        ((at - reach) as f32, (at + reach) as f32)
    }
}

pub(super) fn fit(
    light: &Light,
    outer_rad: f32,
    bounds_world: &[Aabb],
    options: &FitOptions,
) -> Result<ShadowView, FitError> {
    pyramid(light, light.world_from_light_rotation(), outer_rad.tan(), bounds_world, options)
}

/// A square pyramid from the light's place along -Z of `world_from_light_rotation`, `tan_half` wide to each side and wider by
/// the border that was asked for.
pub(super) fn pyramid(
    light: &Light,
    world_from_light_rotation: Mat3,
    tan_half: f32,
    bounds_world: &[Aabb],
    options: &FitOptions,
) -> Result<ShadowView, FitError> {
    let world_from_light =
        Mat4::from_translation(light.position_world) * Mat4::from_mat3(world_from_light_rotation);
    let light_from_world = world_from_light.inverse();
    let tan_outer = tan_half * options.widened();

    let axis = Axis::new(&light_from_world);
    let farthest = |bounds: &Aabb| {
        let depths = bounds.corners().map(|corner| -light_from_world.transform_point3(corner).z);
        depths.into_iter().fold(0.0f32, f32::max)
    };
    let everything_m = bounds_world.iter().filter(|b| !b.is_empty()).fold(0.0f32, |most, bounds| {
        if axis.along(bounds).1 < most * 0.9999 { most } else { most.max(farthest(bounds)) }
    });
    let reach_m = light.far_m.or(light.range_m).unwrap_or(f32::INFINITY).min(everything_m * 1.001);
    if reach_m <= 0.0 {
        return Err(FitError::NothingInReach);
    }
    // The map's pyramid down to the farthest box. What of each box lies in it tells the range: a floor that reaches
    // below the light counts only where the light sees it.
    let (tan, reach) = (f64::from(tan_outer), f64::from(reach_m));
    let pyramid = Convex::from_corners(std::array::from_fn(|i| {
        let along = if i & 4 == 0 { TIP * reach } else { reach };
        let side = |bit: usize| if i & bit == 0 { -along * tan } else { along * tan };
        DVec3::new(side(1), side(2), -along)
    }));
    let light_from_world_f64 = light_from_world.as_dmat4();
    let corners = |b: &Aabb| b.corners().map(|p| light_from_world_f64.transform_point3(p.as_dvec3()));
    // Of many boxes few decide: first those that are wholly inside, then those that it cuts, which cost more.
    let (mut nearest_m, mut farthest_m) = (f32::INFINITY, 0.0f32);
    for wanted in [Held::All, Held::Part] {
        for bounds in bounds_world.iter().filter(|b| !b.is_empty()) {
            let (from, to) = axis.along(bounds);
            if to < 0.0 || from > reach_m || from >= nearest_m && to <= farthest_m {
                continue;
            }
            let corners = corners(bounds);
            if pyramid.holds(&corners) != wanted {
                continue;
            }
            let mut widen = |p: &DVec3| {
                let along = -p.z as f32;
                (nearest_m, farthest_m) = (nearest_m.min(along), farthest_m.max(along));
            };
            if wanted == Held::All {
                corners.iter().for_each(&mut widen);
            } else {
                pyramid.common(corners).iter().for_each(&mut widen);
            }
        }
    }
    if farthest_m <= 0.0 {
        return Err(FitError::NothingInReach);
    }

    // A hair of room, so that a surface exactly on a plane is not lost to rounding.
    let far_m = light.far_m.unwrap_or((farthest_m * 1.001).min(reach_m));
    let near_m = light.near_m.unwrap_or((nearest_m * 0.999).max(far_m * options.least_near));
    // Everything on one plane that faces the light, or a near plane that was asked for behind it: keep some depth.
    let near_m = near_m.min(far_m * 0.99);
    Ok(ShadowView {
        light_from_world,
        clip_from_light: perspective(tan_outer, tan_outer, near_m, far_m, DEPTH),
        near_m,
        far_m,
        texel_m: 2.0 * tan_outer / options.size_texel as f32,
        perspective: true,
        projection: Projection::Fitted,
        fallback: None,
    })
}

#[cfg(test)]
mod tests {
    use super::super::fit;
    use super::*;
    use crate::lookup::locate;
    use glam::Vec3;

    fn options() -> FitOptions {
        FitOptions { size_texel: 512, ..FitOptions::default() }
    }

    fn around(center: Vec3, half: f32) -> Aabb {
        Aabb { min: center - half, max: center + half }
    }

    #[test]
    fn near_and_far_hug_what_is_in_the_cone() {
        let light = Light::spot(Vec3::new(0.0, 10.0, 0.0), Vec3::ZERO, 0.3, 0.5);
        let seen =
            [around(Vec3::ZERO, 1.0), around(Vec3::new(0.0, 4.0, 0.0), 0.5), around(Vec3::X * 90.0, 1.0)];
        let view = fit(&light, &seen, &options()).expect("three boxes, two in the cone");
        assert!(view.near_m <= 5.5 && view.near_m > 5.4, "near {}", view.near_m);
        assert!(view.far_m >= 11.0 && view.far_m < 11.1, "far {}", view.far_m);
        for corner in seen[0].corners() {
            let at = locate(&view.texture_from_world(), corner);
            assert!(at.inside && at.depth >= 0.0 && at.depth <= 1.0, "{at:?}");
        }
    }

    /// What is skipped for speed would not have changed the view: in any order of the boxes, and with each given twice.
    #[test]
    fn boxes_that_decide_nothing_change_nothing() {
        let light = Light::spot(Vec3::new(3.0, 40.0, -2.0), Vec3::new(1.0, 0.0, 1.0), 0.3, 0.7);
        let mut state = 1u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1u32 << 24) as f32
        };
        for scale in [1e-3f32, 1.0, 1e4] {
            let light = Light { position_world: light.position_world * scale, ..light };
            let mut boxes: Vec<Aabb> = (0..300)
                .map(|_| {
                    around(
                        Vec3::new(random() - 0.5, random(), random() - 0.5) * 60.0 * scale,
                        random() * scale,
                    )
                })
                .collect();
            let view = fit(&light, &boxes, &options()).expect("boxes");
            boxes.reverse();
            assert_eq!(fit(&light, &boxes, &options()), Ok(view));
            let twice: Vec<Aabb> = boxes.iter().chain(&boxes).copied().collect();
            assert_eq!(fit(&light, &twice, &options()), Ok(view));
            // One by one: each box's own range is in that of all.
            let alone = boxes.iter().filter_map(|b| fit(&light, &[*b], &options()).ok());
            let (near, far) =
                alone.fold((f32::INFINITY, 0.0f32), |(n, f), v| (n.min(v.near_m), f.max(v.far_m)));
            assert!(view.near_m <= near * 1.001 && view.far_m >= far * 0.999, "{view:?} {near} {far}");
        }
    }

    #[test]
    fn a_light_inside_a_box_keeps_a_near_plane() {
        let light = Light::spot(Vec3::ZERO, Vec3::NEG_Y, 0.3, 0.5);
        let view = fit(&light, &[around(Vec3::ZERO, 8.0)], &options()).expect("it is inside");
        assert!(view.near_m > 0.0 && view.near_m < 0.01 && view.far_m > 8.0, "{view:?}");
    }

    #[test]
    fn nothing_in_the_cone_is_said() {
        let light = Light::spot(Vec3::ZERO, Vec3::NEG_Y, 0.3, 0.5);
        assert_eq!(fit(&light, &[around(Vec3::Y * 20.0, 1.0)], &options()), Err(FitError::NothingInReach));
        assert_eq!(fit(&light, &[], &options()), Err(FitError::NothingInReach));
    }

    #[test]
    fn asked_for_planes_are_kept() {
        let light = Light {
            near_m: Some(1.0),
            far_m: Some(30.0),
            ..Light::spot(Vec3::Y * 9.0, Vec3::ZERO, 0.3, 0.5)
        };
        let view = fit(&light, &[around(Vec3::ZERO, 1.0)], &options()).expect("one box");
        assert_eq!((view.near_m, view.far_m), (1.0, 30.0));
    }

    #[test]
    fn any_scale_fits() {
        for scale in [1e-3f32, 1.0, 1e5] {
            let light = Light::spot(Vec3::Y * 10.0 * scale, Vec3::ZERO, 0.3, 0.5);
            let view = fit(&light, &[around(Vec3::ZERO, scale)], &options()).expect("one box");
            assert!((view.far_m / scale - 11.0).abs() < 0.05, "{scale}: {view:?}");
            assert!(view.clip_from_world().is_finite(), "{scale}");
        }
    }
}
