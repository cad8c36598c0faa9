//! `umbrage truth`: the ray-traced answer.

use crate::args::{QualityArgs, TruthArgs};
use crate::fault::{Fault, say, tell};
use crate::json::{self, SceneJson};
use crate::progress::Progress;
use crate::render::check_output;
use crate::setup::{self, Stage};
use crate::text;
use glam::Vec3;
use serde::Serialize;
use std::sync::Arc;
use std::time::Instant;
use umbrage_measure::picture_of_v;
use umbrage_render::picture::write_png;
use umbrage_render::{GivenVisibility, Gpu, MAX_LIGHTS, Measure, RenderOptions, Renderer, View, deformed};
use umbrage_truth::{Quality, Rays, Surfaces, Visibility};

#[derive(Serialize)]
struct Report {
    scene: SceneJson,
    size: [u32; 2],
    view: &'static str,
    light_index: usize,
    samples: u32,
    seed: u32,
    /// Of the whole truth; `build_s` of it is building the hierarchy.
    seconds: f64,
    build_s: f64,
    rays: u64,
    rays_per_second: f64,
    receivers: usize,
    /// Mean of V* over receivers.
    lit: f64,
    memory_bytes: usize,
    output: String,
    notes: Vec<String>,
    warnings: Vec<String>,
}

/// Of the options.
pub fn quality(args: &QualityArgs) -> Quality {
    Quality { samples: args.samples, seed: args.seed }
}

/// Traces it, writes it, says what it is.
///
/// # Errors
/// Wrong use before anything is loaded, failures as they come. No picture is left behind.
pub fn run(args: &TruthArgs) -> Result<(), Fault> {
    check_output(&args.output)?;
    let stage = setup::stage(&args.scene)?;
    let is_final = args.view == View::Final.id();
    let count = match stage.scene.lights.len() {
        all if is_final => all.min(MAX_LIGHTS),
        all => all,
    };
    if args.light_index >= count {
        return Err(Fault::WrongUse(format!(
            "--light-index {}: there are {count} lights, counted from 0",
            args.light_index
        )));
    }
    let progress = Progress::new()?;
    let start = Instant::now();
    // The bar's share of building is a guess; rays take most of the time in all but the largest scenes.
    stopped(progress.at("building the ray hierarchy", 0.0))?;
    let moved = deformed_scene(args, &stage)?;
    let rays = Rays::new(moved.as_ref().unwrap_or(&stage.scene))?;
    let build_s = start.elapsed().as_secs_f64();
    let surfaces = Surfaces::new(&rays, &stage.camera, stage.size, &|share| {
        progress.at("tracing rays of sight", 0.1 * share)
    })?;
    let lights = if is_final { 0..count } else { args.light_index..args.light_index + 1 };
    let all = lights.len() as f32;
    let traced = lights.enumerate().map(|(i, light)| {
        let at = |share: f32| progress.at("tracing rays to the light", 0.1 + 0.9 * (i as f32 + share) / all);
        Visibility::new(&rays, &surfaces, &stage.scene.lights[light].light, &quality(&args.quality), &at)
    });
    let found = traced.collect::<Result<Vec<_>, _>>()?;
    let seconds = start.elapsed().as_secs_f64();
    let picture = if is_final { final_picture(args, &stage, &found)? } else { picture_of_v(&found[0].v) };
    stopped(progress.at("writing", 1.0))?;
    write_png(&args.output, stage.size.x, stage.size.y, &picture).map_err(Fault::Failed)?;
    drop(progress);
    let shown = &found[if is_final { args.light_index } else { 0 }];
    let traced = surfaces.rays + found.iter().map(|truth| truth.rays).sum::<u64>();
    let report = Report {
        scene: SceneJson::of(&stage.scene),
        size: stage.size.to_array(),
        view: if is_final { View::Final.id() } else { View::Visibility.id() },
        light_index: args.light_index,
        samples: shown.samples,
        seed: args.quality.seed,
        seconds,
        build_s,
        rays: traced,
        rays_per_second: traced as f64 / (seconds - build_s).max(1e-9),
        receivers: shown.receivers(),
        lit: mean_of_receivers(shown),
        memory_bytes: rays.memory_bytes(),
        output: args.output.display().to_string(),
        warnings: stage.scene.warnings,
        notes: stage.notes,
    };
    if !args.quiet {
        report.notes.iter().for_each(|note| tell("note", note));
        report.warnings.iter().for_each(|warning| tell("warning", warning));
    }
    match (args.json, args.quiet) {
        (true, _) => json::print(&report),
        (_, true) => Ok(()),
        _ => say(&describe(&report)),
    }
}

/// The scene as the user's own function leaves it, where there is one.
fn deformed_scene(args: &TruthArgs, stage: &Stage) -> Result<Option<umbrage_scene::Scene>, Fault> {
    if args.scene.deform.is_none() {
        return Ok(None);
    }
    let options = setup::options(&args.scene, stage, setup::settings("unshadowed", &[], None)?)?;
    let gpu = Gpu::new(args.scene.adapter.as_deref())?;
    Ok(Some(deformed(&gpu, &stage.scene, &options)?))
}

fn stopped(flow: std::ops::ControlFlow<()>) -> Result<(), Fault> {
    if flow.is_break() { Err(Fault::Stopped) } else { Ok(()) }
}

fn mean_of_receivers(found: &Visibility) -> f64 {
    let receivers = found.receivers().max(1) as f64;
    let seen = found.place.iter().zip(&found.v).filter(|(p, _)| **p == umbrage_truth::Place::Receiver);
    seen.map(|(_, v)| f64::from(v.x + v.y + v.z) / 3.0).sum::<f64>() / receivers
}

/// The lit scene, V of every light as found.
fn final_picture(args: &TruthArgs, stage: &Stage, found: &[Visibility]) -> Result<Vec<u8>, Fault> {
    let settings = setup::settings("unshadowed", &[], None)?;
    let of_light: Vec<Vec<Vec3>> = found.iter().map(|truth| truth.v.clone()).collect();
    let options = RenderOptions {
        given: Some(Arc::new(GivenVisibility { of_light })),
        ..setup::options(&args.scene, stage, settings)?
    };
    let gpu = Gpu::new(args.scene.adapter.as_deref())?;
    let mut renderer = Renderer::new(&gpu, &stage.scene, &stage.camera, options)?;
    renderer.frame(Measure::Frame)?;
    let pixels = renderer.picture()?;
    gpu.check()?;
    Ok(pixels)
}

fn describe(report: &Report) -> String {
    format!(
        "{}: {} triangles, {} rays in {:.2} s ({:.2} s of it building), {:.1} million a second, {:.0} bytes a triangle\n\
         light {}: {} of {} pixels face it and see {:.1} % of it{}\n\
         {} view of {}x{} pixels written to {}\n",
        report.scene.name,
        text::count(report.scene.triangles),
        text::count(report.rays),
        report.seconds,
        report.build_s,
        report.rays_per_second * 1e-6,
        report.memory_bytes as f64 / report.scene.triangles.max(1) as f64,
        report.light_index,
        text::count(report.receivers as u64),
        text::count(u64::from(report.size[0]) * u64::from(report.size[1])),
        report.lit * 100.0,
        if report.samples > 1 { format!(", {} rays each", report.samples) } else { String::new() },
        report.view,
        report.size[0],
        report.size[1],
        report.output
    )
}
