//! Shapes: closed ones are watertight bit by bit when welded by position, wound counter-clockwise seen from outside.

use crate::Mesh;
use glam::{Mat3, Mat4, Vec2, Vec3};
use std::f32::consts::TAU;
use umbrage_core::Aabb;

/// Triangles while they are put together.
#[derive(Clone, Debug, Default)]
pub(super) struct Shape {
    pub positions: Vec<Vec3>,
    pub normals: Vec<Vec3>,
    pub uvs: Vec<Vec2>,
    pub indices: Vec<u32>,
}

impl Shape {
    fn vertex(&mut self, position: Vec3, normal: Vec3, uv: Vec2) -> u32 {
        self.positions.push(position);
        self.normals.push(normal);
        self.uvs.push(uv);
        self.positions.len() as u32 - 1
    }

    /// Two triangles over four vertices given around the outline. Corners at the same place (poles) leave one.
    fn quad(&mut self, [a, b, c, d]: [u32; 4]) {
        for triangle in [[a, b, c], [a, c, d]] {
            let [p, q, r] = triangle.map(|i| self.positions[i as usize]);
            if p != q && q != r && r != p {
                self.indices.extend(triangle);
            }
        }
    }

    /// A flat four-sided face with a normal of its own, corners counter-clockwise.
    fn face(&mut self, corners: [Vec3; 4]) {
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize();
        let uvs = [Vec2::new(0.0, 1.0), Vec2::ONE, Vec2::new(1.0, 0.0), Vec2::ZERO];
        let vertices = [0, 1, 2, 3].map(|i| self.vertex(corners[i], normal, uvs[i]));
        self.quad(vertices);
    }

    /// Turned and moved for good. `transform` neither scales nor mirrors.
    pub fn moved(mut self, transform: Mat4) -> Self {
        let rotation = Mat3::from_mat4(transform);
        self.positions.iter_mut().for_each(|p| *p = transform.transform_point3(*p));
        self.normals.iter_mut().for_each(|n| *n = (rotation * *n).normalize());
        self
    }

    /// Moved along Y so that its lowest point lies exactly at 0.
    pub fn grounded(mut self) -> Self {
        let lowest = self.positions.iter().map(|p| p.y).fold(f32::INFINITY, f32::min);
        self.positions.iter_mut().for_each(|p| p.y -= lowest);
        self
    }

    pub fn into_mesh(self, name: &str, material: usize) -> Mesh {
        Mesh {
            name: name.to_owned(),
            bounds: Aabb::from_points(self.positions.iter().copied()),
            positions: self.positions,
            normals: self.normals,
            uvs: self.uvs,
            indices: self.indices,
            material,
            ..Mesh::default()
        }
    }
}

/// A grid of quads in the plane of `right` and `up` (half edges) around `center`; it faces `right x up`.
pub(super) fn plane(center: Vec3, right: Vec3, up: Vec3, divisions: u32) -> Shape {
    let mut shape = Shape::default();
    let normal = right.cross(up).normalize();
    let row = divisions + 1;
    for j in 0..row {
        for i in 0..row {
            let s = Vec2::new(i as f32, j as f32) / divisions as f32;
            let position = center + right * (2.0 * s.x - 1.0) + up * (2.0 * s.y - 1.0);
            shape.vertex(position, normal, Vec2::new(s.x, 1.0 - s.y));
        }
    }
    for j in 0..divisions {
        for i in 0..divisions {
            let a = j * row + i;
            shape.quad([a, a + 1, a + row + 1, a + row]);
        }
    }
    shape
}

/// A box from corner to corner.
pub(super) fn cuboid(min: Vec3, max: Vec3) -> Shape {
    let at =
        |x: usize, y: usize, z: usize| Vec3::new([min.x, max.x][x], [min.y, max.y][y], [min.z, max.z][z]);
    let mut shape = Shape::default();
    for [a, b, c, d] in [
        [(0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)],
        [(1, 0, 0), (0, 0, 0), (0, 1, 0), (1, 1, 0)],
        [(1, 0, 1), (1, 0, 0), (1, 1, 0), (1, 1, 1)],
        [(0, 0, 0), (0, 0, 1), (0, 1, 1), (0, 1, 0)],
        [(0, 1, 1), (1, 1, 1), (1, 1, 0), (0, 1, 0)],
        [(0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)],
    ] {
        shape.face([a, b, c, d].map(|(x, y, z)| at(x, y, z)));
    }
    shape
}

/// Sine and cosine of `i` steps of `n`: the last step is bit by bit the first.
fn turn(i: u32, n: u32) -> (f32, f32) {
    (TAU * (i % n) as f32 / n as f32).sin_cos()
}

/// A ball around the origin; its poles lie exactly at `y = -radius` and `y = radius`.
pub(super) fn sphere(radius: f32, slices: u32, stacks: u32) -> Shape {
    let mut shape = Shape::default();
    for j in 0..=stacks {
        let (ring, y) = match j {
            0 => (0.0, -1.0),
            _ if j == stacks => (0.0, 1.0),
            _ => {
                let (sin, cos) = (std::f32::consts::PI * j as f32 / stacks as f32).sin_cos();
                (sin, -cos)
            }
        };
        for i in 0..=slices {
            let (sin, cos) = turn(i, slices);
            let normal = Vec3::new(ring * cos, y, -ring * sin);
            let uv = Vec2::new(i as f32 / slices as f32, 1.0 - j as f32 / stacks as f32);
            shape.vertex(radius * normal, normal.normalize(), uv);
        }
    }
    grid(&mut shape, slices, stacks);
    shape
}

/// Quads over `(slices + 1) x (stacks + 1)` vertices, row by row.
fn grid(shape: &mut Shape, slices: u32, stacks: u32) {
    for j in 0..stacks {
        for i in 0..slices {
            let a = j * (slices + 1) + i;
            shape.quad([a, a + 1, a + slices + 2, a + slices + 1]);
        }
    }
}

/// What a turned profile makes: `(radius, y)` from the axis at the bottom to the axis at the top; each edge is sharp.
pub(super) fn lathe(profile: &[(f32, f32)], slices: u32) -> Shape {
    let mut shape = Shape::default();
    for (part, edge) in profile.windows(2).enumerate() {
        let [(r0, y0), (r1, y1)] = [edge[0], edge[1]];
        let slope = Vec2::new(y1 - y0, r0 - r1).normalize();
        let base = shape.positions.len() as u32;
        for (row, (r, y)) in [(r0, y0), (r1, y1)].into_iter().enumerate() {
            for i in 0..=slices {
                let (sin, cos) = turn(i, slices);
                let v = 1.0 - (part + row) as f32 / (profile.len() - 1) as f32;
                let normal = Vec3::new(slope.x * cos, slope.y, -slope.x * sin);
                shape.vertex(Vec3::new(r * cos, y, -r * sin), normal, Vec2::new(i as f32 / slices as f32, v));
            }
        }
        for i in 0..slices {
            let a = base + i;
            shape.quad([a, a + 1, a + slices + 2, a + slices + 1]);
        }
    }
    shape
}

/// A closed cylinder (or, with two radii, a frustum) that stands on `y = 0`.
pub(super) fn cylinder(bottom: f32, top: f32, height: f32, slices: u32) -> Shape {
    lathe(&[(0.0, 0.0), (bottom, 0.0), (top, height), (0.0, height)], slices)
}

/// A tube along a closed curve: `frame` gives the curve's place and two unit vectors across it (outwards and upwards,
/// so that `outwards x upwards` points along the curve).
fn tube(radius: f32, along: u32, around: u32, frame: impl Fn(u32) -> (Vec3, Vec3, Vec3)) -> Shape {
    let mut shape = Shape::default();
    for i in 0..=along {
        let (center, out, up) = frame(i % along);
        for j in 0..=around {
            let (sin, cos) = turn(j, around);
            let normal = (out * cos + up * sin).normalize();
            let uv = Vec2::new(j as f32 / around as f32, i as f32 / along as f32);
            shape.vertex(center + radius * normal, normal, uv);
        }
    }
    grid(&mut shape, around, along);
    shape
}

/// A ring around the Y axis.
pub(super) fn torus(major: f32, minor: f32, along: u32, around: u32) -> Shape {
    tube(minor, along, around, |i| {
        let (sin, cos) = turn(i, along);
        let out = Vec3::new(cos, 0.0, sin);
        (major * out, out, Vec3::Y)
    })
}

/// The knot that winds twice around the Y axis and three times around its own ring.
pub(super) fn torus_knot(radius: f32, minor: f32, along: u32, around: u32) -> Shape {
    let curve = |u: f32| {
        let ring = radius * (2.0 + (1.5 * u).cos()) * 0.5;
        Vec3::new(ring * u.cos(), 0.5 * radius * (1.5 * u).sin(), ring * u.sin())
    };
    tube(minor, along, around, |i| {
        let u = 2.0 * TAU * i as f32 / along as f32;
        let (here, ahead) = (curve(u), curve(u + 0.01));
        let forwards = (ahead - here).normalize();
        // The sum of two places of the curve points away from the axis and is never along the curve.
        let side = forwards.cross(here + ahead).normalize();
        let out = side.cross(forwards).normalize();
        (here, out, side)
    })
}

/// Half a ring in the XY plane, `depth` thick around `z = 0`, feet on `y = 0`.
pub(super) fn arch(inner: f32, outer: f32, depth: f32, segments: u32) -> Shape {
    let mut shape = Shape::default();
    let at = |i: u32, r: f32, z: f32| {
        // The feet lie on the ground exactly.
        let (sin, cos) = if i == segments {
            (0.0, -1.0)
        } else {
            (std::f32::consts::PI * i as f32 / segments as f32).sin_cos()
        };
        Vec3::new(r * cos, r * sin, z)
    };
    let z = 0.5 * depth;
    for i in 0..segments {
        let j = i + 1;
        shape.face([at(i, inner, z), at(i, outer, z), at(j, outer, z), at(j, inner, z)]);
        shape.face([at(i, outer, -z), at(i, inner, -z), at(j, inner, -z), at(j, outer, -z)]);
        shape.face([at(i, outer, z), at(i, outer, -z), at(j, outer, -z), at(j, outer, z)]);
        shape.face([at(i, inner, -z), at(i, inner, z), at(j, inner, z), at(j, inner, -z)]);
    }
    let s = segments;
    shape.face([at(0, inner, -z), at(0, outer, -z), at(0, outer, z), at(0, inner, z)]);
    shape.face([at(s, inner, z), at(s, outer, z), at(s, outer, -z), at(s, inner, -z)]);
    shape
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashMap;

    type Edge = ([u32; 3], [u32; 3]);

    fn edges(shape: &Shape) -> HashMap<Edge, u32> {
        let key = |i: u32| (shape.positions[i as usize] + Vec3::ZERO).to_array().map(f32::to_bits);
        let mut edges = HashMap::new();
        for t in shape.indices.chunks_exact(3) {
            for k in 0..3 {
                *edges.entry((key(t[k]), key(t[(k + 1) % 3]))).or_insert(0) += 1;
            }
        }
        edges
    }

    fn watertight(shape: &Shape) -> bool {
        let edges = edges(shape);
        edges.iter().all(|((a, b), n)| *n == 1 && edges.get(&(*b, *a)) == Some(&1))
    }

    fn volume(shape: &Shape) -> f32 {
        let at = |i: u32| shape.positions[i as usize];
        shape.indices.chunks_exact(3).map(|t| at(t[0]).dot(at(t[1]).cross(at(t[2]))) / 6.0).sum()
    }

    fn closed() -> Vec<(&'static str, Shape, f32)> {
        let pi = std::f32::consts::PI;
        vec![
            ("cuboid", cuboid(Vec3::new(-1.0, 0.0, 2.0), Vec3::new(1.0, 3.0, 3.0)), 6.0),
            ("sphere", sphere(0.5, 48, 24), pi / 6.0),
            ("cylinder", cylinder(0.5, 0.5, 2.0, 96), pi / 2.0),
            ("frustum", cylinder(1.0, 0.5, 1.0, 96), pi * 1.75 / 3.0),
            ("torus", torus(1.0, 0.25, 96, 48), 2.0 * pi * pi / 16.0),
            // Its curve is 6.699 m long.
            ("knot", torus_knot(0.42, 0.13, 128, 20), pi * 0.13 * 0.13 * 6.699),
            ("arch", arch(0.9, 1.2, 0.4, 64), 0.4 * 0.5 * pi * (1.44 - 0.81)),
        ]
    }

    #[test]
    fn closed_shapes_are_watertight_and_wound_outwards() {
        for (name, shape, expected) in closed() {
            assert!(watertight(&shape), "{name}");
            let volume = volume(&shape);
            // A wrong winding turns the sign.
            assert!((volume / expected - 1.0).abs() < 0.03, "{name}: {volume} {expected}");
        }
    }

    #[test]
    fn a_hole_or_a_turned_triangle_is_seen() {
        for (name, shape, _) in closed() {
            let mut holed = shape.clone();
            holed.indices.truncate(holed.indices.len() - 3);
            assert!(!watertight(&holed), "{name}");
            let mut turned = shape;
            turned.indices.swap(0, 1);
            assert!(!watertight(&turned), "{name}");
        }
        assert!(!watertight(&plane(Vec3::ZERO, Vec3::X, Vec3::NEG_Z, 2)), "a plane has a rim");
    }

    #[test]
    fn normals_agree_with_the_winding() {
        let mut shapes = closed();
        shapes.push(("plane", plane(Vec3::ONE, Vec3::X, Vec3::NEG_Z, 3), 0.0));
        for (name, shape, _) in shapes {
            for t in shape.indices.chunks_exact(3) {
                let [a, b, c] = [t[0], t[1], t[2]].map(|i| shape.positions[i as usize]);
                let face = (b - a).cross(c - a).normalize();
                for i in t {
                    let normal = shape.normals[*i as usize];
                    assert!((normal.length() - 1.0).abs() < 1e-5, "{name}");
                    assert!(face.dot(normal) > 0.7, "{name}: {face} {normal}");
                }
            }
        }
    }
}
