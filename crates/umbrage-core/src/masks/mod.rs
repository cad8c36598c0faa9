//! What all masks of a picture have in common: where their shadows lie on the screen, how many there may be, and which
//! blockers have none. How one mask is fitted says [`crate::fit::fit_mask`].

mod budget;
mod maskable;
mod shadow;

pub use budget::{MOST_BYTES, MOST_MASKS, most_of_light, size_texel};
pub use maskable::{Maskable, Unmaskable, fit_blocker, maskable};
pub use shadow::{Picture, Rect, Shadow};
