//! Pictures that MTL names: found, decoded once, joined with their cut-out.

use super::lines::quoted;
use crate::{Image, TextureRef, Wrap};
use glam::{Affine2, Mat2, Vec2};
use std::{
    collections::{HashMap, HashSet},
    io::{Cursor, Read},
    path::{Path, PathBuf},
};

/// Larger files are not read.
const MAX_IMAGE_BYTES: u64 = 256 << 20;
/// Wider or higher pictures are not decoded: no GPU takes them.
const MAX_IMAGE_SIDE: u32 = 16_384;

/// What a picture line says: options, then a file name that may have spaces.
#[derive(Debug, PartialEq)]
struct MapLine<'a> {
    name: &'a str,
    offset: Vec2,
    scale: Vec2,
    clamp: bool,
}

fn parse_map(text: &str) -> MapLine<'_> {
    let mut line = MapLine { name: "", offset: Vec2::ZERO, scale: Vec2::ONE, clamp: false };
    let mut rest = text.trim();
    while let Some((option, mut after)) =
        rest.split_once(char::is_whitespace).filter(|(o, _)| o.starts_with('-'))
    {
        let mut word = || {
            let (word, tail) =
                after.trim_start().split_once(char::is_whitespace).unwrap_or((after.trim(), ""));
            after = tail;
            word
        };
        match option {
            "-o" | "-s" | "-t" => {
                // One to three numbers; the file name follows.
                let (numbers, tail) = leading_numbers(after);
                let missing = if option == "-s" { 1.0 } else { 0.0 };
                let at = |i: usize| numbers.get(i).copied().unwrap_or(missing);
                match option {
                    "-o" => line.offset = Vec2::new(at(0), at(1)),
                    "-s" => line.scale = Vec2::new(at(0), at(1)),
                    _ => {}
                }
                after = tail;
            }
            "-mm" => {
                word();
                word();
            }
            "-clamp" => line.clamp = word() == "on",
            "-blendu" | "-blendv" | "-cc" | "-bm" | "-boost" | "-texres" | "-imfchan" | "-type" => {
                word();
            }
            // A file name that starts with a hyphen.
            _ => break,
        }
        rest = after.trim_start();
    }
    line.name = rest.trim().trim_matches('"');
    line
}

fn leading_numbers(text: &str) -> (Vec<f32>, &str) {
    let mut rest = text.trim_start();
    let mut numbers = Vec::new();
    while numbers.len() < 3
        && let Some((word, tail)) = rest.split_once(char::is_whitespace)
        && let Some(number) = super::lines::finite(word)
    {
        numbers.push(number.clamp(-1e6, 1e6));
        rest = tail.trim_start();
    }
    (numbers, rest)
}

impl MapLine<'_> {
    fn texture(&self, image: usize) -> TextureRef {
        // The options count rows from the bottom: t = o + s * (1 - v), and our row is 1 - t.
        let from_top = Vec2::new(self.offset.x, 1.0 - self.offset.y - self.scale.y);
        let uv_from_texcoord = Affine2::from_mat2_translation(Mat2::from_diagonal(self.scale), from_top);
        let wrap = if self.clamp { Wrap::Clamp } else { Wrap::Repeat };
        TextureRef { image, wrap: [wrap; 2], linear: true, uv_set: 0, uv_from_texcoord }
    }
}

/// The file of that name: as it is written, or, for paths of somebody else's machine, by its last part.
pub(super) fn find(folders: &[&Path], name: &str) -> Option<PathBuf> {
    let name = name.replace('\\', "/");
    let last = name.rsplit('/').next().filter(|last| !last.is_empty())?;
    let there = |path: PathBuf| path.is_file().then_some(path);
    let as_written = folders.iter().find_map(|folder| there(folder.join(&name)));
    as_written.or_else(|| folders.iter().find_map(|folder| there(folder.join(last))))
}

/// A plain file's bytes, unless there are too many.
pub(super) fn read_bounded(path: &Path, limit: u64) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    std::fs::File::open(path).ok()?.take(limit + 1).read_to_end(&mut bytes).ok()?;
    (bytes.len() as u64 <= limit).then_some(bytes)
}

/// A material's colour, and whether parts of it are cut out.
pub(super) struct BaseColor {
    pub texture: Option<TextureRef>,
    pub cut_out: bool,
}

/// The scene's pictures while materials are read.
#[derive(Default)]
pub(super) struct Textures {
    images: Vec<Image>,
    /// By colour file and cut-out file; `None`: there is no such picture.
    index_of: HashMap<(Option<PathBuf>, Option<PathBuf>), Option<usize>>,
    reported: HashSet<String>,
}

impl Textures {
    pub(super) fn into_images(self) -> Vec<Image> {
        self.images
    }

    /// A picture as it is.
    pub(super) fn plain(
        &mut self,
        text: &str,
        folders: &[&Path],
        warnings: &mut Vec<String>,
    ) -> Option<TextureRef> {
        let line = parse_map(text);
        let path = self.locate(line.name, folders, warnings)?;
        let index = self.cached((Some(path.clone()), None), warnings, || decode(&path))?;
        Some(line.texture(index))
    }

    /// A `map_bump`, if it is a normal map: the format means a height map by it, many exporters a normal map.
    pub(super) fn normal_map(
        &mut self,
        text: &str,
        folders: &[&Path],
        warnings: &mut Vec<String>,
    ) -> Option<TextureRef> {
        let texture = self.plain(text, folders, warnings)?;
        if looks_like_normals(&self.images[texture.image]) {
            return Some(texture);
        }
        let name = quoted(parse_map(text).name);
        self.warn_once(format!("{name} is a height map, which is not used; a normal map would be"), warnings);
        None
    }

    /// `map_Kd`, with `map_d` as its alpha.
    pub(super) fn base_color(
        &mut self,
        color: Option<&str>,
        cut_out: Option<&str>,
        folders: &[&Path],
        warnings: &mut Vec<String>,
    ) -> BaseColor {
        if let Some(found) = cut_out.and_then(|cut| self.joined(color, cut, folders, warnings)) {
            return BaseColor { texture: Some(found), cut_out: true };
        }
        let texture = color.and_then(|text| self.plain(text, folders, warnings));
        BaseColor { texture, cut_out: false }
    }

    /// Colour and cut-out in one picture; `None` when there is no usable cut-out.
    fn joined(
        &mut self,
        color: Option<&str>,
        cut_out: &str,
        folders: &[&Path],
        warnings: &mut Vec<String>,
    ) -> Option<TextureRef> {
        let (color, cut_out) = (color.map(parse_map), parse_map(cut_out));
        let cut_path = self.locate(cut_out.name, folders, warnings)?;
        let color_path = color.as_ref().and_then(|line| self.locate(line.name, folders, warnings));
        let key = (color_path.clone(), Some(cut_path.clone()));
        let index = self.cached(key, warnings, || {
            let alpha = alpha_of(&decode(&cut_path)?)?;
            // A colour that cannot be decoded leaves its cut-out: the shadow is what counts.
            let color = color_path.and_then(|path| decode(&path).ok());
            Ok(join(color.as_ref(), &alpha))
        })?;
        Some(color.unwrap_or(cut_out).texture(index))
    }

    fn locate(&mut self, name: &str, folders: &[&Path], warnings: &mut Vec<String>) -> Option<PathBuf> {
        let found = find(folders, name);
        if found.is_none() {
            self.warn_once(format!("picture {} is not there; plain colour instead", quoted(name)), warnings);
        }
        found
    }

    fn cached(
        &mut self,
        key: (Option<PathBuf>, Option<PathBuf>),
        warnings: &mut Vec<String>,
        make: impl FnOnce() -> Result<Image, String>,
    ) -> Option<usize> {
        if let Some(known) = self.index_of.get(&key) {
            return *known;
        }
        let made = match make() {
            Ok(image) => {
                self.images.push(image);
                Some(self.images.len() - 1)
            }
            Err(what) => {
                self.warn_once(what, warnings);
                None
            }
        };
        self.index_of.insert(key, made);
        made
    }

    fn warn_once(&mut self, what: String, warnings: &mut Vec<String>) {
        if self.reported.insert(what.clone()) {
            warnings.push(what);
        }
    }
}

fn decode(path: &Path) -> Result<Image, String> {
    let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let refuse = |why: &str| format!("picture {}: {why}; plain colour instead", quoted(&name));
    let bytes = read_bounded(path, MAX_IMAGE_BYTES).ok_or_else(|| refuse("unreadable or above 256 MB"))?;
    let mut reader = image::ImageReader::new(Cursor::new(bytes))
        .with_guessed_format()
        .map_err(|_| refuse("unreadable"))?;
    let mut limits = image::Limits::default();
    limits.max_image_width = Some(MAX_IMAGE_SIDE);
    limits.max_image_height = Some(MAX_IMAGE_SIDE);
    reader.limits(limits);
    let rgba = reader.decode().map_err(|_| refuse("neither PNG, JPEG nor WebP, or broken"))?.to_rgba8();
    Ok(Image { name, width: rgba.width(), height: rgba.height(), rgba: rgba.into_raw() })
}

/// One channel of coverage.
struct Alpha {
    name: String,
    width: u32,
    height: u32,
    values: Vec<u8>,
}

/// The alpha channel where there is one, else the brightness of a grey picture.
fn alpha_of(image: &Image) -> Result<Alpha, String> {
    let pixels = || image.rgba.chunks_exact(4);
    let values: Vec<u8> = if pixels().any(|p| p[3] < 255) {
        pixels().map(|p| p[3]).collect()
    } else if pixels().all(|p| p[0].abs_diff(p[1]) < 16 && p[1].abs_diff(p[2]) < 16) {
        pixels().map(|p| p[1]).collect()
    } else {
        let name = quoted(&image.name);
        return Err(format!("map_d {name} has colours and no alpha: nothing is cut out"));
    };
    Ok(Alpha { name: image.name.clone(), width: image.width, height: image.height, values })
}

/// Colour and coverage in one picture, as fine as the finer of both, by the nearest texel.
fn join(color: Option<&Image>, alpha: &Alpha) -> Image {
    let (color_width, color_height) = color.map_or((1, 1), |c| (c.width, c.height));
    let (width, height) = (color_width.max(alpha.width), color_height.max(alpha.height));
    let near = |i: u32, of: u32, n: u32| (u64::from(i) * u64::from(n) / u64::from(of)) as usize;
    let mut rgba = Vec::with_capacity(width as usize * height as usize * 4);
    for y in 0..height {
        for x in 0..width {
            let texel = color.map_or([255; 3], |c| {
                let i = 4 * (near(y, height, c.height) * c.width as usize + near(x, width, c.width));
                [c.rgba[i], c.rgba[i + 1], c.rgba[i + 2]]
            });
            let a = near(y, height, alpha.height) * alpha.width as usize + near(x, width, alpha.width);
            rgba.extend_from_slice(&[texel[0], texel[1], texel[2], alpha.values[a]]);
        }
    }
    let name = color.map_or_else(|| alpha.name.clone(), |c| c.name.clone());
    Image { name, width, height, rgba }
}

/// Do the texels point outwards: red and green about the middle, blue near the top?
fn looks_like_normals(image: &Image) -> bool {
    let mut sum = [0u64; 3];
    for pixel in image.rgba.chunks_exact(4) {
        for (s, c) in sum.iter_mut().zip(pixel) {
            *s += u64::from(*c);
        }
    }
    let mean = sum.map(|s| s as f64 / (image.rgba.len() / 4).max(1) as f64 / 255.0);
    (mean[0] - 0.5).abs() < 0.1 && (mean[1] - 0.5).abs() < 0.1 && mean[2] > 0.7
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_do_not_break_the_name() {
        let name = |text| parse_map(text).name;
        assert_eq!(name("-bm 0.2 bump map.png"), "bump map.png");
        assert_eq!(name("-s 1.0 1.0 1.0 -o 0.0 0.0 0.0 diffuse.png"), "diffuse.png");
        assert_eq!(name("-o 0.5 2.png"), "2.png");
        assert_eq!(name("-mm 0 1 -imfchan l -clamp on -type sphere \"a b.png\""), "a b.png");
        assert_eq!(name("-strange.png"), "-strange.png");
        assert_eq!(name("-odd one.png"), "-odd one.png");
        assert_eq!(name("-o"), "-o");
    }

    #[test]
    fn offset_and_scale_count_from_the_bottom() {
        let line = parse_map("-s 2 4 -o 0.25 0.5 -clamp on a.png");
        let texture = line.texture(0);
        let uv = texture.uv_from_texcoord.transform_point2(Vec2::new(0.1, 1.0 - 0.2));
        assert!(uv.distance(Vec2::new(0.25 + 0.2, 1.0 - (0.5 + 0.8))) < 1e-6, "{uv}");
        assert_eq!(texture.wrap, [Wrap::Clamp; 2]);
        assert_eq!(parse_map("a.png").texture(0).uv_from_texcoord, Affine2::IDENTITY);
    }

    fn image(width: u32, rgba: &[[u8; 4]]) -> Image {
        Image { name: "t".into(), width, height: rgba.len() as u32 / width, rgba: rgba.concat() }
    }

    #[test]
    fn alpha_is_taken_before_brightness_and_colours_are_refused() {
        let rgba = alpha_of(&image(2, &[[9, 99, 9, 0], [9, 99, 9, 255]])).unwrap();
        assert_eq!(rgba.values, [0, 255]);
        let grey = alpha_of(&image(2, &[[10, 10, 10, 255], [200, 200, 200, 255]])).unwrap();
        assert_eq!(grey.values, [10, 200]);
        assert!(alpha_of(&image(1, &[[10, 200, 10, 255]])).is_err());
    }

    #[test]
    fn joined_pictures_take_the_finer_size() {
        let alpha = Alpha { name: "a".into(), width: 2, height: 1, values: vec![0, 255] };
        let color = image(1, &[[1, 2, 3, 255], [4, 5, 6, 255]]);
        let joined = join(Some(&color), &alpha);
        assert_eq!((joined.width, joined.height), (2, 2));
        assert_eq!(joined.rgba, [1, 2, 3, 0, 1, 2, 3, 255, 4, 5, 6, 0, 4, 5, 6, 255]);
        assert_eq!(join(None, &alpha).rgba, [255, 255, 255, 0, 255, 255, 255, 255]);
    }

    #[test]
    fn a_normal_map_is_told_from_a_height_map() {
        assert!(looks_like_normals(&image(1, &[[128, 127, 250, 255]])));
        assert!(!looks_like_normals(&image(1, &[[128, 128, 128, 255]])));
    }
}
