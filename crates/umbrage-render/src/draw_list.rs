//! What a view draws: instances that it may see, grouped so that each group is one draw.

use crate::geometry::Geometry;
use crate::layout::GpuInstance;
use crate::materials::{MaterialEntry, Variant};
use glam::Vec3;
use umbrage::core::{Aabb, Frustum};
use umbrage_scene::Scene;

/// One draw: a mesh and consecutive instances.
#[derive(Clone, Debug)]
pub struct Batch {
    /// Index of the mesh.
    pub mesh: usize,
    /// Pipeline variant.
    pub variant: Variant,
    /// Instances: first and past the last, in the buffer of all views.
    pub instances: std::ops::Range<u32>,
}

/// An instance with what sorting and culling need.
#[derive(Clone, Copy, Debug)]
struct Item {
    instance: usize,
    variant: Variant,
    bounds_world: Aabb,
}

/// All instances of a scene in drawing order.
#[derive(Debug)]
pub struct Items {
    items: Vec<Item>,
}

/// Which instances a view draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Surfaces that are not mixed by alpha.
    Solid,
    /// Surfaces that are, far ones first.
    Blended,
    /// Everything that throws a shadow.
    Casters,
}

impl Items {
    /// Sorts a scene's instances by pipeline, material and mesh.
    pub fn new(scene: &Scene, geometry: &Geometry, materials: &[MaterialEntry]) -> Self {
        let mut items: Vec<Item> = (0..scene.instances.len())
            .map(|instance| {
                let placed = &scene.instances[instance];
                let mesh = &scene.meshes[placed.mesh];
                let variant = Variant {
                    full: geometry.meshes[placed.mesh].full,
                    mirrored: placed.world_from_object.determinant() < 0.0,
                    ..materials[mesh.material].variant
                };
                Item { instance, variant, bounds_world: mesh.bounds.transformed(&placed.world_from_object) }
            })
            .collect();
        items.sort_by_key(|item| {
            let mesh = scene.instances[item.instance].mesh;
            (item.variant, scene.meshes[mesh].material, mesh, item.instance)
        });
        Self { items }
    }

    /// Boxes of all instances in world space.
    pub fn bounds_world(&self) -> Vec<Aabb> {
        self.items.iter().map(|item| item.bounds_world).collect()
    }

    /// The draws of a view, and their instances appended to `instances`. `eye` sorts what is mixed by alpha.
    pub fn draw_list(
        &self,
        scene: &Scene,
        kind: Kind,
        frustum: &Frustum,
        eye: Vec3,
        instances: &mut Vec<GpuInstance>,
    ) -> Vec<Batch> {
        let mut seen: Vec<&Item> = self
            .items
            .iter()
            .filter(|item| match kind {
                Kind::Solid => !item.variant.blend,
                Kind::Blended => item.variant.blend,
                Kind::Casters => true,
            })
            .filter(|item| frustum.may_see(&item.bounds_world))
            .collect();
        if kind == Kind::Blended {
            let distance = |item: &Item| item.bounds_world.center().distance_squared(eye);
            seen.sort_by(|a, b| distance(b).total_cmp(&distance(a)));
        }
        let mut batches: Vec<Batch> = Vec::new();
        for item in seen {
            let placed = &scene.instances[item.instance];
            let at = instances.len() as u32;
            instances.push(GpuInstance::new(&placed.world_from_object));
            match batches.last_mut() {
                Some(last) if last.mesh == placed.mesh && last.variant == item.variant => {
                    last.instances.end = at + 1
                }
                _ => batches.push(Batch { mesh: placed.mesh, variant: item.variant, instances: at..at + 1 }),
            }
        }
        batches
    }
}

/// What a list of draws asks of the GPU, counted on the CPU.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Draw calls.
    pub draws: u64,
    /// Instances.
    pub instances: u64,
    /// Triangles.
    pub triangles: u64,
    /// Distinct vertices, each instance's counted.
    pub vertices: u64,
}

impl Work {
    /// Counts a list.
    pub fn of(batches: &[Batch], geometry: &Geometry) -> Self {
        batches.iter().fold(Self::default(), |sum, batch| {
            let mesh = &geometry.meshes[batch.mesh];
            let instances = u64::from(batch.instances.end - batch.instances.start);
            Self {
                draws: sum.draws + 1,
                instances: sum.instances + instances,
                triangles: sum.triangles + instances * mesh.indices.len() as u64 / 3,
                vertices: sum.vertices + instances * u64::from(mesh.vertices),
            }
        })
    }
}
