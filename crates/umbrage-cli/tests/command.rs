//! The command as users meet it: exit status, one line for each error, nothing left behind.
//!
//! Tests that draw need an adapter. Where there is none they say so on standard error, and fail when
//! `UMBRAGE_GOLDEN_REQUIRED=1`.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;

const SMALL: [&str; 3] = ["render", "--size", "64x36"];

/// An empty folder that goes when the test ends.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("umbrage-cli-{}-{name}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).expect("a temporary folder");
        Self(path)
    }

    fn names(&self) -> Vec<String> {
        let mut names: Vec<String> = std::fs::read_dir(&self.0)
            .expect("the folder")
            .flatten()
            .map(|entry| entry.file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn command(folder: &Path, args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_umbrage"));
    command.current_dir(folder).args(args).env_remove("UMBRAGE_WITHOUT").env_remove("UMBRAGE_ADAPTER");
    command
}

fn umbrage(folder: &Path, args: &[&str]) -> Output {
    command(folder, args).output().expect("the command starts")
}

fn small(more: &[&'static str]) -> Vec<&'static str> {
    SMALL.iter().chain(more).copied().collect()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Fails unless the output is one line of error with this status that contains `words`.
fn refused(output: &Output, status: i32, words: &[&str]) {
    let stderr = text(&output.stderr);
    assert_eq!(output.status.code(), Some(status), "{stderr}");
    assert!(output.stdout.is_empty(), "{}", text(&output.stdout));
    assert!(stderr.starts_with("umbrage: ") && stderr.ends_with('\n'), "{stderr:?}");
    assert_eq!(stderr.lines().count(), 1, "{stderr}");
    for word in words {
        assert!(stderr.contains(word), "`{word}` is not in: {stderr}");
    }
}

fn succeeded(output: &Output) {
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
}

/// Is there an adapter? Says so when not, and fails where one is required.
fn has_adapter() -> bool {
    static HAS: OnceLock<bool> = OnceLock::new();
    let has = *HAS.get_or_init(|| umbrage(Path::new("."), &["doctor"]).status.success());
    if !has {
        assert!(
            std::env::var("UMBRAGE_GOLDEN_REQUIRED").as_deref() != Ok("1"),
            "UMBRAGE_GOLDEN_REQUIRED=1, but there is no graphics adapter; `umbrage doctor` says what to install"
        );
        eprintln!("SKIPPED: {:?} needs a graphics adapter and found none", std::thread::current().name());
    }
    has
}

#[test]
fn what_cannot_be_read_or_written_fails_with_one_line_and_leaves_nothing() {
    let folder = Folder::new("files");
    std::fs::create_dir(folder.0.join("folder")).expect("a folder");
    std::fs::create_dir(folder.0.join("folder.png")).expect("a folder");
    for name in ["empty.glb", "empty.gltf", "empty.obj", "text.txt", "text.png", "cases.json"] {
        std::fs::write(folder.0.join(name), if name.starts_with("empty") { "" } else { "{}" })
            .expect("a file");
    }
    let before = folder.names();
    for (args, words) in [
        (&["none.glb"][..], &["none.glb", "no such file"][..]),
        (&["folder"], &["folder"]),
        (&["empty.glb"], &["empty.glb"]),
        (&["empty.gltf"], &["empty.gltf"]),
        (&["empty.obj"], &["empty.obj"]),
        (&["text.txt"], &["text.txt", ".gltf, .glb and .obj"]),
        (&["-o", "none/a.png"], &["none/a.png", "its folder does not exist"]),
        (&["-o", "folder"], &["cannot write folder", "it is a folder"]),
        (&["-o", "folder.png"], &["cannot write folder.png", "it is a folder"]),
        (&["-o", "text.txt/a.png"], &["its folder does not exist"]),
        (&["--light", "cookie=none.png"], &["cookie", "none.png"]),
        (&["--light", "cookie=folder"], &["cookie", "it is a folder"]),
        (&["--light", "cookie=text.png"], &["cookie", "png, jpg and webp"]),
        (&["--lights-from", "none.json:A"], &["none.json", "check the path"]),
        (&["--lights-from", "cases.json:A"], &["cases.json", "not a file of cases"]),
    ] {
        refused(&umbrage(&folder.0, &small(args)), 1, words);
        assert_eq!(folder.names(), before, "{args:?}");
    }
}

#[test]
fn wrong_use_names_what_was_meant_before_anything_is_loaded() {
    let folder = Folder::new("use");
    for (args, words) in [
        (&["render", "--size", "0x0"][..], &["0x0", "1280x720"][..]),
        (&["render", "--size", "64"], &["64", "1280x720"]),
        (&["render", "--technique", "liner"], &["liner", "`linear`", "similar"]),
        (&["render", "--view", "finall"], &["finall", "`final`", "possible values"]),
        (&["render", "--set", "map_sise=3"], &["did you mean `map_size`?"]),
        (&["render", "--set", "filter=nearst"], &["did you mean `nearest`?"]),
        (&["render", "--set", "map_size"], &["key=value"]),
        (&["render", "--set", "map_size=0"], &["whole number from 1 to 16384"]),
        (&["render", "--set", "map_size=1", "--set", "map_size=2"], &["twice"]),
        (&["render", "--technique", "unshadowed", "--set", "map_size=4"], &["it has none"]),
        (&["render", "--light", "kind=spott"], &["did you mean `spot`?"]),
        (&["render", "--light", "postion=1:2:3"], &["did you mean `position`?"]),
        (&["render", "--light", "position=1/2/3"], &["x:y:z"]),
        (&["render", "--light", "kind=point,cookie=a.png"], &["only a spot light"]),
        (&["render", "--light", "outer=100"], &["below 90 degrees"]),
        (&["render", "--light", "candela=-1"], &["0 or more"]),
        (&["render", "--camera", "fov=200"], &["below 179"]),
        (&["render", "--camera", "near=2,far=1"], &["near must be below far"]),
        (&["render", "--camera", "farr=1"], &["did you mean `far`?"]),
        (&["render", "--camera", "7"], &["no camera `7`", "it has 0"]),
        (&["render", "--camera", "camra"], &["did you mean `camera`?"]),
        (&["render", "--ambient", "2"], &["from 0 to 1"]),
        (&["render", "--fill", "NaN"], &["from 0 to 1"]),
        (&["render", "--exposure", "0"], &["auto"]),
        (&["render", "--msaa", "3"], &["possible values", "1", "4"]),
        (&["render", "--shading", "pretty"], &["material, documents"]),
        (&["render", "--background", "blue"], &["#rrggbb"]),
        (&["render", "--frames", "0"], &["0 is not in 1..=10000"]),
        (&["render", "--lights-from", "cases.json"], &["cases.json:A"]),
        (&["render", "-o", "a.jpg"], &["PNG", ".jpg"]),
        (&["render", "--json", "--quiet"], &["--quiet"]),
        (&["render", "builtin:tors"], &["did you mean torus?"]),
        (&["render", "builtin:torus?scale=0"], &["scale"]),
        (&["render", "--exposure", "-1"], &["--exposure"]),
        (&["render", "--time", "now"], &["--time", "a number of seconds"]),
        (&["render", "--time", "inf"], &["--time", "a number of seconds"]),
        (&["render", "--animation", "Run"], &["--time"]),
        (&["render", "--time", "1", "--animation", "Run"], &["builtin:torus", "no animation \"Run\""]),
        (&["render", "--light", "kind=spot", "--lights-from", "a.json:A"], &["cannot be used with"]),
        (&["render", "--sise", "3x3"], &["--sise", "--size"]),
        (&["bench", "--techniques", "unshadowed,hrad"], &["hrad", "`hard`"]),
        (&["compare", "--techniques", "unshadowed,hrad:bias=none"], &["hrad", "`hard`"]),
        (&["compare", "--techniques", "hard:bias"], &["key=value", "linear:bias=slope"]),
        (&["compare", "--techniques", "hard:bais=none"], &["`bais`", "`bias`"]),
        (
            &["bench", "--techniques", "linear,matrix-bias", "--set", "matrix_bias=0.1"],
            &["`linear` has no setting"],
        ),
        (&["passes"], &["<ID>"]),
        (&["passes", "liner"], &["`linear`"]),
        (&["passes", "linear", "--set", "bias=slop"], &["did you mean `slope`?"]),
        (&["wgsl", "filter/liner"], &["did you mean `filter/linear`?"]),
        (&["completions", "tcsh"], &["tcsh", "bash"]),
        (&["man", "rendr"], &["did you mean `render`?"]),
        (&["rendr"], &["rendr", "`render`"]),
        (&[], &["umbrage --help"]),
    ] {
        let output = umbrage(&folder.0, args);
        refused(&output, 2, &words.iter().map(|w| w.trim_matches('`')).collect::<Vec<_>>());
        assert_eq!(folder.names(), [""; 0], "{args:?}");
    }
}

#[test]
fn what_the_adapter_cannot_do_fails_and_leaves_nothing() {
    if !has_adapter() {
        return;
    }
    let folder = Folder::new("adapter");
    let huge = umbrage(&folder.0, &["render", "--size", "100000x100000"]);
    refused(&huge, 1, &["100000x100000", "on this adapter"]);
    let lacking = command(&folder.0, &small(&["--set", "storage=depth16"]))
        .env("UMBRAGE_WITHOUT", "depth16")
        .output()
        .expect("starts");
    refused(&lacking, 1, &["depth16", "depth32f, depth24", "storage=auto"]);
    refused(&umbrage(&folder.0, &small(&["--adapter", "no such card"])), 1, &["no such card", "there is"]);
    for (args, words) in [
        (&["--view", "depth", "--technique", "unshadowed"][..], &["needs a shadow map"][..]),
        (&["--view", "visibility", "--light-index", "7"], &["light 7"]),
        (&["--view", "channels"], &["the map is depth32f", "storage=r32f"]),
    ] {
        refused(&umbrage(&folder.0, &small(args)), 2, words);
    }
    assert_eq!(folder.names(), [""; 0]);
}

/// An adapter without depth textures to sample: `auto` keeps distance in colour, and what cannot be had with that is said.
#[test]
fn without_depth_formats_distance_is_kept_in_colour() {
    if !has_adapter() {
        return;
    }
    let folder = Folder::new("colour");
    let without = |args: &[&'static str]| {
        command(&folder.0, &small(args))
            .env("UMBRAGE_WITHOUT", "depth16,depth24,depth32f,r32f")
            .output()
            .expect("starts")
    };
    let drawn = without(&["--json"]);
    let said = String::from_utf8_lossy(&drawn.stdout).into_owned();
    assert!(drawn.status.success() && said.contains("packed3"), "{said}");
    refused(&without(&["--technique", "perspective"]), 2, &["packed3", "warped map"]);
}

#[test]
fn without_an_adapter_the_way_out_is_named() {
    let folder = Folder::new("none");
    for args in [&small(&[])[..], &["doctor"], &["doctor", "--json"], &["bench", "--size", "64x36"]] {
        let output = command(&folder.0, args)
            .env("VK_ICD_FILENAMES", "/nonexistent")
            .env("VK_DRIVER_FILES", "/nonexistent")
            .env("WGPU_BACKEND", "vulkan")
            .output()
            .expect("starts");
        refused(&output, 1, &["no graphics adapter was found", "mesa-vulkan-drivers"]);
    }
    assert_eq!(folder.names(), [""; 0]);
}

#[test]
fn a_reader_that_leaves_is_no_failure() {
    let mut child = command(Path::new("."), &["techniques", "--json"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("starts");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("ends");
    succeeded(&output);
    assert!(output.stderr.is_empty(), "{}", text(&output.stderr));
}

#[test]
fn json_of_a_picture_has_every_key_and_only_finite_numbers() {
    if !has_adapter() {
        return;
    }
    let folder = Folder::new("json");
    let output = umbrage(
        &folder.0,
        &small(&["--json", "--frames", "3", "--statistics", "--ground", "--set", "map_size=64"]),
    );
    succeeded(&output);
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("one object");
    for key in [
        "adapter",
        "driver",
        "backend",
        "scene",
        "technique",
        "params",
        "map_format",
        "size",
        "view",
        "passes",
        "frame_ms",
        "frames_ms",
        "shadow_memory_bytes",
        "exposure",
        "density",
        "overdraw",
        "timings",
        "output",
        "notes",
        "warnings",
    ] {
        assert!(json.get(key).is_some(), "{key} is not in {json}");
    }
    for key in ["name", "triangles", "instances", "meshes", "materials", "lights", "cameras"] {
        assert!(json["scene"][key].is_string() || json["scene"][key].as_u64() > Some(0), "{key}");
    }
    for corner in ["min", "max"] {
        let corner = json["scene"]["bounds"][corner].as_array().expect("three numbers");
        assert!(corner.len() == 3 && corner.iter().all(serde_json::Value::is_f64), "{corner:?}");
    }
    for key in ["load_ms", "setup_ms", "frame_ms", "write_ms"] {
        assert!(json["timings"][key].is_f64(), "{key}");
    }
    assert_eq!(json["params"]["map_size"], 64.0);
    assert_eq!(json["params"]["filter"], "linear");
    assert_eq!(json["size"], serde_json::json!([64, 36]));
    assert_eq!(json["frames_ms"].as_array().map(Vec::len), Some(2), "the first frame is left out");
    assert!(json["shadow_memory_bytes"].as_u64() >= Some(64 * 64 * 2));
    let passes = json["passes"].as_array().expect("passes");
    assert_eq!(passes[0]["name"], "shadow-map 0");
    for pass in passes {
        for key in ["name", "draws", "instances", "triangles", "vertices", "gpu_ms", "statistics"] {
            assert!(pass.get(key).is_some(), "{key} is not in {pass}");
        }
        assert!(pass["draws"].as_u64() > Some(0), "{pass}");
    }
    assert_eq!(folder.names(), ["umbrage.png"]);
}

#[test]
fn the_same_input_gives_the_same_bytes_and_shadows_change_them() {
    if !has_adapter() {
        return;
    }
    let folder = Folder::new("same");
    for (name, technique) in [("a.png", "linear"), ("b.png", "linear"), ("c.png", "unshadowed")] {
        let output =
            umbrage(&folder.0, &["render", "--size", "64x36", "-o", name, "-t", technique, "--quiet"]);
        succeeded(&output);
        assert!(output.stdout.is_empty() && output.stderr.is_empty());
    }
    let [a, b, c] = ["a.png", "b.png", "c.png"].map(|name| std::fs::read(folder.0.join(name)).expect(name));
    assert!(a.starts_with(b"\x89PNG"));
    assert!(a == b, "two runs differ");
    assert!(a != c, "the shadow is not there");
}

#[test]
fn every_view_of_every_light_kind_is_drawn_or_refused_with_a_reason() {
    if !has_adapter() {
        return;
    }
    let folder = Folder::new("views");
    for view in [
        "final",
        "visibility",
        "light",
        "depth",
        "distance",
        "projected",
        "density",
        "density-light",
        "volumes",
    ] {
        let technique = if view == "volumes" { "volume" } else { "linear" };
        for light in ["kind=spot", "kind=directional", "kind=point"] {
            let output = umbrage(
                &folder.0,
                &["render", "--size", "64x36", "-t", technique, "--view", view, "--light", light],
            );
            succeeded(&output);
            assert!(text(&output.stdout).contains("written to umbrage.png"), "{}", text(&output.stdout));
        }
    }
}

#[test]
fn texels_per_pixel_are_told_as_numbers_and_to_people() {
    if !has_adapter() {
        return;
    }
    let folder = Folder::new("density");
    let told = |more: &[&'static str]| {
        let output = umbrage(&folder.0, &small(&[&["--view", "density", "--json"], more].concat()));
        succeeded(&output);
        let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("one object");
        json["density"].clone()
    };
    let number = |json: &serde_json::Value| json.as_f64().expect("a number");
    let (fine, coarse) = (told(&["--set", "map_size=512"]), told(&["--set", "map_size=256"]));
    for part in [&fine, &fine["worst_direction"]] {
        let steps =
            ["p01", "p05", "p25", "p50", "p75", "p95", "p99"].map(|p| number(&part["percentiles"][p]));
        let all = [&[number(&part["least"])], &steps[..], &[number(&part["most"])]].concat();
        assert!(all.is_sorted(), "{part}");
        assert!((all[0]..=all[8]).contains(&number(&part["mean"])), "{part}");
    }
    // Half the map has half the texels along each pixel, everywhere.
    for key in ["least", "most", "mean"] {
        let times = number(&fine[key]) / number(&coarse[key]);
        assert!((times - 2.0).abs() < 0.06, "{key}: {times}");
    }
    assert!(fine["pixels"].as_u64() > Some(500) && fine["of"] == "picture", "{fine}");
    let octaves = fine["histogram"].as_array().expect("octaves");
    let shares: f64 = octaves.iter().map(|octave| number(&octave["share"])).sum();
    assert!((shares - 1.0).abs() < 1e-9 && octaves[9]["to"].is_null(), "{fine}");
    let nothing = told(&["--camera", "position=0:9:0,target=0:50:0.1"]);
    assert_eq!((&nothing["pixels"], nothing.get("least")), (&0.into(), None));
    let output = umbrage(&folder.0, &small(&["--view", "density-light"]));
    let stdout = text(&output.stdout);
    assert!(stdout.contains("texels per pixel: ") && stdout.contains("of the map\n"), "{stdout}");
    let none = ["render", "--view", "density", "-t", "unshadowed"];
    refused(&umbrage(&folder.0, &none), 2, &["`density` needs a shadow map", "unshadowed"]);
}

#[test]
fn lights_and_camera_of_a_case_are_taken() {
    if !has_adapter() {
        return;
    }
    let folder = Folder::new("case");
    let cases = r#"{"image":[48,32],"fovy_deg":60,"near":0.1,"far":100,"eye":[0,7,10],"target":[0,0,0],
        "cases":{"A":{"spot":[{"pos":[4,12,4],"target":[0,0,0],"outer_deg":40,"inner_deg":30}],"map":128}}}"#;
    std::fs::write(folder.0.join("cases.json"), cases).expect("written");
    let output = umbrage(&folder.0, &["render", "--lights-from", "cases.json:A", "--json"]);
    succeeded(&output);
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("one object");
    assert_eq!((&json["size"], &json["params"]["map_size"]), (&serde_json::json!([48, 32]), &128.0.into()));
    assert_eq!(json["scene"]["lights"], 1);
    refused(
        &umbrage(&folder.0, &["render", "--lights-from", "cases.json:B"]),
        2,
        &["no case `B`", "there are A"],
    );
}

#[test]
fn bench_puts_techniques_beside_the_unshadowed_frame() {
    if !has_adapter() {
        return;
    }
    let folder = Folder::new("bench");
    let args = ["bench", "--size", "64x36", "--techniques", "hard", "--set", "map_size=64", "--frames", "2"];
    let table = umbrage(&folder.0, &args);
    succeeded(&table);
    let stdout = text(&table.stdout);
    assert!(
        stdout.contains("median ms") && stdout.contains("unshadowed") && stdout.contains("hard"),
        "{stdout}"
    );
    assert!(!text(&table.stderr).contains("frame 1"), "progress without a terminal");
    let json = umbrage(&folder.0, &[&args[..], &["--json"]].concat());
    let json: serde_json::Value = serde_json::from_slice(&json.stdout).expect("one object");
    let rows = json["techniques"].as_array().expect("rows");
    assert_eq!(rows.len(), 2);
    assert!(rows[1]["draws"].as_u64() > rows[0]["draws"].as_u64(), "the map is drawn");
    assert_eq!(rows[0]["shadow_cost_ms"], 0.0);
    assert_eq!(folder.names(), [""; 0]);
}

#[test]
fn tables_plans_and_shaders_are_printed() {
    let out = |args: &[&str]| {
        let output = umbrage(Path::new("."), args);
        succeeded(&output);
        text(&output.stdout)
    };
    let plan = out(&["passes", "linear", "--set", "map_size=512"]);
    assert!(
        plan.contains("shadow-map (one for each view of a shadowed light)") && plan.contains("512x512"),
        "{plan}"
    );
    assert!(plan.contains("polygon offset slope") && plan.contains("\nlighting"), "{plan}");
    let plan: serde_json::Value =
        serde_json::from_str(&out(&["passes", "linear", "--json"])).expect("one object");
    assert_eq!(plan["passes"][0]["target"]["size_texel"], 2048);

    let table: serde_json::Value = serde_json::from_str(&out(&["techniques", "--json"])).expect("one object");
    let linear = table["techniques"].as_array().and_then(|all| all.iter().find(|t| t["id"] == "linear"));
    let linear = linear.expect("linear is in the table");
    assert_eq!(linear["choices"]["filter"], "linear");
    assert!(
        linear["params"]
            .as_array()
            .expect("a list")
            .iter()
            .any(|p| p["name"] == "map_size" && p["unit"] == "texel")
    );
    assert!(table["choices"]["bias"].as_array().expect("a list").len() > 1);
    let table = out(&["techniques"]);
    assert!(table.lines().all(|line| line.chars().count() <= 80), "{table}");
    assert!(out(&["techniques", "--matrix"]).contains("combinations are valid"));

    let wgsl = out(&["wgsl", "filter/linear"]);
    assert!(wgsl.contains("struct UmbrageView") && wgsl.contains("fn umbrage_"), "{wgsl}");
    assert!(!wgsl.contains("@group"), "a library binds nothing");
    assert!(out(&["wgsl"]).contains("filter/linear"));
}

#[test]
fn help_completions_and_pages_come_from_one_definition() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let output = umbrage(Path::new("."), &["completions", shell]);
        succeeded(&output);
        assert!(text(&output.stdout).contains("lights-from"), "{shell}");
    }
    for args in [&["man"][..], &["man", "render"], &["--help"], &["render", "--help"], &["--version"]] {
        let output = umbrage(Path::new("."), args);
        succeeded(&output);
        assert!(text(&output.stdout).contains("umbrage") && output.stderr.is_empty(), "{args:?}");
    }
    let help = text(&umbrage(Path::new("."), &["render", "--help"]).stdout);
    for word in ["Examples:", "umbrage.png", "position=x:y:z"] {
        assert!(help.contains(word), "{word}");
    }
}
