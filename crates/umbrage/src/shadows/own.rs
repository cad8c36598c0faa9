//! Casters that the caller draws: what is asked, and into what.

use super::handles::{CasterHandle, LightHandle};
use super::{Shadows, ShadowsError};
use crate::ChosenFormat;
use crate::caster::{channels, depth_bias, depth_compare};
use crate::format::SCRATCH_DEPTH;
use umbrage_core::fit::ShadowView;
use umbrage_core::plan::Pass;

/// What the caller draws of a map: see [`Shadows::record_with`].
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct OwnDraw<'a> {
    /// Which light.
    pub light: LightHandle,
    /// From where. Bind group 0 holds its matrix.
    pub view: &'a ShadowView,
    /// What pipelines have to be made for.
    pub target: OwnTarget,
    /// Which casters to draw.
    pub casters: &'a [CasterHandle],
}

/// What a pipeline that draws into maps has to be made for: one for each that differs, to be kept.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct OwnTarget {
    /// The depth's format, comparison and polygon offset. Reversed.
    pub depth_stencil: wgpu::DepthStencilState,
    /// The colour target of maps that keep distance in colours: its fragment shader returns
    /// `umbrage_caster_color(position.z, vec2f(dpdx(position.z), dpdy(position.z)))`. `None`: depth is all that is drawn.
    pub color: Option<wgpu::ColorTargetState>,
    /// The pipeline constant `UMBRAGE_CHANNELS` of [`crate::caster::caster_view_wgsl`], where there is a colour target.
    pub channels: f64,
}

impl OwnTarget {
    pub(super) fn new(format: &ChosenFormat, pass: &Pass) -> Self {
        let is_color = format.storage.is_color();
        Self {
            depth_stencil: wgpu::DepthStencilState {
                format: if is_color { SCRATCH_DEPTH } else { format.format },
                depth_write_enabled: Some(true),
                depth_compare: Some(depth_compare()),
                stencil: Default::default(),
                bias: depth_bias(format.storage, pass),
            },
            color: is_color.then(|| format.format.into()),
            channels: channels(format.storage),
        }
    }
}

impl Shadows {
    /// The layout of bind group 0 in the closure of [`Shadows::record_with`]: a uniform buffer with a dynamic offset.
    pub fn own_draw_layout(&self) -> &wgpu::BindGroupLayout {
        &self.view_layout
    }

    /// What the maps of a light are drawn into, after [`Shadows::prepare`]: to make pipelines before they are needed. `None` for a light
    /// without maps.
    ///
    /// # Errors
    /// [`ShadowsError::Removed`], [`ShadowsError::OfAnother`].
    pub fn own_target(&self, light: LightHandle) -> Result<Option<OwnTarget>, ShadowsError> {
        let casting = self.lights.get(light.0)?.casting.and_then(|casting| self.castings.get(casting));
        Ok(casting.map(|casting| OwnTarget::new(&self.pools[casting.pool].kind.format, &casting.pass)))
    }
}
