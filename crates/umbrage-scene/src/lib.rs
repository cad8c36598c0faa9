//! Scenes for Umbrage: glTF 2.0, Wavefront OBJ, and built-in ones made from a seed.
//!
//! [`load`] takes what a user types (a path or `builtin:NAME`) and gives a [`Scene`]: flat lists, world space, no GPU.

mod builtin;
mod check;
mod closed;
mod defaults;
mod error;
mod gltf;
mod normals;
mod obj;
pub mod scene;
mod tangents;

pub use builtin::{Builtin, builtins};
pub use closed::is_closed;
pub use defaults::{add_defaults, add_ground};
pub use error::SceneError;
pub use scene::*;

/// Loads what a user typed: `builtin:NAME`, or the path of a `.gltf`, `.glb` or `.obj` file.
///
/// # Errors
/// One line that names the file, the reason and the way out. Whatever the bytes are, this returns.
pub fn load(spec: &str) -> Result<Scene, SceneError> {
    if let Some(name) = spec.strip_prefix("builtin:") {
        return builtin::build(name);
    }
    let path = std::path::Path::new(spec);
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    // Before it is read: a pipe or a device might never end.
    let about = std::fs::metadata(path).map_err(|e| SceneError::read(path, &e))?;
    if about.is_dir() {
        return Err(SceneError::read(path, &std::io::ErrorKind::IsADirectory.into()));
    }
    if !about.is_file() {
        let reason = "it is no ordinary file; copy its contents to one".to_owned();
        return Err(SceneError::Read { path: path.to_owned(), reason });
    }
    let read = || std::fs::read(path).map_err(|e| SceneError::read(path, &e));
    let scene = match ending.as_str() {
        "gltf" | "glb" => gltf::load(path, &read()?)?,
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
