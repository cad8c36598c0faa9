//! Which objects of a scene may have masks.

use crate::draw_list::is_flat_and_idle;
use crate::geometry::caster_cutoff;
use umbrage::core::fit::MaskOptions;
use umbrage::core::masks::{maskable, size_texel};
use umbrage::core::technique::{Method, Settings};
use umbrage::core::{Aabb, Light};
use umbrage_scene::{Mesh, Scene};

/// For each instance: is it a part of an object that a light cannot mask, though it shines on it? With the reason of the first.
/// Vertices may be moved by `reach_m`.
pub(crate) fn unmaskable(scene: &Scene, settings: &Settings, reach_m: f32) -> (Vec<bool>, Option<String>) {
    let mut by_map = vec![false; scene.instances.len()];
    let Method::Mask(choices) = settings.method else { return (by_map, None) };
    let Some(size_texel) = size_texel(settings) else { return (by_map, None) };
    let options = MaskOptions::of(&choices, size_texel, &scene.bounds());
    let lights: Vec<Light> = scene.lights.iter().take(crate::MAX_LIGHTS).map(|placed| placed.light).collect();
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
    objects.retain(|object| !object.is_empty());
    let box_of = |object: &Vec<usize>| object.iter().fold(Aabb::EMPTY, |all, i| all.union(&boxes[*i]));
    let blockers: Vec<Aabb> = objects.iter().map(box_of).collect();
    let found = maskable(&lights, &blockers, &options, |light, object| {
        let light = &lights[light];
        !objects[object].iter().all(|number| is_flat_and_idle(scene, light, *number, &boxes))
    });
    for (object, why) in objects.iter().zip(&found.why) {
        object.iter().for_each(|number| by_map[*number] = why.is_some());
    }
    (by_map, found.first.map(|why| why.to_string()))
}

/// Is a mesh one whose triangles have contours inside of them?
pub(crate) fn has_holes(scene: &Scene, mesh: &Mesh) -> bool {
    caster_cutoff(&scene.materials[mesh.material]).is_some()
}
