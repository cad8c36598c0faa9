//! A colonnade: thick columns with beams, thin ones before them, an arch behind. Long shadows in parallel.

use super::{Random, Stage, paint, shapes};
use crate::Scene;
use glam::{Mat4, Vec3};
use umbrage_core::{Camera, Light};

const THICK: usize = 7;
const THIN: usize = 9;
const SPACING_M: f32 = 1.7;
const HEIGHT_M: f32 = 3.2;

pub(super) fn make(random: &mut Random) -> Scene {
    let mut stage = Stage::default();
    let ground = stage.material(paint("ground", [0.55, 0.52, 0.47], 0.95));
    let marble = stage.material(paint("marble", [0.74, 0.71, 0.66], 0.7));
    let bronze = stage.material(paint("bronze", [0.30, 0.17, 0.08], 0.5));
    let brick = stage.material(paint("brick", [0.52, 0.22, 0.13], 0.9));

    stage.add("ground", shapes::plane(Vec3::ZERO, Vec3::X * 14.0, Vec3::NEG_Z * 10.0, 1), ground);

    let h = HEIGHT_M;
    let profile = [
        (0.0, 0.0),
        (0.38, 0.0),
        (0.38, 0.12),
        (0.29, 0.2),
        (0.24, h - 0.22),
        (0.36, h - 0.1),
        (0.36, h),
        (0.0, h),
    ];
    let column = stage.mesh(shapes::lathe(&profile, 64).into_mesh("column", marble));
    for i in 0..THICK {
        let x = SPACING_M * (i as f32 - 0.5 * (THICK - 1) as f32) + 0.12 * random.around_zero();
        // Turned only: a round column shows it by where its edges fall, never by its height under the beam.
        let turn = Mat4::from_rotation_y(random.around_zero());
        stage.instance(&format!("column {i}"), column, Mat4::from_translation(Vec3::X * x) * turn);
    }
    let half = 0.5 * SPACING_M * (THICK - 1) as f32 + 0.6;
    let beam = shapes::cuboid(Vec3::new(-half, h, -0.4), Vec3::new(half, h + 0.45, 0.4));
    stage.add("beam", beam, marble);
    let cornice =
        shapes::cuboid(Vec3::new(-half - 0.15, h + 0.45, -0.55), Vec3::new(half + 0.15, h + 0.6, 0.55));
    stage.add("cornice", cornice, marble);

    for i in 0..THIN {
        let x = 1.3 * (i as f32 - 0.5 * (THIN - 1) as f32) + 0.2 * random.around_zero();
        let z = 2.2 + 0.3 * random.around_zero();
        let radius = [0.02, 0.035, 0.06][i % 3] * (1.0 + 0.3 * random.around_zero());
        let height = 1.9 + 0.25 * (i % 4) as f32 + 0.3 * random.around_zero();
        let name = format!("pole {i}");
        let pole = shapes::cylinder(radius, 0.7 * radius, height, 32);
        stage.add(&name, pole.moved(Mat4::from_translation(Vec3::new(x, 0.0, z))), bronze);
    }

    for (name, side) in [("left pier", -1.0), ("right pier", 1.0f32)] {
        let (inner, outer) = (side * 1.1, side * 1.6);
        let pier =
            shapes::cuboid(Vec3::new(inner.min(outer), 0.0, -3.3), Vec3::new(inner.max(outer), 1.8, -2.7));
        stage.add(name, pier, brick);
    }
    let arch = shapes::arch(1.1, 1.6, 0.6, 48).moved(Mat4::from_translation(Vec3::new(0.0, 1.8, -3.0)));
    stage.add("arch", arch, brick);

    let camera = Camera::look_at(Vec3::new(6.4, 4.3, 9.6), Vec3::new(0.1, 1.35, -0.3), 0.75, 0.1, 80.0);
    let target = Vec3::new(0.0, 1.0, 0.0);
    let light = Light::spot(Vec3::new(-9.0, 10.0, 9.5), target, 0.42, 0.55);
    stage.finish(camera, light, target, 3.0)
}
