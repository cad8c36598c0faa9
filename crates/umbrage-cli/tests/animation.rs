//! `--time` and `--animation` in every command that loads a scene.

use base64::Engine as _;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A folder with an animated file that goes when the test ends.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("umbrage-animation-{}-{name}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).expect("a temporary folder");
        std::fs::write(path.join("moves.gltf"), moves().to_string()).expect("a file");
        Self(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// A slanting triangle of one metre that `Slide` moves along x by 4 m in 2 s, and `Rise` along y.
fn moves() -> Value {
    let corners = [0.0, 1.0, 0.0, 1.0, 1.4, 0.0, 0.0, 1.4, 1.0];
    let times = [0.0, 2.0];
    let (slide, rise) = ([0.0, 0.0, 0.0, 4.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0, 4.0, 0.0]);
    let numbers = corners.iter().chain(&times).chain(&slide).chain(&rise);
    let bytes: Vec<u8> = numbers.flat_map(|x: &f32| x.to_le_bytes()).collect();
    let uri = format!("data:;base64,{}", base64::engine::general_purpose::STANDARD.encode(&bytes));
    let accessor = |offset: usize, kind: &str, count: usize| json!({"bufferView": 0, "byteOffset": offset, "componentType": 5126, "type": kind, "count": count});
    let animation = |name: &str, output: usize| {
        json!({"name": name, "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
               "samplers": [{"input": 1, "output": output}]})
    };
    json!({
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
        "materials": [{"doubleSided": true}],
        "buffers": [{"byteLength": bytes.len(), "uri": uri}],
        "bufferViews": [{"buffer": 0, "byteLength": bytes.len()}],
        "accessors": [accessor(0, "VEC3", 3), accessor(36, "SCALAR", 2), accessor(44, "VEC3", 2), accessor(68, "VEC3", 2)],
        "animations": [animation("Slide", 2), animation("Rise", 3)],
    })
}

fn umbrage(folder: &Path, args: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_umbrage"));
    command.current_dir(folder).args(args.split_whitespace());
    command.env_remove("UMBRAGE_WITHOUT").env_remove("UMBRAGE_ADAPTER");
    command.output().expect("the command starts")
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn json_of(folder: &Path, args: &str) -> Value {
    let output = umbrage(folder, args);
    assert_eq!(output.status.code(), Some(0), "{args}: {}", stderr(&output));
    serde_json::from_slice(&output.stdout).unwrap_or_else(|e| panic!("{args}: {e}"))
}

/// Is there an adapter? Says so when not, and fails where one is required.
fn has_adapter() -> bool {
    let has = umbrage(Path::new("."), "doctor").status.success();
    if !has {
        assert!(
            std::env::var("UMBRAGE_GOLDEN_REQUIRED").as_deref() != Ok("1"),
            "UMBRAGE_GOLDEN_REQUIRED=1, but there is no graphics adapter"
        );
        eprintln!("SKIPPED: {:?} needs a graphics adapter and found none", std::thread::current().name());
    }
    has
}

#[test]
fn the_truth_of_a_moment() {
    let folder = Folder::new("truth");
    let truth = |more: &str| {
        json_of(&folder.0, &format!("truth moves.gltf --size 32x18 --samples 1 --json -o t.png {more}"))
    };
    let rest = truth("");
    assert!(rest["scene"]["animation"].is_null());
    for (options, number, name, time, min) in [
        ("--time 0.5", 0, "Slide", 0.5, [1.0, 1.0, 0.0]),
        ("--time=-0.5", 0, "Slide", 1.5, [3.0, 1.0, 0.0]),
        ("--time 2.5 --animation Rise", 1, "Rise", 0.5, [0.0, 2.0, 0.0]),
        ("--time 2 --animation 1", 1, "Rise", 2.0, [0.0, 5.0, 0.0]),
    ] {
        let said = truth(options);
        let expected = json!({"number": number, "name": name, "length_s": 2.0, "time_s": time});
        assert_eq!(said["scene"]["animation"], expected, "{options}");
        assert_eq!(said["scene"]["bounds"]["min"], json!(min), "{options}");
        let note = format!("animation {number} `{name}` is shown at {time:.3} s of 2.000 s");
        assert_eq!(said["notes"][0], json!(note), "{options}");
    }
}

#[test]
fn a_scene_that_does_not_move_is_drawn_with_a_warning() {
    let folder = Folder::new("still");
    let said = json_of(&folder.0, "truth builtin:torus --size 32x18 --json -o t.png --time 1");
    assert!(said["scene"]["animation"].is_null());
    assert_eq!(said["warnings"].as_array().map(Vec::len), Some(1), "{}", said["warnings"]);
    assert!(said["warnings"][0].as_str().is_some_and(|w| w.contains("no animation")));
    let refused = umbrage(&folder.0, "truth moves.gltf --time 1 --animation Slid");
    assert_eq!(refused.status.code(), Some(2));
    assert!(stderr(&refused).contains("there are 0 \"Slide\", 1 \"Rise\""), "{}", stderr(&refused));
    assert!(!folder.0.join("truth.png").exists());
}

#[test]
fn every_command_that_draws_takes_the_time_and_repeats_it() {
    if !has_adapter() {
        return;
    }
    let folder = Folder::new("draws");
    let pose = "moves.gltf --ground --size 64x36 --time 1.5 --animation Rise --json";
    for (command, more) in
        [("render", "-o a.png"), ("bench", "--frames 1"), ("compare", "--frames 1 -t hard --samples 1")]
    {
        let said = json_of(&folder.0, &format!("{command} {pose} {more}"));
        assert_eq!(said["scene"]["animation"]["time_s"], 1.5, "{command}");
        if command == "compare" {
            let typed = said["results"][0]["command"].as_str().expect("a command");
            assert!(typed.contains("--time 1.5 --animation Rise"), "{typed}");
            let drawn = umbrage(&folder.0, typed.strip_prefix("umbrage ").expect("ours"));
            assert_eq!(drawn.status.code(), Some(0), "{typed}: {}", stderr(&drawn));
        }
    }
    // The shadow on the ground is elsewhere at another time, under the same camera and light.
    let picture = |time: &str| {
        let output = umbrage(
            &folder.0,
            &format!(
                "render moves.gltf --ground --size 64x36 --quiet -o {time}.png --time {time} --view visibility \
                 --camera position=2:8:8,target=2:0:0 --light kind=directional,direction=0:-1:0"
            ),
        );
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        std::fs::read(folder.0.join(format!("{time}.png"))).expect("a picture")
    };
    assert_eq!(picture("0.5"), picture("2.5"), "it loops");
    assert_ne!(picture("0.5"), picture("1.5"));
}
