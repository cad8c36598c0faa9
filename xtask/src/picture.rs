//! PNG files that stay in git: as small as they can be without changing a pixel.

use crate::process::{Done, Fault, failed};
use std::fs::File;
use std::io::{BufReader, BufWriter};
use std::path::Path;

/// Writes RGB, 8 bits each, rows from the top.
pub fn write_rgb(path: &Path, width: u32, height: u32, rgb: &[u8]) -> Done {
    let why = |e: &dyn std::fmt::Display| failed(format!("{} cannot be written: {e}", path.display()));
    let file = File::create(path).map_err(|e| why(&e))?;
    let mut encoder = png::Encoder::new(BufWriter::new(file), width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::High);
    let mut writer = encoder.write_header().map_err(|e| why(&e))?;
    writer.write_image_data(rgb).map_err(|e| why(&e))?;
    writer.finish().map_err(|e| why(&e))
}

/// Packs an opaque RGBA picture more tightly. The command packs quickly, because its user waits.
pub fn repack(path: &Path) -> Done {
    let (width, height, rgba) = read_rgba(path)?;
    if rgba.chunks_exact(4).any(|pixel| pixel[3] != 255) {
        return Err(failed(format!("{} is not opaque", path.display())));
    }
    let rgb: Vec<u8> = rgba.chunks_exact(4).flat_map(|pixel| &pixel[..3]).copied().collect();
    write_rgb(path, width, height, &rgb)
}

/// In how many pixels two pictures differ.
pub struct Difference {
    pub pixels: usize,
    /// All pixels.
    pub of: usize,
    /// The most that a channel differs by.
    pub most: u8,
}

/// Compares two pictures that [`repack`] wrote.
pub fn difference(a: &Path, b: &Path) -> Result<Difference, Fault> {
    let (read_a, read_b) = (read_rgb(a)?, read_rgb(b)?);
    if read_a.0 != read_b.0 {
        return Err(failed(format!("{} and {} have two sizes", a.display(), b.display())));
    }
    let pixels = || read_a.1.chunks_exact(3).zip(read_b.1.chunks_exact(3));
    let most = read_a.1.iter().zip(&read_b.1).map(|(a, b)| a.abs_diff(*b)).max();
    Ok(Difference {
        pixels: pixels().filter(|(a, b)| a != b).count(),
        of: pixels().count(),
        most: most.unwrap_or_default(),
    })
}

/// Width and height, and the colours.
fn read_rgb(path: &Path) -> Result<((u32, u32), Vec<u8>), Fault> {
    let (width, height, rgba) = read_rgba(path)?;
    let rgb = rgba.chunks_exact(4).flat_map(|pixel| &pixel[..3]).copied().collect();
    Ok(((width, height), rgb))
}

fn read_rgba(path: &Path) -> Result<(u32, u32, Vec<u8>), Fault> {
    let why = |e: &dyn std::fmt::Display| failed(format!("{} cannot be read: {e}", path.display()));
    let file = File::open(path).map_err(|e| why(&e))?;
    let mut decoder = png::Decoder::new(BufReader::new(file));
    decoder.set_transformations(png::Transformations::ALPHA | png::Transformations::STRIP_16);
    let mut reader = decoder.read_info().map_err(|e| why(&e))?;
    let size = reader.output_buffer_size().ok_or_else(|| why(&"it is too large"))?;
    let mut bytes = vec![0; size];
    let info = reader.next_frame(&mut bytes).map_err(|e| why(&e))?;
    bytes.truncate(info.buffer_size());
    match info.color_type {
        png::ColorType::Rgba => Ok((info.width, info.height, bytes)),
        png::ColorType::GrayscaleAlpha => {
            let rgba = bytes.chunks_exact(2).flat_map(|p| [p[0], p[0], p[0], p[1]]).collect();
            Ok((info.width, info.height, rgba))
        }
        other => Err(why(&format!("{other:?} is no kind of picture that is made here"))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packing_again_changes_no_pixel() {
        let path = std::env::temp_dir().join(format!("xtask-repack-{}.png", std::process::id()));
        let rgb: Vec<u8> = (0..48u8).map(|i| i.wrapping_mul(37)).collect();
        write_rgb(&path, 4, 4, &rgb).unwrap();
        let before = read_rgba(&path).unwrap();
        repack(&path).unwrap();
        let after = read_rgba(&path).unwrap();
        let other = path.with_extension("other.png");
        write_rgb(&other, 4, 4, &rgb.iter().map(|x| if *x == 37 { 40 } else { *x }).collect::<Vec<_>>())
            .unwrap();
        let same = difference(&path, &path).unwrap();
        let differs = difference(&path, &other).unwrap();
        std::fs::remove_file(&path).unwrap();
        std::fs::remove_file(&other).unwrap();
        assert_eq!((same.pixels, same.of, same.most), (0, 16, 0));
        assert_eq!((differs.pixels, differs.of, differs.most), (1, 16, 3));
        assert_eq!(before, after);
        assert_eq!(after.2[..8], [0, 37, 74, 255, 111, 148, 185, 255]);
    }
}
