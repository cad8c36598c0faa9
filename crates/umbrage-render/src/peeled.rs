//! The layer that midpoint maps peel off first: one for all views, who take turns.

use umbrage::core::plan::{Draws, Pass, Target, plan};
use umbrage::core::technique::Settings;
use umbrage::format::{PEEL_DEPTH, PEEL_STORAGE};
use umbrage::{CasterPipelines, CasterVertices, ChosenFormat, Peel, ShadowError};

/// The nearest layer, and what draws it.
#[derive(Debug)]
pub(crate) struct Peeled {
    pub pass: Pass,
    pub peel: Peel,
    pub pipelines: CasterPipelines,
}

/// The planned passes that draw casters: the one that draws the maps, and the one that peels a layer off before it.
pub(crate) fn caster_passes(settings: &Settings) -> (Option<Pass>, Option<Pass>) {
    let passes = plan(settings).into_iter().filter(|pass| pass.draws == Draws::Casters);
    let (peels, maps): (Vec<_>, Vec<_>) =
        passes.partition(|pass| matches!(pass.target, Target::Layer { .. }));
    (maps.into_iter().next(), peels.into_iter().next())
}

impl Peeled {
    pub fn new(
        device: &wgpu::Device,
        pass: Pass,
        size_texel: u32,
        cut_out_layout: &wgpu::BindGroupLayout,
        vertices: &CasterVertices<'_>,
    ) -> Result<Self, ShadowError> {
        let format =
            ChosenFormat { storage: PEEL_STORAGE, format: PEEL_DEPTH, why: "depth peeling".to_owned() };
        Ok(Self {
            peel: Peel::new(device, size_texel, 1)?,
            pipelines: CasterPipelines::new(device, &format, &pass, cut_out_layout, vertices),
            pass,
        })
    }
}
