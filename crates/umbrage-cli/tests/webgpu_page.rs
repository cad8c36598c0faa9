//! The library alone: a page of somebody else's that has only our WGSL, drawn by a browser; and every module in its compiler.
//!
//! Needs a browser with WebGPU. Where it lacks the tests say so on standard error, and fail when
//! `UMBRAGE_BROWSER_REQUIRED=1`.

mod browser;
mod oracle;

use browser::{Browser, Folder, TEMPORARY};
use oracle::{Scene, Sight};
use serde_json::json;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;
use umbrage_render::umbrage::core::technique::Combination;
use umbrage_render::umbrage::core::wgsl::{MODULES, assemble};

/// Where the page has the library's text, after the command that prints it.
const FROM: &str = "<!-- The library: what `umbrage wgsl ";
const BEGIN: &str = "<script type=\"text/wgsl\" id=\"library\">\n";
const END: &str = "</script>\n";

/// The line of the page that looks the map up.
const LOOKUP: &str = "v = umbrage_filter_linear(map, point, frame.shadow, at);";

fn page() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/guide/webgpu.html");
    std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

fn printed(modules: &[&str]) -> String {
    let said = Command::new(env!("CARGO_BIN_EXE_umbrage")).arg("wgsl").args(modules).output();
    let said = said.expect("the command starts");
    assert!(said.status.success(), "{}", String::from_utf8_lossy(&said.stderr));
    String::from_utf8(said.stdout).expect("text")
}

/// The page's text with one thing in it changed.
#[track_caller]
fn changed(page: &str, from: &str, to: &str) -> String {
    assert_eq!(page.matches(from).count(), 1, "the page has no `{from}`");
    page.replace(from, to)
}

/// A browser with WebGPU that has a page open. The browser goes before the folder that it reads.
struct Open {
    browser: Browser,
    folder: Folder,
}

impl Open {
    /// None where something lacks, which is said.
    fn new(name: &str, text: &str) -> Option<Self> {
        let program = browser::find()?;
        let folder = Folder::new(name);
        let file = Self::write(&folder, text);
        let browser = Browser::start_with_webgpu(&program, &folder.0.join("profile"), &file)?;
        Some(Self { browser, folder })
    }

    fn write(folder: &Folder, text: &str) -> PathBuf {
        let file = folder.0.join("page.html");
        std::fs::write(&file, text).expect("the page is written");
        file
    }

    /// Opens another page in the same browser.
    fn open(&mut self, text: &str) {
        self.browser.open(&Self::write(&self.folder, text));
    }

    /// What the page's canvas shows when it is drawn, and what the page says.
    fn drawn(&mut self) -> (image::RgbImage, Vec<String>) {
        self.browser.value("ready");
        let noise = self.browser.noise().to_vec();
        let place = "(({ x, y, width, height }) => [x, y, width, height])(canvas.getBoundingClientRect())";
        let place: [u32; 4] = serde_json::from_value(self.browser.value(place)).expect("whole pixels");
        let picture = image::load_from_memory(&self.browser.picture()).expect("a PNG").to_rgb8();
        let [x, y, width, height] = place;
        (image::imageops::crop_imm(&picture, x, y, width, height).to_image(), noise)
    }
}

/// The page's scene, as its own variables hold it.
fn scene(browser: &mut Browser) -> Scene {
    Scene::new(browser.value("({ eye, light, boxes, torus })"))
}

/// Pixels that are lit or shadowed wherever in them and around them one looks, with what they are.
fn sure(scene: &Scene, (width, height): (u32, u32)) -> Vec<(u32, u32, bool)> {
    let around = [(0.0, 0.0), (-2.5, -2.5), (2.5, -2.5), (-2.5, 2.5), (2.5, 2.5)];
    let places = (0..height).step_by(4).flat_map(|y| (0..width).step_by(4).map(move |x| (x, y)));
    let judge = |(x, y): (u32, u32)| {
        let at = |(right, down): (f64, f64)| {
            let (x, y) = (f64::from(x) + 0.5 + right, f64::from(y) + 0.5 + down);
            scene.sight(x, y, f64::from(width), f64::from(height))
        };
        let sight = at(around[0]);
        let same = around.iter().all(|place| at(*place) == sight);
        match sight {
            Sight::Lit(_) if same => Some((x, y, true)),
            Sight::Shadow(_) if same => Some((x, y, false)),
            _ => None,
        }
    };
    places.filter_map(judge).collect()
}

/// Of the sure pixels, those that are not what rays say. What is shadowed is darker than the same page without its lookup.
fn wrong(
    sure: &[(u32, u32, bool)],
    picture: &image::RgbImage,
    unshadowed: &image::RgbImage,
) -> Vec<(u32, u32, bool)> {
    let brightness = |image: &image::RgbImage, x, y| {
        image.get_pixel(x, y).0.iter().map(|channel| f64::from(*channel)).sum::<f64>()
    };
    let is_lit = |x, y| brightness(picture, x, y) > 0.93 * brightness(unshadowed, x, y);
    sure.iter().filter(|(x, y, lit)| is_lit(*x, *y) != *lit).copied().collect()
}

#[test]
fn the_page_holds_what_the_command_prints_in_under_a_hundred_lines_of_its_own() {
    let page = page();
    let (_, rest) = page.split_once(FROM).expect("the command");
    let (modules, rest) = rest.split_once('`').expect("the command's end");
    let (_, rest) = rest.split_once(BEGIN).expect("the library");
    let (library, _) = rest.split_once(END).expect("the library's end");
    let modules: Vec<&str> = modules.split(' ').collect();
    assert!(
        library == printed(&modules),
        "docs/guide/webgpu.html: between its script's tags is not what `umbrage wgsl {}` prints; paste it there",
        modules.join(" ")
    );
    let own = page.lines().count() - library.lines().count();
    assert!(own < 100, "the page has {own} lines of its own");
}

#[test]
fn the_page_has_shadow_where_rays_say() {
    let page = page();
    let off = changed(&page, LOOKUP, &LOOKUP.replace("v = ", "v = 1.0 + 0.0 * "));
    let Some(mut open) = Open::new("webgpu", &off) else { return };
    let (unshadowed, noise) = open.drawn();
    assert_eq!(noise, [""; 0], "without the lookup");

    open.open(&page);
    let (picture, noise) = open.drawn();
    assert_eq!(noise, [""; 0], "the page is to say nothing and to ask for nothing");
    let file = Path::new(TEMPORARY).join("webgpu.png");
    picture.save(&file).expect("the picture is written");
    assert_eq!(picture.dimensions(), unshadowed.dimensions());

    let sure = sure(&scene(&mut open.browser), picture.dimensions());
    let shadowed = sure.iter().filter(|(_, _, lit)| !lit).count();
    let lit = sure.len() - shadowed;
    assert!(
        shadowed >= 300 && lit >= 1000,
        "only {shadowed} pixels with shadow and {lit} with light are asked"
    );
    let off = wrong(&sure, &picture, &unshadowed);
    assert_eq!(off, [], "not as rays say, of {}: x, y, lit? {}", sure.len(), file.display());

    // Without the lookup, all that is shadowed is wrong: the comparison sees it.
    assert_eq!(wrong(&sure, &unshadowed, &unshadowed).len(), shadowed);

    // A mistake in the use of WebGPU would have been heard.
    open.open(&changed(&page, "arrayStride: 36", "arrayStride: 35"));
    let (_, noise) = open.drawn();
    assert!(noise.iter().any(|line| line.contains("35")), "{noise:?}");
}

#[test]
fn a_browser_without_webgpu_says_so() {
    let Some(program) = browser::find() else { return };
    let folder = Folder::new("without webgpu");
    let file = Open::write(&folder, &changed(&page(), "navigator.gpu?.requestAdapter()", "null"));
    let mut browser = Browser::start(&program, &folder.0.join("profile"));
    browser.open(&file);
    browser.value("ready");
    let said = browser.value("document.getElementById('said').textContent");
    assert!(said.as_str().unwrap_or_default().contains("no WebGPU"), "{said}");
}

/// What the browser's compiler says of texts: name, message.
fn messages(browser: &mut Browser, texts: &[(&str, String)]) -> Vec<(String, String)> {
    let expression = format!(
        "(async () => {{
            const device = await (await navigator.gpu.requestAdapter()).requestDevice(), said = [];
            device.onuncapturederror = () => {{}};
            for (const [name, code] of {}) {{
                device.pushErrorScope('validation');
                const module = device.createShaderModule({{ code }});
                for (const {{ type, lineNum, message }} of (await module.getCompilationInfo()).messages)
                    said.push([name, `${{type}}: ${{lineNum}}: ${{message}}`]);
                const targets = [{{ format: 'rgba8unorm' }}], layout = 'auto';
                const made = code.includes('@fragment')
                    ? device.createRenderPipelineAsync({{ layout, vertex: {{ module }}, fragment: {{ module, targets }} }})
                    : device.createComputePipelineAsync({{ layout, compute: {{ module }} }});
                await made.catch((e) => said.push([name, e.message]));
                const error = await device.popErrorScope();
                if (error) said.push([name, error.message]);
            }}
            return said;
        }})()",
        json!(texts)
    );
    serde_json::from_value(browser.value(&expression)).expect("pairs of texts")
}

#[test]
fn every_module_compiles_alone_in_a_browser() {
    let Some(mut open) = Open::new("modules", "<!doctype html><title>modules</title>") else { return };
    let entry = "\n@compute @workgroup_size(1) fn alone() {}\n";
    let texts: Vec<_> = MODULES.iter().map(|m| (m.name, printed(&[m.name]) + entry)).collect();
    assert!(texts.len() > 20, "only {} modules", texts.len());
    assert_eq!(messages(&mut open.browser, &texts), [], "module, message");

    // What is wrong in a module, in a function that nothing calls, is seen.
    let broken = texts[0].1.clone() + "fn umbrage_broken() -> f32 { return 1u; }\n";
    let said = messages(&mut open.browser, &[("broken", broken)]);
    assert!(said.iter().any(|(_, message)| message.starts_with("error")), "{said:?}");
}

/// A pipeline's text that looks a map up as a combination does.
fn lookup(combination: &Combination) -> String {
    let hardware = combination.compares_in_hardware();
    let (map, sampler) =
        if hardware { ("texture_depth_2d_array", "sampler_comparison") } else { ("UmbrageMap", "sampler") };
    let (more, maps, v) = if combination.colors_light() {
        let more = "@group(0) @binding(3) var translucent: UmbrageMap;
            @group(0) @binding(4) var colors: UmbrageColorMap;";
        (more, "map, translucent, colors", "1.0")
    } else {
        ("", "map", "0.0, 0.0, 1.0")
    };
    let (library, filter) =
        (assemble(&combination.modules()).expect("modules of a choice"), combination.filter_function());
    format!(
        "{library}
        @group(0) @binding(0) var<uniform> view: UmbrageView;
        @group(0) @binding(1) var map: {map};
        @group(0) @binding(2) var point: {sampler};
        {more}
        @vertex fn corner() -> @builtin(position) vec4f {{ return vec4f(0.0); }}
        @fragment fn pixel(@builtin(position) p: vec4f) -> @location(0) vec4f {{
            let at = umbrage_locate(view, p.xyz, cross(dpdx(p.xyz), dpdy(p.xyz)));
            if at.inside {{ return vec4f({filter}({maps}, point, view, at), {v}); }}
            return vec4f(0.0);
        }}"
    )
}

#[test]
fn every_way_of_looking_a_map_up_makes_a_pipeline_in_a_browser() {
    let Some(mut open) = Open::new("lookups", "<!doctype html><title>lookups</title>") else { return };
    let valid = Combination::all().filter(|combination| combination.objection().is_none());
    let texts: BTreeMap<String, Combination> = valid.map(|c| (lookup(&c), c)).collect();
    assert!(texts.len() > 50, "only {} lookups", texts.len());
    let names: Vec<(String, &String)> =
        texts.iter().map(|(text, c)| (c.rows().map(|row| row.id).join(" "), text)).collect();
    let named: Vec<(&str, String)> =
        names.iter().map(|(name, text)| (name.as_str(), (*text).clone())).collect();
    assert_eq!(messages(&mut open.browser, &named), [], "lookup, message");

    // What only a pipeline can tell is seen: a module may have two entry points that do not fit together.
    let broken = named[0].1.replace("@builtin(position) p: vec4f)", "@location(7) p: vec4f)");
    assert_ne!(messages(&mut open.browser, &[("broken", broken)]), []);
}
