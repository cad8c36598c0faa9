//! A parsed document with its bytes, and the words by which messages name its parts.

use super::buffers;
use crate::SceneError;
use gltf::json;
use std::borrow::Cow;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// What a file may ask for in decoded geometry before it is refused: a few hundred bytes of JSON can announce more
/// than any memory holds. 4 GiB is about 60 million vertices.
const GEOMETRY_BYTES_MAX: u64 = 4 << 30;

/// A parsed document and everything that its references to bytes lead to.
pub(super) struct Document<'a> {
    /// Where the file lies; companions are looked for beside it.
    pub(super) path: PathBuf,
    /// The JSON. Its references have been checked.
    pub(super) root: json::Root,
    /// For each buffer its bytes; `None` where an extension stands in for them.
    pub(super) buffers: Vec<Option<Cow<'a, [u8]>>>,
    /// Buffer views that were compressed, by index.
    pub(super) decompressed_views: HashMap<usize, Vec<u8>>,
    /// Accessors whose elements came out of a compressed mesh, tightly packed, by index.
    pub(super) decompressed_accessors: HashMap<usize, Vec<u8>>,
    /// What is left of [`GEOMETRY_BYTES_MAX`]. Atomic only so that pictures may be decoded meanwhile.
    budget: AtomicU64,
}

impl<'a> Document<'a> {
    /// Reads the buffers of a document whose references have been checked.
    pub(super) fn open(path: &Path, root: json::Root, bin: Option<&'a [u8]>) -> Result<Self, SceneError> {
        let buffers = buffers::read(path, &root, bin)?;
        Ok(Self {
            path: path.to_owned(),
            root,
            buffers,
            decompressed_views: HashMap::new(),
            decompressed_accessors: HashMap::new(),
            budget: AtomicU64::new(GEOMETRY_BYTES_MAX),
        })
    }

    /// Takes `count` elements of `size` bytes out of what a file may ask for.
    pub(super) fn charge(&self, count: usize, size: usize) -> Result<(), String> {
        let bytes = (count as u64).saturating_mul(size as u64);
        let rest = self.budget.load(Ordering::Relaxed).checked_sub(bytes);
        match rest {
            Some(rest) => {
                self.budget.store(rest, Ordering::Relaxed);
                Ok(())
            }
            None => Err(format!(
                "its geometry would take more than {} GiB once decoded; split the file",
                GEOMETRY_BYTES_MAX >> 30
            )),
        }
    }

    /// How messages name a mesh's part.
    pub(super) fn primitive_label(&self, mesh: usize, primitive: usize) -> String {
        let name = self.root.meshes.get(mesh).and_then(|m| m.name.as_ref());
        format!("{}, primitive {primitive}", label("mesh", mesh, name))
    }

    /// How messages name a node.
    pub(super) fn node_label(&self, node: usize) -> String {
        label("node", node, self.root.nodes.get(node).and_then(|n| n.name.as_ref()))
    }
}

/// `mesh 3 "Body"`, or `mesh 3` where the file gives no name.
pub(super) fn label(what: &str, index: usize, name: Option<&String>) -> String {
    match name.filter(|name| !name.is_empty()) {
        Some(name) => format!("{what} {index} \"{}\"", name.chars().take(60).collect::<String>()),
        None => format!("{what} {index}"),
    }
}

/// Names come from the file and may hold line ends and control characters; a message is one line.
pub(super) fn one_line(text: &str) -> String {
    text.chars()
        .map(|c| if c.is_control() || ('\u{2028}'..='\u{202E}').contains(&c) { ' ' } else { c })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn geometry_has_a_budget() {
        let document = Document::open(Path::new("x.gltf"), json::Root::default(), None).unwrap();
        document.charge(1 << 30, 3).unwrap();
        assert!(document.charge(1 << 30, 2).unwrap_err().contains("4 GiB"));
        document.charge(1 << 30, 1).unwrap();
        assert!(document.charge(1, 1).is_err() && document.charge(usize::MAX, usize::MAX).is_err());
    }

    #[test]
    fn messages_stay_on_one_line() {
        assert_eq!(one_line("a\nb\u{1b}[31m\u{2028}c"), "a b [31m c");
        assert_eq!(label("mesh", 3, Some(&"x".repeat(99))).len(), "mesh 3 \"\"".len() + 60);
    }
}
