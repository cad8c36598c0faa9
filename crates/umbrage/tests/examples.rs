//! The examples draw what somebody looked at, and without what they are about they do not. No call of theirs is against wgpu's rules
//! on a device with default limits and no feature. The first shadow takes few lines.

#![allow(clippy::duplicate_mod, reason = "each example has the shared parts as modules of its own")]

#[path = "../examples/animated/main.rs"]
#[allow(dead_code, reason = "its `main` is cargo's")]
mod animated;
#[path = "../../umbrage-render/tests/common/compare.rs"]
mod compare;
#[path = "../examples/custom_filter/main.rs"]
#[allow(dead_code, reason = "its `main` is cargo's")]
mod custom_filter;
#[path = "../examples/hello_shadow/main.rs"]
#[allow(dead_code, reason = "its `main` is cargo's")]
mod hello_shadow;
#[path = "../examples/many_lights/main.rs"]
#[allow(dead_code, reason = "its `main` is cargo's")]
mod many_lights;
#[path = "../examples/wgpu_shadow/main.rs"]
#[allow(dead_code, reason = "its `main` is cargo's")]
mod wgpu_shadow;

use compare::{check, check_differs, differences};
use std::path::Path;

/// A picture: RGBA, as high as it is wide.
pub struct Shot {
    /// Pixels.
    pub side: u32,
    /// Rows, top first.
    pub rgba: Vec<u8>,
}

/// Brightness alone, where smooth shading in three colours would be more bytes than a golden has. Shadows are dark in any case.
fn grey(rgba: &[u8]) -> Vec<u8> {
    let of = |p: &[u8]| ((u16::from(p[0]) + 2 * u16::from(p[1]) + u16::from(p[2])) / 4) as u8;
    rgba.chunks_exact(4).flat_map(|p| [of(p), of(p), of(p), 255]).collect()
}

/// `None`, said loudly, where the software rasteriser is missing; a failure where `UMBRAGE_GOLDEN_REQUIRED=1` says that it must not
/// be.
fn or_skip<T, E: std::fmt::Display>(opened: Result<T, E>) -> Option<T> {
    opened
        .inspect_err(|error| {
            let required = std::env::var("UMBRAGE_GOLDEN_REQUIRED").is_ok_and(|v| v == "1");
            assert!(!required, "UMBRAGE_GOLDEN_REQUIRED=1, but: {error}");
            eprintln!("SKIPPED, no golden was compared: {error}");
        })
        .ok()
}

/// The golden of an example, and the picture that must not pass for it. Each example has the shared parts as modules of its own, so
/// this is no function.
macro_rules! golden {
    ($test:ident, $example:ident :: $Example:ident, $side:literal, $seen:expr, $plain:literal) => {
        #[test]
        fn $test() {
            use $example::support::{Example, Gpu, picture};
            let Some(gpu) = or_skip(Gpu::open(Some("llvmpipe"))) else { return };
            let shoot = |plain| {
                let times_s = $example::$Example::times_s($example::$Example::TIME_S);
                let drawn = picture::<$example::$Example>(&gpu, [$side, $side], plain, &times_s);
                let (rgba, _) = drawn.unwrap_or_else(|why| panic!("{}: {why}", stringify!($test)));
                Shot { side: $side, rgba: $seen(&rgba) }
            };
            let name = format!("example-{}", $example::$Example::NAME);
            check_differs(&name, &shoot(true), $plain);
            check(&name, &shoot(false));
        }
    };
}

golden!(hello_shadow_golden, hello_shadow::Hello, 192, grey, "the scene without casters");
golden!(custom_filter_golden, custom_filter::CustomFilter, 192, grey, "the default kernel on both sides");
golden!(many_lights_golden, many_lights::ManyLights, 160, grey, "the scene without casters");
golden!(animated_golden, animated::Animated, 160, grey, "the scene without casters");
golden!(wgpu_shadow_golden, wgpu_shadow::WgpuShadow, 192, <[u8]>::to_vec, "the scene without casters");

/// Frame by frame, with a technique that is switched on the way, the same comes out as at once.
#[test]
fn what_moved_frame_by_frame_is_where_it_would_be_at_once() {
    use animated::support::{Gpu, picture};
    let Some(gpu) = or_skip(Gpu::open(Some("llvmpipe"))) else { return };
    let shoot = |times_s: &[f32]| {
        picture::<animated::Animated>(&gpu, [192, 192], false, times_s).expect("a picture").0
    };
    let frames: Vec<f32> = (0..=40).map(|i| 0.06 * i as f32).collect();
    let (moved, at_once) = (shoot(&frames), shoot(&frames[40..]));
    // Maps of what moves have room around it, so their texels lie elsewhere: edges of shadows differ.
    let off = differences(&moved, &at_once).len();
    let earlier = differences(&moved, &shoot(&frames[35..36])).len();
    assert!(off < 200 && earlier > 2000, "{off} pixels differ, and {earlier} from 0.3 s before");
}

/// A picture is refused when wgpu had anything to say against how it was drawn.
#[test]
fn what_wgpu_complains_of_is_an_error() {
    use hello_shadow::support::Gpu;
    let Some(gpu) = or_skip(Gpu::open(Some("llvmpipe"))) else { return };
    gpu.check().expect("nothing was done");
    let _ = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: 4,
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::MAP_WRITE,
        mapped_at_creation: false,
    });
    let why = gpu.check().expect_err("a buffer that cannot be").to_string();
    assert!(why.starts_with("wgpu: ") && !why.contains('\n'), "{why}");
    gpu.check().expect("it was said");
}

fn read(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples").join(name);
    std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

fn is_code(line: &&str) -> bool {
    let line = line.trim();
    !line.is_empty() && !line.starts_with("//")
}

fn is_marked(line: &str) -> bool {
    line.trim_end().ends_with("// shadow")
}

/// Lines that are there for the shadow: marked ones.
fn marked(text: &str) -> usize {
    text.lines().filter(is_code).filter(|line| is_marked(line)).count()
}

/// Code that names the library, or what is made by it.
fn naming(text: &str) -> impl Iterator<Item = &str> {
    let names = ["umbrage", "Umbrage", "UMBRAGE", "shadows", "Shadows", "caster", "Caster"];
    text.lines().filter(is_code).filter(move |line| names.iter().any(|name| line.contains(name)))
}

/// The same without a mark.
fn unmarked(text: &str) -> Vec<&str> {
    naming(text).filter(|line| !is_marked(line)).collect()
}

/// Does the table of examples have these numbers of lines?
fn tells(example: &str, [in_rust, in_wgsl]: [usize; 2]) {
    let (table, told) = (read("README.md"), format!("| {in_rust} + {in_wgsl} |"));
    let of_it = format!("[`{example}`]");
    let row =
        table.lines().find(|line| line.contains(&of_it)).unwrap_or_else(|| panic!("no row of {example}"));
    assert!(row.contains(&told), "examples/README.md does not say `{told}` of {example}: {row}");
}

#[test]
fn the_table_tells_how_many_lines_name_the_library() {
    let count = |names: &[&str]| names.iter().map(|name| naming(&read(name)).count()).sum::<usize>();
    let in_support = [count(&["support/forward.rs"]), count(&["support/forward.wgsl"])];
    assert!(in_support[0] > 10);
    tells("support/forward.rs", in_support);
    tells("custom_filter", [count(&["custom_filter/main.rs"]), count(&["custom_filter/ring.wgsl"])]);
    tells("many_lights", [count(&["many_lights/main.rs"]), 0]);
    let animated_wgsl = ["animated/blades.wgsl", "animated/cast.wgsl", "animated/lit.wgsl"];
    tells("animated", [count(&["animated/main.rs", "animated/blades.rs"]), count(&animated_wgsl)]);
    tells("wgpu_shadow", [count(&["wgpu_shadow/main.rs"]), count(&["wgpu_shadow/forward.wgsl"])]);
}

#[test]
fn the_first_shadow_takes_fewer_than_fifty_lines() {
    let [rust, wgsl] = ["hello_shadow/main.rs", "hello_shadow/forward.wgsl"].map(read);
    for text in [&rust, &wgsl] {
        assert_eq!(unmarked(text), [""; 0], "lines for the shadow that are not marked");
    }
    let (in_rust, in_wgsl) = (marked(&rust), marked(&wgsl));
    assert!(in_rust > 10 && in_wgsl > 0, "{in_rust} and {in_wgsl} marked lines: is this still counted?");
    assert!(in_rust + in_wgsl < 50, "{in_rust} marked lines in Rust, {in_wgsl} in WGSL");
    tells("hello_shadow", [in_rust, in_wgsl]);

    // A line that is not marked would be seen, and so would one that is.
    assert_eq!(unmarked("let at = umbrage_visibility(0u, p, n, x);").len(), 1);
    assert_eq!((marked("a(); // shadow"), marked("// shadow"), marked("a();")), (1, 0, 0));
}

/// The page that has wgpu's own example beside ours counts our lines as they are.
#[test]
fn the_page_beside_wgpus_example_counts_our_lines() {
    let page = read("../../../docs/guide/wgpu-shadow.md");
    for (of, file) in [("Rust", "wgpu_shadow/main.rs"), ("WGSL", "wgpu_shadow/forward.wgsl")] {
        let row =
            page.lines().find(|line| line.starts_with(&format!("| the example, {of} |"))).expect("its row");
        let count = read(file).lines().filter(is_code).count();
        assert!(row.ends_with(&format!("| {count} |")), "{file} has {count} lines: {row}");
    }
}

/// Without the marked lines the shader is one that works alone.
#[test]
fn without_its_shadow_the_first_shader_is_whole() {
    let text = read("hello_shadow/forward.wgsl");
    let rest: Vec<&str> = text.lines().filter(|line| !is_marked(line)).collect();
    let module = naga::front::wgsl::parse_str(&rest.join("\n")).expect("WGSL");
    let everything = naga::valid::Capabilities::all();
    naga::valid::Validator::new(naga::valid::ValidationFlags::all(), everything)
        .validate(&module)
        .expect("valid");
    naga::front::wgsl::parse_str(&text).expect_err("the lookup is not in it");
}
