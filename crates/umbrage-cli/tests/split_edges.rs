//! `umbrage split-edges` as users meet it. It needs no adapter.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Two triangles that meet: open all around.
const LEAF: &str = "# a leaf\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 1\ng leaf\nf 1 2 3\nf 3 2 4\n";
const TETRAHEDRON: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

/// A folder that goes when the test ends.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("umbrage-cli-split-{}-{name}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).expect("a temporary folder");
        std::fs::write(path.join("leaf.obj"), LEAF).expect("a file");
        std::fs::write(path.join("solid.obj"), TETRAHEDRON).expect("a file");
        Self(path)
    }

    fn run(&self, args: &[&str]) -> Output {
        let mut command = Command::new(env!("CARGO_BIN_EXE_umbrage"));
        command.current_dir(&self.0).arg("split-edges").args(args).output().expect("the command starts")
    }

    fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(&self.0).expect("the folder").flatten();
        let mut names: Vec<String> =
            entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
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

#[test]
fn a_solid_is_split_and_counted() {
    let folder = Folder::new("solid");
    let done = folder.run(&["solid.obj", "-o", "out.obj"]);
    assert_eq!((done.status.code(), text(&done.stderr)), (Some(0), String::new()));
    let said = text(&done.stdout);
    let rows: Vec<String> =
        said.lines().map(|line| line.split_whitespace().collect::<Vec<_>>().join(" ")).collect();
    for row in ["faces 4", "ghosts added 6", "open edges 0"] {
        assert!(rows.iter().any(|r| r == row), "{row}: {said}");
    }
    assert!(said.trim_end().lines().last().is_some_and(|l| l.contains("written to out.obj")), "{said}");
    let written = std::fs::read_to_string(folder.0.join("out.obj")).expect("the file");
    assert!(written.starts_with("v 0 0 0\n") && written.contains("\ng umbrage_ghosts\nf "), "{written}");
    assert_eq!(written.lines().filter(|line| line.starts_with("f ")).count(), 10);
    assert_eq!(folder.names(), ["leaf.obj", "out.obj", "solid.obj"]);

    let silent = folder.run(&["solid.obj", "-o", "out.obj", "--quiet"]);
    assert!(silent.status.success() && silent.stdout.is_empty() && silent.stderr.is_empty());
}

#[test]
fn what_is_open_is_said_and_closed_on_demand() {
    let folder = Folder::new("open");
    let json = |args: &[&str]| -> (serde_json::Value, String) {
        let done = folder.run(args);
        assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
        (serde_json::from_slice(&done.stdout).expect("one object"), text(&done.stderr))
    };
    let (open, said) = json(&["leaf.obj", "-o", "out.obj", "--json"]);
    assert_eq!((&open["open_edges"], &open["ghosts"], &open["parts"]), (&4.into(), &5.into(), &1.into()));
    assert!(said.starts_with("warning: 4 open edges") && said.contains("--back-faces"), "{said}");
    assert_eq!(open["warnings"].as_array().map(Vec::len), Some(1));
    let (whole, said) = json(&["leaf.obj", "-o", "out.obj", "--json", "--back-faces"]);
    assert_eq!((&whole["back_faces"], &whole["ghosts"]), (&2.into(), &6.into()));
    assert!(said.is_empty(), "{said}");
    for key in
        ["vertices", "faces", "edges_of_more_than_two_faces", "degenerate_faces", "duplicated_faces", "bytes"]
    {
        assert!(whole[key].is_u64(), "{key} in {whole}");
    }
}

#[test]
fn what_cannot_be_done_fails_in_one_line_and_leaves_nothing() {
    let folder = Folder::new("refused");
    std::fs::write(folder.0.join("points.obj"), "v 0 0 0\np 1\n").expect("a file");
    std::fs::write(folder.0.join("broken.obj"), "v 0 0 0\nf 1 2 3\n").expect("a file");
    std::fs::create_dir(folder.0.join("folder.obj")).expect("a folder");
    let before = folder.names();
    let missing = &["none.obj", "-o", "out.obj"];
    for (args, status, words) in [
        (&missing[..], 1, &["none.obj", "no such file"][..]),
        (&["points.obj", "-o", "out.obj"], 1, &["points.obj", "no faces"]),
        (&["broken.obj", "-o", "out.obj"], 1, &["broken.obj", "line 2"]),
        (&["folder.obj", "-o", "out.obj"], 1, &["folder.obj", "folder"]),
        (&["leaf.obj", "-o", "none/out.obj"], 1, &["its folder does not exist"]),
        (&["leaf.obj", "-o", "folder.obj"], 1, &["it is a folder"]),
        (&["model.glb", "-o", "out.obj"], 1, &["model.glb"]),
        (&["leaf.obj", "-o", "leaf.obj"], 2, &["leaf.obj is the input"]),
        (&["leaf.obj", "-o", "folder.obj/../leaf.obj"], 2, &["is the input"]),
        (&["leaf.obj", "-o", "out.glb"], 2, &["OBJ", ".glb"]),
        (&["leaf.obj"], 2, &["--output"]),
        (&["-o", "out.obj"], 2, &["<IN.OBJ>"]),
    ] {
        let output = folder.run(args);
        let stderr = text(&output.stderr);
        assert_eq!(output.status.code(), Some(status), "{args:?}: {stderr}");
        assert!(output.stdout.is_empty() && stderr.lines().count() == 1, "{args:?}: {stderr}");
        assert!(stderr.starts_with("umbrage: ") && words.iter().all(|w| stderr.contains(w)), "{stderr}");
        assert_eq!(folder.names(), before, "{args:?}");
    }
    assert_eq!(std::fs::read_to_string(folder.0.join("leaf.obj")).expect("kept"), LEAF);
}

#[test]
fn real_models_are_split() {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/scenes");
    if !scenes.is_dir() {
        eprintln!("SKIPPED: {} is not there, so no model of it was split", scenes.display());
        return;
    }
    let folder = Folder::new("real");
    let spot = scenes.join("classic-obj/spot/spot_triangulated.obj");
    let done = folder.run(&[&spot.to_string_lossy(), "-o", "spot.obj", "--json"]);
    let json: serde_json::Value = serde_json::from_slice(&done.stdout).expect("one object");
    // Closed, so three edges to two triangles.
    assert_eq!(
        (&json["faces"], &json["ghosts"], &json["open_edges"]),
        (&5856.into(), &8784.into(), &0.into())
    );
    assert!(umbrage_scene::load(&folder.0.join("spot.obj").to_string_lossy()).is_ok());
}
