//! What the tests of this crate share.

use std::sync::{Mutex, MutexGuard, OnceLock};
use umbrage_render::Gpu;
use umbrage_render::umbrage::core::technique::Settings;
use umbrage_scene::Scene;

/// The software rasteriser, one test at a time. `None`, said loudly, where it is missing; a failure where
/// `UMBRAGE_GOLDEN_REQUIRED=1` says that it must not be.
pub fn gpu() -> Option<MutexGuard<'static, Gpu>> {
    static GPU: OnceLock<Result<Mutex<Gpu>, String>> = OnceLock::new();
    let made = GPU.get_or_init(|| Gpu::new(Some("llvmpipe")).map(Mutex::new).map_err(|e| e.to_string()));
    match made {
        Ok(gpu) => Some(gpu.lock().unwrap_or_else(|poisoned| poisoned.into_inner())),
        Err(error) => {
            let required = std::env::var("UMBRAGE_GOLDEN_REQUIRED").is_ok_and(|v| v == "1");
            assert!(!required, "UMBRAGE_GOLDEN_REQUIRED=1, but: {error}");
            eprintln!("SKIPPED, nothing was measured: {error}");
            None
        }
    }
}

/// `builtin:SPEC`.
pub fn builtin(spec: &str) -> Scene {
    umbrage_scene::load(&format!("builtin:{spec}")).expect("a built-in scene")
}

/// A technique with `key=value` pairs.
pub fn settings(technique: &str, pairs: &[(&str, &str)]) -> Settings {
    Settings::new(technique, pairs.iter().copied()).expect("settings of a test")
}
