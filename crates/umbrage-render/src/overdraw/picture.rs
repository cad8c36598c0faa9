//! Faces of volumes per pixel as a picture: colours over the dimmed scene, a legend, a histogram.

use super::{Overdraw, OverdrawPixel, OverdrawStatistics};
use crate::heat::{self, Legend, OCTAVES, TEXT};
use colorous::INFERNO;
use embedded_graphics::pixelcolor::{Rgb888, RgbColor};
use glam::{UVec2, Vec3};

const TITLE: &str = "faces of volumes per pixel";
/// Ticks of the legend, from 1 to 256.
const TICKS: [(i32, &str); 5] = [(1, "1"), (3, "4"), (5, "16"), (7, "64"), (9, "256")];
/// Pixels that are lit and should not be: a hue that no number has.
const WRONG: Rgb888 = Rgb888::new(40, 255, 130);
/// Where the colours begin and end: Inferno's black would not be seen over a dark scene, nor its white on a light one.
const COLORS: (f64, f64) = (0.24, 0.97);

/// The colour of so many faces a pixel, from violet to yellow (Inferno, whose lightness grows evenly, also for the colour-blind).
/// Logarithmic from 1 to 256, the same beyond; dark where there is none.
fn color(faces: f64) -> Vec3 {
    if faces < 1.0 {
        return heat::scene(0.6);
    }
    let share = (faces.log2() / f64::from(OCTAVES)).min(1.0);
    let color = INFERNO.eval_continuous(COLORS.0 + share * (COLORS.1 - COLORS.0));
    Vec3::new(f32::from(color.r), f32::from(color.g), f32::from(color.b))
}

fn painted(pixel: &OverdrawPixel) -> [u8; 4] {
    let Overdraw { faces, .. } = pixel.overdraw;
    heat::rgba(if pixel.overdraw.is_wrongly_lit() {
        Vec3::new(f32::from(WRONG.r()), f32::from(WRONG.g()), f32::from(WRONG.b()))
    } else if faces > 0 {
        heat::over_scene(color(f64::from(faces)), pixel.grey)
    } else if pixel.grey > 0.0 {
        heat::scene(pixel.grey)
    } else {
        heat::NOTHING
    })
}

/// The whole picture, RGBA.
pub fn picture(size: UVec2, pixels: &[OverdrawPixel], found: &OverdrawStatistics) -> Vec<u8> {
    let mut rgba: Vec<u8> = pixels.iter().flat_map(painted).collect();
    let shares: Vec<f64> = found.histogram.iter().map(|cell| cell.share).collect();
    let (most, deepest) =
        (format!("most {}", found.picture.most), format!("deepest count {}", found.deepest_count));
    let legend = Legend {
        title: TITLE,
        color: |cells| color((cells - 1.0).exp2()),
        ticks: &TICKS,
        words: [(&most, TEXT), (&deepest, if found.wrongly_lit_pixels > 0 { WRONG } else { TEXT })],
        shares: &shares,
    };
    heat::draw_legend(size, &mut rgba, &legend, 0);
    rgba
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_faces_are_lighter_and_none_has_no_hue() {
        let light = |faces: f64| color(faces).dot(Vec3::new(0.21, 0.72, 0.07));
        let steps: Vec<f32> = (0..=8).map(|octave| light(f64::from(octave).exp2())).collect();
        assert!(steps.windows(2).all(|pair| pair[1] > pair[0] + 5.0), "{steps:?}");
        assert_eq!((color(256.0), color(0.0).x), (color(1e9), color(0.0).y));
        assert!(TITLE.len() <= heat::LINE && "most 2048deepest count 2048".len() <= heat::LINE);
    }
}
