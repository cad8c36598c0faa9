//! Lights on the GPU: each with its view, if it gets one, and what to tell the user when it does not.

use crate::layout::{DIRECTIONAL, GpuLight, MAX_LIGHTS, POINT, SPOT};
use bytemuck::Zeroable;
use glam::{Mat4, Vec3};
use umbrage::core::fit::{Eye, FitOptions, ShadowView, fit, fit_places};
use umbrage::core::layout::GpuView;
use umbrage::core::lookup::{TextureOrigin, texture_from_world};
use umbrage::core::projection::perspective;
use umbrage::core::technique::{Projection, Settings, Storage};
use umbrage::core::{Aabb, DEPTH, Light, LightKind};
use umbrage_scene::SceneLight;

/// The lights of a frame.
#[derive(Debug, Default)]
pub struct Lights {
    /// One for each light.
    pub lights: Vec<GpuLight>,
    /// One for each map.
    pub gpu_views: Vec<GpuView>,
    /// The view of each map, in the order of the layers.
    pub views: Vec<ShadowView>,
    /// The light of each map: with several places, the light at that place.
    pub light_of_view: Vec<Light>,
    /// The views of each light; empty without a map.
    pub views_of_light: Vec<std::ops::Range<usize>>,
    /// Images of the slides, in the order of their layers.
    pub slides: Vec<usize>,
    /// What did not go as the user may expect.
    pub warnings: Vec<String>,
}

/// The lookup matrix of a slide: it fills the light's whole cone, or the scene's box for parallel light.
fn slide_from_world(light: &Light, view: Option<&ShadowView>) -> Mat4 {
    let clip_from_world = match light.kind {
        LightKind::Spot { outer_rad, .. } => {
            let world_from_light = Mat4::from_translation(light.position_world)
                * Mat4::from_mat3(light.world_from_light_rotation());
            perspective(outer_rad.tan(), outer_rad.tan(), 0.5, 2.0, DEPTH) * world_from_light.inverse()
        }
        _ => view.map_or(Mat4::IDENTITY, ShadowView::clip_from_world),
    };
    texture_from_world(clip_from_world, DEPTH, TextureOrigin::TopLeft)
}

fn gpu_light(
    light: &Light,
    exposure: f32,
    view: Option<(usize, &ShadowView)>,
    places: usize,
    slide: Option<usize>,
) -> GpuLight {
    let (kind, inner_rad, outer_rad) = match light.kind {
        LightKind::Directional => (DIRECTIONAL, 0.0, std::f32::consts::PI),
        LightKind::Point => (POINT, 0.0, std::f32::consts::PI),
        LightKind::Spot { inner_rad, outer_rad } => (SPOT, inner_rad, outer_rad),
    };
    let cone_scale = 1.0 / (inner_rad.cos() - outer_rad.cos()).max(1e-3);
    GpuLight {
        slide_from_world: slide_from_world(light, view.map(|v| v.1)),
        position: light.position_world,
        kind,
        direction: light.direction_world.normalize(),
        range_m: light.range_m.unwrap_or(0.0),
        color: light.color * light.intensity * exposure,
        view: view.map_or(-1, |v| v.0 as i32),
        cone_scale,
        cone_offset: -outer_rad.cos() * cone_scale,
        cos_outer: outer_rad.cos(),
        slide: slide.map_or(-1, |s| s as i32),
        near_m: view.map_or(0.0, |v| v.1.near_m),
        far_m: view.map_or(0.0, |v| v.1.far_m),
        places: places as u32,
        ..GpuLight::zeroed()
    }
}

impl Lights {
    /// Fits a view to each light that the settings shadow.
    ///
    /// # Errors
    /// A light whose numbers cannot be used.
    pub fn new(
        scene_lights: &[SceneLight],
        settings: &Settings,
        storage: Storage,
        exposure: f32,
        bounds_world: &[Aabb],
        eye: Eye,
    ) -> Result<Self, umbrage::core::LightError> {
        let mut made = Self {
            lights: Vec::new(),
            gpu_views: Vec::new(),
            views: Vec::new(),
            light_of_view: Vec::new(),
            views_of_light: Vec::new(),
            slides: Vec::new(),
            warnings: Vec::new(),
        };
        if scene_lights.len() > MAX_LIGHTS {
            let left_out = scene_lights.len() - MAX_LIGHTS;
            made.warnings.push(format!("{left_out} lights are left out; a picture has {MAX_LIGHTS} at most"));
        }
        for (index, placed) in scene_lights.iter().take(MAX_LIGHTS).enumerate() {
            let light = &placed.light;
            light.check()?;
            let first = made.views.len();
            let mut places = 0;
            if let Some(combination) = settings.combination() {
                let placed = fit_places(light, settings, storage, bounds_world, Some(eye));
                match placed {
                    Ok(placed) => {
                        places = placed.places as usize;
                        made.light_of_view.extend(placed.views.iter().map(|(place, _)| *place));
                        made.views.extend(placed.views.iter().map(|(_, view)| *view));
                        let failed = placed.failures.iter().map(|error| format!("light {index}: {error}"));
                        made.warnings.extend(failed);
                    }
                    Err(error) => made.warnings.push(format!("light {index}: {error}")),
                }
                if let Some((view, why)) = made.views.get(first).and_then(|v| v.fallback.map(|why| (v, why)))
                {
                    let (asked, got) = (combination.projection.row().id, view.projection.row().id);
                    made.warnings.push(format!("light {index}: {why}: `{got}` instead of `{asked}`"));
                }
            }
            let views = first..made.views.len();
            let slide = placed.cookie.map(|image| {
                made.slides.push(image);
                made.slides.len() - 1
            });
            let view = made.views.get(first).map(|view| (first, view));
            let mut on_gpu = gpu_light(light, exposure, view, places, slide);
            if slide.is_some() && view.is_some_and(|(_, view)| view.projection != Projection::Fitted) {
                // A slide stays where it is when the eye moves.
                let whole = fit(light, bounds_world, &FitOptions::default()).ok();
                on_gpu.slide_from_world = slide_from_world(light, whole.as_ref());
            }
            made.lights.push(on_gpu);
            made.gpu_views
                .extend(views.clone().map(|i| GpuView::new(&made.views[i], i as u32, settings, storage)));
            made.views_of_light.push(views);
        }
        Ok(made)
    }

    /// The lights as they are now over the views as they were: a map that is older than the frame is looked up where it
    /// was drawn, while its light shines from where it is.
    pub fn relit(&self, scene_lights: &[SceneLight], exposure: f32) -> Vec<GpuLight> {
        let relit = |(made, placed): (&GpuLight, &SceneLight)| {
            let now = gpu_light(&placed.light, exposure, None, 0, None);
            let is_spot = made.kind == SPOT;
            GpuLight {
                position: now.position,
                direction: now.direction,
                range_m: now.range_m,
                color: now.color,
                cone_scale: now.cone_scale,
                cone_offset: now.cone_offset,
                cos_outer: now.cos_outer,
                slide_from_world: if is_spot { now.slide_from_world } else { made.slide_from_world },
                ..*made
            }
        };
        self.lights.iter().zip(scene_lights).map(relit).collect()
    }
}

/// Where the eye is: a place and 1, or the direction towards it and 0.
pub fn eye_of(camera: &umbrage::core::Camera) -> (Vec3, f32) {
    match camera.projection {
        umbrage::core::Projection::Perspective { .. } => (camera.position_world, 1.0),
        umbrage::core::Projection::Orthographic { .. } => (-camera.direction_world, 0.0),
    }
}
