//! Things that touch: between caster and shadow there must be no gap, and no light under a wall however thin.

use super::{Random, Stage, paint, shapes};
use crate::Scene;
use glam::{Mat4, Vec3};
use umbrage_core::{Camera, Light};

/// Edge of the ground, metres; the walls' thickness counts in parts of it.
const SIZE_M: f32 = 4.0;

/// Wall thickness as parts of [`SIZE_M`].
const WALLS: [f32; 4] = [0.002, 0.005, 0.01, 0.02];

pub(super) fn make(random: &mut Random) -> Scene {
    let mut stage = Stage::default();
    let ground = stage.material(paint("ground", [0.62, 0.60, 0.56], 0.95));
    let blue = stage.material(paint("blue", [0.16, 0.32, 0.55], 0.6));
    let red = stage.material(paint("red", [0.62, 0.16, 0.12], 0.6));
    let chalk = stage.material(paint("chalk", [0.78, 0.77, 0.74], 0.8));
    let wood = stage.material(paint("wood", [0.45, 0.27, 0.13], 0.7));

    let half = 0.5 * SIZE_M;
    stage.add("ground", shapes::plane(Vec3::ZERO, Vec3::X * half, Vec3::NEG_Z * half, 1), ground);

    // Two boxes side by side that share a plane, and one on top of the first.
    let edge = -0.55;
    stage.add("low box", shapes::cuboid(Vec3::new(-1.2, 0.0, -0.1), Vec3::new(edge, 0.55, 0.5)), blue);
    stage.add("high box", shapes::cuboid(Vec3::new(edge, 0.0, -0.1), Vec3::new(-0.15, 0.95, 0.3)), red);
    stage.add("top box", shapes::cuboid(Vec3::new(-1.05, 0.55, 0.05), Vec3::new(-0.75, 0.8, 0.35)), chalk);

    let ball = |radius: f32, x: f32, z: f32| {
        shapes::sphere(radius, 64, 32).moved(Mat4::from_translation(Vec3::new(x, radius, z)))
    };
    stage.add("ball", ball(0.35, 0.55, 0.75), chalk);
    stage.add("small ball", ball(0.12, -0.2, 0.95), red);

    for (i, part) in WALLS.into_iter().enumerate() {
        let (x, z) = (-1.2 + 0.75 * i as f32, -1.15 + 0.1 * random.around_zero());
        let thickness = part * SIZE_M;
        let wall = shapes::cuboid(Vec3::new(x, 0.0, z), Vec3::new(x + 0.55, 0.7, z + thickness));
        stage.add(&format!("wall {} permille", part * 1000.0), wall, chalk);
    }

    // A board that leans on a post: it stands on its lower edge alone.
    let post_x = 1.45;
    stage.add("post", shapes::cuboid(Vec3::new(post_x, 0.0, -0.3), Vec3::new(post_x + 0.12, 1.0, 0.3)), blue);
    let lean = 0.32f32;
    let board = shapes::cuboid(Vec3::new(-0.012, 0.0, -0.25), Vec3::new(0.012, 1.15, 0.25))
        .moved(Mat4::from_rotation_z(-lean))
        .grounded();
    // Its right side touches the post's upper edge: at height 1 it is that far from its lowest corner.
    let reach = 0.012 / lean.cos() + (1.0 - 0.012 * lean.sin()) * lean.tan();
    stage.add("board", board.moved(Mat4::from_translation(Vec3::X * (post_x - reach))), wood);

    let camera = Camera::look_at(Vec3::new(2.6, 2.7, 4.4), Vec3::new(0.08, 0.26, -0.1), 0.5, 0.05, 30.0);
    let target = Vec3::new(0.0, 0.3, 0.0);
    let light = Light::spot(Vec3::new(-3.0, 4.6, 3.2), target, 0.32, 0.42);
    stage.finish(camera, light, target, 3.0)
}
