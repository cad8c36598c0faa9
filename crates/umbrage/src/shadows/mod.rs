//! Shadows in somebody else's renderer: lights and casters by handle, any technique for each light, one bind group.
//!
//! Once: make a [`Shadows`] with your device, name your meshes' buffers ([`CasterMesh`]), add casters and lights. Put
//! [`Shadows::wgsl`] before your shader and [`Shadows::bind_group_layout`] into its pipeline. Each frame: say what moved, call
//! [`Shadows::prepare`], then [`Shadows::record`] with your encoder, and bind [`Shadows::bind_group`] where you light. In the shader,
//! `umbrage_visibility(light, p_world, normal, pixel)` is how much of a light a surface sees.
//!
//! Nothing here submits or waits. Where nothing moved, nothing is drawn, written or allocated.

mod casters;
mod casting;
mod error;
mod foreign;
mod frame;
mod handles;
mod lights;
mod masks;
mod meshes;
mod options;
mod pool;
mod prepare;
mod record;
mod screen;
mod table;
mod variants;
mod views;
mod visibility;
mod wgsl;

pub use error::ShadowsError;
pub use frame::Frame;
pub use handles::{CasterHandle, LightHandle, MeshHandle, ReceiverHandle};
pub use meshes::{CasterMesh, CutOut, Translucent};
pub use options::ShadowsOptions;
pub use prepare::{Prepared, ShadowsWarning};
pub use record::{OwnDraw, Recorded};

use crate::CasterPipelines;
use crate::caster::{GpuCasterView, GpuInstance};
use crate::growing::Growing;
use crate::maps::{comparison_sampler, point_sampler};
use casters::{Casters, check_box, check_transform};
use casting::Casting;
use glam::{Mat4, Vec3};
use handles::{Store, index};
use lights::Lit;
use masks::Masks;
use meshes::Mesh;
use pool::Pool;
use screen::Screen;
use std::hash::{BuildHasher, Hasher};
use std::num::NonZeroU64;
use table::{GpuLit, Table};
use umbrage_core::technique::Settings;
use umbrage_core::{Aabb, Light};
use variants::Declared;
use visibility::Visibility;

/// The shadows of a scene: see the [module](self).
#[derive(Debug)]
pub struct Shadows {
    device: wgpu::Device,
    queue: wgpu::Queue,
    options: ShadowsOptions,
    declared: Declared,
    meshes: Store<Mesh>,
    casters: Casters,
    lights: Store<Lit>,
    pools: Vec<Pool>,
    castings: Vec<Casting>,
    table: Table,
    layout: wgpu::BindGroupLayout,
    group: wgpu::BindGroup,
    group_is_stale: bool,
    comparison: wgpu::Sampler,
    point: wgpu::Sampler,
    cut_out_layout: wgpu::BindGroupLayout,
    view_layout: wgpu::BindGroupLayout,
    matrices: wgpu::Buffer,
    view_group: wgpu::BindGroup,
    moving_placed: Growing,
    /// Memory that frames use again.
    scratch: Scratch,
    /// V on the screen, where a technique finds it there.
    screen: Option<Screen>,
    masks: Option<Masks>,
    visibility: Option<Visibility>,
    /// Box around all that there is.
    scene_world: Aabb,
    frame: Option<Frame>,
    /// Lights were added, removed or changed.
    lights_changed: bool,
    /// Since the last change that recording must not miss.
    is_prepared: bool,
    warnings: Vec<ShadowsWarning>,
}

#[derive(Debug, Default)]
struct Scratch {
    boxes: Vec<Aabb>,
    placed: Vec<GpuInstance>,
    moving_placed: Vec<GpuInstance>,
    seen: Vec<(usize, u32)>,
    table: Vec<GpuLit>,
}

impl Shadows {
    /// Shadows for what `device` draws, handed over by `queue`, which must be its own. Makes no map yet.
    ///
    /// Cost: shader text; pipelines and maps are made when a light first needs them.
    ///
    /// # Errors
    /// [`ShadowsError::Option`], [`ShadowsError::Limit`] or [`ShadowsError::Shadow`] when options or device cannot be used,
    /// [`ShadowsError::Kernel`] when the kernel's text has no `umbrage_kernel`.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        options: ShadowsOptions,
    ) -> Result<Self, ShadowsError> {
        options.check()?;
        if options.kernel.as_deref().is_some_and(|text| !text.contains("fn umbrage_kernel")) {
            return Err(ShadowsError::Kernel { reason: "its text defines no `umbrage_kernel`".into() });
        }
        let declared = Declared::new(device, &options)?;
        check_limits(device, &declared)?;
        let pools = declared.pools.iter().map(|kind| Pool::new(device, kind.clone()));
        let pools: Vec<Pool> = pools.collect::<Result<_, _>>()?;
        let table = Table::new(device, options.most_lights, options.most_views);
        let (comparison, point) = (comparison_sampler(device), point_sampler(device));
        let layout = wgsl::layout(device, &declared);
        let screen = declared.screen.then(|| Screen::new(device, options.depth_stencil));
        let cut_out_layout = CasterPipelines::cut_out_layout(device);
        let masks = declared.mask_settings.as_ref();
        let masks = masks.map(|settings| Masks::new(device, settings, &cut_out_layout)).transpose()?;
        let resources = wgsl::Resources {
            table: &table,
            pools: &pools,
            comparison: &comparison,
            point: &point,
            screen: screen.as_ref().map(|screen| screen.v.array()),
            masks: masks.as_ref().map(|masks| masks.blockers.bindings()),
        };
        let group = wgsl::group(device, &layout, &declared, &resources);
        let view_layout = crate::caster::view_layout(device);
        let matrices = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("umbrage caster views"),
            size: u64::from(options.most_views * GpuCasterView::STRIDE),
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let view_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("umbrage caster view"),
            layout: &view_layout,
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                    buffer: &matrices,
                    offset: 0,
                    size: NonZeroU64::new(size_of::<GpuCasterView>() as u64),
                }),
            }],
        });
        // Told apart from others by chance: 1 in 4 billion pairs are not.
        let of = std::hash::RandomState::new().build_hasher().finish() as u32;
        Ok(Self {
            meshes: Store::new("mesh", of),
            casters: Casters::new(of),
            lights: Store::new("light", of),
            cut_out_layout,
            moving_placed: Growing::new(device, "umbrage moving casters", wgpu::BufferUsages::VERTEX, 0),
            device: device.clone(),
            queue: queue.clone(),
            options,
            declared,
            pools,
            castings: Vec::new(),
            table,
            layout,
            group,
            group_is_stale: false,
            comparison,
            point,
            view_layout,
            matrices,
            view_group,
            scratch: Scratch::default(),
            screen,
            masks,
            visibility: None,
            scene_world: Aabb::EMPTY,
            frame: None,
            lights_changed: true,
            is_prepared: false,
            warnings: Vec::new(),
        })
    }

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
        let receiver = casters::Receiver { bounds_world, mesh: None, placed };
        Ok(ReceiverHandle(self.casters.add_receiver(receiver)))
    }

    /// The same with a mesh: subtractive masks draw receivers once more, and darken nothing that has none. It casts no shadow.
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
        let receiver = casters::Receiver { bounds_world, mesh: Some(mesh.0), placed };
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
        self.casters.place_receiver(receiver.0, casters::Receiver { bounds_world, ..known })
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
        self.casters.place_receiver(receiver.0, casters::Receiver { bounds_world, placed, ..known })
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

    /// Adds a light with the first of the options' techniques.
    ///
    /// # Errors
    /// [`ShadowsError::Light`], [`ShadowsError::TooMany`].
    pub fn add_light(&mut self, light: Light) -> Result<LightHandle, ShadowsError> {
        let first = self.options.techniques.first().cloned();
        let settings = first.ok_or(ShadowsError::Option {
            option: "techniques",
            value: "empty".into(),
            allowed: "one technique or more".into(),
        })?;
        self.add_light_with(light, &settings)
    }

    /// Adds a light with a technique.
    ///
    /// # Errors
    /// [`ShadowsError::Light`], [`ShadowsError::TooMany`], [`ShadowsError::Undeclared`].
    pub fn add_light_with(
        &mut self,
        light: Light,
        technique: &Settings,
    ) -> Result<LightHandle, ShadowsError> {
        light.check()?;
        if self.lights.len() >= self.options.most_lights as usize {
            return Err(ShadowsError::TooMany {
                what: "lights",
                asked: self.lights.len() + 1,
                most: self.options.most_lights,
                option: "most_lights",
                limit: options::LIMIT,
            });
        }
        let settled = self.declared.settle(technique)?;
        self.lights_changed = true;
        self.is_prepared = false;
        Ok(LightHandle(self.lights.insert(Lit::new(light, settled))))
    }

    /// Moves a light, or changes it otherwise.
    ///
    /// # Errors
    /// [`ShadowsError::Light`], [`ShadowsError::Removed`], [`ShadowsError::OfAnother`].
    pub fn set_light(&mut self, handle: LightHandle, light: Light) -> Result<(), ShadowsError> {
        light.check()?;
        let lit = self.lights.get_mut(handle.0)?;
        if lit.light != light {
            (lit.light, lit.fit_is_stale) = (light, true);
            self.lights_changed = true;
        }
        Ok(())
    }

    /// Gives a light another technique, or another setting of its own, from the next [`Shadows::prepare`] on. One of the options'
    /// techniques: parameters are free, choices are not.
    ///
    /// # Errors
    /// [`ShadowsError::Undeclared`], [`ShadowsError::Removed`], [`ShadowsError::OfAnother`].
    pub fn set_technique(&mut self, handle: LightHandle, technique: &Settings) -> Result<(), ShadowsError> {
        let (settings, lookup) = self.declared.settle(technique)?;
        let lit = self.lights.get_mut(handle.0)?;
        lit.give_back(&mut self.pools, &self.declared.lookups);
        *lit = Lit::new(lit.light, (settings, lookup));
        self.lights_changed = true;
        self.is_prepared = false;
        Ok(())
    }

    /// The same by the technique's name, with its defaults: the first of the options' techniques of that name, or of the table.
    ///
    /// # Errors
    /// [`ShadowsError::Setting`] names what there is; otherwise as [`Shadows::set_technique`].
    pub fn set_technique_named(&mut self, handle: LightHandle, name: &str) -> Result<(), ShadowsError> {
        let declared = self.options.techniques.iter().find(|settings| settings.technique.id == name).cloned();
        let settings = declared.map_or_else(|| Settings::new(name, []), Ok)?;
        self.set_technique(handle, &settings)
    }

    /// Removes a light. Its number may be given to another one.
    ///
    /// # Errors
    /// [`ShadowsError::Removed`], [`ShadowsError::OfAnother`].
    pub fn remove_light(&mut self, handle: LightHandle) -> Result<(), ShadowsError> {
        let mut removed = self.lights.remove(handle.0)?;
        removed.give_back(&mut self.pools, &self.declared.lookups);
        self.lights_changed = true;
        self.is_prepared = false;
        Ok(())
    }

    /// The number of a light in the shader: it stays the same while the light is there.
    ///
    /// # Errors
    /// [`ShadowsError::Removed`], [`ShadowsError::OfAnother`].
    pub fn light_index(&self, handle: LightHandle) -> Result<u32, ShadowsError> {
        self.lights.get(handle.0)?;
        Ok(index(handle.0.key) as u32)
    }

    /// The number of a caster in the shader, for `umbrage_visibility_on`: it stays the same while the caster is there.
    ///
    /// # Errors
    /// [`ShadowsError::Removed`], [`ShadowsError::OfAnother`].
    pub fn caster_index(&self, handle: CasterHandle) -> Result<u32, ShadowsError> {
        self.casters.all.get(handle.0)?;
        Ok(index(handle.0.key) as u32)
    }

    /// A light as it was set.
    ///
    /// # Errors
    /// [`ShadowsError::Removed`], [`ShadowsError::OfAnother`].
    pub fn light(&self, handle: LightHandle) -> Result<(&Light, &Settings), ShadowsError> {
        self.lights.get(handle.0).map(|lit| (&lit.light, &lit.settings))
    }

    /// The layout of the one bind group, for the pipelines of whoever lights. The same as long as this lives.
    pub fn bind_group_layout(&self) -> &wgpu::BindGroupLayout {
        &self.layout
    }

    /// The bind group of all lights. Valid from the start; ask for it each frame after [`Shadows::prepare`], which may have made
    /// another one.
    pub fn bind_group(&self) -> &wgpu::BindGroup {
        &self.group
    }

    /// WGSL for whoever lights, to stand before their shader: the declarations of bind group number `group`, and
    /// `fn umbrage_visibility(light: u32, p_world: vec3f, normal: vec3f, pixel: vec2f) -> f32`, with
    /// `umbrage_visibility_rgb` for light that is coloured. All of its names begin with `umbrage_` or `Umbrage`. It stays the same.
    pub fn wgsl(&self, group: u32) -> String {
        wgsl::text(group, &self.declared, &self.options)
    }

    /// What did not go as one may expect, of the last [`Shadows::prepare`].
    pub fn warnings(&self) -> &[ShadowsWarning] {
        &self.warnings
    }

    /// Memory of maps and of what is kept to draw them, bytes.
    pub fn memory_bytes(&self) -> u64 {
        let kept = |lit: &Lit| -> u64 {
            let kept = lit.views.iter().filter_map(|view| view.kept.as_ref());
            kept.map(|kept| 4 * u64::from(kept.texture.width()) * u64::from(kept.texture.height())).sum()
        };
        let kept: u64 = self.lights.iter().map(|(_, lit)| kept(lit)).sum();
        let peels = self.castings.iter().filter_map(|casting| casting.peel.as_ref());
        let peeled: u64 = peels.map(|(_, peel)| peel.memory_bytes()).sum();
        let screen = self.screen.as_ref().map_or(0, Screen::memory_bytes);
        let masks = self.masks.as_ref().map_or(0, Masks::memory_bytes);
        self.pools.iter().map(Pool::memory_bytes).sum::<u64>() + kept + peeled + screen + masks
    }
}

/// Does one stage of the device have room for what is bound?
fn check_limits(device: &wgpu::Device, declared: &Declared) -> Result<(), ShadowsError> {
    let limits = device.limits();
    let bound = wgsl::bound(declared);
    let textures = bound.iter().filter(|bound| bound.is_texture()).count() as u64;
    let has = u64::from(limits.max_sampled_textures_per_shader_stage);
    if textures > has {
        return Err(ShadowsError::Limit {
            limit: "max_sampled_textures_per_shader_stage",
            has,
            needed: textures,
            advice: "name fewer techniques of different storage or map_size in `ShadowsOptions`",
        });
    }
    Ok(())
}
