//! Point lights across the edges of their tiles, and area lights from many places, against ray-traced truth.

mod common;

use common::{builtin, gpu, settings};
use glam::{Mat4, Quat, UVec2, Vec3};
use std::ops::ControlFlow;
use umbrage_measure::{Cameras, Plan, compare};
use umbrage_render::umbrage::core::technique::Settings;
use umbrage_render::umbrage::core::{Light, LightKind, LightShape};
use umbrage_render::{Gpu, Measure, RenderOptions, Renderer, View};
use umbrage_scene::Scene;
use umbrage_truth::{Place, Quality, Rays, Surfaces, Visibility, silent};

/// The same scene, turned about the vertical axis: the same picture, but for where the tiles of a point light meet.
fn turned(scene: &Scene, angle_rad: f32) -> Scene {
    let turn = Quat::from_rotation_y(angle_rad);
    let mut scene = scene.clone();
    for instance in &mut scene.instances {
        instance.world_from_object = Mat4::from_quat(turn) * instance.world_from_object;
    }
    for placed in &mut scene.lights {
        placed.light.position_world = turn * placed.light.position_world;
    }
    for placed in &mut scene.cameras {
        placed.camera.position_world = turn * placed.camera.position_world;
        placed.camera.direction_world = turn * placed.camera.direction_world;
    }
    scene
}

/// How near a direction is to an edge between two tiles: 1 on it, 0 at a tile's middle.
fn edgeness(from_light: Vec3) -> f32 {
    let mut sizes = from_light.abs().to_array();
    sizes.sort_by(f32::total_cmp);
    sizes[1] / sizes[2]
}

struct Shot {
    off: Vec<Option<f32>>,
    edgeness: Vec<f32>,
}

/// V - V* of every receiver.
fn shot(gpu: &Gpu, scene: &Scene, size: UVec2, with: &Settings) -> Shot {
    let camera = &scene.cameras[0].camera;
    let light = &scene.lights[0].light;
    let options = RenderOptions { size, view: View::Visibility, ..RenderOptions::new(with.clone()) };
    let mut renderer = Renderer::new(gpu, scene, camera, options).expect("a renderer");
    renderer.frame(Measure::Frame).expect("a frame");
    let v = renderer.visibility().expect("V");
    let rays = Rays::new(scene).expect("rays");
    let surfaces = Surfaces::new(&rays, camera, size, &silent).expect("surfaces");
    let truth = Visibility::new(&rays, &surfaces, light, &Quality::default(), &silent).expect("truth");
    let off =
        (0..v.len()).map(|i| (truth.place[i] == Place::Receiver).then(|| v[i] - truth.v[i].x)).collect();
    let edgeness = surfaces.seen.iter().map(|seen| {
        seen.as_ref().map_or(0.0, |seen| edgeness(seen.p_world.as_vec3() - light.position_world))
    });
    Shot { off, edgeness: edgeness.collect() }
}

#[test]
fn no_seam_shows_where_the_tiles_of_a_point_light_meet() {
    let Some(gpu) = gpu() else { return };
    let mut scene = builtin("columns");
    let light = scene.lights[0].light;
    scene.lights[0].light =
        Light { kind: LightKind::Point, position_world: Vec3::new(0.4, 2.0, 1.6), ..light };
    let size = UVec2::new(640, 360);
    for (technique, pairs) in [
        ("hard", &[("map_size", "512")][..]),
        ("linear", &[("map_size", "512")]),
        ("pcf", &[("map_size", "512"), ("width", "9")]),
        ("kernel", &[("map_size", "512"), ("width", "9")]),
    ] {
        let with = settings(technique, pairs);
        // The seams of one lie in the middle of the other's tiles; those around the light's height stay.
        let here = shot(&gpu, &scene, size, &with);
        let there = shot(&gpu, &turned(&scene, std::f32::consts::FRAC_PI_4), size, &with);
        let (mut pixels, mut on_seam, mut off_seam) = (0, 0.0f64, 0.0f64);
        for i in 0..here.off.len() {
            let (Some(a), Some(b)) = (here.off[i], there.off[i]) else { continue };
            if here.edgeness[i] > 0.93 && there.edgeness[i] < 0.9 {
                pixels += 1;
                on_seam += f64::from(a * a);
                off_seam += f64::from(b * b);
            }
        }
        let (on, off) = ((on_seam / f64::from(pixels)).sqrt(), (off_seam / f64::from(pixels)).sqrt());
        println!(
            "{technique}: rmse {on:.4} on the seams, {off:.4} on the same {pixels} pixels without seams"
        );
        assert!(pixels > 2000 && off > 0.005, "{technique}: the seams must cross shadows: {pixels} {off}");
        assert!(on <= 1.1 * off, "{technique}: {on} is more than {off}");
    }
}

#[test]
fn an_area_light_converges_to_the_truth_as_views_are_added() {
    let Some(gpu) = gpu() else { return };
    let kinds: [(&str, LightShape, bool); 3] = [
        ("disc", LightShape::Disc { radius_m: 0.3 }, false),
        ("rectangle", LightShape::Rectangle { width_m: 0.6, height_m: 0.3 }, false),
        ("sun", LightShape::Sun { angle_rad: 0.1 }, true),
    ];
    for (name, shape, parallel) in kinds {
        let mut scene = builtin("contact");
        let light = Light { shape, ..scene.lights[0].light };
        scene.lights[0].light = if parallel {
            Light { kind: LightKind::Directional, intensity: 3.0, near_m: None, far_m: None, ..light }
        } else {
            light
        };
        let counts = ["1", "4", "16", "64"];
        let techniques: Vec<Settings> = counts
            .iter()
            .map(|views| settings("multi-view", &[("views", views), ("map_size", "1024")]))
            .collect();
        let plan = Plan {
            cameras: Cameras::Each(vec![("first".into(), scene.cameras[0].camera)]),
            light_numbers: vec![0],
            quality: Quality { samples: 512, seed: 0 },
            frames: 1,
            options: RenderOptions {
                size: UVec2::new(192, 108),
                ..RenderOptions::new(techniques[0].clone())
            },
            techniques,
        };
        let found = compare(&gpu, &scene, &plan, &|_: &str, _| ControlFlow::Continue(())).expect("measured");
        let rmse: Vec<f64> = found.rows.iter().map(|row| row.errors.rmse).collect();
        println!(
            "{name}: rmse {rmse:.4?} with {counts:?} views, edges {:?} of their width",
            found.rows[3].penumbra
        );
        assert!(
            rmse[1] < 0.65 * rmse[0] && rmse[2] < 0.5 * rmse[1] && rmse[3] < 0.5 * rmse[2],
            "{name}: {rmse:?}"
        );
        assert!(rmse[3] < 0.01, "{name}: {rmse:?}");
        let width = found.rows[3].penumbra.expect("soft edges");
        // Pixels here are a good part of a penumbra wide, and widen it.
        assert!((0.8..1.35).contains(&width), "{name}: {width} of the true width");
        assert_eq!(found.rows[3].errors.acne_pixels, 0, "{name}");
    }
}
