//! What masks of one texture cannot be.

use crate::ShadowError;
use umbrage_core::masks::MOST_MASKS;

/// Why masks cannot be kept as asked for.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MasksError {
    /// A technique of another family.
    #[error("`{technique}` makes no masks; use `mask` or `mask-subtractive`")]
    NoMasks {
        /// What was asked for.
        technique: &'static str,
    },
    /// More lights than a picture has masks.
    #[error("masks for {lights} lights are more than the {MOST_MASKS} of a picture; hand in fewer lights")]
    TooManyLights {
        /// What was asked for.
        lights: usize,
    },
    /// A light that there is no room for.
    #[error("there is no light {light}: masks were made for {lights}, numbered from 0; make them for more")]
    NoLight {
        /// What was asked for.
        light: usize,
        /// How many there are.
        lights: usize,
    },
    /// A light whose masks are of another size: all stand in one texture.
    #[error(
        "light {light} asks for masks of {asked} texels, and all of these have {size_texel}; give each light the same mask_size"
    )]
    OtherSize {
        /// The light's number.
        light: usize,
        /// What was asked for, texels.
        asked: u32,
        /// What there is, texels.
        size_texel: u32,
    },
    /// A light whose masks are looked up otherwise: all have one sampler.
    #[error(
        "light {light} asks for lookup={asked}, and all of these masks have another; give each light the same lookup"
    )]
    OtherLookup {
        /// The light's number.
        light: usize,
        /// What was asked for.
        asked: &'static str,
    },
    /// Textures of the device are too small.
    #[error(transparent)]
    Shadow(#[from] ShadowError),
}
