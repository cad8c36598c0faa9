//! Every technique on every light and camera.

use crate::cost::Cost;
use crate::heat::{heat, picture_of_v};
use crate::numbers::params;
use crate::reach::Reach;
use crate::view::{TruthSummary, ViewSummary, ViewTruth, name_of};
use crate::{MeasureError, Progress};
use glam::Vec3;
use serde::Serialize;
use serde_json::{Map, Value};
use std::sync::Arc;
use std::time::Instant;
use umbrage_render::picture::encode_png;
use umbrage_render::umbrage::core::Camera;
use umbrage_render::umbrage::core::technique::Settings;
use umbrage_render::{GivenVisibility, Gpu, Measure, RenderOptions, Renderer, View, deformed};
use umbrage_scene::{Scene, SceneLight};
use umbrage_truth::{Errors, Frame, Quality, Rays, flicker, flip};

/// From where a scene is seen.
#[derive(Clone, Debug)]
pub enum Cameras {
    /// Each for itself, with its name.
    Each(Vec<(String, Camera)>),
    /// The frames of a path: errors are means over them, and what changes between them is measured.
    Path(String, Vec<Camera>),
}

impl Cameras {
    /// Each camera or path, with its frames.
    fn groups(&self) -> Vec<(String, Vec<Camera>)> {
        match self {
            Self::Each(cameras) => {
                cameras.iter().map(|(name, camera)| (name.clone(), vec![*camera])).collect()
            }
            Self::Path(name, frames) => vec![(name.clone(), frames.clone())],
        }
    }
}

/// What is measured.
#[derive(Clone, Debug)]
pub struct Plan {
    /// From where.
    pub cameras: Cameras,
    /// What each of the scene's lights is called in rows: its number, before any were left out.
    pub light_numbers: Vec<usize>,
    /// Which techniques, with their parameters.
    pub techniques: Vec<Settings>,
    /// How truth is found.
    pub quality: Quality,
    /// Frames of each technique that are timed.
    pub frames: u32,
    /// Size and look of the pictures; settings, view and shown light do not count.
    pub options: RenderOptions,
}

/// One technique under one light from one camera (or along one path). Shares and errors are fractions of 1.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// Which [`ViewSummary`], by its id.
    pub view: String,
    /// The technique's name on the command line.
    pub technique: &'static str,
    /// Its name for people.
    pub label: &'static str,
    /// What it is.
    pub summary: &'static str,
    /// Which light of the scene.
    pub light: usize,
    /// Which camera or path.
    pub camera: String,
    /// Choices and parameters.
    pub params: Map<String, Value>,
    /// Means over all frames.
    #[serde(flatten)]
    pub errors: Errors,
    /// From a contact to where its shadow begins, metres.
    pub gap_m: Option<f64>,
    /// The same in widths of a texel there, across the light; nothing without a map.
    pub gap_texel: Option<f64>,
    /// Width of soft edges over that of similar triangles.
    pub penumbra: Option<f64>,
    /// Change of V between frames where the truth does not change.
    pub flicker: Option<f64>,
    /// Perceptual difference of the final picture.
    pub flip: f64,
    /// Times and counts.
    #[serde(flatten)]
    pub cost: Cost,
    /// Picture, below the report's folder.
    pub r#final: String,
    /// V.
    pub visibility: String,
    /// V - V*.
    pub heat: String,
    /// What to type to draw it again.
    pub command: String,
    /// The three pictures, PNG.
    #[serde(skip)]
    pub pictures: [Vec<u8>; 3],
    /// The technique with its parameters.
    #[serde(skip)]
    pub settings: Settings,
}

/// All that was measured.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// How truth was found.
    pub truth: TruthSummary,
    /// Each camera and light.
    pub views: Vec<ViewSummary>,
    /// Each technique on each of these.
    pub rows: Vec<Row>,
    /// What did not go as a user may expect.
    pub warnings: Vec<String>,
}

/// What is known of a technique while its frames go by.
#[derive(Default)]
struct Running {
    errors: Vec<Errors>,
    gaps_m: Vec<f64>,
    gaps_texel: Vec<f64>,
    penumbrae: Vec<f64>,
    flickers: Vec<f64>,
    last_v: Vec<Vec3>,
}

/// Draws and traces everything that `plan` names.
///
/// # Errors
/// See [`MeasureError`].
pub fn compare(
    gpu: &Gpu,
    scene: &Scene,
    plan: &Plan,
    progress: &Progress<'_>,
) -> Result<Comparison, MeasureError> {
    let groups = plan.cameras.groups();
    let frames: usize = groups.iter().map(|(_, frames)| frames.len()).sum();
    // The truth of a frame counts as much as a technique's.
    let steps = (scene.lights.len() * frames * (1 + plan.techniques.len())).max(1) as f32;
    progress_to(progress, "building the ray hierarchy", 0.0)?;
    let start = Instant::now();
    let moved = deformed(gpu, scene, &plan.options)?;
    let rays = Rays::new(&moved)?;
    let build_s = start.elapsed().as_secs_f64();
    let mut made = Comparison {
        truth: TruthSummary { samples: 1, ..TruthSummary::default() },
        views: Vec::new(),
        rows: Vec::new(),
        warnings: Vec::new(),
    };
    let mut step = 0;
    let mut alone = scene.clone();
    for (light, number) in scene.lights.iter().zip(&plan.light_numbers) {
        alone.lights = vec![light.clone()];
        for (camera, (name, cameras)) in groups.iter().enumerate() {
            let at = At { id: format!("c{camera}-l{number}"), name, light: *number };
            let steps_done = |label: &str, done: f32| progress(label, (step as f32 + done) / steps);
            measure_group(gpu, &rays, &alone, plan, &at, cameras, &mut made, &steps_done)?;
            step += cameras.len() * (1 + plan.techniques.len());
        }
    }
    made.truth.rays_per_second = made.truth.rays as f64 / made.truth.seconds.max(1e-9);
    made.truth.seconds += build_s;
    gpu.check()?;
    Ok(made)
}

fn progress_to(progress: &Progress<'_>, label: &str, share: f32) -> Result<(), MeasureError> {
    if progress(label, share).is_break() { Err(MeasureError::Stopped) } else { Ok(()) }
}

/// Which camera and light.
struct At<'a> {
    id: String,
    name: &'a str,
    light: usize,
}

/// One light along the frames of one camera. `alone` has that light only; `progress` counts steps.
#[allow(
    clippy::too_many_arguments,
    reason = "they are the whole state of a measurement, and it has one caller"
)]
fn measure_group(
    gpu: &Gpu,
    rays: &Rays<'_>,
    alone: &Scene,
    plan: &Plan,
    at: &At<'_>,
    cameras: &[Camera],
    made: &mut Comparison,
    progress: &Progress<'_>,
) -> Result<(), MeasureError> {
    let shown = cameras.len() / 2;
    let light = &alone.lights[0].light;
    let mut running: Vec<Running> = plan.techniques.iter().map(|_| Running::default()).collect();
    let mut last: Option<ViewTruth> = None;
    for (frame, camera) in cameras.iter().enumerate() {
        let done = frame * (1 + plan.techniques.len());
        let tracing = |label: &str, share: f32| progress(label, done as f32 + share);
        let (truth, found) =
            ViewTruth::new(gpu, rays, alone, camera, &plan.options, &plan.quality, &tracing)?;
        made.truth.seconds += found.seconds;
        made.truth.rays += found.rays;
        made.truth.samples = made.truth.samples.max(found.samples);
        made.truth.excluded_pixels += found.excluded_pixels;
        let scene = Shot { gpu, scene: alone, camera, options: &plan.options };
        let reference = (frame == shown).then(|| scene.of_truth(&truth)).transpose()?;
        // One for all techniques: what costs time is the making.
        let mut bare = (frame == shown).then(|| scene.renderer(&unshadowed()?, View::Final)).transpose()?;
        for (i, settings) in plan.techniques.iter().enumerate() {
            let label = format!("measuring {}", settings.technique.id);
            progress_to(progress, &label, (done + 1 + i) as f32)?;
            let v = scene.visibility(settings, &mut made.warnings)?;
            let (errors, shape) = truth.judge(rays, light, &v.v, &v.reach(settings));
            let so_far = &mut running[i];
            so_far.errors.push(errors);
            so_far.gaps_m.extend(shape.gap_m);
            so_far.gaps_texel.extend(shape.gap_texel);
            so_far.penumbrae.extend(shape.penumbra);
            if let Some(last) = &last {
                let frames = [frame_of(last, &so_far.last_v), frame_of(&truth, &v.v)];
                so_far.flickers.extend(flicker(&frames));
            }
            if let (Some(reference), Some(bare)) = (&reference, &mut bare) {
                made.rows.push(row(&scene, settings, &truth, &v.v, reference, bare, at, plan.frames)?);
            }
            so_far.last_v = v.v;
        }
        if let Some(reference) = reference {
            made.views.push(summary(&truth, &reference, &alone.lights[0], at)?);
        }
        last = Some(truth);
    }
    let first = made.rows.len() - plan.techniques.len();
    for (i, (row, so_far)) in made.rows[first..].iter_mut().zip(&running).enumerate() {
        so_far.put(row);
        // A technique may be measured several times, with other parameters.
        let file = |what: &str| format!("img/{}-{i}-{}-{what}.png", at.id, row.technique);
        [row.r#final, row.visibility, row.heat] = ["final", "visibility", "heat"].map(file);
    }
    Ok(())
}

fn frame_of<'a>(truth: &'a ViewTruth, v: &'a [Vec3]) -> Frame<'a> {
    let (surfaces, receivers) = (&truth.surfaces, truth.judged.receivers());
    Frame { surfaces, truth: &truth.visibility.v, v, receivers }
}

impl Running {
    /// Means over the frames; the gap is the greatest of any.
    fn put(&self, row: &mut Row) {
        row.errors = Errors::mean(&self.errors);
        row.gap_m = self.gaps_m.iter().copied().reduce(f64::max);
        row.gap_texel = self.gaps_texel.iter().copied().reduce(f64::max);
        let average = |list: &[f64]| (!list.is_empty()).then(|| list.iter().sum::<f64>() / list.len() as f64);
        row.penumbra = average(&self.penumbrae);
        row.flicker = average(&self.flickers);
    }
}

/// A scene from a camera, to be drawn in several ways.
struct Shot<'a> {
    gpu: &'a Gpu,
    scene: &'a Scene,
    camera: &'a Camera,
    options: &'a RenderOptions,
}

/// A technique's answer, and the views that it was looked up in.
struct Answer {
    v: Vec<Vec3>,
    views: Vec<umbrage_render::umbrage::core::fit::ShadowView>,
    masks: Vec<umbrage_render::umbrage::core::fit::MaskView>,
}

impl Answer {
    fn reach(&self, settings: &Settings) -> Reach {
        Reach::of(settings, &self.views, &self.masks)
    }
}

impl<'a> Shot<'a> {
    fn renderer(&self, settings: &Settings, view: View) -> Result<Renderer<'a>, MeasureError> {
        let options = RenderOptions {
            settings: settings.clone(),
            view,
            shown_light: 0,
            samples: 1,
            // What a map costs is asked, not what it saves to have one.
            reuse: false,
            given: None,
            ..self.options.clone()
        };
        Ok(Renderer::new(self.gpu, self.scene, self.camera, options)?)
    }

    fn visibility(&self, settings: &Settings, warnings: &mut Vec<String>) -> Result<Answer, MeasureError> {
        let mut renderer = self.renderer(settings, View::Visibility)?;
        renderer.frame(Measure::Frame)?;
        for warning in renderer.warnings() {
            if !warnings.contains(warning) {
                warnings.push(warning.clone());
            }
        }
        Ok(Answer {
            v: renderer.visibility_rgb()?,
            views: renderer.views().to_vec(),
            masks: renderer.mask_views(),
        })
    }

    /// The final picture with the truth's V.
    fn of_truth(&self, truth: &ViewTruth) -> Result<Vec<u8>, MeasureError> {
        let given = Arc::new(GivenVisibility { of_light: vec![truth.visibility.v.clone()] });
        let options = RenderOptions {
            settings: unshadowed()?,
            view: View::Final,
            samples: 1,
            given: Some(given),
            ..self.options.clone()
        };
        let mut renderer = Renderer::new(self.gpu, self.scene, self.camera, options)?;
        renderer.frame(Measure::Frame)?;
        Ok(renderer.picture()?)
    }
}

fn unshadowed() -> Result<Settings, MeasureError> {
    Settings::new("unshadowed", []).map_err(|e| MeasureError::Write(e.to_string()))
}

fn png(truth: &ViewTruth, rgba: &[u8]) -> Result<Vec<u8>, MeasureError> {
    let size = truth.size();
    encode_png(size.x, size.y, rgba).map_err(|e| MeasureError::Write(format!("cannot pack a picture: {e}")))
}

/// A row with its pictures and costs; errors over all frames, and names, are put in later.
#[allow(
    clippy::too_many_arguments,
    reason = "a row is made of all that was found out, and it has one caller"
)]
fn row(
    shot: &Shot<'_>,
    settings: &Settings,
    truth: &ViewTruth,
    v: &[Vec3],
    reference: &[u8],
    bare: &mut Renderer<'_>,
    at: &At<'_>,
    frames: u32,
) -> Result<Row, MeasureError> {
    let mut with = shot.renderer(settings, View::Final)?;
    let cost = Cost::measure(&mut with, bare, settings, frames)?;
    let picture = with.picture()?;
    let size = truth.size();
    let heat = heat(size, reference, truth.judged.truth(), v, truth.judged.receivers(), &truth.excluded);
    let technique = settings.technique;
    Ok(Row {
        view: at.id.clone(),
        technique: technique.id,
        label: technique.label,
        summary: technique.summary,
        light: at.light,
        camera: at.name.to_owned(),
        params: params(settings),
        errors: Errors::default(),
        gap_m: None,
        gap_texel: None,
        penumbra: None,
        flicker: None,
        flip: flip(reference, &picture, size.x, size.y),
        cost,
        r#final: String::new(),
        visibility: String::new(),
        heat: String::new(),
        command: String::new(),
        pictures: [png(truth, &picture)?, png(truth, &picture_of_v(v))?, png(truth, &heat)?],
        settings: settings.clone(),
    })
}

fn summary(
    truth: &ViewTruth,
    reference: &[u8],
    light: &SceneLight,
    at: &At<'_>,
) -> Result<ViewSummary, MeasureError> {
    let file = |what: &str| format!("img/{}-truth-{what}.png", at.id);
    Ok(ViewSummary {
        id: at.id.clone(),
        camera: at.name.to_owned(),
        light: name_of(at.light, &light.name, &light.light),
        r#final: file("final"),
        visibility: file("visibility"),
        receivers: truth.judged.receivers().iter().filter(|r| **r).count(),
        excluded_pixels: truth.excluded.iter().filter(|e| **e).count(),
        soft_edges: truth.soft_edges(),
        pictures: [png(truth, reference)?, png(truth, &picture_of_v(&truth.visibility.v))?],
    })
}
