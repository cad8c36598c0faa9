//! What the automatic bias promises: no acne, no leaks, no gaps, at any scale, and with nothing to set. `cargo xtask bias`
//! measures the same more widely.

mod common;

use common::{builtin, gpu, settings};
use glam::UVec2;
use std::ops::ControlFlow;
use umbrage_measure::{Cameras, Plan, Row, compare};
use umbrage_render::umbrage::core::technique::Settings;
use umbrage_render::umbrage::core::{Light, LightKind};
use umbrage_render::{Gpu, RenderOptions};
use umbrage_scene::Scene;
use umbrage_truth::Quality;

const SIZE: UVec2 = UVec2::new(400, 225);
/// Share of sure receivers in full shadow that may be lit.
const MOST_LEAK: f64 = 2e-4;
/// From a contact to where its shadow begins, widths of a texel.
const MOST_GAP_TEXEL: f64 = 1.5;

/// A technique with its settings.
type Asked = (&'static str, &'static [(&'static str, &'static str)]);

const ALL: [Asked; 5] = [
    ("linear", &[]),
    ("pcf", &[("width", "3")]),
    ("pcf", &[("width", "9")]),
    ("kernel", &[]),
    ("linear", &[("storage", "depth16")]),
];
/// At other scales, where only rounding and what is counted in metres could differ.
const SOME: [Asked; 2] = [("linear", &[]), ("pcf", &[("width", "9")])];

fn scene(name: &str, scale: &str, point: bool) -> Scene {
    let mut scene = builtin(&format!("{name}?scale={scale}"));
    scene.lights.truncate(1);
    if point {
        let light = &mut scene.lights[0].light;
        *light = Light { kind: LightKind::Point, ..*light };
    }
    scene
}

fn measured(gpu: &Gpu, scene: &Scene, asked: &[Asked], more: &[(&str, &str)]) -> Vec<Row> {
    let settings = |(id, pairs): &Asked| {
        let pairs: Vec<_> = pairs.iter().chain(more).copied().collect();
        settings(id, &pairs)
    };
    let techniques: Vec<Settings> = asked.iter().map(settings).collect();
    let plan = Plan {
        cameras: Cameras::Each(vec![("first".into(), scene.cameras[0].camera)]),
        light_numbers: vec![0],
        quality: Quality { samples: 1, seed: 0 },
        frames: 0,
        options: RenderOptions { size: SIZE, ..RenderOptions::new(techniques[0].clone()) },
        techniques,
    };
    compare(gpu, scene, &plan, &|_: &str, _| ControlFlow::Continue(())).expect("measured").rows
}

/// What a row does not keep of the promise.
fn broken(row: &Row) -> Option<String> {
    let (acne, leak, gap) = (row.errors.acne, row.errors.leak, row.gap_texel.unwrap_or(0.0));
    let kept = acne == 0.0 && leak <= MOST_LEAK && gap <= MOST_GAP_TEXEL;
    (!kept).then(|| format!("acne {acne} leak {leak} gap {gap} texels"))
}

#[test]
fn auto_keeps_its_promise() {
    let Some(gpu) = gpu() else { return };
    let mut contacts = 0;
    let mut failures = Vec::new();
    for name in ["tilt", "contact", "torus", "columns"] {
        for point in [false, true] {
            for (scale, sizes, asked) in [
                ("1", &["256", "2048"][..], &ALL[..]),
                ("0.01", &["256", "2048"][..], &SOME[..]),
                ("1000", &["256"][..], &SOME[..]),
            ] {
                let scene = scene(name, scale, point);
                for size in sizes {
                    for (row, asked) in measured(&gpu, &scene, asked, &[("map_size", size)]).iter().zip(asked)
                    {
                        assert_eq!(row.params["bias"], "auto", "this is about the default");
                        contacts += usize::from(row.gap_texel.is_some());
                        let at = format!("{name} x{scale} point {point} {size} {asked:?}");
                        failures.extend(broken(row).map(|what| format!("{at}: {what}")));
                    }
                }
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    assert!(contacts > 40, "there must be contacts to judge: {contacts}");
}

#[test]
fn what_lacks_it_is_seen_to_fail() {
    let Some(gpu) = gpu() else { return };
    // Bevy's defaults for spot lights, see docs/bias.md.
    const ENGINE: Asked = (
        "pcf",
        &[
            ("width", "5"),
            ("bias", "normal"),
            ("normal_offset", "0"),
            ("constant", "0"),
            ("normal_always", "2.546"),
            ("depth_m", "0.02"),
        ],
    );
    let asked = [("linear", &[("bias", "none")][..]), ("linear", &[("bias", "receiver-plane")]), ENGINE];
    let map = [("map_size", "2048")];
    let of_scale = |scale: &str| measured(&gpu, &scene("contact", scale, false), &asked, &map);
    let [none, plane, _] = of_scale("1").try_into().expect("three rows");
    assert!(none.errors.acne > 0.1, "{}", none.errors.acne);
    assert!(plane.errors.acne > 0.001, "{}", plane.errors.acne);
    // What is in metres is right at no scale but its own.
    let [_, _, engine] = of_scale("0.01").try_into().expect("three rows");
    assert!(engine.errors.leak > 10.0 * MOST_LEAK, "{:?}", broken(&engine));
    // The same scene and map with the automatic bias: nothing else of it is to blame.
    let auto = measured(&gpu, &scene("contact", "0.01", false), &[("pcf", &[("width", "5")])], &map);
    assert_eq!(auto.iter().find_map(broken), None);
}

#[test]
fn every_offset_of_normal_does_its_part() {
    let Some(gpu) = gpu() else { return };
    let scene = scene("contact", "1", false);
    let bare = [("map_size", "512"), ("bias", "normal"), ("normal_offset", "0"), ("constant", "0")];
    let nothing = measured(&gpu, &scene, &[("linear", &[])], &bare);
    assert!(nothing[0].errors.acne > 0.1, "{}", nothing[0].errors.acne);
    for alone in [
        ("normal_always", "3"),
        ("normal_tilt", "20"),
        ("depth_texel", "5"),
        ("depth_m", "0.1"),
        ("depth_share", "0.02"),
        ("polygon_slope", "3"),
    ] {
        let with = [&bare[..], &[alone]].concat();
        let acne = measured(&gpu, &scene, &[("linear", &[])], &with)[0].errors.acne;
        assert!(acne < 0.2 * nothing[0].errors.acne, "{alone:?}: {acne} of {}", nothing[0].errors.acne);
    }
    let sine = measured(&gpu, &scene, &[("linear", &[])], &[&bare[..2], &[("normal_offset", "3")]].concat());
    assert!(sine[0].errors.acne < 0.2 * nothing[0].errors.acne, "{}", sine[0].errors.acne);
}
