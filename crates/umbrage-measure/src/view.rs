//! The truth of one light from one camera, ready to judge what techniques draw.

use crate::reach::Reach;
use crate::{MeasureError, Progress};
use glam::{UVec2, Vec3};
use rayon::prelude::*;
use serde::Serialize;
use std::time::Instant;
use umbrage_render::umbrage::core::technique::Settings;
use umbrage_render::umbrage::core::{Camera, Light};
use umbrage_render::{DrawnSurface, Gpu, Measure, RenderOptions, Renderer, View};
use umbrage_scene::Scene;
use umbrage_truth::{
    Contacts, Edges, Emitter, Errors, Judged, Place, Quality, Rays, Seen, Stack, Surfaces, Visibility,
    hides_change,
};

/// How the truth was found, over all cameras and lights.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct TruthSummary {
    /// Rays from each receiver to a light that is no point.
    pub samples: u32,
    /// Seconds that it took, building the hierarchy included.
    pub seconds: f64,
    /// Rays of sight and rays to lights.
    pub rays: u64,
    /// The same in a second, without the building.
    pub rays_per_second: f64,
    /// Pixels that were left out because rays and rasteriser saw different surfaces.
    pub excluded_pixels: u64,
}

/// One camera and one light.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ViewSummary {
    /// For file names.
    pub id: String,
    /// For people.
    pub camera: String,
    /// For people.
    pub light: String,
    /// Picture with the truth's V, below the report's folder.
    pub r#final: String,
    /// The truth's V.
    pub visibility: String,
    /// Pixels that are judged.
    pub receivers: usize,
    /// Pixels that were left out because rays and rasteriser saw different surfaces.
    pub excluded_pixels: usize,
    /// Soft edges that were measured.
    pub soft_edges: usize,
    /// Both pictures, PNG.
    #[serde(skip)]
    pub pictures: [Vec<u8>; 2],
}

/// The truth of one light from one camera.
#[derive(Debug)]
pub struct ViewTruth {
    /// What rays saw.
    pub surfaces: Surfaces,
    /// V*.
    pub visibility: Visibility,
    /// V* with all that judging needs.
    pub judged: Judged,
    /// Pixels where rasteriser and rays saw different surfaces.
    pub excluded: Vec<bool>,
    contacts: Contacts,
    edges: Edges,
}

/// What a technique is judged by in one picture, beside [`Errors`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shape {
    /// See [`Contacts::gap_m`].
    pub gap_m: Option<f64>,
    /// The same in widths of a texel there, across the light.
    pub gap_texel: Option<f64>,
    /// See [`Edges::ratio`].
    pub penumbra: Option<f64>,
}

/// A technique with more wrong pixels than this share of all is simply wrong: no ray is spent on its excuses.
const MOST_LOOKED_AT: f64 = 0.005;

/// The two saw the same surface when the drawn place lies on the triangle's plane, up to this share of a pixel.
const SAME_PLANE_PX: f64 = 0.05;

fn is_same(surfaces: &Surfaces, seen: &Option<Seen>, drawn: &Option<DrawnSurface>) -> bool {
    match (seen, drawn) {
        (None, None) => true,
        (Some(seen), Some(drawn)) => {
            let offset = drawn.p_world - seen.p_world;
            let pixel_m = surfaces.pixel_m(seen);
            let off_plane_m = offset.dot(seen.normal_world.as_dvec3()).abs();
            // A plane that is seen edge-on takes many metres of depth into one pixel, but never as many as this.
            off_plane_m <= SAME_PLANE_PX * pixel_m && offset.length() < 1e3 * pixel_m
        }
        _ => false,
    }
}

impl ViewTruth {
    /// Traces the scene and draws its surfaces once, so that only pixels are judged in which both saw the same.
    ///
    /// # Errors
    /// See [`MeasureError`].
    pub fn new(
        gpu: &Gpu,
        rays: &Rays<'_>,
        scene: &Scene,
        camera: &Camera,
        options: &RenderOptions,
        quality: &Quality,
        progress: &Progress<'_>,
    ) -> Result<(Self, TruthSummary), MeasureError> {
        let light = &scene.lights[0].light;
        let part =
            |from: f32, to: f32| move |share: f32| progress("tracing rays", from + (to - from) * share);
        let start = Instant::now();
        let surfaces = Surfaces::new(rays, camera, options.size, &part(0.0, 0.2))?;
        let visibility = Visibility::new(rays, &surfaces, light, quality, &part(0.2, 0.9))?;
        let seconds = start.elapsed().as_secs_f64();

        let drawn = drawn_surfaces(gpu, scene, camera, options)?;
        let same = surfaces.seen.iter().zip(&drawn).map(|(seen, drawn)| is_same(&surfaces, seen, drawn));
        let excluded: Vec<bool> = same.map(|same| !same).collect();
        let emitter = Emitter::new(light);
        let receivers = (0..drawn.len()).map(|i| {
            visibility.place[i] == Place::Receiver
                && !excluded[i]
                && drawn[i].is_some_and(|s| faces(&emitter, &s))
        });
        let counts: Vec<bool> =
            visibility.place.iter().map(|place| matches!(place, Place::Receiver | Place::Away)).collect();
        let judged = Judged::new(options.size, visibility.v.clone(), &counts, receivers.collect());
        let contacts = Contacts::new(rays, &surfaces, light, &visibility, &part(0.9, 1.0))?;
        let edges = Edges::new(rays, &surfaces, light, &judged);
        let summary = TruthSummary {
            samples: visibility.samples,
            seconds,
            rays: surfaces.rays + visibility.rays,
            rays_per_second: 0.0,
            excluded_pixels: excluded.iter().filter(|e| **e).count() as u64,
        };
        Ok((Self { surfaces, visibility, judged, excluded, contacts, edges }, summary))
    }

    /// Pixels across and down.
    pub fn size(&self) -> UVec2 {
        self.surfaces.size
    }

    /// How many soft edges there are to measure.
    pub fn soft_edges(&self) -> usize {
        self.edges.len()
    }

    /// Judges an answer of a technique that reaches so far.
    pub fn judge(&self, rays: &Rays<'_>, light: &Light, v: &[Vec3], reach: &Reach) -> (Errors, Shape) {
        let mut reach_px = reach.px(&self.surfaces);
        let hidden = self.hidden(rays, light, v, &reach_px, reach);
        hidden.iter().for_each(|pixel| reach_px[*pixel] = f32::INFINITY);
        let errors = Errors { hidden_pixels: hidden.len(), ..self.judged.errors(v, &reach_px) };
        let gap_m = self.contacts.gap_m(&self.judged, v, &reach_px);
        let emitter = Emitter::new(light);
        let texel_m = |pixel: usize| {
            let seen = self.surfaces.seen[pixel].as_ref();
            seen.and_then(|seen| reach.texel_m(seen.p_world, emitter.center(seen.p_world).way))
        };
        // Where there is no map there is no texel.
        let gap_texel = self
            .contacts
            .gap(&self.judged, v, &reach_px, |pixel| texel_m(pixel).unwrap_or(f64::INFINITY))
            .filter(|_| reach.has_map());
        (errors, Shape { gap_m, gap_texel, penumbra: self.edges.ratio(v) })
    }

    /// The wrong pixels that have an edge within reach which the picture does not show.
    fn hidden(
        &self,
        rays: &Rays<'_>,
        light: &Light,
        v: &[Vec3],
        reach_px: &[f32],
        reach: &Reach,
    ) -> Vec<usize> {
        let wrong = self.judged.wrong(v, reach_px);
        if wrong.len() as f64 > MOST_LOOKED_AT * self.surfaces.len() as f64 {
            return Vec::new();
        }
        let emitter = Emitter::new(light);
        let is_hidden = |stack: &mut Stack, pixel: &usize| {
            let seen = self.surfaces.seen[*pixel].as_ref()?;
            let reach_m = reach.across_light_m(seen.p_world, emitter.center(seen.p_world).way);
            let is_lit = self.judged.truth()[*pixel] == Vec3::ONE;
            (reach_m > 0.0 && hides_change(rays, &emitter, seen, is_lit, reach_m, stack)).then_some(*pixel)
        };
        let found = wrong.par_iter().map_init(Stack::default, is_hidden).flatten();
        found.collect()
    }
}

/// Does the shading's normal face the light? Where it does not, the surface gets no light whatever V is.
fn faces(emitter: &Emitter, drawn: &DrawnSurface) -> bool {
    drawn.shading_normal_world.as_dvec3().dot(emitter.center(drawn.p_world).way) > 0.0
}

fn drawn_surfaces(
    gpu: &Gpu,
    scene: &Scene,
    camera: &Camera,
    options: &RenderOptions,
) -> Result<Vec<Option<DrawnSurface>>, MeasureError> {
    let settings = Settings::new("unshadowed", []).map_err(|e| MeasureError::Write(e.to_string()))?;
    let options = RenderOptions { settings, view: View::Visibility, shown_light: 0, ..options.clone() };
    let mut renderer = Renderer::new(gpu, scene, camera, options)?;
    renderer.frame(Measure::Frame)?;
    Ok(renderer.surfaces()?)
}

/// What a light is, in a word or two.
pub(crate) fn name_of(index: usize, name: &str, light: &Light) -> String {
    let kind = light.kind.id();
    if name.is_empty() || name.starts_with("--light") {
        format!("light {index} ({kind})")
    } else {
        format!("light {index}: {name} ({kind})")
    }
}
