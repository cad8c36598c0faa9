//! Where on a light the rays of a pixel end.

use crate::Quality;
use glam::DVec2;

/// Steps of a sample's coordinate.
const STEPS: f64 = (1u32 << 24) as f64;

/// Points of the unit square, evenly spread: a (0, 2)-sequence (Burley 2020, "Practical Hash-based Owen Scrambling"), the
/// same for every pixel but for a digital shift of its own, which keeps the even spread.
///
/// Neighbours in the list are neighbours in the square, for any pixel: rays in a row then meet the same boxes.
#[derive(Clone, Debug)]
pub struct Samples {
    digits: Vec<[u32; 2]>,
    seed: u32,
}

impl Samples {
    /// Of a quality that was checked.
    pub fn new(quality: &Quality) -> Self {
        let digit =
            |i, dimension| (f64::from(sobol_burley::sample(i, dimension, quality.seed)) * STEPS) as u32;
        let mut digits: Vec<_> = (0..quality.samples).map(|i| [digit(i, 0), digit(i, 1)]).collect();
        // By quarters of quarters (Morton 1966). A digital shift moves each quarter as a whole.
        digits.sort_by_key(|[x, y]| spread(*x) | spread(*y) << 1);
        Self { digits, seed: quality.seed }
    }

    /// The points of one pixel.
    pub fn of_pixel(&self, pixel: u32) -> impl Iterator<Item = DVec2> + '_ {
        let shift = hash(u64::from(pixel) << 32 | u64::from(self.seed));
        let (x, y) = ((shift & 0xff_ffff) as u32, (shift >> 32 & 0xff_ffff) as u32);
        self.digits.iter().map(move |p| (DVec2::new(f64::from(p[0] ^ x), f64::from(p[1] ^ y)) + 0.5) / STEPS)
    }
}

/// The bits of a number with a gap after each.
fn spread(x: u32) -> u64 {
    (0..24).map(|bit| u64::from(x >> bit & 1) << (2 * bit)).sum()
}

/// SplitMix64 (Steele, Lea and Flood 2014, "Fast Splittable Pseudorandom Number Generators").
fn hash(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pixel_has_one_point_in_each_cell_and_its_own_ones() {
        let samples = Samples::new(&Quality { samples: 64, seed: 3 });
        let points = |pixel| samples.of_pixel(pixel).collect::<Vec<_>>();
        for pixel in [0, 1, 77_777] {
            // The cells of a (0, 6, 2)-net: 1x64, 8x8, 64x1 and between.
            for across in [1u32, 2, 4, 8, 16, 32, 64] {
                let down = 64 / across;
                let cell =
                    |p: &DVec2| (p.y * f64::from(down)) as u32 * across + (p.x * f64::from(across)) as u32;
                let mut cells: Vec<u32> = points(pixel).iter().map(cell).collect();
                cells.sort_unstable();
                assert_eq!(cells, (0..64).collect::<Vec<_>>(), "{across} across, pixel {pixel}");
            }
        }
        assert_ne!(points(0), points(1));
        assert_ne!(
            points(0),
            Samples::new(&Quality { samples: 64, seed: 4 }).of_pixel(0).collect::<Vec<_>>()
        );
    }

    #[test]
    fn sixteen_in_a_row_are_neighbours() {
        let samples = Samples::new(&Quality { samples: 256, seed: 0 });
        let points: Vec<DVec2> = samples.of_pixel(5).collect();
        for row in points.chunks(16) {
            let (min, max) = row.iter().fold((DVec2::ONE, DVec2::ZERO), |(a, b), p| (a.min(*p), b.max(*p)));
            assert!((max - min).max_element() <= 0.25, "{row:?}");
        }
    }
}
