//! The layer that midpoint maps peel off first: one for all views, who take turns.

use umbrage::core::plan::Pass;
use umbrage::format::{PEEL_DEPTH, PEEL_STORAGE};
use umbrage::{CasterPipelines, CasterVertices, ChosenFormat, Peel, ShadowError};

/// The nearest layer, and what draws it.
#[derive(Debug)]
pub(crate) struct Peeled {
    pub pass: Pass,
    pub peel: Peel,
    pub pipelines: CasterPipelines,
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
