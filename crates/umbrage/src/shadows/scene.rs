//! What casts and what receives: added, moved and removed by handle.

use super::casters::{Receiver, check_box, check_transform};
use super::handles::index;
use super::meshes::Mesh;
use super::{CasterHandle, CasterMesh, MeshHandle, ReceiverHandle, Shadows, ShadowsError};
use crate::caster::GpuInstance;
use glam::{Mat4, Vec3};
use umbrage_core::Aabb;

impl Shadows {
    /// Adds a mesh. Its buffers are kept until it is removed.
    ///
    /// # Errors
    /// [`ShadowsError::Buffer`] when a buffer cannot be read so, [`ShadowsError::ForeignDevice`], [`ShadowsError::Number`].
    pub fn add_mesh(&mut self, mesh: &CasterMesh<'_>) -> Result<MeshHandle, ShadowsError> {
        let made = Mesh::new(&self.device, &self.cut_out_layout, mesh)?;
        let id = self.meshes.insert(made);
        if let Some((positions, indices)) = mesh.shape_on_cpu() {
            self.keep_shape(MeshHandle(id), positions, indices).inspect_err(|_| {
                // It was not there before, and so it goes.
                let _ = self.meshes.remove(id);
            })?;
        }
        Ok(MeshHandle(id))
    }

    fn keep_shape(
        &mut self,
        mesh: MeshHandle,
        positions: &[Vec3],
        indices: &[u32],
    ) -> Result<(), ShadowsError> {
        let number = index(mesh.0.key);
        match self.screen.as_mut().filter(|_| self.declared.volumes) {
            Some(screen) => screen.set_shape(number, positions, indices),
            None => Ok(()),
        }
    }

    /// Gives a mesh another shape for shadow volumes, after [`Shadows::reshape_mesh`]: until then, lights whose technique makes
    /// volumes draw it into a map. Cost: its edges are found anew, 0.4 microseconds a triangle.
    ///
    /// # Errors
    /// [`ShadowsError::Volume`] for one too large, [`ShadowsError::Removed`], [`ShadowsError::OfAnother`].
    pub fn set_shape(
        &mut self,
        mesh: MeshHandle,
        positions: &[Vec3],
        indices: &[u32],
    ) -> Result<(), ShadowsError> {
        self.meshes.get(mesh.0)?;
        self.keep_shape(mesh, positions, indices)?;
        self.meshes.get_mut(mesh.0)?.has_shape = true;
        Ok(())
    }

    /// Says that the vertices in a mesh's buffers are others now, inside of `bounds_object`: all its casters count as moved, and its
    /// shape is forgotten ([`Shadows::set_shape`]). Cost:
    /// proportional to the number of casters.
    ///
    /// # Errors
    /// [`ShadowsError::Removed`], [`ShadowsError::OfAnother`], [`ShadowsError::Number`].
    pub fn reshape_mesh(&mut self, mesh: MeshHandle, bounds_object: Aabb) -> Result<(), ShadowsError> {
        check_box("mesh's box", &bounds_object)?;
        let changed = self.meshes.get_mut(mesh.0)?;
        changed.bounds_object = bounds_object;
        changed.version += 1;
        changed.has_shape = false;
        let users = self.casters.all.iter().filter(|(_, caster)| caster.mesh == Some(mesh.0));
        let users: Vec<_> = users.map(|(key, caster)| (key, caster.world_from_object)).collect();
        for (key, world_from_object) in users {
            let bounds_world = bounds_object.transformed(&world_from_object);
            self.casters.place(self.casters.all.id(key), world_from_object, bounds_world)?;
        }
        Ok(())
    }

    /// Forgets a mesh that no caster uses.
    ///
    /// # Errors
    /// [`ShadowsError::InUse`], [`ShadowsError::Removed`], [`ShadowsError::OfAnother`].
    pub fn remove_mesh(&mut self, mesh: MeshHandle) -> Result<(), ShadowsError> {
        let casters = self.meshes.get(mesh.0)?.casters;
        if casters > 0 {
            return Err(ShadowsError::InUse { casters });
        }
        self.meshes.remove(mesh.0)?;
        if let Some(screen) = &mut self.screen {
            screen.remove_shape(index(mesh.0.key));
        }
        self.is_prepared = false;
        Ok(())
    }

    /// Adds a caster: a mesh somewhere. It receives shadows, too, as far as fits are concerned.
    ///
    /// # Errors
    /// [`ShadowsError::Number`] for a transform that is not finite and affine, [`ShadowsError::Removed`],
    /// [`ShadowsError::OfAnother`].
    pub fn add_caster(
        &mut self,
        mesh: MeshHandle,
        world_from_object: Mat4,
    ) -> Result<CasterHandle, ShadowsError> {
        check_transform(&world_from_object)?;
        let of_mesh = self.meshes.get_mut(mesh.0)?;
        of_mesh.casters += 1;
        let bounds_world = of_mesh.bounds_object.transformed(&world_from_object);
        self.is_prepared = false;
        Ok(CasterHandle(self.casters.add(Some(mesh.0), world_from_object, bounds_world)))
    }

    /// Adds many casters of one mesh, in order.
    ///
    /// # Errors
    /// As [`Shadows::add_caster`]; none is added then.
    pub fn add_casters(
        &mut self,
        mesh: MeshHandle,
        world_from_object: impl IntoIterator<Item = Mat4>,
    ) -> Result<Vec<CasterHandle>, ShadowsError> {
        let placed: Vec<Mat4> = world_from_object.into_iter().collect();
        placed.iter().try_for_each(check_transform)?;
        placed.into_iter().map(|placed| self.add_caster(mesh, placed)).collect()
    }

    /// Adds a caster that the caller draws, in the closure of [`Shadows::record_with`]: what no mesh describes. Volumes and masks
    /// cannot be made of it; lights of these techniques draw it into a map.
    ///
    /// # Errors
    /// [`ShadowsError::Number`] for a box that is empty or not finite.
    pub fn add_own_caster(&mut self, bounds_world: Aabb) -> Result<CasterHandle, ShadowsError> {
        check_box("caster's box", &bounds_world)?;
        self.is_prepared = false;
        Ok(CasterHandle(self.casters.add(None, Mat4::IDENTITY, bounds_world)))
    }

    /// Moves a caster. Call it for those that moved only: the cost of a frame is that of what moved.
    ///
    /// # Errors
    /// [`ShadowsError::Number`], [`ShadowsError::Removed`], [`ShadowsError::OfAnother`].
    pub fn move_caster(&mut self, caster: CasterHandle, world_from_object: Mat4) -> Result<(), ShadowsError> {
        check_transform(&world_from_object)?;
        let Some(mesh) = self.casters.all.get(caster.0)?.mesh else {
            return Err(ShadowsError::Number {
                what: "caster that the caller draws",
                value: "without a mesh to move".into(),
                allowed: "moved with `move_own_caster`, which takes its box",
            });
        };
        let bounds_world = self.meshes.get(mesh)?.bounds_object.transformed(&world_from_object);
        self.casters.place(caster.0, world_from_object, bounds_world)
    }

    /// Says that a caster that the caller draws is elsewhere, or looks otherwise.
    ///
    /// # Errors
    /// [`ShadowsError::Number`], [`ShadowsError::Removed`], [`ShadowsError::OfAnother`].
    pub fn move_own_caster(&mut self, caster: CasterHandle, bounds_world: Aabb) -> Result<(), ShadowsError> {
        check_box("caster's box", &bounds_world)?;
        let world_from_object = self.casters.all.get(caster.0)?.world_from_object;
        self.casters.place(caster.0, world_from_object, bounds_world)
    }

    /// Removes a caster.
    ///
    /// # Errors
    /// [`ShadowsError::Removed`], [`ShadowsError::OfAnother`].
    pub fn remove_caster(&mut self, caster: CasterHandle) -> Result<(), ShadowsError> {
        let removed = self.casters.remove(caster.0)?;
        if let Some(mesh) = removed.mesh.and_then(|mesh| self.meshes.get_mut(mesh).ok()) {
            mesh.casters -= 1;
        }
        self.is_prepared = false;
        Ok(())
    }

    /// Adds a box in which something receives shadows and casts none: ground, walls. Maps of parallel light hold what is inside of
    /// casters and receivers, and nothing else.
    ///
    /// # Errors
    /// [`ShadowsError::Number`] for a box that is empty or not finite.
    pub fn add_receiver(&mut self, bounds_world: Aabb) -> Result<ReceiverHandle, ShadowsError> {
        check_box("receiver's box", &bounds_world)?;
        let placed = GpuInstance::new(&Mat4::IDENTITY);
        let receiver = Receiver { bounds_world, mesh: None, placed };
        Ok(ReceiverHandle(self.casters.add_receiver(receiver)))
    }

    /// The same with a mesh, for techniques that draw receivers: subtractive masks darken nothing that has none, and midpoint maps
    /// find there what lies behind casters that are not closed. It casts no shadow.
    ///
    /// # Errors
    /// [`ShadowsError::Number`] for a transform that is not finite and affine, [`ShadowsError::Removed`],
    /// [`ShadowsError::OfAnother`].
    pub fn add_receiver_mesh(
        &mut self,
        mesh: MeshHandle,
        world_from_object: Mat4,
    ) -> Result<ReceiverHandle, ShadowsError> {
        check_transform(&world_from_object)?;
        let of_mesh = self.meshes.get_mut(mesh.0)?;
        of_mesh.casters += 1;
        let bounds_world = of_mesh.bounds_object.transformed(&world_from_object);
        let placed = GpuInstance::new(&world_from_object);
        let receiver = Receiver { bounds_world, mesh: Some(mesh.0), placed };
        Ok(ReceiverHandle(self.casters.add_receiver(receiver)))
    }

    /// Moves a receiver without a mesh.
    ///
    /// # Errors
    /// [`ShadowsError::Number`], [`ShadowsError::Removed`], [`ShadowsError::OfAnother`].
    pub fn move_receiver(
        &mut self,
        receiver: ReceiverHandle,
        bounds_world: Aabb,
    ) -> Result<(), ShadowsError> {
        check_box("receiver's box", &bounds_world)?;
        let known = *self.casters.receivers.get(receiver.0)?;
        self.casters.place_receiver(receiver.0, Receiver { bounds_world, ..known })
    }

    /// Moves a receiver with a mesh.
    ///
    /// # Errors
    /// [`ShadowsError::Number`], also for a receiver without mesh; [`ShadowsError::Removed`], [`ShadowsError::OfAnother`].
    pub fn move_receiver_mesh(
        &mut self,
        receiver: ReceiverHandle,
        world_from_object: Mat4,
    ) -> Result<(), ShadowsError> {
        check_transform(&world_from_object)?;
        let known = *self.casters.receivers.get(receiver.0)?;
        let Some(mesh) = known.mesh else {
            return Err(ShadowsError::Number {
                what: "receiver",
                value: "without a mesh to move".into(),
                allowed: "moved with `move_receiver`, which takes its box",
            });
        };
        let bounds_world = self.meshes.get(mesh)?.bounds_object.transformed(&world_from_object);
        let placed = GpuInstance::new(&world_from_object);
        self.casters.place_receiver(receiver.0, Receiver { bounds_world, placed, ..known })
    }

    /// Removes a receiver.
    ///
    /// # Errors
    /// [`ShadowsError::Removed`], [`ShadowsError::OfAnother`].
    pub fn remove_receiver(&mut self, receiver: ReceiverHandle) -> Result<(), ShadowsError> {
        let removed = self.casters.remove_receiver(receiver.0)?;
        if let Some(mesh) = removed.mesh.and_then(|mesh| self.meshes.get_mut(mesh).ok()) {
            mesh.casters -= 1;
        }
        self.is_prepared = false;
        Ok(())
    }

    /// The number of a caster in the shader, for `umbrage_visibility_on`: it stays the same while the caster is there.
    ///
    /// # Errors
    /// [`ShadowsError::Removed`], [`ShadowsError::OfAnother`].
    pub fn caster_index(&self, handle: CasterHandle) -> Result<u32, ShadowsError> {
        self.casters.all.get(handle.0)?;
        Ok(index(handle.0.key) as u32)
    }
}
