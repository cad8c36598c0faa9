//! A scene made ready for one GPU: everything that a frame needs, and what of it follows the world.

use crate::bindings::FrameBindings;
use crate::draw_list::{Batch, Items, Work};
use crate::frame::Ages;
use crate::geometry::Geometry;
use crate::gpu::Gpu;
use crate::layout::{GpuFrame, GpuLight, MAX_LIGHTS};
use crate::lights::{Lights, eye_of};
use crate::maps::{Casting, Growing, MapMaker, MapSet};
use crate::maskable::{has_holes, unmaskable};
use crate::masks::Masks;
use crate::materials::MaterialEntry;
use crate::moving::World;
use crate::options::{RenderOptions, View};
use crate::overdraw::{self, OverdrawPipelines};
use crate::peeled::{Peeled, caster_passes};
use crate::pipelines::{DEPTH_FORMAT, Layouts, MeshPipelines, MeshTarget, screen_pipeline};
use crate::shaders::ShaderNeeds;
use crate::targets::{TargetNeeds, Targets};
use crate::textures::Textures;
use crate::threaded::{MapSchedule, MapThread, locked};
use crate::volumes::{Silhouettes, Volumes};
use crate::{RenderError, exposure, own_wgsl};
use glam::{Mat4, Vec3};
use std::ops::Range;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use umbrage::caster::NO_DEFORM;
use umbrage::core::fit::{MaskView, ShadowView};
use umbrage::core::plan::{Draws, plan};
use umbrage::core::technique::mask::Receivers;
use umbrage::core::technique::{Combination, DEFAULT, Method, NO_SHADOW, Settings, Storage};
use umbrage::core::{Camera, DEPTH, Frustum, Light, LightKind, LightShape};
use umbrage::{CasterPipelines, ChosenFormat, ShadowMaps, TranslucentPipelines, choose_format};
use umbrage_scene::{Image, Instance, Reflectance, Scene, SceneLight};

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
        camera.check().map_err(RenderError::Camera)?;
        check_samples(gpu, options.samples)?;
        let emits = scene.meshes.iter().any(|mesh| scene.materials[mesh.material].emissive != Vec3::ZERO);
        let lit_at_once = matches!(options.view, View::Final | View::Light) && (options.samples > 1 || emits);
        let on_screen = is_on_screen(&options.settings);
        let looks_up_masks = matches!(options.settings.method, Method::Mask(_)) && !on_screen;
        let depth = if on_screen { umbrage::volume::choose_count_format(&gpu.device) } else { DEPTH_FORMAT };
        let target_needs =
            TargetNeeds { gbuffer: on_screen || !lit_at_once, lit_at_once, objects: looks_up_masks, depth };
        let targets = Targets::new(&gpu.device, &options, &target_needs)?;

        check_given(scene, &options)?;
        overdraw::check(&options)?;
        options.deform.as_deref().map_or(Ok(()), own_wgsl::check_deform)?;
        options.kernel.as_deref().map_or(Ok(()), own_wgsl::check_kernel)?;
        let exposure = options.exposure.unwrap_or_else(|| automatic_exposure(scene));
        let (by_map, why) = by_map(scene, &options);
        let map_settings = map_settings(&options.settings, &by_map)?;
        let format = settled_format(gpu, &options, &map_settings)?;
        let most_views = most_views(scene, &map_settings);
        let color_maps = map_settings.combination().is_some() && format.storage.is_color();
        let layouts = Layouts::new(&gpu.device, color_maps, most_views, looks_up_masks);
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
            items: Items::new(scene, &geometry, &materials, options.deform_reach_m, &by_map),
            lights: scene.lights.clone(),
            camera: *camera,
            time_s: options.time_s,
            mesh_versions: vec![0; scene.meshes.len()],
            version: 0,
        };
        let maker = make_maker(
            gpu,
            &options,
            map_settings,
            format,
            &caster_layout,
            exposure,
            (Arc::clone(&geometry), Arc::new(materials), scene),
        )?;
        let mut set = MapSet::new(&gpu.device, most_views);
        maker.refresh(&mut set, &world)?;

        let masks = Masks::new(
            gpu,
            scene,
            &options,
            &caster_layout,
            depth,
            set.lights.lights.len(),
            &geometry,
            &maker.materials,
        )?;
        let mut volumes = Volumes::new(
            gpu,
            scene,
            &options.settings,
            &by_mesh(scene, &by_map),
            depth,
            options.size,
            set.lights.lights.len(),
        );
        if let (Some(volumes), Some(depth_only)) = (&mut volumes, &targets.depth_only) {
            volumes.soften(&gpu.device, &options.settings, options.size, depth_only);
        }
        let needs = shader_needs(scene, &options, &maker.settings, maker.format.storage, &set.lights);
        let mesh_pipelines = MeshPipelines::new(&gpu.device, &layouts, &needs, depth);
        let screen =
            (!lit_at_once).then(|| screen_pipeline(&gpu.device, &layouts, &needs, options.view, depth));
        let slide_images: Vec<&Image> = set.lights.slides.iter().map(|i| &scene.images[*i]).collect();
        let gbuffer_group = gbuffer_group(gpu, &layouts, &targets);
        let of_masks = masks.as_ref().and_then(Masks::v);
        let v = volumes.as_ref().map(Volumes::v).or(of_masks).map(|v| v.array().clone());
        let looked_up = masks.as_ref().filter(|_| looks_up_masks).map(Masks::bindings);
        let bindings = FrameBindings::new(gpu, layouts, &options, &slide_images, v, looked_up);
        let mut lasting = fallback_warnings(scene, &options, &by_map, why);
        if options.samples > 1 && !lit_at_once {
            let id = options.view.id();
            lasting
                .push(format!("the view `{id}` has one sample a pixel; {} were asked for", options.samples));
        }
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
            lasting,
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
        let of_masks = self.tell_masks(&world, &frustum, &eye, &mut lights);
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
            self.warnings.extend(volumes.tell(gpu, &world, eye.clip_from_world, size, all));
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
    ) -> Vec<String> {
        let Some(masks) = &mut self.masks else { return Vec::new() };
        let objects = world.items.objects(frustum, eye.position);
        self.objects.write(&self.gpu.device, &self.gpu.queue, bytemuck::cast_slice(&objects));
        let warnings = masks.tell(self.gpu, world, eye.clip_from_world, self.options.size);
        for (index, light) in lights.iter_mut().enumerate() {
            let range = masks.of_light(index);
            light.masks = range.start as u32 | ((range.len() as u32) << 16);
        }
        warnings
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

    /// Memory of each light's maps, bytes; 0 for lights without. Twice as much while a thread draws them.
    pub fn shadow_memory_of_lights(&self) -> Vec<u64> {
        let layer: u64 =
            self.sets.iter().map(|set| locked(set).maps().map_or(0, ShadowMaps::layer_bytes)).sum();
        self.views_of_light.iter().map(|views| views.len() as u64 * layer).collect()
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

/// Is V found on the screen before surfaces are lit?
fn is_on_screen(settings: &Settings) -> bool {
    match settings.method {
        Method::Volume(_) => true,
        Method::Mask(mask) => mask.receivers == Receivers::Subtractive,
        Method::None | Method::Map(_) => false,
    }
}

/// For each instance: can only a map draw its shadow? And why. Volumes know no holes, and nothing of what a function moves;
/// masks nothing of what a light is inside of.
fn by_map(scene: &Scene, options: &RenderOptions) -> (Vec<bool>, Option<String>) {
    let is_volume = matches!(options.settings.method, Method::Volume(_));
    if !is_volume {
        return unmaskable(scene, &options.settings, options.deform_reach_m);
    }
    let is_by_map =
        |placed: &Instance| options.deform.is_some() || has_holes(scene, &scene.meshes[placed.mesh]);
    let by_map: Vec<bool> = scene.instances.iter().map(is_by_map).collect();
    let why = if options.deform.is_some() {
        "a function moves their vertices"
    } else {
        "textures cut holes into them"
    };
    (by_map, Some(why.to_owned()))
}

/// For each mesh: does any of its instances need a map?
fn by_mesh(scene: &Scene, by_map: &[bool]) -> Vec<bool> {
    let mut by_mesh = vec![false; scene.meshes.len()];
    let placed = scene.instances.iter().zip(by_map);
    placed.for_each(|(placed, by_map)| by_mesh[placed.mesh] |= by_map);
    by_mesh
}

/// What maps are drawn with: the technique itself, or what takes over for casters that it cannot draw; nothing where there are none.
fn map_settings(settings: &Settings, by_map: &[bool]) -> Result<Settings, RenderError> {
    match settings.fallback() {
        None => Ok(settings.clone()),
        Some(fallback) if by_map.contains(&true) => Ok(fallback),
        Some(_) => Settings::new(NO_SHADOW, []).map_err(|e| RenderError::View(e.to_string())),
    }
}

/// Which casters a map draws though the technique is none.
fn fallback_warnings(
    scene: &Scene,
    options: &RenderOptions,
    by_map: &[bool],
    why: Option<String>,
) -> Vec<String> {
    const NAMED: usize = 8;
    let name = |number: usize| {
        let placed = &scene.instances[number];
        let name = if placed.name.is_empty() { &scene.meshes[placed.mesh].name } else { &placed.name };
        if name.is_empty() { format!("instance {number}") } else { format!("`{name}`") }
    };
    let mut names: Vec<String> = (0..by_map.len()).filter(|number| by_map[*number]).map(name).collect();
    names.dedup();
    let Some(why) = why.filter(|_| !names.is_empty()) else { return Vec::new() };
    let (id, family) = (options.settings.technique.id, options.settings.method.family().id());
    let more = if names.len() > NAMED { format!(" and {} more", names.len() - NAMED) } else { String::new() };
    let named = names[..names.len().min(NAMED)].join(", ");
    vec![format!(
        "`{id}`: no {family} is made of {named}{more}: {why}; their shadows come from a `{DEFAULT}` map (set its map_size)"
    )]
}

/// What draws the maps.
#[allow(clippy::too_many_arguments, reason = "a maker is made of all that it needs, and it has one caller")]
fn make_maker(
    gpu: &Gpu,
    options: &RenderOptions,
    settings: Settings,
    format: ChosenFormat,
    caster_layout: &wgpu::BindGroupLayout,
    exposure: f32,
    (geometry, materials, scene): (Arc<Geometry>, Arc<Vec<MaterialEntry>>, &Scene),
) -> Result<MapMaker, RenderError> {
    let casting = make_casting(gpu, options, &settings, &format, caster_layout)?;
    Ok(MapMaker {
        device: gpu.device.clone(),
        queue: gpu.queue.clone(),
        only_by_map: options.settings.fallback().is_some(),
        settings,
        format,
        casting,
        geometry,
        materials,
        material_of_mesh: Arc::new(scene.meshes.iter().map(|m| m.material).collect()),
        mesh_names: scene.meshes.iter().map(|mesh| mesh.name.clone()).collect(),
        exposure,
        aspect: options.size.x as f32 / options.size.y as f32,
        all_casters: options.all_casters || options.view.shows_map(),
        deforms: options.deform.is_some(),
        load: Duration::try_from_secs_f32(options.map_load_ms * 1e-3).unwrap_or_default(),
    })
}

/// The passes that draw casters, and their pipelines; `None` for techniques without maps.
fn make_casting(
    gpu: &Gpu,
    options: &RenderOptions,
    settings: &Settings,
    format: &ChosenFormat,
    caster_layout: &wgpu::BindGroupLayout,
) -> Result<Option<Casting>, RenderError> {
    let (Some(pass), peel_pass) = caster_passes(settings) else { return Ok(None) };
    let deform = options.deform.as_deref().unwrap_or(NO_DEFORM);
    let pipelines = CasterPipelines::new(&gpu.device, format, &pass, caster_layout, deform);
    let size_texel = settings.map_size_texel();
    let peel = |pass| Peeled::new(&gpu.device, pass, size_texel, caster_layout, deform);
    let mut tinting = plan(settings).into_iter().filter(|pass| pass.draws == Draws::Translucent);
    let translucent = match (tinting.next(), tinting.next()) {
        (Some(colors), Some(nearest)) => {
            let groups = [&pipelines.view_layout, caster_layout];
            let made = TranslucentPipelines::new(&gpu.device, format, &colors, groups, deform);
            Some(([colors, nearest], made))
        }
        _ => None,
    };
    Ok(Some(Casting { peeled: peel_pass.map(peel).transpose()?, pass, pipelines, translucent }))
}

/// The format of the maps, when it goes with all else that was asked for.
fn settled_format(
    gpu: &Gpu,
    options: &RenderOptions,
    settings: &Settings,
) -> Result<ChosenFormat, RenderError> {
    let storage = settings.combination().map_or(Storage::Auto, |c| c.storage);
    let format = choose_format(storage, |format| gpu.usages_of(format))?;
    let settled = settings.combination().map(|c| Combination { storage: format.storage, ..c });
    if let Some(reason) = settled.and_then(|combination| combination.objection()) {
        return Err(RenderError::View(format!(
            "this adapter's best storage for maps is {}, and that does not go with the rest: {reason}",
            format.storage.row().id
        )));
    }
    if options.view == View::Channels && !format.storage.is_color() {
        return Err(RenderError::View(format!(
            "the view `channels` shows a colour target, and the map is {}; set storage=r32f or storage=packed3",
            format.storage.row().id
        )));
    }
    Ok(format)
}

/// How many views the lights of a scene may have.
fn most_views(scene: &Scene, settings: &Settings) -> usize {
    let places = if settings.combination().is_some() { settings.places() as usize } else { 0 };
    let of_light = |light: &Light| {
        let places = if light.shape == LightShape::Point { places.min(1) } else { places };
        places * if light.kind == LightKind::Point { 6 } else { 1 }
    };
    scene.lights.iter().take(MAX_LIGHTS).map(|placed| of_light(&placed.light)).sum()
}

/// What the shaders of a scene must be able to do, and no more.
fn shader_needs(
    scene: &Scene,
    options: &RenderOptions,
    settings: &Settings,
    storage: Storage,
    lights: &Lights,
) -> ShaderNeeds {
    let used = || scene.meshes.iter().map(|mesh| &scene.materials[mesh.material].reflectance);
    let is_blinn = |r: &Reflectance| options.all_blinn || matches!(r, Reflectance::Blinn { .. });
    ShaderNeeds {
        // `auto` is read as what it was settled on.
        combination: settings.combination().map(|c| Combination { storage, ..c }),
        given: options.given.is_some(),
        screen: is_on_screen(&options.settings),
        masks: matches!(options.settings.method, Method::Mask(_)) && !is_on_screen(&options.settings),
        exempt: scene.instances.iter().any(|placed| !placed.roles.receiver),
        metallic_roughness: used().any(|r| !is_blinn(r)),
        blinn: used().any(is_blinn),
        placed: scene.lights.iter().any(|l| l.light.kind != LightKind::Directional),
        slide: !lights.slides.is_empty(),
        lights: lights.lights.len(),
        point: scene.lights.iter().any(|l| l.light.kind == LightKind::Point),
        views: most_views(scene, settings),
        places: lights.lights.iter().any(|l| l.places > 1),
        density: options.view.is_density(),
        deform: options.deform.clone(),
        kernel: options.kernel.clone(),
    }
}

/// The eye of the picture: the camera's, or the shown light's.
struct Eye {
    clip_from_world: Mat4,
    position: Vec3,
    towards: (Vec3, f32),
}

impl Eye {
    fn new(camera: &Camera, options: &RenderOptions, shown: Option<(Light, &ShadowView)>) -> Self {
        let aspect = options.size.x as f32 / options.size.y as f32;
        if let (View::Light, Some((light, view))) = (options.view, shown) {
            // The map is square: a wider picture shows more on both sides, a higher one more above and below.
            let fit = Vec3::new((1.0 / aspect).min(1.0), aspect.min(1.0), 1.0);
            let towards =
                if view.perspective { (light.position_world, 1.0) } else { (-light.direction_world, 0.0) };
            let clip_from_world = Mat4::from_scale(fit) * view.clip_from_world();
            return Self { clip_from_world, position: light.position_world, towards };
        }
        let clip_from_world = camera.clip_from_view(aspect, DEPTH) * camera.view_from_world();
        Self { clip_from_world, position: camera.position_world, towards: eye_of(camera) }
    }

    fn frame(&self, options: &RenderOptions, light_count: usize, exposure: f32, time_s: f32) -> GpuFrame {
        GpuFrame {
            clip_from_world: self.clip_from_world,
            world_from_clip: self.clip_from_world.as_dmat4().inverse().as_mat4(),
            eye: self.towards.0,
            eye_w: self.towards.1,
            ambient: exposure::ambient(options.ambient),
            fill: options.fill,
            light_count: light_count as u32,
            shown_light: options.shown_light as u32,
            exposure,
            time_s,
        }
    }
}

/// The exposure that the scene's own lights and instances ask for.
fn automatic_exposure(scene: &Scene) -> f32 {
    let lights: Vec<Light> = scene.lights.iter().map(|l| l.light).collect();
    let middle = |i: &Instance| i.world_from_object.transform_point3(scene.meshes[i.mesh].bounds.center());
    exposure::automatic(&lights, &scene.bounds(), scene.instances.iter().map(middle))
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

fn check_samples(gpu: &Gpu, asked: u32) -> Result<(), RenderError> {
    let flags = gpu.adapter.get_texture_format_features(crate::pipelines::COLOR).flags;
    // More than 4 need a device feature that is not asked for.
    let available: Vec<u32> =
        flags.supported_sample_counts().into_iter().filter(|count| matches!(count, 1 | 4)).collect();
    if available.contains(&asked) {
        return Ok(());
    }
    let names: Vec<_> = available.iter().map(u32::to_string).collect();
    Err(RenderError::Samples { asked, available: names.join(" or ") })
}

/// Does what is given fit the scene and the picture?
fn check_given(scene: &Scene, options: &RenderOptions) -> Result<(), RenderError> {
    let Some(given) = &options.given else { return Ok(()) };
    let lights = scene.lights.len().min(MAX_LIGHTS);
    let pixels = options.size.element_product() as usize;
    let fits = given.of_light.len() == lights && given.of_light.iter().all(|v| v.len() == pixels);
    if fits && options.settings.method == Method::None {
        return Ok(());
    }
    Err(RenderError::View(if fits {
        format!("V is given, so `{}` has nothing to do; use `unshadowed`", options.settings.technique.id)
    } else {
        let found: Vec<usize> = given.of_light.iter().map(Vec::len).collect();
        format!("V is given for {found:?} pixels of each light; {lights} lights of {pixels} are needed")
    }))
}

/// The light that the debug views show, when they need one.
fn shown_view(
    scene_lights: &[SceneLight],
    lights: &Lights,
    options: &RenderOptions,
) -> Result<Option<(Light, ShadowView)>, RenderError> {
    let (index, id) = (options.shown_light, options.view.id());
    if options.view == View::Final {
        return Ok(None);
    }
    if index >= lights.lights.len() {
        let count = lights.lights.len();
        return Err(RenderError::View(format!(
            "the view `{id}` shows light {index}, but there are {count} lights"
        )));
    }
    match lights.views_of_light[index].clone().next() {
        Some(view) => Ok(Some((scene_lights[index].light, lights.views[view]))),
        None if options.view.needs_map() => Err(RenderError::View(format!(
            "the view `{id}` needs a shadow map, and light {index} has none with technique `{}`",
            options.settings.technique.id
        ))),
        None => Ok(None),
    }
}
