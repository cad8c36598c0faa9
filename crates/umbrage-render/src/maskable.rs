//! Which objects of a scene may have masks, of which options, and how many.

use crate::geometry::caster_cutoff;
use crate::masks::MOST_MASKS;
use umbrage::core::fit::{MaskError, MaskOptions, fit_mask};
use umbrage::core::technique::mask::{Aim, Mask, Ratios};
use umbrage::core::technique::{Method, Settings};
use umbrage::core::{Aabb, Light, fit};
use umbrage_scene::{Mesh, Scene};

/// Memory that masks may take, bytes.
const MOST_BYTES: u64 = 512 << 20;

/// How a technique fits its masks, in a scene of that box.
pub fn mask_options(choices: &Mask, size_texel: u32, scene_world: &Aabb) -> MaskOptions {
    MaskOptions {
        size_texel,
        frame: match choices.aim {
            Aim::Mean => fit::Frame::Mean,
            Aim::Box => fit::Frame::Box,
        },
        ratios: match choices.ratios {
            Ratios::Adaptive => fit::Ratios::Adaptive,
            Ratios::Symmetric => fit::Ratios::Symmetric,
            Ratios::Fixed => fit::Ratios::Fixed,
        },
        fixed_half_m: scene_world.radius().max(1e-6),
        ..MaskOptions::default()
    }
}

/// Most masks of a light, when so many lights have some of such a size.
pub fn most_of_light(lights: usize, size_texel: u32) -> usize {
    let of_memory = (MOST_BYTES / (u64::from(size_texel) * u64::from(size_texel)).max(1)) as usize;
    (MOST_MASKS.min(of_memory.max(1)) / lights.max(1)).max(1)
}

/// For each instance: is it a part of an object that a light cannot mask, though it shines on it? With the reason of the first.
/// Vertices may be moved by `reach_m`.
pub(crate) fn unmaskable(scene: &Scene, settings: &Settings, reach_m: f32) -> (Vec<bool>, Option<String>) {
    let mut by_map = vec![false; scene.instances.len()];
    let mut reason = None;
    let Method::Mask(choices) = settings.method else { return (by_map, reason) };
    let size_texel = settings.value("mask_size").map_or(512, |size| size as u32);
    let options = mask_options(&choices, size_texel, &scene.bounds());
    let lights = scene.lights.len().min(crate::MAX_LIGHTS);
    let boxes: Vec<Aabb> = scene
        .instances
        .iter()
        .map(|placed| scene.meshes[placed.mesh].bounds.transformed(&placed.world_from_object))
        .map(|bounds| Aabb { min: bounds.min - reach_m, max: bounds.max + reach_m })
        .collect();
    let mut objects: Vec<Vec<usize>> = vec![Vec::new(); scene.objects() as usize];
    for (number, placed) in scene.instances.iter().enumerate().filter(|(_, placed)| placed.roles.blocker) {
        objects[placed.object as usize].push(number);
    }
    let box_of = |object: &[usize]| object.iter().fold(Aabb::EMPTY, |all, i| all.union(&boxes[*i]));
    let is_idle = |light: &Light, object: &[usize]| {
        object.iter().all(|number| crate::draw_list::is_flat_and_idle(scene, light, *number, &boxes))
    };
    let mut wanted = 0;
    objects.sort_by(|a, b| box_of(b).radius().total_cmp(&box_of(a).radius()));
    for object in objects.iter().filter(|object| !object.is_empty()) {
        let active: Vec<&Light> = scene
            .lights
            .iter()
            .take(lights)
            .map(|placed| &placed.light)
            .filter(|light| !is_idle(light, object))
            .collect();
        let failed = active.iter().find_map(|light| {
            let fitted = fit_mask(light, box_of(object).corners().into_iter(), &options);
            fitted.err().filter(|why| *why != MaskError::Unreached)
        });
        let too_many = wanted >= most_of_light(lights, size_texel);
        let why = failed.map(|why| why.to_string()).or_else(|| {
            too_many.then(|| {
                format!("a light has {} masks of this size at most", most_of_light(lights, size_texel))
            })
        });
        match why {
            Some(why) => {
                object.iter().for_each(|number| by_map[*number] = true);
                reason.get_or_insert(why);
            }
            None => wanted += usize::from(!active.is_empty()),
        }
    }
    (by_map, reason)
}

/// Is a mesh one whose triangles have contours inside of them?
pub(crate) fn has_holes(scene: &Scene, mesh: &Mesh) -> bool {
    caster_cutoff(&scene.materials[mesh.material]).is_some()
}
