//! What a mask may choose, and why there is none.

use crate::bounds::Aabb;
use crate::light::LightError;
use crate::technique::mask::{Aim, Mask, Ratios as ChosenRatios};
use glam::Vec3;

/// Where the axis of a mask goes. Parallel light has no choice: all of its rays are axes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Frame {
    /// Along the mean of the ways to the blocker's points: towards where they are dense.
    #[default]
    Mean,
    /// To the middle of the box around the points: towards the middle of what they take up.
    Box,
}

/// How wide a mask is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Ratios {
    /// From the blocker's leftmost to its rightmost point and from its lowest to its highest, so that the outline touches all
    /// four sides of the free texels. The window may be off centre. It never has fewer texels on the blocker than
    /// `Symmetric`, for the same cost: on torus, knot, fox and monkey, lit aslant from 2 to 8 radii away, outlines take up 56 to 86 %
    /// of the mask against 27 to 83 %.
    #[default]
    Adaptive,
    /// As far to both sides as the point that is farthest from the axis, for each of x and y: the article's ratios. The
    /// outline touches one side of each pair.
    Symmetric,
    /// The same for every blocker: a spot light's own cone, 45 degrees to each side for a point light, and
    /// [`MaskOptions::fixed_half_m`] for parallel light. A blocker that needs more gets no mask.
    Fixed,
}

/// What a mask may choose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaskOptions {
    /// Width and height of the mask, texels. More than twice the border; default 512.
    pub size_texel: u32,
    /// Texels that stay empty on each side. 1 or more, default 1, which is enough for a linear lookup.
    pub border_texel: u32,
    /// Where the axis goes. Default: [`Frame::Mean`].
    pub frame: Frame,
    /// How wide it is. Default: [`Ratios::Adaptive`].
    pub ratios: Ratios,
    /// Half the width of [`Ratios::Fixed`] under parallel light, metres, above 0: the radius of the scene, say. Default 10.
    pub fixed_half_m: f32,
}

impl Default for MaskOptions {
    fn default() -> Self {
        let (frame, ratios) = (Frame::default(), Ratios::default());
        Self { size_texel: 512, border_texel: 1, frame, ratios, fixed_half_m: 10.0 }
    }
}

impl MaskOptions {
    /// What a technique chooses, for masks of `size_texel` texels along a side in a scene of that box.
    pub fn of(choices: &Mask, size_texel: u32, scene_world: &Aabb) -> Self {
        Self {
            size_texel,
            frame: match choices.aim {
                Aim::Mean => Frame::Mean,
                Aim::Box => Frame::Box,
            },
            ratios: match choices.ratios {
                ChosenRatios::Adaptive => Ratios::Adaptive,
                ChosenRatios::Symmetric => Ratios::Symmetric,
                ChosenRatios::Fixed => Ratios::Fixed,
            },
            fixed_half_m: scene_world.radius().max(1e-6),
            ..Self::default()
        }
    }

    pub(super) fn check(&self) -> Result<(), MaskError> {
        let Self { size_texel, border_texel, fixed_half_m, .. } = *self;
        let least = 2 * u64::from(border_texel.max(1)) + 1;
        if border_texel == 0 || u64::from(size_texel) < least {
            return Err(MaskError::NoRoom { size_texel, border_texel, least });
        }
        if !(fixed_half_m.is_finite() && fixed_half_m > 0.0) {
            return Err(MaskError::FixedHalf(fixed_half_m));
        }
        Ok(())
    }
}

/// Why a light and a blocker got no mask.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MaskError {
    /// The light itself is not usable.
    #[error(transparent)]
    Light(#[from] LightError),
    /// The mask is all border.
    #[error(
        "a mask of {size_texel} texels has no room in a border of {border_texel}; make it {least} or more"
    )]
    NoRoom {
        /// What was asked for.
        size_texel: u32,
        /// What was asked for.
        border_texel: u32,
        /// The least size with that border.
        least: u64,
    },
    /// A fixed width that is none.
    #[error("half the fixed width is {0} m; it must be finite and above 0")]
    FixedHalf(f32),
    /// There is nothing to fit to.
    #[error("the blocker has no points; hand in its vertices or the corners of its box")]
    NoPoints,
    /// A point with a number that is none.
    #[error("a point of the blocker is at {0}, which is not finite; correct its mesh or transform")]
    NotFinite(Vec3),
    /// The blocker is behind the light, outside of its cone or beyond its range: it needs no mask and no map.
    #[error("the light does not reach the blocker, so it throws no shadow")]
    Unreached,
    /// The light is inside the blocker or so close that no projection holds it.
    #[error(
        "the blocker spans more than {MOST_SPAN_DEG} degrees of the light's view; move the light away or use a map"
    )]
    TooNear,
    /// The fixed width is too small.
    #[error(
        "the blocker reaches {factor:.2} times as far as the fixed ratio does; use adaptive ratios or a map"
    )]
    TooWide {
        /// What the blocker needs over what there is, above 1.
        factor: f64,
    },
    /// Sizes or distances too different for single precision.
    #[error(
        "single precision cannot tell the blocker's points apart from there; move it closer to the origin"
    )]
    OutOfNumbers,
}

/// The widest angle that a mask spans, degrees: 80 to each side of its axis. A texel in the middle of such a view spans 33
/// times the angle of one at its edge.
pub(super) const MOST_SPAN_DEG: f64 = 160.0;
