//! The whole loader on text made here.

use super::*;
use crate::Reflectance;
use glam::Vec3;

fn load_text(text: &str) -> Result<Scene, SceneError> {
    load(Path::new("/nowhere/made here.obj"), text.as_bytes())
}

/// A file with everything in it: a grid of quads with normals and coordinates, n-gons without, groups, materials.
fn rich() -> String {
    use std::fmt::Write;
    let mut text = String::from("# made for tests\nmtllib a b.mtl c.mtl\no grid\n");
    for y in 0..6 {
        for x in 0..6 {
            writeln!(text, "v {x} {:.3} {y}\nvt {} {}", (x * y) as f32 * 0.1, x as f32 / 5.0, y as f32 / 5.0)
                .unwrap();
        }
    }
    text.push_str("vn 0 1 0\nvn 0 0.8 0.6\nusemtl a\ns 1\n");
    for y in 0..5 {
        for x in 0..5 {
            let a = y * 6 + x + 1;
            let (b, c, d) = (a + 1, a + 7, a + 6);
            writeln!(text, "f {a}/{a}/1 {d}/{d}/1 {c}/{c}/2 {b}/{b}/1").unwrap();
        }
    }
    text.push_str("g star\nusemtl b\ns off\n");
    for i in 0..10 {
        let (sin, cos) = (i as f32 * 0.628_318).sin_cos();
        let r = if i % 2 == 0 { 2.0 } else { 0.7 };
        writeln!(text, "v {} 4 {}", r * cos, r * sin).unwrap();
    }
    text.push_str("f -1 -2 -3 -4 -5 \\\n -6 -7 -8 -9 -10\nl 1 2 3 4\np 1\n");
    text
}

#[test]
fn a_rich_file_loads_whole() {
    let scene = load_text(&rich()).unwrap();
    assert_eq!(scene.name, "made here");
    assert_eq!(scene.triangles(), 50 + 8);
    assert_eq!((scene.materials.len(), scene.meshes.len()), (1, 1), "both unknown materials are one white");
    assert_eq!(scene.meshes[0].uvs.len(), scene.meshes[0].positions.len());
    assert_eq!(scene.warnings.len(), 2, "{:?}", scene.warnings);
}

#[test]
fn texture_rows_count_from_the_top() {
    let scene = load_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.25 0.125\nf 1/1 2/1 3/1\n").unwrap();
    assert_eq!(scene.meshes[0].uvs[0].to_array(), [0.25, 0.875]);
}

#[test]
fn faces_without_normals_do_not_borrow_those_of_others() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 1\nf 1//1 2//1 3//1\nf 1 2 4\n";
    let mesh = &load_text(text).unwrap().meshes[0];
    let normal = |face: usize| mesh.normals[mesh.indices[3 * face] as usize];
    assert_eq!(normal(0), Vec3::Z);
    assert_eq!(normal(1), Vec3::NEG_Y);
}

#[test]
fn files_without_faces_say_what_they_hold() {
    for text in ["", "\n\n", "v 1 2 3\np 1\n", "\u{0}\u{1}\u{2}", "# only talk", "v 1 1 1\nf 1 1\n"] {
        let error = load_text(text).expect_err(text);
        assert!(matches!(error, SceneError::NoTriangles { .. }), "{error}");
    }
}

#[test]
fn colours_of_scanners_are_scaled() {
    let scene = load_text("v 0 0 0 255 0 0\nv 1 0 0\nv 0 1 0 0 255 0\nf 1 2 3\n").unwrap();
    assert_eq!(scene.meshes[0].colors[0], [255, 0, 0, 255]);
}

#[test]
fn bytes_that_are_no_text_do_not_matter_in_names() {
    let text = b"o caf\xe9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl \xff\xfe\nf 1 2 3\n";
    assert_eq!(load(Path::new("x.obj"), text).unwrap().triangles(), 1);
}

#[test]
fn mtl_becomes_blinn() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../target/umbrage-scene-tests");
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("two words.mtl"), "newmtl red one\nKd 0.5 0 0\nKs 1 1 1\nNs 40\nTr 0.5\n")
        .unwrap();
    let text = "mtllib two words.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red one\nf 1 2 3\n";
    let scene = load(&folder.join("x.obj"), text.as_bytes()).unwrap();
    assert_eq!(scene.warnings, Vec::<String>::new());
    let material = &scene.materials[scene.meshes[0].material];
    assert!((material.base_color - glam::Vec4::new(0.214_04, 0.0, 0.0, 0.5)).length() < 1e-4);
    assert_eq!(material.alpha, crate::AlphaMode::Blend);
    assert!(matches!(material.reflectance, Reflectance::Blinn { shininess: 40.0, .. }));
}

/// Nothing that a file can have many of may cost the square of their number.
#[test]
fn many_of_everything_is_quick() {
    use std::fmt::Write;
    let mut text = String::from("v 0 0 0\nv 1 0 0\nv 0 1 0\n");
    for i in 0..100_000 {
        writeln!(text, "mtllib {i}.mtl\nusemtl m{i}\ns {i}\ng {i}\nf 1 2 3").unwrap();
    }
    let started = std::time::Instant::now();
    let scene = load_text(&text).unwrap();
    eprintln!("many of everything: {:?}", started.elapsed());
    assert_eq!((scene.triangles(), scene.meshes.len()), (100_000, 1));
    assert!(scene.warnings.len() <= MAX_WARNINGS + 1);
}

/// Numbers that repeat, from a seed.
struct Random(u64);

impl Random {
    fn below(&mut self, limit: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % limit.max(1) as u64) as usize
    }
}

fn corrupt(bytes: &mut Vec<u8>, random: &mut Random) {
    const NUMBERS: [&str; 12] = [
        "0",
        "-1",
        "999999999999",
        "-9223372036854775808",
        "9223372036854775807",
        "nan",
        "-inf",
        "1e38",
        "1e-45",
        "",
        "1/2/3/4",
        "//",
    ];
    match random.below(5) {
        0 => {
            let at = random.below(bytes.len());
            bytes[at] ^= 1 << random.below(8);
        }
        1 => bytes.truncate(random.below(bytes.len())),
        2 => {
            // A piece of the file in another place.
            let (from, to, length) =
                (random.below(bytes.len()), random.below(bytes.len()), random.below(200));
            let piece = bytes[from..(from + length).min(bytes.len())].to_vec();
            bytes.splice(to..to, piece);
        }
        3 => {
            let at = random.below(bytes.len());
            bytes[at] = b" \n/-\\#."[random.below(7)];
        }
        _ => {
            let text = String::from_utf8_lossy(bytes).into_owned();
            let words: Vec<&str> = text.split(' ').collect();
            let which = random.below(words.len());
            let new = NUMBERS[random.below(NUMBERS.len())];
            let edited: Vec<&str> =
                words.iter().enumerate().map(|(i, w)| if i == which { new } else { *w }).collect();
            *bytes = edited.join(" ").into_bytes();
        }
    }
    if bytes.is_empty() {
        bytes.push(b'f');
    }
}

#[test]
fn a_thousand_corruptions_return() {
    let clean = rich().into_bytes();
    let mut random = Random(0x9E37_79B9_7F4A_7C15);
    let (mut loaded, mut refused) = (0, 0);
    for _ in 0..1000 {
        let mut bytes = clean.clone();
        for _ in 0..=random.below(4) {
            corrupt(&mut bytes, &mut random);
        }
        match load(Path::new("corrupt.obj"), &bytes) {
            Ok(scene) => {
                loaded += 1;
                for mesh in &scene.meshes {
                    assert!(mesh.positions.iter().chain(&mesh.normals).all(|p| p.is_finite()));
                    assert!(mesh.indices.iter().all(|i| (*i as usize) < mesh.positions.len()));
                }
            }
            Err(error) => {
                refused += 1;
                assert!(!error.to_string().contains('\n'), "{error}");
            }
        }
    }
    // Both ends must have been seen, or the corruptions are too weak or too strong to say anything.
    assert!(loaded > 100 && refused > 100, "{loaded} loaded, {refused} refused");
}

#[test]
fn corrupt_mtl_returns() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../target/umbrage-scene-tests");
    std::fs::create_dir_all(&folder).unwrap();
    let clean = "newmtl a\nKd 0.5 0.5 0.5\nKs 1 1 1\nNs 40\nd 0.5\nmap_Kd -s 1 1 1 -o 0 0 a b.png\nnewmtl b\nKa 1\nTr 0.1\n";
    let mut random = Random(77);
    for _ in 0..300 {
        let mut bytes = clean.as_bytes().to_vec();
        for _ in 0..=random.below(4) {
            corrupt(&mut bytes, &mut random);
        }
        std::fs::write(folder.join("corrupt.mtl"), &bytes).unwrap();
        let text = "mtllib corrupt.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n";
        let scene = load(&folder.join("x.obj"), text.as_bytes()).unwrap();
        assert!(scene.materials.iter().all(|m| m.base_color.is_finite()));
    }
}
