//! The views of lights: what each draws, what it holds, and whether that is what it should hold.

use super::casters::{Caster, Casters};
use super::handles::{CasterHandle, Id, Store, index};
use super::lights::draws;
use super::meshes::Mesh;
use crate::caster::GpuInstance;
use crate::growing::Growing;
use slotmap::DefaultKey;
use std::ops::Range;
use umbrage_core::fit::ShadowView;
use umbrage_core::plan::Cull;
use umbrage_core::technique::Family;
use umbrage_core::{Aabb, Frustum, Light, LightKind, cone_may_see};

/// Which pipeline draws a caster.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum How {
    /// All faces.
    Open,
    /// Without the side that the pass leaves out.
    Closed,
    /// The same, wound the other way.
    ClosedMirrored,
    /// With holes.
    CutOut,
}

/// One draw.
#[derive(Clone, Debug)]
pub(super) struct Draw {
    pub mesh: Id,
    pub how: How,
    pub instances: Range<u32>,
}

/// Draws, and what the caller draws.
#[derive(Debug, Default)]
pub(super) struct Draws {
    pub list: Vec<Draw>,
    /// Those that let light through, where the technique colours it.
    pub translucent: Vec<Draw>,
    pub own: Vec<CasterHandle>,
    pub triangles: u64,
}

impl Draws {
    fn clear(&mut self) {
        self.list.clear();
        self.translucent.clear();
        self.own.clear();
        self.triangles = 0;
    }

    fn push(list: &mut Vec<Draw>, mesh: Id, how: How, at: u32) {
        match list.last_mut() {
            Some(last) if (last.mesh, last.how, last.instances.end) == (mesh, how, at) => {
                last.instances.end = at + 1;
            }
            _ => list.push(Draw { mesh, how, instances: at..at + 1 }),
        }
    }
}

/// Still casters, drawn once to be copied below what moves.
#[derive(Debug)]
pub(super) struct Kept {
    pub texture: wgpu::Texture,
    pub view: wgpu::TextureView,
    /// Does it hold what stands still?
    pub holds: bool,
}

/// One view of a light.
#[derive(Debug)]
pub(super) struct View {
    pub view: ShadowView,
    /// The light, at the place of this view.
    pub light: Light,
    pub layer: u32,
    frustum: Frustum,
    /// What stands still, its instances, and whether the list is out of date.
    pub still: Draws,
    pub still_placed: Growing,
    pub still_list_is_stale: bool,
    /// What moves: numbers and stamps.
    pub moving: Vec<(usize, u64)>,
    pub moving_draws: Draws,
    pub kept: Option<Kept>,
    /// Does the map hold what it should?
    pub holds: bool,
    /// Has its matrix to be written?
    pub matrix_is_stale: bool,
}

/// What decides which casters a view draws, and how.
#[derive(Clone, Copy, Debug)]
pub(super) struct Drawn<'a> {
    pub meshes: &'a Store<Mesh>,
    pub cull: Cull,
    /// Do translucent casters colour light?
    pub colored: bool,
    /// The light's own family, which leaves to maps what it cannot draw.
    pub family: Family,
    /// What else it leaves to maps, by number.
    pub left: &'a [usize],
}

impl Drawn<'_> {
    /// Do maps draw a caster?
    fn takes(&self, key: DefaultKey, caster: &Caster) -> bool {
        let mesh = caster.mesh.and_then(|mesh| self.meshes.at(mesh.key));
        matches!(self.family, Family::None | Family::Map)
            || !draws(self.family, mesh)
            || self.left.contains(&index(key))
    }
}

impl View {
    pub fn new(device: &wgpu::Device, (light, view): (Light, ShadowView), layer: u32) -> Self {
        Self {
            frustum: view.caster_frustum(&light),
            view,
            light,
            layer,
            still: Draws::default(),
            still_placed: Growing::new(device, "umbrage still casters", wgpu::BufferUsages::VERTEX, 0),
            still_list_is_stale: true,
            moving: Vec::new(),
            moving_draws: Draws::default(),
            kept: None,
            holds: false,
            matrix_is_stale: true,
        }
    }

    /// Looks from elsewhere.
    pub fn aim(&mut self, (light, view): (Light, ShadowView)) {
        if (self.light, self.view) == (light, view) {
            return;
        }
        self.frustum = view.caster_frustum(&light);
        (self.light, self.view) = (light, view);
        self.matrix_is_stale = true;
        self.redraw();
    }

    /// All of it has to be listed and drawn anew.
    pub fn redraw(&mut self) {
        self.still_list_is_stale = true;
        self.holds = false;
        self.kept.iter_mut().for_each(|kept| kept.holds = false);
    }

    /// May it hold something of a box?
    pub fn may_see(&self, bounds_world: &Aabb) -> bool {
        let in_cone = match self.light.kind {
            LightKind::Spot { outer_rad, .. } => cone_may_see(
                self.light.position_world,
                self.light.direction_world.normalize_or_zero(),
                outer_rad,
                bounds_world,
            ),
            _ => true,
        };
        in_cone && !bounds_world.is_empty() && self.frustum.may_see(bounds_world)
    }

    /// Is there room for a box, or for what of it lies in the light's reach? Of parallel light all of it has to be inside; of a cone
    /// its distance along the axis.
    pub fn has_room_for(&self, bounds_world: &Aabb) -> bool {
        let view = &self.view;
        if view.perspective && !view.frustum().without_depth().may_see(bounds_world) {
            return true;
        }
        let along = bounds_world.corners().map(|p| -view.light_from_world.transform_point3(p).z);
        let nearest = along.into_iter().fold(f32::INFINITY, f32::min);
        let farthest = along.into_iter().fold(f32::NEG_INFINITY, f32::max);
        if view.perspective {
            let reach_m = self.light.far_m.or(self.light.range_m).unwrap_or(f32::INFINITY);
            let least_m = if self.light.near_m.is_some() { f32::INFINITY } else { nearest.max(0.0) };
            return farthest.min(reach_m) <= view.far_m
                && (least_m >= view.near_m || view.near_m <= 1.01e-4 * view.far_m);
        }
        let clip_from_world = view.clip_from_world();
        let is_inside = |p: &glam::Vec3| {
            let clip = clip_from_world.transform_point3(*p);
            clip.x.abs().max(clip.y.abs()) <= 1.0
        };
        nearest >= view.near_m && farthest <= view.far_m && bounds_world.corners().iter().all(is_inside)
    }

    fn how(&self, caster: &Caster, mesh: &Mesh, cull: Cull) -> How {
        let in_front = || {
            let corners = caster.bounds_world.corners();
            corners.iter().all(|p| -self.view.light_from_world.transform_point3(*p).z > self.view.near_m)
        };
        let one_sided = match cull {
            Cull::BackOfClosed => mesh.closed && in_front(),
            Cull::FrontOfClosed => mesh.closed,
            Cull::Front | Cull::Back | Cull::Nothing | Cull::ByMaterial => false,
        };
        match (mesh.cut_out.is_some(), one_sided, caster.mirrored) {
            (true, ..) => How::CutOut,
            (_, true, false) => How::Closed,
            (_, true, true) => How::ClosedMirrored,
            _ => How::Open,
        }
    }

    fn list(
        &self,
        draws: &mut Draws,
        (key, caster): (DefaultKey, &Caster),
        drawn: &Drawn<'_>,
        placed: &mut Vec<GpuInstance>,
        of: Id,
    ) {
        let Some(id) = caster.mesh else {
            draws.own.push(CasterHandle(Id { key, ..of }));
            return;
        };
        let Some(mesh) = drawn.meshes.at(id.key) else { return };
        let at = placed.len() as u32;
        placed.push(caster.placed);
        draws.triangles += mesh.triangles();
        if drawn.colored && mesh.translucent.is_some() {
            Draws::push(&mut draws.translucent, id, How::Open, at);
        } else {
            Draws::push(&mut draws.list, id, self.how(caster, mesh, drawn.cull), at);
        }
    }

    /// Finds which of the moving casters it sees; those that it holds it need not draw again.
    pub fn look_for_moving(&mut self, casters: &Casters, drawn: &Drawn<'_>, seen: &mut Vec<(usize, u64)>) {
        seen.clear();
        for key in &casters.moving {
            let Some(caster) = casters.all.at(*key) else { continue };
            if drawn.takes(*key, caster) && self.may_see(&caster.bounds_world) {
                seen.push((index(*key), caster.stamp));
            }
        }
        if *seen != self.moving {
            std::mem::swap(seen, &mut self.moving);
            self.holds = false;
        }
    }

    /// What moved and now stands still is the same picture, drawn in another order.
    pub fn let_stand(&mut self, settled: &[DefaultKey], casters: &Casters) {
        let before = self.moving.len();
        self.moving.retain(|(number, _)| !settled.iter().any(|key| index(*key) == *number));
        let seen = self.moving.len() != before
            || settled.iter().any(|key| casters.all.at(*key).is_some_and(|c| self.may_see(&c.bounds_world)));
        if seen {
            self.still_list_is_stale = true;
            self.kept.iter_mut().for_each(|kept| kept.holds = false);
        }
    }

    /// Lists what stands still, if that changed, and hands it to the GPU; the bytes.
    pub fn list_still(
        &mut self,
        (device, queue): (&wgpu::Device, &wgpu::Queue),
        casters: &mut Casters,
        drawn: &Drawn<'_>,
        placed: &mut Vec<GpuInstance>,
    ) -> u64 {
        if !std::mem::replace(&mut self.still_list_is_stale, false) {
            return 0;
        }
        let mut draws = std::mem::take(&mut self.still);
        draws.clear();
        placed.clear();
        let of = casters.all.id(DefaultKey::default());
        for (key, caster) in casters.still() {
            if drawn.takes(key, caster) && self.may_see(&caster.bounds_world) {
                self.list(&mut draws, (key, caster), drawn, placed, of);
            }
        }
        // What shadows nothing may still be what lies behind the nearest surface.
        if drawn.cull == Cull::Nothing {
            for (_, receiver) in casters.receivers.iter().filter(|(_, r)| self.may_see(&r.bounds_world)) {
                let Some(id) = receiver.mesh else { continue };
                Draws::push(&mut draws.list, id, How::Open, placed.len() as u32);
                placed.push(receiver.placed);
                draws.triangles += drawn.meshes.at(id.key).map_or(0, Mesh::triangles);
            }
        }
        self.still = draws;
        let bytes: &[u8] = bytemuck::cast_slice(placed);
        self.still_placed.write(device, queue, bytes);
        bytes.len() as u64
    }

    /// Lists what moves, its instances after those that are in `placed`.
    pub fn list_moving(&mut self, casters: &Casters, drawn: &Drawn<'_>, placed: &mut Vec<GpuInstance>) {
        let mut draws = std::mem::take(&mut self.moving_draws);
        draws.clear();
        let of = casters.all.id(DefaultKey::default());
        // `moving` lists some of the moving casters in their order.
        let mut wanted = self.moving.iter().map(|(number, _)| *number).peekable();
        for key in &casters.moving {
            if wanted.next_if_eq(&index(*key)).is_none() {
                continue;
            }
            let Some(caster) = casters.all.at(*key) else { continue };
            self.list(&mut draws, (*key, caster), drawn, placed, of);
        }
        self.moving_draws = draws;
    }
}
