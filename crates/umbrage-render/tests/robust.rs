//! Whatever is handed in: a typed error that says what to do, or a right picture.

mod common;

use common::scenes::{builtin, over_floor, sheet, with_light};
use common::{gpu, settings};
use glam::{Mat4, UVec2, Vec3};
use umbrage_render::umbrage::core::technique::{Combination, Method, Settings, TECHNIQUES};
use umbrage_render::umbrage::core::{Camera, Light, LightKind, LightShape};
use umbrage_render::{Gpu, MAX_LIGHTS, Measure, RenderError, RenderOptions, Renderer, View};
use umbrage_scene::{Material, Scene, SceneLight};

/// V of the first light, 48 x 48 pixels.
fn visibility(gpu: &Gpu, scene: &Scene, settings: Settings) -> Result<Vec<f32>, RenderError> {
    let options =
        RenderOptions { size: UVec2::splat(48), view: View::Visibility, ..RenderOptions::new(settings) };
    let mut renderer = Renderer::new(gpu, scene, &scene.cameras[0].camera, options)?;
    renderer.frame(Measure::Frame)?;
    renderer.visibility()
}

fn all(pairs: &[(&str, &str)]) -> Vec<Settings> {
    TECHNIQUES
        .iter()
        .filter(|technique| technique.method.combination().is_some())
        .map(|technique| settings(technique.id, pairs))
        .collect()
}

fn kinds(light: Light) -> [Light; 3] {
    [
        light,
        Light { kind: LightKind::Point, ..light },
        Light { kind: LightKind::Directional, near_m: None, far_m: None, ..light },
    ]
}

#[test]
fn one_texel_is_a_map() {
    let Some(gpu) = gpu() else { return };
    let scene = builtin("torus");
    for light in kinds(scene.lights[0].light) {
        let scene = with_light(scene.clone(), light);
        for size in ["1", "2", "3"] {
            for settings in all(&[("map_size", size)]) {
                let id = settings.technique.id;
                let v = visibility(&gpu, &scene, settings).unwrap_or_else(|e| panic!("{id} {size}: {e}"));
                assert!(v.iter().all(|v| (0.0..=1.0).contains(v)), "{id} {size}: V is no visibility");
            }
        }
    }
}

#[test]
fn numbers_that_are_none_are_named() {
    let Some(gpu) = gpu() else { return };
    let good = builtin("torus");
    let light = good.lights[0].light;
    let linear = || settings("linear", &[]);
    for (broken, word) in [
        (Light { position_world: Vec3::splat(f32::NAN), ..light }, "position"),
        (Light { direction_world: Vec3::ZERO, ..light }, "direction"),
        (Light { intensity: f32::INFINITY, ..light }, "intensity"),
        (Light { kind: LightKind::Spot { inner_rad: 0.0, outer_rad: f32::NAN }, ..light }, "cone"),
        (Light { shape: LightShape::Disc { radius_m: -1.0 }, ..light }, "radius"),
        (Light { near_m: Some(5.0), far_m: Some(5.0), ..light }, "near"),
        (Light { range_m: Some(f32::NAN), ..light }, "range"),
    ] {
        let error = visibility(&gpu, &with_light(good.clone(), broken), linear()).expect_err(word);
        assert!(matches!(error, RenderError::Light(_)) && error.to_string().contains(word), "{error}");
    }
    let camera = good.cameras[0].camera;
    for broken in [
        Camera { position_world: Vec3::splat(f32::INFINITY), ..camera },
        Camera { direction_world: Vec3::ZERO, ..camera },
        Camera { near_m: 0.0, ..camera },
        Camera { near_m: 9.0, far_m: 9.0, ..camera },
    ] {
        let mut scene = good.clone();
        scene.cameras[0].camera = broken;
        let error = visibility(&gpu, &scene, linear()).expect_err("a broken camera");
        assert!(matches!(error, RenderError::Camera(_)), "{error}");
    }
}

#[test]
fn without_casters_all_that_the_light_reaches_is_lit() {
    let Some(gpu) = gpu() else { return };
    let floor = over_floor(vec![], vec![], vec![], &[]);
    let mut empty = floor.clone();
    empty.instances.clear();
    for light in kinds(floor.lights[0].light) {
        for settings in all(&[("map_size", "64")]) {
            let id = settings.technique.id;
            let lit = visibility(&gpu, &with_light(floor.clone(), light), settings.clone()).expect(id);
            let plain = self::settings("unshadowed", &[]);
            let expected = visibility(&gpu, &with_light(floor.clone(), light), plain).expect("unshadowed");
            assert_eq!(lit, expected, "{id}: a floor alone throws no shadow on itself");
            let nothing = visibility(&gpu, &with_light(empty.clone(), light), settings).expect(id);
            assert!(nothing.iter().all(|v| *v == 1.0), "{id}: nothing there, nothing dark");
        }
    }
}

/// A sheet that hangs from before a coarse map's near plane to far behind it: the part that is cut off must shadow too.
#[test]
fn a_caster_through_the_near_plane_throws_its_whole_shadow() {
    let Some(gpu) = gpu() else { return };
    let hanging = sheet(Vec3::new(0.0, 6.99, 0.0), Vec3::X * 0.02, Vec3::NEG_Z * 0.02, 0);
    let material = Material { double_sided: true, ..Material::default() };
    let scene = over_floor(vec![material], vec![], vec![hanging], &[(0, Mat4::IDENTITY)]);
    let light = Light::spot(Vec3::new(0.0, 7.0, 0.0), Vec3::ZERO, 0.5, 0.6);
    let scene = with_light(scene, light);
    for storage in ["depth16", "depth32f"] {
        let v = visibility(&gpu, &scene, settings("hard", &[("storage", storage)])).expect("V");
        let dark = v.iter().filter(|v| **v == 0.0).count();
        let plain = visibility(&gpu, &scene, settings("unshadowed", &[])).expect("V");
        let lit = plain.iter().zip(&v).filter(|(plain, v)| **plain == 1.0 && **v == 1.0).count();
        // The sheet covers the whole cone.
        println!("{storage}: {dark} dark, {lit} lit pixels");
        assert!(dark > 400, "{storage}: the sheet, nearer than the map begins, throws its shadow");
    }
}

#[test]
fn a_light_inside_a_mesh_is_shut_in() {
    let Some(gpu) = gpu() else { return };
    let scene = builtin("torus");
    let ball = scene.instances.iter().position(|i| i.name.contains("ball")).expect("a ball");
    let mesh = &scene.meshes[scene.instances[ball].mesh];
    let middle = scene.instances[ball].world_from_object.transform_point3(mesh.bounds.center());
    for light in kinds(Light { position_world: middle, ..scene.lights[0].light }).into_iter().take(2) {
        let scene = with_light(scene.clone(), light);
        for id in ["hard", "linear", "pcf", "kernel", "packed"] {
            let v = visibility(&gpu, &scene, settings(id, &[("map_size", "512")])).expect(id);
            let plain = visibility(&gpu, &scene, settings("unshadowed", &[])).expect("unshadowed");
            let reached = plain.iter().filter(|v| **v == 1.0).count();
            // The background is 1 in both.
            let background =
                visibility(&gpu, &Scene { instances: vec![], ..scene.clone() }, settings("unshadowed", &[]));
            let nothing = background.expect("V").len();
            let escaped = v.iter().zip(&plain).filter(|(v, plain)| **v > 0.05 && **plain == 1.0).count();
            println!("{id}: {escaped} of {reached} pixels lit ({nothing} in all)");
            assert!(escaped < reached, "{id}: something must be shut in");
        }
    }
}

#[test]
fn more_lights_than_a_picture_has_are_left_out_with_a_word() {
    let Some(gpu) = gpu() else { return };
    let mut scene = builtin("torus");
    let one = scene.lights[0].clone();
    scene.lights = (0..MAX_LIGHTS + 3).map(|_| SceneLight { ..one.clone() }).collect();
    let options = RenderOptions {
        size: UVec2::splat(16),
        ..RenderOptions::new(settings("linear", &[("map_size", "16")]))
    };
    let mut renderer = Renderer::new(&gpu, &scene, &scene.cameras[0].camera, options).expect("16 lights");
    renderer.frame(Measure::Frame).expect("a frame");
    assert!(
        renderer.warnings().iter().any(|w| w.contains("3 lights are left out")),
        "{:?}",
        renderer.warnings()
    );
}

#[test]
fn more_maps_than_the_adapter_holds_are_refused_with_the_way_out() {
    let Some(gpu) = gpu() else { return };
    let scene = builtin("torus");
    let ball = LightShape::Sphere { radius_m: 0.2 };
    let light = Light { kind: LightKind::Point, shape: ball, ..scene.lights[0].light };
    let scene = with_light(scene, light);
    let many = settings("multi-view", &[("views", "1024"), ("map_size", "16")]);
    let error = visibility(&gpu, &scene, many).expect_err("6,144 layers");
    assert!(matches!(error, RenderError::Shadow(_)), "{error}");
    let message = error.to_string();
    assert!(message.contains("6144 layers") && message.contains("views"), "{message}");
}

/// Every combination that is said to go together draws a shadow, and every other says why not.
#[test]
fn every_valid_combination_draws_a_shadow() {
    let Some(gpu) = gpu() else { return };
    let block = builtin("contact").meshes.into_iter().find(|m| m.name == "low box").expect("a box");
    let block = umbrage_scene::Mesh { material: 0, ..block };
    let lifted = Mat4::from_translation(Vec3::new(0.6, 0.8, 0.0));
    let scene = over_floor(vec![Material::default()], vec![], vec![block], &[(0, lifted)]);
    let plain = visibility(&gpu, &scene, settings("unshadowed", &[])).expect("unshadowed");
    let (mut drawn, mut refused) = (0, 0);
    for combination in Combination::all() {
        let ids: Vec<_> = Method::Map(combination).rows().iter().map(|(key, row)| (*key, row.id)).collect();
        let pairs: Vec<(&str, &str)> = ids.iter().copied().chain([("map_size", "256")]).collect();
        let made = Settings::new("linear", pairs.iter().copied());
        if combination.objection().is_some() {
            assert!(made.is_err_and(|e| e.to_string().contains("do not go together")), "{ids:?}");
            refused += 1;
            continue;
        }
        let v = visibility(&gpu, &scene, made.expect("valid")).unwrap_or_else(|e| panic!("{ids:?}: {e}"));
        let dark = v.iter().zip(&plain).filter(|(v, plain)| **v < 0.5 && **plain == 1.0).count();
        assert!(v.iter().all(|v| (0.0..=1.0).contains(v)), "{ids:?}: V is no visibility");
        assert!(dark > 12, "{ids:?}: only {dark} pixels are in shadow");
        drawn += 1;
    }
    println!("{drawn} combinations drawn, {refused} refused");
    assert!(drawn > 1000 && refused > 100);
}
