//! What a view draws: instances that it may see, grouped so that each group is one draw.

use crate::geometry::Geometry;
use crate::layout::GpuInstance;
use crate::materials::{MaterialEntry, Variant};
use glam::{Vec3, Vec4};
use std::sync::atomic::{AtomicUsize, Ordering};
use umbrage::core::fit::ShadowView;
use umbrage::core::idle::flat_caster_is_idle;
use umbrage::core::{Aabb, Frustum, Light, LightKind, cone_may_see};
use umbrage_scene::{Scene, is_closed, plane_of};

/// One draw: a mesh and consecutive instances.
#[derive(Clone, Debug)]
pub struct Batch {
    /// Index of the mesh.
    pub mesh: usize,
    /// Pipeline variant.
    pub variant: Variant,
    /// A closed solid wholly in front of the view, so that its back faces need not be drawn. Only set for casters.
    pub back_hidden: bool,
    /// Instances: first and past the last, in the buffer of all views.
    pub instances: std::ops::Range<u32>,
}

/// An instance with what sorting and culling need.
#[derive(Clone, Copy, Debug)]
struct Item {
    instance: usize,
    variant: Variant,
    bounds_world: Aabb,
    closed: bool,
    /// The plane that it lies in, if it is flat.
    plane_world: Option<Vec4>,
}

/// All instances of a scene in drawing order.
#[derive(Debug)]
pub struct Items {
    items: Vec<Item>,
}

/// What the shape of a mesh allows.
#[derive(Clone, Copy, Debug, Default)]
struct Shape {
    closed: bool,
    plane_object: Option<Vec4>,
}

/// The shapes of all meshes; all cores share the work.
fn shapes(scene: &Scene) -> Vec<Shape> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from).min(scene.meshes.len());
    let next = AtomicUsize::new(0);
    let work = || {
        let mut found = Vec::new();
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some(mesh) = scene.meshes.get(index) else { return found };
            let plane_object = plane_of(mesh);
            found.push((index, Shape { closed: plane_object.is_none() && is_closed(mesh), plane_object }));
        }
    };
    let mut all = vec![Shape::default(); scene.meshes.len()];
    std::thread::scope(|scope| {
        let running: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        for (index, shape) in running.into_iter().filter_map(|thread| thread.join().ok()).flatten() {
            all[index] = shape;
        }
    });
    all
}

impl Items {
    /// Sorts a scene's instances by pipeline, material and mesh. Vertices may be moved by `reach_m`; what is moved is neither
    /// flat nor closed for certain.
    pub fn new(scene: &Scene, geometry: &Geometry, materials: &[MaterialEntry], reach_m: f32) -> Self {
        let shapes = shapes(scene);
        let mut items: Vec<Item> = (0..scene.instances.len())
            .map(|instance| {
                let placed = &scene.instances[instance];
                let mesh = &scene.meshes[placed.mesh];
                let variant = Variant {
                    full: geometry.meshes[placed.mesh].full,
                    mirrored: placed.world_from_object.determinant() < 0.0,
                    ..materials[mesh.material].variant
                };
                let mut bounds_world = mesh.bounds.transformed(&placed.world_from_object);
                bounds_world = Aabb { min: bounds_world.min - reach_m, max: bounds_world.max + reach_m };
                let shape = if reach_m > 0.0 { Shape::default() } else { shapes[placed.mesh] };
                let Shape { closed, plane_object } = shape;
                // Planes go by the inverse transpose.
                let plane_world =
                    plane_object.map(|plane| placed.world_from_object.inverse().transpose() * plane);
                let plane_world = plane_world.map(|p| p / p.truncate().length()).filter(|p| p.is_finite());
                Item { instance, variant, bounds_world, closed, plane_world }
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

    /// The solid surfaces that a view may see; their instances are appended to `instances`.
    pub fn solid(&self, scene: &Scene, frustum: &Frustum, instances: &mut Vec<GpuInstance>) -> Vec<Batch> {
        let seen = self.items.iter().filter(|i| !i.variant.blend && frustum.may_see(&i.bounds_world));
        batches(scene, seen.map(|item| (item, false)), instances)
    }

    /// The surfaces mixed by alpha that a view may see, far ones first.
    pub fn blended(
        &self,
        scene: &Scene,
        frustum: &Frustum,
        eye: Vec3,
        instances: &mut Vec<GpuInstance>,
    ) -> Vec<Batch> {
        let mut seen: Vec<&Item> =
            self.items.iter().filter(|i| i.variant.blend && frustum.may_see(&i.bounds_world)).collect();
        let distance = |item: &Item| item.bounds_world.center().distance_squared(eye);
        seen.sort_by(|a, b| distance(b).total_cmp(&distance(a)));
        batches(scene, seen.into_iter().map(|item| (item, false)), instances)
    }

    /// Everything that may throw a shadow in a light's view; with `all` also what can be shown to shadow nothing.
    pub fn casters(
        &self,
        scene: &Scene,
        (light, view): (&Light, &ShadowView),
        all: bool,
        instances: &mut Vec<GpuInstance>,
    ) -> Vec<Batch> {
        let frustum = view.caster_frustum(light);
        let in_front = |bounds: &Aabb| {
            bounds.corners().iter().all(|p| -view.light_from_world.transform_point3(*p).z > view.near_m)
        };
        let whole = self.items.iter().fold(Aabb::EMPTY, |all, item| all.union(&item.bounds_world));
        let tolerance_m = 1e-6 * whole.size().max_element();
        let is_idle = |item: &Item| {
            let others = self.items.iter().filter(|other| other.instance != item.instance);
            let receivers = others.map(|other| other.bounds_world);
            item.plane_world.is_some_and(|plane| flat_caster_is_idle(light, plane, receivers, tolerance_m))
        };
        let in_cone = |bounds: &Aabb| match light.kind {
            LightKind::Spot { outer_rad, .. } => {
                cone_may_see(light.position_world, light.direction_world.normalize(), outer_rad, bounds)
            }
            _ => true,
        };
        let is_needed = |item: &Item| all || (in_cone(&item.bounds_world) && !is_idle(item));
        let seen = self.items.iter().filter(|item| frustum.may_see(&item.bounds_world) && is_needed(item));
        batches(scene, seen.map(|item| (item, item.closed && in_front(&item.bounds_world))), instances)
    }
}

/// Joins neighbours of the same mesh and state.
fn batches<'a>(
    scene: &Scene,
    items: impl Iterator<Item = (&'a Item, bool)>,
    instances: &mut Vec<GpuInstance>,
) -> Vec<Batch> {
    let mut batches: Vec<Batch> = Vec::new();
    for (item, back_hidden) in items {
        let placed = &scene.instances[item.instance];
        let at = instances.len() as u32;
        instances.push(GpuInstance::new(&placed.world_from_object));
        match batches.last_mut() {
            Some(last)
                if (last.mesh, last.variant, last.back_hidden)
                    == (placed.mesh, item.variant, back_hidden) =>
            {
                last.instances.end = at + 1;
            }
            _ => batches.push(Batch {
                mesh: placed.mesh,
                variant: item.variant,
                back_hidden,
                instances: at..at + 1,
            }),
        }
    }
    batches
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
