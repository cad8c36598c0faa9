//! glTF 2.0 and GLB.
//!
//! The order below is the order of the work: container, extensions, references, bytes, animation, node tree, meshes,
//! materials, pictures. Everything that can be wrong with a reference is settled before the first byte of geometry is read.

mod accessors;
mod animation;
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
mod roles;
mod sampler;
mod skin;
mod uri;

use crate::{Pose, Scene, SceneError};
use std::path::Path;

/// Loads a `.gltf` or `.glb` file whose bytes are `bytes`; `path` is where its companions lie. Without a pose it is at
/// rest.
///
/// The result still has to pass [`crate::check::check`].
pub(crate) fn load(path: &Path, bytes: &[u8], pose: Option<&Pose>) -> Result<Scene, SceneError> {
    let malformed = |what: String| SceneError::malformed(path, document::one_line(&what));
    let container::Container { root, text, bin } = container::open(bytes).map_err(malformed)?;
    let mut warnings = Vec::new();
    extensions::check(&root, &mut warnings)
        .map_err(|what| SceneError::Unsupported { path: path.to_owned(), what: document::one_line(&what) })?;
    references::check(&root).map_err(malformed)?;
    let mut document = document::Document::open(path, root, bin)?;
    meshopt::decompress(&mut document).map_err(malformed)?;
    draco::decompress(&mut document).map_err(malformed)?;
    let mut playing = None;
    if let Some(pose) = pose {
        let animations = animation::Animations::of(text).map_err(malformed)?;
        let chosen = animations
            .choose(pose.animation.as_deref())
            .map_err(|what| SceneError::Pose { path: path.to_owned(), what: document::one_line(&what) })?;
        if let Some(number) = chosen {
            let moment = animations.play(&mut document, number, pose, &mut warnings).map_err(malformed)?;
            playing = Some(moment);
        }
    }
    let mut scene = assemble::scene(&document, &mut warnings).map_err(malformed)?;
    scene.playing = playing;
    scene.name = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    scene.warnings = for_the_eye(&warnings);
    Ok(scene)
}

/// Each warning once, on one line, and no more than a person reads.
fn for_the_eye(warnings: &[String]) -> Vec<String> {
    const SHOWN: usize = 30;
    let mut seen = std::collections::HashSet::new();
    let mut lines: Vec<String> =
        warnings.iter().map(|w| document::one_line(w)).filter(|w| seen.insert(w.clone())).collect();
    if lines.len() > SHOWN {
        let more = lines.len() - SHOWN;
        lines.truncate(SHOWN);
        lines.push(format!("and {more} more of such kinds"));
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn warnings_are_said_once_and_not_without_end() {
        let twice = ["a\nb", "a\nb"].map(String::from);
        assert_eq!(for_the_eye(&twice), ["a b"]);
        let many: Vec<String> = (0..100).map(|i| i.to_string()).collect();
        assert_eq!(for_the_eye(&many).len(), 31);
    }
}
