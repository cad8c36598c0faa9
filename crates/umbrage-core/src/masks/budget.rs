//! How many masks there may be.

use crate::technique::{Method, Settings};

/// How many masks a picture may have, of all lights together: they stand in a uniform.
pub const MOST_MASKS: usize = 256;

/// Memory that all masks may take, bytes; one mask has room whatever its size.
pub const MOST_BYTES: u64 = 512 << 20;

/// Most masks of a light, when so many lights have some of `size_texel` texels along a side; 1 at least.
pub fn most_of_light(lights: usize, size_texel: u32) -> usize {
    let of_memory = (MOST_BYTES / (u64::from(size_texel) * u64::from(size_texel)).max(1)) as usize;
    (MOST_MASKS.min(of_memory.max(1)) / lights.max(1)).max(1)
}

/// Width and height of a mask, texels, as settings say; `None` for techniques of other families.
pub fn size_texel(settings: &Settings) -> Option<u32> {
    matches!(settings.method, Method::Mask(_))
        .then(|| settings.value("mask_size").map_or(512, |size| size as u32))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn masks_fit_in_the_uniform_and_in_memory_whatever_is_asked_for() {
        for lights in 0..40 {
            for size in [0, 1, 8, 512, 2048, 4096, u32::MAX] {
                let most = most_of_light(lights, size);
                assert!(most >= 1);
                if most > 1 {
                    assert!(most * lights.max(1) <= MOST_MASKS);
                    let bytes = (most * lights.max(1)) as u64 * u64::from(size) * u64::from(size);
                    assert!(bytes <= MOST_BYTES, "{lights} {size}");
                }
            }
        }
    }

    #[test]
    fn only_masks_have_a_size() {
        let of = |id: &str, pairs: &[(&str, &str)]| {
            size_texel(&Settings::new(id, pairs.iter().copied()).expect("settings"))
        };
        assert_eq!(of("mask", &[]), Some(512));
        assert_eq!(of("mask-subtractive", &[("mask_size", "64")]), Some(64));
        assert_eq!(of("linear", &[]), None);
    }
}
