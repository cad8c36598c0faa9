//! Rows H14, H15, I4, I5 and I11: what moved is drawn again and nothing else, whoever draws it, and the picture is that of a
//! renderer that never knew anything else.

mod common;

use common::scenes::{cuboid, cut_out, sheet};
use common::{gpu, settings};
use glam::{Mat4, UVec2, Vec3};
use std::time::Duration;
use umbrage_render::umbrage::core::{Aabb, Camera, Light, LightKind};
use umbrage_render::{FrameReport, Gpu, MapSchedule, Measure, RenderError, RenderOptions, Renderer};
use umbrage_scene::{AlphaMode, Instance, Material, Scene, SceneCamera, SceneLight};

const SIDE: u32 = 96;

/// Two boxes far apart over a floor each, under a spot light each that sees only its own, and a camera that sees both.
/// Instances: floor, box, floor, box.
fn two_places() -> Scene {
    let mut scene = Scene { materials: vec![Material::default()], ..Scene::default() };
    scene.meshes = vec![sheet(Vec3::ZERO, Vec3::X * 3.0, Vec3::NEG_Z * 3.0, 0), cuboid(Vec3::splat(0.5))];
    for x in [-5.0, 5.0] {
        let aim = Vec3::new(x, 0.0, 0.0);
        for (mesh, y) in [(0, 0.0), (1, 1.2)] {
            let world_from_object = Mat4::from_translation(aim + Vec3::Y * y);
            scene.instances.push(Instance { mesh, world_from_object, ..Instance::default() });
        }
        let light = Light::spot(aim + Vec3::new(0.7, 6.0, 0.4), aim, 0.3, 0.4);
        // Planes that are fitted would follow the box, and the matrices with them.
        let planes = (x > 0.0).then_some((1.0, 9.0));
        let light = Light { near_m: planes.map(|p| p.0), far_m: planes.map(|p| p.1), ..light };
        scene.lights.push(SceneLight { name: String::new(), light, cookie: None });
    }
    let camera = Camera::look_at(Vec3::new(0.0, 9.0, 12.0), Vec3::ZERO, 1.0, 0.1, 60.0);
    scene.cameras.push(SceneCamera { name: String::new(), camera });
    scene
}

fn options() -> RenderOptions {
    let settings = settings("linear", &[("map_size", "128")]);
    RenderOptions { size: UVec2::splat(SIDE), exposure: Some(0.3), ..RenderOptions::new(settings) }
}

fn renderer<'a>(gpu: &'a Gpu, scene: &Scene) -> Renderer<'a> {
    Renderer::new(gpu, scene, &scene.cameras[0].camera, options()).expect("a renderer")
}

fn frame(renderer: &mut Renderer<'_>) -> (FrameReport, Vec<u8>) {
    let report = renderer.frame(Measure::Frame).expect("a frame");
    (report, renderer.picture().expect("a picture"))
}

/// Drawn and reused.
fn maps(report: &FrameReport) -> (u64, u64) {
    (report.maps_drawn, report.maps_reused)
}

fn map_passes(report: &FrameReport) -> Vec<&str> {
    let names = report.passes.iter().map(|pass| pass.name.as_str());
    names.filter(|name| name.starts_with("shadow-map")).collect()
}

/// The picture of a renderer that was never told anything.
fn fresh(gpu: &Gpu, scene: &Scene) -> Vec<u8> {
    frame(&mut renderer(gpu, scene)).1
}

#[test]
fn nothing_is_drawn_again_when_nothing_moved() {
    let Some(gpu) = gpu() else { return };
    let scene = two_places();
    let mut renderer = renderer(&gpu, &scene);
    let (first, picture) = frame(&mut renderer);
    assert_eq!(maps(&first), (2, 0));
    assert_eq!(map_passes(&first), ["shadow-map 0", "shadow-map 1"]);
    let (second, same) = frame(&mut renderer);
    assert_eq!((maps(&second), map_passes(&second).len()), ((0, 2), 0));
    assert!(picture == same, "the same world, another picture");
    // To be told what was so already is no change.
    renderer.place(1, scene.instances[1].world_from_object).expect("placed");
    renderer.set_light(0, &scene.lights[0].light).expect("lit");
    assert_eq!(maps(&frame(&mut renderer).0), (0, 2));
}

#[test]
fn without_reuse_every_frame_draws_all_maps() {
    let Some(gpu) = gpu() else { return };
    let scene = two_places();
    let options = RenderOptions { reuse: false, ..options() };
    let mut renderer = Renderer::new(&gpu, &scene, &scene.cameras[0].camera, options).expect("a renderer");
    let pictures = [(); 3].map(|()| {
        let (report, picture) = frame(&mut renderer);
        assert_eq!((maps(&report), map_passes(&report).len()), ((2, 0), 2));
        picture
    });
    assert!(pictures[0] == pictures[1] && pictures[1] == pictures[2]);
    assert!(pictures[0] == fresh(&gpu, &scene), "reuse changes a picture");
}

#[test]
fn a_camera_moves_over_maps_that_stay() {
    let Some(gpu) = gpu() else { return };
    let mut scene = two_places();
    let mut renderer = renderer(&gpu, &scene);
    let (_, before) = frame(&mut renderer);
    for eye in [Vec3::new(3.0, 4.0, 9.0), Vec3::new(-9.0, 6.0, 2.0), Vec3::new(-5.0, 5.0, 5.0)] {
        let camera = Camera::look_at(eye, Vec3::new(-2.0, 0.0, 0.0), 0.9, 0.1, 60.0);
        renderer.set_camera(&camera).expect("a camera");
        let (report, picture) = frame(&mut renderer);
        assert_eq!(maps(&report), (0, 2));
        scene.cameras[0].camera = camera;
        assert!(picture == fresh(&gpu, &scene), "not the picture of a fresh renderer from {eye}");
        assert!(picture != before);
    }
}

#[test]
fn a_caster_that_moves_is_drawn_again_where_it_is_seen() {
    let Some(gpu) = gpu() else { return };
    let mut scene = two_places();
    let mut renderer = renderer(&gpu, &scene);
    let (_, before) = frame(&mut renderer);
    for step in 1..4 {
        let world_from_object = Mat4::from_translation(Vec3::new(5.0 + 0.1 * step as f32, 1.2, 0.1))
            * Mat4::from_rotation_y(0.2 * step as f32);
        renderer.place(3, world_from_object).expect("placed");
        let (report, picture) = frame(&mut renderer);
        assert_eq!((maps(&report), map_passes(&report)), ((1, 1), vec!["shadow-map 1"]));
        scene.instances[3].world_from_object = world_from_object;
        assert!(picture == fresh(&gpu, &scene), "step {step}: not the picture of a fresh renderer");
        assert!(picture != before, "step {step}: it did not move");
    }
    // Mirrored, it takes other pipelines.
    let mirrored = scene.instances[3].world_from_object * Mat4::from_scale(Vec3::new(-1.0, 1.3, 1.0));
    renderer.place(3, mirrored).expect("placed");
    scene.instances[3].world_from_object = mirrored;
    let (report, picture) = frame(&mut renderer);
    assert_eq!(maps(&report), (1, 1));
    assert!(picture == fresh(&gpu, &scene), "mirrored: not the picture of a fresh renderer");
}

#[test]
fn a_caster_that_no_light_sees_moves_for_nothing() {
    let Some(gpu) = gpu() else { return };
    let mut scene = two_places();
    let aside = |z: f32| Mat4::from_translation(Vec3::new(0.0, 1.0, z)) * Mat4::from_scale(Vec3::splat(0.4));
    scene.instances.push(Instance { mesh: 1, world_from_object: aside(0.0), ..Instance::default() });
    let mut renderer = renderer(&gpu, &scene);
    let (_, before) = frame(&mut renderer);
    renderer.place(4, aside(2.0)).expect("placed");
    let (report, picture) = frame(&mut renderer);
    assert_eq!(maps(&report), (0, 2));
    assert!(picture != before, "the camera sees it");
    scene.instances[4].world_from_object = aside(2.0);
    assert!(picture == fresh(&gpu, &scene), "not the picture of a fresh renderer");
    // Into a light's view, and it counts; out of it, and its leaving does.
    renderer.place(4, Mat4::from_translation(Vec3::new(-5.5, 2.4, 0.0))).expect("placed");
    assert_eq!(maps(&frame(&mut renderer).0), (1, 1));
    renderer.place(4, aside(2.0)).expect("placed");
    let (report, back) = frame(&mut renderer);
    assert_eq!(maps(&report), (1, 1));
    assert!(back == picture);
}

#[test]
fn a_light_that_moves_has_its_own_maps_drawn_again() {
    let Some(gpu) = gpu() else { return };
    let mut scene = two_places();
    scene.lights[1].light =
        Light { kind: LightKind::Point, position_world: Vec3::new(5.0, 4.0, 1.0), ..scene.lights[1].light };
    let mut renderer = renderer(&gpu, &scene);
    assert_eq!(maps(&frame(&mut renderer).0), (7, 0));

    scene.lights[1].light.position_world.x += 0.3;
    renderer.set_light(1, &scene.lights[1].light).expect("lit");
    let (report, picture) = frame(&mut renderer);
    assert_eq!(maps(&report), (6, 1));
    assert!(picture == fresh(&gpu, &scene), "point: not the picture of a fresh renderer");

    scene.lights[0].light = Light::spot(Vec3::new(-6.0, 5.0, 0.5), Vec3::new(-5.0, 0.0, 0.0), 0.3, 0.42);
    renderer.set_light(0, &scene.lights[0].light).expect("lit");
    let (report, picture) = frame(&mut renderer);
    assert_eq!((maps(&report), map_passes(&report)), ((1, 6), vec!["shadow-map 0"]));
    assert!(picture == fresh(&gpu, &scene), "spot: not the picture of a fresh renderer");

    // Colour and intensity are in no map.
    scene.lights[0].light.intensity *= 2.0;
    scene.lights[0].light.color = Vec3::new(1.0, 0.4, 0.2);
    renderer.set_light(0, &scene.lights[0].light).expect("lit");
    let (report, picture) = frame(&mut renderer);
    assert_eq!(maps(&report), (0, 7));
    assert!(picture == fresh(&gpu, &scene), "colour: not the picture of a fresh renderer");
}

#[test]
fn a_light_may_lose_and_win_its_map() {
    let Some(gpu) = gpu() else { return };
    for index in [0, 1] {
        let mut scene = two_places();
        let at = scene.lights[index].light;
        let away = Light { direction_world: -at.direction_world, near_m: None, far_m: None, ..at };
        scene.lights[index].light = away;
        let mut renderer = renderer(&gpu, &scene);
        assert_eq!(maps(&frame(&mut renderer).0), (1, 0));
        for light in [at, away, at] {
            scene.lights[index].light = light;
            renderer.set_light(index, &light).expect("lit");
            let (report, picture) = frame(&mut renderer);
            assert_eq!(report.maps_drawn + report.maps_reused, if light == at { 2 } else { 1 });
            assert!(picture == fresh(&gpu, &scene), "light {index}: not the picture of a fresh renderer");
        }
    }
}

#[test]
fn vertices_that_move_are_a_reason_to_draw_again() {
    let Some(gpu) = gpu() else { return };
    let mut scene = two_places();
    // One box of its own mesh, so that the other light's map has no part in it.
    scene.meshes.push(scene.meshes[1].clone());
    scene.instances[3].mesh = 2;
    let mut renderer = renderer(&gpu, &scene);
    frame(&mut renderer);
    let mesh = &mut scene.meshes[2];
    mesh.positions.iter_mut().for_each(|p| p.x += 0.6 * p.y);
    mesh.bounds = Aabb::from_points(mesh.positions.iter().copied());
    renderer.set_mesh(2, mesh).expect("posed");
    let (report, picture) = frame(&mut renderer);
    assert_eq!((maps(&report), map_passes(&report)), ((1, 1), vec!["shadow-map 1"]));
    assert!(picture == fresh(&gpu, &scene), "not the picture of a fresh renderer");
    // Vertices with textures are interleaved with other things.
    let mut scene = cut_out(AlphaMode::Mask { cutoff: 0.5 });
    let mut renderer = self::renderer(&gpu, &scene);
    frame(&mut renderer);
    scene.meshes[0].positions.iter_mut().for_each(|p| p.y += 0.3 * p.x);
    scene.meshes[0].bounds = Aabb::from_points(scene.meshes[0].positions.iter().copied());
    renderer.set_mesh(0, &scene.meshes[0]).expect("posed");
    let (report, picture) = frame(&mut renderer);
    assert_eq!(maps(&report), (1, 0));
    assert!(picture == fresh(&gpu, &scene), "cut out: not the picture of a fresh renderer");
}

#[test]
fn time_counts_only_where_something_moves_by_it() {
    let Some(gpu) = gpu() else { return };
    let scene = two_places();
    let mut still = renderer(&gpu, &scene);
    frame(&mut still);
    still.set_time(1.0).expect("a time");
    assert_eq!(maps(&frame(&mut still).0), (0, 2));

    let deform = "fn umbrage_deform(p_world: vec3f, p_object: vec3f, time_s: f32) -> vec3f {
        return p_world + vec3f(0.2 * time_s * p_world.y, 0.0, 0.0);
    }";
    let at = |time_s| RenderOptions { deform: Some(deform.into()), deform_reach_m: 1.0, time_s, ..options() };
    let make =
        |time_s| Renderer::new(&gpu, &scene, &scene.cameras[0].camera, at(time_s)).expect("a renderer");
    let mut moving = make(0.0);
    frame(&mut moving);
    moving.set_time(1.0).expect("a time");
    let (report, picture) = frame(&mut moving);
    assert_eq!(maps(&report), (2, 0));
    assert!(picture == frame(&mut make(1.0)).1, "not the picture of a fresh renderer");
}

#[test]
fn maps_that_lag_are_looked_up_with_their_own_matrices() {
    let Some(gpu) = gpu() else { return };
    let mut scene = two_places();
    let mut lagging = renderer(&gpu, &scene);
    lagging.schedule_maps(MapSchedule::Every(Duration::from_secs(3600))).expect("a schedule");
    let (first, before) = frame(&mut lagging);
    assert_eq!((maps(&first), first.maps_age_frames), ((2, 0), 0));
    // The light turns a little and its map does not follow: shadows stay where they are, light does not.
    let aim = Vec3::new(-4.9, 0.0, 0.0);
    scene.lights[0].light = scene.lights[0].light.aimed(scene.lights[0].light.position_world, aim);
    lagging.set_light(0, &scene.lights[0].light).expect("lit");
    for age in 1..4 {
        lagging.place(0, scene.instances[0].world_from_object).expect("placed");
        let (report, picture) = frame(&mut lagging);
        assert_eq!((maps(&report), report.maps_age_frames), ((0, 2), age));
        assert!(report.maps_age_ms > 0.0);
        // Looked up with the new matrices, all of the box's shadow would shift against the floor.
        let off = picture.iter().zip(&before).filter(|(a, b)| a.abs_diff(**b) > 40).count();
        assert!(off < 12, "{off} channels jump");
        assert!(picture != before, "the light does not shine from where it is");
    }
    lagging.schedule_maps(MapSchedule::EachFrame).expect("a schedule");
    let (report, picture) = frame(&mut lagging);
    assert_eq!((maps(&report), report.maps_age_frames), ((1, 1), 0));
    assert!(picture == fresh(&gpu, &scene), "not the picture of a fresh renderer");
}

/// Frames until the thread has caught up; a thread that never does fails.
fn caught_up(renderer: &mut Renderer<'_>) -> (u64, Vec<u8>) {
    let mut drawn = 0;
    for _ in 0..500 {
        let (report, picture) = frame(renderer);
        drawn += report.maps_drawn;
        assert!(map_passes(&report).is_empty(), "the frame drew a map");
        if report.maps_age_frames == 0 {
            return (drawn, picture);
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    panic!("the thread never caught up");
}

#[test]
fn a_thread_draws_what_the_frame_would() {
    let Some(gpu) = gpu() else { return };
    let mut scene = two_places();
    let mut threaded = renderer(&gpu, &scene);
    let single = threaded.shadow_memory_bytes();
    threaded.schedule_maps(MapSchedule::Threaded(Duration::from_millis(1))).expect("a thread");
    let (_, picture) = caught_up(&mut threaded);
    assert!(picture == fresh(&gpu, &scene), "at rest: not the picture of a fresh renderer");
    for step in 0..20 {
        let world_from_object = Mat4::from_translation(Vec3::new(5.0, 1.2, 0.05 * step as f32));
        threaded.place(3, world_from_object).expect("placed");
        scene.instances[3].world_from_object = world_from_object;
        scene.lights[0].light.position_world.y += 0.02;
        threaded.set_light(0, &scene.lights[0].light).expect("lit");
        if step % 4 != 3 {
            frame(&mut threaded);
            continue;
        }
        let (_, picture) = caught_up(&mut threaded);
        assert!(picture == fresh(&gpu, &scene), "step {step}: not the picture of a fresh renderer");
    }
    // At rest the thread rests too.
    std::thread::sleep(Duration::from_millis(30));
    frame(&mut threaded);
    std::thread::sleep(Duration::from_millis(30));
    assert_eq!(maps(&frame(&mut threaded).0), (0, 2));
    assert_eq!(threaded.shadow_memory_bytes(), 2 * single);
    threaded.schedule_maps(MapSchedule::EachFrame).expect("the frame's again");
    assert!(frame(&mut threaded).1 == fresh(&gpu, &scene));
    assert_eq!(threaded.shadow_memory_bytes(), single);
}

#[test]
fn a_slow_thread_holds_up_no_frame() {
    let Some(gpu) = gpu() else { return };
    let scene = two_places();
    // No time is asserted: frames are counted while one map is being made that takes as long as hundreds of them.
    let options = RenderOptions { map_load_ms: 60.0, ..options() };
    let mut slow = Renderer::new(&gpu, &scene, &scene.cameras[0].camera, options).expect("a renderer");
    slow.schedule_maps(MapSchedule::Threaded(Duration::ZERO)).expect("a thread");
    frame(&mut slow);
    let (mut oldest, mut drawn) = (0, 0);
    for step in 0..20_000 {
        slow.place(3, Mat4::from_translation(Vec3::new(5.0, 1.2, 1e-4 * step as f32))).expect("placed");
        let (report, _) = frame(&mut slow);
        oldest = oldest.max(report.maps_age_frames);
        drawn += report.maps_drawn;
        if drawn > 0 {
            break;
        }
    }
    assert!(oldest > 3 && drawn > 0, "maps were {oldest} frames old at most, and {drawn} were drawn");
}

#[test]
fn memory_is_linear_in_lights_and_knows_nothing_of_the_scene() {
    let Some(gpu) = gpu() else { return };
    let scene = two_places();
    let with = |scene: &Scene, lights: usize, settings| {
        let mut scene = scene.clone();
        let light = scene.lights[0].clone();
        scene.lights = vec![light; lights];
        let options = RenderOptions { settings, ..options() };
        let renderer = Renderer::new(&gpu, &scene, &scene.cameras[0].camera, options).expect("a renderer");
        (renderer.shadow_memory_bytes(), renderer.shadow_memory_of_lights())
    };
    let depth = || settings("linear", &[("map_size", "128"), ("storage", "depth32f")]);
    let one = with(&scene, 1, depth());
    assert_eq!(one, (128 * 128 * 4, vec![128 * 128 * 4]));
    for lights in [2usize, 5, 16] {
        assert_eq!(with(&scene, lights, depth()), (lights as u64 * one.0, vec![one.0; lights]));
    }
    let mut larger = scene.clone();
    for step in 0..300 {
        let world_from_object = Mat4::from_translation(Vec3::new(-5.0, 0.01 * step as f32, 0.0));
        larger.instances.push(Instance { mesh: 1, world_from_object, ..Instance::default() });
    }
    assert_eq!(with(&larger, 5, depth()).0, 5 * one.0);
    let bare = with(&scene, 3, settings("unshadowed", &[]));
    assert_eq!(bare, (0, vec![0; 3]));
}

#[test]
fn what_cannot_be_is_refused_in_one_line() {
    let Some(gpu) = gpu() else { return };
    let scene = two_places();
    let mut renderer = renderer(&gpu, &scene);
    let point = Light { kind: LightKind::Point, ..scene.lights[0].light };
    let dark = Light { intensity: f32::NAN, ..scene.lights[0].light };
    let mut torn = scene.meshes[1].clone();
    torn.positions[0].x = f32::NAN;
    let lost = Camera { position_world: Vec3::NAN, ..scene.cameras[0].camera };
    let errors: Vec<RenderError> = [
        renderer.place(4, Mat4::IDENTITY),
        renderer.place(0, Mat4::from_translation(Vec3::NAN)),
        renderer.place(0, Mat4::ZERO),
        renderer.set_light(2, &scene.lights[0].light),
        renderer.set_light(0, &point),
        renderer.set_light(0, &dark),
        renderer.set_mesh(2, &scene.meshes[1]),
        renderer.set_mesh(0, &scene.meshes[1]),
        renderer.set_mesh(1, &torn),
        renderer.set_camera(&lost),
        renderer.set_time(f32::INFINITY),
    ]
    .into_iter()
    .map(|refused| refused.expect_err("refused"))
    .collect();
    for error in errors {
        let text = error.to_string();
        assert!(!text.contains('\n') && text.len() > 20, "{text}");
    }
    // Nothing of it sticks.
    assert!(frame(&mut renderer).1 == fresh(&gpu, &scene));
}
