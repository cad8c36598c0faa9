//! `umbrage compare`: every technique against the truth.

use crate::again;
use crate::args::CompareArgs;
use crate::fault::{Fault, say, tell};
use crate::json::{self, Machine, SceneJson};
use crate::progress::Progress;
use crate::setup::{self, Stage};
use crate::specs::{Pair, PathSpec, TechniqueSpec};
use crate::text;
use crate::truth::quality;
use glam::{Mat3, Vec3};
use serde::Serialize;
use std::path::PathBuf;
use umbrage_measure::{Cameras, Comparison, Plan, Row, TruthSummary, ViewSummary, compare, report};
use umbrage_render::umbrage::core::Camera;
use umbrage_render::umbrage::core::technique::{Settings, TECHNIQUES};
use umbrage_render::{Gpu, RenderOptions};

/// Where the report goes when nothing is said.
const FOLDER: &str = "report";

#[derive(Serialize)]
struct Report<'a> {
    #[serde(flatten)]
    machine: Machine,
    scene: SceneJson,
    size: [u32; 2],
    frames: u32,
    truth: TruthSummary,
    views: &'a [ViewSummary],
    results: &'a [Row],
    report: Option<String>,
    notes: &'a [String],
    warnings: &'a [String],
}

/// Measures, writes the report, prints the table.
///
/// # Errors
/// Wrong use before anything is loaded, failures as they come. Nothing is left behind.
pub fn run(args: &CompareArgs) -> Result<(), Fault> {
    let specs = techniques(&args.techniques);
    all_settings(&specs, &args.set, None)?;
    let folder = args.output.clone().or_else(|| (!args.json).then(|| PathBuf::from(FOLDER)));
    if let Some(folder) = &folder {
        report::check(folder).map_err(Fault::Failed)?;
    }
    let stage = setup::stage(&args.scene)?;
    if stage.scene.lights.is_empty() {
        return Err(Fault::WrongUse("there is no light to measure".into()));
    }
    let techniques = all_settings(&specs, &args.set, stage.map_size)?;
    let plan = Plan {
        cameras: cameras(args, &stage)?,
        light_numbers: stage.light_numbers.clone(),
        options: RenderOptions { samples: 1, ..setup::options(&args.scene, &stage, techniques[0].clone())? },
        techniques,
        quality: quality(&args.quality),
        frames: args.frames,
    };
    let gpu = Gpu::new(args.scene.adapter.as_deref())?;
    let progress = Progress::new()?;
    let mut measured = compare(&gpu, &stage.scene, &plan, &|label: &str, share| progress.at(label, share))?;
    drop(progress);
    // Rows come by light and camera, and there in the order of the techniques.
    for (row, spec) in measured.rows.iter_mut().zip(specs.iter().cycle()) {
        row.command = command_of(row, spec, args, &plan, stage.light_numbers.len());
    }
    let mut warnings = stage.scene.warnings.clone();
    warnings.append(&mut measured.warnings);
    if let Some(folder) = &folder {
        report::write(folder, &head(&gpu, &stage, &plan, &warnings), &measured)?;
    }
    stage.notes.iter().for_each(|note| tell("note", note));
    warnings.iter().for_each(|warning| tell("warning", warning));
    let report = Report {
        machine: Machine::of(&gpu.info),
        scene: SceneJson::of(&stage.scene),
        size: stage.size.to_array(),
        frames: args.frames,
        truth: measured.truth,
        views: &measured.views,
        results: &measured.rows,
        report: folder.map(|folder| folder.join("index.html").display().to_string()),
        notes: &stage.notes,
        warnings: &warnings,
    };
    if args.json { json::print(&report) } else { say(&describe(&report, &measured)) }
}

/// As asked for, each once.
fn techniques(asked: &[TechniqueSpec]) -> Vec<TechniqueSpec> {
    let mut specs = Vec::new();
    for spec in asked {
        let named = |id: &str| TechniqueSpec { id: id.to_owned(), set: spec.set.clone() };
        let more: Vec<TechniqueSpec> = if spec.id == "all" {
            TECHNIQUES.iter().map(|t| named(t.id)).collect()
        } else {
            vec![spec.clone()]
        };
        more.into_iter().for_each(|spec| {
            if !specs.contains(&spec) {
                specs.push(spec);
            }
        });
    }
    specs
}

/// What of `set` a technique takes, and then what it has of its own, which goes before.
fn taken_by(spec: &TechniqueSpec, set: &[Pair]) -> Result<Vec<Pair>, Fault> {
    let plain = Settings::new(&spec.id, [])?;
    let is_choice = |pair: &Pair| Settings::is_choice(&pair.key);
    let is_own = |pair: &Pair| spec.set.iter().any(|own| own.key == pair.key);
    let shared = set.iter().filter(|pair| !is_own(pair));
    let choices: Vec<Pair> = shared
        .clone()
        .filter(|pair| plain.method.rows().iter().any(|(key, _)| *key == pair.key))
        .chain(spec.set.iter().filter(|pair| is_choice(pair)))
        .cloned()
        .collect();
    // Which parameters there are depends on the choices.
    let chosen = setup::settings(&spec.id, &choices, None)?;
    let has = |pair: &&Pair| choices.contains(pair) || chosen.value(&pair.key).is_some();
    Ok(shared.filter(has).chain(&spec.set).cloned().collect())
}

/// Every technique with its own settings and with what it has of `set`. Each pair of `set` must be a setting of one of them.
fn all_settings(
    specs: &[TechniqueSpec],
    set: &[Pair],
    map_size: Option<u32>,
) -> Result<Vec<Settings>, Fault> {
    let mut taken = vec![false; set.len()];
    let mut settings = Vec::with_capacity(specs.len());
    for spec in specs {
        let pairs = taken_by(spec, set)?;
        set.iter().zip(&mut taken).for_each(|(pair, taken)| {
            *taken |= pairs.iter().any(|other| other.key == pair.key);
        });
        settings.push(setup::settings(&spec.id, &pairs, map_size)?);
    }
    if let Some((pair, _)) = set.iter().zip(&taken).find(|(_, taken)| !**taken) {
        // The same words as for a single technique, with what it has and what is near.
        let last = specs.last().map_or("", |spec| spec.id.as_str());
        setup::settings(last, std::slice::from_ref(pair), None)?;
    }
    Ok(settings)
}

fn cameras(args: &CompareArgs, stage: &Stage) -> Result<Cameras, Fault> {
    if let Some(path) = &args.path {
        let frames = frames_of(path, &stage.camera, stage.scene.bounds().center());
        return Ok(Cameras::Path(format!("path of {} frames", frames.len()), frames));
    }
    let named = |number: usize| {
        let placed = &stage.scene.cameras[number];
        let name = if placed.name.is_empty() { format!("camera {number}") } else { placed.name.clone() };
        (name, placed.camera)
    };
    match args.cameras.as_slice() {
        [] => Ok(Cameras::Each(vec![("camera".to_owned(), stage.camera)])),
        [all] if all == "all" => Ok(Cameras::Each((0..stage.scene.cameras.len()).map(named).collect())),
        names => {
            let find = |name: &String| {
                setup::camera_of_scene(&stage.scene, name).map(|camera| (name.clone(), camera))
            };
            Ok(Cameras::Each(names.iter().map(find).collect::<Result<_, _>>()?))
        }
    }
}

/// The cameras of a path, first to last.
fn frames_of(path: &PathSpec, camera: &Camera, middle: Vec3) -> Vec<Camera> {
    let frame = |i: u32| {
        let share = i as f32 / (path.frames - 1) as f32;
        let turn = Mat3::from_rotation_y((path.turn_deg * share).to_radians());
        Camera {
            position_world: middle + turn * (camera.position_world - middle) + path.move_m * share,
            direction_world: turn * camera.direction_world,
            up_world: turn * camera.up_world,
            ..*camera
        }
    };
    (0..path.frames).map(frame).collect()
}

/// What draws a row's picture again.
fn command_of(row: &Row, spec: &TechniqueSpec, args: &CompareArgs, plan: &Plan, lights: usize) -> String {
    let mut words: Vec<String> = vec!["umbrage".into(), "render".into()];
    words.extend(again::scene_words());
    words.extend(["--technique".to_owned(), row.technique.to_owned()]);
    for pair in taken_by(spec, &args.set).unwrap_or_default() {
        words.extend(["--set".to_owned(), format!("{}={}", pair.key, pair.value)]);
    }
    if lights > 1 || !args.scene.lights.is_empty() {
        words.extend(["--lights".to_owned(), row.light.to_string()]);
    }
    match &plan.cameras {
        Cameras::Path(_, frames) => {
            words.extend(["--camera".to_owned(), again::camera_spec(&frames[frames.len() / 2])]);
        }
        Cameras::Each(_) if !args.cameras.is_empty() => {
            words.extend(["--camera".to_owned(), row.camera.clone()]);
        }
        Cameras::Each(_) => {}
    }
    words.extend(["-o".to_owned(), format!("{}.png", row.technique)]);
    again::typed(&words)
}

fn head(gpu: &Gpu, stage: &Stage, plan: &Plan, warnings: &[String]) -> report::Head {
    let machine = Machine::of(&gpu.info);
    let scene = serde_json::to_value(SceneJson::of(&stage.scene));
    report::Head {
        title: stage.scene.name.clone(),
        command: again::whole(),
        adapter: machine.adapter,
        driver: machine.driver,
        backend: machine.backend,
        version: env!("CARGO_PKG_VERSION"),
        scene: scene.ok().and_then(|v| v.as_object().cloned()).unwrap_or_default(),
        size: stage.size.to_array(),
        frames: plan.frames,
        warnings: stage.notes.iter().chain(warnings).cloned().collect(),
    }
}

/// A share in percent with three digits; nothing above 0 reads as 0.
fn percent(share: f64) -> String {
    match share * 100.0 {
        0.0 => "0".into(),
        x if x < 0.001 => "<0.001".into(),
        x if x < 1.0 => format!("{x:.3}"),
        x => format!("{x:.2}"),
    }
}

fn describe(report: &Report<'_>, measured: &Comparison) -> String {
    let truth = &report.truth;
    let mut out = format!(
        "{}, {} ({})\n{}: {} triangles, {}x{} pixels; truth: {} rays in {:.2} s, {} pixels left out\n",
        report.machine.adapter,
        report.machine.driver,
        report.machine.backend,
        report.scene.name,
        text::count(report.scene.triangles),
        report.size[0],
        report.size[1],
        text::count(truth.rays),
        truth.seconds,
        text::count(truth.excluded_pixels),
    );
    let head = [
        "technique",
        "false shadow %",
        "false light %",
        "rmse",
        "acne %",
        "leak %",
        "edge",
        "band %",
        "gap m",
        "gap texels",
        "penumbra",
        "flicker",
        "flip",
        "cost ms",
        "memory",
    ];
    let optional = |x: Option<f64>| x.map_or_else(|| "-".to_owned(), |x| format!("{x:.4}"));
    for view in &measured.views {
        let mut rows: Vec<Vec<String>> = vec![head.map(str::to_owned).to_vec()];
        for row in measured.rows.iter().filter(|row| row.view == view.id) {
            rows.push(vec![
                row.technique.to_owned(),
                percent(row.errors.false_shadow),
                percent(row.errors.false_light),
                format!("{:.4}", row.errors.rmse),
                percent(row.errors.acne),
                percent(row.errors.leak),
                format!("{:.4}", row.errors.edge),
                percent(row.errors.band),
                optional(row.gap_m),
                row.gap_texel.map_or_else(|| "-".to_owned(), |x| format!("{x:.2}")),
                optional(row.penumbra),
                optional(row.flicker),
                format!("{:.4}", row.flip),
                format!("{:.2}", row.cost.cost_ms),
                text::bytes(row.cost.memory_bytes),
            ]);
        }
        let receivers = text::count(view.receivers as u64);
        out += &format!("\n{}, {}: {receivers} receivers\n{}", view.camera, view.light, text::table(&rows));
    }
    if let Some(page) = &report.report {
        out += &format!("\nThe report is {page}\n");
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair(key: &str, value: &str) -> Pair {
        Pair { key: key.into(), value: value.into() }
    }

    #[test]
    fn what_is_set_goes_where_it_fits() {
        let ids = ["unshadowed", "linear", "matrix-bias"].map(spec);
        let set = [pair("map_size", "64"), pair("matrix_bias", "0.25")];
        let settings = all_settings(&ids, &set, None).expect("valid");
        let value = |i: usize, name: &str| settings[i].value(name);
        assert_eq!(
            [value(0, "map_size"), value(1, "map_size"), value(2, "map_size")],
            [None, Some(64.0), Some(64.0)]
        );
        assert_eq!([value(1, "matrix_bias"), value(2, "matrix_bias")], [None, Some(0.25)]);
        assert!(all_settings(&ids, &[pair("mapsize", "64")], None).is_err());
        assert!(all_settings(&ids, &[pair("map_size", "0")], None).is_err());
    }

    fn spec(text: &str) -> TechniqueSpec {
        crate::specs::technique(text).expect("valid")
    }

    #[test]
    fn a_technique_has_settings_of_its_own() {
        let specs = ["linear", "linear:bias=slope:map_size=32", "pcf:width=9"].map(spec);
        assert_eq!(techniques(&[specs.as_slice(), &specs].concat()), specs);
        let set = [pair("map_size", "64"), pair("bias", "normal"), pair("normal_offset", "2")];
        let settings = all_settings(&specs, &set, None).expect("valid");
        let value = |name: &str| [0, 1, 2].map(|i: usize| settings[i].value(name));
        assert_eq!(value("map_size"), [Some(64.0), Some(32.0), Some(64.0)]);
        assert_eq!(value("normal_offset"), [Some(2.0), None, Some(2.0)]);
        assert_eq!(value("width"), [None, None, Some(9.0)]);
        let refused = |text: &str| match all_settings(&[spec(text)], &[], None) {
            Err(Fault::WrongUse(message)) => message,
            other => panic!("{text} must be wrong use, not {other:?}"),
        };
        assert!(refused("linear:widht=3").contains("`linear` has no setting `widht`"));
        assert!(refused("pcf:width=99").contains("from 1 to 17"));
        assert!(refused("pcf:width=3:width=5").contains("twice"));
        let unread = |text: &str| crate::specs::technique(text).expect_err("must be refused");
        assert!(unread("liner:bias=none").contains("did you mean `linear`?"));
        assert!(
            unread("linear:bias").contains("is not key=value") && unread("linear:").contains("key=value")
        );
        assert!(
            all_settings(&techniques(&[spec("all:map_size=64")]), &[], None).is_err(),
            "unshadowed has no map"
        );
    }

    #[test]
    fn a_path_begins_at_the_camera_and_ends_turned_and_moved() {
        let camera = Camera::look_at(Vec3::new(0.0, 1.0, 5.0), Vec3::ZERO, 1.0, 0.1, 9.0);
        let path = PathSpec { frames: 3, turn_deg: 90.0, move_m: Vec3::Y };
        let frames = frames_of(&path, &camera, Vec3::ZERO);
        assert_eq!((frames.len(), frames[0]), (3, camera));
        assert!((frames[2].position_world - Vec3::new(5.0, 2.0, 0.0)).length() < 1e-5);
        assert!((frames[2].direction_world.x + camera.direction_world.length()).abs() < 0.1);
    }

    #[test]
    fn nothing_above_0_reads_as_0() {
        assert_eq!([0.0, 1e-9, 0.00012, 0.25].map(percent), ["0", "<0.001", "0.012", "25.00"]);
    }
}
