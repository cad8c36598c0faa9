//! Row F7 as a user meets it: `umbrage render --view volumes` tells what volumes cost, and where a stencil wraps.

use serde_json::Value;
use std::path::PathBuf;
use std::process::{Command, Output};
use std::sync::atomic::{AtomicU32, Ordering};

/// A folder that goes when the test ends.
struct Folder(PathBuf);

impl Folder {
    fn new() -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("umbrage-cli-volumes-{}-{number}", std::process::id()));
        std::fs::create_dir_all(&path).expect("a temporary folder");
        Self(path)
    }

    fn run(&self, args: &[&str]) -> Output {
        let mut command = Command::new(env!("CARGO_BIN_EXE_umbrage"));
        command.current_dir(&self.0).args(args).env_remove("UMBRAGE_WITHOUT").env_remove("UMBRAGE_ADAPTER");
        command.output().expect("the command starts")
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Closed boxes within each other, as one mesh.
fn nested_boxes(count: u32) -> String {
    let mut obj = String::new();
    for i in 0..count {
        let half = 1.0 + 0.2 * f64::from(i) / f64::from(count);
        for corner in 0..8 {
            let at = |bit: u32| if corner >> bit & 1 == 1 { half } else { -half };
            obj += &format!("v {} {} {}\n", at(0), at(1), at(2));
        }
        for side in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
            let corners = side.map(|corner| (1 + 8 * i + corner).to_string());
            obj += &format!("f {}\n", corners.join(" "));
        }
    }
    obj
}

#[test]
fn faces_of_volumes_are_told_and_a_stencil_that_wraps_is_warned_of() {
    let folder = Folder::new();
    let scene = ["--ground", "--light", "kind=directional,direction=0.9:-1:-0.5"];
    let told = |count: u32| {
        let name = format!("{count}.obj");
        std::fs::write(folder.0.join(&name), nested_boxes(count)).expect("a file");
        let args = ["render", &name, "-t", "volume", "--view", "volumes", "--size", "64x36", "--json"];
        let output = folder.run(&[&args[..], &scene].concat());
        let stderr = text(&output.stderr);
        if !output.status.success() && stderr.contains("no graphics adapter") {
            let required = std::env::var("UMBRAGE_GOLDEN_REQUIRED").is_ok_and(|v| v == "1");
            assert!(!required, "{stderr}");
            eprintln!("SKIPPED: {stderr}");
            return None;
        }
        assert!(output.status.success(), "{stderr}");
        let json: Value = serde_json::from_slice(&output.stdout).expect("one object");
        Some((json["overdraw"].clone(), json["warnings"].clone(), stderr))
    };
    let number = |json: &Value| json.as_f64().expect("a number");
    let Some((few, warnings, _)) = told(3) else { return };
    assert_eq!(
        (&few["deepest_count"], &few["most"], &few["wrongly_lit_pixels"]),
        (&3.into(), &6.into(), &0.into())
    );
    assert_eq!((&few["pixels"], warnings), (&(64 * 36).into(), serde_json::json!([])));
    assert!((number(&few["mean"]) * 64.0 * 36.0 - number(&few["fragments"])).abs() < 1e-6, "{few}");
    for part in ["lit", "shadow"] {
        let (pixels, mean, most) =
            (&few[part]["pixels"], number(&few[part]["mean"]), number(&few[part]["most"]));
        assert!(pixels.as_u64() > Some(20) && mean > 0.0 && mean <= most, "{few}");
    }
    let cells = few["histogram"].as_array().expect("cells");
    let shares: f64 = cells.iter().map(|cell| number(&cell["share"])).sum();
    assert!((shares - 1.0).abs() < 1e-9 && cells[9]["to"].is_null(), "{few}");
    let Some((_, warnings, _)) = told(255) else { return };
    assert_eq!(warnings, serde_json::json!([]));
    let Some((many, warnings, stderr)) = told(256) else { return };
    assert!(many["wrongly_lit_pixels"].as_u64() > Some(20) && many["deepest_count"] == 256, "{many}");
    let warning = format!("light 0: {} pixels are lit and should be dark", many["wrongly_lit_pixels"]);
    assert!(warnings[0].as_str().is_some_and(|w| w.starts_with(&warning)), "{warnings}");
    assert!(stderr.contains(&warning), "{stderr}");
}

#[test]
fn people_are_told_in_a_sentence_and_maps_have_no_volumes() {
    let folder = Folder::new();
    let small = ["render", "--size", "64x36", "--view", "volumes"];
    let output = folder.run(&[&small[..], &["-t", "volume"]].concat());
    if output.status.success() {
        let stdout = text(&output.stdout);
        for part in ["faces of volumes per pixel: ", "in shadow ", "the deepest count is "] {
            assert!(stdout.contains(part), "{part} is not in {stdout}");
        }
        let output = folder.run(&small);
        let stderr = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{stderr}");
        assert!(stderr.contains("technique `linear` has none; use the technique `volume`"), "{stderr}");
    } else {
        let stderr = text(&output.stderr);
        let required = std::env::var("UMBRAGE_GOLDEN_REQUIRED").is_ok_and(|v| v == "1");
        assert!(!required && stderr.contains("no graphics adapter"), "{stderr}");
        eprintln!("SKIPPED: {stderr}");
    }
}
