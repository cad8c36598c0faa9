//! OBJ files with split edges: all records survive, and the plainest extrusion pulls right shadow volumes out of them.

// The lint's exception for tests does not see a test file's helpers.
#![allow(clippy::unwrap_used)]

mod common;

use common::volume::{End, Random, Soup, far, hidden, open_edges, points_around, winding};
use glam::{DVec3, Vec3, Vec4};
use proptest::prelude::*;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use umbrage_core::edges::{Adjacency, EdgeCounts};
use umbrage_scene::{SceneError, SplitObj, load, split_obj};

const REAL: [&str; 8] = [
    "classic-obj/teapot.obj",
    "classic-obj/cornell_box.obj",
    "classic-obj/spot/spot_triangulated.obj",
    "classic-obj/spot/spot_quadrangulated.obj",
    "thin-casters/fence/fence.obj",
    "thin-casters/umbrella/umbrella.obj",
    "scopia-trees/hedge/hedge.obj",
    "scopia-trees/bush/bush.obj",
];

/// A folder that goes when the test ends.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("umbrage-split-{}-{name}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn file(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.0.join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// What a strict reader finds: one that goes through the file once and knows nothing of what comes later.
#[derive(Default)]
struct Read {
    positions: Vec<Vec3>,
    uvs: Vec<String>,
    normals: Vec<Vec3>,
    /// For each face its corners' position, texture coordinate and normal, and is it a ghost?
    faces: Vec<(Vec<[Option<usize>; 3]>, bool)>,
    /// What other records mean: the keyword, and the positions that they name.
    others: Vec<(String, Vec<Vec3>)>,
}

fn read(bytes: &[u8]) -> Read {
    let text = String::from_utf8_lossy(bytes).replace("\\\r\n", " ").replace("\\\n", " ");
    let mut found = Read::default();
    let mut ghost = false;
    for line in text.lines() {
        let words: Vec<&str> = line.split('#').next().unwrap().split_whitespace().collect();
        let Some((&key, rest)) = words.split_first() else { continue };
        let vector = || Vec3::from_slice(&rest[..3].iter().map(|w| w.parse().unwrap()).collect::<Vec<f32>>());
        let counts = [found.positions.len(), found.uvs.len(), found.normals.len()];
        let corner = |word: &&str| {
            let mut corner = [None; 3];
            for (kind, part) in word.split('/').enumerate().filter(|(_, part)| !part.is_empty()) {
                let n: i64 = part.parse().unwrap();
                let index = if n < 0 { counts[kind] as i64 + n } else { n - 1 };
                assert!((0..counts[kind] as i64).contains(&index), "{line}: {part} is not there yet");
                corner[kind] = Some(index as usize);
            }
            corner
        };
        match key {
            "v" => found.positions.push(vector()),
            "vn" => found.normals.push(vector()),
            "vt" => found.uvs.push(rest.concat()),
            "g" => ghost = rest == ["umbrage_ghosts"],
            "f" => {
                let corners = rest.iter().map(corner).collect();
                found.faces.push((corners, ghost));
            }
            "l" | "p" | "curv" | "surf" => {
                let skip = HashMap::from([("curv", 2), ("surf", 4)]);
                let named = rest[skip.get(key).copied().unwrap_or(0)..].iter().map(corner);
                found.others.push((key.into(), named.map(|c| found.positions[c[0].unwrap()]).collect()));
            }
            _ => {}
        }
    }
    found
}

/// Moves every vertex whose normal faces away from the light, as the plainest shader would.
fn extrude(read: &Read, light: Vec4) -> (Soup, Vec<Vec3>) {
    let mut places: Vec<Vec3> = Vec::new();
    let mut place_of: HashMap<[u32; 3], u32> = HashMap::new();
    let mut soup = Soup::new();
    for (corners, _) in &read.faces {
        // Faces without area stay as they were.
        let Some(ends) = corners
            .iter()
            .map(|corner| {
                let p = read.positions[corner[0]?] + 0.0;
                let normal = read.normals[corner[2]?];
                let place = *place_of.entry(p.to_array().map(f32::to_bits)).or_insert_with(|| {
                    places.push(p);
                    places.len() as u32 - 1
                });
                Some((place, normal.dot(light.truncate() - p * light.w) <= 0.0))
            })
            .collect::<Option<Vec<End>>>()
        else {
            continue;
        };
        soup.extend((2..ends.len()).map(|i| [ends[0], ends[i - 1], ends[i]]));
    }
    (soup, places)
}

fn triangles(path: &Path) -> Vec<[DVec3; 3]> {
    let scene = load(path.to_str().unwrap()).unwrap();
    let corners = |mesh: &umbrage_scene::Mesh| {
        let at = |i: u32| mesh.positions[i as usize].as_dvec3();
        mesh.indices.chunks_exact(3).map(|t| [at(t[0]), at(t[1]), at(t[2])]).collect::<Vec<_>>()
    };
    scene.meshes.iter().flat_map(corners).collect()
}

/// Extrudes the split file, and compares with rays at random points. Gives how many were in shadow, and how many wrong.
fn judge(split: &SplitObj, truth: &[[DVec3; 3]], light: Vec4, closed: bool) -> (usize, usize) {
    let read = read(&split.bytes);
    let (soup, places) = extrude(&read, light);
    let open = open_edges(&soup).len();
    assert_eq!(open == 0, closed, "{open} edges are open with light {light}");
    let at = |(i, moved): End| {
        let p = places[i as usize].as_dvec3();
        if moved { far(p, light) } else { p }
    };
    let soup: Vec<[DVec3; 3]> = soup.iter().map(|t| t.map(at)).collect();
    let mut random = Random(7);
    let (mut dark, mut wrong) = (0, 0);
    for p in points_around(&places, 60, &mut random) {
        let hidden = hidden(truth, p, light);
        dark += usize::from(hidden);
        wrong += usize::from(hidden != (winding(&soup, p, random.point()) > 0));
    }
    (dark, wrong)
}

fn lights(truth: &[[DVec3; 3]]) -> [Vec4; 3] {
    let all = truth.as_flattened();
    let (low, high) =
        all.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), p| (l.min(*p), h.max(*p)));
    let at = (low + high) / 2.0 + DVec3::new(0.31, 1.4, 0.57) * (high - low).max_element();
    [at.as_vec3().extend(1.0), Vec4::new(0.31, 1.0, 0.17, 0.0), Vec4::new(-0.71, -0.4, 0.37, 0.0)]
}

#[test]
fn real_files_cast_right_shadows() {
    for name in REAL {
        let Some(path) = common::shared(name) else { return };
        let started = std::time::Instant::now();
        let split = split_obj(&path, true).unwrap();
        eprintln!("{name}: {:?}, {:?}", started.elapsed(), split.counts);
        let truth = triangles(&path);
        // Where a surface is closed, back faces are not added.
        assert_eq!(split.counts.back_faces == 0, split.counts.open == 0);
        for light in lights(&truth) {
            let (dark, wrong) = judge(&split, &truth, light, true);
            // Polygons that are not flat have one normal for all; their triangles may look elsewhere.
            assert!(wrong == 0 || (name.contains("quad") && wrong < 2), "{name}: {wrong} points are wrong");
            assert!(dark > 0 && dark < 60, "{name}: {dark} of 60 points are dark, light {light}");
        }
    }
}

/// Negative control: without back faces an open surface is not closed, and has no far lid.
#[test]
fn open_files_say_so() {
    let folder = Folder::new("open");
    let path = folder.file("leaf.obj", b"v 0 0 0\nv 0 0 1\nv 1 0 0.4\nf 1 2 3\n");
    let truth = triangles(&path);
    let bare = split_obj(&path, false).unwrap();
    assert_eq!((bare.counts.open, bare.counts.ghosts, bare.counts.added_vertices), (3, 3, 9));
    assert!(bare.warnings.len() == 1 && bare.warnings[0].contains("--back-faces"), "{:?}", bare.warnings);
    let whole = split_obj(&path, true).unwrap();
    assert_eq!((whole.counts.back_faces, whole.counts.ghosts, whole.counts.added_vertices), (1, 3, 6));
    assert!(whole.warnings.is_empty(), "{:?}", whole.warnings);
    for light in [Vec4::new(0.2, 1.0, 0.0, 0.0), Vec4::new(0.3, -2.0, 0.4, 1.0)] {
        judge(&bare, &truth, light, false);
        assert_eq!(judge(&whole, &truth, light, true).1, 0);
    }
}

fn other_lines(bytes: &[u8]) -> Vec<&[u8]> {
    let kept = |line: &&[u8]| {
        let first = line.split(u8::is_ascii_whitespace).find(|word| !word.is_empty());
        !matches!(first, Some(b"v" | b"vn" | b"f"))
    };
    bytes.split_inclusive(|b| *b == b'\n').filter(kept).collect()
}

fn counts(path: &Path) -> Vec<EdgeCounts> {
    load(path.to_str().unwrap())
        .unwrap()
        .meshes
        .iter()
        .map(|mesh| Adjacency::new(&mesh.positions, &mesh.indices).counts)
        .collect()
}

#[test]
fn other_records_survive_and_at_rest_nothing_has_changed() {
    let folder = Folder::new("survive");
    for name in REAL {
        let Some(path) = common::shared(name) else { return };
        let before = std::fs::read(&path).unwrap();
        let split = split_obj(&path, false).unwrap();
        let mut after = other_lines(&split.bytes);
        assert_eq!(
            after.pop(),
            Some(if before.contains(&b'\r') { &b"g umbrage_ghosts\r\n"[..] } else { b"g umbrage_ghosts\n" })
        );
        let unnamed = !before.split(|b| *b == b'\n').any(|line| matches!(line, [b'g' | b'o', b' ', ..]));
        if unnamed {
            let group = after.iter().position(|line| line.starts_with(b"g default"));
            after.remove(group.expect("the group of those in none"));
        }
        assert!(other_lines(&before) == after, "{name}: a line is lost, changed or moved");
        assert_eq!(split.counts.renumbered, 0, "{name}: nothing but faces counts backwards there");

        let (old, new) = (read(&before), read(&split.bytes));
        assert!(new.positions.starts_with(&old.positions) && new.normals.starts_with(&old.normals));
        assert!(new.uvs == old.uvs && new.others == old.others);
        let faces: Vec<_> = new.faces.iter().filter(|(_, ghost)| !ghost).collect();
        assert_eq!(faces.len(), old.faces.len());
        for ((was, _), (is, _)) in old.faces.iter().zip(faces) {
            let place = |from: &Read, c: &[Option<usize>; 3]| (from.positions[c[0].unwrap()], c[1]);
            assert!(was.iter().map(|c| place(&old, c)).eq(is.iter().map(|c| place(&new, c))), "{name}");
        }
        for (corners, _) in new.faces.iter().filter(|(_, ghost)| *ghost) {
            let p: Vec<Vec3> = corners.iter().map(|c| new.positions[c[0].unwrap()]).collect();
            assert_eq!((p.len(), p[0], p[2]), (4, p[1], p[3]), "{name}: a ghost has an area");
        }
        // Meshes are made by material, so its library has to be there.
        for entry in std::fs::read_dir(path.parent().unwrap()).unwrap().flatten() {
            if entry.path().extension().is_some_and(|ending| ending == "mtl") {
                folder.file(entry.file_name().to_str().unwrap(), &std::fs::read(entry.path()).unwrap());
            }
        }
        let written = folder.file("split.obj", &split.bytes);
        assert_eq!(counts(&written), counts(&path), "{name}");
    }
}

/// Everything that is awkward at once.
const AWKWARD: &[u8] = b"\xef\xbb\xbf# caf\xe9 \\\r\n\
    mtllib none.mtl\r\n\
    o first\r\n\
    v 0 0 0 1 0 0\r\n\
    v 1 0 0 \\\r\n  0 1 0\r\n\
    v 0 1 0 0 0 1\r\n\
    vt 0 0\r\nvt 1 0\r\nvt 0 1\r\n\
    vn 0 0 1\r\n\
    l -1 -2\r\n\
    usemtl red\r\n\
    \tf -3/-3/-1 -2/-2 \\\r\n -1/3 # caf\xe9\r\n\
    # vertices follow\r\n\
    o second\r\n\
    v 0 0 2\r\n\
    vn 1 0 0\r\n\
    l -1 1 -4\r\n\
    p -2\r\n\
    vt 0.5 0.5\r\n\
    cstype bspline\r\ndeg 1\r\n\
    curv -1 -2 -1 1 -3\r\n\
    parm u -1 -2\r\nend\r\n\
    surf 0 1 -1 1 -4/-4/-1 1/1/1\r\n\
    s 3\r\n\
    f 1 -1 2\r\n\
    f 2 4 3\r\n\
    f 1 3 4\r\n\
    f 1/-1 1/-1 2/-1\r\n\
    f -1 -1 -2\r\n\
    g last \\";

#[test]
fn awkward_records_keep_their_meaning() {
    let folder = Folder::new("awkward");
    let path = folder.file("awkward.obj", AWKWARD);
    let split = split_obj(&path, false).unwrap();
    let counts = split.counts;
    assert_eq!((counts.vertices, counts.faces, counts.degenerate, counts.renumbered), (4, 4, 2, 5));
    assert_eq!((counts.edges, counts.open, counts.ghosts, counts.added_vertices), (6, 0, 6, 12));

    let text = String::from_utf8_lossy(&split.bytes);
    assert!(!text.replace("\r\n", "").contains(['\r', '\n']), "every line ends as the file's do: {text}");
    assert!(split.bytes.starts_with(b"\xef\xbb\xbf# caf\xe9 \\\r\n"));
    assert!(text.contains("\r\nl -1 -2\r\n") && text.contains("\r\nl 4 1 1\r\n"), "{text}");
    assert!(text.contains("\r\ncurv -1 -2 4 1 2\r\n") && text.contains("\r\nparm u -1 -2\r\n"), "{text}");
    assert!(text.contains("\r\nsurf 0 1 -1 1 1/-4/2 1/1/1\r\n"), "{text}");
    assert!(split.bytes.windows(8).any(|w| w == b" # caf\xe9\r"), "the comment behind the face");
    assert!(text.contains("v 1 0 0 0 1 0\r\n"), "colours are copied: {text}");
    assert!(text.contains("g last \\\r\n\r\ng umbrage_ghosts\r\n"), "{text}");

    let (old, new) = (read(AWKWARD), read(&split.bytes));
    assert!(new.positions.starts_with(&old.positions) && new.normals.starts_with(&old.normals));
    assert_eq!((new.others, &new.uvs), (old.others, &old.uvs));
    assert_eq!(new.faces[0].0.iter().map(|c| c[1]).collect::<Vec<_>>(), [Some(0), Some(1), Some(2)]);

    let written = folder.file("split.obj", &split.bytes);
    let truth = triangles(&path);
    assert_eq!(triangles(&written).len(), truth.len());
    for light in lights(&truth) {
        assert_eq!(judge(&split, &truth, light, true).1, 0);
    }
    let again = split_obj(&written, false).unwrap_err();
    assert!(matches!(again, SceneError::Unsupported { .. }), "{again}");
}

#[test]
fn what_cannot_be_split_is_refused_in_one_line() {
    let folder = Folder::new("refused");
    for (name, text, word) in [
        ("a.obj", "v 0 0 0\np 1\n", "no faces"),
        ("b.obj", "v 0 0 0\nv 0 0 0\nv 1 0 0\nf 1 2 3\n", "three different corners"),
        ("c.obj", "v 0 0 0\nf 1 2 3\n", "line 2"),
        ("d.obj", "f 1 2 3", "line 1"),
        ("e.glb", "glTF", "only .obj"),
        ("f.obj", "", "no faces"),
        ("g.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\ng umbrage_ghosts\n", "already"),
    ] {
        let message = split_obj(&folder.file(name, text.as_bytes()), true).unwrap_err().to_string();
        assert!(message.contains(word) && message.contains(name) && !message.contains('\n'), "{message}");
    }
    assert!(split_obj(&folder.0, false).unwrap_err().to_string().contains("folder"));
    assert!(split_obj(&folder.0.join("none.obj"), false).unwrap_err().to_string().contains("no such file"));
}

/// Every damaged file of the shared scenes: split or refused, as the loader does.
#[test]
fn what_loads_can_be_split() {
    let Some(folder) = common::shared("invalid") else { return };
    let mut files = Vec::new();
    for kind in ["tinyobjloader", "obj2gltf"] {
        let mut folders = vec![folder.join(kind)];
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(&folder).unwrap().flatten() {
                let path = entry.path();
                if path.is_dir() {
                    folders.push(path);
                } else if path.extension().is_some_and(|e| e == "obj") {
                    files.push(path);
                }
            }
        }
    }
    assert!(files.len() >= 39, "{} files", files.len());
    let out = Folder::new("invalid");
    for path in files {
        let loads = load(path.to_str().unwrap()).is_ok();
        let split = split_obj(&path, true);
        assert_eq!(split.is_ok(), loads, "{}: {:?}", path.display(), split.err().map(|e| e.to_string()));
        if let Ok(split) = split {
            let written = out.file("split.obj", &split.bytes);
            assert!(load(written.to_str().unwrap()).is_ok(), "{}", path.display());
        }
    }
}

#[test]
fn hostile_files_end_in_time() {
    let folder = Folder::new("hostile");
    let round: String =
        (0..20_000).map(|i| format!("v {} {} 0\n", (i as f32).cos(), (i as f32).sin())).collect();
    let corners: String = (1..=20_000).map(|i| format!(" {i}")).collect();
    let zeros = "0".repeat(100_000);
    for (name, text) in [
        ("polygon.obj", format!("{round}f{corners}\n")),
        ("many.obj", format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{}", "f 1 2 3\n".repeat(100_000))),
        ("long.obj", format!("v 0.{zeros} 0 0\nv 1 0 0\nv 0 1 0\n{}", "f 1 2 3\n".repeat(1000))),
        ("again.obj", format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nf{}\n", " 1 2 3".repeat(50_000))),
    ] {
        let path = folder.file(name, text.as_bytes());
        let started = std::time::Instant::now();
        let split = split_obj(&path, true).unwrap();
        eprintln!("{name}: {:?}, {} bytes to {}", started.elapsed(), text.len(), split.bytes.len());
        assert!(split.bytes.len() < 100 * text.len().max(10_000), "{name}: {} bytes", split.bytes.len());
    }
}

/// What files are made of, whole and broken.
const PIECES: [&str; 24] = [
    "v 0 0 0",
    "v 1 0 0.5",
    "v -0 1 0",
    "v 1 1 1 0.5",
    "v 2 1 0 1 0 0.5",
    "v 0 0 0 \\",
    "vt 0 1",
    "vn 0 0 1",
    "vn x",
    "f 1 2 3",
    "f -1 -2 -3",
    "f 1/1 2/1/1 -1//1",
    "f 1 2 3 -1 -2 # a#b",
    "fo 3 2 1",
    "f 1 1 2",
    "f",
    "f 1 2 \\",
    "l -1 1",
    "g a \\",
    "curv 0 1 -1 \\",
    "#\\",
    "",
    "\\",
    "\u{fffd} s 1",
];

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_mixture_of_records_is_split_or_refused(
        pieces in prop::collection::vec(0..PIECES.len(), 1..30), end in 0..3usize, last: bool, back_faces: bool,
    ) {
        let end = ["\n", "\r\n", "\r"][end];
        // Mostly something to refer to.
        let start = ["v 0 0 0", "v 0 1 0", "v 0 0 1"].into_iter();
        let lines: Vec<&str> = start.chain(pieces.iter().map(|i| PIECES[*i])).collect();
        let text = lines.join(end) + if last { end } else { "" };
        let folder = Folder::new("mixture");
        let path = folder.file("mixture.obj", text.as_bytes());
        let loads = |path: &Path| load(path.to_str().unwrap()).map(|scene| scene.triangles());
        match split_obj(&path, back_faces) {
            Err(error) => {
                prop_assert!(loads(&path).is_err(), "{}", error);
                prop_assert!(!error.to_string().contains('\n'));
            }
            Ok(split) => {
                let back = split.counts.back_faces > 0;
                let written = folder.file("split.obj", &split.bytes);
                match (loads(&path), loads(&written)) {
                    (Ok(before), Ok(after)) => prop_assert!(after == before || back && after > before),
                    (before, after) => prop_assert_eq!(before.is_ok(), after.is_ok()),
                }
            }
        }
    }
}
