//! How different two pictures look.

/// Pixels that fill a degree of the eye: those of a 0.7 m wide screen of 3840 pixels, 0.7 m away, the authors' default.
const PIXELS_PER_DEGREE: f32 = nv_flip::DEFAULT_PIXELS_PER_DEGREE;

/// The mean perceptual difference between two pictures, 0 the same, 1 the most (Andersson and others 2020, "FLIP: A
/// Difference Evaluator for Alternating Images"). Both are RGBA, sRGB, 8 bits a channel, of the same size; alpha is left out.
pub fn flip(reference_rgba: &[u8], test_rgba: &[u8], width: u32, height: u32) -> f64 {
    let image = |rgba: &[u8]| {
        let rgb: Vec<u8> = rgba.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
        nv_flip::FlipImageRgb8::with_data(width, height, &rgb)
    };
    let map = nv_flip::flip(image(reference_rgba), image(test_rgba), PIXELS_PER_DEGREE).to_vec();
    map.iter().map(|x| f64::from(*x)).sum::<f64>() / map.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_is_0_and_black_on_white_is_1() {
        let (white, black) = ([255u8; 4 * 64], [0u8; 4 * 64].map(|x| x));
        assert_eq!(flip(&white, &white, 8, 8), 0.0);
        let most = flip(&white, &black, 8, 8);
        assert!(most > 0.9 && most <= 1.0, "{most}");
        let mut spot = white;
        spot[4 * 27..4 * 27 + 3].fill(0);
        let little = flip(&white, &spot, 8, 8);
        assert!(little > 0.0 && little < 0.5 * most, "{little}");
    }
}
