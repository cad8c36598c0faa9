//! What rays through a scene take in memory, while they are built too. Alone in its process, because it asks the system.

#![cfg(target_os = "linux")]

use umbrage_truth::Rays;

/// A line of `/proc/self/status`, bytes.
fn status(key: &str) -> u64 {
    let text = std::fs::read_to_string("/proc/self/status").expect("procfs");
    let line = text.lines().find_map(|line| line.strip_prefix(key)).expect("a known key");
    line.trim_start_matches(':').trim().trim_end_matches(" kB").parse::<u64>().expect("a number") * 1024
}

#[test]
fn a_triangle_takes_less_than_200_bytes_even_while_the_hierarchy_is_built() {
    let scene = umbrage_scene::load("builtin:knots").expect("built in");
    let before = status("VmRSS");
    if std::fs::write("/proc/self/clear_refs", "5").is_err() {
        eprintln!("SKIPPED: the system does not let the greatest use be measured");
        return;
    }
    let rays = Rays::new(&scene).expect("rays");
    let triangles = rays.triangle_count() as u64;
    let (most, kept) = (status("VmHWM") - before, rays.memory_bytes() as u64);
    println!("{triangles} triangles: {} bytes each at most, {} kept", most / triangles, kept / triangles);
    assert!(triangles > 500_000 && most < 200 * triangles && kept < 100 * triangles, "{most} {kept}");
}
