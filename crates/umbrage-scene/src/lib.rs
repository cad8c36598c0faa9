//! Scenes for Umbrage: glTF 2.0, Wavefront OBJ, and built-in ones made from a seed.
//!
//! [`load`] takes what a user types (a path or `builtin:NAME`) and gives a [`Scene`]: flat lists, world space, no GPU.

mod builtin;
mod defaults;
mod error;
mod gltf;
mod normals;
mod obj;
pub mod scene;

pub use builtin::{Builtin, builtins};
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
    let bytes = std::fs::read(path).map_err(|e| SceneError::read(path, &e))?;
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    match ending.as_str() {
        "gltf" | "glb" => gltf::load(path, &bytes),
        "obj" => obj::load(path, &bytes),
        _ => Err(SceneError::UnknownFormat {
            path: path.to_owned(),
            reason: "not a scene that is known by its ending; .gltf, .glb and .obj are".into(),
        }),
    }
}
