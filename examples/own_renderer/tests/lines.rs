//! What a shadow costs its caller in lines, and in crates.

use std::path::Path;

fn read(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(name);
    std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

fn is_code(line: &&str) -> bool {
    let line = line.trim();
    !line.is_empty() && !line.starts_with("//")
}

/// Lines that are there for the shadow: marked ones.
fn marked(text: &str) -> usize {
    text.lines().filter(is_code).filter(|line| line.trim_end().ends_with("// shadow")).count()
}

/// Code that names the shadow or the library without a mark.
fn unmarked(text: &str) -> Vec<&str> {
    let names = ["umbrage_", "Umbrage", "shadow", "Shadow", "UMBRAGE"];
    let code = |line: &&str| is_code(line) && !line.trim_end().ends_with("// shadow");
    text.lines().filter(code).filter(|line| names.iter().any(|name| line.contains(name))).collect()
}

#[test]
fn the_shadow_takes_fewer_than_fifty_lines_beside_the_renderers_own_pass() {
    let files = ["src/lib.rs", "src/scene.rs", "src/main.rs", "src/forward.wgsl"].map(read);
    for text in &files {
        assert_eq!(unmarked(text), [""; 0], "lines for the shadow that are not marked");
    }
    let own: usize = files.iter().map(|text| marked(text)).sum();
    let module = read("src/shadow.rs").lines().filter(is_code).count();
    assert!(own > 10 && module > 20, "{own} marked lines and {module} of shadow.rs: is this still counted?");
    assert!(own + module < 50, "{own} marked lines and {module} of shadow.rs");

    // A line that is not marked would be seen, and so would one that is.
    assert_eq!(unmarked("let at = umbrage_locate(view, p);").len(), 1);
    assert_eq!((marked("a(); // shadow"), marked("// shadow"), marked("a();")), (1, 0, 0));
}

#[test]
fn of_umbrage_it_has_the_core_alone() {
    let manifest = read("Cargo.toml");
    let (_, dependencies) = manifest.split_once("[dependencies]\n").expect("dependencies");
    let names: Vec<&str> = dependencies.lines().filter_map(|line| line.split('.').next()).collect();
    assert_eq!(names, ["bytemuck", "glam", "image", "pollster", "umbrage-core", "wgpu"]);
}
