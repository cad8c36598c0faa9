//! What the fits that follow the eye promise, by points drawn at random: no visible shadow is lost.

use super::*;
use crate::camera::Projection as Lens;
use crate::lookup::{Located, locate};
use glam::DVec3;
use proptest::prelude::*;

fn vec3(range: std::ops::Range<f32>) -> impl Strategy<Value = Vec3> {
    (range.clone(), range.clone(), range).prop_map(Vec3::from)
}

fn boxes() -> impl Strategy<Value = Vec<Aabb>> {
    let one = (vec3(-8.0..8.0), vec3(0.0..4.0), any::<bool>()).prop_map(|(at, size, flat)| {
        let size = if flat { size * Vec3::new(3.0, 0.0, 3.0) } else { size };
        Aabb { min: at, max: at + size }
    });
    prop::collection::vec(one, 1..7)
}

fn light() -> impl Strategy<Value = Light> {
    (vec3(-12.0..12.0), vec3(-4.0..4.0), 0.15f32..1.2, any::<bool>()).prop_map(|(at, to, outer, parallel)| {
        let spot = Light::spot(at, to, 0.0, outer);
        if parallel { Light { kind: LightKind::Directional, ..spot } } else { spot }
    })
}

fn eye() -> impl Strategy<Value = Eye> {
    (vec3(-9.0..9.0), vec3(-4.0..4.0), 0.3f32..2.0, 0.5f32..2.0, 0.05f32..1.0, 5.0f32..60.0, 0u8..4).prop_map(
        |(at, to, fov, aspect, near, far, kind)| {
            let mut camera = Camera::look_at(at, to, fov, near, far);
            if kind == 0 {
                camera.projection = Lens::Orthographic { half_height_m: 3.0 * fov };
            }
            Eye { camera, aspect }
        },
    )
}

fn scaled(scale: f32, light: &Light, eye: &Eye, bounds: &[Aabb]) -> (Light, Eye, Vec<Aabb>) {
    let mut eye = *eye;
    eye.camera.position_world *= scale;
    eye.camera.near_m *= scale;
    eye.camera.far_m *= scale;
    if let Lens::Orthographic { half_height_m } = &mut eye.camera.projection {
        *half_height_m *= scale;
    }
    let bounds = bounds.iter().map(|b| Aabb { min: b.min * scale, max: b.max * scale }).collect();
    (Light { position_world: light.position_world * scale, ..*light }, eye, bounds)
}

/// Does the eye see the point, were nothing in between?
fn sees(eye: &Eye, p: Vec3) -> bool {
    let clip = eye.camera.clip_from_view(eye.aspect, DEPTH) * eye.camera.view_from_world() * p.extend(1.0);
    clip.w > 0.0 && clip.x.abs() <= clip.w && clip.y.abs() <= clip.w && (0.0..=clip.w).contains(&clip.z)
}

fn in_cone(light: &Light, p: Vec3) -> bool {
    match light.kind {
        LightKind::Spot { outer_rad, .. } => {
            (p - light.position_world).angle_between(light.direction_world) < outer_rad
        }
        _ => true,
    }
}

fn at(view: &ShadowView, p: Vec3) -> Located {
    locate(&view.texture_from_world(), p)
}

fn follower() -> impl Strategy<Value = Projection> {
    prop::sample::select(&Projection::ALL[1..])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(768))]

    #[test]
    fn no_visible_shadow_is_lost(
        light in light(), eye in eye(), bounds in boxes(), projection in follower(),
        scale in prop::sample::select(vec![1e-3f32, 1.0, 1e4]),
        draws in prop::collection::vec((0usize..7, (0.0f32..1.0, 0.0f32..1.0, 0.0f32..1.0)), 200),
    ) {
        let (light, eye, bounds) = scaled(scale, &light, &eye, &bounds);
        let options = FitOptions { size_texel: 256, projection, eye: Some(eye), ..FitOptions::default() };
        let Ok(view) = fit(&light, &bounds, &options) else { return Ok(()) };
        prop_assert!(view.clip_from_world().is_finite() && view.near_m < view.far_m && view.near_m > 0.0);
        let place = |(index, t): (usize, (f32, f32, f32))| {
            let bounds = &bounds[index % bounds.len()];
            bounds.min + bounds.size() * Vec3::from(t)
        };
        let along = |p: Vec3| -view.light_from_world.transform_point3(p).z;
        let points: Vec<Vec3> = draws.into_iter().map(place).collect();
        for &receiver in points.iter().filter(|p| sees(&eye, **p) && in_cone(&light, **p)) {
            let there = at(&view, receiver);
            let floor = view.far_m * options.least_near;
            if view.perspective && along(receiver) <= floor * 1.01 {
                continue;
            }
            prop_assert!(there.inside && (0.0..=1.0).contains(&there.depth), "{there:?} {view:?}");

            // Every box that the ray from the light crosses before the receiver can cast on it.
            let start = if view.perspective { light.position_world }
                else { receiver - light.direction_world * 100.0 * scale };
            for caster in &bounds {
                let Some(t) = crossed(caster, start, receiver) else { continue };
                let p = start + (receiver - start) * t;
                if view.perspective && along(p) <= floor * 1.01 {
                    continue;
                }
                let on_ray = at(&view, p);
                // Places are rounded, and the ray starts far away: so much is that in the map.
                let rounded_m = 3e-5 * f64::from(scale);
                let depth = 1e-5 + rounded_m * view.depth_per_metre(p).max(view.depth_per_metre(receiver));
                let texels = view.texel_density(p, -light.direction_world, 256).most * rounded_m;
                prop_assert!(f64::from(on_ray.depth) <= 1.0 + depth, "{on_ray:?}");
                prop_assert!(f64::from(on_ray.depth - there.depth) >= -depth, "{on_ray:?} {there:?}");
                let apart = f64::from((on_ray.uv - there.uv).length()) * 256.0;
                prop_assert!(apart <= 1.0 + texels, "{on_ray:?} {there:?}");
            }
        }
    }

    #[test]
    fn nothing_that_is_handed_in_panics(
        numbers in prop::collection::vec(prop::sample::select(vec![
            0.0f32, 1.0, -1.0, 1e-38, 1e38, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 3.0, 1e-6, 1e9,
        ]), 24),
        projection in follower(), parallel in any::<bool>(), border in prop::sample::select(vec![0.0f32, 1e9, f32::NAN]),
        size_texel in prop::sample::select(vec![0u32, 1, 3, 2048]),
    ) {
        let v = |i: usize| Vec3::new(numbers[i], numbers[i + 1], numbers[i + 2]);
        let spot = Light::spot(v(0), v(3), 0.0, numbers[6]);
        let light = if parallel { Light { kind: LightKind::Directional, ..spot } } else { spot };
        let camera = Camera::look_at(v(7), v(10), numbers[13], numbers[14], numbers[15]);
        let bounds = [Aabb { min: v(16), max: v(19) }, Aabb { min: v(0), max: v(0) }, Aabb::EMPTY];
        let eye = Some(Eye { camera, aspect: numbers[22] });
        let options =
            FitOptions { size_texel, projection, eye, border_texel: border, least_near: numbers[23] };
        if let Ok(view) = fit(&light, &bounds, &options) && view.projection != Projection::Fitted {
            prop_assert!(view.clip_from_world().is_finite(), "{view:?}");
        }
    }
}

/// Where a segment enters a box, as a share of its way; `None` where it does not.
fn crossed(bounds: &Aabb, from: Vec3, to: Vec3) -> Option<f32> {
    let way = to - from;
    let (mut enter, mut leave) = (0.0f32, 1.0f32);
    for axis in 0..3 {
        if way[axis].abs() < 1e-12 {
            if from[axis] < bounds.min[axis] || from[axis] > bounds.max[axis] {
                return None;
            }
            continue;
        }
        let (a, b) =
            ((bounds.min[axis] - from[axis]) / way[axis], (bounds.max[axis] - from[axis]) / way[axis]);
        enter = enter.max(a.min(b));
        leave = leave.min(a.max(b));
    }
    (enter <= leave).then_some(enter)
}

fn ground() -> Vec<Aabb> {
    let post = |x: f32| Aabb { min: Vec3::new(x, 0.0, -0.2), max: Vec3::new(x + 0.4, 3.0, 0.2) };
    let mut bounds = vec![Aabb { min: Vec3::new(-20.0, 0.0, -20.0), max: Vec3::new(20.0, 0.0, 20.0) }];
    bounds.extend((-4..5).map(|i| post(3.0 * i as f32)));
    bounds
}

fn standing() -> Camera {
    Camera::look_at(Vec3::new(-15.0, 1.7, 1.0), Vec3::new(0.0, 1.7, 1.0), 0.9, 0.1, 80.0)
}

fn sun(toward: Vec3) -> Light {
    Light { kind: LightKind::Directional, ..Light::default() }.aimed(toward, Vec3::ZERO)
}

fn fitted_to(light: &Light, camera: Camera, projection: Projection) -> ShadowView {
    let eye = Some(Eye { camera, aspect: 1.6 });
    fit(light, &ground(), &FitOptions { projection, eye, ..FitOptions::default() }).expect("a view")
}

const WARPS: [Projection; 2] = [Projection::Perspective, Projection::LightSpacePerspective];

#[test]
fn the_singular_cases_have_views() {
    // Before, behind, beside and above the eye; along its line and against it; in its plane, where the light is at
    // infinity behind the eye's perspective.
    for toward in
        [Vec3::new(1.0, 0.4, 0.0), Vec3::new(-1.0, 0.4, 0.0), Vec3::Z, Vec3::Y, Vec3::X, Vec3::NEG_X]
            .map(|v| v * 9.0)
    {
        for projection in WARPS {
            for light in [sun(toward), Light::spot(toward + Vec3::Y, Vec3::ZERO, 0.1, 0.9)] {
                let view = fitted_to(&light, standing(), projection);
                assert!(view.clip_from_world().is_finite(), "{toward} {view:?}");
            }
        }
    }
}

#[test]
fn what_is_asked_for_is_got_or_the_reason_said() {
    let across = sun(Vec3::new(0.3, 9.0, 2.0));
    for projection in &Projection::ALL[1..] {
        let view = fitted_to(&across, standing(), *projection);
        assert_eq!((view.projection, view.fallback), (*projection, None));
    }
    let parallel = Camera { projection: Lens::Orthographic { half_height_m: 4.0 }, ..standing() };
    let straight_down = Camera::look_at(Vec3::Y * 30.0, Vec3::ZERO, 0.5, 1.0, 60.0);
    let away = Camera::look_at(Vec3::Y * 50.0, Vec3::Y * 90.0, 0.5, 1.0, 60.0);
    for projection in WARPS {
        let got = |camera| {
            let view = fitted_to(&across, camera, projection);
            (view.projection, view.fallback)
        };
        assert_eq!(got(parallel), (Projection::Adaptive, Some(Fallback::ParallelEye)));
        assert_eq!(got(away), (Projection::Fitted, Some(Fallback::NothingSeen)));
        let along = fitted_to(&sun(Vec3::Y * 9.0), straight_down, projection);
        assert!(along.fallback.is_none_or(|why| why == Fallback::NoGain), "{along:?}");
        let blind = fit(&across, &ground(), &FitOptions { projection, ..FitOptions::default() });
        assert_eq!(blind.map(|view| view.fallback), Ok(Some(Fallback::NoEye)));
    }
}

#[test]
fn a_warp_fades_as_eye_and_light_come_into_line() {
    // The steepness of w over the map tells how strong the warp is.
    let strength = |gamma: f32| {
        let camera = Camera::look_at(Vec3::Y * 30.0, Vec3::ZERO, 0.8, 1.0, 60.0);
        let light = sun(Vec3::new(gamma.sin(), gamma.cos(), 0.0) * 9.0);
        let c = fitted_to(&light, camera, Projection::LightSpacePerspective).clip_from_light.row(3);
        c.truncate().length() / c.w.abs().max(1e-30)
    };
    assert!(strength(0.0) < 1e-3, "{}", strength(0.0));
    assert!(strength(0.1) <= strength(0.9), "{} {}", strength(0.1), strength(0.9));
}

#[test]
fn near_and_far_fitted_to_the_view_give_more_depth_steps() {
    // Row I6: steps of a 16-bit map at the receivers' depth, beside planes at 1 cm and 1 km.
    let light = Light::spot(Vec3::new(-9.0, 10.0, 9.5), Vec3::Y, 0.42, 0.55);
    let naive = Light { near_m: Some(0.01), far_m: Some(1000.0), ..light };
    let at = Vec3::new(0.0, 0.0, 1.0);
    let steps_per_m = |light: &Light, projection| {
        fitted_to(light, standing(), projection).depth_per_metre(at) * f64::from(u16::MAX)
    };
    let plain = steps_per_m(&naive, Projection::Fitted);
    for projection in [Projection::Fitted, Projection::Adaptive] {
        let fitted = steps_per_m(&light, projection);
        println!(
            "16-bit depth at 16 m: a step is {:.1} mm naive, {:.3} mm {}; gain {:.0}",
            1e3 / plain,
            1e3 / fitted,
            projection.row().id,
            fitted / plain
        );
        assert!(fitted > 100.0 * plain, "{fitted} {plain}");
    }
}

#[test]
fn depth_per_metre_is_the_difference_along_the_ray() {
    for light in
        [Light::spot(Vec3::new(-9.0, 10.0, 9.5), Vec3::Y, 0.42, 0.8), sun(Vec3::new(-9.0, 10.0, 9.5))]
    {
        for projection in Projection::ALL {
            let view = fitted_to(&light, standing(), *projection);
            let p = DVec3::new(-2.0, 0.0, 1.0);
            let from = if view.perspective {
                light.position_world.as_dvec3()
            } else {
                p - light.direction_world.as_dvec3()
            };
            let way = (p - from).normalize();
            let depth = |t: f64| view.clip_from_world().as_dmat4().project_point3(p + way * t).z;
            let by_difference = (depth(-0.01) - depth(0.01)) / 0.02;
            let found = view.depth_per_metre(p.as_vec3());
            assert!((found - by_difference).abs() < 1e-3 * found, "{projection:?} {found} {by_difference}");
        }
    }
}

#[test]
fn texels_are_counted_where_the_map_is_warped() {
    const SIDE: u32 = 1024;
    for light in
        [Light::spot(Vec3::new(-9.0, 10.0, 9.5), Vec3::Y, 0.42, 0.8), sun(Vec3::new(-9.0, 10.0, 9.5))]
    {
        for projection in Projection::ALL {
            let view = fitted_to(&light, standing(), *projection);
            let from_world = view.texture_from_world().as_dmat4();
            for p in [DVec3::new(-8.0, 0.0, 1.0), DVec3::new(5.0, 0.0, -2.0)] {
                let texel = |p: DVec3| from_world.project_point3(p).truncate() * f64::from(SIDE);
                let column = |way: DVec3| (texel(p + way * 1e-3) - texel(p - way * 1e-3)) / 2e-3;
                let (x, z) = (column(DVec3::X), column(DVec3::Z));
                let found = view.texel_density(p.as_vec3(), Vec3::Y, SIDE);
                let mean = x.perp_dot(z).abs().sqrt();
                assert!((found.mean - mean).abs() < 1e-3 * mean, "{projection:?} {found:?} {mean}");
                assert!(
                    (found.least * found.most - mean * mean).abs() < 1e-3 * mean * mean,
                    "{projection:?}"
                );
                // The nominal texel is the widest: no surface that faces the light has fewer texels.
                let along = -view.light_from_world.transform_point3(p.as_vec3()).z;
                let facing = view.texel_density(p.as_vec3(), -light.direction_world, SIDE);
                let nominal = 2048.0 / f64::from(SIDE) * f64::from(view.texel_size_m(along));
                assert!(1.0 / facing.least <= 1.001 * nominal, "{projection:?} {facing:?} {nominal}");
            }
        }
    }
}
