//! A scene made ready for one GPU: everything that a frame needs and no frame changes.

use crate::draw_list::{Batch, Items, Work};
use crate::geometry::Geometry;
use crate::gpu::Gpu;
use crate::layout::{GpuFrame, GpuLight, MAX_LIGHTS};
use crate::lights::{Lights, eye_of};
use crate::materials::MaterialEntry;
use crate::options::{RenderOptions, View};
use crate::pipelines::{Layouts, MeshPipelines, MeshTarget, screen_pipeline};
use crate::shaders::ShaderNeeds;
use crate::targets::Targets;
use crate::textures::Textures;
use crate::{RenderError, exposure};
use bytemuck::Zeroable;
use glam::{Mat4, Vec3};
use umbrage::caster::{GpuCasterView, NO_DEFORM};
use umbrage::core::fit::{self, ShadowView};
use umbrage::core::layout::GpuView;
use umbrage::core::plan::{Draws, Pass, plan};
use umbrage::core::technique::Storage;
use umbrage::core::{Camera, DEPTH, Frustum, Light, LightKind};
use umbrage::{CasterPipelines, ChosenFormat, ShadowMaps, choose_format};
use umbrage_scene::{Image, Instance, Reflectance, Scene};
use wgpu::util::DeviceExt;

/// The maps and what draws them.
#[derive(Debug)]
pub(crate) struct Shadows {
    pub pass: Pass,
    pub format: ChosenFormat,
    pub maps: ShadowMaps,
    pub pipelines: CasterPipelines,
    pub view_group: wgpu::BindGroup,
    /// Draws of each view.
    pub casters: Vec<Vec<Batch>>,
}

/// A scene made ready for one GPU.
#[derive(Debug)]
pub struct Renderer<'a> {
    pub(crate) gpu: &'a Gpu,
    pub(crate) options: RenderOptions,
    pub(crate) geometry: Geometry,
    pub(crate) materials: Vec<MaterialEntry>,
    pub(crate) material_of_mesh: Vec<usize>,
    pub(crate) shadows: Option<Shadows>,
    pub(crate) targets: Targets,
    pub(crate) mesh_pipelines: MeshPipelines,
    pub(crate) screen: Option<wgpu::RenderPipeline>,
    pub(crate) frame_group: wgpu::BindGroup,
    pub(crate) gbuffer_group: Option<wgpu::BindGroup>,
    pub(crate) instances: wgpu::Buffer,
    pub(crate) solid: Vec<Batch>,
    pub(crate) blended: Vec<Batch>,
    pub(crate) clip_from_world: Mat4,
    views: Vec<ShadowView>,
    exposure: f32,
    warnings: Vec<String>,
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
        let targets = Targets::new(&gpu.device, &options, !lit_at_once)?;

        check_given(scene, &options)?;
        let exposure = options.exposure.unwrap_or_else(|| automatic_exposure(scene));
        let storage = options.settings.combination.map_or(Storage::Auto, |c| c.storage);
        let format = choose_format(storage, |format| gpu.usages_of(format))?;
        let layouts =
            Layouts::new(&gpu.device, options.settings.combination.is_some() && format.storage.is_color());
        let geometry = Geometry::new(&gpu.device, scene);
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
        let items = Items::new(scene, &geometry, &materials, options.deform_reach_m);
        let seen_by = fit::Eye { camera: *camera, aspect: options.size.x as f32 / options.size.y as f32 };
        let lights =
            Lights::new(scene, &options.settings, format.storage, exposure, &items.bounds_world(), seen_by)?;
        let shown = shown_view(scene, &lights, &options)?;

        let eye = Eye::new(camera, &options, shown.as_ref().map(|(light, view)| (*light, view)));
        let frustum = Frustum::from_clip(eye.clip_from_world, DEPTH);
        let mut instances = Vec::new();
        let solid = items.solid(scene, &frustum, &mut instances);
        let blended = items.blended(scene, &frustum, eye.position, &mut instances);
        let all_casters = options.all_casters || options.view.shows_map();
        let casters: Vec<_> = lights
            .light_of_view
            .iter()
            .zip(&lights.views)
            .map(|of| items.casters(scene, of, all_casters, &mut instances))
            .collect();
        let shadows = make_shadows(gpu, &options, format, &lights, casters, &caster_layout)?;

        let needs = shader_needs(scene, &options, &lights);
        let mut mesh_pipelines = MeshPipelines::new(&gpu.device, &layouts, &needs);
        let solid_target =
            if lit_at_once { MeshTarget::Forward { samples: options.samples } } else { MeshTarget::Gbuffer };
        mesh_pipelines.prepare(&gpu.device, solid_target, solid.iter().map(|b| b.variant));
        if matches!(options.view, View::Final | View::Light) {
            let target = MeshTarget::Forward { samples: options.samples };
            mesh_pipelines.prepare(&gpu.device, target, blended.iter().map(|b| b.variant));
        }
        let screen = (!lit_at_once).then(|| screen_pipeline(&gpu.device, &layouts, &needs, options.view));

        let frame = eye.frame(&options, lights.lights.len(), exposure);
        let slide_images: Vec<&Image> = lights.slides.iter().map(|i| &scene.images[*i]).collect();
        let frame_group =
            frame_group(gpu, &layouts, &frame, &lights, shadows.as_ref(), &options, &slide_images);
        let gbuffer_group = gbuffer_group(gpu, &layouts, &targets);
        let instances = gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("instances"),
            contents: if instances.is_empty() { &[0; 48] } else { bytemuck::cast_slice(&instances) },
            usage: wgpu::BufferUsages::VERTEX,
        });
        gpu.check()?;
        let mut warnings = lights.warnings;
        if options.samples > 1 && !lit_at_once {
            let id = options.view.id();
            warnings
                .push(format!("the view `{id}` has one sample a pixel; {} were asked for", options.samples));
        }
        Ok(Self {
            gpu,
            material_of_mesh: scene.meshes.iter().map(|m| m.material).collect(),
            geometry,
            materials,
            shadows,
            targets,
            mesh_pipelines,
            screen,
            frame_group,
            gbuffer_group,
            instances,
            solid,
            blended,
            clip_from_world: eye.clip_from_world,
            views: lights.views,
            exposure,
            warnings,
            options,
        })
    }

    /// Memory of all shadow maps, bytes.
    pub fn shadow_memory_bytes(&self) -> u64 {
        self.shadows.as_ref().map_or(0, |s| s.maps.memory_bytes())
    }

    /// The depth format that the maps got, and why. `None` without maps.
    pub fn map_format(&self) -> Option<&ChosenFormat> {
        self.shadows.as_ref().map(|s| &s.format)
    }

    /// The views of the lights that got one.
    pub fn views(&self) -> &[ShadowView] {
        &self.views
    }

    /// Factor from radiance to picture.
    pub fn exposure(&self) -> f32 {
        self.exposure
    }

    /// What did not go as a user may expect.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// What solid and blended surfaces, and each view's casters, ask of the GPU.
    pub(crate) fn work_of(&self, batches: &[Batch]) -> Work {
        Work::of(batches, &self.geometry)
    }
}

/// What the shaders of a scene must be able to do, and no more.
fn shader_needs(scene: &Scene, options: &RenderOptions, lights: &Lights) -> ShaderNeeds {
    let used = || scene.meshes.iter().map(|mesh| &scene.materials[mesh.material].reflectance);
    let is_blinn = |r: &Reflectance| options.all_blinn || matches!(r, Reflectance::Blinn { .. });
    ShaderNeeds {
        combination: options.settings.combination,
        given: options.given.is_some(),
        metallic_roughness: used().any(|r| !is_blinn(r)),
        blinn: used().any(is_blinn),
        placed: scene.lights.iter().any(|l| l.light.kind != LightKind::Directional),
        slide: !lights.slides.is_empty(),
        lights: lights.lights.len(),
        point: scene.lights.iter().any(|l| l.light.kind == LightKind::Point),
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

    fn frame(&self, options: &RenderOptions, light_count: usize, exposure: f32) -> GpuFrame {
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
            time_s: options.time_s,
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
    let gbuffer = targets.gbuffer.as_ref()?;
    Some(gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("gbuffer"),
        layout: &layouts.gbuffer,
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(gbuffer) },
            wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(&targets.depth) },
        ],
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
    if fits && options.settings.combination.is_none() {
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
    scene: &Scene,
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
        Some(view) => Ok(Some((scene.lights[index].light, lights.views[view]))),
        None if options.view.needs_map() => Err(RenderError::View(format!(
            "the view `{id}` needs a shadow map, and light {index} has none with technique `{}`",
            options.settings.technique.id
        ))),
        None => Ok(None),
    }
}

fn make_shadows(
    gpu: &Gpu,
    options: &RenderOptions,
    format: ChosenFormat,
    lights: &Lights,
    casters: Vec<Vec<Batch>>,
    caster_layout: &wgpu::BindGroupLayout,
) -> Result<Option<Shadows>, RenderError> {
    let Some(pass) = plan(&options.settings).into_iter().find(|pass| pass.draws == Draws::Casters) else {
        return Ok(None);
    };
    if lights.views.is_empty() {
        return Ok(None);
    }
    let maps =
        ShadowMaps::new(&gpu.device, &format, options.settings.map_size_texel(), lights.views.len() as u32)?;
    let deform = options.deform.as_deref().unwrap_or(NO_DEFORM);
    let pipelines = CasterPipelines::new(&gpu.device, &format, &pass, caster_layout, deform);
    let stride = GpuCasterView::STRIDE as usize;
    let mut matrices = vec![0u8; lights.views.len() * stride];
    for (view, slot) in lights.views.iter().zip(matrices.chunks_mut(stride)) {
        let view = GpuCasterView::new(view, &pass, options.time_s);
        slot[..size_of_val(&view)].copy_from_slice(bytemuck::bytes_of(&view));
    }
    let matrices = gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some("caster views"),
        contents: &matrices,
        usage: wgpu::BufferUsages::UNIFORM,
    });
    let view_group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("caster view"),
        layout: &pipelines.view_layout,
        entries: &[wgpu::BindGroupEntry {
            binding: 0,
            resource: wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer: &matrices,
                offset: 0,
                size: std::num::NonZeroU64::new(size_of::<GpuCasterView>() as u64),
            }),
        }],
    });
    Ok(Some(Shadows { pass, format, maps, pipelines, view_group, casters }))
}

fn frame_group(
    gpu: &Gpu,
    layouts: &Layouts,
    frame: &GpuFrame,
    lights: &Lights,
    shadows: Option<&Shadows>,
    options: &RenderOptions,
    slide_images: &[&Image],
) -> wgpu::BindGroup {
    let uniform = |label, contents: &[u8]| {
        gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some(label),
            contents,
            usage: wgpu::BufferUsages::UNIFORM,
        })
    };
    let mut gpu_lights = [GpuLight::zeroed(); MAX_LIGHTS];
    gpu_lights[..lights.lights.len()].copy_from_slice(&lights.lights);
    let frame = uniform("frame", bytemuck::bytes_of(frame));
    let gpu_lights = uniform("lights", bytemuck::cast_slice(&gpu_lights));
    // A binding cannot be empty.
    let none = [GpuView::zeroed()];
    let views = if lights.gpu_views.is_empty() { &none[..] } else { &lights.gpu_views };
    let gpu_views = gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some("views"),
        contents: bytemuck::cast_slice(views),
        usage: wgpu::BufferUsages::STORAGE,
    });
    let compare = umbrage::maps::comparison_sampler(&gpu.device);
    let point = umbrage::maps::point_sampler(&gpu.device);
    let slides = crate::textures::slides(&gpu.device, &gpu.queue, slide_images);
    let slide_sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("slide"),
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        ..Default::default()
    });
    let is_color = layouts.color_maps;
    // A binding cannot be empty: without maps one texel stands in, and no light refers to it.
    let stand_in = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("no maps"),
        size: wgpu::Extent3d { width: 1, height: 1, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: if is_color { wgpu::TextureFormat::R32Float } else { wgpu::TextureFormat::Depth32Float },
        usage: wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    let stand_in = stand_in.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        ..Default::default()
    });
    let maps = shadows.map_or(&stand_in, |s| s.maps.array());
    let given = crate::textures::given(&gpu.device, &gpu.queue, options);
    let entries = [
        frame.as_entire_binding(),
        gpu_lights.as_entire_binding(),
        gpu_views.as_entire_binding(),
        wgpu::BindingResource::TextureView(maps),
        wgpu::BindingResource::Sampler(&compare),
        wgpu::BindingResource::TextureView(&slides),
        wgpu::BindingResource::Sampler(&slide_sampler),
        wgpu::BindingResource::TextureView(&given),
        wgpu::BindingResource::Sampler(&point),
    ];
    let entries: Vec<_> =
        (0u32..).zip(entries).map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }).collect();
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("frame"),
        layout: &layouts.frame,
        entries: &entries,
    })
}
