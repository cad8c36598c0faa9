//! From `tobj`'s polygons to meshes, one for each material.

use super::{
    polygons::Cutter,
    scan::{Scan, Smoothing},
};
use crate::{Material, Mesh, normals};
use glam::{Vec2, Vec3};
use std::collections::HashMap;
use umbrage_core::Aabb;

/// Joins all runs. `material_of_run` gives each run's index into `materials`. `None`: more corners than 32 bits count.
pub(super) fn meshes(
    models: &[tobj::Model],
    scan: &Scan,
    material_of_run: &[usize],
    materials: &[Material],
    warnings: &mut Vec<String>,
) -> Option<Vec<Mesh>> {
    let corners: usize = models.iter().map(|m| m.mesh.indices.len()).sum();
    u32::try_from(corners).ok()?;
    let color_scale = color_scale(models);
    let mut builders: Vec<Builder> = materials.iter().map(|_| Builder::default()).collect();
    let mut computed = computed_normals(models, scan).into_iter();
    let mut cutter = Cutter::new();
    let (mut triangles, mut places, mut vertices) = (Vec::new(), Vec::new(), Vec::new());
    let mut too_large = 0;
    for ((model, run), &material) in models.iter().zip(&scan.runs).zip(material_of_run) {
        let corner = Corners { mesh: &model.mesh, uvs: run.uvs, normals: run.normals, color_scale };
        let builder = &mut builders[material];
        builder.has_uvs |= run.uvs;
        let mut start = 0;
        for arity in arities(&model.mesh) {
            places.clear();
            vertices.clear();
            triangles.clear();
            for i in start..start + arity as usize {
                let normal = if run.normals { None } else { computed.next() };
                let vertex = corner.vertex(i, normal);
                places.push(vertex.position);
                vertices.push(vertex);
            }
            start += arity as usize;
            too_large += usize::from(!cutter.cut(&places, &mut triangles));
            for triangle in &triangles {
                for &i in triangle {
                    builder.add(&vertices[i as usize]);
                }
            }
        }
    }
    if too_large > 0 {
        warnings.push(format!("{too_large} polygons have so many corners that they are cut as fans"));
    }
    let finish = |(material, builder): (usize, Builder)| {
        builder.finish(material, &materials[material].name, scan.colors)
    };
    Some(builders.into_iter().enumerate().map(finish).filter(|m| !m.indices.is_empty()).collect())
}

/// Corners of each face. `tobj` leaves the list empty when all are triangles.
fn arities(mesh: &tobj::Mesh) -> impl Iterator<Item = u32> + '_ {
    let triangles = if mesh.face_arities.is_empty() { mesh.indices.len() / 3 } else { 0 };
    mesh.face_arities.iter().copied().chain(std::iter::repeat_n(3, triangles))
}

/// Some scanners' programs write colours as 0..255.
fn color_scale(models: &[tobj::Model]) -> f32 {
    let large = models.iter().any(|m| m.mesh.vertex_color.iter().any(|c| *c > 1.0));
    if large { 1.0 / 255.0 } else { 1.0 }
}

/// Normals for the corners of all runs without, one after the other. Faces meet over the borders of materials.
fn computed_normals(models: &[tobj::Model], scan: &Scan) -> Vec<Vec3> {
    let (mut places, mut counts, mut groups) = (Vec::new(), Vec::new(), Vec::new());
    for (model, run) in models.iter().zip(&scan.runs).filter(|(_, run)| !run.normals) {
        places.extend(model.mesh.indices.iter().map(|&i| triple(&model.mesh.positions, i)));
        let before = counts.len();
        counts.extend(arities(&model.mesh));
        let group = match run.smoothing {
            Smoothing::Group(group) => Some(group),
            Smoothing::Flat => None,
        };
        groups.extend(std::iter::repeat_n(group, counts.len() - before));
    }
    normals::smooth(&places, &counts, &groups)
}

fn triple(values: &[f32], i: u32) -> Vec3 {
    Vec3::from_slice(&values[3 * i as usize..])
}

/// One vertex of the mesh to be.
struct Vertex {
    position: Vec3,
    normal: Vec3,
    uv: Vec2,
    color: [u8; 4],
}

/// A model's corners by number.
struct Corners<'a> {
    mesh: &'a tobj::Mesh,
    uvs: bool,
    normals: bool,
    color_scale: f32,
}

impl Corners<'_> {
    fn vertex(&self, corner: usize, computed: Option<Vec3>) -> Vertex {
        let mesh = self.mesh;
        let place = mesh.indices[corner];
        let own = || self.normals.then(|| triple(&mesh.normals, mesh.normal_indices[corner]));
        let uv = if self.uvs {
            let uv = Vec2::from_slice(&mesh.texcoords[2 * mesh.texcoord_indices[corner] as usize..]);
            // OBJ counts rows from the bottom, glTF and this crate from the top.
            Vec2::new(uv.x, 1.0 - uv.y)
        } else {
            Vec2::ZERO
        };
        let color = if mesh.vertex_color.is_empty() {
            [255; 4]
        } else {
            let linear = super::mtl::linear_from_srgb(triple(&mesh.vertex_color, place) * self.color_scale);
            let byte = |x: f32| (x * 255.0).round() as u8;
            [byte(linear.x), byte(linear.y), byte(linear.z), 255]
        };
        // Adding zero makes -0 equal to 0 bit by bit.
        let position = triple(&mesh.positions, place) + Vec3::ZERO;
        let normal = computed.or_else(own).and_then(Vec3::try_normalize).unwrap_or(Vec3::Y) + Vec3::ZERO;
        Vertex { position, normal, uv, color }
    }
}

/// Bits of position, normal, uv and colour: equal vertices are stored once.
type Key = [u32; 9];

/// A mesh while it grows.
#[derive(Default)]
struct Builder {
    mesh: Mesh,
    index_of: HashMap<Key, u32>,
    has_uvs: bool,
}

impl Builder {
    fn add(&mut self, vertex: &Vertex) {
        let [px, py, pz] = vertex.position.to_array().map(f32::to_bits);
        let [nx, ny, nz] = vertex.normal.to_array().map(f32::to_bits);
        let [u, v] = vertex.uv.to_array().map(f32::to_bits);
        let key = [px, py, pz, nx, ny, nz, u, v, u32::from_ne_bytes(vertex.color)];
        let mesh = &mut self.mesh;
        let index = *self.index_of.entry(key).or_insert_with(|| {
            mesh.positions.push(vertex.position);
            mesh.normals.push(vertex.normal);
            mesh.uvs.push(vertex.uv);
            mesh.colors.push(vertex.color);
            mesh.positions.len() as u32 - 1
        });
        mesh.indices.push(index);
    }

    fn finish(self, material: usize, name: &str, has_colors: bool) -> Mesh {
        let mut mesh = self.mesh;
        if !self.has_uvs {
            mesh.uvs = Vec::new();
        }
        if !has_colors {
            mesh.colors = Vec::new();
        }
        mesh.bounds = Aabb::from_points(mesh.positions.iter().copied());
        mesh.name = name.to_owned();
        mesh.material = material;
        mesh
    }
}
