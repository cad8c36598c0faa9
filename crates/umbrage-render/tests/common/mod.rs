//! What the GPU tests share: one adapter, small pictures, comparison.
#![allow(dead_code)]

pub mod compare;
pub mod found;
pub mod scenes;
pub mod volumes;

use std::sync::{Mutex, MutexGuard, OnceLock};
use umbrage_render::umbrage::core::technique::Settings;
use umbrage_render::{Gpu, Measure, RenderOptions, Renderer, View};
use umbrage_scene::Scene;

/// The software rasteriser that goldens are made with. `None`, said loudly, where it is missing; a failure where
/// `UMBRAGE_GOLDEN_REQUIRED=1` says that it must not be. One test draws at a time: software devices share the cores.
pub fn gpu() -> Option<MutexGuard<'static, Gpu>> {
    static GPU: OnceLock<Result<Mutex<Gpu>, String>> = OnceLock::new();
    let made = GPU.get_or_init(|| Gpu::new(Some("llvmpipe")).map(Mutex::new).map_err(|e| e.to_string()));
    match made {
        Ok(gpu) => Some(gpu.lock().unwrap_or_else(|poisoned| poisoned.into_inner())),
        Err(error) => {
            let required = std::env::var("UMBRAGE_GOLDEN_REQUIRED").is_ok_and(|v| v == "1");
            assert!(!required, "UMBRAGE_GOLDEN_REQUIRED=1, but: {error}");
            eprintln!("SKIPPED, no golden was compared: {error}");
            None
        }
    }
}

/// Settings from the table.
pub fn settings(technique: &str, pairs: &[(&str, &str)]) -> Settings {
    Settings::new(technique, pairs.iter().copied()).expect("settings of a test")
}

/// A picture of a view: RGBA, and V when that is what it shows.
pub struct Shot {
    pub side: u32,
    pub rgba: Vec<u8>,
    pub v: Vec<f32>,
}

/// Draws a square picture with the scene's first camera.
pub fn shoot(gpu: &Gpu, scene: &Scene, settings: Settings, view: View, side: u32) -> Shot {
    shoot_with(gpu, scene, side, RenderOptions { view, ..RenderOptions::new(settings) })
}

/// The same with all options.
pub fn shoot_with(gpu: &Gpu, scene: &Scene, side: u32, options: RenderOptions) -> Shot {
    let options = RenderOptions { size: glam::UVec2::splat(side), ..options };
    let view = options.view;
    let mut renderer = Renderer::new(gpu, scene, &scene.cameras[0].camera, options).expect("a renderer");
    renderer.frame(Measure::Frame).expect("a frame");
    let v = if view == View::Visibility { renderer.visibility().expect("V") } else { Vec::new() };
    Shot { side, rgba: renderer.picture().expect("a picture"), v }
}
