//! OBJ files from elsewhere: what they hold is known from other readers, broken ones are refused in one line.

// The lint's exception for tests does not see a test file's helpers.
#![allow(clippy::unwrap_used)]

use glam::{Vec3, Vec4};
use std::path::{Path, PathBuf};
use umbrage_scene::{AlphaMode, Reflectance, Scene, load};

/// The shared scenes; they are large and lie beside the repository, not in it.
fn scenes() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/scenes");
    if folder.is_dir() {
        return Some(folder);
    }
    eprintln!("SKIPPED: {} is not there, so no file of it was loaded", folder.display());
    None
}

fn load_at(path: &Path) -> Result<Scene, String> {
    let result = load(path.to_str().expect("test paths are UTF-8")).map_err(|e| e.to_string());
    if let Err(message) = &result {
        assert!(!message.contains('\n') && message.contains(path.to_str().unwrap()), "{message}");
    }
    result
}

fn check(scene: &Scene) {
    assert!(!scene.materials.is_empty());
    for mesh in &scene.meshes {
        let n = mesh.positions.len();
        assert_eq!(mesh.normals.len(), n);
        assert!(mesh.uvs.is_empty() || mesh.uvs.len() == n);
        assert!(mesh.colors.is_empty() || mesh.colors.len() == n);
        assert!(mesh.indices.iter().all(|i| (*i as usize) < n) && mesh.indices.len() % 3 == 0);
        assert!(mesh.positions.iter().all(|p| p.is_finite() && mesh.bounds.min.cmple(*p).all()));
        assert!(mesh.normals.iter().all(|x| (x.length() - 1.0).abs() < 1e-4));
        assert!(mesh.uvs.iter().all(|uv| uv.is_finite()));
        let material = &scene.materials[mesh.material];
        for texture in material.base_color_texture.iter().chain(&material.normal_texture) {
            let image = &scene.images[texture.image];
            assert_eq!(image.rgba.len(), image.width as usize * image.height as usize * 4);
        }
    }
    assert!(scene.warnings.iter().all(|w| !w.contains('\n') && w.len() < 300), "{:?}", scene.warnings);
}

/// `(file, triangles, extents)` of each OBJ row in the tables of the README.
fn table(scenes: &Path) -> Vec<(PathBuf, u64, Vec3)> {
    let text = std::fs::read_to_string(scenes.join("README.md")).unwrap();
    let mut folder = "";
    let mut rows = Vec::new();
    for line in text.lines() {
        if let Some(name) = line.strip_prefix("## ") {
            folder = name.trim();
        }
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        if cells.len() > 7 && cells[1].trim_matches('`').ends_with(".obj") {
            let size: Vec<f32> = cells[6].split('×').map(|x| x.trim().parse().unwrap()).collect();
            rows.push((
                scenes.join(folder).join(cells[1].trim_matches('`')),
                cells[3].replace(',', "").parse().unwrap(),
                Vec3::from_slice(&size),
            ));
        }
    }
    rows
}

/// Files whose polygons repeat corners (their numbers were rounded) or cross themselves, and the number of triangles
/// without area in a fan over all of them: nobody sees those, and so a loader may leave them out.
const WITHOUT_AREA: [(&str, u64); 5] = [
    ("fence.obj", 128),
    ("pedestrianRailing1.obj", 3941),
    ("radiator3.obj", 88),
    ("tableFan.obj", 6),
    ("spiralStaircase.obj", 86),
];

#[test]
fn triangles_and_extents_are_what_the_table_says() {
    let Some(scenes) = scenes() else { return };
    let rows = table(&scenes);
    assert_eq!(rows.len(), 16, "an OBJ was added to the README or its tables are written differently");
    for (path, triangles, size) in rows {
        let started = std::time::Instant::now();
        let scene = load_at(&path).unwrap();
        check(&scene);
        eprintln!("{}: {:?}, {:?}", path.display(), started.elapsed(), scene.warnings);
        let short = triangles.checked_sub(scene.triangles()).expect("more triangles than the table has");
        let name = path.file_name().unwrap().to_string_lossy();
        let degenerate = WITHOUT_AREA.iter().find(|(file, _)| *file == name).map_or(0, |(_, n)| *n);
        assert!(short <= degenerate, "{name}: {short} triangles are missing, {degenerate} may");
        let found = scene.bounds().size();
        // The table has three digits.
        let off = (found - size).abs() / size;
        assert!(off.max_element() < 0.006, "{}: {found} instead of {size}", path.display());
        assert!(scene.meshes.len() <= scene.materials.len(), "one draw for each material");
    }
}

/// `true`: loads. `false`: refused.
const AWKWARD: [(&str, bool); 40] = [
    ("tinyobjloader/cube-vertexcol.obj", true),
    ("tinyobjloader/invalid-face-definition.obj", false),
    ("tinyobjloader/invalid-relative-texture-index.obj", false),
    ("tinyobjloader/invalid-relative-vertex-index.obj", false),
    ("tinyobjloader/issue-140-zero-face-idx.obj", false),
    ("tinyobjloader/issue-161-inconsistent-f.obj", true),
    ("tinyobjloader/issue-235-usemtl-then-o.obj", true),
    ("tinyobjloader/issue-295-trianguation-failure.obj", true),
    ("tinyobjloader/issue-319-002.obj", true),
    ("tinyobjloader/issue-319-003.obj", true),
    ("tinyobjloader/issue-95-2.obj", true),
    ("tinyobjloader/issue-95.obj", true),
    ("tinyobjloader/leading-decimal-dot-issue-201.obj", true),
    ("tinyobjloader/leading-zero-in-exponent-notation-issue-210.obj", true),
    ("tinyobjloader/line-prim.obj", false),
    ("tinyobjloader/missing_material_file.obj", true),
    ("tinyobjloader/mtllib-multiple-files-issue-112.obj", true),
    ("tinyobjloader/points-prim.obj", false),
    ("tinyobjloader/test-nan.obj", false),
    ("tinyobjloader/usemtl-issue-104.obj", true),
    ("obj2gltf/box-incomplete-attributes/box-incomplete-normals.obj", true),
    ("obj2gltf/box-incomplete-attributes/box-incomplete-positions.obj", false),
    ("obj2gltf/box-incomplete-attributes/box-incomplete-uvs.obj", true),
    ("obj2gltf/box-incorrect-winding-order/box-incorrect-winding-order.obj", true),
    ("obj2gltf/box-missing-attributes/box-missing-attributes.obj", true),
    ("obj2gltf/box-missing-mtllib/box-missing-mtllib.obj", true),
    ("obj2gltf/box-missing-texture/box-missing-texture.obj", true),
    ("obj2gltf/box-missing-usemtl/box-missing-usemtl.obj", true),
    ("obj2gltf/box-mixed-attributes/box-mixed-attributes.obj", true),
    ("obj2gltf/box-mixed-attributes-2/box-mixed-attributes-2.obj", true),
    ("obj2gltf/box-negative-indices/box-negative-indices.obj", true),
    ("obj2gltf/box-subdirectories/box-textured.obj", true),
    ("obj2gltf/box-texture-options/box-texture-options.obj", true),
    ("obj2gltf/box-transparent/box-transparent.obj", true),
    ("obj2gltf/box-uncleaned/box-uncleaned.obj", true),
    ("obj2gltf/box-unnormalized/box-unnormalized.obj", true),
    ("obj2gltf/box-windows-paths/box-windows-paths.obj", true),
    ("obj2gltf/box-with-tabs/box-with-tabs.obj", true),
    ("obj2gltf/concave/concave.obj", true),
    ("nothing/here.obj", false),
];

#[test]
fn awkward_files_load_or_are_refused_in_one_line() {
    let Some(scenes) = scenes() else { return };
    for (name, loads) in AWKWARD {
        let result = load_at(&scenes.join("invalid").join(name));
        eprintln!("{name}: {:?}", result.as_ref().map(|s| &s.warnings));
        assert_eq!(result.is_ok(), loads, "{name}: {:?}", result.err());
        if let Ok(scene) = result {
            check(&scene);
        }
    }
    let listed = |folder: &str| AWKWARD.iter().filter(|(name, _)| name.starts_with(folder)).count();
    assert_eq!((listed("tinyobjloader"), listed("obj2gltf")), (20, 19), "as many as the README counts");
}

#[test]
fn materials_of_awkward_files_are_found() {
    let Some(scenes) = scenes() else { return };
    let load = |name: &str| load_at(&scenes.join("invalid/obj2gltf").join(name)).unwrap();
    for name in ["box-windows-paths/box-windows-paths.obj", "box-subdirectories/box-textured.obj"] {
        let scene = load(name);
        assert_eq!((scene.images.len(), scene.warnings.len()), (1, 0), "{name}: {:?}", scene.warnings);
        assert_eq!(scene.materials[0].base_color_texture.unwrap().image, 0);
    }
    let options = load("box-texture-options/box-texture-options.obj");
    assert!(
        options.materials[0].base_color_texture.is_some() && options.materials[0].emissive_texture.is_some()
    );
    assert_eq!(options.materials[0].alpha, AlphaMode::Blend);
    assert_eq!(options.materials[0].base_color.w, 0.9);
    for name in ["box-missing-mtllib/box-missing-mtllib.obj", "box-missing-texture/box-missing-texture.obj"] {
        assert!(!load(name).warnings.is_empty(), "{name}");
    }
    let missing = load("box-missing-mtllib/box-missing-mtllib.obj");
    assert_eq!(missing.materials[0].base_color, Vec4::ONE);
    let multiple =
        load_at(&scenes.join("invalid/tinyobjloader/mtllib-multiple-files-issue-112.obj")).unwrap();
    assert_eq!(multiple.materials[0].name, "default");
}

#[test]
fn leaves_are_cut_out_and_boxes_have_colours() {
    let Some(scenes) = scenes() else { return };
    let bush = load_at(&scenes.join("scopia-trees/bush/bush.obj")).unwrap();
    let leaves = bush.materials.iter().find(|m| m.name == "leaves").unwrap();
    assert_eq!(leaves.alpha, AlphaMode::Mask { cutoff: 0.5 });
    let picture = &bush.images[leaves.base_color_texture.unwrap().image];
    let clear = picture.rgba.chunks_exact(4).filter(|p| p[3] < 128).count();
    let share = clear as f32 / (picture.rgba.len() / 4) as f32;
    assert!(share > 0.1 && share < 0.9, "{share} of the leaf's picture is cut away");
    assert_eq!(bush.images.len(), 2, "leaf and bark, each once");

    let cornell = load_at(&scenes.join("classic-obj/cornell_box.obj")).unwrap();
    let red = cornell.materials.iter().find(|m| m.name == "red").unwrap();
    assert_eq!(red.base_color, Vec4::new(1.0, 0.0, 0.0, 1.0));
    assert!(red.double_sided && matches!(red.reflectance, Reflectance::Blinn { .. }));

    let colors = load_at(&scenes.join("invalid/tinyobjloader/cube-vertexcol.obj")).unwrap();
    assert!(colors.meshes.iter().flat_map(|m| &m.colors).any(|c| *c == [0, 255, 0, 255]));
}

/// The area of a concave prism's lid and floor, measured by hand from the file.
#[test]
fn concave_faces_cover_their_area() {
    let Some(scenes) = scenes() else { return };
    let scene = load_at(&scenes.join("invalid/obj2gltf/concave/concave.obj")).unwrap();
    let mut area = 0.0;
    for mesh in &scene.meshes {
        for t in mesh.indices.chunks_exact(3) {
            let [a, b, c] = [t[0], t[1], t[2]].map(|i| mesh.positions[i as usize]);
            let normal = (b - a).cross(c - a);
            if normal.normalize().y > 0.99 {
                area += 0.5 * normal.length();
            }
        }
    }
    // A square of 2 x 2 without the triangle whose tip is 0.87836 inside.
    assert!((area - (4.0 - 0.87836)).abs() < 1e-4, "{area}");
}
