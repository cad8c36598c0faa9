//! `umbrage bench`: what techniques cost, frame by frame in turns.

use crate::args::{BenchArgs, BenchCommand};
use crate::fault::{Fault, say, tell};
use crate::json::{self, Machine, MapFormat, PassJson, SceneJson};
use crate::setup::{self, Stage};
use crate::text;
use serde::Serialize;
use serde_json::{Map, Value};
use std::io::{IsTerminal, Write};
use umbrage_render::umbrage::core::technique::{Settings, TECHNIQUES};
use umbrage_render::{Gpu, Measure, RenderOptions, Renderer};

const UNSHADOWED: &str = "unshadowed";

#[derive(Serialize)]
struct Report {
    #[serde(flatten)]
    machine: Machine,
    scene: SceneJson,
    size: [u32; 2],
    msaa: u32,
    frames: u32,
    techniques: Vec<Row>,
    notes: Vec<String>,
    warnings: Vec<String>,
}

#[derive(Serialize)]
struct Row {
    technique: &'static str,
    params: Map<String, Value>,
    map_format: Option<MapFormat>,
    frame_ms: f64,
    min_ms: f64,
    max_ms: f64,
    /// Median of the differences between each frame and the unshadowed one before it.
    shadow_cost_ms: f64,
    gpu_ms: Option<f64>,
    draws: u64,
    triangles: u64,
    /// Of the outlines that a compute pass finds for volumes.
    silhouette_edges: u64,
    vertices: u64,
    vertex_runs: Option<u64>,
    fragment_runs: Option<u64>,
    shadow_memory_bytes: u64,
    /// Of each light's maps.
    shadow_memory_per_light_bytes: Vec<u64>,
    /// In all timed frames together.
    maps_drawn: u64,
    maps_reused: u64,
    passes: Vec<PassJson>,
    frames_ms: Vec<f64>,
}

/// Measures and reports.
///
/// # Errors
/// As `umbrage render`.
pub fn run(args: &BenchArgs) -> Result<(), Fault> {
    if let Some(BenchCommand::Threaded(args)) = &args.other {
        return crate::threaded::run(args);
    }
    let ids = techniques(&args.techniques);
    all_settings(&ids, args, None)?;
    let stage = setup::stage(&args.scene)?;
    let settings = all_settings(&ids, args, stage.map_size)?;
    let gpu = Gpu::new(args.scene.adapter.as_deref())?;
    let mut renderers = settings
        .iter()
        .map(|settings| renderer(args, &stage, &gpu, settings))
        .collect::<Result<Vec<_>, _>>()?;
    let mut warnings = stage.scene.warnings.clone();
    for warning in renderers.iter().flat_map(|renderer| renderer.warnings()) {
        if !warnings.contains(warning) {
            warnings.push(warning.clone());
        }
    }
    stage.notes.iter().for_each(|note| tell("note", note));
    warnings.iter().for_each(|warning| tell("warning", warning));

    let timed = measure(&mut renderers, args.frames)?;
    let mut rows = Vec::new();
    for ((settings, renderer), timed) in settings.iter().zip(&mut renderers).zip(timed) {
        rows.push(row(settings, renderer, timed)?);
    }
    gpu.check()?;
    let bare = rows.first().map(|row| row.frames_ms.clone()).unwrap_or_default();
    for row in &mut rows {
        // Frame by frame: neighbours in time saw the same machine.
        let costs: Vec<f64> = row.frames_ms.iter().zip(&bare).map(|(with, without)| with - without).collect();
        row.shadow_cost_ms = json::median(&costs);
    }
    let report = Report {
        machine: Machine::of(&gpu.info),
        scene: SceneJson::of(&stage.scene),
        size: stage.size.to_array(),
        msaa: args.scene.msaa,
        frames: args.frames,
        techniques: rows,
        notes: stage.notes,
        warnings,
    };
    if args.json { json::print(&report) } else { say(&describe(&report)) }
}

/// Unshadowed first, then as asked for, each once.
fn techniques(asked: &[String]) -> Vec<&str> {
    let mut ids = vec![UNSHADOWED];
    for id in asked {
        let more: Vec<&str> =
            if id == "all" { TECHNIQUES.iter().map(|t| t.id).collect() } else { vec![id.as_str()] };
        for id in more {
            if !ids.contains(&id) {
                ids.push(id);
            }
        }
    }
    ids
}

fn all_settings(ids: &[&str], args: &BenchArgs, map_size: Option<u32>) -> Result<Vec<Settings>, Fault> {
    // Without a shadow there is nothing to set.
    ids.iter()
        .map(|&id| setup::settings(id, if id == UNSHADOWED { &[] } else { &args.set }, map_size))
        .collect()
}

fn renderer<'a>(
    args: &BenchArgs,
    stage: &Stage,
    gpu: &'a Gpu,
    settings: &Settings,
) -> Result<Renderer<'a>, Fault> {
    let options =
        RenderOptions { reuse: args.reuse, ..setup::options(&args.scene, stage, settings.clone())? };
    Ok(Renderer::new(gpu, &stage.scene, &stage.camera, options)?)
}

/// A technique's frames.
#[derive(Default)]
struct Timed {
    frames_ms: Vec<f64>,
    maps_drawn: u64,
    maps_reused: u64,
}

/// Each technique's frames, in turns.
fn measure(renderers: &mut [Renderer<'_>], frames: u32) -> Result<Vec<Timed>, Fault> {
    let progress = std::io::stderr().is_terminal();
    for renderer in renderers.iter_mut() {
        renderer.frame(Measure::Frame)?; // Drivers compile in the first.
    }
    let mut all: Vec<Timed> = renderers.iter().map(|_| Timed::default()).collect();
    for frame in 0..frames {
        if progress {
            let _ = write!(std::io::stderr(), "\rframe {} of {frames}", frame + 1);
        }
        for (renderer, timed) in renderers.iter_mut().zip(&mut all) {
            let report = renderer.frame(Measure::Frame)?;
            timed.frames_ms.push(report.frame_ms);
            timed.maps_drawn += report.maps_drawn;
            timed.maps_reused += report.maps_reused;
        }
    }
    if progress {
        let _ = write!(std::io::stderr(), "\r\u{1b}[K");
    }
    Ok(all)
}

/// One technique's row. Passes are timed and counted in frames of their own, because that slows them.
fn row(settings: &Settings, renderer: &mut Renderer<'_>, timed: Timed) -> Result<Row, Fault> {
    let frames_ms = timed.frames_ms;
    let mut measured = renderer.frame(Measure::Passes)?.passes;
    for (pass, counted) in measured.iter_mut().zip(renderer.frame(Measure::Counts)?.passes) {
        pass.statistics = counted.statistics;
    }
    let passes: Vec<PassJson> = measured.iter().map(PassJson::from).collect();
    let sum = |of: fn(&PassJson) -> u64| passes.iter().map(of).sum();
    let counted = |of: fn(&json::StatisticsJson) -> u64| {
        passes.iter().map(|pass| pass.statistics.as_ref().map(of)).sum::<Option<u64>>()
    };
    let found = renderer.silhouettes()?;
    let silhouette_edges = found.iter().map(|of| of.silhouette_edges).sum();
    Ok(Row {
        technique: settings.technique.id,
        params: json::params(settings),
        map_format: MapFormat::of_renderer(renderer),
        frame_ms: json::median(&frames_ms),
        min_ms: frames_ms.iter().copied().fold(f64::MAX, f64::min),
        max_ms: frames_ms.iter().copied().fold(0.0, f64::max),
        shadow_cost_ms: 0.0,
        gpu_ms: passes.iter().map(|pass| pass.gpu_ms).sum(),
        draws: sum(|pass| pass.draws),
        triangles: sum(|pass| pass.triangles)
            + if silhouette_edges > 0 { found.iter().map(|of| of.triangles_drawn).sum::<u64>() } else { 0 },
        silhouette_edges,
        vertices: sum(|pass| pass.vertices),
        vertex_runs: counted(|s| s.vertex_runs),
        fragment_runs: counted(|s| s.fragment_runs),
        shadow_memory_bytes: renderer.shadow_memory_bytes(),
        shadow_memory_per_light_bytes: renderer.shadow_memory_of_lights(),
        maps_drawn: timed.maps_drawn,
        maps_reused: timed.maps_reused,
        passes,
        frames_ms,
    })
}

/// Memory of a light's maps; the least and the most where lights differ.
fn per_light(bytes: &[u64]) -> String {
    match (bytes.iter().min(), bytes.iter().max()) {
        (Some(least), Some(most)) if least == most => text::bytes(*most),
        (Some(least), Some(most)) => format!("{}..{}", text::bytes(*least), text::bytes(*most)),
        _ => "-".to_owned(),
    }
}

fn describe(report: &Report) -> String {
    let head = [
        "technique",
        "median ms",
        "min..max",
        "cost ms",
        "passes",
        "draws",
        "triangles",
        "silhouette edges",
        "vertices",
        "vertex runs",
        "fragment runs",
        "map memory",
        "a light",
    ];
    let mut rows: Vec<Vec<String>> = vec![head.map(str::to_owned).to_vec()];
    let runs = |count: Option<u64>| count.map_or_else(|| "-".to_owned(), text::count);
    for row in &report.techniques {
        rows.push(vec![
            row.technique.to_owned(),
            format!("{:.2}", row.frame_ms),
            format!("{:.2}..{:.2}", row.min_ms, row.max_ms),
            if row.technique == UNSHADOWED { "-".to_owned() } else { format!("{:.2}", row.shadow_cost_ms) },
            row.passes.len().to_string(),
            text::count(row.draws),
            text::count(row.triangles),
            text::count(row.silhouette_edges),
            text::count(row.vertices),
            runs(row.vertex_runs),
            runs(row.fragment_runs),
            text::bytes(row.shadow_memory_bytes),
            per_light(&row.shadow_memory_per_light_bytes),
        ]);
    }
    format!(
        "{}, {} ({})\n{}: {} triangles, {}x{} pixels, {} frames of each\n\n{}",
        report.machine.adapter,
        report.machine.driver,
        report.machine.backend,
        report.scene.name,
        text::count(report.scene.triangles),
        report.size[0],
        report.size[1],
        report.frames,
        text::table(&rows)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unshadowed_is_always_first_and_none_is_twice() {
        let asked = |ids: &[&str]| -> Vec<String> {
            let ids: Vec<String> = ids.iter().map(|id| (*id).to_owned()).collect();
            techniques(&ids).iter().map(|id| (*id).to_owned()).collect()
        };
        assert_eq!(asked(&["linear", "linear"]), ["unshadowed", "linear"]);
        assert_eq!(asked(&["hard", "unshadowed"]), ["unshadowed", "hard"]);
        assert_eq!(asked(&["all", "hard"]).len(), TECHNIQUES.len());
    }
}
