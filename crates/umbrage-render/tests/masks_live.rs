//! Masks while things move, where there can be none, and of whatever is handed in.

mod common;

use common::scenes::{builtin, cuboid, over_floor, sheet, with_light};
use common::{gpu, settings};
use glam::{Mat4, UVec2, Vec3};
use umbrage_render::umbrage::core::{Aabb, Light, LightKind};
use umbrage_render::{FrameReport, Gpu, MAX_LIGHTS, Measure, RenderOptions, Renderer, View};
use umbrage_scene::{Instance, Material, Mesh, Scene, SceneLight};

/// Both ways to draw receivers.
const BOTH: [&str; 2] = ["mask", "mask-subtractive"];

fn options(technique: &str, view: View) -> RenderOptions {
    let sized: &[_] = if technique.starts_with("mask") { &[("mask_size", "64")] } else { &[] };
    let settings = settings(technique, sized);
    RenderOptions { size: UVec2::splat(64), view, exposure: Some(0.02), ..RenderOptions::new(settings) }
}

fn make<'a>(gpu: &'a Gpu, scene: &Scene, options: RenderOptions) -> Renderer<'a> {
    Renderer::new(gpu, scene, &scene.cameras[0].camera, options).expect("a renderer")
}

fn frame(renderer: &mut Renderer<'_>) -> (FrameReport, Vec<u8>) {
    let report = renderer.frame(Measure::Frame).expect("a frame");
    (report, renderer.picture().expect("a picture"))
}

fn mask_passes(report: &FrameReport) -> Vec<&str> {
    let names = report.passes.iter().map(|pass| pass.name.as_str());
    names.filter(|name| name.starts_with("mask ")).collect()
}

/// V of the first light.
fn visibility(gpu: &Gpu, scene: &Scene, technique: &str) -> (Vec<f32>, Vec<String>) {
    let mut renderer = make(gpu, scene, options(technique, View::Visibility));
    renderer.frame(Measure::Frame).expect("a frame");
    (renderer.visibility().expect("V"), renderer.warnings().to_vec())
}

/// Boxes of so many metres at these places over a floor, which is the last object.
fn boxes(at: &[(Vec3, f32)]) -> Scene {
    let meshes = at.iter().map(|(_, side_m)| cuboid(Vec3::splat(0.5 * side_m))).collect();
    let placed: Vec<_> = at.iter().enumerate().map(|(i, (at, _))| (i, Mat4::from_translation(*at))).collect();
    over_floor(vec![Material::default()], vec![], meshes, &placed)
}

/// Two boxes under two lights.
fn two_and_two() -> Scene {
    let mut scene = boxes(&[(Vec3::new(-0.8, 1.0, 0.0), 0.8), (Vec3::new(0.9, 1.2, 0.3), 0.8)]);
    let light =
        Light { kind: LightKind::Point, ..Light::spot(Vec3::new(1.0, 5.0, 2.0), Vec3::ZERO, 0.5, 0.6) };
    scene.lights.push(SceneLight { light, ..scene.lights[0].clone() });
    scene
}

#[test]
fn only_masks_of_what_moved_are_drawn_again() {
    let Some(gpu) = gpu() else { return };
    for technique in BOTH {
        let mut scene = two_and_two();
        let options = || options(technique, View::Final);
        let fresh = |scene: &Scene| frame(&mut make(&gpu, scene, options())).1;
        let mut renderer = make(&gpu, &scene, options());
        let (report, first) = frame(&mut renderer);
        assert_eq!(mask_passes(&report), ["mask 0.0", "mask 0.1", "mask 1.0", "mask 1.1"]);
        let (report, same) = frame(&mut renderer);
        assert!(mask_passes(&report).is_empty() && first == same, "{technique}: nothing moved");
        // To look from elsewhere is no reason.
        scene.cameras[0].camera.position_world.x += 0.5;
        renderer.set_camera(&scene.cameras[0].camera).expect("a camera");
        let (report, picture) = frame(&mut renderer);
        assert!(mask_passes(&report).is_empty(), "{technique}: the camera moved");
        assert!(picture == fresh(&scene) && picture != first, "{technique}: the camera moved");
        // A receiver neither.
        scene.instances[2].world_from_object = Mat4::from_translation(Vec3::Y * -0.3);
        renderer.place(2, scene.instances[2].world_from_object).expect("placed");
        let (report, picture) = frame(&mut renderer);
        assert!(mask_passes(&report).is_empty(), "{technique}: the floor moved");
        assert!(picture == fresh(&scene), "{technique}: the floor moved");
        // A blocker has its own drawn again, by each light.
        scene.instances[1].world_from_object = Mat4::from_translation(Vec3::new(0.7, 1.5, 0.1));
        renderer.place(1, scene.instances[1].world_from_object).expect("placed");
        let (report, picture) = frame(&mut renderer);
        assert_eq!(mask_passes(&report), ["mask 0.1", "mask 1.1"], "{technique}");
        assert!(picture == fresh(&scene), "{technique}: a blocker moved");
        // A light all of its own.
        scene.lights[1].light.position_world.x -= 0.4;
        renderer.set_light(1, &scene.lights[1].light).expect("lit");
        let (report, picture) = frame(&mut renderer);
        assert_eq!(mask_passes(&report), ["mask 1.0", "mask 1.1"], "{technique}");
        assert!(picture == fresh(&scene), "{technique}: a light moved");
        // Its colour is in no mask.
        scene.lights[1].light.intensity *= 0.5;
        renderer.set_light(1, &scene.lights[1].light).expect("lit");
        let (report, picture) = frame(&mut renderer);
        assert!(mask_passes(&report).is_empty() && picture == fresh(&scene), "{technique}: a light dimmed");
        // Another pose.
        let mesh = &mut scene.meshes[0];
        mesh.positions.iter_mut().for_each(|p| p.x += 0.6 * p.y);
        mesh.bounds = Aabb::from_points(mesh.positions.iter().copied());
        renderer.set_mesh(0, mesh).expect("posed");
        let (report, picture) = frame(&mut renderer);
        assert_eq!(mask_passes(&report), ["mask 0.0", "mask 1.0"], "{technique}");
        assert!(picture == fresh(&scene), "{technique}: a blocker has another pose");
        // A light that no longer reaches a blocker, and then does.
        let at = scene.lights[0].light;
        let away = Light { direction_world: -at.direction_world, ..at };
        for light in [away, at] {
            scene.lights[0].light = light;
            renderer.set_light(0, &light).expect("lit");
            assert!(frame(&mut renderer).1 == fresh(&scene), "{technique}: a light turned");
        }
    }
}

/// Whatever a light cannot mask is drawn by a map, by name, into the same V.
#[test]
fn what_has_no_mask_has_a_map() {
    let Some(gpu) = gpu() else { return };
    let mut scene = boxes(&[(Vec3::new(-0.5, 0.7, 0.0), 0.6), (Vec3::new(1.0, 1.0, -0.5), 0.7)]);
    scene.instances[0].name = "shade".into();
    scene.instances[1].name = "crate".into();
    // A light between two sheets of one object: inside of its box, and outside of its surface.
    let mut shade = sheet(Vec3::new(0.8, 0.3, 0.0), Vec3::Z * 0.5, Vec3::Y * 0.5, 0);
    let other = sheet(Vec3::new(-0.8, 0.3, 0.0), Vec3::Z * 0.5, Vec3::Y * 0.5, 0);
    shade.indices.extend(other.indices.iter().map(|i| i + 4));
    shade.positions.extend(&other.positions);
    shade.normals.extend(&other.normals);
    shade.uvs.extend(&other.uvs);
    shade.bounds = Aabb::from_points(shade.positions.iter().copied());
    scene.materials[0].double_sided = true;
    scene.meshes[0] = shade;
    let spot = scene.lights[0].light;
    let point = Light { kind: LightKind::Point, position_world: Vec3::new(-0.5, 1.2, 0.0), ..spot };
    let scene = with_light(scene, point);
    let (linear, _) = visibility(&gpu, &scene, "linear");
    for technique in BOTH {
        let (v, warnings) = visibility(&gpu, &scene, technique);
        let off = v.iter().zip(&linear).filter(|(a, b)| (*a - *b).abs() > 0.5).count();
        let dark = linear.iter().filter(|v| **v < 0.5).count();
        println!("{technique}: {off} off of {dark} dark; {warnings:?}");
        let named = warnings.iter().any(|w| w.contains("`shade`") && w.contains("`linear`"));
        assert!(named && !warnings.iter().any(|w| w.contains("`crate`")), "{technique}: {warnings:?}");
        assert!(warnings.iter().all(|w| !w.contains('\n')));
        // The map does not know the crate, nor do masks the crate's own back, which faces away.
        assert!(dark > 400 && off * 20 < dark, "{technique}: {off} of {dark}");
        let mut without = scene.clone();
        without.instances[1].roles.blocker = false;
        let (less, _) = visibility(&gpu, &without, technique);
        assert!(
            less.iter().zip(&v).filter(|(a, b)| *a > *b).count() > 20,
            "{technique}: the crate has a mask"
        );
    }
}

/// A blocker whose vertices are dense at one end: the mean direction goes there, and the other end lies too far aside for a
/// view along it. Along the middle of the box there is room.
#[test]
fn a_mean_direction_that_leaves_no_room_gives_way_to_the_box() {
    let Some(gpu) = gpu() else { return };
    // A beam of 12 m close below the light. Hulls drop what is inside of faces, so the dense end is round.
    let mut beam = cuboid(Vec3::new(4.0, 0.05, 0.05));
    for step in 0..200 {
        let angle = std::f32::consts::TAU * step as f32 / 200.0;
        let first = beam.positions.len() as u32;
        let at = |angle: f32| Vec3::new(4.0, 0.09 * angle.cos(), 0.09 * angle.sin());
        beam.positions.extend([Vec3::X * 4.0, at(angle), at(angle + 0.0314)]);
        beam.normals.extend([Vec3::X; 3]);
        beam.indices.extend([first, first + 1, first + 2]);
    }
    beam.bounds = Aabb::from_points(beam.positions.iter().copied());
    let scene = over_floor(
        vec![Material { double_sided: true, ..Material::default() }],
        vec![],
        vec![beam],
        &[(0, Mat4::from_translation(Vec3::Y * 1.0))],
    );
    let point = Light { kind: LightKind::Point, position_world: Vec3::Y * 2.2, ..scene.lights[0].light };
    let scene = with_light(scene, point);
    let (linear, _) = visibility(&gpu, &scene, "linear");
    let dark = |v: &[f32]| v.iter().filter(|v| **v < 0.5).count();
    for technique in BOTH {
        let (v, warnings) = visibility(&gpu, &scene, technique);
        println!("{technique}: {} dark, {} by a map; {warnings:?}", dark(&v), dark(&linear));
        assert!(dark(&linear) > 60 && dark(&v) * 4 > dark(&linear) * 3, "{technique}: {warnings:?}");
    }
}

/// 256 masks are all that there may be: the largest objects get them.
#[test]
fn more_blockers_than_masks_leave_the_smallest_to_a_map() {
    let Some(gpu) = gpu() else { return };
    let place = |i: usize| Vec3::new((i % 20) as f32 * 0.4 - 3.8, 0.6, (i / 20) as f32 * 0.5 - 3.5);
    let mut scene = boxes(&[(Vec3::ZERO, 0.2)]);
    let floor = scene.instances.pop().expect("a floor");
    let one = scene.instances.pop().expect("a box");
    for i in 0..280 {
        // The last ones are the smallest.
        let size = if i < 260 { 1.0 } else { 0.7 };
        let world_from_object = Mat4::from_translation(place(i)) * Mat4::from_scale(Vec3::splat(size));
        scene.instances.push(Instance {
            world_from_object,
            object: i as u32,
            name: format!("b{i}"),
            ..one.clone()
        });
    }
    scene.instances.push(Instance { object: 280, ..floor });
    let spot = scene.lights[0].light;
    let scene = with_light(scene, Light { kind: LightKind::Directional, near_m: None, far_m: None, ..spot });
    let (linear, _) = visibility(&gpu, &scene, "linear");
    for technique in BOTH {
        let (v, warnings) = visibility(&gpu, &scene, technique);
        let off = v.iter().zip(&linear).filter(|(a, b)| (*a - *b).abs() > 0.5).count();
        let dark = linear.iter().filter(|v| **v < 0.5).count();
        println!("{technique}: {off} off, {dark} dark; {warnings:?}");
        assert!(dark > 200 && off * 20 < dark, "{technique}: {off} of {dark}");
        assert!(warnings.iter().any(|w| w.contains("`b279`") || w.contains("more")), "{warnings:?}");
        assert!(!warnings.iter().any(|w| w.contains("`b0`,")), "{warnings:?}");
    }
}

/// Whatever is handed in: V is a visibility, and a frame is drawn in every way.
#[test]
fn odd_scenes_have_pictures() {
    let Some(gpu) = gpu() else { return };
    let triangle =
        Mesh { indices: vec![0, 1, 2], ..sheet(Vec3::Y * 1.5, Vec3::X * 0.5, Vec3::NEG_Z * 0.5, 0) };
    let mut flat = sheet(Vec3::Y * 1.5, Vec3::X * 0.5, Vec3::NEG_Z * 0.5, 0);
    flat.indices.extend([0, 0, 1, 2, 2, 2, 1, 3, 1]);
    let nothing =
        Mesh { indices: vec![0, 0, 0], ..sheet(Vec3::Y * 1.5, Vec3::X * 0.5, Vec3::NEG_Z * 0.5, 0) };
    let mut open = cuboid(Vec3::splat(0.5));
    open.indices.truncate(24);
    let material = || Material { double_sided: true, ..Material::default() };
    let with = |mesh: Mesh, at: Mat4| over_floor(vec![material()], vec![], vec![mesh], &[(0, at)]);
    let up = Mat4::from_translation(Vec3::Y * 1.5);
    let mut empty = with(triangle.clone(), Mat4::IDENTITY);
    empty.instances.clear();
    let mut dark = with(triangle.clone(), Mat4::IDENTITY);
    dark.lights.clear();
    let mut shining = with(cuboid(Vec3::splat(0.5)), up);
    shining.materials[0].emissive = Vec3::new(0.2, 0.5, 0.1);
    let mut crowd = with(cuboid(Vec3::splat(0.5)), up);
    crowd.lights = (0..MAX_LIGHTS + 1).map(|_| crowd.lights[0].clone()).collect();
    let huge = {
        let mut scene = builtin("torus?scale=1000");
        scene.lights.truncate(1);
        scene
    };
    for (name, scene, shadow) in [
        ("one triangle", with(triangle, Mat4::IDENTITY), true),
        ("degenerate faces", with(flat, Mat4::IDENTITY), true),
        ("nothing but a point", with(nothing, Mat4::IDENTITY), false),
        ("an open box", with(open, up), true),
        ("no size", with(cuboid(Vec3::splat(0.5)), up * Mat4::from_scale(Vec3::ZERO)), false),
        ("no height", with(cuboid(Vec3::splat(0.5)), up * Mat4::from_scale(Vec3::new(1.0, 0.0, 1.0))), true),
        ("mirrored", with(cuboid(Vec3::splat(0.5)), up * Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0))), true),
        ("empty", empty, false),
        ("without light", dark, false),
        ("shining", shining, true),
        ("17 lights", crowd, true),
        ("huge", huge, true),
    ] {
        for technique in BOTH {
            for samples in [1, 4] {
                let options = RenderOptions { samples, ..options(technique, View::Final) };
                frame(&mut make(&gpu, &scene, options));
            }
            if scene.lights.is_empty() {
                continue;
            }
            for kind in [scene.lights[0].light.kind, LightKind::Point, LightKind::Directional] {
                let mut scene = scene.clone();
                let light = Light { kind, near_m: None, far_m: None, ..scene.lights[0].light };
                scene.lights[0].light = light;
                let (v, warnings) = visibility(&gpu, &scene, technique);
                let (plain, _) = visibility(&gpu, &scene, "unshadowed");
                let darker = v.iter().zip(&plain).filter(|(v, plain)| v < plain).count();
                let what = format!("{name}, {technique}, {kind:?}: {darker} darker; {warnings:?}");
                assert!(v.iter().all(|v| (0.0..=1.0).contains(v)), "{what}");
                assert!(if shadow { darker > 8 } else { darker == 0 }, "{what}");
            }
        }
    }
}

/// On a face, on an edge, at a corner and inside: a word of why, and a shadow by a map.
#[test]
fn a_light_on_or_in_a_mesh_gets_a_map() {
    let Some(gpu) = gpu() else { return };
    let at = Vec3::new(0.2, 1.2, 0.1);
    let scene = boxes(&[(at, 1.0)]);
    for offset in [Vec3::ZERO, Vec3::Y * 0.5, Vec3::new(0.5, 0.5, 0.0), Vec3::splat(0.5), Vec3::Y * 0.5001] {
        let light = Light { kind: LightKind::Point, position_world: at + offset, ..scene.lights[0].light };
        let scene = with_light(scene.clone(), light);
        let (linear, _) = visibility(&gpu, &scene, "linear");
        for technique in BOTH {
            let (v, warnings) = visibility(&gpu, &scene, technique);
            assert!(v.iter().all(|v| (0.0..=1.0).contains(v)), "{technique} {offset}");
            assert!(
                warnings.iter().any(|w| w.contains("160 degrees") && w.contains("`linear`")),
                "{warnings:?}"
            );
            assert_eq!(v, linear, "{technique} {offset}: the only blocker is drawn by a map");
        }
    }
}
