//! Tangents where a file has a normal map and none: MikkTSpace, the method that glTF names and normal maps are baked with.

use crate::Mesh;
use glam::{Vec2, Vec3, Vec4};
use std::collections::HashMap;
use std::sync::Mutex;

/// Gives a mesh tangents along its `uv_set`th texture coordinates. Vertices whose triangles disagree are split, so the
/// number of vertices may grow. A mesh without those coordinates, or too odd for the method, stays as it is.
pub(crate) fn generate(mesh: &mut Mesh, uv_set: u32) {
    let uvs = if uv_set == 1 { &mesh.uvs1 } else { &mesh.uvs };
    if uvs.len() != mesh.positions.len() || mesh.normals.len() != mesh.positions.len() || uvs.is_empty() {
        return;
    }
    let mut corners = Corners { mesh, uvs, tangents: vec![None; mesh.indices.len()] };
    if bevy_mikktspace::generate_tangents(&mut corners).is_err() {
        return;
    }
    let tangents = corners.tangents;
    split(mesh, &tangents);
}

/// [`generate`] for each mesh that has a set to follow, on every core.
pub(crate) fn generate_all(meshes: &mut [Mesh], uv_sets: &[Option<u32>]) {
    let jobs: Vec<(&mut Mesh, u32)> =
        meshes.iter_mut().zip(uv_sets).filter_map(|(mesh, set)| Some((mesh, (*set)?))).collect();
    let cores = std::thread::available_parallelism().map_or(1, usize::from).min(jobs.len());
    let queue = Mutex::new(jobs.into_iter());
    let next = || queue.lock().ok()?.next();
    let work = || {
        while let Some((mesh, uv_set)) = next() {
            generate(mesh, uv_set);
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..cores {
            scope.spawn(work);
        }
        work();
    });
}

/// What the method asks of a mesh, and what it answers for each corner of each triangle.
struct Corners<'a> {
    mesh: &'a Mesh,
    uvs: &'a [Vec2],
    tangents: Vec<Option<[f32; 4]>>,
}

impl Corners<'_> {
    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.mesh.indices[face * 3 + corner] as usize
    }
}

impl bevy_mikktspace::Geometry for Corners<'_> {
    fn num_faces(&self) -> usize {
        self.mesh.indices.len() / 3
    }

    fn num_vertices_of_face(&self, _face: usize) -> usize {
        3
    }

    fn position(&self, face: usize, vert: usize) -> [f32; 3] {
        self.mesh.positions[self.vertex(face, vert)].to_array()
    }

    fn normal(&self, face: usize, vert: usize) -> [f32; 3] {
        self.mesh.normals[self.vertex(face, vert)].to_array()
    }

    fn tex_coord(&self, face: usize, vert: usize) -> [f32; 2] {
        // The method thinks of v as upwards, glTF of downwards; turned over, bitangents point as glTF's do.
        let uv = self.uvs[self.vertex(face, vert)];
        [uv.x, 1.0 - uv.y]
    }

    fn set_tangent(&mut self, space: Option<bevy_mikktspace::TangentSpace>, face: usize, vert: usize) {
        self.tangents[face * 3 + vert] = space.map(|space| space.tangent_encoded());
    }
}

/// One vertex for each pair of old vertex and tangent.
fn split(mesh: &mut Mesh, tangents: &[Option<[f32; 4]>]) {
    let old = std::mem::take(mesh);
    let mut seen: HashMap<(u32, [u32; 4]), u32> = HashMap::with_capacity(old.positions.len());
    let mut sources: Vec<u32> = Vec::with_capacity(old.positions.len());
    let mut kept: Vec<Vec4> = Vec::with_capacity(old.positions.len());
    let mut indices = Vec::with_capacity(old.indices.len());
    for (vertex, tangent) in old.indices.iter().zip(tangents) {
        let tangent = usable(*tangent, old.normals[*vertex as usize]);
        let index = *seen.entry((*vertex, tangent.to_array().map(f32::to_bits))).or_insert_with(|| {
            sources.push(*vertex);
            kept.push(tangent);
            sources.len() as u32 - 1
        });
        indices.push(index);
    }
    *mesh = Mesh {
        positions: pick(&old.positions, &sources),
        normals: pick(&old.normals, &sources),
        tangents: kept,
        uvs: pick(&old.uvs, &sources),
        uvs1: pick(&old.uvs1, &sources),
        colors: pick(&old.colors, &sources),
        indices,
        ..old
    };
}

/// The elements at `sources`; an empty list stays empty.
pub(crate) fn pick<T: Copy>(list: &[T], sources: &[u32]) -> Vec<T> {
    if list.is_empty() { Vec::new() } else { sources.iter().map(|i| list[*i as usize]).collect() }
}

/// A unit tangent with a handedness of 1 or -1, whatever the method made of degenerate corners.
pub(crate) fn usable(tangent: Option<[f32; 4]>, normal: Vec3) -> Vec4 {
    let [x, y, z, w] = tangent.unwrap_or_default();
    let direction =
        Vec3::new(x, y, z).try_normalize().unwrap_or_else(|| normal.any_orthogonal_vector().normalize());
    direction.extend(if w < 0.0 { -1.0 } else { 1.0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    /// Two triangles in z = 0; the second one's texture is mirrored when `mirrored`.
    fn quad(mirrored: bool) -> Mesh {
        let far = if mirrored { 0.0 } else { 2.0 };
        Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::X + Vec3::Y, Vec3::X * 2.0],
            normals: vec![Vec3::Z; 5],
            uvs: vec![Vec2::Y, Vec2::ONE, Vec2::ZERO, Vec2::X, Vec2::new(far, 1.0)],
            indices: vec![0, 1, 2, 1, 4, 3],
            ..Mesh::default()
        }
    }

    #[test]
    fn tangents_follow_u_and_the_bitangent_follows_v_upwards() {
        let mut mesh = quad(false);
        generate(&mut mesh, 0);
        assert_eq!(mesh.positions.len(), 5, "nothing to split");
        for tangent in &mesh.tangents {
            assert!((tangent.truncate() - Vec3::X).length() < 1e-5, "{tangent}");
            // v grows downwards in this mesh as glTF has it, so cross(normal, tangent) * w is +y.
            assert_eq!(tangent.w, 1.0);
        }
    }

    #[test]
    fn a_mirrored_seam_splits_its_vertex() {
        let mut mesh = quad(true);
        generate(&mut mesh, 0);
        assert_eq!(mesh.positions.len(), 6, "vertex 1 serves two triangles that disagree");
        assert!(mesh.tangents.iter().any(|t| t.w < 0.0) && mesh.tangents.iter().any(|t| t.w > 0.0));
        assert!(mesh.indices.iter().all(|i| (*i as usize) < 6));
    }

    #[test]
    fn odd_meshes_do_no_harm() {
        let mut without = Mesh { uvs: vec![], ..quad(false) };
        generate(&mut without, 0);
        assert!(without.tangents.is_empty());
        let mut flat = Mesh { uvs: vec![Vec2::ZERO; 5], ..quad(false) };
        generate(&mut flat, 0);
        assert!(flat.tangents.iter().all(|t| t.is_finite() && (t.truncate().length() - 1.0).abs() < 1e-5));
    }

    /// Tangents that another tool wrote into a file, made again: the oracle for direction and handedness.
    #[test]
    fn tangents_agree_with_those_that_a_file_brings() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/scenes");
        let file = root.join("flight-helmet/FlightHelmet.gltf");
        if !file.is_file() {
            eprintln!("SKIPPED: there is no {}", file.display());
            return;
        }
        let scene = crate::load(&file.to_string_lossy()).unwrap();
        let text = std::fs::read_to_string(&file).unwrap();
        assert!(text.contains("TANGENT"), "the file has no tangents to compare with");
        for given in scene.meshes.iter().filter(|mesh| !mesh.tangents.is_empty()) {
            let mut made = Mesh { tangents: vec![], ..given.clone() };
            generate(&mut made, 0);
            let corners = given.indices.iter().zip(&made.indices);
            let agree = corners.filter(|(a, b)| {
                let (a, b) = (given.tangents[**a as usize], made.tangents[**b as usize]);
                a.w == b.w && a.truncate().dot(b.truncate()) > 0.9
            });
            let (agree, all) = (agree.count(), given.indices.len());
            assert!(agree * 100 > all * 95, "{}: {agree} of {all} corners agree", given.name);
        }
    }
}
