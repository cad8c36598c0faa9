//! The scene by which engines are compared: a ground of 40 x 40 quads, 100 torus knots, one ball; 519,168 triangles.
//!
//! Numbers are those of `shared/scenes/knots` (case A), so that figures from here stand beside those of other engines.

use super::{Random, Stage, paint, shapes};
use crate::Scene;
use glam::{Mat4, Vec3};
use umbrage_core::{Camera, Light};

pub(super) fn make(random: &mut Random) -> Scene {
    let mut stage = Stage::default();
    let ground = stage.material(paint("ground", [0.75, 0.75, 0.75], 1.0));
    let copper = stage.material(paint("knot", [0.8, 0.45, 0.25], 1.0));
    let blue = stage.material(paint("sphere", [0.35, 0.5, 0.8], 1.0));
    stage.add("ground", shapes::plane(Vec3::ZERO, Vec3::X * 10.0, Vec3::NEG_Z * 10.0, 40), ground);
    let ball = shapes::sphere(1.6, 64, 32).into_mesh("sphere", blue);
    let ball = stage.mesh(ball);
    stage.instance("sphere", ball, Mat4::from_translation(Vec3::Y * 3.2));
    let knot = stage.mesh(shapes::torus_knot(0.42, 0.13, 128, 20).into_mesh("knot", copper));
    for i in 0..100u8 {
        let place = Vec3::new(1.8 * f32::from(i % 10) - 8.1, 0.9, 1.8 * f32::from(i / 10) - 8.1);
        let turn = 0.37 * f32::from(i) + random.around_zero();
        let world_from_object =
            Mat4::from_translation(place) * Mat4::from_rotation_y(turn) * Mat4::from_rotation_x(1.1);
        stage.instance(&format!("knot{i:02}"), knot, world_from_object);
    }
    let camera = Camera::look_at(Vec3::new(0.0, 7.0, 10.0), Vec3::ZERO, 60f32.to_radians(), 0.1, 100.0);
    let light = Light {
        near_m: Some(1.0),
        far_m: Some(30.0),
        ..Light::spot(Vec3::new(4.0, 12.0, 4.0), Vec3::ZERO, 30f32.to_radians(), 40f32.to_radians())
    };
    stage.finish(camera, light, Vec3::ZERO, 3.0)
}
