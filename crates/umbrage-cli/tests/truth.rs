//! `umbrage truth` and `umbrage compare` as users meet them.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

/// An empty folder that goes when the test ends.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("umbrage-truth-{}-{name}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).expect("a temporary folder");
        Self(path)
    }

    fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(&self.0).expect("the folder").flatten();
        let mut names: Vec<_> = entries.map(|e| e.file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn command(folder: &Path, args: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_umbrage"));
    command.current_dir(folder).args(args.split_whitespace());
    command.env_remove("UMBRAGE_WITHOUT").env_remove("UMBRAGE_ADAPTER");
    command
}

fn umbrage(folder: &Path, args: &str) -> Output {
    command(folder, args).output().expect("the command starts")
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn json(folder: &Path, args: &str) -> Value {
    let output = umbrage(folder, args);
    assert_eq!(output.status.code(), Some(0), "{args}: {}", stderr(&output));
    serde_json::from_slice(&output.stdout).unwrap_or_else(|e| panic!("{args}: {e}"))
}

fn refused(folder: &Path, args: &str, status: i32, word: &str) {
    let output = umbrage(folder, args);
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(status), "{args}: {said}");
    assert!(
        said.starts_with("umbrage: ") && said.lines().count() == 1 && said.contains(word),
        "{args}: {said}"
    );
    assert!(output.stdout.is_empty());
}

/// Is there an adapter? Says so when not, and fails where one is required.
fn has_adapter() -> bool {
    let has = umbrage(Path::new("."), "doctor").status.success();
    let required = std::env::var("UMBRAGE_GOLDEN_REQUIRED").as_deref() == Ok("1");
    assert!(has || !required, "UMBRAGE_GOLDEN_REQUIRED=1, but there is no graphics adapter");
    if !has {
        eprintln!("SKIPPED: {:?} needs a graphics adapter and found none", std::thread::current().name());
    }
    has
}

#[test]
fn the_truth_needs_no_adapter_and_is_the_same_twice() {
    let folder = Folder::new("same");
    let args = "truth builtin:contact --size 96x54 --light disc=0.3 --samples 16 --seed 5 --json -o";
    let said = json(&folder.0, &format!("{args} a.png --adapter none"));
    json(&folder.0, &format!("{args} b.png"));
    let read = |name: &str| std::fs::read(folder.0.join(name)).expect(name);
    assert_eq!(read("a.png"), read("b.png"));
    assert_eq!(
        (&said["samples"], &said["seed"], &said["view"]),
        (&16.into(), &5.into(), &"visibility".into())
    );
    for number in ["seconds", "rays", "rays_per_second", "receivers", "lit", "memory_bytes"] {
        assert!(said[number].as_f64().is_some_and(|x| x > 0.0), "{number}: {}", said[number]);
    }
    let other = format!("{args} c.png").replace("--seed 5", "--seed 6");
    json(&folder.0, &other);
    assert_ne!(read("a.png"), read("c.png"));
}

#[test]
fn objects_lose_their_roles_by_name_or_number() {
    let folder = Folder::new("roles");
    let args = "truth builtin:torus --size 96x54 --json -o t.png";
    let lit = |more: &str| json(&folder.0, &format!("{args} {more}"))["lit"].as_f64().expect("a share");
    let all = lit("");
    assert!(lit("--no-blocker torus") > all + 0.02);
    assert!(lit("--no-blocker torus --no-blocker floor") >= lit("--no-blocker torus"));
    assert!(lit("--no-blocker 0 --no-blocker 1 --no-blocker 2 --no-blocker 3 --no-blocker 4") == 1.0);
    refused(&folder.0, &format!("{args} --no-receiver flor"), 2, "did you mean `floor`?");
    refused(&folder.0, &format!("{args} --no-blocker 5"), 2, "there are 5");
}

#[test]
fn a_lit_picture_with_true_shadows() {
    if !has_adapter() {
        return;
    }
    let folder = Folder::new("final");
    json(&folder.0, "truth --size 64x36 --view final --json");
    let unshadowed = umbrage(&folder.0, "render --size 64x36 --technique unshadowed -o u.png --quiet");
    assert!(unshadowed.status.success());
    let read = |name: &str| image::open(folder.0.join(name)).expect(name).to_luma8();
    let mean = |name: &str| {
        let picture = read(name);
        picture.pixels().map(|p| f64::from(p.0[0])).sum::<f64>()
            / f64::from(picture.width() * picture.height())
    };
    assert!(mean("truth.png") < 0.97 * mean("u.png"), "{} {}", mean("truth.png"), mean("u.png"));
}

#[test]
fn what_cannot_be_meant_is_refused_before_any_work() {
    let folder = Folder::new("refused");
    std::fs::create_dir(folder.0.join("full")).expect("a folder");
    std::fs::write(folder.0.join("full/mine.txt"), "mine").expect("a file");
    for (args, status, word) in [
        ("truth --samples 0", 2, "1..=65536"),
        ("truth --samples 70000", 2, "1..=65536"),
        ("truth --light-index 3", 2, "there are 1 lights"),
        ("truth --view depth", 2, "visibility"),
        ("truth -o full", 1, "it is a folder"),
        ("truth -o a.jpg", 2, "PNG"),
        ("truth --light disc=1,rect=1:1", 2, "one shape"),
        ("truth --lights 4", 2, "no light `4`"),
        ("compare --techniques liner", 2, "linear"),
        ("compare --set map_sise=3", 2, "map_size"),
        ("compare --set map_size=0", 2, "whole number"),
        ("compare -o full", 1, "something else than a report"),
        ("compare -o none/report", 1, "does not exist"),
        ("compare --cameras 9", 2, "no camera `9`"),
        ("compare --path frames=3", 2, "does not move"),
        ("compare --path frames=1,turn=3", 2, "2 to 1000"),
        ("compare --path turn=3 --cameras all", 2, "cannot be used with"),
    ] {
        refused(&folder.0, args, status, word);
    }
    assert_eq!(folder.names(), ["full"]);
}

#[test]
fn compare_prints_every_measure_of_every_technique_light_and_camera() {
    if !has_adapter() {
        return;
    }
    let folder = Folder::new("compare");
    let said = json(
        &folder.0,
        "compare builtin:contact --size 160x90 --frames 2 --json --techniques unshadowed,hard,linear \
         --set map_size=256 --light position=-3:4.6:3.2,target=0:0.3:0,outer=24,disc=0.2 \
         --light kind=directional,direction=-1:-2:-0.5 --samples 16",
    );
    assert!(folder.names().is_empty(), "no report without -o: {:?}", folder.names());
    assert!(said["adapter"].is_string() && said["scene"]["triangles"].as_u64() > Some(1000));
    for key in ["samples", "seconds", "rays", "rays_per_second", "excluded_pixels"] {
        assert!(said["truth"][key].is_number(), "{key}");
    }
    let results = said["results"].as_array().expect("results");
    assert_eq!(results.len(), 3 * 2);
    for row in results {
        let numbers = [
            "false_shadow",
            "false_light",
            "rmse",
            "acne",
            "leak",
            "edge",
            "band",
            "flip",
            "cost_ms",
            "frame_ms",
            "unshadowed_ms",
            "memory_bytes",
            "passes",
            "draws",
            "triangles",
            "texels",
            "taps",
            "light",
        ];
        for key in numbers {
            assert!(row[key].is_number(), "{key} of {row}");
        }
        assert!(row["camera"].is_string() && row["params"].is_object() && row["flicker"].is_null());
        assert!(row["command"].as_str().is_some_and(|c| c.starts_with("umbrage render builtin:contact")));
    }
    // Only the first light has a shape, so only it has penumbrae; without a shadow there is no edge to measure.
    let penumbrae: Vec<bool> = results.iter().map(|row| row["penumbra"].is_number()).collect();
    assert_eq!(penumbrae, [false, true, true, false, false, false]);
    let rmse = |i: usize| results[i]["rmse"].as_f64().expect("a number");
    assert!(rmse(0) > rmse(2) && rmse(3) > rmse(5), "{} {} {} {}", rmse(0), rmse(2), rmse(3), rmse(5));
}

/// Every command in a report draws a picture.
#[test]
fn the_commands_of_a_report_can_be_typed() {
    if !has_adapter() {
        return;
    }
    let folder = Folder::new("again");
    let said = json(
        &folder.0,
        "compare builtin:columns --size 64x36 --frames 1 --techniques linear --set map_size=128 --json \
         --path frames=2,turn=5 -o report",
    );
    assert_eq!(folder.names(), ["report"]);
    assert!(folder.0.join("report/index.html").is_file() && folder.0.join("report/img").is_dir());
    let row = &said["results"][0];
    assert!(row["flicker"].is_number());
    let typed = row["command"].as_str().expect("a command").strip_prefix("umbrage ").expect("ours");
    assert!(typed.contains("--set map_size=128") && typed.contains("--camera position="), "{typed}");
    let drawn = umbrage(&folder.0, typed);
    assert!(drawn.status.success(), "{typed}: {}", stderr(&drawn));
    assert!(folder.0.join("linear.png").is_file());
}

#[cfg(unix)]
#[test]
fn ctrl_c_leaves_nothing_behind() {
    let folder = Folder::new("stop");
    let mut child =
        command(&folder.0, "truth builtin:torus --light radius=0.3 --samples 65536 --size 640x360")
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("starts");
    std::thread::sleep(Duration::from_millis(1500));
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill");
    assert!(sent.success() && child.try_wait().expect("asked").is_none(), "it must still be at work");
    let start = Instant::now();
    while child.try_wait().expect("asked").is_none() {
        if start.elapsed() > Duration::from_secs(60) {
            let _ = child.kill();
            panic!("it does not stop");
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    let output = child.wait_with_output().expect("output");
    assert_eq!(output.status.code(), Some(130), "{}", stderr(&output));
    assert!(
        stderr(&output).contains("nothing was written") && folder.names().is_empty(),
        "{:?}",
        folder.names()
    );
}
