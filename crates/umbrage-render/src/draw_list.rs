//! What a view draws: instances that it may see, grouped so that each group is one draw.

use crate::geometry::Geometry;
use crate::layout::GpuInstance;
use crate::materials::{MaterialEntry, Variant};
use glam::{Mat4, Vec3, Vec4};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use umbrage::core::fit::ShadowView;
use umbrage::core::idle::flat_caster_is_idle;
use umbrage::core::masks::{Rect, Shadow};
use umbrage::core::plan::Cull;
use umbrage::core::technique::{Bias, Settings};
use umbrage::core::volume::light_may_reach;
use umbrage::core::{Aabb, Frustum, Light, LightKind, cone_may_see};
use umbrage::mask::MaskPart;
use umbrage::volume::VolumeItem;
use umbrage_scene::{Mesh, Roles, Scene, is_closed, plane_of};

/// One draw: a mesh and consecutive instances.
#[derive(Clone, Debug)]
pub struct Batch {
    /// Index of the mesh.
    pub mesh: usize,
    /// Pipeline variant.
    pub variant: Variant,
    /// A closed solid of which the pass leaves out one side, as its `Cull` says. Only set for casters.
    pub one_sided: bool,
    /// Instances: first and past the last, in the buffer of all views.
    pub instances: std::ops::Range<u32>,
}

/// An instance with what sorting and culling need.
#[derive(Clone, Copy, Debug)]
struct Item {
    instance: usize,
    mesh: usize,
    material: usize,
    world_from_object: Mat4,
    variant: Variant,
    bounds_world: Aabb,
    closed: bool,
    /// Has it holes that light passes?
    cut_out: bool,
    /// Is it one that only maps can draw?
    by_map: bool,
    /// The object that it is a part of, and what that does with light.
    object: u32,
    roles: Roles,
    /// The plane that it lies in, if it is flat.
    plane_world: Option<Vec4>,
}

/// Receivers of a mask: a mesh and consecutive instances.
#[derive(Clone, Debug)]
pub(crate) struct ReceiverBatch {
    /// Index of the mesh.
    pub mesh: usize,
    /// Instances: first and past the last.
    pub instances: std::ops::Range<u32>,
    /// The pixels that may lie in the shadow.
    pub on_screen: Rect,
}

/// Is an instance flat, and nothing behind it? `boxes` are those of all instances, world space.
pub fn is_flat_and_idle(scene: &Scene, light: &Light, number: usize, boxes: &[Aabb]) -> bool {
    let placed = &scene.instances[number];
    let Some(plane_object) = plane_of(&scene.meshes[placed.mesh]) else { return false };
    let plane = placed.world_from_object.inverse().transpose() * plane_object;
    let plane = plane / plane.truncate().length();
    let whole = boxes.iter().fold(Aabb::EMPTY, |all, one| all.union(one));
    let others = boxes.iter().enumerate().filter(|(other, _)| *other != number).map(|(_, one)| *one);
    plane.is_finite() && flat_caster_is_idle(light, plane, others, 1e-6 * whole.size().max_element())
}

/// All instances of a scene in drawing order.
#[derive(Clone, Debug)]
pub struct Items {
    items: Vec<Item>,
    /// Where each instance stands in `items`.
    at_of_instance: Vec<usize>,
    shapes: Vec<Shape>,
    reach_m: f32,
}

/// What the shape of a mesh allows.
#[derive(Clone, Copy, Debug, Default)]
struct Shape {
    bounds_object: Aabb,
    closed: bool,
    plane_object: Option<Vec4>,
}

impl Shape {
    fn of(mesh: &Mesh) -> Self {
        let plane_object = plane_of(mesh);
        let closed = plane_object.is_none() && is_closed(mesh);
        Self { bounds_object: mesh.bounds, closed, plane_object }
    }
}

impl Item {
    /// Moves it to `world_from_object`. Vertices may be moved on by `reach_m`; what is moved is neither flat nor closed for
    /// certain.
    fn place(&mut self, world_from_object: Mat4, shape: &Shape, reach_m: f32) {
        self.world_from_object = world_from_object;
        self.variant.mirrored = world_from_object.determinant() < 0.0;
        let bounds = shape.bounds_object.transformed(&world_from_object);
        self.bounds_world = Aabb { min: bounds.min - reach_m, max: bounds.max + reach_m };
        self.closed = shape.closed && reach_m <= 0.0;
        // Planes go by the inverse transpose.
        let plane_object = shape.plane_object.filter(|_| reach_m <= 0.0);
        let plane_world = plane_object.map(|plane| world_from_object.inverse().transpose() * plane);
        self.plane_world = plane_world.map(|p| p / p.truncate().length()).filter(|p| p.is_finite());
    }
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
            found.push((index, Shape::of(mesh)));
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
    /// flat nor closed for certain. `by_map`: for each instance, whether it is one that only maps can draw.
    pub fn new(
        scene: &Scene,
        geometry: &Geometry,
        materials: &[MaterialEntry],
        reach_m: f32,
        by_map: &[bool],
    ) -> Self {
        let shapes = shapes(scene);
        let item = |(instance, placed): (usize, &umbrage_scene::Instance)| {
            let material = scene.meshes[placed.mesh].material;
            let mut item = Item {
                instance,
                mesh: placed.mesh,
                material,
                world_from_object: placed.world_from_object,
                variant: Variant {
                    full: geometry.meshes[placed.mesh].full,
                    exempt: !placed.roles.receiver,
                    ..materials[material].variant
                },
                bounds_world: Aabb::EMPTY,
                closed: false,
                cut_out: geometry.meshes[placed.mesh].uv_alpha_offset.is_some(),
                by_map: by_map[instance],
                object: placed.object,
                roles: placed.roles,
                plane_world: None,
            };
            item.place(placed.world_from_object, &shapes[placed.mesh], reach_m);
            item
        };
        let items = scene.instances.iter().enumerate().map(item).collect();
        let mut items = Self { items, at_of_instance: Vec::new(), shapes, reach_m };
        items.sort();
        items
    }

    fn sort(&mut self) {
        self.items.sort_by_key(|item| (item.variant, item.material, item.mesh, item.instance));
        self.at_of_instance = vec![0; self.items.len()];
        for (at, item) in self.items.iter().enumerate() {
            self.at_of_instance[item.instance] = at;
        }
    }

    /// Moves an instance; nothing where there is none of that number.
    pub fn place(&mut self, instance: usize, world_from_object: Mat4) {
        let Some(item) = self.at_of_instance.get(instance).and_then(|at| self.items.get_mut(*at)) else {
            return;
        };
        let was_mirrored = item.variant.mirrored;
        item.place(world_from_object, &self.shapes[item.mesh], self.reach_m);
        if item.variant.mirrored != was_mirrored {
            self.sort();
        }
    }

    /// Gives a mesh another shape.
    pub fn reshape(&mut self, index: usize, mesh: &Mesh) {
        self.shapes[index] = Shape::of(mesh);
        for item in self.items.iter_mut().filter(|item| item.mesh == index) {
            item.place(item.world_from_object, &self.shapes[index], self.reach_m);
        }
    }

    /// How many instances there are.
    pub fn len(&self) -> usize {
        self.items.len()
    }

    /// Boxes of all instances in world space.
    pub fn bounds_world(&self) -> Vec<Aabb> {
        self.items.iter().map(|item| item.bounds_world).collect()
    }

    /// The solid surfaces that a view may see; their instances are appended to `instances`.
    pub fn solid(&self, frustum: &Frustum, instances: &mut Vec<GpuInstance>) -> Vec<Batch> {
        let seen = self.items.iter().filter(|i| !i.variant.blend && frustum.may_see(&i.bounds_world));
        batches(seen.map(|item| (item, false)), instances)
    }

    /// The surfaces mixed by alpha that a view may see, far ones first.
    pub fn blended(&self, frustum: &Frustum, eye: Vec3, instances: &mut Vec<GpuInstance>) -> Vec<Batch> {
        batches(self.blended_items(frustum, eye).into_iter().map(|item| (item, false)), instances)
    }

    fn blended_items(&self, frustum: &Frustum, eye: Vec3) -> Vec<&Item> {
        let mut seen: Vec<&Item> =
            self.items.iter().filter(|i| i.variant.blend && frustum.may_see(&i.bounds_world)).collect();
        let distance = |item: &Item| item.bounds_world.center().distance_squared(eye);
        seen.sort_by(|a, b| distance(b).total_cmp(&distance(a)));
        seen
    }

    /// Box around all instances, world space.
    pub fn whole(&self) -> Aabb {
        self.items.iter().fold(Aabb::EMPTY, |all, item| all.union(&item.bounds_world))
    }

    /// Is an item flat, and nothing behind it?
    fn is_idle(&self, light: &Light, item: &Item, tolerance_m: f32) -> bool {
        let others = self.items.iter().filter(|other| other.instance != item.instance);
        let receivers = others.map(|other| other.bounds_world);
        item.plane_world.is_some_and(|plane| flat_caster_is_idle(light, plane, receivers, tolerance_m))
    }

    /// Everything of which a volume can be made and that may throw a shadow; with `all` also what can be shown to shadow nothing.
    pub fn volume_casters<'a>(
        &'a self,
        light: &'a Light,
        all: bool,
    ) -> impl Iterator<Item = VolumeItem> + 'a {
        let tolerance_m = 1e-6 * self.whole().size().max_element();
        let is_needed = move |item: &&Item| {
            let is_caster = item.roles.blocker && !item.by_map && !item.bounds_world.is_empty();
            let is_caster = is_caster && light_may_reach(light, &item.bounds_world);
            is_caster && (all || !self.is_idle(light, item, tolerance_m))
        };
        self.items.iter().filter(is_needed).map(|item| VolumeItem {
            mesh: item.mesh,
            world_from_object: item.world_from_object,
            bounds_world: item.bounds_world,
        })
    }

    /// The objects that may throw a mask, each with its parts. `versions` are those of the meshes.
    pub fn mask_blockers(&self, light: &Light, versions: &[u64]) -> BTreeMap<u32, Vec<MaskPart>> {
        let tolerance_m = 1e-6 * self.whole().size().max_element();
        let mut blockers: BTreeMap<u32, (bool, Vec<MaskPart>)> = BTreeMap::new();
        let of_kind = self.items.iter().filter(|item| item.roles.blocker && !item.by_map);
        for item in of_kind.filter(|item| !item.bounds_world.is_empty()) {
            let (is_needed, parts) = blockers.entry(item.object).or_default();
            *is_needed |= !self.is_idle(light, item, tolerance_m);
            parts.push(MaskPart {
                mesh: item.mesh as u32,
                version: versions[item.mesh],
                world_from_object: item.world_from_object,
                bounds_world: item.bounds_world,
            });
        }
        let needed = blockers.into_iter().filter(|(_, (is_needed, _))| *is_needed);
        needed.map(|(object, (_, parts))| (object, parts)).collect()
    }

    /// The solid surfaces that are seen and may lie in a mask's shadow; their instances are appended to `instances`.
    pub(crate) fn mask_receivers(
        &self,
        shadow: &Shadow,
        owner: u32,
        instances: &mut Vec<GpuInstance>,
    ) -> Vec<ReceiverBatch> {
        let mut batches: Vec<ReceiverBatch> = Vec::new();
        let receivers = self.items.iter().filter(|item| item.roles.receiver && item.object != owner);
        for item in receivers.filter(|item| !item.variant.blend) {
            let Some(on_screen) = shadow.on(&item.bounds_world) else { continue };
            let at = instances.len() as u32;
            instances.push(GpuInstance::new(&item.world_from_object));
            match batches.last_mut() {
                Some(last) if last.mesh == item.mesh && last.instances.end == at => {
                    last.instances.end = at + 1;
                    last.on_screen = last.on_screen.union(on_screen);
                }
                _ => batches.push(ReceiverBatch { mesh: item.mesh, instances: at..at + 1, on_screen }),
            }
        }
        batches
    }

    /// Boxes of everything that shadows may fall on, each with its object; world space.
    pub(crate) fn mask_boxes(&self) -> impl Iterator<Item = (u32, Aabb)> {
        let receivers = self.items.iter().filter(|item| item.roles.receiver);
        receivers.map(|item| (item.object, item.bounds_world))
    }

    /// The objects of the instances that [`Self::solid`] and [`Self::blended`] list, in the same order.
    pub fn objects(&self, frustum: &Frustum, eye: Vec3) -> Vec<u32> {
        let solid = self.items.iter().filter(|i| !i.variant.blend && frustum.may_see(&i.bounds_world));
        solid.chain(self.blended_items(frustum, eye)).map(|item| item.object).collect()
    }

    /// Everything that may throw a shadow in a light's view; with `all` also what can be shown to shadow nothing. `cull` is the
    /// pass's; with `by_map` only those that nothing but maps can draw.
    pub fn casters(
        &self,
        (light, view): (&Light, &ShadowView),
        all: bool,
        by_map: bool,
        cull: Cull,
        instances: &mut Vec<GpuInstance>,
    ) -> Vec<Batch> {
        let frustum = view.caster_frustum(light);
        let in_front = |bounds: &Aabb| {
            bounds.corners().iter().all(|p| -view.light_from_world.transform_point3(*p).z > view.near_m)
        };
        let tolerance_m = 1e-6 * self.whole().size().max_element();
        let in_cone = |bounds: &Aabb| match light.kind {
            LightKind::Spot { outer_rad, .. } => {
                cone_may_see(light.position_world, light.direction_world.normalize(), outer_rad, bounds)
            }
            _ => true,
        };
        // What shadows nothing may still be what lies behind the nearest surface.
        let layered = cull == Cull::Nothing;
        let is_needed = |item: &Item| {
            all || (in_cone(&item.bounds_world) && (layered || !self.is_idle(light, item, tolerance_m)))
        };
        let one_sided = |item: &Item| match cull {
            Cull::BackOfClosed => item.closed && in_front(&item.bounds_world),
            // What enters through a hole may meet the inside of a back face. Where the near plane, or the light itself, is inside
            // of a solid, the way out is still through its back faces.
            Cull::FrontOfClosed => item.closed && !item.cut_out,
            Cull::Front | Cull::Back | Cull::Nothing | Cull::ByMaterial => false,
        };
        let of_kind = self.items.iter().filter(|item| item.roles.blocker && (item.by_map || !by_map));
        let seen = of_kind.filter(|item| frustum.may_see(&item.bounds_world) && is_needed(item));
        batches(seen.map(|item| (item, one_sided(item))), instances)
    }
}

/// Joins neighbours of the same mesh and state.
fn batches<'a>(
    items: impl Iterator<Item = (&'a Item, bool)>,
    instances: &mut Vec<GpuInstance>,
) -> Vec<Batch> {
    let mut batches: Vec<Batch> = Vec::new();
    for (item, one_sided) in items {
        let at = instances.len() as u32;
        instances.push(GpuInstance::new(&item.world_from_object));
        match batches.last_mut() {
            Some(last)
                if (last.mesh, last.variant, last.one_sided) == (item.mesh, item.variant, one_sided) =>
            {
                last.instances.end = at + 1;
            }
            _ => batches.push(Batch {
                mesh: item.mesh,
                variant: item.variant,
                one_sided,
                instances: at..at + 1,
            }),
        }
    }
    batches
}

/// The closed-mesh check of second-depth maps: what a user must know of casters that have no way out. `casters` are the draws of
/// each view.
pub fn open_casters(names: &[String], settings: &Settings, casters: &[Vec<Batch>]) -> Option<String> {
    const NAMED: usize = 8;
    if settings.combination().is_none_or(|c| c.bias != Bias::SecondDepth) {
        return None;
    }
    let mut meshes: Vec<usize> = casters.iter().flatten().filter(|b| !b.one_sided).map(|b| b.mesh).collect();
    meshes.sort_unstable();
    meshes.dedup();
    let name = |mesh: &usize| match names[*mesh].as_str() {
        "" => format!("mesh {mesh}"),
        name => format!("`{name}`"),
    };
    let named: Vec<String> = meshes.iter().take(NAMED).map(name).collect();
    let more =
        if meshes.len() > NAMED { format!(" and {} more", meshes.len() - NAMED) } else { String::new() };
    (!meshes.is_empty()).then(|| {
        format!(
            "closed-mesh check: second-depth maps hold back faces only, and these casters are not closed solids (open edges, \
             faces turned against each other, cut out, or deformed): {}{more}; both of their sides are drawn, so they may \
             shadow themselves; use bias=midpoint or bias=auto",
            named.join(", ")
        )
    })
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
