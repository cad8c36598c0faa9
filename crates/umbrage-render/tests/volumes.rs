//! Shadow volumes: however they are found and counted, the picture is one, and what holds is kept.

mod common;

use common::scenes::{builtin, cut_out, sun_of, with_light};
use common::volumes::*;
use common::{gpu, settings};
use glam::{Mat4, Vec3};
use umbrage_render::umbrage::core::{Aabb, Camera, Light, Projection};
use umbrage_render::{FrameReport, Gpu, MAX_LIGHTS, Measure, RenderOptions, Renderer, View};
use umbrage_scene::{AlphaMode, Instance, Material, Mesh, Scene, SceneLight};

/// Pixels that another depth format may answer otherwise: a thousandth.
const MOST_OFF: usize = 16;

#[test]
fn every_way_draws_the_same_picture() {
    let Some(gpu) = gpu() else { return };
    let mut inside = mixture();
    let shell = Mat4::from_translation(Vec3::new(-1.0, 3.0, 1.0)) * Mat4::from_rotation_z(0.4);
    inside.instances.push(Instance {
        name: "around the light".into(),
        mesh: 2,
        world_from_object: shell,
        ..Instance::default()
    });
    let lamp = Light { position_world: Vec3::new(-1.0, 3.0, 1.0), ..kinds(inside.lights[0].light)[1] };
    let mut scenes: Vec<(&str, Scene)> =
        kinds(mixture().lights[0].light).map(|light| ("mixture", with_light(mixture(), light))).to_vec();
    scenes.push(("light inside of a box", with_light(inside, lamp)));
    scenes.push(("torus", builtin("torus")));
    scenes.push(("columns", with_light(builtin("columns"), sun_of(&builtin("columns")))));
    for (name, scene) in &scenes {
        let first = visibility(&gpu, scene, &[]);
        let shadow = dark(&gpu, scene, &first);
        assert!(shadow > 200, "{name}: only {shadow} pixels in shadow");
        for silhouette in ["compute", "vertex"] {
            for counting in ["auto", "depth-fail"] {
                for stencil in ["two-sided", "two-pass"] {
                    let pairs = [("silhouette", silhouette), ("counting", counting), ("stencil", stencil)];
                    let off = off(&first, &visibility(&gpu, scene, &pairs));
                    assert_eq!(off, 0, "{name} {}: {pairs:?}", scene.lights[0].light.kind.id());
                }
            }
        }
        // Without caps it is the same picture from outside of all shadows.
        let before = visibility(&gpu, scene, &[("counting", "depth-pass")]);
        let off = off(&first, &before);
        println!("{name}: {shadow} dark, depth-pass off by {off}");
        if ["mixture", "torus"].contains(name) {
            assert_eq!(off, 0, "{name}: depth-pass from outside");
        }
    }
}

#[test]
fn counting_before_is_wrong_in_a_shadow() {
    let Some(gpu) = gpu() else { return };
    let mut scene = placed(vec![cuboid(Vec3::new(0.5, 0.1, 0.5), &ALL)], &[(0, above(1.5))]);
    scene.lights[0].light = Light::spot(Vec3::new(0.0, 4.0, 0.0), Vec3::ZERO, 0.8, 0.9);
    scene.cameras[0].camera =
        Camera::look_at(Vec3::new(0.2, 0.8, 0.1), Vec3::new(-2.0, 0.0, -1.0), 1.3, 0.02, 40.0);
    let right = visibility(&gpu, &scene, &[("counting", "depth-fail")]);
    assert_eq!(off(&right, &visibility(&gpu, &scene, &[])), 0);
    let wrong = off(&right, &visibility(&gpu, &scene, &[("counting", "depth-pass")]));
    println!("{wrong} pixels are wrong");
    assert!(wrong > 2000, "{wrong}");
}

/// Without the features that make volumes whole, and depths fine, they are right too.
#[test]
fn without_features_volumes_are_whole() {
    let Some(with) = gpu() else { return };
    let lacking = wgpu::Features::DEPTH_CLIP_CONTROL | wgpu::Features::DEPTH32FLOAT_STENCIL8;
    let without = Gpu::without(Some("llvmpipe"), lacking).expect("a device");
    let perspective = mixture();
    let camera = &perspective.cameras[0].camera;
    let mut renderer = Renderer::new(&without, &perspective, camera, options(&[])).expect("a renderer");
    renderer.frame(Measure::Frame).expect("a frame");
    let refused = renderer.surfaces().expect_err("24 bits").to_string();
    assert!(refused.contains("24-bit depth cannot be copied"), "{refused}");
    let mut parallel = perspective.clone();
    let camera = &mut parallel.cameras[0].camera;
    camera.projection = Projection::Orthographic { half_height_m: 2.6 };
    // A far plane just behind what is seen: volumes go on for long behind it.
    let mut near = perspective.clone();
    near.cameras[0].camera.far_m = 13.0;
    let mut inside = perspective.clone();
    inside.cameras[0].camera =
        Camera::look_at(Vec3::new(0.35, 0.3, 0.2), Vec3::new(1.0, 0.1, -3.0), 1.2, 0.05, 12.0);
    for (name, scene) in
        [("perspective", perspective), ("parallel", parallel), ("near", near), ("inside", inside)]
    {
        for light in kinds(scene.lights[0].light) {
            let scene = with_light(scene.clone(), light);
            for counting in ["auto", "depth-fail"] {
                let pairs = [("counting", counting)];
                let (a, b) = (visibility(&with, &scene, &pairs), visibility(&without, &scene, &pairs));
                let off = off(&a, &b);
                println!("{name} {} {counting}: {off} pixels differ", light.kind.id());
                assert!(off <= MOST_OFF, "{name} {} {counting}: {off} pixels differ", light.kind.id());
            }
        }
    }
}

fn frame(renderer: &mut Renderer<'_>) -> (FrameReport, Vec<u8>) {
    let report = renderer.frame(Measure::Frame).expect("a frame");
    (report, renderer.picture().expect("a picture"))
}

/// Lights whose silhouettes were looked for.
fn found(report: &FrameReport) -> Vec<&str> {
    let names = report.passes.iter().map(|pass| pass.name.as_str());
    names.filter(|name| name.starts_with("silhouettes")).collect()
}

#[test]
fn silhouettes_hold_until_light_or_caster_moves() {
    let Some(gpu) = gpu() else { return };
    let mut scene = mixture();
    let second = Light::spot(Vec3::new(2.0, 6.0, 1.0), Vec3::ZERO, 0.5, 0.6);
    scene.lights.push(SceneLight { name: String::new(), light: second, cookie: None });
    let options = || RenderOptions { view: View::Final, exposure: Some(0.3), ..options(&[]) };
    let make =
        |scene: &Scene| Renderer::new(&gpu, scene, &scene.cameras[0].camera, options()).expect("a renderer");
    let fresh = |scene: &Scene| frame(&mut make(scene)).1;
    let mut renderer = make(&scene);
    let (first, picture) = frame(&mut renderer);
    assert_eq!(found(&first), ["silhouettes 0", "silhouettes 1"]);
    let (second, same) = frame(&mut renderer);
    assert!(found(&second).is_empty() && picture == same, "nothing moved: {:?}", found(&second));

    for eye in [Vec3::new(1.0, 5.0, 7.0), Vec3::new(-3.0, 4.0, -5.0), Vec3::new(0.0, 7.0, 1.0)] {
        scene.cameras[0].camera = Camera::look_at(eye, Vec3::ZERO, 0.8, 0.1, 50.0);
        renderer.set_camera(&scene.cameras[0].camera).expect("a camera");
        let (report, picture) = frame(&mut renderer);
        assert!(found(&report).is_empty(), "the eye went to {eye}: {:?}", found(&report));
        assert!(picture == fresh(&scene), "not the picture of a fresh renderer from {eye}");
    }

    // Into a shadow, out of it, and into it again: lids are wanted once and stay.
    let outside = scene.cameras[0].camera;
    let inside = Camera::look_at(Vec3::new(0.35, 0.3, 0.2), Vec3::new(1.0, 0.1, -3.0), 1.2, 0.05, 12.0);
    for (step, camera) in [inside, outside, inside, outside].into_iter().enumerate() {
        scene.cameras[0].camera = camera;
        renderer.set_camera(&camera).expect("a camera");
        let (report, picture) = frame(&mut renderer);
        assert!(step == 0 || found(&report).is_empty(), "step {step}: {:?}", found(&report));
        assert!(picture == fresh(&scene), "step {step}: not the picture of a fresh renderer");
    }

    scene.lights[1].light.intensity *= 2.0;
    renderer.set_light(1, &scene.lights[1].light).expect("lit");
    let (report, picture) = frame(&mut renderer);
    assert!(found(&report).is_empty() && picture == fresh(&scene), "only brighter: {:?}", found(&report));

    scene.lights[1].light.position_world.x += 0.4;
    renderer.set_light(1, &scene.lights[1].light).expect("lit");
    let (report, picture) = frame(&mut renderer);
    assert_eq!(found(&report), ["silhouettes 1"]);
    assert!(picture == fresh(&scene), "a light moved: not the picture of a fresh renderer");

    scene.instances[1].world_from_object = above(0.2) * scene.instances[1].world_from_object;
    renderer.place(1, scene.instances[1].world_from_object).expect("placed");
    let (report, picture) = frame(&mut renderer);
    assert_eq!(found(&report), ["silhouettes 0", "silhouettes 1"]);
    assert!(picture == fresh(&scene), "a caster moved: not the picture of a fresh renderer");

    let mesh = &mut scene.meshes[1];
    mesh.positions.iter_mut().for_each(|p| p.x += 0.6 * p.y);
    mesh.bounds = Aabb::from_points(mesh.positions.iter().copied());
    renderer.set_mesh(1, mesh).expect("posed");
    let (report, picture) = frame(&mut renderer);
    assert_eq!(found(&report), ["silhouettes 0", "silhouettes 1"]);
    assert!(picture == fresh(&scene), "a caster has another shape: not the picture of a fresh renderer");
    assert!(frame(&mut renderer).1 == picture);
}

#[test]
fn what_has_holes_or_is_moved_is_drawn_by_a_map() {
    let Some(gpu) = gpu() else { return };
    let mut scene = cut_out(AlphaMode::Mask { cutoff: 0.5 });
    let map = [("map_size", "1024")];
    let by_linear = by(&gpu, &scene, "linear", &map);
    let mut renderer =
        Renderer::new(&gpu, &scene, &scene.cameras[0].camera, options(&map)).expect("a renderer");
    frame(&mut renderer);
    let warnings = renderer.warnings().join(" ");
    assert!(warnings.contains("`sheet`") && warnings.contains("holes"), "{warnings}");
    // Alone, it is what the map says; a solid beside it is a volume's.
    assert_eq!(renderer.visibility().expect("V"), by_linear);
    scene.meshes.push(Mesh { material: 1, ..cuboid(Vec3::splat(0.3), &ALL) });
    scene.instances.push(Instance {
        mesh: 2,
        world_from_object: Mat4::from_translation(Vec3::new(2.0, 0.8, -1.0)),
        ..Instance::default()
    });
    let both = visibility(&gpu, &scene, &map);
    let joined = off(&both, &by(&gpu, &scene, "linear", &map));
    println!("{joined} of {} dark pixels differ from a map of everything", dark(&gpu, &scene, &both));
    assert!(dark(&gpu, &scene, &both) > dark(&gpu, &scene, &by_linear) + 50 && joined < 40, "{joined}");

    let deform = "fn umbrage_deform(p_world: vec3f, p_object: vec3f, time_s: f32) -> vec3f {
        return p_world + vec3f(0.2 * p_world.y, 0.0, 0.0);
    }";
    let scene = mixture();
    let moved = |options: RenderOptions| RenderOptions {
        deform: Some(deform.into()),
        deform_reach_m: 1.0,
        ..options
    };
    let mut renderer =
        Renderer::new(&gpu, &scene, &scene.cameras[0].camera, moved(options(&map))).expect("a renderer");
    frame(&mut renderer);
    assert!(renderer.warnings().join(" ").contains("a function moves"), "{:?}", renderer.warnings());
    let linear = RenderOptions { settings: settings("linear", &map), ..options(&[]) };
    assert_eq!(renderer.visibility().expect("V"), visibility_with(&gpu, &scene, moved(linear)));
}

/// With several samples, and where something shines by itself, surfaces are lit as they are drawn: after the G-buffer.
#[test]
fn what_is_lit_as_it_is_drawn_has_shadows() {
    let Some(gpu) = gpu() else { return };
    let mut glowing = mixture();
    glowing.materials.push(Material { emissive: Vec3::new(0.0, 0.0, 0.2), ..Material::default() });
    glowing.meshes[1].material = glowing.materials.len() - 1;
    for (name, scene, samples) in
        [("samples", mixture(), 4), ("emissive", glowing, 1), ("both", mixture(), 4)]
    {
        let shot = |technique: &str| {
            let settings = settings(technique, &[]);
            let look = RenderOptions { view: View::Final, samples, exposure: Some(0.3), ..options(&[]) };
            let options = RenderOptions { settings, ..look };
            let mut renderer =
                Renderer::new(&gpu, &scene, &scene.cameras[0].camera, options).expect("a renderer");
            frame(&mut renderer)
        };
        let (report, picture) = shot("volume");
        let names: Vec<&str> = report.passes.iter().map(|pass| pass.name.as_str()).collect();
        assert_eq!(names, ["surfaces", "silhouettes 0", "back+front 0", "mask 0", "lit surfaces"]);
        let differ = |other: &[u8]| {
            let pixels = picture.chunks_exact(4).zip(other.chunks_exact(4));
            pixels.filter(|(a, b)| (0..3).any(|i| a[i].abs_diff(b[i]) > 24)).count()
        };
        let (bare, linear) = (differ(&shot("unshadowed").1), differ(&shot("linear").1));
        println!("{name}: {bare} pixels are darker for shadows, {linear} differ from those of a map");
        assert!(bare > 400 && linear * 4 < bare, "{name}: {bare} {linear}");
    }
}

#[test]
fn nothing_there_and_many_lights() {
    let Some(gpu) = gpu() else { return };
    let mut empty = mixture();
    empty.instances.clear();
    assert!(visibility(&gpu, &empty, &[]).iter().all(|v| *v == 1.0), "nothing there, nothing dark");
    let mut many = mixture();
    let one = many.lights[0].light;
    many.lights = (0..MAX_LIGHTS)
        .map(|i| {
            let angle = i as f32 / MAX_LIGHTS as f32 * std::f32::consts::TAU;
            let place = Vec3::new(3.0 * angle.cos(), 6.0, 3.0 * angle.sin());
            let light = kinds(one.aimed(place, Vec3::ZERO))[i % 3];
            SceneLight { name: String::new(), light, cookie: None }
        })
        .collect();
    for shown in [0, 7, MAX_LIGHTS - 1] {
        let v = visibility_with(&gpu, &many, RenderOptions { shown_light: shown, ..options(&[]) });
        let alone = with_light(many.clone(), many.lights[shown].light);
        assert_eq!(v, visibility(&gpu, &alone, &[]), "light {shown} of many is the same alone");
        assert!(dark(&gpu, &alone, &v) > 200);
    }
}
