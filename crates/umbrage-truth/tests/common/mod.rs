//! What the tests of the truth share.

#![allow(dead_code, reason = "each test file uses its part")]

pub mod brute;

use glam::{UVec2, Vec2, Vec3};
use umbrage_core::{Aabb, Camera, Light, Projection};
use umbrage_scene::{Instance, Material, Mesh, Scene};
use umbrage_truth::{Quality, Rays, Surfaces, Visibility, silent};

/// A built-in scene.
pub fn builtin(spec: &str) -> Scene {
    umbrage_scene::load(&format!("builtin:{spec}")).expect("a built-in scene")
}

/// A rectangle: middle, half of its width, half of its height; its front is where `right x up` points.
pub fn sheet(center: Vec3, right: Vec3, up: Vec3, material: usize) -> Mesh {
    let positions = vec![center - right - up, center + right - up, center + right + up, center - right + up];
    Mesh {
        normals: vec![right.cross(up).normalize(); 4],
        uvs: vec![Vec2::new(0.0, 1.0), Vec2::ONE, Vec2::new(1.0, 0.0), Vec2::ZERO],
        indices: vec![0, 1, 2, 0, 2, 3],
        material,
        bounds: Aabb::from_points(positions.iter().copied()),
        positions,
        ..Mesh::default()
    }
}

/// A scene of meshes where they are, each once.
pub fn scene(materials: Vec<Material>, meshes: Vec<Mesh>) -> Scene {
    let instances =
        (0..meshes.len()).map(|mesh| Instance { mesh, object: mesh as u32, ..Instance::default() }).collect();
    Scene { materials, meshes, instances, ..Scene::default() }
}

/// A parallel camera at `height_m` over the ground, looking straight down on a rectangle around `center` that is
/// `half_height_m` high on each side of it. What is above it is not seen.
pub fn looking_down(center: Vec3, height_m: f32, half_height_m: f32) -> Camera {
    Camera {
        position_world: center + Vec3::Y * height_m,
        direction_world: Vec3::NEG_Y,
        up_world: Vec3::NEG_Z,
        projection: Projection::Orthographic { half_height_m },
        near_m: 1e-4 * height_m,
        far_m: 2.0 * height_m,
    }
}

/// The truth of a light, and what was seen.
pub fn truth(
    scene: &Scene,
    camera: &Camera,
    light: &Light,
    size: UVec2,
    samples: u32,
) -> (Surfaces, Visibility) {
    let rays = Rays::new(scene).expect("rays");
    let surfaces = Surfaces::new(&rays, camera, size, &silent).expect("surfaces");
    let quality = Quality { samples, seed: 1 };
    let visibility = Visibility::new(&rays, &surfaces, light, &quality, &silent).expect("truth");
    (surfaces, visibility)
}
