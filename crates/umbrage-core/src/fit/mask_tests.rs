//! What masks promise: the outline stays within the free texels and fills them, and nothing leaks past them.

use super::*;
use crate::lookup::locate;
use glam::UVec2;
use proptest::prelude::*;

fn vec3(range: std::ops::Range<f32>) -> impl Strategy<Value = Vec3> {
    (range.clone(), range.clone(), range).prop_map(Vec3::from)
}

fn kind() -> impl Strategy<Value = LightKind> {
    prop_oneof![
        Just(LightKind::Point),
        Just(LightKind::Directional),
        (0.1f32..1.5).prop_map(|outer_rad| LightKind::Spot { inner_rad: 0.0, outer_rad }),
    ]
}

fn options() -> impl Strategy<Value = MaskOptions> {
    let ratios = prop::sample::select(vec![Ratios::Adaptive, Ratios::Symmetric, Ratios::Fixed]);
    let frame = prop::sample::select(vec![Frame::Mean, Frame::Box]);
    (8u32..=4096, 1u32..=3, frame, ratios).prop_map(|(size_texel, border_texel, frame, ratios)| MaskOptions {
        size_texel,
        border_texel,
        frame,
        ratios,
        fixed_half_m: 30.0,
    })
}

fn point_light(x: f32, y: f32, z: f32) -> Light {
    Light { kind: LightKind::Point, ..Light::default() }.aimed(Vec3::new(x, y, z), Vec3::ZERO)
}

fn unit_box() -> [Vec3; 8] {
    Aabb { min: Vec3::splat(-1.0), max: Vec3::splat(1.0) }.corners()
}

/// Where a point lands in the mask, texels from its upper left corner, in the shader's precision.
fn texel_of(view: &MaskView, p: Vec3) -> Vec2 {
    locate(&view.texture_from_world(), p).uv * view.size_texel as f32
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1024))]

    #[test]
    fn axes_are_of_unit_length_and_at_right_angles(way in vec3(-1.0..1.0), flat in 0u8..8) {
        let zeroed = Vec3::new((flat & 1) as f32, (flat >> 1 & 1) as f32, (flat >> 2) as f32);
        for way in [way, way * zeroed, Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z, Vec3::ONE] {
            let Some(forward) = way.as_dvec3().try_normalize() else { continue };
            let axes = axes(forward);
            prop_assert!((axes.transpose() * axes).abs_diff_eq(DMat3::IDENTITY, 1e-12), "{way}");
            // Right, up and forwards, as the light sees it: what is right stays right.
            prop_assert!((axes.determinant() + 1.0).abs() < 1e-12, "{way}");
        }
    }

    #[test]
    fn all_of_the_blocker_lands_within_the_free_texels(
        points in prop::collection::vec(vec3(-2.0..2.0), 2..40), at in vec3(-9.0..9.0), aside in vec3(-1.0..1.0),
        far_off in 0f32..500.0, scale in -3i32..4, kind in kind(), options in options(),
        weights in prop::collection::vec(0f32..1.0, 40),
    ) {
        let scale = 10f32.powi(scale);
        let offset = Vec3::new(far_off, 0.0, -far_off);
        let points: Vec<Vec3> = points.iter().map(|p| (*p + offset) * scale).collect();
        let light = Light { kind, ..Light::default() }.aimed((at + offset) * scale, (aside + offset) * scale);
        let options = MaskOptions { fixed_half_m: options.fixed_half_m * scale, ..options };
        let Ok(view) = fit_mask(&light, points.iter().copied(), &options) else { return Ok(()) };
        let (low, high) = (options.border_texel as f32, (options.size_texel - options.border_texel) as f32);
        let sum: f32 = weights[..points.len()].iter().sum::<f32>().max(1e-3);
        let inner = points.iter().zip(&weights).map(|(p, w)| *p * (*w / sum)).sum::<Vec3>();
        for p in points.iter().copied().chain((sum > 1e-2).then_some(inner)) {
            let at = texel_of(&view, p);
            prop_assert!(at.min_element() >= low && at.max_element() <= high, "{at} of {view:?}");
            let clip = view.clip_from_world() * p.extend(1.0);
            prop_assert!(clip.w > 0.0 && clip.z > 0.0 && clip.z < clip.w, "{clip} is clipped");
        }
    }

    #[test]
    fn an_adaptive_outline_touches_all_four_sides(
        points in prop::collection::vec(vec3(-2.0..2.0), 4..40), at in vec3(-9.0..9.0), kind in kind(),
        options in options(),
    ) {
        let light = Light { kind, ..Light::default() }.aimed(at, Vec3::ZERO);
        let adaptive = MaskOptions { ratios: Ratios::Adaptive, ..options };
        let Ok(view) = fit_mask(&light, points.iter().copied(), &adaptive) else { return Ok(()) };
        let all: Vec<Vec2> = points.iter().map(|p| texel_of(&view, *p)).collect();
        let low = all.iter().fold(Vec2::INFINITY, |a, b| a.min(*b)) - view.border_texel as f32;
        let high = (view.size_texel - view.border_texel) as f32 - all.iter().fold(Vec2::ZERO, |a, b| a.max(*b));
        let hair = 1e-3 * view.size_texel as f32;
        prop_assert!(low.max_element() < hair && high.max_element() < hair, "{low} {high} of {view:?}");
        let symmetric = MaskOptions { ratios: Ratios::Symmetric, ..adaptive };
        let symmetric = fit_mask(&light, points.iter().copied(), &symmetric).expect("the same points");
        let on = |view: &MaskView| view.texels_on(points.iter().copied());
        prop_assert!(on(&view) >= on(&symmetric) * (1.0 - 1e-3));
        // And the article's touches one side of each pair.
        let reach = points.iter().map(|p| texel_of(&symmetric, *p) - 0.5 * view.size_texel as f32);
        let reach = reach.fold(Vec2::ZERO, |a, b| a.max(b.abs()));
        let free = 0.5 * view.size_texel as f32 - view.border_texel as f32;
        prop_assert!((reach - free).abs().max_element() < hair, "{reach} {free}");
    }
}

/// A mask as a pass draws it: 1 where a texel's centre lies in a triangle.
fn drawn(view: &MaskView, triangles: &[[Vec3; 3]]) -> Vec<f32> {
    let n = view.size_texel;
    let mut mask = vec![0.0; (n * n) as usize];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|p| texel_of(view, p).as_dvec2());
        for (y, x) in (0..n).flat_map(|y| (0..n).map(move |x| (y, x))) {
            let p = UVec2::new(x, y).as_dvec2() + 0.5;
            let sides = [(a, b), (b, c), (c, a)].map(|(a, b)| (b - a).perp_dot(p - a));
            if sides.iter().all(|s| *s >= 0.0) || sides.iter().all(|s| *s <= 0.0) {
                mask[(y * n + x) as usize] = 1.0;
            }
        }
    }
    mask
}

/// A linear lookup, clamped to the edge, as a sampler does it.
fn clamped(mask: &[f32], n: u32, uv: Vec2) -> f32 {
    let place = uv.clamp(Vec2::ZERO, Vec2::ONE) * n as f32 - 0.5;
    let corner = place.floor();
    let share = place - corner;
    let texel = |dx: f32, dy: f32| {
        let at = (corner + Vec2::new(dx, dy)).clamp(Vec2::ZERO, Vec2::splat(n as f32 - 1.0)).as_uvec2();
        mask[(at.y * n + at.x) as usize]
    };
    let row = |dy| texel(0.0, dy) + share.x * (texel(1.0, dy) - texel(0.0, dy));
    row(0.0) + share.y * (row(1.0) - row(0.0))
}

/// The triangles of a box, whose outline fills much of its window.
fn box_triangles() -> Vec<[Vec3; 3]> {
    let c = unit_box();
    let faces = [[0, 2, 6, 4], [1, 5, 7, 3], [0, 4, 5, 1], [2, 3, 7, 6], [0, 1, 3, 2], [4, 6, 7, 5]];
    faces.iter().flat_map(|f| [[c[f[0]], c[f[1]], c[f[2]]], [c[f[0]], c[f[2]], c[f[3]]]]).collect()
}

/// The most that lookups all around the mask find, at the edge and far away.
fn leak(view: &MaskView) -> f32 {
    let mask = drawn(view, &box_triangles());
    assert!(mask.contains(&1.0), "something was drawn");
    let edge = (0..=256).flat_map(|i| {
        let t = 3.0 * i as f32 / 256.0 - 1.0;
        let sides = |low: f32, high: f32| [(low, t), (high, t), (t, low), (t, high)];
        sides(0.0, 1.0).into_iter().chain(sides(-0.2, 1.2)).chain(sides(-50.0, 70.0))
    });
    edge.map(|(u, v)| clamped(&mask, view.size_texel, Vec2::new(u, v))).fold(0.0, f32::max)
}

#[test]
fn nothing_leaks_past_the_border_and_without_one_it_would() {
    // Straight before a face, so that the outline's edges run along the mask's.
    let straight = point_light(0.0, 0.0, 5.0);
    let sun = Light { kind: LightKind::Directional, ..Light::default() }.aimed(Vec3::Y, Vec3::ZERO);
    let aslant = point_light(2.0, 3.0, 4.0);
    for size_texel in [3, 8, 9, 64, 127, 256] {
        for light in [straight, sun, aslant] {
            for ratios in [Ratios::Adaptive, Ratios::Symmetric] {
                let options = MaskOptions { size_texel, ratios, ..MaskOptions::default() };
                let view =
                    fit_mask(&light, unit_box().into_iter(), &options).expect("a box before the light");
                assert_eq!(leak(&view), 0.0, "{size_texel} {ratios:?}");
            }
        }
        // The same projection without room for the border, as 0.98 instead of its formula leaves it in small masks.
        let options = MaskOptions { size_texel, ..MaskOptions::default() };
        let mut bare = fit_mask(&straight, unit_box().into_iter(), &options).expect("the same box");
        let grown = size_texel as f32 / (size_texel - 2) as f32;
        bare.clip_from_light = Mat4::from_scale(Vec3::new(grown, grown, 1.0)) * bare.clip_from_light;
        assert_eq!(leak(&bare), 1.0, "{size_texel}: the test sees a leak");
    }
}

#[test]
fn regions_follow_the_axis_and_nothing_is_behind_the_light() {
    let view =
        fit_mask(&point_light(0.0, 5.0, 0.0), unit_box().into_iter(), &MaskOptions::default()).expect("box");
    assert!((view.near_m - 4.0).abs() < 1e-5 && (view.far_m - 6.0).abs() < 1e-5, "{view:?}");
    for (y, region) in [
        (9.0, Region::Before),
        (5.0, Region::Before),
        (1.01, Region::Before),
        (0.99, Region::Beside),
        (-0.99, Region::Beside),
        (-1.01, Region::Beyond),
        (-1e6, Region::Beyond),
        (f32::NAN, Region::Before),
    ] {
        assert_eq!(view.region(Vec3::new(0.3, y, -0.2)), region, "{y}");
    }
    let sun = Light { kind: LightKind::Directional, ..Light::default() }.aimed(Vec3::ZERO, Vec3::NEG_Y);
    let view = fit_mask(&sun, unit_box().into_iter(), &MaskOptions::default()).expect("box");
    let regions = [1.5, 0.0, -1.5].map(|y| view.region(Vec3::Y * y));
    assert_eq!(regions, [Region::Before, Region::Beside, Region::Beyond]);
}

#[test]
fn every_refusal_says_why() {
    let (light, options) = (point_light(0.0, 5.0, 0.0), MaskOptions::default());
    let fit = |light: &Light, points: &[Vec3], options: &MaskOptions| {
        fit_mask(light, points.iter().copied(), options)
    };
    let unit = unit_box();
    let spot = |at: Vec3, to: Vec3| Light::spot(at, to, 0.1, 0.4);
    let small = MaskOptions { size_texel: 2, ..options };
    let fixed = MaskOptions { ratios: Ratios::Fixed, ..options };
    let pierced = [unit.as_slice(), &[Vec3::NAN]].concat();
    for (result, word) in [
        (fit(&light, &unit, &small), "3 or more"),
        (fit(&light, &unit, &MaskOptions { border_texel: 0, ..options }), "no room"),
        (fit(&light, &unit, &MaskOptions { border_texel: u32::MAX, ..options }), "no room"),
        (fit(&light, &unit, &MaskOptions { fixed_half_m: f32::NAN, ..options }), "fixed width"),
        (fit(&light, &[], &options), "no points"),
        (fit(&light, &pierced, &options), "not finite"),
        (fit(&point_light(0.1, 0.2, 0.3), &unit, &options), "160 degrees"),
        (fit(&Light { position_world: Vec3::ZERO, ..light }, &unit, &options), "160 degrees"),
        (fit(&point_light(0.0, 1.05, 0.0), &unit, &options), "160 degrees"),
        (fit(&spot(Vec3::Y * 5.0, Vec3::Y * 9.0), &unit, &options), "does not reach"),
        (fit(&spot(Vec3::Y * 5.0, Vec3::X * 30.0), &unit, &options), "does not reach"),
        (fit(&Light { range_m: Some(2.0), ..light }, &unit, &options), "does not reach"),
        (fit(&point_light(0.0, 1.5, 0.0), &unit, &fixed), "adaptive"),
        (fit(&light, &[Vec3::ONE], &options), "single precision"),
        (fit(&light, &unit.map(|p| p * 1e-3 + 1e6), &options), "single precision"),
        (fit(&light, &unit.map(|p| p * 3e38), &options), "160 degrees"),
        (fit(&Light { intensity: f32::NAN, ..light }, &unit, &options), "intensity"),
    ] {
        let message = result.expect_err(word).to_string();
        assert!(message.contains(word) && !message.contains('\n'), "{word}: {message}");
    }
}

#[test]
fn a_fixed_mask_loses_texels_where_an_adaptive_one_does_not() {
    let on = |ratios, at: f32| {
        let options = MaskOptions { size_texel: 256, ratios, ..MaskOptions::default() };
        let view = fit_mask(&point_light(0.0, at, 0.0), unit_box().into_iter(), &options).expect("a box");
        view.texels_on(unit_box())
    };
    // A face straight before the light fills the free texels whatever the distance.
    for at in [3.0, 6.0, 30.0] {
        assert!((on(Ratios::Adaptive, at) / (254.0 * 254.0) - 1.0).abs() < 1e-3);
        let share = on(Ratios::Fixed, at) * (at - 1.0).powi(2) as f64 / (254.0 * 254.0);
        assert!((share - 1.0).abs() < 1e-3, "by the square of the distance: {share}");
    }
}
