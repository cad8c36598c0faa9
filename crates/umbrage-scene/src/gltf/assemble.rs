//! From nodes to a scene: meshes made once and shared, baked where a skin or weights of a node's own ask for it.

use super::document::Document;
use super::geometry::{self, Geometry};
use super::{cameras, images, instancing, lights, materials, morph, nodes, roles, skin};
use crate::tangents::{self, pick};
use crate::{Instance, Material, Mesh, Scene};
use glam::{Mat4, Vec3};
use std::collections::HashMap;
use umbrage_core::Aabb;

/// Stands for the material of primitives that name none, until the scene's materials are numbered.
const UNNAMED: usize = usize::MAX;

/// The scene that a document describes. Its name and its last checks are the caller's.
pub(super) fn scene(document: &Document<'_>, warnings: &mut Vec<String>) -> Result<Scene, String> {
    let tree = nodes::walk(&document.root, warnings)?;
    let mut builder = Builder {
        document,
        world: &tree.world,
        shared: HashMap::new(),
        scene: Scene::default(),
        objects: 0,
        tangent_sets: Vec::new(),
    };
    for &node in &tree.drawn {
        builder.node(node, warnings)?;
    }
    let Builder { mut scene, tangent_sets, .. } = builder;
    scene.materials = number_materials(document, &mut scene.meshes, warnings)?;
    // The two long jobs of a textured scene know nothing of each other.
    let Scene { meshes, materials, .. } = &mut scene;
    let pictures = std::thread::scope(|scope| {
        let pictures = scope.spawn(|| images::load(document, materials, warnings));
        tangents::generate_all(meshes, &tangent_sets);
        pictures.join()
    });
    scene.images =
        pictures.map_err(|_| "its pictures cannot be decoded; export the file again".to_owned())??;
    scene.lights = lights::read(document, &tree, warnings);
    scene.cameras = cameras::read(document, &tree, &scene.bounds(), warnings);
    Ok(scene)
}

/// Reads the materials in use, in the file's order, and points the meshes at them.
fn number_materials(
    document: &Document<'_>,
    meshes: &mut [Mesh],
    warnings: &mut Vec<String>,
) -> Result<Vec<Material>, String> {
    let used: std::collections::BTreeSet<usize> = meshes.iter().map(|mesh| mesh.material).collect();
    let mut list = Vec::with_capacity(used.len());
    let mut places = HashMap::new();
    for index in used {
        places.insert(index, list.len());
        list.push(if index == UNNAMED {
            materials::unnamed()
        } else {
            materials::read(document, index, warnings)?
        });
    }
    for mesh in meshes {
        mesh.material = places[&mesh.material];
    }
    Ok(list)
}

struct Builder<'a> {
    document: &'a Document<'a>,
    world: &'a [Mat4],
    /// Meshes that do not depend on the node, by mesh and primitive; `None` where there is nothing to draw.
    shared: HashMap<(usize, usize), Option<usize>>,
    scene: Scene,
    /// Objects so far.
    objects: u32,
    /// For each mesh, the texture coordinates along which it still needs tangents.
    tangent_sets: Vec<Option<u32>>,
}

impl Builder<'_> {
    fn node(&mut self, node: usize, warnings: &mut Vec<String>) -> Result<(), String> {
        let json = &self.document.root.nodes[node];
        let Some(mesh) = json.mesh.map(|mesh| mesh.value()) else { return Ok(()) };
        let joints = match json.skin {
            Some(skin) => Some(skin::matrices(self.document, skin.value(), self.world)?),
            None => None,
        };
        let places = match joints {
            Some(_) => None,
            None => instancing::places(self.document, node)?,
        };
        let name = json.name.clone().unwrap_or_default();
        let roles = roles::read(self.document, node, warnings);
        let places = places.as_deref().unwrap_or(&[Mat4::IDENTITY]);
        // Each place is an object, whatever the number of its primitives.
        let first = self.objects;
        self.objects = first.saturating_add(places.len() as u32);
        for primitive in 0..self.document.root.meshes[mesh].primitives.len() {
            let (index, baked) = self.primitive(node, mesh, primitive, joints.as_deref(), warnings)?;
            let Some(index) = index else { continue };
            // What a skin has moved is in the world already.
            let world = if baked { Mat4::IDENTITY } else { self.world[node] };
            self.document.charge(places.len(), size_of::<Instance>() + name.len())?;
            self.scene.instances.extend((first..).zip(places).map(|(object, place)| Instance {
                name: name.clone(),
                mesh: index,
                world_from_object: world * *place,
                roles,
                object,
            }));
        }
        Ok(())
    }

    /// The mesh of a node's primitive, and whether its vertices are in the world already.
    fn primitive(
        &mut self,
        node: usize,
        mesh: usize,
        primitive: usize,
        joints: Option<&[Mat4]>,
        warnings: &mut Vec<String>,
    ) -> Result<(Option<usize>, bool), String> {
        let json = &self.document.root.meshes[mesh].primitives[primitive];
        let own = self.document.root.nodes[node].weights.as_ref();
        let own = own.filter(|_| json.targets.as_ref().is_some_and(|targets| !targets.is_empty()));
        let alone = joints.is_some() || own.is_some();
        if !alone && let Some(made) = self.shared.get(&(mesh, primitive)) {
            return Ok((*made, false));
        }
        let weights = own.or(self.document.root.meshes[mesh].weights.as_ref());
        let place = self.document.primitive_label(mesh, primitive);
        let mut baked = false;
        let made = match geometry::read(self.document, json, &place, warnings)? {
            None => None,
            Some(mut read) => {
                morph::apply(self.document, json, weights.map_or(&[], Vec::as_slice), &mut read, &place)?;
                if let Some(joints) = joints.filter(|_| !read.bones.is_empty()) {
                    skin::apply(joints, &mut read, &place)?;
                    baked = true;
                }
                let name = self.document.root.meshes[mesh].name.clone().unwrap_or_default();
                let material = json.material.map_or(UNNAMED, |material| material.value());
                let (mesh, tangent_set) = self.finish(read, name, material)?;
                self.scene.meshes.push(mesh);
                self.tangent_sets.push(tangent_set);
                Some(self.scene.meshes.len() - 1)
            }
        };
        if !alone {
            self.shared.insert((mesh, primitive), made);
        }
        Ok((made, baked))
    }

    /// The mesh, and along which texture coordinates it still needs tangents.
    fn finish(&self, read: Geometry, name: String, material: usize) -> Result<(Mesh, Option<u32>), String> {
        let Geometry { positions, normals, tangents, uvs: [uvs, uvs1], colors, indices, .. } = read;
        let mut mesh = Mesh { name, positions, uvs, uvs1, colors, indices, material, ..Mesh::default() };
        match normals {
            Some(normals) => {
                mesh.normals = normals.into_iter().map(Vec3::normalize_or_zero).collect();
                repair_normals(&mut mesh);
                let given = tangents.unwrap_or_default();
                mesh.tangents = given
                    .iter()
                    .zip(&mesh.normals)
                    .map(|(t, n)| tangents::usable(Some(t.to_array()), *n))
                    .collect();
            }
            // Tangents without normals mean nothing; the specification has them ignored.
            None => {
                self.document.charge(mesh.indices.len(), 80)?;
                facet(&mut mesh);
            }
        }
        let mut tangent_set = None;
        if material != UNNAMED && mesh.tangents.is_empty() {
            // Whatever is wrong with the texture is said once, where the material is read.
            if let Some(map) = materials::normal_texture(self.document, material, &mut Vec::new())? {
                self.document.charge(mesh.indices.len(), 160)?;
                tangent_set = Some(map.uv_set);
            }
        }
        mesh.bounds = Aabb::from_points(mesh.indices.iter().map(|i| mesh.positions[*i as usize]));
        Ok((mesh, tangent_set))
    }
}

/// The unit normal of a triangle, in 64 bits for the sake of small ones; zero where it has no area.
fn face_normal(mesh: &Mesh, triangle: &[u32]) -> Vec3 {
    let [a, b, c]: [_; 3] = std::array::from_fn(|i| mesh.positions[triangle[i] as usize].as_dvec3());
    (b - a).cross(c - a).normalize_or_zero().as_vec3()
}

/// Flat normals: every triangle gets its own three vertices.
fn facet(mesh: &mut Mesh) {
    let sources = std::mem::take(&mut mesh.indices);
    mesh.positions = pick(&mesh.positions, &sources);
    mesh.uvs = pick(&mesh.uvs, &sources);
    mesh.uvs1 = pick(&mesh.uvs1, &sources);
    mesh.colors = pick(&mesh.colors, &sources);
    mesh.indices = (0..sources.len() as u32).collect();
    mesh.normals = Vec::with_capacity(sources.len());
    for triangle in 0..sources.len() / 3 {
        let first = triangle as u32 * 3;
        let normal = face_normal(mesh, &[first, first + 1, first + 2]);
        mesh.normals.extend([if normal == Vec3::ZERO { Vec3::Y } else { normal }; 3]);
    }
}

/// Gives vertices whose normal has no direction the mean of their triangles'.
fn repair_normals(mesh: &mut Mesh) {
    let broken: Vec<bool> = mesh.normals.iter().map(|n| *n == Vec3::ZERO || !n.is_finite()).collect();
    if !broken.contains(&true) {
        return;
    }
    let mut sums = vec![Vec3::ZERO; mesh.positions.len()];
    for triangle in mesh.indices.chunks_exact(3) {
        if triangle.iter().any(|i| broken[*i as usize]) {
            let normal = face_normal(mesh, triangle);
            triangle.iter().for_each(|i| sums[*i as usize] += normal);
        }
    }
    for (vertex, _) in broken.iter().enumerate().filter(|(_, broken)| **broken) {
        mesh.normals[vertex] = sums[vertex].try_normalize().unwrap_or(Vec3::Y);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quad() -> Mesh {
        Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y],
            colors: vec![[1; 4], [2; 4], [3; 4], [4; 4]],
            indices: vec![0, 1, 2, 0, 2, 3],
            ..Mesh::default()
        }
    }

    #[test]
    fn flat_normals_unshare_every_list() {
        let mut mesh = quad();
        mesh.positions[3].z = 1.0;
        facet(&mut mesh);
        assert_eq!((mesh.positions.len(), mesh.normals.len(), mesh.colors[4]), (6, 6, [3; 4]));
        assert_eq!(mesh.normals[0], Vec3::Z);
        assert_ne!(mesh.normals[3], Vec3::Z);
        assert!(mesh.uvs.is_empty());
    }

    #[test]
    fn normals_without_direction_come_from_the_triangles() {
        let mut mesh = Mesh { normals: vec![Vec3::ZERO, Vec3::X, Vec3::NAN, Vec3::X], ..quad() };
        repair_normals(&mut mesh);
        assert_eq!(mesh.normals, [Vec3::Z, Vec3::X, Vec3::Z, Vec3::X]);
    }
}
