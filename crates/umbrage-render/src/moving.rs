//! What may move between frames, and how a renderer is told.

use crate::draw_list::Items;
use crate::{RenderError, Renderer};
use glam::{Mat4, Vec4};
use std::mem::discriminant;
use std::sync::Arc;
use umbrage::core::{Camera, Light};
use umbrage_scene::{Mesh, SceneLight};

/// Everything that may move.
#[derive(Clone, Debug)]
pub(crate) struct World {
    pub items: Items,
    pub lights: Vec<SceneLight>,
    pub camera: Camera,
    pub time_s: f32,
    /// Counts how often each mesh got other vertices.
    pub mesh_versions: Vec<u64>,
    /// Counts all changes.
    pub version: u64,
}

/// Changes are kept until the next [`Renderer::frame`], which fits, culls and uploads once for all of them; then a frame
/// after changes costs what [`Renderer::new`] spends on fits and draw lists, and nothing for pipelines, geometry,
/// textures and targets, which stay. Exposure stays as it was found at the start: a picture must not flicker because
/// something moves.
impl Renderer<'_> {
    /// Looks from elsewhere. No map of a `fitted` view is drawn again for that.
    ///
    /// # Errors
    /// [`RenderError::Camera`] names the number that cannot be used.
    pub fn set_camera(&mut self, camera: &Camera) -> Result<(), RenderError> {
        camera.check().map_err(RenderError::Camera)?;
        self.change().camera = *camera;
        Ok(())
    }

    /// Changes a light: place, direction, colour, intensity, cone, range. Its kind and what kind of shape it has stay,
    /// because the shaders are made for them.
    ///
    /// # Errors
    /// [`RenderError::Change`] for a light that is not there or would be of another kind; [`RenderError::Light`] for
    /// numbers that cannot be used.
    pub fn set_light(&mut self, index: usize, light: &Light) -> Result<(), RenderError> {
        let count = self.world.lights.len();
        let Some(old) = self.world.lights.get(index).map(|placed| placed.light) else {
            return Err(nothing_there("light", index, count));
        };
        light.check()?;
        if discriminant(&old.kind) != discriminant(&light.kind)
            || discriminant(&old.shape) != discriminant(&light.shape)
        {
            return Err(RenderError::Change(format!(
                "light {index} is a {} light and stays one, of the same kind of shape; make a new renderer for another",
                old.kind.id()
            )));
        }
        self.change().lights[index].light = *light;
        Ok(())
    }

    /// Moves an instance of the scene.
    ///
    /// # Errors
    /// [`RenderError::Change`] for an instance that is not there, or a matrix that is not finite and affine.
    pub fn place(&mut self, instance: usize, world_from_object: Mat4) -> Result<(), RenderError> {
        let count = self.world.items.len();
        if instance >= count {
            return Err(nothing_there("instance", instance, count));
        }
        if !world_from_object.is_finite() || world_from_object.row(3) != Vec4::W {
            return Err(RenderError::Change(format!(
                "instance {instance} cannot be placed there: the matrix must be finite and its last row 0 0 0 1"
            )));
        }
        self.change().items.place(instance, world_from_object);
        Ok(())
    }

    /// Gives a mesh other positions, normals, tangents and bounds: those of the same mesh posed otherwise, as
    /// [`umbrage_scene::load_at`] reads it at another time. Copies the vertices to the GPU, and looks at all triangles to
    /// tell whether it is flat or closed.
    ///
    /// # Errors
    /// [`RenderError::Change`] for a mesh that is not there, of other counts, or with positions that are not finite.
    pub fn set_mesh(&mut self, index: usize, mesh: &Mesh) -> Result<(), RenderError> {
        let Some(range) = self.geometry.meshes.get(index) else {
            return Err(nothing_there("mesh", index, self.geometry.meshes.len()));
        };
        let refused =
            |what: String| Err(RenderError::Change(format!("mesh {index} cannot be posed so: {what}")));
        let (vertices, normals) = (mesh.positions.len(), mesh.normals.len());
        let (had, indices) = (range.vertices as usize, range.indices.len());
        if vertices != had || normals != had || mesh.indices.len() != indices {
            let got = mesh.indices.len();
            return refused(format!(
                "it has {had} vertices and {indices} indices, not {vertices} (with {normals} normals) and {got}; pose the same mesh"
            ));
        }
        if !mesh.positions.iter().all(|p| p.is_finite()) {
            return refused("a position is not finite; check the pose".into());
        }
        self.geometry.repose(&self.gpu.queue, index, mesh);
        if let Some(masks) = &mut self.masks {
            masks.reshape(index, mesh);
        }
        if let Some(volumes) = &mut self.volumes {
            volumes.reshape(index, mesh);
        }
        let world = self.change();
        world.items.reshape(index, mesh);
        world.mesh_versions[index] += 1;
        Ok(())
    }

    /// Tells [`crate::RenderOptions::deform`] another time, seconds. Maps are drawn again for that only where there is
    /// such a function.
    ///
    /// # Errors
    /// [`RenderError::Change`] for a time that is not finite.
    pub fn set_time(&mut self, time_s: f32) -> Result<(), RenderError> {
        if !time_s.is_finite() {
            return Err(RenderError::Change(format!("the time {time_s} s is not finite; give seconds")));
        }
        self.change().time_s = time_s;
        Ok(())
    }

    /// The world, to be changed. A thread that draws maps of it keeps its own copy.
    fn change(&mut self) -> &mut World {
        let world = Arc::make_mut(&mut self.world);
        world.version += 1;
        world
    }
}

fn nothing_there(what: &str, index: usize, count: usize) -> RenderError {
    RenderError::Change(format!("there is no {what} {index}; the scene has {count}, counted from 0"))
}
