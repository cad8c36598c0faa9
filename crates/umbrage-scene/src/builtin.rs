//! Scenes made from a seed, at any scale: nothing to download, and a shadow that is known beforehand.

use crate::{Scene, SceneError};

/// Builds `NAME` or `NAME?key=value&key=value`.
pub(crate) fn build(spec: &str) -> Result<Scene, SceneError> {
    Err(SceneError::Builtin(format!("builtin:{spec}: not built yet")))
}
