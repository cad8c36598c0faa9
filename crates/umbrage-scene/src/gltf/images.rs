//! Pictures: fetched, decoded side by side, each once.

use super::document::{Document, label};
use super::{materials, uri};
use crate::{Image, Material};
use image::ImageDecoder as _;
use std::collections::{BTreeSet, HashMap};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Most pixels on a side: what GPUs take.
const SIDE_MAX: u32 = 16384;
/// Most bytes of a decoded picture.
const BYTES_MAX: u64 = 512 << 20;
/// Most bytes of all decoded pictures of a file.
const TOTAL_BYTES_MAX: u64 = 4 << 30;
/// Most bytes of an encoded picture.
const FILE_BYTES_MAX: u64 = 1 << 30;

/// Decodes the images that materials use and turns the materials' image numbers from the file's into the result's.
/// A picture that cannot be had is a warning, and the materials do without it.
pub(super) fn load(
    document: &Document<'_>,
    materials: &mut [Material],
    warnings: &mut Vec<String>,
) -> Result<Vec<Image>, String> {
    let used: BTreeSet<usize> =
        materials.iter_mut().flat_map(slots).filter_map(|slot| slot.map(|texture| texture.image)).collect();
    let used: Vec<usize> = used.into_iter().collect();
    let mut jobs = Vec::with_capacity(used.len());
    for &index in &used {
        jobs.push(bytes(document, index)?);
    }
    let mut images = Vec::new();
    let mut places = HashMap::new();
    for (index, decoded) in used.iter().zip(decode_all(&jobs)) {
        match decoded {
            Ok((width, height, rgba)) => {
                places.insert(*index, images.len());
                images.push(Image { name: materials::image_name(document, *index), width, height, rgba });
            }
            Err(reason) => {
                let name = materials::image_name(document, *index);
                warnings.push(format!("texture \"{name}\": {reason}; surfaces are drawn without it"));
            }
        }
    }
    for slot in materials.iter_mut().flat_map(slots) {
        *slot = slot
            .and_then(|texture| Some(crate::TextureRef { image: *places.get(&texture.image)?, ..texture }));
    }
    Ok(images)
}

fn slots(material: &mut Material) -> [&mut Option<crate::TextureRef>; 4] {
    [
        &mut material.base_color_texture,
        &mut material.metallic_roughness_texture,
        &mut material.normal_texture,
        &mut material.emissive_texture,
    ]
}

/// An image's encoded bytes. Only a broken buffer view is the file's fault as a whole.
fn bytes<'a>(
    document: &'a Document<'_>,
    index: usize,
) -> Result<Result<std::borrow::Cow<'a, [u8]>, String>, String> {
    let json = &document.root.images[index];
    Ok(match (json.buffer_view, &json.uri) {
        (Some(view), _) => {
            let place = label("image", index, json.name.as_ref());
            Ok(document.view(view.value()).map_err(|e| format!("{place}: {e}"))?.into())
        }
        (None, Some(name)) => uri::read(&document.path, name, FILE_BYTES_MAX).map(Into::into),
        (None, None) => Err("it has neither a URI nor a bufferView".into()),
    })
}

type Decoded = Result<(u32, u32, Vec<u8>), String>;

/// Decodes on every core: pictures are most of the time that a textured scene takes to load.
fn decode_all(jobs: &[Result<std::borrow::Cow<'_, [u8]>, String>]) -> Vec<Decoded> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from).min(jobs.len());
    let next = AtomicUsize::new(0);
    let total = Mutex::new(0_u64);
    let results: Mutex<Vec<Option<Decoded>>> = Mutex::new(vec![None; jobs.len()]);
    let work = || {
        loop {
            let at = next.fetch_add(1, Ordering::Relaxed);
            let Some(job) = jobs.get(at) else { break };
            let decoded = match job {
                Ok(bytes) => catch_unwind(AssertUnwindSafe(|| decode(bytes, &total)))
                    .unwrap_or_else(|_| Err("its data is damaged".into())),
                Err(reason) => Err(reason.clone()),
            };
            if let Ok(mut results) = results.lock() {
                results[at] = Some(decoded);
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..cores {
            scope.spawn(work);
        }
        work();
    });
    let results = results.into_inner().unwrap_or_default();
    results.into_iter().map(|result| result.unwrap_or_else(|| Err("it was not decoded".into()))).collect()
}

fn decode(bytes: &[u8], total: &Mutex<u64>) -> Decoded {
    let damaged = |e: image::ImageError| format!("cannot decode it: {e}");
    let mut reader = image::ImageReader::new(std::io::Cursor::new(bytes))
        .with_guessed_format()
        .map_err(|e| format!("cannot decode it: {e}"))?;
    if reader.format().is_none() {
        return Err("it is neither PNG, JPEG nor WebP".into());
    }
    let mut limits = image::Limits::default();
    // Twice, because 16-bit pictures are decoded whole before they are narrowed.
    limits.max_alloc = Some(2 * BYTES_MAX);
    reader.limits(limits);
    let decoder = reader.into_decoder().map_err(damaged)?;
    let (width, height) = decoder.dimensions();
    let size = u64::from(width) * u64::from(height) * 4;
    if width > SIDE_MAX || height > SIDE_MAX || size > BYTES_MAX {
        let (mib, most) = (size >> 20, BYTES_MAX >> 20);
        return Err(format!(
            "{width} x {height} pixels ({mib} MiB) are too many; {SIDE_MAX} a side and {most} MiB are allowed, scale it down"
        ));
    }
    {
        let mut total = total.lock().map_err(|_| "another picture failed".to_owned())?;
        if *total + size > TOTAL_BYTES_MAX {
            return Err(format!("the file's pictures take more than {} GiB", TOTAL_BYTES_MAX >> 30));
        }
        *total += size;
    }
    let pixels = image::DynamicImage::from_decoder(decoder).map_err(damaged)?.into_rgba8();
    Ok((width, height, pixels.into_raw()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn png(image: &image::DynamicImage) -> Vec<u8> {
        let mut bytes = std::io::Cursor::new(Vec::new());
        image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
        bytes.into_inner()
    }

    #[test]
    fn every_kind_of_pixel_becomes_rgba8() {
        use image::DynamicImage as D;
        let kinds = [
            D::new_luma8(2, 1),
            D::new_luma_a8(2, 1),
            D::new_rgb8(2, 1),
            D::new_rgba8(2, 1),
            D::new_luma16(2, 1),
            D::new_rgba16(2, 1),
        ];
        for kind in kinds {
            let (width, height, rgba) = decode(&png(&kind), &Mutex::new(0)).unwrap();
            assert_eq!((width, height, rgba.len()), (2, 1, 8), "{:?}", kind.color());
        }
        let white = D::ImageLuma16(image::ImageBuffer::from_pixel(1, 1, image::Luma([0x00FF])));
        assert_eq!(decode(&png(&white), &Mutex::new(0)).unwrap().2, [1, 1, 1, 255], "rounded from 16 bits");
    }

    #[test]
    fn too_large_and_broken_pictures_are_refused_in_words() {
        let wide = png(&image::DynamicImage::new_luma8(SIDE_MAX + 1, 1));
        assert!(decode(&wide, &Mutex::new(0)).unwrap_err().contains("16385 x 1"));
        let good = png(&image::DynamicImage::new_rgb8(8, 8));
        assert!(decode(&good[..good.len() / 2], &Mutex::new(0)).is_err());
        assert!(decode(b"GIF89a", &Mutex::new(0)).is_err());
        assert!(decode(&good, &Mutex::new(TOTAL_BYTES_MAX)).unwrap_err().contains("GiB"));
    }
}
