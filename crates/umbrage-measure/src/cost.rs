//! What a shadow costs: frames with and without it in turns, and what does not vary.

use crate::MeasureError;
use crate::numbers::median;
use serde::Serialize;
use umbrage_render::umbrage::core::plan::{Draws, plan};
use umbrage_render::umbrage::core::technique::Settings;
use umbrage_render::{Measure, Renderer};

/// Times in milliseconds, and counts of the passes that make the shadow.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Cost {
    /// Median of the differences between neighbouring frames with and without shadows. Noise may make it negative.
    pub cost_ms: f64,
    /// Least and greatest of these differences.
    pub cost_min_ms: f64,
    /// See `cost_min_ms`.
    pub cost_max_ms: f64,
    /// Median of frames with shadows.
    pub frame_ms: f64,
    /// Median of frames without.
    pub unshadowed_ms: f64,
    /// Shadow maps, and what is drawn on the way to them.
    pub memory_bytes: u64,
    /// Passes that draw casters.
    pub passes: u64,
    /// Their draw calls.
    pub draws: u64,
    /// Their triangles.
    pub triangles: u64,
    /// Texels that these passes draw to.
    pub texels: u64,
    /// Lookups of a map for each lit pixel.
    pub taps: u64,
    /// All passes of the frame by name.
    pub pass_names: Vec<String>,
}

impl Cost {
    /// Draws `frames` frames with and without shadows in turns, after one of each that warms up. `with` draws its maps in each
    /// ([`umbrage_render::RenderOptions::reuse`] is false), or its cost would be that of the lookup alone.
    ///
    /// # Errors
    /// As [`Renderer::frame`].
    pub fn measure(
        with: &mut Renderer<'_>,
        without: &mut Renderer<'_>,
        settings: &Settings,
        frames: u32,
    ) -> Result<Self, MeasureError> {
        let mut report = with.frame(Measure::Frame)?;
        without.frame(Measure::Frame)?;
        let (mut shadowed, mut bare) = (Vec::new(), Vec::new());
        for _ in 0..frames {
            bare.push(without.frame(Measure::Frame)?.frame_ms);
            // What is counted is what was timed, so that a map that was reused is seen to be missing.
            report = with.frame(Measure::Frame)?;
            shadowed.push(report.frame_ms);
        }
        let costs: Vec<f64> = shadowed.iter().zip(&bare).map(|(with, without)| with - without).collect();
        // A pass of the plan has one name, followed by the view's number where each view has its own.
        let planned: Vec<_> =
            plan(settings).into_iter().filter(|pass| pass.draws != Draws::Surfaces).collect();
        let of_casters = |name: &str| planned.iter().any(|pass| name.starts_with(pass.name));
        let casters: Vec<_> = report.passes.iter().filter(|pass| of_casters(&pass.name)).collect();
        let side = u64::from(settings.map_size_texel());
        let is_shadowed = settings.combination().is_some();
        Ok(Self {
            // Without a technique both are the same frame, and what they differ by is noise.
            cost_ms: if is_shadowed { median(&costs) } else { 0.0 },
            cost_min_ms: if is_shadowed { costs.iter().copied().fold(f64::INFINITY, f64::min) } else { 0.0 },
            cost_max_ms: if is_shadowed {
                costs.iter().copied().fold(f64::NEG_INFINITY, f64::max)
            } else {
                0.0
            },
            frame_ms: median(&shadowed),
            unshadowed_ms: median(&bare),
            memory_bytes: with.shadow_memory_bytes(),
            passes: casters.len() as u64,
            draws: casters.iter().map(|pass| pass.work.draws).sum(),
            triangles: casters.iter().map(|pass| pass.work.triangles).sum(),
            texels: casters.len() as u64 * side * side,
            taps: u64::from(settings.taps() * settings.places()),
            pass_names: report.passes.iter().map(|pass| pass.name.clone()).collect(),
        })
    }
}
