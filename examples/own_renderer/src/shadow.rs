//! All that the shadow takes from Umbrage: a view around the scene, how to draw its map, and the text that looks it up.

use std::error::Error;
use umbrage_core::fit::{FitOptions, ShadowView, fit};
use umbrage_core::layout::GpuView;
use umbrage_core::plan::{Pass, plan};
use umbrage_core::technique::{Settings, Storage};
use umbrage_core::{Aabb, Light, wgsl};

/// A light's map, before there is one.
pub struct Shadow {
    /// Width and height of the map, texels.
    pub size_texel: u32,
    /// How the map begins, and what offset its casters get.
    pub pass: Pass,
    /// What the map's pass places corners with.
    pub fitted: ShadowView,
    /// What the lookup is told.
    pub view: GpuView,
    /// The lookup: `umbrage_locate` and `umbrage_filter_kernel`.
    pub wgsl: String,
}

/// Soft by a box of five texels, around all that casts or receives.
///
/// # Errors
/// The words of the fit or of the table; there are none for a light and boxes with finite numbers.
pub fn plan_shadow(light: &Light, bounds_world: &[Aabb]) -> Result<Shadow, Box<dyn Error>> {
    let settings = Settings::new("pcf", [("storage", "depth32f"), ("map_size", "1024")])?;
    let size_texel = settings.map_size_texel();
    let border_texel = settings.reach_texel() + 1.0;
    let fitted = fit(light, bounds_world, &FitOptions { size_texel, border_texel, ..Default::default() })?;
    let modules = settings.combination().map(|chosen| chosen.modules()).unwrap_or_default();
    let view = GpuView::new(&fitted, 0, &settings, Storage::Depth32Float);
    let wgsl = wgsl::assemble(&modules)?;
    Ok(Shadow { size_texel, pass: plan(&settings).swap_remove(0), fitted, view, wgsl })
}
