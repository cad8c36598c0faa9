//! Wavefront OBJ with MTL.
//!
//! `scan` checks and tidies the text, `tobj` reads it, `polygons` cuts it into triangles, `assemble` joins everything
//! with the same material into one mesh: a file of a thousand small objects is a handful of draws.

mod assemble;
pub(crate) mod lines;
mod mtl;
mod polygons;
mod scan;
mod textures;

pub(crate) use polygons::newell;
pub(crate) use scan::{vertex, words};

use crate::{Instance, Scene, SceneError};
use std::path::Path;

/// More warnings than this help nobody.
const MAX_WARNINGS: usize = 20;

/// Refuses what cannot be loaded, in the same words.
pub(crate) fn check(path: &Path, bytes: &[u8]) -> Result<(), SceneError> {
    scanned(path, bytes).map(drop)
}

fn scanned(path: &Path, bytes: &[u8]) -> Result<scan::Scan, SceneError> {
    let scan = scan::scan(bytes).map_err(|what| SceneError::malformed(path, what))?;
    if scan.runs.is_empty() {
        let (vertices, others) = (scan.vertices, scan.points_and_lines);
        let what = format!(
            "{vertices} vertices, {others} points or lines and no faces; export it with its surfaces"
        );
        return Err(SceneError::NoTriangles { path: path.to_owned(), what });
    }
    Ok(scan)
}

/// Loads an `.obj` file whose bytes are `bytes`; `path` is where its companions lie.
pub(crate) fn load(path: &Path, bytes: &[u8]) -> Result<Scene, SceneError> {
    let mut scan = scanned(path, bytes)?;
    let options = tobj::LoadOptions { ignore_points: true, ignore_lines: true, ..Default::default() };
    let (models, _) = tobj::load_obj_buf(&mut scan.text.as_bytes(), &options, |_| Ok(Default::default()))
        .map_err(|e| SceneError::malformed(path, format!("{e}; export the file again")))?;
    // The text has done its work and may be large.
    scan.text = String::new();

    let mut scene = Scene {
        name: path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default(),
        ..Scene::default()
    };
    let material_of_run =
        mtl::Library::read(path, &scan.libraries, &mut scene.warnings).convert(&scan, &mut scene);
    scene.warnings.append(&mut scan.warnings);
    scene.meshes = assemble::meshes(&models, &scan, &material_of_run, &scene.materials, &mut scene.warnings)
        .ok_or_else(|| SceneError::malformed(path, "more than 4 thousand million corners; split the file"))?;
    scene.instances = (0..scene.meshes.len())
        .map(|mesh| Instance {
            name: scene.meshes[mesh].name.clone(),
            mesh,
            object: mesh as u32,
            ..Instance::default()
        })
        .collect();
    let more = scene.warnings.len().saturating_sub(MAX_WARNINGS);
    if more > 0 {
        scene.warnings.truncate(MAX_WARNINGS);
        scene.warnings.push(format!("{more} more of this kind"));
    }
    Ok(scene)
}

#[cfg(test)]
mod tests;
