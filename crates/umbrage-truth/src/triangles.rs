//! A scene as one flat list of triangles in world space, each of which remembers where it came from.

use crate::TruthError;
use glam::{DVec3, Mat4, Vec3};
use obvhs::Boundable;
use obvhs::aabb::Aabb;
use umbrage_scene::{AlphaMode, Material, Mesh, Roles, Scene};

/// Triangles that an index with flags can count.
pub const MOST: u64 = 1 << 29;

/// The triangle's surface has holes, is translucent or belongs to no blocker: a ray that hits it may go on.
const PIERCEABLE: u32 = 1 << 31;
/// Both of its sides are seen.
const DOUBLE_SIDED: u32 = 1 << 30;
/// It is mixed over what is behind it, so the eye's ray goes on.
const BLENDED: u32 = 1 << 29;

/// Which triangle of the scene one is, and what a ray must know before it looks closer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tag(u32);

impl Tag {
    /// Index of the triangle, counted through all instances.
    pub fn index(self) -> u32 {
        self.0 & (BLENDED - 1)
    }

    /// May light or sight go on behind it?
    pub fn is_pierceable(self) -> bool {
        self.0 & PIERCEABLE != 0
    }

    /// Are both of its sides seen?
    pub fn is_double_sided(self) -> bool {
        self.0 & DOUBLE_SIDED != 0
    }

    /// Is it mixed over what is behind it?
    pub fn is_blended(self) -> bool {
        self.0 & BLENDED != 0
    }

    fn new(index: u32, material: &Material, roles: Roles) -> Self {
        let flag = |is: bool, flag: u32| if is { flag } else { 0 };
        Self(
            index
                | flag(material.alpha != AlphaMode::Opaque || !roles.blocker, PIERCEABLE)
                | flag(material.double_sided, DOUBLE_SIDED)
                | flag(material.alpha == AlphaMode::Blend, BLENDED),
        )
    }
}

/// A triangle's corners. The hierarchy is built from these themselves, because a box for each would take as much again.
#[derive(Clone, Copy, Debug)]
pub struct Corners(pub [Vec3; 3]);

impl Boundable for Corners {
    fn aabb(&self) -> Aabb {
        let [a, b, c] = self.0;
        Aabb { min: a.min(b).min(c).into(), max: a.max(b).max(c).into() }
    }
}

/// All triangles that a scene draws. Corners are relative to `center_world`, so that single precision is finest where
/// the scene is; counter-clockwise seen from the front, also in mirrored instances.
#[derive(Debug)]
pub struct Triangles {
    /// Middle of the scene, metres.
    pub center_world: DVec3,
    /// Greatest absolute coordinate of a corner, relative to the middle.
    pub extent_m: f32,
    /// Greatest absolute coordinate of the scene in world space: what its own numbers' rounding grows with.
    pub magnitude_m: f32,
    /// Three corners each.
    pub corners: Vec<Corners>,
    /// One for each.
    pub tags: Vec<Tag>,
    /// Index of the first triangle of each instance, and the count of all.
    pub first_of_instance: Vec<u32>,
}

impl Triangles {
    /// Flattens a scene.
    pub fn new(scene: &Scene) -> Result<Self, TruthError> {
        let count = scene.triangles();
        if count >= MOST {
            return Err(TruthError::TooManyTriangles(count));
        }
        let bounds = scene.bounds();
        let center = if bounds.is_empty() { DVec3::ZERO } else { bounds.center().as_dvec3() };
        let mut made = Self {
            center_world: center,
            extent_m: 0.0,
            magnitude_m: 0.0,
            corners: Vec::with_capacity(count as usize),
            tags: Vec::with_capacity(count as usize),
            first_of_instance: Vec::with_capacity(scene.instances.len() + 1),
        };
        for instance in &scene.instances {
            made.first_of_instance.push(made.corners.len() as u32);
            let mesh = &scene.meshes[instance.mesh];
            made.add(mesh, &instance.world_from_object, &scene.materials[mesh.material], instance.roles);
        }
        made.first_of_instance.push(made.corners.len() as u32);
        made.magnitude_m = made.extent_m + made.center_world.abs().max_element() as f32;
        Ok(made)
    }

    fn add(&mut self, mesh: &Mesh, world_from_object: &Mat4, material: &Material, roles: Roles) {
        let Mesh { positions, indices, .. } = mesh;
        let world_from_object = world_from_object.as_dmat4();
        let mirrored = world_from_object.determinant() < 0.0;
        let placed = |i: u32| {
            let p_world = world_from_object.transform_point3(positions[i as usize].as_dvec3());
            (p_world - self.center_world).as_vec3()
        };
        for triangle in indices.chunks_exact(3) {
            let [a, b, c] = [0, 1, 2].map(|i| placed(triangle[i]));
            let corners = if mirrored { [a, c, b] } else { [a, b, c] };
            let extent = corners.iter().map(|p| p.abs().max_element()).fold(0.0, f32::max);
            self.extent_m = self.extent_m.max(extent);
            self.tags.push(Tag::new(self.corners.len() as u32, material, roles));
            self.corners.push(Corners(corners));
        }
    }

    /// The instance that a triangle belongs to, and which of its mesh's triangles it is.
    pub fn origin_of(&self, tag: Tag) -> (usize, usize) {
        let index = tag.index();
        let instance = self.first_of_instance.partition_point(|first| *first <= index) - 1;
        (instance, (index - self.first_of_instance[instance]) as usize)
    }
}
