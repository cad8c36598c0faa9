//! What draws the maps of a scene, made once.

use crate::geometry::Geometry;
use crate::gpu::Gpu;
use crate::maps::{Casting, MapMaker};
use crate::materials::MaterialEntry;
use crate::peeled::Peeled;
use crate::{RenderError, RenderOptions};
use std::sync::Arc;
use std::time::Duration;
use umbrage::caster::{CasterVertices, NO_DEFORM};
use umbrage::core::plan::{Draws, caster_passes, plan};
use umbrage::core::technique::Settings;
use umbrage::{CasterPipelines, ChosenFormat, TranslucentPipelines};
use umbrage_scene::Scene;

/// What draws the maps.
#[allow(clippy::too_many_arguments, reason = "a maker is made of all that it needs, and it has one caller")]
pub(crate) fn make_maker(
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
    let vertices = CasterVertices::deformed(options.deform.as_deref().unwrap_or(NO_DEFORM));
    let pipelines = CasterPipelines::new(&gpu.device, format, &pass, caster_layout, &vertices);
    let size_texel = settings.map_size_texel();
    let peel = |pass| Peeled::new(&gpu.device, pass, size_texel, caster_layout, &vertices);
    let mut tinting = plan(settings).into_iter().filter(|pass| pass.draws == Draws::Translucent);
    let translucent = match (tinting.next(), tinting.next()) {
        (Some(colors), Some(nearest)) => {
            let groups = [&pipelines.view_layout, caster_layout];
            let made = TranslucentPipelines::new(&gpu.device, format, &colors, groups, &vertices);
            Some(([colors, nearest], made))
        }
        _ => None,
    };
    Ok(Some(Casting { peeled: peel_pass.map(peel).transpose()?, pass, pipelines, translucent }))
}
