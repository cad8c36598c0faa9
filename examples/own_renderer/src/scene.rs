//! What is drawn: a floor, a ring of columns with beams over them, a ball.

use glam::{Mat4, Quat, Vec3};

/// A corner as this renderer keeps it: 20 bytes. Umbrage never sees one.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Vertex {
    /// World space, metres.
    pub p_world: [f32; 3],
    /// Smooth, 8 bits with a sign each; the last is of no use.
    pub normal: [i8; 4],
    /// Linear, 8 bits each; the last is of no use.
    pub color: [u8; 4],
}

/// How pipelines read it: place, normal, colour.
pub const LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: size_of::<Vertex>() as u64,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Snorm8x4, 2 => Unorm8x4],
};

/// Three corners for each triangle.
pub fn triangles() -> Vec<Vertex> {
    let mut all = Vec::new();
    cuboid(
        &mut all,
        Mat4::from_translation(Vec3::NEG_Y * 0.1),
        Vec3::new(5.0, 0.1, 5.0),
        [190, 185, 175, 255],
    );
    const COLUMNS: u32 = 8;
    for i in 0..COLUMNS {
        let angle = std::f32::consts::TAU * i as f32 / COLUMNS as f32;
        let ring = |y: f32, angle: f32, radius_m: f32| {
            let turn = Quat::from_rotation_y(angle);
            Mat4::from_rotation_translation(turn, turn * Vec3::new(0.0, y, radius_m))
        };
        cuboid(&mut all, ring(0.9, angle, 2.6), Vec3::new(0.22, 0.9, 0.22), [150, 110, 80, 255]);
        if i % 4 < 2 {
            let half_way = angle + std::f32::consts::PI / COLUMNS as f32;
            cuboid(&mut all, ring(1.95, half_way, 2.4), Vec3::new(1.25, 0.15, 0.25), [120, 130, 160, 255]);
        }
    }
    ball(&mut all, Vec3::Y * 0.8, 0.8, [180, 70, 60, 255]);
    all
}

fn vertex(p_world: Vec3, normal: Vec3, color: [u8; 4]) -> Vertex {
    let n = (normal * 127.0).round();
    Vertex { p_world: p_world.to_array(), normal: [n.x as i8, n.y as i8, n.z as i8, 0], color }
}

/// The two triangles of a face that is cut in quads, by the signs of its corners.
const CORNERS: [(f32, f32); 6] =
    [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];

fn cuboid(all: &mut Vec<Vertex>, world_from_box: Mat4, half: Vec3, color: [u8; 4]) {
    for (normal, right) in [(Vec3::X, Vec3::Y), (Vec3::Y, Vec3::Z), (Vec3::Z, Vec3::X)] {
        for normal in [normal, -normal] {
            let up = normal.cross(right);
            let n_world = world_from_box.transform_vector3(normal);
            all.extend(CORNERS.map(|(x, y)| {
                let p = (normal + right * x + up * y) * half;
                vertex(world_from_box.transform_point3(p), n_world, color)
            }));
        }
    }
}

fn ball(all: &mut Vec<Vertex>, center_world: Vec3, radius_m: f32, color: [u8; 4]) {
    const RINGS: u32 = 32;
    let step = std::f32::consts::PI / RINGS as f32;
    for ring in 0..RINGS {
        for sector in 0..2 * RINGS {
            all.extend(CORNERS.map(|(x, y)| {
                let down = step * (ring as f32 + 0.5 - 0.5 * y);
                let around = step * (sector as f32 + 0.5 + 0.5 * x);
                let normal = Vec3::new(down.sin() * around.sin(), down.cos(), down.sin() * around.cos());
                vertex(center_world + normal * radius_m, normal, color)
            }));
        }
    }
}
