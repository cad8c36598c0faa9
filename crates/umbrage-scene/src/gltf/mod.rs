//! glTF 2.0 and GLB.
//!
//! The order below is the order of the work: container, extensions, references, bytes, node tree, meshes, materials,
//! pictures. Everything that can be wrong with a reference is settled before the first byte of geometry is read.

mod accessors;
mod assemble;
mod buffers;
mod cameras;
mod container;
mod document;
mod draco;
mod extensions;
mod geometry;
mod images;
mod instancing;
mod lights;
mod materials;
mod meshopt;
mod morph;
mod nodes;
mod references;
mod skin;
mod uri;

use crate::{Scene, SceneError};
use std::path::Path;

/// Loads a `.gltf` or `.glb` file whose bytes are `bytes`; `path` is where its companions lie.
///
/// The result still has to pass [`crate::check::check`].
pub(crate) fn load(path: &Path, bytes: &[u8]) -> Result<Scene, SceneError> {
    let malformed = |what: String| SceneError::malformed(path, document::one_line(&what));
    let (root, bin) = container::open(bytes).map_err(malformed)?;
    let mut warnings = Vec::new();
    extensions::check(&root, &mut warnings)
        .map_err(|what| SceneError::Unsupported { path: path.to_owned(), what: document::one_line(&what) })?;
    references::check(&root).map_err(malformed)?;
    let mut document = document::Document::open(path, root, bin)?;
    meshopt::decompress(&mut document).map_err(malformed)?;
    draco::decompress(&mut document).map_err(malformed)?;
    let mut scene = assemble::scene(&document, &mut warnings).map_err(malformed)?;
    scene.name = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    scene.warnings = warnings.iter().map(|warning| document::one_line(warning)).collect();
    Ok(scene)
}
