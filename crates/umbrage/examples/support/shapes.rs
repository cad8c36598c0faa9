//! Solids with indices: places and normals between each other, 24 bytes a corner.

use glam::Vec3;
use std::f32::consts::{PI, TAU};

/// A corner.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Vertex {
    /// Object space, metres.
    pub p_object: [f32; 3],
    /// Unit length.
    pub normal: [f32; 3],
}

/// Corners, and three indices for each triangle, counter-clockwise from outside.
#[derive(Clone, Debug, Default)]
pub struct Shape {
    pub vertices: Vec<Vertex>,
    pub indices: Vec<u32>,
}

impl Shape {
    /// Places of the corners.
    pub fn places(&self) -> impl Iterator<Item = Vec3> {
        self.vertices.iter().map(|vertex| vertex.p_object.into())
    }

    /// A cube from -1 to 1.
    pub fn cube() -> Self {
        let mut cube = Self::default();
        for (normal, right) in [(Vec3::X, Vec3::Y), (Vec3::Y, Vec3::Z), (Vec3::Z, Vec3::X)] {
            for normal in [normal, -normal] {
                let up = normal.cross(right);
                cube.grid([1, 1], |x, y| (normal + right * (2.0 * x - 1.0) + up * (2.0 * y - 1.0), normal));
            }
        }
        cube
    }

    /// A ball of radius 1.
    pub fn ball() -> Self {
        let mut ball = Self::default();
        ball.grid([48, 24], |x, y| {
            let (around, up) = (TAU * x, PI * (y - 0.5));
            let n = Vec3::new(up.cos() * around.sin(), up.sin(), up.cos() * around.cos());
            (n, n)
        });
        ball
    }

    /// A tube along a knot that winds twice around the Y axis and thrice around a ring of radius 1.
    pub fn knot(radius: f32) -> Self {
        let along = |t: f32| {
            let (around, across) = (2.0 * t, 3.0 * t);
            let out = 1.0 + 0.4 * across.cos();
            Vec3::new(out * around.cos(), 0.4 * across.sin(), out * around.sin())
        };
        let mut knot = Self::default();
        knot.grid([240, 16], |x, y| {
            let (t, turn) = (TAU * x, TAU * y);
            let middle = along(t);
            let ahead = (along(t + 1e-3) - along(t - 1e-3)).normalize();
            let side = ahead.cross(Vec3::Y).normalize();
            let n = side * turn.cos() + side.cross(ahead) * turn.sin();
            (middle + n * radius, n)
        });
        knot
    }

    /// Adds a patch of quads; `at` gives place and normal at 0..1 right and up.
    pub fn grid(&mut self, quads: [u32; 2], at: impl Fn(f32, f32) -> (Vec3, Vec3)) {
        let first = self.vertices.len() as u32;
        let row = quads[0] + 1;
        for y in 0..=quads[1] {
            for x in 0..row {
                let (p, n) = at(x as f32 / quads[0] as f32, y as f32 / quads[1] as f32);
                self.vertices.push(Vertex { p_object: p.to_array(), normal: n.to_array() });
            }
        }
        for y in 0..quads[1] {
            for x in 0..quads[0] {
                let corner = first + y * row + x;
                let [right, up, both] = [corner + 1, corner + row, corner + row + 1];
                self.indices.extend([corner, right, both, corner, both, up]);
            }
        }
    }
}
