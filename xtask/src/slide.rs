//! The slide of the cookie's picture: a leaded window, made here so that it needs no licence but ours.

use crate::picture;
use crate::process::Done;
use std::path::Path;

const SIZE: usize = 256;
/// Panes across and up.
const PANES: usize = 4;
/// Half the width of the lead between panes, and of the frame around them, in texels.
const LEAD: f32 = 3.0;
const FRAME: f32 = 10.0;
/// Colours of the panes, sRGB.
const GLASS: [[u8; 3]; 5] =
    [[250, 226, 150], [214, 96, 66], [96, 152, 206], [134, 188, 120], [240, 240, 236]];

/// Writes the slide.
pub fn write(path: &Path) -> Done {
    picture::write_rgb(path, SIZE as u32, SIZE as u32, &texels())
}

fn texels() -> Vec<u8> {
    (0..SIZE * SIZE).flat_map(|i| texel((i % SIZE) as f32 + 0.5, (i / SIZE) as f32 + 0.5)).collect()
}

/// Glass within a round frame, cut by lead along a grid.
fn texel(x: f32, y: f32) -> [u8; 3] {
    let half = 0.5 * SIZE as f32;
    let radius = ((x - half).powi(2) + (y - half).powi(2)).sqrt();
    let pane = SIZE as f32 / PANES as f32;
    // Distance from the nearest line of the grid.
    let to_lead = |t: f32| (t - (t / pane).round() * pane).abs();
    if radius > half - FRAME || to_lead(x) < LEAD || to_lead(y) < LEAD {
        return [0, 0, 0];
    }
    let (column, row) = ((x / pane) as usize, (y / pane) as usize);
    GLASS[(2 * column + 3 * row) % GLASS.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_window_has_a_dark_frame_and_panes_of_every_colour() {
        let texels = texels();
        assert_eq!(texels.len(), SIZE * SIZE * 3);
        assert_eq!(&texels[..3], &[0, 0, 0]);
        for glass in GLASS {
            assert!(texels.chunks_exact(3).any(|texel| texel == glass), "{glass:?}");
        }
    }
}
