//! What a shadow costs: frames with and without it in turns, and what does not vary.

use crate::MeasureError;
use crate::numbers::median;
use serde::Serialize;
use umbrage_render::umbrage::core::plan::{Draws, Pass, Target, plan};
use umbrage_render::umbrage::core::technique::{Method, Settings};
use umbrage_render::{Measure, Renderer, Silhouettes};

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
    /// Shadow maps and what is drawn on the way to them; meshes, faces and V of volumes.
    pub memory_bytes: u64,
    /// Passes that make the shadow.
    pub passes: u64,
    /// Their draw calls.
    pub draws: u64,
    /// Their triangles.
    pub triangles: u64,
    /// Edges of outlines that a compute pass found for them; 0 without volumes.
    pub silhouette_edges: u64,
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
        // A pass of the plan has one name, followed by the view's number where each view has its own. The map that takes over for
        // some casters is planned apart.
        let fallback = settings.fallback();
        let plans = [Some(settings), fallback.as_ref()].into_iter().flatten();
        let planned: Vec<(Pass, u64)> = plans
            .flat_map(|settings| {
                let side = u64::from(settings.map_size_texel());
                plan(settings).into_iter().map(move |pass| (pass, side * side))
            })
            .filter(|(pass, _)| !matches!(pass.draws, Draws::Surfaces | Draws::Depths))
            .collect();
        let size = with.options().size;
        let pixels = u64::from(size.x) * u64::from(size.y);
        let texels_of = |(pass, map): &(Pass, u64)| match pass.target {
            Target::Faces => 0,
            Target::Stencil | Target::Visibility => pixels,
            Target::Mask { size_texel } => u64::from(size_texel) * u64::from(size_texel),
            _ => *map,
        };
        let of_shadow = |name: &str| planned.iter().find(|(pass, _)| name.starts_with(pass.name));
        let shadow: Vec<_> =
            report.passes.iter().filter_map(|pass| Some((pass, of_shadow(&pass.name)?))).collect();
        let volumes = with.silhouettes()?;
        let found = |of: fn(&Silhouettes) -> u64| volumes.iter().map(of).sum::<u64>();
        let is_shadowed = settings.method != Method::None;
        // Split edges are counted as they are drawn.
        let by_compute = if found(|s| s.silhouette_edges) > 0 { found(|s| s.triangles_drawn) } else { 0 };
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
            passes: shadow.len() as u64,
            draws: shadow.iter().map(|(pass, _)| pass.work.draws).sum(),
            triangles: shadow.iter().map(|(pass, _)| pass.work.triangles).sum::<u64>() + by_compute,
            silhouette_edges: found(|s| s.silhouette_edges),
            texels: shadow.iter().map(|(_, planned)| texels_of(planned)).sum(),
            taps: u64::from(settings.taps() * settings.places()),
            pass_names: report.passes.iter().map(|pass| pass.name.clone()).collect(),
        })
    }
}
