//! From where a picture is seen: the camera, or the shown light.

use crate::layout::GpuFrame;
use crate::lights::{Lights, eye_of};
use crate::options::{RenderOptions, View};
use crate::{RenderError, exposure};
use glam::{Mat4, Vec3};
use umbrage::core::fit::ShadowView;
use umbrage::core::{Camera, DEPTH, Light};
use umbrage_scene::SceneLight;

/// The eye of the picture: the camera's, or the shown light's.
pub(crate) struct Eye {
    pub clip_from_world: Mat4,
    pub position: Vec3,
    towards: (Vec3, f32),
}

impl Eye {
    pub fn new(camera: &Camera, options: &RenderOptions, shown: Option<(Light, &ShadowView)>) -> Self {
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

    pub fn frame(&self, options: &RenderOptions, light_count: usize, exposure: f32, time_s: f32) -> GpuFrame {
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

/// The light that the debug views show, when they need one.
pub(crate) fn shown_view(
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
