//! A scene made ready for one GPU: everything that a frame needs, and what of it follows the world.

use crate::RenderError;
use crate::bindings::FrameBindings;
use crate::draw_list::{Batch, Items, Work};
use crate::eye::{Eye, shown_view};
use crate::families::by_mesh;
use crate::frame::Ages;
use crate::geometry::Geometry;
use crate::gpu::Gpu;
use crate::layout::GpuLight;
use crate::making::make_maker;
use crate::maps::{Growing, MapMaker, MapSet};
use crate::masks::Masks;
use crate::materials::MaterialEntry;
use crate::moving::World;
use crate::options::{RenderOptions, View};
use crate::overdraw::OverdrawPipelines;
use crate::pipelines::{Layouts, MeshPipelines, MeshTarget, screen_pipeline};
use crate::settled::{Settled, shader_needs};
use crate::targets::{TargetNeeds, Targets};
use crate::textures::Textures;
use crate::threaded::{MapSchedule, MapThread, locked};
use crate::volumes::{Silhouettes, Volumes};
use glam::Mat4;
use std::ops::Range;
use std::sync::{Arc, Mutex};
use std::time::Instant;
use umbrage::core::fit::{MaskView, ShadowView};
use umbrage::core::{Camera, DEPTH, Frustum};
use umbrage::mask::mask_range;
use umbrage::{CasterPipelines, ChosenFormat, ShadowMaps};
use umbrage_scene::{Image, Scene};

/// A scene made ready for one GPU.
#[derive(Debug)]
pub struct Renderer<'a> {
    pub(crate) gpu: &'a Gpu,
    pub(crate) options: RenderOptions,
    pub(crate) world: Arc<World>,
    pub(crate) geometry: Arc<Geometry>,
    pub(crate) materials: Arc<Vec<MaterialEntry>>,
    pub(crate) material_of_mesh: Arc<Vec<usize>>,
    pub(crate) maker: Arc<MapMaker>,
    pub(crate) volumes: Option<Volumes>,
    pub(crate) masks: Option<Masks>,
    pub(crate) objects: Growing,
    pub(crate) overdraw: Option<OverdrawPipelines>,
    /// One set of maps, or two that a thread and the frames exchange.
    pub(crate) sets: Vec<Arc<Mutex<MapSet>>>,
    pub(crate) schedule: MapSchedule,
    pub(crate) thread: Option<MapThread>,
    /// How many views there may be.
    pub(crate) most_views: usize,
    /// When the frame last drew maps.
    pub(crate) drawn_at: Option<Instant>,
    pub(crate) targets: Targets,
    pub(crate) mesh_pipelines: MeshPipelines,
    pub(crate) screen: Option<wgpu::RenderPipeline>,
    bindings: FrameBindings,
    /// A bind group for each set, and which of its changes it was made for.
    pub(crate) groups: Vec<Option<(u64, wgpu::BindGroup)>>,
    pub(crate) frame_group: Option<wgpu::BindGroup>,
    pub(crate) gbuffer_group: Option<wgpu::BindGroup>,
    pub(crate) instances: Growing,
    pub(crate) solid: Vec<Batch>,
    pub(crate) blended: Vec<Batch>,
    pub(crate) clip_from_world: Mat4,
    /// World, set and its changes that the uniforms hold.
    pub(crate) told: Option<(u64, usize, u64)>,
    pub(crate) ages: Ages,
    views: Vec<ShadowView>,
    views_of_light: Vec<Range<usize>>,
    exposure: f32,
    /// Warnings that no change takes away, and all.
    lasting: Vec<String>,
    pub(crate) warnings: Vec<String>,
    /// How many of them were there before the frame.
    pub(crate) told_warnings: usize,
}

impl<'a> Renderer<'a> {
    /// Uploads `scene`, fits its lights, makes pipelines and maps.
    ///
    /// # Errors
    /// [`RenderError`] says which input cannot be used and what to do.
    pub fn new(
        gpu: &'a Gpu,
        scene: &Scene,
        camera: &Camera,
        options: RenderOptions,
    ) -> Result<Self, RenderError> {
        let options = crate::density::options(options);
        let settled = Settled::new(gpu, scene, camera, &options)?;
        let Settled { targets: TargetNeeds { lit_at_once, depth, .. }, exposure, most_views, .. } = settled;
        let targets = Targets::new(&gpu.device, &options, &settled.targets)?;
        let color_maps = settled.maps.combination().is_some() && settled.format.storage.is_color();
        let layouts = Layouts::new(&gpu.device, color_maps, most_views, settled.looks_up_masks);
        let geometry = Arc::new(Geometry::new(&gpu.device, scene));
        let textures = Textures::new(&gpu.device, &gpu.queue, scene);
        let caster_layout = CasterPipelines::cut_out_layout(&gpu.device);
        let materials = crate::materials::make(
            &gpu.device,
            scene,
            options.all_blinn,
            &textures,
            &layouts.material,
            &caster_layout,
        );
        let world = World {
            items: Items::new(scene, &geometry, &materials, options.deform_reach_m, &settled.by_map),
            lights: scene.lights.clone(),
            camera: *camera,
            time_s: options.time_s,
            mesh_versions: vec![0; scene.meshes.len()],
            version: 0,
        };
        let maker = make_maker(
            gpu,
            &options,
            settled.maps,
            settled.format,
            &caster_layout,
            exposure,
            (Arc::clone(&geometry), Arc::new(materials), scene),
        )?;
        let mut set = MapSet::new(&gpu.device, most_views);
        maker.refresh(&mut set, &world)?;

        let lights = set.lights.lights.len();
        let drawn = (&geometry, &maker.materials);
        let masks = Masks::new(gpu, scene, &options, &caster_layout, depth, lights, drawn)?;
        let by_mesh = by_mesh(scene, &settled.by_map);
        let volumes = Volumes::new(gpu, scene, &options, &by_mesh, depth, lights);
        let needs = shader_needs(scene, &options, &maker.settings, maker.format.storage, &set.lights);
        let mesh_pipelines = MeshPipelines::new(&gpu.device, &layouts, &needs, depth);
        let screen =
            (!lit_at_once).then(|| screen_pipeline(&gpu.device, &layouts, &needs, options.view, depth));
        let slide_images: Vec<&Image> = set.lights.slides.iter().map(|i| &scene.images[*i]).collect();
        let gbuffer_group = gbuffer_group(gpu, &layouts, &targets);
        let of_masks = masks.as_ref().and_then(Masks::v);
        let v = volumes.as_ref().map(Volumes::v).or(of_masks).map(|v| v.array().clone());
        let looked_up = masks.as_ref().filter(|_| settled.looks_up_masks).map(Masks::bindings);
        let bindings = FrameBindings::new(gpu, layouts, &options, &slide_images, v, looked_up);
        let usage = wgpu::BufferUsages::VERTEX;
        let mut renderer = Self {
            gpu,
            world: Arc::new(world),
            geometry,
            materials: Arc::clone(&maker.materials),
            material_of_mesh: Arc::clone(&maker.material_of_mesh),
            maker: Arc::new(maker),
            overdraw: OverdrawPipelines::of_view(&gpu.device, &options, volumes.as_ref(), depth),
            volumes,
            masks,
            objects: Growing::new(&gpu.device, "objects", wgpu::BufferUsages::VERTEX, 0),
            sets: vec![Arc::new(Mutex::new(set))],
            schedule: MapSchedule::default(),
            thread: None,
            most_views,
            drawn_at: None,
            targets,
            mesh_pipelines,
            screen,
            bindings,
            groups: vec![None],
            frame_group: None,
            gbuffer_group,
            instances: Growing::new(&gpu.device, "instances", usage, 0),
            solid: Vec::new(),
            blended: Vec::new(),
            clip_from_world: Mat4::IDENTITY,
            told: None,
            ages: Ages::default(),
            views: Vec::new(),
            views_of_light: Vec::new(),
            exposure,
            lasting: settled.warnings,
            warnings: Vec::new(),
            told_warnings: 0,
            options,
        };
        let set = Arc::clone(&renderer.sets[0]);
        renderer.tell(0, &locked(&set))?;
        gpu.check()?;
        Ok(renderer)
    }

    /// Brings lists and uniforms up to the world as it is, looked up in a set of maps. No cost when they are.
    pub(crate) fn tell(&mut self, index: usize, set: &MapSet) -> Result<(), RenderError> {
        let now = (self.world.version, index, set.changes);
        if self.told == Some(now) {
            return Ok(());
        }
        let (gpu, world) = (self.gpu, Arc::clone(&self.world));
        let shown = shown_view(&world.lights, &set.lights, &self.options)?;
        let camera = self.volumes.as_ref().map_or(world.camera, |volumes| volumes.camera(gpu, &world));
        let eye = Eye::new(&camera, &self.options, shown.as_ref().map(|(light, view)| (*light, view)));
        let frustum = Frustum::from_clip(eye.clip_from_world, DEPTH);
        let mut instances = Vec::new();
        self.solid = world.items.solid(&frustum, &mut instances);
        self.blended = world.items.blended(&frustum, eye.position, &mut instances);
        self.instances.write(&gpu.device, &gpu.queue, bytemuck::cast_slice(&instances));
        let forward = MeshTarget::Forward { samples: self.options.samples };
        if self.targets.gbuffer.is_some() {
            self.mesh_pipelines.prepare(
                &gpu.device,
                MeshTarget::Gbuffer,
                self.solid.iter().map(|b| b.variant),
            );
        }
        if self.screen.is_none() {
            self.mesh_pipelines.prepare(&gpu.device, forward, self.solid.iter().map(|b| b.variant));
        }
        if matches!(self.options.view, View::Final | View::Light) {
            self.mesh_pipelines.prepare(&gpu.device, forward, self.blended.iter().map(|b| b.variant));
        }
        let mut lights = set.lights.relit(&world.lights, self.exposure);
        let of_masks = self.tell_masks(&world, &frustum, &eye, &mut lights)?;
        let frame = eye.frame(&self.options, lights.len(), self.exposure, world.time_s);
        self.bindings.write(&gpu.queue, &frame, &lights);
        let group = match self.groups[index].take() {
            Some((changes, group)) if changes == set.changes => group,
            _ => self.bindings.group(&gpu.device, set),
        };
        self.frame_group = Some(group.clone());
        self.groups[index] = Some((set.changes, group));
        self.clip_from_world = eye.clip_from_world;
        self.views.clone_from(&set.lights.views);
        self.views_of_light.clone_from(&set.lights.views_of_light);
        self.warnings = set.lights.warnings.iter().chain(&self.lasting).cloned().collect();
        self.warnings.extend(of_masks);
        if let Some(volumes) = &mut self.volumes {
            let (size, all) = (self.options.size, self.options.all_casters);
            self.warnings.extend(volumes.tell(&world, eye.clip_from_world, size, all));
        }
        self.told_warnings = self.warnings.len();
        self.told = Some(now);
        Ok(())
    }

    /// Fits masks to the world, and says which are each light's.
    fn tell_masks(
        &mut self,
        world: &World,
        frustum: &Frustum,
        eye: &Eye,
        lights: &mut [GpuLight],
    ) -> Result<Vec<String>, RenderError> {
        let Some(masks) = &mut self.masks else { return Ok(Vec::new()) };
        let objects = world.items.objects(frustum, eye.position);
        self.objects.write(&self.gpu.device, &self.gpu.queue, bytemuck::cast_slice(&objects));
        let warnings = masks.tell(self.gpu, world, eye.clip_from_world, self.options.size)?;
        for (index, light) in lights.iter_mut().enumerate() {
            light.masks = mask_range(&masks.of_light(index));
        }
        Ok(warnings)
    }

    /// Memory of all shadow maps, bytes: that of all lights, and what is drawn on the way to them. It grows with the
    /// number of views and their texels, and with nothing of the scene. Twice as much while a thread draws them.
    pub fn shadow_memory_bytes(&self) -> u64 {
        let peeled = self.maker.casting.as_ref().and_then(|casting| casting.peeled.as_ref());
        let sets: u64 = self.sets.iter().map(|set| locked(set).memory_bytes()).sum();
        let shadowed = !self.views.is_empty();
        let volumes = self.volumes.as_ref().map_or(0, Volumes::memory_bytes);
        let masks = self.masks.as_ref().map_or(0, Masks::memory_bytes);
        masks + volumes + sets + peeled.filter(|_| shadowed).map_or(0, |peeled| peeled.peel.memory_bytes())
    }

    /// Memory of each light's maps, masks and volumes, bytes, without what lights share; 0 for lights without. Maps take twice as
    /// much while a thread draws them.
    pub fn shadow_memory_of_lights(&self) -> Vec<u64> {
        let layer: u64 =
            self.sets.iter().map(|set| locked(set).maps().map_or(0, ShadowMaps::layer_bytes)).sum();
        let volumes = |light| self.volumes.as_ref().map_or(0, |volumes| volumes.memory_of_light(light));
        let masks = |light| self.masks.as_ref().map_or(0, |masks| masks.memory_of_light(light));
        let of_light = |(light, views): (usize, &Range<usize>)| {
            views.len() as u64 * layer + volumes(light) + masks(light)
        };
        self.views_of_light.iter().enumerate().map(of_light).collect()
    }

    /// The depth format that the maps got, and why. `None` without maps.
    pub fn map_format(&self) -> Option<&ChosenFormat> {
        (!self.views.is_empty()).then_some(&self.maker.format)
    }

    /// The views of the lights that got one, as the last frame looked them up.
    pub fn views(&self) -> &[ShadowView] {
        &self.views
    }

    /// Factor from radiance to picture. It stays as it was found at the start.
    pub fn exposure(&self) -> f32 {
        self.exposure
    }

    /// What did not go as a user may expect; of [`View::Volumes`] also what the last frame counted.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// The views of all masks, light by light; empty for techniques without.
    pub fn mask_views(&self) -> Vec<MaskView> {
        self.masks.iter().flat_map(Masks::views).copied().collect()
    }

    /// What each light sees of its casters' edges, after a frame; nothing for techniques without volumes. Waits for the GPU.
    ///
    /// # Errors
    /// [`RenderError::Gpu`] when the device is lost.
    pub fn silhouettes(&self) -> Result<Vec<Silhouettes>, RenderError> {
        self.volumes.as_ref().map_or(Ok(Vec::new()), |volumes| volumes.silhouettes(self.gpu))
    }

    /// What solid and blended surfaces ask of the GPU.
    pub(crate) fn work_of(&self, batches: &[Batch]) -> Work {
        Work::of(batches, &self.geometry)
    }
}

/// Group 1 of the screen pipelines, where there is a G-buffer.
fn gbuffer_group(gpu: &Gpu, layouts: &Layouts, targets: &Targets) -> Option<wgpu::BindGroup> {
    let (gbuffer, depth) = (targets.gbuffer.as_ref()?, targets.depth_only.as_ref()?);
    let views = [Some(gbuffer), Some(depth), targets.objects.as_ref()].into_iter().flatten();
    let entries: Vec<_> = (0u32..)
        .zip(views)
        .map(|(binding, view)| wgpu::BindGroupEntry {
            binding,
            resource: wgpu::BindingResource::TextureView(view),
        })
        .collect();
    Some(gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("gbuffer"),
        layout: &layouts.gbuffer,
        entries: &entries,
    }))
}
