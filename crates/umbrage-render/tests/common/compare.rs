//! Goldens: a picture against one that somebody looked at.

use super::Shot;
use std::path::{Path, PathBuf};

/// How far a channel may be off: the same rasteriser made both.
const MOST_OFF: u8 = 2;
/// A golden is small, so that the repository stays small and a change can be looked at.
const MOST_BYTES: usize = 8 * 1024;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("goldens")
}

/// Pixels in which two pictures differ, worst first.
pub fn differences(a: &[u8], b: &[u8]) -> Vec<(usize, u8)> {
    assert_eq!(a.len(), b.len(), "pictures of different sizes");
    let worst = |(a, b): (&[u8], &[u8])| a.iter().zip(b).map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0);
    let mut off: Vec<_> = a
        .chunks_exact(4)
        .zip(b.chunks_exact(4))
        .map(worst)
        .enumerate()
        .filter(|(_, d)| *d > MOST_OFF)
        .collect();
    off.sort_by_key(|(_, d)| std::cmp::Reverse(*d));
    off
}

/// Compares with the golden `name`; `UPDATE_GOLDEN=1` writes it instead, and still fails, so that a run that blesses
/// never looks green.
pub fn check(name: &str, shot: &Shot) {
    let path = folder().join(format!("{name}.png"));
    if std::env::var("UPDATE_GOLDEN").is_ok_and(|v| v == "1") {
        bless(&path, shot);
        panic!("{} was written; look at it, then run the tests without UPDATE_GOLDEN", path.display());
    }
    let golden = image::open(&path)
        .unwrap_or_else(|e| panic!("no golden {}: {e}; `cargo xtask bless {name}` writes it", path.display()))
        .to_rgba8();
    assert_eq!((golden.width(), golden.height()), (shot.side, shot.side), "{name}: another size");
    let off = differences(golden.as_raw(), &shot.rgba);
    if !off.is_empty() {
        let report = report(name, golden.as_raw(), shot, &off);
        panic!("{name}: {} pixels differ\n{report}", off.len());
    }
}

/// The negative control: a picture that must not pass for the golden.
pub fn check_differs(name: &str, shot: &Shot, what: &str) {
    let path = folder().join(format!("{name}.png"));
    let Ok(golden) = image::open(&path) else { return };
    let off = differences(golden.to_rgba8().as_raw(), &shot.rgba);
    assert!(off.len() > 20, "{name}: {what} differs from the golden in {} pixels only", off.len());
}

fn bless(path: &Path, shot: &Shot) {
    // V is grey and palettes are small: the smallest PNG that holds the picture.
    let grey = shot.rgba.chunks_exact(4).all(|p| p[0] == p[1] && p[1] == p[2]);
    let mut bytes = Vec::new();
    let encoder = image::codecs::png::PngEncoder::new_with_quality(
        &mut bytes,
        image::codecs::png::CompressionType::Best,
        image::codecs::png::FilterType::Adaptive,
    );
    let (pixels, color): (Vec<u8>, _) = if grey {
        (shot.rgba.iter().step_by(4).copied().collect(), image::ExtendedColorType::L8)
    } else {
        (shot.rgba.chunks_exact(4).flat_map(|p| &p[..3]).copied().collect(), image::ExtendedColorType::Rgb8)
    };
    image::ImageEncoder::write_image(encoder, &pixels, shot.side, shot.side, color).expect("PNG");
    assert!(
        bytes.len() <= MOST_BYTES,
        "{}: {} bytes; a golden has {MOST_BYTES} at most",
        path.display(),
        bytes.len()
    );
    std::fs::create_dir_all(folder()).expect("the folder of goldens");
    std::fs::write(path, bytes).expect("a golden");
}

/// Writes expected, difference and actual side by side, and tells the worst pixels.
fn report(name: &str, golden: &[u8], shot: &Shot, off: &[(usize, u8)]) -> String {
    let side = shot.side as usize;
    let mut sheet = image::RgbaImage::new(3 * shot.side, shot.side);
    let differs: std::collections::HashSet<usize> = off.iter().map(|(i, _)| *i).collect();
    for (x, y, pixel) in sheet.enumerate_pixels_mut() {
        let (part, x) = (x as usize / side, x as usize % side);
        let index = y as usize * side + x;
        let of = |rgba: &[u8]| image::Rgba([rgba[4 * index], rgba[4 * index + 1], rgba[4 * index + 2], 255]);
        // A pixel's neighbours are marked too, so that a few moved pixels are seen.
        let near = [0, 1, side, side + 1].iter().any(|d| index >= *d && differs.contains(&(index - d)));
        *pixel = match part {
            0 => of(golden),
            1 if near => image::Rgba([255, 0, 255, 255]),
            1 => image::Rgba(of(golden).0.map(|c| c / 3).map(|c| c.max(1))),
            _ => of(&shot.rgba),
        };
    }
    let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}.png"));
    let _ = sheet.save(&out);
    let worst = off.iter().take(6).map(|(i, d)| {
        let at = 4 * i;
        format!(
            "  ({}, {}) golden {:?} now {:?}, off by {d}",
            i % side,
            i / side,
            &golden[at..at + 3],
            &shot.rgba[at..at + 3]
        )
    });
    format!("{}\n  expected | difference | actual: {}", worst.collect::<Vec<_>>().join("\n"), out.display())
}
