//! `cargo xtask bench`: what users wait for, beside the bounds that we set ourselves.
//!
//! It reports and never fails on a time: how fast a machine is says nothing about whether a change is right.

use crate::machine;
use crate::process::{self, Done, Fault, failed};
use crate::setup::{self, Need};
use serde_json::{Value, json};
use std::process::Command;
use std::time::Instant;

/// Where the test scenes lie, when they lie beside the checkout.
pub const SCENES: &str = "../shared/scenes";

/// Measured runs of a whole command, after one that warms up (disk cache, the driver's shader cache).
const RUNS: usize = 5;
/// Measured frames of each technique.
const FRAMES: &str = "40";

/// A whole command, from its start to its end.
struct Whole {
    name: &'static str,
    /// Below [`SCENES`]; nothing for the built-in scene.
    scene: Option<&'static str>,
    bound_s: f64,
}

const WHOLE: [Whole; 3] = [
    Whole { name: "built-in scene, start to PNG", scene: None, bound_s: 2.0 },
    Whole {
        name: "village, 1.6 M triangles, start to PNG",
        scene: Some("kaykit-medieval-hexagon/village.gltf"),
        bound_s: 20.0,
    },
    Whole {
        name: "metal-rough spheres, 1.0 M triangles, start to PNG",
        scene: Some("metal-rough-spheres-no-textures/MetalRoughSpheresNoTextures.glb"),
        bound_s: 20.0,
    },
];

/// The scene whose frames are measured, and the case that says how.
const KNOTS: [&str; 2] = ["knots/knots.glb", "knots/cases.json"];
const CASE: &str = "A";
const BOUND_UNSHADOWED_MS: f64 = 150.0;
const BOUND_SHADOW_MS: f64 = 60.0;

/// One line of the table.
struct Measured {
    name: String,
    median: f64,
    min: f64,
    max: f64,
    bound: Option<f64>,
    unit: &'static str,
}

/// `cargo xtask bench [--json]`
pub fn run(arguments: &[String]) -> Done {
    let to_json = match arguments {
        [] => false,
        [flag] if flag == "--json" => true,
        [first, ..] => return Err(Fault::WrongUse(format!("`bench` takes --json, not `{first}`"))),
    };
    setup::before_build(Need::Draw)?;
    process::build_umbrage("release")?;
    let machine = parsed(&mut process::umbrage("release", ["doctor", "--json"]))?;
    let mut skipped = Vec::new();
    let mut rows = Vec::new();
    for whole in &WHOLE {
        match measure_whole(whole)? {
            Some(row) => rows.push(row),
            None => skipped.push(whole.name.to_owned()),
        }
    }
    let frames = measure_frames()?;
    match &frames {
        Some(report) => rows.extend(frame_rows(report)?),
        None => skipped.push("frames of the torus knots".to_owned()),
    }
    let of_machine = |key: &str| machine[key].as_str().unwrap_or("unknown").to_owned();
    println!("\nprocessor  {}", machine::processor());
    println!("adapter    {} ({})", of_machine("adapter"), of_machine("backend"));
    println!("driver     {}\n", of_machine("driver"));
    print_rows(&rows);
    frames.as_ref().into_iter().for_each(print_counts);
    for name in &skipped {
        println!("\nSKIPPED: {name}. Its scene does not lie in {SCENES}.");
    }
    if to_json {
        let path = process::root().join("target").join("bench.json");
        let report = json!({
            "processor": machine::processor(),
            "adapter": of_machine("adapter"),
            "driver": of_machine("driver"),
            "backend": of_machine("backend"),
            "measured": rows.iter().map(Measured::json).collect::<Vec<_>>(),
            "frames": frames,
            "skipped": skipped,
        });
        process::write(&path, format!("{report:#}\n"))?;
        println!("\nThe same as JSON: {}", path.display());
    }
    Ok(())
}

impl Measured {
    fn of_runs(name: &str, times: &mut [f64], bound: Option<f64>, unit: &'static str) -> Self {
        times.sort_by(f64::total_cmp);
        let at = |i: usize| times.get(i).copied().unwrap_or(0.0);
        let last = times.len().saturating_sub(1);
        let (median, min, max) = (0.5 * (at(last / 2) + at(last.div_ceil(2))), at(0), at(last));
        Self { name: name.to_owned(), median, min, max, bound, unit }
    }

    /// Nothing where there is no bound.
    fn is_met(&self) -> Option<bool> {
        self.bound.map(|bound| self.median <= bound)
    }

    fn json(&self) -> Value {
        json!({
            "name": self.name, "unit": self.unit, "median": self.median, "min": self.min, "max": self.max,
            "bound": self.bound, "met": self.is_met(),
        })
    }
}

/// `None`: the scene is not there.
fn measure_whole(whole: &Whole) -> Result<Option<Measured>, Fault> {
    let scene = whole.scene.map(|scene| format!("{SCENES}/{scene}"));
    if scene.as_ref().is_some_and(|scene| !process::root().join(scene).is_file()) {
        return Ok(None);
    }
    let folder = process::root().join("target").join("bench");
    process::make_folder(&folder)?;
    let mut render = process::umbrage("release", ["render"]);
    render.args(&scene).args(["--size", "1280x720", "--quiet", "-o"]).arg(folder.join("whole.png"));
    eprintln!("$ {} (1 + {RUNS} times)", process::typed(&render));
    let mut times = Vec::with_capacity(RUNS);
    for run in 0..=RUNS {
        let start = Instant::now();
        process::stdout(&mut render)?;
        if run > 0 {
            times.push(start.elapsed().as_secs_f64());
        }
    }
    Ok(Some(Measured::of_runs(whole.name, &mut times, Some(whole.bound_s), "s")))
}

/// What `umbrage bench --json` says of the torus knots; `None` when they are not there.
fn measure_frames() -> Result<Option<Value>, Fault> {
    let [scene, cases] = KNOTS.map(|file| format!("{SCENES}/{file}"));
    if ![&scene, &cases].iter().all(|file| process::root().join(file).is_file()) {
        return Ok(None);
    }
    let mut bench = process::umbrage("release", ["bench", &scene, "--lights-from"]);
    bench.arg(format!("{cases}:{CASE}"));
    bench.args(["--techniques", "unshadowed,linear", "--frames", FRAMES, "--json"]);
    eprintln!("$ {}", process::typed(&bench));
    parsed(&mut bench).map(Some)
}

fn parsed(command: &mut Command) -> Result<Value, Fault> {
    let text = process::stdout(command)?;
    serde_json::from_str(&text)
        .map_err(|e| failed(format!("`{}` printed no JSON: {e}", process::typed(command))))
}

fn technique<'a>(report: &'a Value, id: &str) -> Option<&'a Value> {
    report["techniques"].as_array()?.iter().find(|row| row["technique"] == id)
}

fn frame_rows(report: &Value) -> Result<Vec<Measured>, Fault> {
    let frames = |id: &str| -> Option<Vec<f64>> {
        technique(report, id)?["frames_ms"].as_array()?.iter().map(Value::as_f64).collect()
    };
    let (Some(mut bare), Some(mut shadowed)) = (frames("unshadowed"), frames("linear")) else {
        return Err(failed("`umbrage bench --json` has no `frames_ms` of unshadowed and linear"));
    };
    // Frames take turns, so each pair met the same neighbours on this machine.
    let mut costs: Vec<f64> = shadowed.iter().zip(&bare).map(|(with, without)| with - without).collect();
    let cost = Measured::of_runs("knots, what the shadow costs", &mut costs, Some(BOUND_SHADOW_MS), "ms");
    let bare = Measured::of_runs("knots, frame without shadow", &mut bare, Some(BOUND_UNSHADOWED_MS), "ms");
    let shadowed = Measured::of_runs("knots, frame with shadow", &mut shadowed, None, "ms");
    Ok(vec![bare, shadowed, cost])
}

fn print_rows(rows: &[Measured]) {
    println!("{:<52} {:>10} {:>19} {:>9}  ", "measured", "median", "min .. max", "bound");
    for row in rows {
        let Measured { name, median, min, max, bound, unit } = row;
        let verdict = row.is_met().map_or("", |met| if met { "met" } else { "MISSED" });
        println!(
            "{name:<52} {:>10} {:>19} {:>9}  {verdict}",
            format!("{median:.2} {unit}"),
            format!("{min:.2} .. {max:.2}"),
            bound.map(|bound| format!("{bound} {unit}")).unwrap_or_default()
        );
    }
}

/// What does not vary from run to run.
fn print_counts(report: &Value) {
    println!(
        "\n{:<12} {:>7} {:>11} {:>11} {:>13} {:>14}",
        "knots", "draws", "triangles", "vertices", "vertex runs", "fragment runs"
    );
    for id in ["unshadowed", "linear"] {
        let row = technique(report, id).unwrap_or(&Value::Null);
        let count = |key: &str| row[key].as_u64().map_or_else(|| "-".to_owned(), |n| n.to_string());
        println!(
            "{id:<12} {:>7} {:>11} {:>11} {:>13} {:>14}",
            count("draws"),
            count("triangles"),
            count("vertices"),
            count("vertex_runs"),
            count("fragment_runs")
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_bounds_and_spread() {
        let row = Measured::of_runs("x", &mut [3.0, 1.0, 2.0, 9.0, 2.5], Some(2.0), "s");
        assert_eq!((row.median, row.min, row.max), (2.5, 1.0, 9.0));
        assert_eq!(row.is_met(), Some(false));
        assert_eq!(Measured { bound: Some(2.5), ..row }.is_met(), Some(true));
        assert_eq!(Measured::of_runs("x", &mut [4.0, 1.0], None, "s").median, 2.5);
    }

    #[test]
    fn the_shadow_costs_what_neighbouring_frames_differ_by() {
        let report = json!({"techniques": [
            {"technique": "unshadowed", "frames_ms": [10.0, 12.0, 30.0]},
            {"technique": "linear", "frames_ms": [15.0, 18.0, 34.0]},
        ]});
        let rows = frame_rows(&report).unwrap();
        assert_eq!(rows.iter().map(|row| row.median).collect::<Vec<_>>(), [12.0, 18.0, 5.0]);
        assert!(frame_rows(&json!({})).is_err());
    }
}
