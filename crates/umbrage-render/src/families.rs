//! Which family draws which caster: the technique's own, or maps for what that cannot draw.

use crate::maskable::{has_holes, unmaskable};
use crate::{RenderError, RenderOptions};
use umbrage::core::technique::mask::Receivers;
use umbrage::core::technique::{DEFAULT, Method, NO_SHADOW, Settings};
use umbrage_scene::{Instance, Scene};

/// Is V found on the screen before surfaces are lit?
pub(crate) fn is_on_screen(settings: &Settings) -> bool {
    match settings.method {
        Method::Volume(_) => true,
        Method::Mask(mask) => mask.receivers == Receivers::Subtractive,
        Method::None | Method::Map(_) => false,
    }
}

/// For each instance: can only a map draw its shadow? And why. Volumes know no holes, and nothing of what a function moves;
/// masks nothing of what a light is inside of.
pub(crate) fn by_map(scene: &Scene, options: &RenderOptions) -> (Vec<bool>, Option<String>) {
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
pub(crate) fn by_mesh(scene: &Scene, by_map: &[bool]) -> Vec<bool> {
    let mut by_mesh = vec![false; scene.meshes.len()];
    let placed = scene.instances.iter().zip(by_map);
    placed.for_each(|(placed, by_map)| by_mesh[placed.mesh] |= by_map);
    by_mesh
}

/// What maps are drawn with: the technique itself, or what takes over for casters that it cannot draw; nothing where there are none.
pub(crate) fn map_settings(settings: &Settings, by_map: &[bool]) -> Result<Settings, RenderError> {
    match settings.fallback() {
        None => Ok(settings.clone()),
        Some(fallback) if by_map.contains(&true) => Ok(fallback),
        Some(_) => Settings::new(NO_SHADOW, []).map_err(|e| RenderError::View(e.to_string())),
    }
}

/// Which casters a map draws though the technique is none.
pub(crate) fn fallback_warnings(
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
