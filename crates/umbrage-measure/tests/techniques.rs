//! Shadow maps against ray-traced truth, through the same comparison that users run.

/// The scenes of the renderer's own tests.
#[path = "../../umbrage-render/tests/common/scenes.rs"]
#[allow(dead_code, reason = "its other scenes are for goldens")]
mod scenes;

mod common;

use common::{builtin, gpu, settings};
use glam::{UVec2, Vec3};
use std::ops::ControlFlow;
use umbrage_measure::{Cameras, Comparison, MeasureError, Plan, Row, compare};
use umbrage_render::umbrage::core::technique::{Projection, Settings};
use umbrage_render::umbrage::core::{Camera, Light, LightKind, LightShape};
use umbrage_render::{Gpu, RenderOptions};
use umbrage_scene::Scene;
use umbrage_truth::Quality;

const SIDE: u32 = 160;
/// A map this fine has texels below a pixel in these pictures, so that only the edge itself may be wrong.
const MAP: (&str, &str) = ("map_size", "2048");

fn plan(scene: &Scene, techniques: Vec<Settings>) -> Plan {
    Plan {
        cameras: Cameras::Each(vec![("first".into(), scene.cameras[0].camera)]),
        light_numbers: (0..scene.lights.len()).collect(),
        quality: Quality { samples: 32, seed: 0 },
        frames: 1,
        options: RenderOptions { size: UVec2::splat(SIDE), ..RenderOptions::new(techniques[0].clone()) },
        techniques,
    }
}

fn measured(gpu: &Gpu, scene: &Scene, techniques: Vec<Settings>) -> Comparison {
    compare(gpu, scene, &plan(scene, techniques), &|_: &str, _| ControlFlow::Continue(())).expect("measured")
}

fn with_light(mut scene: Scene, light: Light) -> Scene {
    scene.lights.truncate(1);
    scene.lights[0].light = light;
    scene
}

fn sun_of(scene: &Scene) -> Light {
    let spot = scene.lights[0].light;
    Light { kind: LightKind::Directional, intensity: 3.0, near_m: None, far_m: None, ..spot }
}

/// Pixels of a share of the sure ones.
fn pixels(row: &Row, share: f64, receivers: usize) -> usize {
    (share * (1.0 - row.errors.band) * receivers as f64).round() as usize
}

#[test]
fn away_from_edges_the_map_is_right() {
    let Some(gpu) = gpu() else { return };
    for name in ["torus", "columns", "contact", "tilt"] {
        for parallel in [false, true] {
            let mut scene = builtin(name);
            if parallel {
                let sun = sun_of(&scene);
                scene = with_light(scene, sun);
            }
            let techniques =
                vec![settings("unshadowed", &[]), settings("hard", &[MAP]), settings("linear", &[MAP])];
            let found = measured(&gpu, &scene, techniques);
            let receivers = found.views[0].receivers;
            let excluded = found.truth.excluded_pixels;
            assert!(receivers > 2000 && excluded * 1000 < u64::from(SIDE * SIDE), "{name}: {excluded}");
            for row in &found.rows[1..] {
                let sure = pixels(row, 1.0, receivers);
                let (acne, leak) =
                    (pixels(row, row.errors.acne, receivers), pixels(row, row.errors.leak, receivers));
                println!("{name} parallel {parallel} {}: {acne} acne, {leak} leak of {sure}", row.technique);
                assert!(sure > 800, "{name}: the truth must have something to say: {sure}");
                // A coarse curved mesh keeps a pixel near its terminator, where the neighbouring facet is steeper than
                // the receiver's own; on flat ones there is none.
                let most = if name == "tilt" { 0 } else { sure / 400 };
                assert!(acne <= most && leak * 200 <= sure, "{name} {}: {acne} {leak}", row.technique);
                // Flat things on flat ground: no shadow begins late. Metres.
                let gap_m = row.gap_m.unwrap_or(0.0);
                assert!(gap_m < 0.03, "{name} {}: a gap of {gap_m} m", row.technique);
            }
            let [none, .., linear] = found.rows.as_slice() else { panic!("three rows") };
            assert!(none.errors.false_shadow < 1e-6 && none.errors.acne == 0.0);
            if name != "tilt" {
                assert!(
                    pixels(none, none.errors.leak, receivers) > 20,
                    "{name}: without shadows there must be light"
                );
                assert!(
                    none.errors.rmse > 3.0 * linear.errors.rmse && none.flip > 2.0 * linear.flip,
                    "{name}"
                );
            }
        }
    }
}

/// Rows I8, B4, N3: maps that follow the eye, warped or not, have neither acne nor leaks where fitted ones have none.
#[test]
fn maps_that_follow_the_eye_are_right_too() {
    let Some(gpu) = gpu() else { return };
    for name in ["torus", "columns", "contact", "tilt"] {
        for parallel in [false, true] {
            let mut scene = builtin(name);
            if parallel {
                let sun = sun_of(&scene);
                scene = with_light(scene, sun);
            }
            if name == "columns" {
                // A standing eye, for which the warps are strong.
                let (eye, target) = (Vec3::new(-7.5, 1.7, 1.4), Vec3::new(5.0, 1.7, 1.4));
                scene.cameras[0].camera = Camera::look_at(eye, target, 0.9, 0.1, 80.0);
            }
            let with = |p: &Projection| settings("linear", &[MAP, ("projection", p.row().id)]);
            let found = measured(&gpu, &scene, Projection::ALL.iter().map(with).collect());
            let receivers = found.views[0].receivers;
            for (projection, row) in Projection::ALL.iter().zip(&found.rows) {
                let sure = pixels(row, 1.0, receivers);
                let (acne, leak) =
                    (pixels(row, row.errors.acne, receivers), pixels(row, row.errors.leak, receivers));
                let id = projection.row().id;
                // Near columns get so fine a map that the steeper facet next to a lit one is beyond the band of
                // pixels that do not count, see above.
                let most = if name == "columns" { sure / 150 } else { sure / 400 };
                println!(
                    "{name} parallel {parallel} {id}: {acne} acne, {leak} leak of {sure}, rmse {:.4}",
                    row.errors.rmse
                );
                assert!(
                    sure > 800 && acne <= most && leak * 200 <= sure,
                    "{name} {id}: {acne} {leak} of {sure}"
                );
            }
            let rmse = |i: usize| found.rows[i].errors.rmse;
            assert!((1..4).all(|i| rmse(i) < 1.1 * rmse(0) + 1e-4), "{name} parallel {parallel}");
        }
    }
}

/// Row H4: a uniform bias must be as large as the steepest receiver needs, and leaks everywhere else.
#[test]
fn a_uniform_bias_leaks_more_than_a_slope_scaled_one() {
    let Some(gpu) = gpu() else { return };
    let scene = builtin("contact");
    let small = ("map_size", "256");
    let biases: Vec<String> = (0..12).map(|i| format!("{}", 1e-4 * f64::from(1 << i))).collect();
    let uniform = biases.iter().map(|bias| settings("matrix-bias", &[small, ("matrix_bias", bias)]));
    let techniques =
        std::iter::once(settings("linear", &[small, ("bias", "slope")])).chain(uniform).collect();
    // Large enough that a texel is some pixels and the shadows are some texels wide.
    let mut plan = plan(&scene, techniques);
    plan.options.size = UVec2::splat(4 * SIDE);
    let found = compare(&gpu, &scene, &plan, &|_: &str, _| ControlFlow::Continue(())).expect("measured");
    let slope = &found.rows[0];
    let (bias, uniform) = biases
        .iter()
        .zip(&found.rows[1..])
        .find(|(_, row)| row.errors.false_shadow <= slope.errors.false_shadow)
        .expect("some uniform bias is large enough");
    let receivers = found.views[0].receivers;
    for (name, row) in [("slope-scaled", slope), ("least uniform without more false shadow", uniform)] {
        println!(
            "{name}: {} of {} sure pixels leak, gap {:.4} m, false light {:.3} %, false shadow {:.3} %",
            pixels(row, row.errors.leak, receivers),
            pixels(row, 1.0, receivers),
            row.gap_m.unwrap_or(0.0),
            100.0 * row.errors.false_light,
            100.0 * row.errors.false_shadow
        );
    }
    println!("the uniform bias is {bias} of the depth range");
    assert!(uniform.errors.leak > slope.errors.leak && uniform.gap_m > slope.gap_m);
    assert!(uniform.errors.false_light > 1.5 * slope.errors.false_light);
}

/// Rows H11 and H12. Without any bias, round solids that a texel resolves have no acne. What remains elsewhere lies where a solid
/// is thinner than its slope over a texel: at ridges between a lit side and an unlit one, and in blades. Fine maps leave less.
#[test]
fn solids_need_no_bias_but_where_they_are_thinner_than_a_texel() {
    let Some(gpu) = gpu() else { return };
    for (name, most) in [("torus", 0.002), ("columns", 0.002), ("contact", 0.02), ("knots", 0.0)] {
        let scene = builtin(name);
        let of = |technique, size| settings(technique, &[("map_size", size)]);
        let techniques = vec![
            settings("linear", &[("map_size", "512"), ("bias", "none")]),
            of("midpoint", "512"),
            of("midpoint", "4096"),
            of("second-depth", "512"),
            of("second-depth", "4096"),
        ];
        let found = measured(&gpu, &scene, techniques);
        let acne: Vec<f64> = found.rows.iter().map(|row| row.errors.acne).collect();
        let leak: Vec<f64> = found.rows.iter().map(|row| row.errors.leak).collect();
        println!(
            "{name}: acne of none, midpoint 512 and 4096, second 512 and 4096: {acne:.5?}; leak {leak:.5?}"
        );
        assert!(acne[0] > 0.05, "{name}: a bias must be needed: {}", acne[0]);
        assert!(acne[1..].iter().all(|acne| *acne <= most), "{name}: {acne:?}");
        assert!(acne[2] <= most / 4.0 && acne[4] <= most / 4.0, "{name}: {acne:?}");
        assert!(leak[1..].iter().all(|leak| *leak < 0.002), "{name}: {leak:?}");
        let cost = |row: usize| {
            let cost = &found.rows[row].cost;
            (cost.passes, cost.texels, cost.memory_bytes)
        };
        // A pass more, and a layer of 32-bit depth.
        assert_eq!(cost(1), (2, 2 * 512 * 512, 2 * 4 * 512 * 512));
        assert_eq!(cost(3), (1, 512 * 512, 4 * 512 * 512));
    }
}

/// The closed-mesh check: who is not closed is named, and shadows itself; with midpoints it does not.
#[test]
fn a_solid_with_a_hole_is_named_and_shadows_itself() {
    let Some(gpu) = gpu() else { return };
    let scene = builtin("torus");
    let mut holed = scene.clone();
    let torus = holed.meshes.iter_mut().find(|m| m.name == "torus").expect("a torus");
    torus.indices.truncate(torus.indices.len() - 3);
    let size = ("map_size", "512");
    let warned = |scene: &Scene, technique| {
        let options = RenderOptions::new(settings(technique, &[size]));
        let camera = &scene.cameras[0].camera;
        umbrage_render::Renderer::new(&gpu, scene, camera, options).expect("a renderer").warnings().join("")
    };
    assert_eq!(warned(&scene, "second-depth"), "");
    assert_eq!(warned(&holed, "midpoint"), "");
    let warning = warned(&holed, "second-depth");
    assert!(warning.contains("closed-mesh check") && warning.contains("`torus`"), "{warning}");
    let found =
        measured(&gpu, &holed, vec![settings("second-depth", &[size]), settings("midpoint", &[size])]);
    let acne: Vec<f64> = found.rows.iter().map(|row| row.errors.acne).collect();
    println!("acne of an open torus, second-depth and midpoint: {acne:.5?}");
    assert!(acne[0] > 0.02 && acne[1] < 0.002, "{acne:?}");
}

/// A light with a shape: maps of today are hard, so their edges are too narrow, and the truth says so.
#[test]
fn hard_shadows_of_a_wide_light_are_too_narrow() {
    let Some(gpu) = gpu() else { return };
    let scene = builtin("contact");
    let wide = Light { shape: LightShape::Disc { radius_m: 0.6 }, ..scene.lights[0].light };
    let found = measured(&gpu, &with_light(scene, wide), vec![settings("linear", &[MAP])]);
    let row = &found.rows[0];
    let width = row.penumbra.expect("soft edges");
    println!("{} soft edges, {width:.3} of their width", found.views[0].soft_edges);
    assert!(
        found.views[0].soft_edges > 20 && width < 0.4 && row.errors.rmse > 0.05,
        "{width} {}",
        row.errors.rmse
    );
    assert_eq!(found.truth.samples, 32);
}

#[test]
fn a_path_shows_what_flickers() {
    let Some(gpu) = gpu() else { return };
    let scene = builtin("columns");
    let camera = scene.cameras[0].camera;
    let path = (0..3)
        .map(|i| Camera { position_world: camera.position_world + Vec3::X * 0.05 * i as f32, ..camera })
        .collect();
    let techniques = vec![
        settings("unshadowed", &[]),
        settings("linear", &[("map_size", "64")]),
        settings("linear", &[("map_size", "64"), ("bias", "none")]),
    ];
    let plan = Plan { cameras: Cameras::Path("path".into(), path), ..plan(&scene, techniques) };
    let found = compare(&gpu, &scene, &plan, &|_: &str, _| ControlFlow::Continue(())).expect("measured");
    let flicker: Vec<f64> = found.rows.iter().map(|row| row.flicker.expect("places that stay")).collect();
    println!("flicker without shadow, of a coarse map, of one with acne: {flicker:.5?}");
    // The two that are one technique have pictures of their own.
    let files: std::collections::HashSet<&str> = found.rows.iter().map(|row| row.heat.as_str()).collect();
    assert_eq!(files.len(), 3, "{files:?}");
    assert!(flicker[0] < 1e-6 && flicker[1] < 0.02 && flicker[2] > 2.0 * flicker[1], "{flicker:?}");
}

#[test]
fn it_stops_when_asked_and_counts_what_does_not_vary() {
    let Some(gpu) = gpu() else { return };
    let scene = builtin("torus");
    let one = plan(&scene, vec![settings("linear", &[("map_size", "128")])]);
    let stopped = compare(&gpu, &scene, &one, &|_: &str, share| {
        if share > 0.4 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    assert!(matches!(stopped, Err(MeasureError::Stopped)));
    let last = std::sync::atomic::AtomicU32::new(0);
    let found = compare(&gpu, &scene, &one, &|_: &str, share| {
        assert!((0.0..=1.0).contains(&share), "{share}");
        last.fetch_max((share * 100.0) as u32, std::sync::atomic::Ordering::Relaxed);
        ControlFlow::Continue(())
    });
    let row = &found.expect("measured").rows[0];
    assert_eq!(
        (row.cost.passes, row.cost.texels, row.cost.memory_bytes, row.cost.taps),
        (1, 128 * 128, 4 * 128 * 128, 1)
    );
    assert!(row.cost.triangles > 20_000 && row.cost.draws == 3 && row.cost.pass_names.len() == 3);
    assert!(
        row.cost.cost_min_ms <= row.cost.cost_ms
            && row.cost.cost_ms <= row.cost.cost_max_ms
            && row.cost.frame_ms > 0.0
    );
    assert!(last.into_inner() >= 50);
}

/// Row F4: light through panes. The technique that colours it must be far nearer to the truth than the one that cuts it, under every
/// kind of light, and no worse where no pane is in the way.
#[test]
fn coloured_light_is_near_the_truth() {
    let Some(gpu) = gpu() else { return };
    let panes = scenes::panes();
    let spot = panes.lights[0].light;
    let point = Light { kind: LightKind::Point, ..spot };
    for (name, light) in [("spot", spot), ("sun", sun_of(&panes)), ("point", point)] {
        let scene = with_light(panes.clone(), light);
        let techniques = vec![
            settings("linear", &[MAP]),
            settings("colored", &[MAP]),
            settings("colored", &[MAP, ("storage", "packed3"), ("filter", "pcf")]),
        ];
        let found = measured(&gpu, &scene, techniques);
        let receivers = found.views[0].receivers;
        for row in &found.rows {
            println!(
                "{name} {} {}: rmse {:.4}, {} acne, {} leak of {} sure, {} passes, {} bytes",
                row.technique,
                row.params["filter"],
                row.errors.rmse,
                row.errors.acne_pixels,
                row.errors.leak_pixels,
                pixels(row, 1.0, receivers),
                row.cost.passes,
                row.cost.memory_bytes
            );
        }
        let [linear, colored, packed] = found.rows.as_slice() else { panic!("three rows") };
        for row in [colored, packed] {
            assert!(3.0 * row.errors.rmse < linear.errors.rmse, "{name}: {}", row.errors.rmse);
            assert!(row.errors.acne_pixels <= linear.errors.acne_pixels, "{name}");
            assert!(row.errors.leak_pixels <= linear.errors.leak_pixels, "{name}");
            assert_eq!(row.cost.passes, 3 * linear.cost.passes, "{name}");
        }
        assert_eq!(colored.cost.memory_bytes, 3 * linear.cost.memory_bytes, "{name}");
    }
}
