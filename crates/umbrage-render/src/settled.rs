//! What a scene and its options ask of a renderer, checked and settled before anything is made.

use crate::families::{by_map, fallback_warnings, is_on_screen, map_settings};
use crate::gpu::Gpu;
use crate::layout::MAX_LIGHTS;
use crate::lights::Lights;
use crate::options::{RenderOptions, View};
use crate::pipelines::DEPTH_FORMAT;
use crate::shaders::ShaderNeeds;
use crate::targets::TargetNeeds;
use crate::{RenderError, exposure, overdraw, own_wgsl};
use glam::Vec3;
use umbrage::core::technique::{Combination, Method, Settings, Storage};
use umbrage::core::{Camera, Light, LightKind, LightShape};
use umbrage::{ChosenFormat, choose_format};
use umbrage_scene::{Instance, Reflectance, Scene};

/// All of it.
#[derive(Debug)]
pub(crate) struct Settled {
    pub targets: TargetNeeds,
    pub looks_up_masks: bool,
    pub exposure: f32,
    /// For each instance: can only a map draw its shadow?
    pub by_map: Vec<bool>,
    /// What maps are drawn with.
    pub maps: Settings,
    pub format: ChosenFormat,
    pub most_views: usize,
    /// What did not go as a user may expect, whatever moves.
    pub warnings: Vec<String>,
}

impl Settled {
    /// Looks at everything once.
    ///
    /// # Errors
    /// [`RenderError`] says which input cannot be used and what to do.
    pub fn new(
        gpu: &Gpu,
        scene: &Scene,
        camera: &Camera,
        options: &RenderOptions,
    ) -> Result<Self, RenderError> {
        camera.check().map_err(RenderError::Camera)?;
        check_samples(gpu, options.samples)?;
        check_given(scene, options)?;
        overdraw::check(options)?;
        options.deform.as_deref().map_or(Ok(()), own_wgsl::check_deform)?;
        options.kernel.as_deref().map_or(Ok(()), own_wgsl::check_kernel)?;
        let emits = scene.meshes.iter().any(|mesh| scene.materials[mesh.material].emissive != Vec3::ZERO);
        let lit_at_once = matches!(options.view, View::Final | View::Light) && (options.samples > 1 || emits);
        let on_screen = is_on_screen(&options.settings);
        let looks_up_masks = matches!(options.settings.method, Method::Mask(_)) && !on_screen;
        let depth = if on_screen { umbrage::volume::choose_count_format(&gpu.device) } else { DEPTH_FORMAT };
        let (by_map, why) = by_map(scene, options);
        let maps = map_settings(&options.settings, &by_map)?;
        let mut warnings = fallback_warnings(scene, options, &by_map, why);
        let (id, technique) = (options.view.id(), options.settings.technique.id);
        match options.samples {
            1 => {}
            asked if !lit_at_once => {
                warnings.push(format!("the view `{id}` has one sample a pixel; {asked} were asked for"));
            }
            asked if on_screen => warnings.push(format!(
                "`{technique}` has one V a pixel, that of its middle; {asked} samples smooth surfaces' edges, not shadows'"
            )),
            _ => {}
        }
        Ok(Self {
            targets: TargetNeeds {
                gbuffer: on_screen || !lit_at_once,
                lit_at_once,
                objects: looks_up_masks,
                depth,
            },
            looks_up_masks,
            exposure: options.exposure.unwrap_or_else(|| automatic_exposure(scene)),
            format: settled_format(gpu, options, &maps)?,
            most_views: most_views(scene, &maps),
            by_map,
            maps,
            warnings,
        })
    }
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
pub(crate) fn shader_needs(
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

/// The exposure that the scene's own lights and instances ask for.
fn automatic_exposure(scene: &Scene) -> f32 {
    let lights: Vec<Light> = scene.lights.iter().map(|l| l.light).collect();
    let middle = |i: &Instance| i.world_from_object.transform_point3(scene.meshes[i.mesh].bounds.center());
    exposure::automatic(&lights, &scene.bounds(), scene.instances.iter().map(middle))
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
