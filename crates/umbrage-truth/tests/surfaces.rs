//! What surfaces do to light: holes, colours, sides.

mod common;

use common::{looking_down, scene, sheet, truth};
use glam::{Affine2, Mat4, UVec2, Vec3, Vec4};
use umbrage_core::{Camera, Light, LightKind, LightShape};
use umbrage_scene::{AlphaMode, Image, Instance, Material, Mesh, Roles, Scene, TextureRef, Wrap};
use umbrage_truth::{Place, Rays, Surfaces, silent};

fn lamp() -> Light {
    Light { kind: LightKind::Point, ..Light::default() }.aimed(Vec3::Y * 4.0, Vec3::ZERO)
}

/// A sheet of 2 x 2 m, 1 m over a ground, the camera between them.
fn over_ground(material: Material, images: Vec<Image>) -> Scene {
    let ground = sheet(Vec3::ZERO, Vec3::X * 8.0, Vec3::NEG_Z * 8.0, 1);
    let above = sheet(Vec3::Y, Vec3::X, Vec3::NEG_Z, 0);
    Scene { images, ..scene(vec![material, Material::default()], vec![above, ground]) }
}

/// V on the ground, at a place.
fn v_at(scene: &Scene, x: f32, z: f32) -> Vec3 {
    let camera = looking_down(Vec3::new(x, 0.0, z), 0.5, 0.001);
    truth(scene, &camera, &lamp(), UVec2::ONE, 1).1.v[0]
}

fn texture() -> TextureRef {
    TextureRef {
        image: 0,
        wrap: [Wrap::Clamp; 2],
        linear: false,
        uv_set: 0,
        uv_from_texcoord: Affine2::IDENTITY,
    }
}

#[test]
fn a_cut_out_lets_light_through_its_holes_only() {
    // Left half there, right half missing; alpha of the left just above the cutoff.
    let rgba = vec![255, 255, 255, 130, 255, 255, 255, 120];
    let images = vec![Image { name: "halves".into(), width: 2, height: 1, rgba }];
    let material = |alpha, opacity| Material {
        alpha,
        base_color: Vec4::new(1.0, 1.0, 1.0, opacity),
        base_color_texture: Some(texture()),
        ..Material::default()
    };
    let mask = AlphaMode::Mask { cutoff: 0.5 };
    let cut = over_ground(material(mask, 1.0), images.clone());
    assert_eq!([v_at(&cut, -0.5, 0.1), v_at(&cut, 0.5, 0.1)], [Vec3::ZERO, Vec3::ONE]);
    // The factor counts too.
    let faint = over_ground(material(mask, 0.9), images.clone());
    assert_eq!([v_at(&faint, -0.5, 0.1), v_at(&faint, 0.5, 0.1)], [Vec3::ONE, Vec3::ONE]);
    // An opaque surface does not ask its texture.
    let solid = over_ground(material(AlphaMode::Opaque, 0.1), images);
    assert_eq!([v_at(&solid, -0.5, 0.1), v_at(&solid, 0.5, 0.1)], [Vec3::ZERO, Vec3::ZERO]);
}

#[test]
fn a_translucent_sheet_colours_the_light_and_two_do_it_twice() {
    let glass = Material {
        alpha: AlphaMode::Blend,
        base_color: Vec4::new(1.0, 0.2, 0.0, 0.5),
        double_sided: true,
        ..Material::default()
    };
    let mut one = over_ground(glass, Vec::new());
    let once = Vec3::new(1.0, 0.6, 0.5) * 0.5;
    assert!((v_at(&one, 0.3, 0.2) - once).abs().max_element() < 1e-6);
    assert_eq!(v_at(&one, 3.0, 0.2), Vec3::ONE);
    let mut second = one.instances[0].clone();
    second.world_from_object = Mat4::from_translation(Vec3::Y * 0.5);
    one.instances.push(second);
    assert!((v_at(&one, 0.3, 0.2) - once * once).abs().max_element() < 1e-6);
}

#[test]
fn the_eye_looks_through_glass_holes_and_backs_and_light_does_not_pass_backs() {
    let seen_from = |scene: &Scene, eye: Vec3| {
        let rays = Rays::new(scene).expect("rays");
        let camera = Camera::look_at(eye, Vec3::new(0.1, 0.0, 0.1), 0.1, 0.1, 50.0);
        let surfaces = Surfaces::new(&rays, &camera, UVec2::ONE, &silent).expect("surfaces");
        surfaces.seen[0].map(|seen| rays.instance(seen.slot))
    };
    let above = Vec3::new(0.1, 3.0, 0.1);
    let front = over_ground(Material::default(), Vec::new());
    assert_eq!(seen_from(&front, above), Some(0));
    // Turned over, it is single-sided and seen through, but it still takes the light.
    let mut back = front.clone();
    back.instances[0].world_from_object =
        Mat4::from_translation(Vec3::Y * 2.0) * Mat4::from_rotation_x(std::f32::consts::PI);
    assert_eq!(seen_from(&back, above), Some(1));
    assert_eq!(v_at(&back, 0.1, 0.1), Vec3::ZERO);
    back.materials[0].double_sided = true;
    assert_eq!(seen_from(&back, above), Some(0));
    // A mirror turns the winding, not the side that is shown.
    let mut mirrored = front.clone();
    mirrored.instances[0].world_from_object = Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0));
    assert_eq!(seen_from(&mirrored, above), Some(0));
    let mut glass = front;
    glass.materials[0].alpha = AlphaMode::Blend;
    assert_eq!(seen_from(&glass, above), Some(1));
}

#[test]
fn cones_ranges_and_backs_are_no_receivers() {
    let built = over_ground(Material::default(), Vec::new());
    let camera = looking_down(Vec3::new(3.0, 0.0, 0.0), 0.5, 0.001);
    let place = |light: &Light| truth(&built, &camera, light, UVec2::ONE, 1).1.place[0];
    assert_eq!(place(&lamp()), Place::Receiver);
    assert_eq!(place(&Light { range_m: Some(4.9), ..lamp() }), Place::Unreached);
    assert_eq!(place(&Light { range_m: Some(5.1), ..lamp() }), Place::Receiver);
    let spot = |outer_rad| Light { kind: LightKind::Spot { inner_rad: 0.0, outer_rad }, ..lamp() };
    // Three metres beside a foot that is four below: 36.87 degrees.
    assert_eq!([place(&spot(0.64)), place(&spot(0.65))], [Place::Unreached, Place::Receiver]);
    let below = Light { kind: LightKind::Directional, direction_world: Vec3::Y, ..Light::default() };
    assert_eq!(place(&below), Place::Away);
}

#[test]
fn a_scene_without_triangles_is_empty_and_not_a_failure() {
    let nothing = Scene::default();
    let (surfaces, found) =
        truth(&nothing, &looking_down(Vec3::ZERO, 1.0, 1.0), &lamp(), UVec2::new(5, 3), 4);
    assert!(surfaces.seen.iter().all(Option::is_none));
    assert!(found.v.iter().all(|v| *v == Vec3::ONE) && found.rays == 0);
}

#[test]
fn light_passes_what_is_no_blocker_and_sight_does_not() {
    let mut scene = over_ground(Material::default(), Vec::new());
    assert_eq!(v_at(&scene, 0.1, 0.1), Vec3::ZERO);
    scene.instances[0].roles = Roles { blocker: false, receiver: true };
    assert_eq!(v_at(&scene, 0.1, 0.1), Vec3::ONE);
    let above = looking_down(Vec3::new(0.1, 0.0, 0.1), 2.0, 0.001);
    let seen = |scene: &Scene| {
        let rays = Rays::new(scene).expect("rays");
        let seen =
            Surfaces::new(&rays, &above, UVec2::ONE, &silent).expect("a picture").seen[0].expect("a surface");
        (rays.instance(seen.slot), seen.p_world.y)
    };
    assert_eq!(seen(&scene).0, 0, "the sheet is seen all the same");
    // A blocker behind it blocks, whichever is met first.
    let higher = Mesh {
        positions: scene.meshes[0].positions.iter().map(|p| *p + Vec3::Y).collect(),
        ..scene.meshes[0].clone()
    };
    let lower = Mesh {
        positions: scene.meshes[0].positions.iter().map(|p| *p - Vec3::Y * 0.4).collect(),
        ..scene.meshes[0].clone()
    };
    for other in [higher, lower] {
        let mut both = scene.clone();
        both.meshes.push(other);
        both.instances.push(Instance { mesh: 2, object: 2, ..Instance::default() });
        assert_eq!(v_at(&both, 0.1, 0.1), Vec3::ZERO);
    }
}

#[test]
fn what_is_no_receiver_is_lit_wherever_light_would_shine() {
    let mut scene = over_ground(Material::default(), Vec::new());
    scene.instances[1].roles = Roles { blocker: true, receiver: false };
    let at = |light: &Light| {
        let camera = looking_down(Vec3::new(0.1, 0.0, 0.1), 0.5, 0.001);
        let found = truth(&scene, &camera, light, UVec2::ONE, 4).1;
        (found.place[0], found.v[0], found.rays)
    };
    let ball = Light { shape: LightShape::Sphere { radius_m: 0.1 }, ..lamp() };
    assert_eq!(at(&lamp()), (Place::Exempt, Vec3::ONE, 0));
    assert_eq!(at(&ball), (Place::Exempt, Vec3::ONE, 0));
    assert_eq!(at(&Light { range_m: Some(2.0), ..lamp() }), (Place::Unreached, Vec3::ZERO, 0));
    assert_eq!(at(&lamp().aimed(Vec3::NEG_Y, Vec3::ZERO)), (Place::Away, Vec3::ZERO, 0));
}
