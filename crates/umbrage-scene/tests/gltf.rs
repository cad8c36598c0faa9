//! glTF files that others made. The oracles are the tables of the scenes' README, which trimesh and gltf-validator
//! filled in, and numbers read off the files by hand.

#![allow(clippy::unwrap_used)]

mod common;

use common::{assert_sound, extents, load_shared, shared};
use glam::{Vec2, Vec3};
use umbrage_core::{LightKind, Projection};
use umbrage_scene::{AlphaMode, Reflectance, Scene, Wrap};

/// A line of the README's tables.
struct Row {
    file: String,
    drawn: u64,
    extents: Option<[f64; 3]>,
}

/// Every glTF and GLB that the README lists.
fn readme_rows(text: &str) -> Vec<Row> {
    let mut folder = "";
    let mut rows = Vec::new();
    for line in text.lines() {
        if let Some(heading) = line.strip_prefix("## ") {
            folder = heading.trim();
        }
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let Some(name) = cells.get(1).and_then(|c| c.strip_prefix('`')).and_then(|c| c.strip_suffix('`'))
        else {
            continue;
        };
        // Two shapes of table: with and without stored triangles, nodes and textures.
        let (drawn, size) = match cells.len() {
            8 => (cells[3], cells[6]),
            5 => (cells[2], cells[3]),
            _ => continue,
        };
        if name.ends_with(".gltf") || name.ends_with(".glb") {
            rows.push(Row {
                file: format!("{folder}/{name}"),
                drawn: drawn.replace(',', "").parse().unwrap(),
                extents: numbers(size),
            });
        }
    }
    rows
}

fn numbers(text: &str) -> Option<[f64; 3]> {
    let parts: Vec<f64> =
        text.trim_end_matches(" m").split(['×', 'x']).filter_map(|part| part.trim().parse().ok()).collect();
    parts.try_into().ok()
}

/// Where the table holds what trimesh drew, which knows no skins, sparse accessors and instances, and draws lines. Worked
/// out anew from the files' bytes by a script that shares nothing with the loader.
const OTHER_EXTENTS: &[(&str, [f64; 3])] = &[
    ("mannequiny/mannequiny.glb", [1.64078, 1.79786, 0.31622]),
    ("recursive-skeletons/RecursiveSkeletons.glb", [60.0, 125.1, 60.0]),
    ("loader-features/MeshPrimitiveModes/MeshPrimitiveModes.gltf", [5.732, 2.0, 0.0]),
    ("loader-features/SimpleInstancing/SimpleInstancing.glb", [14.39837, 14.39837, 14.39837]),
    ("loader-features/SimpleSparseAccessor/SimpleSparseAccessor.gltf", [6.0, 4.0, 0.0]),
];

/// Does a value agree with one that was printed with three significant digits?
fn agrees(value: f64, printed: f64) -> bool {
    let unit = 10_f64.powf(printed.abs().max(1e-9).log10().floor() - 2.0);
    (value - printed).abs() <= 0.51 * unit + 1e-6
}

/// Triangles that the last gate took out, as its warning says.
fn dropped(scene: &Scene) -> u64 {
    let warning = scene.warnings.iter().find(|w| w.contains("without area"));
    warning.map_or(0, |w| w.split(' ').next().unwrap().parse().unwrap())
}

#[test]
fn the_readmes_tables_hold() {
    let Some(readme) = shared("README.md") else { return };
    let rows = readme_rows(&std::fs::read_to_string(readme).unwrap());
    assert!(rows.len() >= 45, "only {} rows were found: has the README's form changed?", rows.len());
    let mut wrong = Vec::new();
    for row in rows {
        let path = shared(&row.file).unwrap();
        let start = std::time::Instant::now();
        let scene = match umbrage_scene::load(&path.to_string_lossy()) {
            Ok(scene) => scene,
            Err(e) => {
                wrong.push(format!("{e}"));
                continue;
            }
        };
        println!("{:>7.1} ms {}", start.elapsed().as_secs_f64() * 1e3, row.file);
        scene.warnings.iter().for_each(|warning| println!("           {warning}"));
        assert_sound(&scene);
        let drawn = scene.triangles();
        if drawn > row.drawn || drawn + dropped(&scene) < row.drawn {
            wrong.push(format!("{}: {drawn} triangles, {} in the table", row.file, row.drawn));
        }
        let size = extents(&scene);
        let other = OTHER_EXTENTS.iter().find(|(file, _)| *file == row.file).map(|(_, size)| *size);
        if let Some(printed) = other.or(row.extents)
            && !std::iter::zip(size, printed).all(|(value, printed)| agrees(value, printed))
        {
            wrong.push(format!("{}: extents {size:?}, {printed:?} in the table", row.file));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Negative control of the comparison above.
#[test]
fn the_table_test_can_fail() {
    assert!(agrees(0.36712, 0.367) && agrees(2048.0, 2050.0) && agrees(0.0, 0.0));
    assert!(!agrees(0.3676, 0.367) && !agrees(2060.0, 2050.0) && !agrees(0.01, 0.0));
    let rows =
        readme_rows("## a b\n| `c.glb` | 1 | 1,234 | 1 | none | 1 × 2.5 × 2.05e+03 |\n| `c.obj` | 1 | 1 |");
    assert_eq!(rows.len(), 1);
    assert_eq!((rows[0].file.as_str(), rows[0].drawn), ("a b/c.glb", 1234));
    assert_eq!(rows[0].extents, Some([1.0, 2.5, 2050.0]));
    assert_eq!(numbers("20 x 4.8 x 20 m"), Some([20.0, 4.8, 20.0]));
}

#[test]
fn five_lights_of_a_lamp_keep_place_and_strength() {
    let Some(scene) = load_shared("lights-punctual-lamp/LightsPunctualLamp.gltf") else { return };
    let strengths: Vec<f32> = scene.lights.iter().map(|l| l.light.intensity).collect();
    assert_eq!(strengths, [15.0, 1.5, 80.0, 80.0, 180.0]);
    let first = &scene.lights[0];
    assert_eq!((first.name.as_str(), first.light.kind), ("Point", LightKind::Point));
    assert!(
        (first.light.position_world - Vec3::new(0.046_223_55, 0.907_797_34, 0.006_696_629)).length() < 1e-6
    );
    assert!(
        (first.light.direction_world - Vec3::NEG_Y).length() < 1e-6,
        "-Z of a node turned by -90 degrees about X"
    );
    assert_eq!(first.light.range_m, None);
}

#[test]
fn cameras_keep_their_lenses() {
    let Some(scene) = load_shared("loader-features/Cameras/Cameras.gltf") else { return };
    let [eye, flat] = [0, 1].map(|i| scene.cameras[i].camera);
    assert_eq!(eye.projection, Projection::Perspective { fov_y_rad: 0.7 });
    assert_eq!(flat.projection, Projection::Orthographic { half_height_m: 1.0 });
    assert_eq!((eye.near_m, eye.far_m, eye.position_world), (0.01, 100.0, Vec3::new(0.5, 0.5, 3.0)));
    let car = load_shared("toy-car/ToyCar.gltf").unwrap();
    assert_eq!(car.cameras.len(), 8);
    assert_eq!(car.cameras[1].camera.projection, Projection::Perspective { fov_y_rad: 0.41 });
}

#[test]
fn texture_transforms_have_the_files_numbers() {
    let Some(scene) = load_shared("loader-features/TextureTransformTest/TextureTransformTest.gltf") else {
        return;
    };
    let of = |name: &str| {
        let material = scene.materials.iter().find(|m| m.name == name).unwrap();
        material.base_color_texture.unwrap()
    };
    let at = |name: &str, u: f32, v: f32| of(name).uv_from_texcoord.transform_point2(Vec2::new(u, v));
    assert_eq!(at("Offset UV", 0.25, 0.25), Vec2::splat(0.75));
    assert_eq!(at("Scale", 1.0, 0.5), Vec2::new(1.5, 0.75));
    let (sin, cos) = std::f32::consts::FRAC_PI_8.sin_cos();
    assert!((at("Rotation", 1.0, 0.0) - Vec2::new(cos, -sin)).length() < 1e-6);
    let (sin, cos) = 0.3_f32.sin_cos();
    assert!((at("All", 0.0, 1.0) - Vec2::new(1.5 * sin - 0.2, 1.5 * cos - 0.1)).length() < 1e-6);
    assert_eq!(of("All").wrap, [Wrap::Clamp; 2]);
}

#[test]
fn alpha_cutoffs_and_modes() {
    let Some(scene) = load_shared("alpha-blend-mode-test/AlphaBlendModeTest.glb") else { return };
    let alpha = |name: &str| scene.materials.iter().find(|m| m.name == name).unwrap().alpha;
    assert_eq!(alpha("MatCutoff25"), AlphaMode::Mask { cutoff: 0.25 });
    assert_eq!(alpha("MatCutoff75"), AlphaMode::Mask { cutoff: 0.75 });
    assert_eq!(alpha("MatCutoffDefault"), AlphaMode::Mask { cutoff: 0.5 });
    assert_eq!((alpha("MatBlend"), alpha("MatOpaque")), (AlphaMode::Blend, AlphaMode::Opaque));
}

#[test]
fn colours_mirrors_instances_and_sharing() {
    let Some(colored) = load_shared("loader-features/BoxVertexColors/BoxVertexColors.glb") else { return };
    let mesh = &colored.meshes[0];
    // The file's colour of each corner is its place in the unit cube.
    for (position, color) in mesh.positions.iter().zip(&mesh.colors) {
        let place = position.to_array().map(|v| (v * 255.0).round() as u8);
        assert_eq!(place, color[..3], "{position}");
        assert_eq!(color[3], 255);
    }
    let mirrored = load_shared("negative-scale-test/NegativeScaleTest.glb").unwrap();
    let turned = mirrored.instances.iter().filter(|i| i.world_from_object.determinant() < 0.0).count();
    assert!(turned > 0 && turned < mirrored.instances.len(), "{turned} of {}", mirrored.instances.len());
    let boxes = load_shared("loader-features/SimpleInstancing/SimpleInstancing.glb").unwrap();
    assert_eq!((boxes.instances.len(), boxes.meshes.len()), (125, 1));
    let village = load_shared("kaykit-medieval-hexagon/village.gltf").unwrap();
    assert_eq!((village.instances.len(), village.meshes.len(), village.images.len()), (4234, 38, 1));
    assert!(matches!(village.materials[0].reflectance, Reflectance::MetallicRoughness { .. }));
}

#[test]
fn normal_maps_get_tangents_and_given_ones_stay() {
    let Some(lamp) = load_shared("stained-glass-lamp/StainedGlassLamp.gltf") else { return };
    for mesh in &lamp.meshes {
        let mapped = lamp.materials[mesh.material].normal_texture.is_some();
        assert!(!mapped || mesh.tangents.len() == mesh.positions.len(), "{}", mesh.name);
    }
    let spaces = load_shared("loader-features/Box With Spaces/Box With Spaces.gltf").unwrap();
    assert!(!spaces.images.is_empty() && spaces.warnings.is_empty(), "{:?}", spaces.warnings);
    let webp = load_shared("required-extensions/truck-town-webp/town_model.gltf").unwrap();
    assert!(
        !webp.images.is_empty() && !webp.warnings.iter().any(|w| w.contains("texture")),
        "{:?}",
        webp.warnings
    );
    let unicode = load_shared("loader-features/Unicode❤♻Test/Unicode❤♻Test.glb").unwrap();
    assert_eq!((unicode.name.as_str(), unicode.images.len()), ("Unicode❤♻Test", 1));
}

/// Draco's quantization moves a vertex by up to a part in 2^11 of the mesh; the accessors' own bounds say where they lay.
#[test]
fn draco_meshes_fill_the_bounds_that_their_file_announces() {
    let Some(scene) = load_shared("required-extensions/carbon-sphere-draco/carbon-sphere.glb") else {
        return;
    };
    let announced = [(49.083, 49.641, 49.028), (47.093, 48.093, 52.116), (44.66, 49.641, 49.937)];
    assert_eq!(scene.meshes.len(), announced.len());
    for (mesh, (x, y, z)) in scene.meshes.iter().zip(announced) {
        let off = (mesh.bounds.max - Vec3::new(x, y, z)).abs().max_element();
        assert!(off < 0.05, "{}: {}", mesh.name, mesh.bounds.max);
        // Decoded normals belong to decoded positions: most of them point as their triangles do.
        let along = mesh.indices.chunks_exact(3).filter(|t| {
            let [a, b, c]: [Vec3; 3] = std::array::from_fn(|i| mesh.positions[t[i] as usize]);
            (b - a).cross(c - a).dot(mesh.normals[t[0] as usize]) > 0.0
        });
        assert!(along.count() * 3 > mesh.indices.len() * 9 / 10, "{}", mesh.name);
    }
}
