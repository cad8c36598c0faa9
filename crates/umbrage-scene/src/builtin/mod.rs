//! Scenes made from a seed, at any scale: nothing to download, and a shadow that is known beforehand.
//!
//! Each scene is built in metres at scale 1, one file each; [`build`] then multiplies every length. Seed 0 is the plain
//! layout, other seeds vary it a little.

mod columns;
mod contact;
mod knots;
mod random;
mod shapes;
mod tilt;
mod torus;

use crate::{Instance, Material, Mesh, Reflectance, Scene, SceneCamera, SceneError, SceneLight};
use glam::{Mat4, Vec3};
use random::Random;
use std::ops::RangeInclusive;
use umbrage_core::{Aabb, Camera, Light, LightKind};

/// A scene that needs no file.
#[derive(Clone, Copy, Debug)]
pub struct Builtin {
    /// What stands after `builtin:`.
    pub name: &'static str,
    /// One line for a list.
    pub summary: &'static str,
    make: fn(&mut Random) -> Scene,
}

const BUILTINS: [Builtin; 5] = [
    Builtin {
        name: "torus",
        summary: "a torus floating before a floor and a wall, a ball on a pedestal (the default)",
        make: torus::make,
    },
    Builtin {
        name: "columns",
        summary: "a colonnade of thick and thin columns with beams and an arch",
        make: columns::make,
    },
    Builtin {
        name: "tilt",
        summary: "planes turned from 0 to 89 degrees away from the light; none shadows another",
        make: tilt::make,
    },
    Builtin {
        name: "contact",
        summary: "boxes, balls, thin walls and a leaning board that touch the ground and each other",
        make: contact::make,
    },
    Builtin {
        name: "knots",
        summary: "100 torus knots and a ball over a ground of 20 m, for comparing costs",
        make: knots::make,
    },
];

/// Factors that `scale` may have.
const SCALES: RangeInclusive<f32> = 0.01..=1000.0;

/// What a scene's specification may set.
const KEYS: [&str; 2] = ["scale", "seed"];

/// All scenes that `builtin:NAME` knows; the first is the default scene.
pub fn builtins() -> &'static [Builtin] {
    &BUILTINS
}

/// Builds `NAME` or `NAME?key=value&key=value`.
pub(crate) fn build(spec: &str) -> Result<Scene, SceneError> {
    let (name, query) = spec.split_once('?').unwrap_or((spec, ""));
    let builtin = BUILTINS.iter().find(|b| b.name == name).ok_or_else(|| {
        let names: Vec<&str> = BUILTINS.iter().map(|b| b.name).collect();
        refuse(spec, &format!("there is no built-in scene of that name{}", nearest(name, &names)))
    })?;
    let (mut scale, mut seed) = (1.0f32, 0u64);
    for pair in query.split('&').filter(|pair| !pair.is_empty()) {
        let (key, value) = pair.split_once('=').unwrap_or((pair, ""));
        match key {
            "scale" => {
                let number = value.parse().ok().filter(|x| SCALES.contains(x));
                scale = number.ok_or_else(|| refuse(spec, "scale is a number from 0.01 to 1000"))?;
            }
            "seed" => {
                let number = value.parse().ok();
                seed = number.ok_or_else(|| refuse(spec, "seed is a whole number, 0 or more"))?;
            }
            _ => {
                let what = format!("there is no parameter of that name{}", nearest(key, &KEYS));
                return Err(refuse(spec, &what));
            }
        }
    }
    let mut scene = (builtin.make)(&mut Random::new(seed));
    scene.name = format!("builtin:{name}");
    scale_by(&mut scene, scale);
    Ok(scene)
}

fn refuse(spec: &str, what: &str) -> SceneError {
    let short: String = spec.chars().take(60).flat_map(char::escape_debug).collect();
    SceneError::Builtin(format!("builtin:{short}: {what}"))
}

/// The name that was probably meant, and all that there are.
fn nearest(word: &str, known: &[&str]) -> String {
    // The comparison takes time and memory with the word's length; nobody means a name with a word of thousands.
    let word: String = word.chars().take(40).collect();
    let best = known.iter().map(|k| (strsim::jaro_winkler(&word, k), *k)).max_by(|a, b| a.0.total_cmp(&b.0));
    let guess = best.filter(|b| b.0 > 0.6).map(|b| format!("; did you mean {}?", b.1)).unwrap_or_default();
    format!("{guess} (there are: {})", known.join(", "))
}

/// Multiplies every length. The intensity grows with the square, so that surfaces are as bright as before.
fn scale_by(scene: &mut Scene, scale: f32) {
    for mesh in &mut scene.meshes {
        mesh.positions.iter_mut().for_each(|p| *p *= scale);
        mesh.bounds = Aabb::from_points(mesh.positions.iter().copied());
    }
    for instance in &mut scene.instances {
        let place = &mut instance.world_from_object.w_axis;
        *place = (place.truncate() * scale).extend(1.0);
    }
    for SceneLight { light, .. } in &mut scene.lights {
        light.position_world *= scale;
        light.shape = light.shape.scaled(scale);
        if light.kind != LightKind::Directional {
            light.intensity *= scale * scale;
        }
        for length in [&mut light.range_m, &mut light.near_m, &mut light.far_m].into_iter().flatten() {
            *length *= scale;
        }
    }
    for SceneCamera { camera, .. } in &mut scene.cameras {
        camera.position_world *= scale;
        camera.near_m *= scale;
        camera.far_m *= scale;
    }
}

/// A surface of one linear colour.
fn paint(name: &str, color: [f32; 3], roughness: f32) -> Material {
    Material {
        name: name.to_owned(),
        base_color: Vec3::from(color).extend(1.0),
        reflectance: Reflectance::MetallicRoughness { metallic: 0.0, roughness },
        ..Material::default()
    }
}

/// What every scene is made of.
#[derive(Default)]
struct Stage {
    scene: Scene,
}

impl Stage {
    fn material(&mut self, material: Material) -> usize {
        self.scene.materials.push(material);
        self.scene.materials.len() - 1
    }

    fn mesh(&mut self, mesh: Mesh) -> usize {
        self.scene.meshes.push(mesh);
        self.scene.meshes.len() - 1
    }

    fn instance(&mut self, name: &str, mesh: usize, world_from_object: Mat4) {
        let object = self.scene.instances.len() as u32;
        let name = name.to_owned();
        self.scene.instances.push(Instance { name, mesh, world_from_object, object, ..Instance::default() });
    }

    /// A shape that is drawn once, where it is.
    fn add(&mut self, name: &str, shape: shapes::Shape, material: usize) {
        let mesh = self.mesh(shape.into_mesh(name, material));
        self.instance(name, mesh, Mat4::IDENTITY);
    }

    /// Closes with the camera, and a white spot light that gives `lux` at its target.
    fn finish(mut self, camera: Camera, light: Light, target: Vec3, lux: f32) -> Scene {
        let intensity = lux * light.position_world.distance_squared(target);
        let light = Light { intensity, ..light };
        self.scene.cameras.push(SceneCamera { name: "camera".into(), camera });
        self.scene.lights.push(SceneLight { name: "spot".into(), light, cookie: None });
        self.scene
    }
}
