//! MTL: what the surfaces look like. `tobj` reads it, after lines that would make it panic or give up are mended.

use super::{
    lines::{Lines, finite, keyword, quoted},
    scan::Scan,
    textures::{Textures, find, read_bounded},
};
use crate::{AlphaMode, Material, Reflectance, Scene};
use glam::{Vec3, Vec4};
use std::{
    collections::{HashMap, HashSet},
    fmt::Write,
    path::{Path, PathBuf},
};

/// An MTL file is text that people can read; a larger one is something else.
const MAX_MTL_BYTES: u64 = 64 << 20;

/// More file names than this on one `mtllib` line are no honest file's.
const MAX_NAMES: usize = 64;

/// All materials of all `mtllib` files, and where their pictures lie.
pub(super) struct Library {
    by_name: HashMap<String, (tobj::Material, PathBuf)>,
    obj_folder: PathBuf,
    read: HashSet<PathBuf>,
}

/// sRGB to linear, channel by channel. MTL says nothing about colour spaces; programs write what their colour picker
/// shows, which is sRGB. `Kd`, `Ka`, `Ks`, `Ke` and vertex colours are all read so.
pub(super) fn linear_from_srgb(srgb: Vec3) -> Vec3 {
    let channel = |x: f32| if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) };
    let x = srgb.clamp(Vec3::ZERO, Vec3::ONE);
    Vec3::new(channel(x.x), channel(x.y), channel(x.z))
}

impl Library {
    /// Reads what stands after each `mtllib`: one file whose name may have spaces, or several files.
    pub(super) fn read(obj: &Path, libraries: &[String], warnings: &mut Vec<String>) -> Self {
        let obj_folder = obj.parent().unwrap_or(Path::new("")).to_owned();
        let mut library = Self { by_name: HashMap::new(), obj_folder, read: HashSet::new() };
        for names in libraries {
            if library.read_file(names, warnings) {
                continue;
            }
            let found = names
                .split_whitespace()
                .take(MAX_NAMES)
                .filter(|name| library.read_file(name, warnings))
                .count();
            if found == 0 {
                warnings
                    .push(format!("mtllib {} is not there; its materials are matte white", quoted(names)));
            }
        }
        library
    }

    fn read_file(&mut self, name: &str, warnings: &mut Vec<String>) -> bool {
        let Some(path) = find(&[&self.obj_folder], name) else { return false };
        if !self.read.insert(path.clone()) {
            return true;
        }
        let Some(bytes) = read_bounded(&path, MAX_MTL_BYTES) else { return false };
        let text = tidy(&bytes, &quoted(name), warnings);
        match tobj::load_mtl_buf(&mut text.as_bytes()) {
            Ok((materials, _)) => {
                let folder = path.parent().unwrap_or(Path::new(""));
                for material in materials {
                    let key = material.name.clone();
                    self.by_name.entry(key).or_insert_with(|| (material, folder.to_owned()));
                }
            }
            Err(error) => warnings.push(format!("mtllib {}: {error}", quoted(name))),
        }
        true
    }

    /// Adds the materials that faces use to the scene, and gives each run its index.
    pub(super) fn convert(&self, scan: &Scan, scene: &mut Scene) -> Vec<usize> {
        let mut textures = Textures::default();
        let mut index_of: HashMap<Option<usize>, usize> = HashMap::new();
        let mut white = None;
        let mut unknown = Vec::new();
        let indices = scan
            .runs
            .iter()
            .map(|run| {
                *index_of.entry(run.material).or_insert_with(|| {
                    let named = run.material.map(|m| scan.materials[m].as_str());
                    let Some((found, folder)) = named.and_then(|name| self.by_name.get(name)) else {
                        unknown.extend(named.map(quoted));
                        return *white.get_or_insert_with(|| {
                            scene.materials.push(Material { double_sided: true, ..Material::default() });
                            scene.materials.len() - 1
                        });
                    };
                    let folders: [&Path; 2] = [folder, &self.obj_folder];
                    let material = material(found, &mut textures, &folders, &mut scene.warnings);
                    scene.materials.push(material);
                    scene.materials.len() - 1
                })
            })
            .collect();
        if let Some(first) = unknown.first() {
            let more = match unknown.len() - 1 {
                0 => String::new(),
                more => format!(" (and {more} more)"),
            };
            scene.warnings.push(format!("usemtl {first}{more}: not in any mtllib; matte white instead"));
        }
        scene.images = textures.into_images();
        indices
    }
}

fn material(
    mtl: &tobj::Material,
    textures: &mut Textures,
    folders: &[&Path],
    warnings: &mut Vec<String>,
) -> Material {
    let color =
        |c: Option<[f32; 3]>, missing: f32| linear_from_srgb(c.map_or(Vec3::splat(missing), Vec3::from));
    let extra = |key: &str| mtl.unknown_param.get(key).map(String::as_str);
    let mut kd = color(mtl.diffuse, 1.0);
    let dissolve = mtl.dissolve.unwrap_or(1.0).clamp(0.0, 1.0);
    let cut_out = mtl.dissolve_texture.as_deref();
    let base = textures.base_color(mtl.diffuse_texture.as_deref(), cut_out, folders, warnings);
    // Many exporters write black beside a picture and mean the picture.
    if base.texture.is_some() && kd == Vec3::ZERO {
        kd = Vec3::ONE;
    }
    let alpha = match (base.cut_out, dissolve < 1.0) {
        (true, _) => AlphaMode::Mask { cutoff: 0.5 },
        (false, true) => AlphaMode::Blend,
        (false, false) => AlphaMode::Opaque,
    };
    if dissolve == 0.0 && !base.cut_out {
        warnings.push(format!("material {} is wholly transparent (d 0 or Tr 1)", quoted(&mtl.name)));
    }
    // The cut-out decides by itself what is there; a factor below the cutoff would take everything away.
    let opacity = if base.cut_out { 1.0 } else { dissolve };
    let emissive_texture = extra("map_Ke").and_then(|text| textures.plain(text, folders, warnings));
    let emissive = match (mtl.emissive, emissive_texture) {
        (None, Some(_)) => Vec3::ONE,
        (ke, _) => color(ke, 0.0),
    };
    let bump = mtl.normal_texture.as_deref();
    let normal_texture = extra("norm")
        .or_else(|| extra("map_Kn"))
        .and_then(|text| textures.plain(text, folders, warnings))
        .or_else(|| bump.and_then(|text| textures.normal_map(text, folders, warnings)));
    Material {
        name: mtl.name.clone(),
        base_color: Vec4::from((kd, opacity)),
        base_color_texture: base.texture,
        reflectance: Reflectance::Blinn {
            ambient: color(mtl.ambient, 1.0),
            specular: color(mtl.specular, 0.0),
            shininess: mtl.shininess.unwrap_or(1.0).clamp(1.0, 10_000.0),
        },
        normal_texture,
        emissive,
        emissive_texture,
        alpha,
        // Nothing in an OBJ file says which side of a face is its front.
        double_sided: true,
        ..Material::default()
    }
}

/// The lines that matter, in the form that `tobj` reads. It panics on a colour with fewer than three numbers and throws
/// the whole file away for one that it does not understand.
fn tidy(bytes: &[u8], name: &str, warnings: &mut Vec<String>) -> String {
    let mut text = String::new();
    let (mut within, mut has_d) = (false, false);
    for (number, line) in Lines::new(bytes) {
        let (key, rest) = keyword(&line);
        let key = canonical(key);
        let numbers = || rest.split_whitespace().map_while(finite).collect::<Vec<f32>>();
        let mut bad = false;
        match key {
            "newmtl" => {
                (within, has_d) = (!rest.is_empty(), false);
                bad = rest.is_empty();
                if within {
                    let _ = writeln!(text, "newmtl {rest}");
                }
            }
            _ if !within => {}
            "Ka" | "Kd" | "Ks" | "Ke" => match numbers()[..] {
                [r, g, b, ..] => {
                    let _ = writeln!(text, "{key} {r} {g} {b}");
                }
                [grey] => {
                    let _ = writeln!(text, "{key} {grey} {grey} {grey}");
                }
                _ => bad = true,
            },
            // The last word: `d -halo 0.5` has one before the number.
            "Ns" | "d" | "Tr" => match rest.split_whitespace().last().and_then(finite) {
                Some(transparency) if key == "Tr" => {
                    // Where both stand, they say the same, or `d` is right.
                    if !has_d {
                        let _ = writeln!(text, "d {}", 1.0 - transparency);
                    }
                }
                Some(x) => {
                    has_d |= key == "d";
                    let _ = writeln!(text, "{key} {x}");
                }
                None => bad = true,
            },
            "map_Kd" | "map_d" | "map_Ke" | "map_Kn" | "norm" | "bump" => {
                bad = rest.is_empty();
                if !bad {
                    let _ = writeln!(text, "{key} {rest}");
                }
            }
            _ => {}
        }
        if bad {
            warnings.push(format!("{name} line {number}: {} is passed over", quoted(&line)));
        }
    }
    text
}

/// Programs do not agree on capitals.
fn canonical(key: &str) -> &str {
    const KEYS: [&str; 14] = [
        "newmtl", "Ka", "Kd", "Ks", "Ke", "Ns", "d", "Tr", "map_Kd", "map_d", "map_Ke", "map_Kn", "norm",
        "bump",
    ];
    if key.eq_ignore_ascii_case("map_bump") {
        return "bump";
    }
    KEYS.into_iter().find(|k| k.eq_ignore_ascii_case(key)).unwrap_or("")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_that_tobj_panics_on_or_gives_up_at_are_mended() {
        let mut warnings = Vec::new();
        let text = "Kd 1 1 1\nnewmtl a b\nkd 0.5\nKs 1 2\nKa spectral x.rfl\nNs\nd -halo 0.25\nTr 0.9\nillum x\nmap_kd\n";
        let tidied = tidy(text.as_bytes(), "x.mtl", &mut warnings);
        assert_eq!(tidied, "newmtl a b\nKd 0.5 0.5 0.5\nd 0.25\n");
        assert_eq!(warnings.len(), 4, "{warnings:?}");
        let (materials, _) = tobj::load_mtl_buf(&mut tidied.as_bytes()).unwrap();
        assert_eq!((materials[0].name.as_str(), materials[0].dissolve), ("a b", Some(0.25)));
    }

    #[test]
    fn tr_is_what_d_leaves() {
        let d = |text: &str| {
            let tidied = tidy(text.as_bytes(), "", &mut Vec::new());
            tobj::load_mtl_buf(&mut tidied.as_bytes()).unwrap().0[0].dissolve.unwrap()
        };
        assert!((d("newmtl a\nTr 0.25\n") - 0.75).abs() < 1e-6);
        assert_eq!((d("newmtl a\nd 0.9\nTr 0.9"), d("newmtl a\nTr 0.9\nd 0.9")), (0.9, 0.9));
    }

    #[test]
    fn srgb_goes_to_linear() {
        let linear = linear_from_srgb(Vec3::new(0.5, 1.0, 20.0));
        assert!(linear.distance(Vec3::new(0.214_04, 1.0, 1.0)) < 1e-4, "{linear}");
        assert_eq!(linear_from_srgb(Vec3::ZERO), Vec3::ZERO);
    }
}
