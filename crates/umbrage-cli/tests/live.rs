//! Rows I4, I5 and I11 as a user meets them: what `--reuse` counts, what memory says, and `umbrage bench threaded`.

use serde_json::Value;
use std::path::PathBuf;
use std::process::{Command, Output};

fn umbrage(args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_umbrage"));
    command.current_dir(std::env::temp_dir()).args(args);
    command.env_remove("UMBRAGE_WITHOUT").env_remove("UMBRAGE_ADAPTER").output().expect("the command starts")
}

/// `None`, said loudly, without an adapter; a failure where `UMBRAGE_GOLDEN_REQUIRED=1` says that there must be one.
fn json(args: &[&str]) -> Option<Value> {
    let output = umbrage(args);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    if !output.status.success() && stderr.contains("no graphics adapter") {
        let required = std::env::var("UMBRAGE_GOLDEN_REQUIRED").is_ok_and(|v| v == "1");
        assert!(!required, "{stderr}");
        eprintln!("SKIPPED: {stderr}");
        return None;
    }
    assert!(output.status.success(), "{stderr}");
    Some(serde_json::from_slice(&output.stdout).expect("one JSON object"))
}

fn refused(args: &[&str], words: &str) {
    let output = umbrage(args);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    assert!(stderr.lines().count() == 1 && stderr.contains(words), "{stderr}");
}

#[test]
fn frames_draw_their_maps_unless_reuse_is_asked_for() {
    let picture: PathBuf = std::env::temp_dir().join(format!("umbrage-live-{}.png", std::process::id()));
    let picture_name = picture.display().to_string();
    let point = "kind=point,position=0:5:1";
    let render =
        ["render", "--size", "32x18", "--set", "map_size=64", "--light", point, "--light", "kind=spot"];
    let more = ["--frames", "3", "--json", "-o", &picture_name];
    let Some(drawn) = json(&[&render[..], &more].concat()) else { return };
    // Three frames, and one more in which passes are measured; seven maps in each.
    assert_eq!((&drawn["maps_drawn"], &drawn["maps_reused"]), (&28.into(), &0.into()));
    let layer = drawn["shadow_memory_bytes"].as_u64().expect("bytes") / 7;
    assert_eq!(drawn["shadow_memory_per_light_bytes"], serde_json::json!([6 * layer, layer]));
    let Some(reused) = json(&[&render[..], &more, &["--reuse", "--statistics"]].concat()) else { return };
    assert_eq!((&reused["maps_drawn"], &reused["maps_reused"]), (&7.into(), &28.into()));
    let _ = std::fs::remove_file(picture);

    let bench = ["bench", "--size", "32x18", "--set", "map_size=64", "--frames", "2", "--json"];
    let counts = |report: &Value| {
        let row = &report["techniques"][1];
        (row["maps_drawn"].clone(), row["maps_reused"].clone(), row["passes"].as_array().map(Vec::len))
    };
    let Some(drawn) = json(&bench) else { return };
    assert_eq!(counts(&drawn), (2.into(), 0.into(), Some(3)));
    assert_eq!(
        drawn["techniques"][1]["shadow_memory_per_light_bytes"][0],
        drawn["techniques"][1]["shadow_memory_bytes"]
    );
    let Some(reused) = json(&[&bench[..], &["--reuse"]].concat()) else { return };
    assert_eq!(counts(&reused), (0.into(), 2.into(), Some(2)));
}

#[test]
fn bench_threaded_has_a_row_for_each_load_and_schedule() {
    let args = ["bench", "threaded", "--size", "32x18", "--set", "map_size=64", "--seconds", "0.1"];
    let loads = ["--map-load-ms", "3", "--frame-load-ms", "2", "--interval-ms", "4", "--json"];
    let Some(report) = json(&[&args[..], &loads].concat()) else { return };
    let rows = report["rows"].as_array().expect("rows");
    assert_eq!(rows.len(), 12);
    for row in rows {
        assert!(row["frames"].as_u64().expect("a count") > 0, "{row}");
        assert!(row["frames_per_s"].as_f64().is_some_and(|fps| fps > 0.0), "{row}");
        if row["maps_by"] == "frame" {
            // Whatever the machine does, these are never old.
            assert_eq!((&row["age_frames_max"], &row["age_ms_max"]), (&0.into(), &0.0.into()));
        }
    }
    let by: Vec<_> = rows.iter().take(3).map(|row| row["maps_by"].as_str().unwrap_or_default()).collect();
    assert_eq!(by, ["frame", "interval", "thread"]);
    assert!(report["adapter"].is_string() && report["cores"].as_u64().is_some_and(|n| n > 0));
}

#[test]
fn bench_threaded_refuses_what_makes_no_sense() {
    refused(&["bench", "threaded", "--interval-ms", "-1"], "milliseconds");
    refused(&["bench", "threaded", "--map-load-ms", "inf"], "milliseconds");
    refused(&["bench", "threaded", "--seconds", "0"], "seconds");
    if json(&["doctor", "--json"])
        .is_some_and(|doctor| doctor["adapters"].as_array().is_some_and(|a| !a.is_empty()))
    {
        refused(&["bench", "threaded", "--technique", "unshadowed"], "draws no map");
    }
}
