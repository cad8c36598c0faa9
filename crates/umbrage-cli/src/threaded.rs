//! `umbrage bench threaded`: what it brings to draw maps on a thread of their own, and how old shadows get by it.

use crate::args::ThreadedArgs;
use crate::fault::{Fault, say, tell};
use crate::json::{self, Machine, SceneJson};
use crate::setup::{self, Stage};
use crate::text;
use glam::{Mat4, UVec2, Vec3};
use serde::Serialize;
use std::io::{IsTerminal, Write};
use std::time::{Duration, Instant};
use umbrage_render::{FrameReport, Gpu, MapSchedule, Measure, RenderOptions, Renderer};
use umbrage_scene::{Scene, plane_of};

/// Rows are measured in turns of so many seconds, two at least, so that what else the machine does meets all of them.
const TURN_S: f32 = 0.5;
/// Frames of a turn that do not count: drivers compile in the first, and maps are not yet as old as they get.
const WARM_UP: u32 = 4;
/// Pixels, unless others are asked for.
const SIZE: UVec2 = UVec2::new(640, 360);
/// The caster's way around, seconds.
const ROUND_S: f32 = 2.0;

#[derive(Serialize)]
struct Report {
    #[serde(flatten)]
    machine: Machine,
    cores: usize,
    scene: SceneJson,
    size: [u32; 2],
    msaa: u32,
    technique: &'static str,
    maps: usize,
    /// Instance that moves.
    mover: usize,
    interval_ms: f64,
    map_load_ms: f64,
    frame_load_ms: f64,
    seconds: f64,
    rows: Vec<Row>,
    notes: Vec<String>,
    warnings: Vec<String>,
}

#[derive(Serialize)]
struct Row {
    load: &'static str,
    /// `frame`, `interval` or `thread`.
    maps_by: &'static str,
    frames: usize,
    frames_per_s: f64,
    /// From one frame's start to the next one's, median.
    frame_ms: f64,
    frame_ms_max: f64,
    maps_per_s: f64,
    age_frames_mean: f64,
    age_frames_max: u64,
    age_ms_mean: f64,
    age_ms_max: f64,
}

/// A row that is being measured.
struct Running {
    load: &'static str,
    maps_by: &'static str,
    schedule: MapSchedule,
    loads_maps: bool,
    frame_load: Duration,
    elapsed: Duration,
    frames_ms: Vec<f64>,
    reports: Vec<FrameReport>,
}

/// Measures and reports.
///
/// # Errors
/// As `umbrage render`; wrong use for a technique without maps and for scenes in which nothing casts one.
pub fn run(args: &ThreadedArgs) -> Result<(), Fault> {
    setup::settings(&args.technique, &args.set, None)?;
    let mut stage = setup::stage(&args.scene)?;
    if args.scene.size.is_none() {
        // Small, so that a software rasteriser too draws frames at a rate that threads can matter to.
        stage.size = SIZE;
    }
    let settings = setup::settings(&args.technique, &args.set, stage.map_size)?;
    let gpu = Gpu::new(args.scene.adapter.as_deref())?;
    let mover = mover(&stage.scene)
        .ok_or_else(|| Fault::Failed("the scene has nothing that could move; name another".into()))?;
    let renderer = |map_load_ms| -> Result<Renderer<'_>, Fault> {
        let options = RenderOptions { map_load_ms, ..setup::options(&args.scene, &stage, settings.clone())? };
        Ok(Renderer::new(&gpu, &stage.scene, &stage.camera, options)?)
    };
    let mut renderers = [renderer(0.0)?, renderer(args.map_load_ms)?];
    if renderers[0].views().is_empty() {
        let id = settings.technique.id;
        return Err(Fault::WrongUse(format!(
            "--technique: `{id}` draws no map of this scene's lights, so no thread can; use another technique or --light"
        )));
    }
    let warnings: Vec<String> = stage.scene.warnings.iter().chain(renderers[0].warnings()).cloned().collect();
    stage.notes.iter().for_each(|note| tell("note", note));
    warnings.iter().for_each(|warning| tell("warning", warning));

    let mut rows = all_rows(args);
    let progress = std::io::stderr().is_terminal();
    let turns = (args.seconds / TURN_S).ceil().max(2.0);
    let turn = Duration::from_secs_f32(args.seconds / turns);
    let (mut count, all) = (0, turns as usize * rows.len());
    for _ in 0..turns as usize {
        for row in &mut rows {
            count += 1;
            if progress {
                let _ = write!(std::io::stderr(), "\rmeasurement {count} of {all}");
            }
            measure(&mut renderers[usize::from(row.loads_maps)], row, &stage, mover, turn)?;
        }
    }
    if progress {
        let _ = write!(std::io::stderr(), "\r\u{1b}[K");
    }
    gpu.check()?;
    let report = Report {
        machine: Machine::of(&gpu.info),
        cores: std::thread::available_parallelism().map_or(1, usize::from),
        scene: SceneJson::of(&stage.scene),
        size: stage.size.to_array(),
        msaa: args.scene.msaa,
        technique: settings.technique.id,
        maps: renderers[0].views().len(),
        mover,
        interval_ms: json::decimal(args.interval_ms),
        map_load_ms: json::decimal(args.map_load_ms),
        frame_load_ms: json::decimal(args.frame_load_ms),
        seconds: json::decimal(args.seconds),
        rows: rows.iter().map(finished).collect(),
        notes: stage.notes,
        warnings,
    };
    if args.json { json::print(&report) } else { say(&describe(&report)) }
}

/// The instance of the largest mesh that is not flat, or else the largest.
fn mover(scene: &Scene) -> Option<usize> {
    let key = |index: &usize| {
        let instance = &scene.instances[*index];
        let mesh = &scene.meshes[instance.mesh];
        let radius_m = mesh.bounds.transformed(&instance.world_from_object).radius();
        (plane_of(mesh).is_none(), radius_m)
    };
    (0..scene.instances.len()).max_by(|a, b| {
        let ((solid_a, a), (solid_b, b)) = (key(a), key(b));
        solid_a.cmp(&solid_b).then(a.total_cmp(&b))
    })
}

fn all_rows(args: &ThreadedArgs) -> Vec<Running> {
    let interval = Duration::from_secs_f32(args.interval_ms * 1e-3);
    let load = Duration::from_secs_f32(args.frame_load_ms * 1e-3);
    let schedules = [
        ("frame", MapSchedule::EachFrame),
        ("interval", MapSchedule::Every(interval)),
        ("thread", MapSchedule::Threaded(interval)),
    ];
    let loads = [
        ("none", false, Duration::ZERO),
        ("each map", true, Duration::ZERO),
        ("each frame", false, load),
        ("both", true, load),
    ];
    let row = |(load, loads_maps, frame_load), (maps_by, schedule)| Running {
        load,
        maps_by,
        schedule,
        loads_maps,
        frame_load,
        elapsed: Duration::ZERO,
        frames_ms: Vec::new(),
        reports: Vec::new(),
    };
    loads.into_iter().flat_map(|load| schedules.map(|schedule| row(load, schedule))).collect()
}

/// One turn of a row: frame after frame, a caster on its way around.
fn measure(
    renderer: &mut Renderer<'_>,
    row: &mut Running,
    stage: &Stage,
    mover: usize,
    turn: Duration,
) -> Result<(), Fault> {
    let rest = stage.scene.instances[mover].world_from_object;
    let radius_m = 0.05 * stage.scene.bounds().radius();
    renderer.schedule_maps(row.schedule)?;
    let clock = Instant::now();
    let mut frame = || {
        let angle = clock.elapsed().as_secs_f32() / ROUND_S * std::f32::consts::TAU;
        let offset_m = radius_m * Vec3::new(angle.cos(), 0.0, angle.sin());
        renderer.place(mover, Mat4::from_translation(offset_m) * rest)?;
        keep_busy(row.frame_load);
        renderer.frame(Measure::Frame)
    };
    for _ in 0..WARM_UP {
        frame()?;
    }
    let begun = Instant::now();
    let mut start = begun;
    while start - begun < turn {
        row.reports.push(frame()?);
        let end = Instant::now();
        row.frames_ms.push((end - start).as_secs_f64() * 1e3);
        start = end;
    }
    row.elapsed += begun.elapsed();
    renderer.place(mover, rest)?;
    renderer.schedule_maps(MapSchedule::EachFrame)?;
    Ok(())
}

fn keep_busy(time: Duration) {
    let start = Instant::now();
    while start.elapsed() < time {
        std::hint::spin_loop();
    }
}

fn finished(row: &Running) -> Row {
    let (count, seconds) = (row.reports.len(), row.elapsed.as_secs_f64());
    let mean = |of: fn(&FrameReport) -> f64| row.reports.iter().map(of).sum::<f64>() / count.max(1) as f64;
    let maps: u64 = row.reports.iter().map(|report| report.maps_drawn).sum();
    Row {
        load: row.load,
        maps_by: row.maps_by,
        frames: count,
        frames_per_s: count as f64 / seconds,
        frame_ms: json::median(&row.frames_ms),
        frame_ms_max: row.frames_ms.iter().copied().fold(0.0, f64::max),
        maps_per_s: maps as f64 / seconds,
        age_frames_mean: mean(|report| report.maps_age_frames as f64),
        age_frames_max: row.reports.iter().map(|report| report.maps_age_frames).max().unwrap_or(0),
        age_ms_mean: mean(|report| report.maps_age_ms),
        age_ms_max: row.reports.iter().map(|report| report.maps_age_ms).fold(0.0, f64::max),
    }
}

fn describe(report: &Report) -> String {
    let head = [
        "load",
        "maps by",
        "frames/s",
        "median ms",
        "max ms",
        "maps/s",
        "age frames",
        "max",
        "age ms",
        "max",
    ];
    let mut rows: Vec<Vec<String>> = vec![head.map(str::to_owned).to_vec()];
    for row in &report.rows {
        rows.push(vec![
            row.load.to_owned(),
            row.maps_by.to_owned(),
            format!("{:.1}", row.frames_per_s),
            format!("{:.2}", row.frame_ms),
            format!("{:.1}", row.frame_ms_max),
            format!("{:.1}", row.maps_per_s),
            format!("{:.2}", row.age_frames_mean),
            row.age_frames_max.to_string(),
            format!("{:.1}", row.age_ms_mean),
            format!("{:.1}", row.age_ms_max),
        ]);
    }
    format!(
        "{}, {} ({}), {} cores\n{}: {} triangles, {}x{} pixels, `{}`, {} map{}, instance {} moves\n\
         interval {} ms; load {} ms for each map, {} ms for each frame\n\n{}",
        report.machine.adapter,
        report.machine.driver,
        report.machine.backend,
        report.cores,
        report.scene.name,
        text::count(report.scene.triangles),
        report.size[0],
        report.size[1],
        report.technique,
        report.maps,
        if report.maps == 1 { "" } else { "s" },
        report.mover,
        report.interval_ms,
        report.map_load_ms,
        report.frame_load_ms,
        text::table(&rows)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_moves_is_no_floor() {
        let scene = umbrage_scene::load("builtin:torus").expect("built in");
        let index = mover(&scene).expect("something");
        assert!(plane_of(&scene.meshes[scene.instances[index].mesh]).is_none());
        assert_eq!(mover(&Scene::default()), None);
    }
}
