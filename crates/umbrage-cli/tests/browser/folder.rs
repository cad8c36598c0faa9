//! A folder that a test and its browser share.

use std::path::{Path, PathBuf};

/// Where a browser can read, too: one in a sandbox (snap) has a `/tmp` of its own.
pub const TEMPORARY: &str = env!("CARGO_TARGET_TMPDIR");

/// An empty folder that goes when the test ends.
pub struct Folder(pub PathBuf);

impl Folder {
    /// `name` tells it from those of other tests.
    pub fn new(name: &str) -> Self {
        let path = Path::new(TEMPORARY).join(format!("page {name} {}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).expect("a temporary folder");
        Self(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
