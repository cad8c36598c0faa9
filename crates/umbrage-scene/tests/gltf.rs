//! glTF files that others made. The oracles are the tables of the scenes' README, which trimesh and gltf-validator
//! filled in, and numbers read off the files by hand.

mod common;

use common::{assert_sound, extents, load_shared, shared};
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
        if let Some(printed) = row.extents
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
