//! Pictures on disk: whole or not at all.

use std::io::Write;
use std::path::Path;

/// An RGBA picture as the bytes of a PNG file.
///
/// # Errors
/// What the encoder says; the number of bytes must be `4 * width * height`.
pub fn encode_png(width: u32, height: u32, rgba: &[u8]) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let encoder = image::codecs::png::PngEncoder::new_with_quality(
        &mut bytes,
        image::codecs::png::CompressionType::Fast,
        image::codecs::png::FilterType::Adaptive,
    );
    image::ImageEncoder::write_image(encoder, rgba, width, height, image::ExtendedColorType::Rgba8)
        .map_err(|e| e.to_string())?;
    Ok(bytes)
}

/// Writes an RGBA picture as PNG: first beside its place, then moved there, so that a failure leaves nothing behind and
/// never half a file.
///
/// # Errors
/// One line: the path, the reason, what to do.
pub fn write_png(path: &Path, width: u32, height: u32, rgba: &[u8]) -> Result<(), String> {
    let refused = |reason: &dyn std::fmt::Display| format!("cannot write {}: {reason}", path.display());
    if path.is_dir() {
        return Err(refused(&"it is a folder; name a .png file in it"));
    }
    let bytes = encode_png(width, height, rgba).map_err(|e| refused(&e))?;
    write_whole(path, &bytes).map_err(|e| {
        let way_out = match e.kind() {
            std::io::ErrorKind::NotFound => "; its folder does not exist, make it or name another",
            std::io::ErrorKind::PermissionDenied => "; choose a folder that you may write to",
            _ => "",
        };
        refused(&format!("{e}{way_out}"))
    })
}

/// Writes a file whole or not at all.
///
/// # Errors
/// What the system says; nothing is left behind.
pub fn write_whole(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    // Devices and pipes (`-o /dev/stdout`) cannot be replaced, only written to.
    if path.exists() && !path.is_file() {
        return std::fs::OpenOptions::new().write(true).open(path)?.write_all(bytes);
    }
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let beside = path.with_file_name(format!(".{name}.{}.part", std::process::id()));
    let written = std::fs::write(&beside, bytes).and_then(|()| std::fs::rename(&beside, path));
    if written.is_err() {
        let _ = std::fs::remove_file(&beside);
    }
    written
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_is_whole_or_not_there() {
        let folder = std::env::temp_dir().join(format!("umbrage-picture-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a temporary folder");
        let rgba: Vec<u8> = (0..4 * 6).collect();
        write_png(&folder.join("a.png"), 3, 2, &rgba).expect("writable");
        let read = image::open(folder.join("a.png")).expect("a PNG").to_rgba8();
        assert_eq!((read.width(), read.height(), read.into_raw()), (3, 2, rgba.clone()));
        let message = write_png(&folder.join("none/b.png"), 3, 2, &rgba).expect_err("no such folder");
        assert!(message.contains("its folder does not exist"), "{message}");
        assert!(write_png(&folder, 3, 2, &rgba).expect_err("a folder").contains("it is a folder"));
        let left: Vec<_> =
            std::fs::read_dir(&folder).expect("folder").flatten().map(|e| e.file_name()).collect();
        assert_eq!(left, ["a.png"]);
        std::fs::remove_dir_all(&folder).expect("clean-up");
    }
}
