//! Why a scene cannot be loaded. Every message is one line: what is wrong, where, and what to do.

use std::path::{Path, PathBuf};

/// Why a scene cannot be loaded.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The file or one of its companions cannot be read.
    #[error("cannot read {}: {reason}", path.display())]
    Read {
        /// Which file.
        path: PathBuf,
        /// What the system said, and what to do.
        reason: String,
    },
    /// The file's ending is none that is known.
    #[error("{}: {reason}", path.display())]
    UnknownFormat {
        /// Which file.
        path: PathBuf,
        /// Which endings are known.
        reason: String,
    },
    /// The file breaks its format's rules.
    #[error("{}: {what}", path.display())]
    Malformed {
        /// Which file.
        path: PathBuf,
        /// What is wrong, where in the file, and what to do.
        what: String,
    },
    /// The file requires something that Umbrage does not have.
    #[error("{}: {what}", path.display())]
    Unsupported {
        /// Which file.
        path: PathBuf,
        /// What it requires, and what to do.
        what: String,
    },
    /// There is nothing to draw.
    #[error("{}: no triangles to draw: {what}", path.display())]
    NoTriangles {
        /// Which file.
        path: PathBuf,
        /// What was found instead.
        what: String,
    },
    /// The scene cannot be had in the pose that was asked for: no such animation, or no such time.
    #[error("{}: {what}", path.display())]
    Pose {
        /// Which file, or `builtin:NAME`.
        path: PathBuf,
        /// What was asked for, and what there is.
        what: String,
    },
    /// `builtin:NAME` with a name or parameter that does not exist.
    #[error("{0}")]
    Builtin(String),
}

impl SceneError {
    /// The file breaks its format's rules.
    pub(crate) fn malformed(path: &Path, what: impl Into<String>) -> Self {
        Self::Malformed { path: path.to_owned(), what: what.into() }
    }

    /// Reading failed: the system's word for it, without its number.
    pub(crate) fn read(path: &Path, error: &std::io::Error) -> Self {
        let reason = match error.kind() {
            std::io::ErrorKind::NotFound => "there is no such file; check the path".to_owned(),
            std::io::ErrorKind::PermissionDenied => "permission denied; check who may read it".to_owned(),
            std::io::ErrorKind::IsADirectory => {
                "it is a folder; name a .gltf, .glb or .obj file in it".to_owned()
            }
            _ => error.to_string(),
        };
        Self::Read { path: path.to_owned(), reason }
    }
}
