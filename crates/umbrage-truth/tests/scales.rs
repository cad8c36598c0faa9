//! No surface shadows itself, whatever the scene's scale.

mod common;

use common::{builtin, truth};
use glam::{UVec2, Vec3};
use umbrage_core::{Light, LightKind, LightShape};
use umbrage_scene::{Scene, builtins};
use umbrage_truth::{Place, Visibility};

const SCALES: [f32; 5] = [0.01, 0.1, 1.0, 100.0, 1000.0];
const SIZE: UVec2 = UVec2::new(160, 90);

/// The light of the scene as a point, as a sun, and as a disc.
fn lights(scene: &Scene) -> [Light; 3] {
    let spot = scene.lights[0].light;
    let sun = Light { kind: LightKind::Directional, near_m: None, far_m: None, ..spot };
    let radius_m = 0.02 * scene.bounds().radius();
    [spot, sun, Light { shape: LightShape::Disc { radius_m }, ..spot }]
}

fn truths(scene: &Scene) -> Vec<Visibility> {
    let camera = &scene.cameras[0].camera;
    lights(scene).iter().map(|light| truth(scene, camera, light, SIZE, 16).1).collect()
}

#[test]
fn the_truth_is_the_same_at_every_scale() {
    for builtin in builtins() {
        let [first, others @ ..] =
            SCALES.map(|scale| truths(&common::builtin(&format!("{}?scale={scale}", builtin.name))));
        for (scale, other) in SCALES[1..].iter().zip(&others) {
            for (kind, (a, b)) in ["spot", "sun", "disc"].iter().zip(first.iter().zip(other)) {
                let differ =
                    a.v.iter().zip(&b.v).filter(|(a, b)| (*a - *b).abs().max_element() > 0.13).count();
                // A ray may pass an edge on its other side, because scaling rounds every corner anew.
                println!("{} {kind} at {scale}: {differ} of {} pixels differ", builtin.name, a.v.len());
                assert!(differ <= 4, "{} {kind} at {scale}: {differ} pixels differ", builtin.name);
            }
        }
    }
}

/// Planes of which none shadows another, and a ball alone: all that faces the light is lit, every single pixel.
#[test]
fn what_cannot_be_shadowed_is_lit_in_every_pixel() {
    for scale in SCALES {
        let tilt = builtin(&format!("tilt?scale={scale}"));
        let mut ball = builtin(&format!("torus?scale={scale}"));
        ball.instances.retain(|i| ball.meshes[i.mesh].name == "ball");
        let mut lit = 0;
        for scene in [&tilt, &ball] {
            for found in truths(scene) {
                for (place, v) in found.place.iter().zip(&found.v) {
                    // A disc's rim may lie below the plane of a surface that just faces its middle.
                    let least = if found.samples > 1 { 0.4 } else { 1.0 };
                    if *place == Place::Receiver {
                        assert!(v.min_element() >= least, "scale {scale}: {v}");
                        lit += 1;
                    }
                }
            }
        }
        assert!(lit > 3000, "the test must have something to say: {lit}");
    }
}

/// Two sheets in the same place, one turned over, as modellers make two-sided leaves, far from the origin and turned, so
/// that every corner is rounded: neither shadows the other.
#[test]
fn coincident_sheets_do_not_shadow_each_other() {
    let far = Vec3::new(1234.5, 678.9, -4321.0);
    let turn = glam::Quat::from_euler(glam::EulerRot::XYZ, 0.3, 0.7, 0.1);
    let (right, up) = (turn * Vec3::X, turn * Vec3::NEG_Z);
    let sheets = vec![common::sheet(far, right, up, 0), common::sheet(far, -right, up, 0)];
    let scene = common::scene(vec![Default::default()], sheets);
    let camera = umbrage_core::Camera::look_at(far + turn * Vec3::new(1.0, 3.0, 1.0), far, 0.9, 0.1, 20.0);
    let light = Light { kind: LightKind::Point, ..Light::default() }
        .aimed(far + turn * Vec3::new(3.0, 0.2, 0.0), far);
    let (_, found) = truth(&scene, &camera, &light, SIZE, 1);
    assert!(found.receivers() > 1000);
    assert!(found.place.iter().zip(&found.v).all(|(p, v)| *p != Place::Receiver || *v == Vec3::ONE));
}
