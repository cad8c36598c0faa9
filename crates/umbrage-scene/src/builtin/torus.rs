//! The default scene, after the document that Umbrage starts from: a torus that floats before planes.

use super::{Random, Stage, paint, shapes};
use crate::Scene;
use glam::{Mat4, Vec3};
use umbrage_core::{Camera, Light};

pub(super) fn make(random: &mut Random) -> Scene {
    let mut stage = Stage::default();
    let floor = stage.material(paint("floor", [0.60, 0.57, 0.53], 0.9));
    let wall = stage.material(paint("wall", [0.36, 0.45, 0.53], 0.95));
    let coral = stage.material(paint("coral", [0.80, 0.20, 0.11], 0.45));
    let plaster = stage.material(paint("plaster", [0.72, 0.70, 0.66], 0.8));
    let amber = stage.material(paint("amber", [0.87, 0.50, 0.10], 0.35));

    // Wide enough that the picture has no rim on either side.
    stage.add("floor", shapes::plane(Vec3::new(0.0, 0.0, 1.0), Vec3::X * 9.0, Vec3::NEG_Z * 3.6, 1), floor);
    stage.add("wall", shapes::plane(Vec3::new(0.0, 3.5, -2.6), Vec3::X * 9.0, Vec3::Y * 3.5, 1), wall);

    let tilt = Mat4::from_translation(Vec3::new(-0.55, 1.5, 0.0))
        * Mat4::from_rotation_y(-0.35 + 0.6 * random.around_zero())
        * Mat4::from_rotation_z(0.32 + 0.3 * random.around_zero())
        * Mat4::from_rotation_x(1.0 + 0.4 * random.around_zero());
    stage.add("torus", shapes::torus(0.8, 0.29, 128, 64).moved(tilt), coral);

    let profile = [
        (0.0, 0.0),
        (0.42, 0.0),
        (0.42, 0.1),
        (0.3, 0.16),
        (0.27, 0.66),
        (0.36, 0.72),
        (0.36, 0.8),
        (0.0, 0.8),
    ];
    let place = Vec3::new(1.5, 0.0, 0.7);
    stage.add("pedestal", shapes::lathe(&profile, 96).moved(Mat4::from_translation(place)), plaster);
    let ball = place + Vec3::Y * (0.8 + 0.34);
    stage.add("ball", shapes::sphere(0.34, 96, 48).moved(Mat4::from_translation(ball)), amber);

    let camera = Camera::look_at(Vec3::new(2.2, 2.35, 6.2), Vec3::new(0.3, 1.08, -0.2), 0.6, 0.1, 40.0);
    let target = Vec3::new(0.2, 0.9, -0.4);
    let light = Light::spot(Vec3::new(-3.4, 5.2, 4.4), target, 0.34, 0.6);
    stage.finish(camera, light, target, 3.1)
}
