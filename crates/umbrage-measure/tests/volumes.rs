//! Shadow volumes against ray-traced truth: what differs lies at a geometric edge, wherever eye and light are.

mod common;

#[path = "common/pixels.rs"]
mod pixels;

/// The scenes of the renderer's own tests.
#[path = "../../umbrage-render/tests/common/scenes.rs"]
#[allow(dead_code, reason = "its other scenes are for goldens")]
mod scenes;

use common::{builtin, gpu, settings};
use glam::{Mat4, Vec3};
use pixels::{Found, Subject, Truth};
use scenes::{over_floor, sheet, with_light};
use std::path::Path;
use umbrage_render::umbrage::core::technique::Settings;
use umbrage_render::umbrage::core::{Camera, Light, LightKind, Projection};
use umbrage_scene::{AlphaMode, Instance, Material, Mesh, Scene, SceneCamera};
use umbrage_truth::{Emitter, Ray, Rays, Stack};

/// A spot light, and the other kinds from the same side.
fn kinds(spot: Light) -> [Light; 3] {
    let planes = Light { near_m: None, far_m: None, range_m: None, ..spot };
    [
        spot,
        Light { kind: LightKind::Point, ..spot },
        Light { kind: LightKind::Directional, intensity: 3.0, ..planes },
    ]
}

#[test]
fn built_in_scenes_are_right_to_the_pixel() {
    let Some(gpu) = gpu() else { return };
    let mut failures = Vec::new();
    for name in ["torus", "columns", "contact", "tilt", "knots"] {
        let scene = builtin(name);
        let subject = Subject::new(&gpu, &scene);
        for light in kinds(scene.lights[0].light) {
            let found = subject.one(&scene.cameras[0].camera, light);
            let what = format!("{name} {}", light.kind.id());
            println!("{what}: {found:?}");
            assert!(found.judged > 3000 && (name == "tilt" || found.dark > 1000), "{what}: {found:?}");
            failures.extend(found.broken(&what));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

fn scaled(mut scene: Scene, scale: f32) -> Scene {
    for instance in &mut scene.instances {
        instance.world_from_object = Mat4::from_scale(Vec3::splat(scale)) * instance.world_from_object;
    }
    let light = &mut scene.lights[0].light;
    let planes = |m: Option<f32>| m.map(|m| m * scale);
    (light.position_world, light.range_m) = (light.position_world * scale, planes(light.range_m));
    (light.near_m, light.far_m) = (planes(light.near_m), planes(light.far_m));
    let camera = &mut scene.cameras[0].camera;
    camera.position_world *= scale;
    (camera.near_m, camera.far_m) = (camera.near_m * scale, camera.far_m * scale);
    scene
}

/// The same scene from a thousandth to ten thousand times its size.
#[test]
fn any_scale_is_right_to_the_pixel() {
    let Some(gpu) = gpu() else { return };
    let mut failures = Vec::new();
    for scale in [1e-3, 1e4] {
        let scene = scaled(builtin("contact"), scale);
        let subject = Subject::new(&gpu, &scene);
        for light in kinds(scene.lights[0].light) {
            let found = subject.one(&scene.cameras[0].camera, light);
            println!("x{scale} {}: {found:?}", light.kind.id());
            assert!(found.dark > 1000, "x{scale}: {found:?}");
            failures.extend(found.broken(&format!("x{scale} {}", light.kind.id())));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// A model on a ground of its own, with an eye and a light that see all of it.
fn on_ground(mut scene: Scene) -> Scene {
    for material in scene.materials.iter_mut().filter(|m| m.alpha == AlphaMode::Opaque) {
        // They cost time and change no V.
        *material = Material { double_sided: material.double_sided, ..Material::default() };
    }
    let bounds = scene.bounds();
    let (middle, size) = (bounds.center(), bounds.size().max_element());
    let ground = Vec3::new(middle.x, bounds.min.y - 0.002 * size, middle.z);
    let material = scene.materials.len();
    scene.materials.push(Material::default());
    scene.meshes.push(sheet(ground, Vec3::X * 3.0 * size, Vec3::NEG_Z * 3.0 * size, material));
    let (mesh, world_from_object) = (scene.meshes.len() - 1, Mat4::IDENTITY);
    scene.instances.push(Instance { name: "ground".into(), mesh, world_from_object, ..Instance::default() });
    let eye = middle + size * Vec3::new(0.9, 0.8, 1.2);
    let camera = Camera::look_at(eye, middle - 0.15 * size * Vec3::Y, 0.8, 0.02 * size, 30.0 * size);
    scene.cameras = vec![SceneCamera { name: String::new(), camera }];
    // In the plane of no side: there a triangle faces the light or not by rounding, of truth and of volumes alike.
    let place = middle + size * Vec3::new(-0.83, 1.6, 0.57);
    with_light(scene, Light::spot(place, ground, 0.7, 0.8))
}

/// Below `shared/scenes`: closed and open, mirrored, skinned, in centimetres and in hundreds of metres.
const MODELS: &[&str] = &[
    "classic-obj/cornell_box.obj",
    "classic-obj/spot/spot_triangulated.obj",
    "classic-obj/teapot.obj",
    "fox/Fox.glb",
    "kaykit-medieval-hexagon/buildings/blue/building_castle_blue.gltf",
    "kaykit-medieval-hexagon/decoration/nature/trees_A_large.gltf",
    "kenney-city-builder/building-small-c.glb",
    "kenney-city-builder/grass-trees-tall.glb",
    "kenney-city-builder/pavement-fountain.glb",
    "kenney-city-builder/road-straight-lightposts.glb",
    "loader-features/BoxAnimated/BoxAnimated.glb",
    "loader-features/OrientationTest/OrientationTest.glb",
    "loader-features/RiggedFigure/RiggedFigure.glb",
    "loader-features/SimpleInstancing/SimpleInstancing.glb",
    "loader-features/SimpleSkin/SimpleSkin.gltf",
    "mannequiny/mannequiny.glb",
    "metal-rough-spheres-no-textures/MetalRoughSpheresNoTextures.glb",
    "morph-stress-test/MorphStressTest.glb",
    "negative-scale-test/NegativeScaleTest.glb",
    "recursive-skeletons/RecursiveSkeletons.glb",
    "required-extensions/truck-town-webp/town_model.gltf",
    "scopia-trees/hedge/hedge.obj",
    "scopia-trees/japaneseMaple/japaneseMaple.obj",
    "scopia-trees/palm/palm.obj",
    "scopia-trees/pine/pine.obj",
    "suzanne/Suzanne.gltf",
    "thin-casters/fence/fence.obj",
    "thin-casters/pedestrianRailing1/pedestrianRailing1.obj",
    "thin-casters/radiator3/radiator3.obj",
    "thin-casters/spiralStaircase/spiralStaircase.obj",
    "thin-casters/tableFan/tableFan.obj",
    "thin-casters/tennisRacket/tennisRacket.obj",
    "thin-casters/umbrella/umbrella.obj",
    "toy-car/ToyCar.gltf",
    "zdm2/zdm2.glb",
];

#[test]
fn models_are_right_to_the_pixel() {
    let Some(gpu) = gpu() else { return };
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/scenes");
    if !folder.is_dir() {
        eprintln!("SKIPPED: {} is not there, so no model was judged", folder.display());
        return;
    }
    let mut failures = Vec::new();
    for name in MODELS {
        let file = folder.join(name);
        let scene = on_ground(umbrage_scene::load(&file.to_string_lossy()).expect(name));
        assert!(
            scene.materials.iter().all(|m| m.alpha == AlphaMode::Opaque),
            "{name}: maps draw parts of it"
        );
        let subject = Subject::new(&gpu, &scene);
        for light in kinds(scene.lights[0].light) {
            let found = subject.one(&scene.cameras[0].camera, light);
            println!("{name} {}: {found:?}", light.kind.id());
            assert!(found.judged > 10_000 && found.dark > 40, "{name}: {found:?}");
            failures.extend(found.broken(&format!("{name} {}", light.kind.id())));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// Places on a grid in the scene's box from which something is between them and the light.
fn dark_places(rays: &Rays<'_>, scene: &Scene, light: &Light) -> Vec<Vec3> {
    const SIDE: i32 = 12;
    let bounds = scene.bounds();
    let emitter = Emitter::new(light);
    let mut stack = Stack::default();
    let grid = (0..SIDE.pow(3)).map(|i| Vec3::new(i as f32, (i / SIDE) as f32, (i / SIDE / SIDE) as f32));
    let places =
        grid.map(|i| bounds.min + bounds.size() * (i % SIDE as f32 + 0.41) / SIDE as f32).filter(|p| {
            let p_world = p.as_dvec3();
            let to = emitter.center(p_world);
            let ray = Ray { origin_world: p_world, way: to.way, from_m: 0.0, to_m: to.distance_m };
            emitter.shines_on(p_world) && rays.blocker(&ray, &mut stack).is_some()
        });
    places.collect()
}

/// Counts that must be right wherever the eye is, and one that is not.
fn counting(ids: &[&'static str]) -> Vec<Settings> {
    ids.iter().map(|id| settings("volume", &[("counting", id)])).collect()
}

/// Eyes in shadows. There is a control: counts before the surface begin in the dark and are wrong.
#[test]
fn eyes_in_shadows_see_the_same() {
    let Some(gpu) = gpu() else { return };
    let (mut failures, mut pictures, mut fooled) = (Vec::new(), 0, 0);
    for name in ["columns", "contact"] {
        let scene = builtin(name);
        let subject = Subject::new(&gpu, &scene);
        let middle = scene.bounds().center();
        for light in kinds(scene.lights[0].light) {
            let dark = dark_places(&subject.rays, &scene, &light);
            let mut ways: Vec<_> = counting(&["auto", "depth-fail", "depth-pass"])
                .into_iter()
                .map(|with| subject.renderer(&scene.cameras[0].camera, light, with))
                .collect();
            for (i, eye) in dark.iter().step_by(dark.len() / 4).enumerate() {
                let aims = [middle, *eye + Vec3::new(1.0, -0.6, 0.3), *eye + Vec3::new(-0.4, -0.5, -1.0)];
                let camera = Camera::look_at(*eye, aims[i % 3], 1.2, 0.03, 80.0);
                let truth = Truth::new(&subject.rays, &camera, &light);
                let found: Vec<Found> =
                    ways.iter_mut().map(|way| subject.judge(way, &truth, &light)).collect();
                for (found, id) in found.iter().zip(["auto", "depth-fail"]) {
                    failures.extend(found.broken(&format!("{name} {} {id} from {eye}", light.kind.id())));
                }
                pictures += usize::from(found[0].judged > 1000);
                fooled += usize::from(found[2].acne > 500);
            }
        }
    }
    println!("{pictures} pictures from the dark, of which depth-pass spoils {fooled}");
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    assert!(pictures > 20 && 2 * fooled > pictures, "{pictures} {fooled}");
}

/// Boxes over a floor, of which the top is y = 0: middle and full size of each.
fn boxes(places: &[(Vec3, Vec3)]) -> Scene {
    let unit = builtin("contact").meshes.into_iter().find(|m| m.name == "low box").expect("a box");
    let unit = Mesh { material: 0, ..unit };
    let (center, size) = (unit.bounds.center(), unit.bounds.size());
    let placed: Vec<_> = places
        .iter()
        .map(|(middle, full)| {
            let scaled = Mat4::from_scale(*full / size) * Mat4::from_translation(-center);
            (0, Mat4::from_translation(*middle) * scaled)
        })
        .collect();
    over_floor(vec![Material::default()], vec![], vec![unit], &placed)
}

/// The middle of a thin pole that hangs over the floor.
const POLE: Vec3 = Vec3::new(1.5, 1.6, 0.5);

fn box_and_poles() -> Scene {
    boxes(&[
        (Vec3::new(0.0, 0.6, 0.0), Vec3::ONE),
        (POLE, Vec3::new(0.1, 0.1, 2.0)),
        (Vec3::new(-1.5, 0.75, -1.0), Vec3::new(0.1, 1.5, 0.1)),
    ])
}

/// Eyes inside of solids, at and around the light, in the plane of a volume's side; near planes in everything; parallel eyes.
fn hard_eyes(light: &Light) -> Vec<(String, Camera)> {
    let at = |eye: Vec3, target: Vec3, near_m: f32| Camera::look_at(eye, target, 1.0, near_m, 40.0);
    let (place, aim) = (light.position_world, Vec3::new(0.3, 0.0, -0.2));
    let inside = Vec3::new(0.1, 0.5, 0.1);
    let above = place + Vec3::new(0.0, 0.3, 0.0);
    let named = [
        ("in a box", at(inside, Vec3::new(2.0, 0.2, -1.0), 0.02)),
        ("in a box, towards the light", at(inside, Vec3::new(-2.0, 0.0, 1.2), 0.02)),
        ("on a box", at(Vec3::new(0.1, 1.1, 0.1), Vec3::new(2.0, 0.2, -1.0), 0.02)),
        ("light above", at(place - Vec3::Y * 0.5, Vec3::ZERO, 0.1)),
        ("light behind", at(place - 0.4 * place.normalize(), Vec3::ZERO, 0.1)),
        ("light before", at(Vec3::new(2.5, 0.6, -1.5), place, 0.05)),
        ("at the light", at(place, aim, 0.05)),
        ("near the light", at(place + Vec3::splat(1e-3), aim, 0.05)),
        (
            "light on the near plane",
            at(place + Vec3::X * 0.3, place + Vec3::X * 0.3 + Vec3::new(-1.0, -0.6, 0.0), 0.3),
        ),
        ("light just before the near plane", at(above, above - Vec3::new(0.1, 1.0, 0.1), 0.3)),
        ("light just behind the near plane", at(above, above - Vec3::new(0.1, 1.0, 0.1), 0.29)),
        ("in the plane of a side", at(Vec3::new(0.5, 1.5, 3.0), Vec3::new(0.5, 0.0, -0.5), 0.1)),
    ];
    let mut eyes: Vec<_> = named.map(|(name, camera)| (name.to_owned(), camera)).to_vec();
    // Near planes go through boxes and through shadows.
    for near_m in [1.0, 2.0, 3.0, 3.5] {
        eyes.push((
            format!("near plane at {near_m} m"),
            at(Vec3::new(0.3, 2.4, -2.0), Vec3::new(0.0, 0.0, 0.4), near_m),
        ));
    }
    // The eye in a pole's thin shadow, the near plane in it or beyond it.
    let away = match light.kind {
        LightKind::Directional => light.direction_world,
        _ => (POLE - place).normalize(),
    };
    for (far_m, aim, near_m) in
        [(0.3, Vec3::NEG_X, 0.3), (0.5, Vec3::new(0.0, 0.0, -0.5), 0.6), (0.8, Vec3::NEG_X, 0.05)]
    {
        let name = format!("{far_m} m below a pole, near plane at {near_m} m");
        eyes.push((name, at(POLE + away * far_m, aim, near_m)));
    }
    for (name, direction, back_m) in [
        ("slanted", Vec3::new(-1.0, -1.0, -1.0), 6.0),
        ("slanted, from the box", Vec3::new(-1.0, -1.0, -1.0), 0.3),
        ("down", Vec3::NEG_Y, 6.0),
        ("level", Vec3::new(0.3, -0.05, -1.0), 6.0),
        ("as the light shines", light.direction_world, 6.0),
        ("towards the light", Vec3::new(-1.0, -0.8, 0.6), 1.0),
    ] {
        let (middle, direction) = (Vec3::new(0.1, 0.7, 0.1), direction.normalize());
        let projection = Projection::Orthographic { half_height_m: 2.0 };
        let camera = at(middle - direction * back_m, middle, 0.1);
        eyes.push((format!("parallel {name}"), Camera { projection, direction_world: direction, ..camera }));
    }
    eyes
}

#[test]
fn eyes_that_are_hard_see_the_same() {
    let Some(gpu) = gpu() else { return };
    let scene = box_and_poles();
    let subject = Subject::new(&gpu, &scene);
    let spot = Light::spot(Vec3::new(-2.0, 4.0, 1.2), Vec3::new(0.3, 0.0, -0.2), 0.9, 1.0);
    // Two more, of which a parallel eye sees the infinite end at one place, and sides in one plane with the eye.
    let noon = Light { direction_world: Vec3::NEG_Y, ..kinds(spot)[2] };
    let in_plane = Light { position_world: Vec3::new(0.5, 4.0, 1.2), ..kinds(spot)[1] };
    let mut failures = Vec::new();
    for light in [spot, kinds(spot)[2], noon, in_plane] {
        let ids = if light == in_plane { &["auto"][..] } else { &["auto", "depth-fail"] };
        let mut ways: Vec<_> = counting(ids)
            .into_iter()
            .map(|with| subject.renderer(&scene.cameras[0].camera, light, with))
            .collect();
        let (mut judged, mut dark, mut differ) = (0, 0, 0);
        for (name, camera) in hard_eyes(&light) {
            let truth = Truth::new(&subject.rays, &camera, &light);
            for (way, id) in ways.iter_mut().zip(ids) {
                let found = subject.judge(way, &truth, &light);
                failures.extend(found.broken(&format!("{} {id}, {name}", light.kind.id())));
                (judged, dark, differ) = (judged + found.judged, dark + found.dark, differ + found.differ);
            }
        }
        println!(
            "{} from {}: {differ} of {judged} differ, {dark} dark",
            light.kind.id(),
            light.position_world
        );
        assert!(judged > 400_000 && dark > 10_000, "{judged} {dark}");
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}
