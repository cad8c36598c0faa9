//! EXPERIMENT harness.
use glam::{UVec2, Vec3};
use std::ops::ControlFlow;
use umbrage_measure::{Cameras, Plan, compare};
use umbrage_render::umbrage::core::technique::Settings;
use umbrage_render::umbrage::core::{Light, LightKind};
use umbrage_render::{Gpu, RenderOptions};
use umbrage_truth::Quality;

fn main() {
    // bias SCENES SIZES LIGHTS settings...
    let args: Vec<String> = std::env::args().skip(1).collect();
    let gpu = Gpu::new(None).expect("gpu");
    let heat = std::env::var("HEAT").ok();
    for scene_name in args[0].split(',') {
        let mut scene = umbrage_scene::load(scene_name).expect("scene");
        if !scene_name.starts_with("builtin") {
            umbrage_scene::add_ground(&mut scene);
        }
        umbrage_scene::add_defaults(&mut scene);
        scene.lights.truncate(1);
        for kind in args[2].split(',') {
            let mut scene = scene.clone();
            let light = scene.lights[0].light;
            let bounds = scene.bounds();
            match kind {
                "point" => scene.lights[0].light = Light { kind: LightKind::Point, ..light },
                "sun" => {
                    scene.lights[0].light = Light {
                        kind: LightKind::Directional,
                        intensity: 3.0,
                        near_m: None,
                        far_m: None,
                        ..light
                    }
                }
                _ => {}
            }
            let mut techniques = Vec::new();
            let mut labels = Vec::new();
            for size in args[1].split(',') {
                for spec in &args[3..] {
                    let (technique, pairs) = spec.split_once(':').unwrap_or((spec, ""));
                    let pairs: Vec<(&str, &str)> = pairs
                        .split(',')
                        .filter(|p| !p.is_empty())
                        .map(|p| p.split_once('=').expect("k=v"))
                        .chain([("map_size", size)])
                        .collect();
                    techniques.push(Settings::new(technique, pairs).expect("settings"));
                    labels.push((size.to_owned(), spec.clone()));
                }
            }
            let side = std::env::var("SIDE").ok().and_then(|s| s.parse().ok()).unwrap_or(480u32);
            let plan = Plan {
                cameras: Cameras::Each(vec![("c".into(), scene.cameras[0].camera)]),
                light_numbers: vec![0],
                quality: Quality { samples: 32, seed: 0 },
                frames: 0,
                options: RenderOptions {
                    size: UVec2::new(side * 16 / 9, side),
                    ..RenderOptions::new(techniques[0].clone())
                },
                techniques,
            };
            let found = match compare(&gpu, &scene, &plan, &|_: &str, _| ControlFlow::Continue(())) {
                Ok(f) => f,
                Err(e) => {
                    println!("{scene_name} {kind}: {e}");
                    continue;
                }
            };
            let receivers = found.views[0].receivers as f64;
            for (row, (size, spec)) in found.rows.iter().zip(&labels) {
                let sure = (1.0 - row.errors.band) * receivers;
                let distance = match kind {
                    "sun" => 1.0,
                    _ => light.position_world.distance(bounds.center()),
                };
                let width = match (kind, light.kind) {
                    ("point", _) => 2.0,
                    (_, LightKind::Spot { outer_rad, .. }) => 2.0 * outer_rad.tan(),
                    _ => 2.0 * bounds.radius(),
                };
                let texel = width * distance / size.parse::<f32>().unwrap();
                println!(
                    "{:28} {kind:5} {size:>5} {spec:50} acne {:5.0} leak {:5.0} /{:7.0} leak% {:.4} gap {:5.2} tx edge {:.4} band {:4.1}% rmse {:.4} hidden {}",
                    scene_name.rsplit('/').next().unwrap(),
                    row.errors.acne * sure,
                    row.errors.leak * sure,
                    sure,
                    100.0 * row.errors.leak,
                    row.gap_m.unwrap_or(0.0) / f64::from(texel),
                    row.errors.edge,
                    100.0 * row.errors.band,
                    row.errors.rmse,
                    row.errors.hidden_pixels
                );
                if let Some(folder) = &heat {
                    let safe: String =
                        format!("{}-{kind}-{size}-{spec}", scene_name.rsplit('/').next().unwrap())
                            .chars()
                            .map(|c| if c.is_alphanumeric() || c == '-' { c } else { '_' })
                            .collect();
                    std::fs::write(format!("{folder}/{safe}.png"), &row.pictures[2]).unwrap();
                }
            }
        }
    }
    let _ = Vec3::ZERO;
}
