//! Scenes for Umbrage: glTF 2.0, Wavefront OBJ, and built-in ones made from a seed.
//!
//! [`load`] takes what a user types (a path or `builtin:NAME`) and gives a [`Scene`]: flat lists, world space, no GPU.
//! [`load_at`] gives a moment of one of its animations.

mod builtin;
mod check;
mod closed;
mod defaults;
mod error;
mod flat;
mod gltf;
mod hull;
mod normals;
mod obj;
mod outline;
mod pose;
pub mod scene;
mod split;
mod tangents;

pub use builtin::{Builtin, builtins};
pub use closed::is_closed;
pub use defaults::{add_defaults, add_ground};
pub use error::SceneError;
pub use flat::plane_of;
pub use outline::Outline;
pub use pose::Pose;
pub use scene::*;
pub use split::{SplitCounts, SplitObj, split_obj};

/// Loads what a user typed: `builtin:NAME`, or the path of a `.gltf`, `.glb` or `.obj` file. Animated files are at rest.
///
/// # Errors
/// One line that names the file, the reason and the way out. Whatever the bytes are, this returns.
pub fn load(spec: &str) -> Result<Scene, SceneError> {
    read(spec, None)
}

/// As [`load`], at a moment of an animation: nodes with their lights and cameras, joints and morph weights are where
/// its channels put them (`LINEAR`, `STEP` and `CUBICSPLINE`), all else is at rest. [`Scene::playing`] says what was
/// found. A scene without animations is at rest, with a warning.
///
/// Everything is read anew; the cost is that of [`load`].
///
/// # Errors
/// As [`load`]; [`SceneError::Pose`] where there is no such animation or the time is not finite, and
/// [`SceneError::Malformed`] where the animation cannot be played.
pub fn load_at(spec: &str, pose: &Pose) -> Result<Scene, SceneError> {
    pose.check(spec)?;
    let mut scene = read(spec, Some(pose))?;
    if scene.playing.is_none() {
        pose.without_animations(spec, &mut scene)?;
    }
    Ok(scene)
}

fn read(spec: &str, pose: Option<&Pose>) -> Result<Scene, SceneError> {
    if let Some(name) = spec.strip_prefix("builtin:") {
        return builtin::build(name);
    }
    let path = std::path::Path::new(spec);
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    ordinary(path)?;
    let read = || std::fs::read(path).map_err(|e| SceneError::read(path, &e));
    let scene = match ending.as_str() {
        "gltf" | "glb" => gltf::load(path, &read()?, pose)?,
        "obj" => {
            let mut scene = obj::load(path, &read()?)?;
            let uv_set =
                |mesh: &Mesh| scene.materials[mesh.material].normal_texture.map(|texture| texture.uv_set);
            let uv_sets: Vec<_> = scene.meshes.iter().map(uv_set).collect();
            tangents::generate_all(&mut scene.meshes, &uv_sets);
            scene
        }
        _ => {
            return Err(SceneError::UnknownFormat {
                path: path.to_owned(),
                reason: "not a scene that is known by its ending; .gltf, .glb and .obj are".into(),
            });
        }
    };
    check::check(scene, path)
}

/// Refuses folders, pipes and devices, before anything is read: they might never end.
fn ordinary(path: &std::path::Path) -> Result<(), SceneError> {
    let about = std::fs::metadata(path).map_err(|e| SceneError::read(path, &e))?;
    if about.is_dir() {
        return Err(SceneError::read(path, &std::io::ErrorKind::IsADirectory.into()));
    }
    if !about.is_file() {
        let reason = "it is no ordinary file; copy its contents to one".to_owned();
        return Err(SceneError::Read { path: path.to_owned(), reason });
    }
    Ok(())
}
