//! Small scenes for volumes, and what is asked of their pictures.

use super::scenes::{over_floor, sheet};
use super::settings;
use glam::{Mat4, Quat, UVec2, Vec3};
use umbrage_render::umbrage::core::{Aabb, Light, LightKind};
use umbrage_render::{Gpu, Measure, RenderOptions, Renderer, View};
use umbrage_scene::{Material, Mesh, Scene};

/// Pixels across and down.
pub const SIDE: u32 = 128;

pub fn options(pairs: &[(&str, &str)]) -> RenderOptions {
    let size = UVec2::splat(SIDE);
    RenderOptions { size, view: View::Visibility, ..RenderOptions::new(settings("volume", pairs)) }
}

pub fn visibility_with(gpu: &Gpu, scene: &Scene, options: RenderOptions) -> Vec<f32> {
    let mut renderer = Renderer::new(gpu, scene, &scene.cameras[0].camera, options).expect("a renderer");
    renderer.frame(Measure::Frame).expect("a frame");
    let v = renderer.visibility().expect("V");
    assert!(v.iter().all(|v| (0.0..=1.0).contains(v)), "V is no visibility");
    v
}

pub fn visibility(gpu: &Gpu, scene: &Scene, pairs: &[(&str, &str)]) -> Vec<f32> {
    visibility_with(gpu, scene, options(pairs))
}

/// The same pixels by another technique.
pub fn by(gpu: &Gpu, scene: &Scene, technique: &str, pairs: &[(&str, &str)]) -> Vec<f32> {
    let options = RenderOptions { settings: settings(technique, pairs), ..options(&[]) };
    visibility_with(gpu, scene, options)
}

/// Pixels in which two answers are not the same.
pub fn off(a: &[f32], b: &[f32]) -> usize {
    a.iter().zip(b).filter(|(a, b)| (*a - *b).abs() > 0.5).count()
}

/// Pixels that the light would reach and does not.
pub fn dark(gpu: &Gpu, scene: &Scene, v: &[f32]) -> usize {
    let plain = by(gpu, scene, "unshadowed", &[]);
    v.iter().zip(plain).filter(|(v, plain)| **v < 0.5 && *plain > 0.5).count()
}

pub fn kinds(light: Light) -> [Light; 3] {
    let parallel = LightKind::Directional;
    let sun = Light { kind: parallel, intensity: 3.0, near_m: None, far_m: None, ..light };
    [light, Light { kind: LightKind::Point, ..light }, sun]
}

/// A mesh of positions and triangles, with normals that nobody looks at.
pub fn mesh(positions: &[Vec3], indices: &[u32]) -> Mesh {
    Mesh {
        name: "made".into(),
        normals: vec![Vec3::Y; positions.len()],
        bounds: Aabb::from_points(positions.iter().copied()),
        positions: positions.to_vec(),
        indices: indices.to_vec(),
        ..Mesh::default()
    }
}

/// A box around the origin; `faces` of its six are there: -x, +x, -y, +y, -z, +z.
pub fn cuboid(half: Vec3, faces: &[usize]) -> Mesh {
    let corner = |i: u32| {
        half * Vec3::new(
            if i & 1 == 0 { -1.0 } else { 1.0 },
            if i & 2 == 0 { -1.0 } else { 1.0 },
            if i & 4 == 0 { -1.0 } else { 1.0 },
        )
    };
    const QUADS: [[u32; 4]; 6] =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = |face: &usize| {
        let [a, b, c, d] = QUADS[*face];
        [a, b, c, a, c, d]
    };
    let positions: Vec<Vec3> = (0..8).map(corner).collect();
    Mesh {
        name: "box".into(),
        normals: positions.iter().map(|p| p.normalize()).collect(),
        ..mesh(&positions, &faces.iter().flat_map(triangles).collect::<Vec<_>>())
    }
}

pub const ALL: [usize; 6] = [0, 1, 2, 3, 4, 5];

/// Both sides are seen.
pub fn thin() -> Material {
    Material { double_sided: true, ..Material::default() }
}

pub fn placed(meshes: Vec<Mesh>, placed: &[(usize, Mat4)]) -> Scene {
    over_floor(vec![thin()], vec![], meshes, placed)
}

pub fn above(y: f32) -> Mat4 {
    Mat4::from_translation(Vec3::Y * y)
}

/// Closed and open, mirrored, turned and stretched.
pub fn mixture() -> Scene {
    let torus =
        super::scenes::builtin("torus").meshes.into_iter().find(|m| m.name == "torus").expect("a torus");
    let shift = |x: f32, y: f32, z: f32| Mat4::from_translation(Vec3::new(x, y, z));
    let turn = |angle: f32| Mat4::from_quat(Quat::from_axis_angle(Vec3::new(0.6, 0.8, 0.0), angle));
    let scale = |x: f32, y: f32, z: f32| Mat4::from_scale(Vec3::new(x, y, z));
    let half = Vec3::splat(0.4);
    placed(
        vec![
            Mesh { material: 0, tangents: vec![], ..torus },
            cuboid(half, &ALL),
            cuboid(half, &[0, 1, 2, 4, 5]),
            sheet(Vec3::ZERO, Vec3::X * 0.5, Vec3::Y * 0.4, 0),
        ],
        &[
            (0, shift(-1.4, 0.9, -0.6) * turn(0.4) * scale(0.6, 0.6, 0.6)),
            (0, shift(1.2, 0.8, -1.3) * turn(1.1) * scale(-0.5, 1.1, 0.7)),
            (1, shift(0.2, 0.7, 0.9) * turn(0.7) * scale(1.0, 0.4, 1.6)),
            (1, shift(-1.2, 0.6, 1.2) * turn(2.0) * scale(1.0, 1.0, -1.0)),
            (2, shift(1.5, 0.7, 0.8) * turn(0.2)),
            (2, shift(0.1, 1.4, -1.0) * turn(-0.9) * scale(-0.8, 0.5, 1.0)),
            (3, shift(-0.5, 1.7, 0.0) * turn(1.2)),
        ],
    )
}
