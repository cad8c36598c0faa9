//! How maps are drawn: the planned passes of a technique, and pipelines for every kind of vertices there is.

use super::meshes::VertexKind;
use super::variants::PoolKind;
use crate::caster::{CasterVertices, NO_DEFORM};
use crate::format::{PEEL_DEPTH, PEEL_STORAGE};
use crate::{CasterPipelines, ChosenFormat, Peel, ShadowError, TranslucentPipelines};
use umbrage_core::plan::{Draws, Keeps, Pass, caster_passes, plan};
use umbrage_core::technique::Settings;

/// Passes that draw maps of one pool, and their pipelines.
#[derive(Debug)]
pub(super) struct Casting {
    pub pass: Pass,
    pub pool: usize,
    /// Draws the layer that a midpoint lies behind.
    pub peel: Option<(Pass, Peel)>,
    /// Colours of translucent casters, and the nearest of these.
    pub translucent: Option<[Pass; 2]>,
    pipelines: Vec<(VertexKind, Pipelines)>,
}

/// For one kind of vertices.
#[derive(Debug)]
pub(super) struct Pipelines {
    pub map: CasterPipelines,
    pub peel: Option<CasterPipelines>,
    pub translucent: Option<TranslucentPipelines>,
}

impl Casting {
    /// The passes of a technique with maps; `None` for others.
    pub fn new(
        device: &wgpu::Device,
        settings: &Settings,
        pool: usize,
        kind: &PoolKind,
    ) -> Result<Option<Self>, ShadowError> {
        let (Some(pass), peel) = caster_passes(settings) else { return Ok(None) };
        let peel = peel.map(|pass| Ok((pass, Peel::new(device, kind.size_texel, 1)?))).transpose()?;
        let mut tinting = plan(settings).into_iter().filter(|pass| pass.draws == Draws::Translucent);
        let translucent = tinting.next().zip(tinting.next()).map(|(colors, nearest)| [colors, nearest]);
        Ok(Some(Self { pass, pool, peel, translucent, pipelines: Vec::new() }))
    }

    /// Does it draw what `settings` ask for?
    pub fn draws(&self, settings: &Settings, pool: usize) -> bool {
        self.pool == pool && caster_passes(settings).0.is_some_and(|pass| pass == self.pass)
    }

    /// Makes what draws a kind of vertices, if it is not there yet.
    pub fn provide(
        &mut self,
        device: &wgpu::Device,
        kind: VertexKind,
        pool: &PoolKind,
        cut_out_layout: &wgpu::BindGroupLayout,
    ) {
        if self.of(kind).is_some() {
            return;
        }
        let vertices = CasterVertices { stride: kind.stride, format: kind.format, deform: NO_DEFORM };
        let map = CasterPipelines::new(device, &pool.format, &self.pass, cut_out_layout, &vertices);
        let peel = self.peel.as_ref().map(|(pass, _)| {
            let format = ChosenFormat { storage: PEEL_STORAGE, format: PEEL_DEPTH, why: String::new() };
            CasterPipelines::new(device, &format, pass, cut_out_layout, &vertices)
        });
        let translucent = self.translucent.as_ref().map(|[colors, _]| {
            let groups = [&map.view_layout, cut_out_layout];
            TranslucentPipelines::new(device, &pool.format, colors, groups, &vertices)
        });
        self.pipelines.push((kind, Pipelines { map, peel, translucent }));
    }

    /// What draws a kind of vertices.
    pub fn of(&self, kind: VertexKind) -> Option<&Pipelines> {
        self.pipelines.iter().find(|(other, _)| *other == kind).map(|(_, pipelines)| pipelines)
    }

    /// May what stands still be drawn once and copied below what moves? Only where the nearest surface is all that counts, and where
    /// it is depth that is kept.
    pub fn can_keep(&self, pool: &PoolKind) -> bool {
        self.pass.keeps == Keeps::Nearest && self.translucent.is_none() && !pool.format.storage.is_color()
    }
}
