//! `KHR_lights_punctual`: lights in world space.

use super::document::{Document, label};
use super::nodes::Tree;
use crate::SceneLight;
use glam::Vec3;
use gltf::json::extensions::scene::khr_lights_punctual::{Light as JsonLight, Type};
use gltf::json::validation::Checked;
use std::f32::consts::FRAC_PI_2;
use umbrage_core::{Light, LightKind};

/// A cone of a right angle is allowed by glTF and cannot be projected; half a degree less can.
const OUTER_MAX_RAD: f32 = FRAC_PI_2 - 0.5 * std::f32::consts::PI / 180.0;

/// The lights of the drawn nodes. One that makes no sense is left out with a warning.
pub(super) fn read(document: &Document<'_>, tree: &Tree, warnings: &mut Vec<String>) -> Vec<SceneLight> {
    let defined =
        document.root.extensions.iter().flat_map(|e| &e.khr_lights_punctual).flat_map(|l| &l.lights);
    let defined: Vec<&JsonLight> = defined.collect();
    let mut lights = Vec::new();
    for &node in &tree.drawn {
        let json = &document.root.nodes[node];
        let Some(index) = json.extensions.iter().flat_map(|e| &e.khr_lights_punctual).next() else {
            continue;
        };
        let index = index.light.value();
        let name = defined[index].name.as_ref().or(json.name.as_ref());
        let placed = place(defined[index], &tree.world[node]).and_then(|light| match light.check() {
            Ok(()) => Ok(light),
            Err(e) => Err(e.to_string()),
        });
        match placed {
            Ok(light) => {
                lights.push(SceneLight { name: name.cloned().unwrap_or_default(), light, cookie: None })
            }
            Err(e) => warnings.push(format!("{}: {e}; it is left out", label("light", index, name))),
        }
    }
    lights
}

fn place(json: &JsonLight, world_from_light: &glam::Mat4) -> Result<Light, String> {
    let kind = match json.type_ {
        Checked::Valid(Type::Directional) => LightKind::Directional,
        Checked::Valid(Type::Point) => LightKind::Point,
        Checked::Valid(Type::Spot) => {
            let spot = json.spot.as_ref().ok_or("a spot light needs `spot`")?;
            let outer_rad = spot.outer_cone_angle.min(OUTER_MAX_RAD);
            LightKind::Spot { inner_rad: spot.inner_cone_angle.min(outer_rad), outer_rad }
        }
        Checked::Invalid => return Err("its type is none of directional, point and spot".into()),
    };
    let axis = |axis: Vec3| world_from_light.transform_vector3(axis).try_normalize();
    Ok(Light {
        kind,
        position_world: world_from_light.w_axis.truncate(),
        direction_world: axis(Vec3::NEG_Z).ok_or("its node is scaled to nothing")?,
        up_world: axis(Vec3::Y).ok_or("its node is scaled to nothing")?,
        color: Vec3::from(json.color),
        intensity: json.intensity,
        range_m: json.range,
        ..Light::default()
    })
}
