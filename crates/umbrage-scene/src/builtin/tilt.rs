//! Planes turned away from the light by known angles: where a depth map's bias is too small, these show it first.

use super::{Random, Stage, paint, shapes};
use crate::Scene;
use glam::Vec3;
use umbrage_core::{Camera, Light};

/// Between each plane's normal and the direction to the light, degrees.
const ANGLES_DEG: [u16; 13] = [0, 15, 30, 45, 60, 70, 75, 80, 83, 85, 87, 88, 89];

/// Half the edge of a plane, metres.
const HALF_M: f32 = 0.4;

pub(super) fn make(_: &mut Random) -> Scene {
    let mut stage = Stage::default();
    let eye = Vec3::new(0.0, 0.3, 8.3);
    // Light and eye stand 45 degrees apart, so that planes turned by 0 and by 89 degrees are both seen well.
    let lamp = Vec3::new(-7.6, 1.2, 8.0);
    for (i, degrees) in ANGLES_DEG.into_iter().enumerate() {
        // Five, four and four, so far apart that neither light nor eye sees one behind another.
        let (column, row) = if i < 5 { (i, 0) } else { ((i - 5) % 4, 1 + (i - 5) / 4) };
        let columns = if row == 0 { 5.0 } else { 4.0 };
        let center = Vec3::new(2.0 * (column as f32 - 0.5 * (columns - 1.0)), 1.35 * (1.0 - row as f32), 0.0);
        let to_light = (lamp - center).normalize();
        let to_eye = (eye - center).normalize();
        // From the light's direction towards the eye's.
        let across = to_eye.reject_from_normalized(to_light).normalize();
        let (sin, cos) = (f64::from(degrees)).to_radians().sin_cos();
        let normal = to_light * cos as f32 + across * sin as f32;
        let right = normal.cross(to_light.cross(across)).normalize();
        let shape = shapes::plane(center, right * HALF_M, normal.cross(right) * HALF_M, 1);
        let mut material = paint(&format!("tilt {degrees:02}"), [0.7, 0.7, 0.7], 1.0);
        // A sheet has no inside; behind it, its other side is seen.
        material.double_sided = true;
        let material = stage.material(material);
        stage.add(&format!("tilt {degrees:02}"), shape, material);
    }
    let camera = Camera::look_at(eye, Vec3::ZERO, 0.66, 0.1, 40.0);
    let light = Light::spot(lamp, Vec3::ZERO, 0.48, 0.58);
    stage.finish(camera, light, Vec3::ZERO, 3.0)
}
