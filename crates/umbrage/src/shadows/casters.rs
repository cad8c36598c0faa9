//! Casters and receivers: where each is, and which of them move.

use super::ShadowsError;
use super::handles::{Id, Store, index};
use super::lights::draws;
use super::meshes::{Mesh, is_finite};
use crate::caster::GpuInstance;
use glam::{Mat4, Vec3};
use slotmap::DefaultKey;
use umbrage_core::Aabb;
use umbrage_core::technique::Family;

/// A caster.
#[derive(Debug)]
pub(super) struct Caster {
    /// What is drawn; `None`: the caller draws it.
    pub mesh: Option<Id>,
    pub world_from_object: Mat4,
    pub placed: GpuInstance,
    pub bounds_world: Aabb,
    pub mirrored: bool,
    /// Another number after each move, and for each caster: whoever gets the place of a removed one is not taken for it.
    pub stamp: u64,
    /// Is it drawn over what stands still?
    pub moving: bool,
    /// Frame of its last move.
    moved_at: u64,
    /// Is it in the list of what changed since the last frame?
    touched: bool,
    /// Where it was when it was last drawn as standing still.
    still_bounds: Option<Aabb>,
    /// What fits leave room for, so that they hold while it moves.
    pub room_world: Aabb,
}

/// What receives shadows and casts none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Receiver {
    pub bounds_world: Aabb,
    /// What is drawn where receivers are drawn once more.
    pub mesh: Option<Id>,
    pub placed: GpuInstance,
}

/// What became of casters since the last frame.
#[derive(Debug, Default)]
pub(super) struct Changes {
    /// Boxes where something that stood still is there no more, or is new: views of them are drawn whole.
    pub still: Vec<Aabb>,
    /// Boxes that fits may have no room for yet.
    pub room: Vec<Aabb>,
    /// Some caster began to move, moved, or stands still again.
    pub moving: bool,
    /// Casters that stand still again.
    pub settled: Vec<DefaultKey>,
    /// How many moved.
    pub moved: u64,
    /// Something is gone, and fits may be tighter.
    pub loose: bool,
    /// So many are new that all is fitted and drawn anew.
    pub all: bool,
}

impl Changes {
    pub fn clear(&mut self) {
        self.still.clear();
        self.room.clear();
        self.settled.clear();
        (self.moving, self.loose, self.all, self.moved) = (false, false, false, 0);
    }
}

/// All casters and receivers.
#[derive(Debug)]
pub(super) struct Casters {
    pub all: Store<Caster>,
    pub receivers: Store<Receiver>,
    /// By mesh and winding, so that neighbours go into one draw.
    order: Vec<DefaultKey>,
    order_is_stale: bool,
    /// Those that move, in the same order.
    pub moving: Vec<DefaultKey>,
    touched: Vec<DefaultKey>,
    pub changes: Changes,
    frame: u64,
    /// The last that was given.
    stamp: u64,
}

/// Room around a moving box: half of its size on each side, so that fits hold for some frames.
fn with_room(bounds: &Aabb) -> Aabb {
    let room = Vec3::splat(0.5 * bounds.size().max_element());
    Aabb { min: bounds.min - room, max: bounds.max + room }
}

fn holds(outer: &Aabb, inner: &Aabb) -> bool {
    outer.min.cmple(inner.min).all() && outer.max.cmpge(inner.max).all()
}

/// Refuses what is no place.
pub(super) fn check_transform(world_from_object: &Mat4) -> Result<(), ShadowsError> {
    let is_affine = world_from_object.is_finite() && world_from_object.row(3) == glam::Vec4::W;
    if is_affine {
        return Ok(());
    }
    Err(ShadowsError::Number {
        what: "caster's world_from_object",
        value: format!("{world_from_object}"),
        allowed: "finite and affine (its last row 0, 0, 0, 1)",
    })
}

/// Refuses what is no box.
pub(super) fn check_box(what: &'static str, bounds_world: &Aabb) -> Result<(), ShadowsError> {
    if is_finite(bounds_world) && !bounds_world.is_empty() {
        return Ok(());
    }
    let value = format!("{:?}", (bounds_world.min, bounds_world.max));
    Err(ShadowsError::Number { what, value, allowed: "finite, its corners in order" })
}

impl Casters {
    pub fn new(of: u32) -> Self {
        Self {
            all: Store::new("caster", of),
            receivers: Store::new("receiver", of),
            order: Vec::new(),
            order_is_stale: false,
            moving: Vec::new(),
            touched: Vec::new(),
            changes: Changes::default(),
            frame: 0,
            stamp: 0,
        }
    }

    pub fn add(&mut self, mesh: Option<Id>, world_from_object: Mat4, bounds_world: Aabb) -> Id {
        self.stamp += 1;
        let id = self.all.insert(Caster {
            mesh,
            world_from_object,
            placed: GpuInstance::new(&world_from_object),
            bounds_world,
            mirrored: umbrage_core::volume::is_mirrored(&world_from_object),
            stamp: self.stamp,
            moving: false,
            moved_at: self.frame,
            touched: true,
            still_bounds: None,
            room_world: bounds_world,
        });
        self.touched.push(id.key);
        self.order_is_stale = true;
        id
    }

    /// Puts a caster elsewhere.
    pub fn place(&mut self, id: Id, world_from_object: Mat4, bounds_world: Aabb) -> Result<(), ShadowsError> {
        let caster = self.all.get_mut(id)?;
        let mirrored = umbrage_core::volume::is_mirrored(&world_from_object);
        self.order_is_stale |= mirrored != caster.mirrored;
        caster.world_from_object = world_from_object;
        caster.placed = GpuInstance::new(&world_from_object);
        (caster.bounds_world, caster.mirrored) = (bounds_world, mirrored);
        self.touch(id.key);
        Ok(())
    }

    /// Says that a caster is not as it was.
    pub fn touch(&mut self, key: DefaultKey) {
        let Some(caster) = self.all.at_mut(key) else { return };
        self.stamp += 1;
        caster.stamp = self.stamp;
        caster.moved_at = self.frame + 1;
        if !std::mem::replace(&mut caster.touched, true) {
            self.touched.push(key);
        }
    }

    pub fn remove(&mut self, id: Id) -> Result<Caster, ShadowsError> {
        let removed = self.all.remove(id)?;
        self.changes.still.extend(removed.still_bounds);
        self.changes.loose = true;
        if removed.moving {
            self.moving.retain(|key| *key != id.key);
            self.changes.moving = true;
        }
        self.order_is_stale = true;
        Ok(removed)
    }

    pub fn add_receiver(&mut self, receiver: Receiver) -> Id {
        self.changes.room.push(receiver.bounds_world);
        self.changes.still.extend(receiver.mesh.map(|_| receiver.bounds_world));
        self.receivers.insert(receiver)
    }

    pub fn place_receiver(&mut self, id: Id, receiver: Receiver) -> Result<(), ShadowsError> {
        let known = self.receivers.get_mut(id)?;
        if *known != receiver {
            // Maps that hold what lies behind casters hold receivers, too.
            let drawn = receiver.mesh.map(|_| [known.bounds_world, receiver.bounds_world]);
            self.changes.still.extend(drawn.into_iter().flatten());
            *known = receiver;
            self.changes.room.push(receiver.bounds_world);
            self.changes.loose = true;
        }
        Ok(())
    }

    pub fn remove_receiver(&mut self, id: Id) -> Result<Receiver, ShadowsError> {
        let removed = self.receivers.remove(id)?;
        self.changes.still.extend(removed.mesh.map(|_| removed.bounds_world));
        self.changes.loose = true;
        Ok(removed)
    }

    /// Begins a frame: sorts what changed into what moves and what stands still. `false`: nothing changed at all. The cost is
    /// that of what changed and of what moves.
    pub fn begin(&mut self, still_frames: u64) -> bool {
        self.frame += 1;
        let Self { all, moving, touched, changes, .. } = self;
        let is_new = |key: &DefaultKey| all.at(*key).is_some_and(|c| !c.moving && c.still_bounds.is_none());
        let new = touched.iter().filter(|key| is_new(key)).count();
        // What is there from the start, or comes in crowds, stands still until it moves.
        let stands = new > 64 && 4 * new > all.len() || self.frame == 1;
        changes.all |= stands && new > 0;
        let mut resort = false;
        for key in touched.drain(..) {
            let Some(caster) = all.at_mut(key) else { continue };
            caster.touched = false;
            changes.moved += 1;
            let is_new = !caster.moving && caster.still_bounds.is_none();
            if is_new && stands {
                caster.still_bounds = Some(caster.bounds_world);
                caster.room_world = caster.bounds_world;
                continue;
            }
            changes.moving = true;
            if !caster.moving {
                changes.still.extend(caster.still_bounds.take());
                caster.moving = true;
                moving.push(key);
                resort = true;
            }
            if is_new || !holds(&caster.room_world, &caster.bounds_world) {
                caster.room_world = with_room(&caster.bounds_world);
                changes.room.push(caster.room_world);
            }
        }
        self.settle(still_frames);
        if resort || (self.order_is_stale && !self.moving.is_empty()) {
            let all = &self.all;
            self.moving.sort_unstable_by_key(|key| place_in_order(all, *key));
        }
        self.has_changed()
    }

    /// Lets what did not move for long stand still again: all at once and seldom, because what stands still is then drawn anew
    /// where something else moves.
    fn settle(&mut self, still_frames: u64) {
        if self.moving.is_empty() || !self.frame.is_multiple_of(still_frames.max(1)) {
            return;
        }
        let (all, changes, frame) = (&mut self.all, &mut self.changes, self.frame);
        self.moving.retain(|key| {
            let Some(caster) = all.at_mut(*key) else { return false };
            if caster.moved_at + still_frames > frame {
                return true;
            }
            caster.moving = false;
            caster.still_bounds = Some(caster.bounds_world);
            changes.settled.push(*key);
            changes.moving = true;
            false
        });
    }

    /// All that stand still, neighbours of one mesh together.
    pub fn still(&mut self) -> impl Iterator<Item = (DefaultKey, &Caster)> {
        if std::mem::replace(&mut self.order_is_stale, false) {
            self.order.clear();
            self.order.extend(self.all.iter().map(|(key, _)| key));
            let all = &self.all;
            self.order.sort_unstable_by_key(|key| place_in_order(all, *key));
        }
        let of = |key: &DefaultKey| Some((*key, self.all.at(*key)?));
        self.order.iter().filter_map(of).filter(|(_, caster)| !caster.moving)
    }

    /// Did anything change since the last frame?
    pub fn has_changed(&self) -> bool {
        let changes = &self.changes;
        changes.all
            || changes.moving
            || changes.loose
            || !changes.still.is_empty()
            || !changes.room.is_empty()
    }

    /// Are there casters that a family cannot draw? Counted when casters were added, removed or changed.
    pub fn left_to_maps(&self, meshes: &Store<Mesh>, family: Family) -> bool {
        match family {
            Family::None => false,
            Family::Map => true,
            _ => {
                let mesh_of = |caster: &Caster| caster.mesh.and_then(|mesh| meshes.at(mesh.key));
                self.all.iter().any(|(_, caster)| !draws(family, mesh_of(caster)))
            }
        }
    }

    /// Boxes of all that casts or receives, with room for what moves.
    pub fn boxes_world(&self, boxes: &mut Vec<Aabb>) {
        boxes.clear();
        boxes.extend(self.all.iter().map(|(_, caster)| caster.room_world));
        boxes.extend(self.receivers.iter().map(|(_, receiver)| receiver.bounds_world));
    }
}

fn place_in_order(all: &Store<Caster>, key: DefaultKey) -> (Option<DefaultKey>, bool, usize) {
    let caster = all.at(key);
    (caster.and_then(|c| c.mesh).map(|mesh| mesh.key), caster.is_some_and(|c| c.mirrored), index(key))
}
