//! `umbrage render`: one picture.

use crate::args::RenderArgs;
use crate::fault::{Fault, say, tell};
use crate::json::{
    self, DensityJson, Machine, MapFormat, OverdrawJson, PassJson, RenderJson, SceneJson, Timings,
};
use crate::setup::{self, Stage};
use crate::text;
use std::path::Path;
use std::time::Instant;
use umbrage_render::picture::write_png;
use umbrage_render::{
    DensityStatistics, FrameReport, Gpu, Measure, OverdrawPart, OverdrawStatistics, PassReport,
    RenderOptions, Renderer, View,
};

/// Draws it, writes it, says what it is.
///
/// # Errors
/// Wrong use before anything is loaded, failures as they come. No picture is left behind.
pub fn run(args: &RenderArgs) -> Result<(), Fault> {
    setup::settings(&args.technique, &args.set, None)?;
    let view = View::ALL.into_iter().find(|view| view.id() == args.view).unwrap_or(View::Final);
    check_output(&args.output)?;
    let stage = setup::stage(&args.scene)?;
    let settings = setup::settings(&args.technique, &args.set, stage.map_size)?;
    let options = RenderOptions {
        view,
        shown_light: args.light_index,
        reuse: args.reuse,
        ..setup::options(&args.scene, &stage, settings)?
    };

    let start = Instant::now();
    let gpu = Gpu::new(args.scene.adapter.as_deref())?;
    let mut renderer = Renderer::new(&gpu, &stage.scene, &stage.camera, options)?;
    let setup_ms = ms_since(start);
    let drawn = draw(&mut renderer, args.frames, args.statistics)?;
    let pixels = renderer.picture()?;
    gpu.check()?;

    let start = Instant::now();
    write_png(&args.output, stage.size.x, stage.size.y, &pixels).map_err(Fault::Failed)?;
    let write_ms = ms_since(start);
    let warnings: Vec<String> = stage.scene.warnings.iter().chain(renderer.warnings()).cloned().collect();
    if !args.quiet {
        stage.notes.iter().for_each(|note| tell("note", note));
        warnings.iter().for_each(|warning| tell("warning", warning));
    }
    if args.json {
        let report = report(args, &stage, &gpu, &renderer, &drawn, warnings, [setup_ms, write_ms]);
        return json::print(&report);
    }
    if args.quiet { Ok(()) } else { say(&summary(args, &stage, &gpu, &renderer, &drawn)) }
}

fn ms_since(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}

/// What was drawn, and how long it took.
struct Drawn {
    /// One for each frame that counts.
    frames_ms: Vec<f64>,
    /// Of one frame, with all that could be measured of it.
    passes: Vec<PassReport>,
    /// In all frames together.
    maps_drawn: u64,
    maps_reused: u64,
    /// Texels per pixel, in the views that show them; `None` inside where no receiver is seen.
    density: Option<Option<DensityStatistics>>,
    /// Faces of volumes per pixel, in the view that shows them.
    overdraw: Option<OverdrawStatistics>,
}

/// The frames; the first is dropped when there are several, because drivers compile then. Passes are measured in a frame
/// of their own, because that takes time too; a single frame has to do for both.
fn draw(renderer: &mut Renderer<'_>, count: u32, statistics: bool) -> Result<Drawn, Fault> {
    let frames = if count > 1 { count } else { 0 };
    let mut frames_ms = Vec::new();
    let (mut maps_drawn, mut maps_reused) = (0, 0);
    let mut frame = |measure| -> Result<FrameReport, Fault> {
        let report = renderer.frame(measure)?;
        maps_drawn += report.maps_drawn;
        maps_reused += report.maps_reused;
        Ok(report)
    };
    for _ in 0..frames {
        frames_ms.push(frame(Measure::Frame)?.frame_ms);
    }
    let measured = frame(Measure::Passes)?;
    if frames_ms.is_empty() {
        frames_ms.push(measured.frame_ms);
    } else {
        frames_ms.remove(0);
    }
    let mut passes = measured.passes;
    if statistics {
        let counted = frame(Measure::Counts)?.passes;
        for pass in &mut passes {
            // By name: a map that is reused has no pass any more.
            let same = counted.iter().find(|other| other.name == pass.name);
            pass.statistics = same.and_then(|other| other.statistics);
        }
    }
    let shows_density = renderer.options().view.is_density();
    let density = if shows_density { Some(renderer.density_statistics()?) } else { None };
    let shows_overdraw = renderer.options().view == View::Volumes;
    let overdraw = shows_overdraw.then(|| renderer.overdraw_statistics()).transpose()?;
    Ok(Drawn { frames_ms, passes, maps_drawn, maps_reused, density, overdraw })
}

/// Can the picture be written there? Asked before any work.
pub fn check_output(path: &Path) -> Result<(), Fault> {
    check_file(path, "png", "pictures are PNG")
}

/// Can a file with this ending be written there? `what` says what it holds.
pub fn check_file(path: &Path, wanted: &str, what: &str) -> Result<(), Fault> {
    let failed = |reason: &str| Fault::Failed(format!("cannot write {}: {reason}", path.display()));
    if path.is_dir() {
        return Err(failed(&format!("it is a folder; name a .{wanted} file in it")));
    }
    if path.file_name().is_none() {
        return Err(Fault::WrongUse(format!("--output: `{}` names no file", path.display())));
    }
    if let Some(ending) = path.extension().filter(|ending| !ending.eq_ignore_ascii_case(wanted)) {
        let ending = ending.to_string_lossy();
        return Err(Fault::WrongUse(format!(
            "--output: {what}; let the name end in .{wanted}, not .{ending}"
        )));
    }
    if path.exists() && !path.is_file() {
        return Ok(()); // A device or a pipe.
    }
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if !folder.is_dir() {
        return Err(failed("its folder does not exist, make it or name another"));
    }
    let probe = folder.join(format!(".umbrage.{}.probe", std::process::id()));
    std::fs::write(&probe, []).and_then(|()| std::fs::remove_file(&probe)).map_err(|e| {
        let _ = std::fs::remove_file(&probe);
        failed(&format!("{e}; choose a folder that you may write to"))
    })
}

fn report(
    args: &RenderArgs,
    stage: &Stage,
    gpu: &Gpu,
    renderer: &Renderer<'_>,
    drawn: &Drawn,
    warnings: Vec<String>,
    [setup_ms, write_ms]: [f64; 2],
) -> RenderJson {
    let options = renderer.options();
    let frame_ms = json::median(&drawn.frames_ms);
    RenderJson {
        machine: Machine::of(&gpu.info),
        scene: SceneJson::of(&stage.scene),
        technique: options.settings.technique.id,
        params: json::params(&options.settings),
        map_format: MapFormat::of_renderer(renderer),
        size: options.size.to_array(),
        msaa: options.samples,
        view: options.view.id(),
        light_index: options.shown_light,
        passes: drawn.passes.iter().map(PassJson::from).collect(),
        frame_ms,
        frames_ms: drawn.frames_ms.clone(),
        shadow_memory_bytes: renderer.shadow_memory_bytes(),
        shadow_memory_per_light_bytes: renderer.shadow_memory_of_lights(),
        maps_drawn: drawn.maps_drawn,
        maps_reused: drawn.maps_reused,
        exposure: json::decimal(renderer.exposure()),
        density: drawn.density.as_ref().map(|found| DensityJson::of(options.view, found.as_ref())),
        overdraw: drawn.overdraw.as_ref().map(OverdrawJson::from),
        timings: Timings { load_ms: stage.load_ms, setup_ms, frame_ms, write_ms },
        output: args.output.display().to_string(),
        notes: stage.notes.clone(),
        warnings,
    }
}

/// Texels per pixel for people; the numbers are in `--json`.
fn density_sentence(view: View, found: Option<&DensityStatistics>) -> String {
    let Some(found) = found else {
        return "texels per pixel: no surface that the light could reach is in sight\n".to_owned();
    };
    let [mean, hundredth, worst] =
        [found.mean.mean, found.mean.percentiles[0], found.worst_direction.percentiles[0]].map(text::rough);
    let (counted, seen) = match view {
        View::DensityLight => {
            ("texels", format!("; the eye sees {} % of the map", text::rough(100.0 * found.share)))
        }
        _ => ("pixels", String::new()),
    };
    format!(
        "texels per pixel: {mean} in the mean, 1 % of the {counted} below {hundredth}, along the worst direction below \
         {worst}{seen}\n"
    )
}

/// Faces of volumes per pixel for people.
fn overdraw_sentence(found: &OverdrawStatistics) -> String {
    let mean =
        |part: Option<&OverdrawPart>| part.map_or("none".to_owned(), |part| format!("{:.1}", part.mean));
    format!(
        "faces of volumes per pixel: {} in the mean (lit {}, in shadow {}), {} at most; the deepest count is {}, a stencil holds 255\n",
        mean(Some(&found.picture)),
        mean(found.lit.as_ref()),
        mean(found.shadow.as_ref()),
        found.picture.most,
        found.deepest_count
    )
}

fn summary(args: &RenderArgs, stage: &Stage, gpu: &Gpu, renderer: &Renderer<'_>, drawn: &Drawn) -> String {
    let options = renderer.options();
    let maps = match renderer.map_format() {
        Some(format) => {
            let size = options.settings.map_size_texel();
            format!(
                " ({} map{} {size}x{size} {})",
                renderer.views().len(),
                if renderer.views().len() == 1 { "" } else { "s" },
                format.storage.row().id
            )
        }
        None => String::new(),
    };
    let time = match drawn.frames_ms.len() {
        // The driver compiles shaders in it, so it says little of the next.
        0 | 1 => format!("first frame {:.0} ms", json::median(&drawn.frames_ms)),
        many => format!("{:.1} ms, the median of {many} frames", json::median(&drawn.frames_ms)),
    };
    let density =
        drawn.density.as_ref().map_or(String::new(), |found| density_sentence(options.view, found.as_ref()));
    let overdraw = drawn.overdraw.as_ref().map_or(String::new(), overdraw_sentence);
    format!(
        "{}: {} triangles, {}{maps}, on {}: {time}\n{density}{overdraw}{} view of {}x{} pixels written to {}\n",
        stage.scene.name,
        text::count(stage.scene.triangles()),
        options.settings.technique.id,
        gpu.info.name,
        options.view.id(),
        stage.size.x,
        stage.size.y,
        args.output.display()
    )
}
