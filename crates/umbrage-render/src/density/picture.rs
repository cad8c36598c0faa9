//! Texels per pixel as a picture: colours over the dimmed scene, a legend, a histogram.

use super::DensityPixel;
use crate::heat::{self, FAINT, Legend, OCTAVES};
use colorous::RED_YELLOW_BLUE;
use glam::{UVec2, Vec3};

const TITLE: &str = "shadow map texels per pixel";
/// Ticks of the legend, from 1/16 to 16.
const TICKS: [(i32, &str); 5] = [(1, "1/16"), (3, "1/4"), (5, "1"), (7, "4"), (9, "16")];

/// The colour of so many texels a pixel: blue below one, pale yellow at it, red above (Brewer's RdYlBu, which stays readable
/// for every kind of colour blindness). Logarithmic from 1/16 to 16, the same beyond.
fn color(texels_per_pixel: f64) -> Vec3 {
    let share = 0.5 - texels_per_pixel.log2() / f64::from(OCTAVES);
    let color = RED_YELLOW_BLUE.eval_continuous(share.clamp(0.0, 1.0));
    Vec3::new(f32::from(color.r), f32::from(color.g), f32::from(color.b))
}

fn painted(pixel: &DensityPixel) -> [u8; 4] {
    heat::rgba(if pixel.is_receiver() {
        heat::over_scene(color(f64::from(pixel.mean)), pixel.grey)
    } else if pixel.grey < 0.0 {
        heat::scene(-pixel.grey)
    } else {
        heat::NOTHING
    })
}

/// The whole picture, RGBA. `shares` are those of the histogram, none where there is none.
/// `beside_px` is how much room there is at the left side of what is shown.
pub fn picture(size: UVec2, pixels: &[DensityPixel], shares: &[f64], beside_px: u32) -> Vec<u8> {
    let mut rgba: Vec<u8> = pixels.iter().flat_map(painted).collect();
    let legend = Legend {
        title: if shares.is_empty() { "no receiver is in sight" } else { TITLE },
        color: |cells| color((cells - 1.0 - f64::from(OCTAVES / 2)).exp2()),
        ticks: &TICKS,
        words: [("too few", FAINT), ("to spare", FAINT)],
        shares,
    };
    heat::draw_legend(size, &mut rgba, &legend, beside_px);
    rgba
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn too_few_is_blue_and_to_spare_is_red() {
        let (few, one, many) = (color(1.0 / 16.0), color(1.0), color(16.0));
        assert!(few.z > 2.0 * few.x && many.x > 2.0 * many.z, "{few} {many}");
        assert!(one.min_element() > 150.0, "{one}");
        assert_eq!((color(0.0), color(1e-9), color(1e30)), (few, few, many));
        // What grows must not turn back: lightness rises up to one, and falls from it on.
        let light = |octave: i32| color(f64::from(octave).exp2()).dot(Vec3::new(0.21, 0.72, 0.07));
        assert!((-4..0).all(|i| light(i) < light(i + 1)) && (0..4).all(|i| light(i) > light(i + 1)));
        assert!(TITLE.len() <= heat::LINE);
    }
}
