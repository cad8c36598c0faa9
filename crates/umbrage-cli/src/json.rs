//! What `--json` prints: one object, every number finite.

use crate::fault::{Fault, say};
use serde::Serialize;
use serde_json::{Map, Value};
pub use umbrage_measure::{decimal, median, params};
use umbrage_render::umbrage::ChosenFormat;
use umbrage_render::umbrage::core::technique::{Param, ParamDefault, Source};
use umbrage_render::{
    DensityStatistics, OverdrawPart, OverdrawStatistics, PERCENTILES, PassReport, Renderer, Spread, View,
};
use umbrage_scene::Scene;

/// A picture and all that is known of it.
#[derive(Debug, Serialize)]
pub struct RenderJson {
    #[serde(flatten)]
    pub machine: Machine,
    pub scene: SceneJson,
    pub technique: &'static str,
    pub params: Map<String, Value>,
    pub map_format: Option<MapFormat>,
    pub size: [u32; 2],
    pub msaa: u32,
    pub view: &'static str,
    pub light_index: usize,
    pub passes: Vec<PassJson>,
    pub frame_ms: f64,
    pub frames_ms: Vec<f64>,
    pub shadow_memory_bytes: u64,
    /// Of each light's maps.
    pub shadow_memory_per_light_bytes: Vec<u64>,
    /// In all frames together, also those that are not timed.
    pub maps_drawn: u64,
    pub maps_reused: u64,
    pub exposure: f64,
    /// `null` in views that do not hold it.
    pub density: Option<DensityJson>,
    /// `null` in views that do not hold it.
    pub overdraw: Option<OverdrawJson>,
    pub timings: Timings,
    pub output: String,
    pub notes: Vec<String>,
    pub warnings: Vec<String>,
}

/// What drew it.
#[derive(Clone, Debug, Serialize)]
pub struct Machine {
    pub adapter: String,
    pub driver: String,
    pub backend: String,
}

/// What was drawn.
#[derive(Debug, Serialize)]
pub struct SceneJson {
    pub name: String,
    pub triangles: u64,
    pub instances: usize,
    pub meshes: usize,
    pub materials: usize,
    pub images: usize,
    pub lights: usize,
    pub cameras: usize,
    pub bounds: BoundsJson,
    /// `null` at rest.
    pub animation: Option<AnimationJson>,
}

/// The moment of an animation that is shown.
#[derive(Debug, Serialize)]
pub struct AnimationJson {
    pub number: usize,
    pub name: String,
    pub length_s: f64,
    /// Within the length.
    pub time_s: f64,
}

/// Metres, world space.
#[derive(Debug, Serialize)]
pub struct BoundsJson {
    pub min: [f64; 3],
    pub max: [f64; 3],
}

/// The depth format of the maps, and why.
#[derive(Debug, Serialize)]
pub struct MapFormat {
    pub storage: &'static str,
    pub format: String,
    pub why: String,
}

/// What a pass did.
#[derive(Debug, Serialize)]
pub struct PassJson {
    pub name: String,
    pub draws: u64,
    pub instances: u64,
    pub triangles: u64,
    pub vertices: u64,
    pub gpu_ms: Option<f64>,
    pub statistics: Option<StatisticsJson>,
}

/// What the GPU counted.
#[derive(Debug, Serialize)]
pub struct StatisticsJson {
    pub vertex_runs: u64,
    pub clipped_triangles: u64,
    pub fragment_runs: u64,
}

/// Texels of the light's map in a pixel, linear: 1 is one texel a pixel.
#[derive(Debug, Serialize)]
pub struct DensityJson {
    /// What is counted: pixels of the `picture`, or of the `map` as it is shown.
    pub of: &'static str,
    /// Those that show a receiver.
    pub pixels: usize,
    /// Their share of the picture or the map, 0..1.
    pub share: f64,
    /// Square root of the number of texels in a pixel; absent where no receiver is seen.
    #[serde(flatten)]
    pub mean: Option<SpreadJson>,
    /// Texels along the direction of each pixel in which there are fewest.
    pub worst_direction: Option<SpreadJson>,
    pub histogram: Vec<OctaveJson>,
}

/// What many numbers span.
#[derive(Debug, Serialize)]
pub struct SpreadJson {
    pub least: f64,
    /// `p01` is what one pixel in a hundred is not above.
    pub percentiles: Map<String, Value>,
    pub most: f64,
    /// Geometric.
    pub mean: f64,
}

/// Share of what has so many texels, or faces of volumes, a pixel.
#[derive(Debug, Serialize)]
pub struct OctaveJson {
    pub from: f64,
    /// `null`: without bound.
    pub to: Option<f64>,
    pub share: f64,
}

/// Faces of the light's shadow volumes in a pixel.
#[derive(Debug, Serialize)]
pub struct OverdrawJson {
    /// All that are rasterised.
    pub fragments: u64,
    /// Of all pixels.
    #[serde(flatten)]
    pub picture: OverdrawPartJson,
    /// Of pixels that show a lit receiver; `null` where there is none.
    pub lit: Option<OverdrawPartJson>,
    /// Of those that show a receiver in shadow; `null` where there is none.
    pub shadow: Option<OverdrawPartJson>,
    /// How many volumes the surface is in that is in most; a stencil holds up to 255.
    pub deepest_count: i32,
    /// Pixels that are lit because the stencil wraps.
    pub wrongly_lit_pixels: usize,
    /// Pixels with so many faces that they are not told apart.
    pub unsure_pixels: usize,
    pub histogram: Vec<OctaveJson>,
}

/// Faces of volumes over a part of the picture.
#[derive(Debug, Serialize)]
pub struct OverdrawPartJson {
    pub pixels: usize,
    pub mean: f64,
    pub most: u32,
}

impl From<&OverdrawStatistics> for OverdrawJson {
    fn from(found: &OverdrawStatistics) -> Self {
        let part =
            |part: &OverdrawPart| OverdrawPartJson { pixels: part.pixels, mean: part.mean, most: part.most };
        let cell = |cell: &umbrage_render::FacesShare| OctaveJson {
            from: f64::from(cell.from),
            to: cell.to.map(f64::from),
            share: cell.share,
        };
        Self {
            fragments: found.fragments,
            picture: part(&found.picture),
            lit: found.lit.as_ref().map(part),
            shadow: found.shadow.as_ref().map(part),
            deepest_count: found.deepest_count,
            wrongly_lit_pixels: found.wrongly_lit_pixels,
            unsure_pixels: found.unsure_pixels,
            histogram: found.histogram.iter().map(cell).collect(),
        }
    }
}

impl DensityJson {
    /// Of a view, with nothing to tell where no receiver is seen.
    pub fn of(view: View, found: Option<&DensityStatistics>) -> Self {
        let octave = |octave: &umbrage_render::OctaveShare| OctaveJson {
            from: octave.from,
            to: octave.to.is_finite().then_some(octave.to),
            share: octave.share,
        };
        Self {
            of: if view == View::DensityLight { "map" } else { "picture" },
            pixels: found.map_or(0, |found| found.pixels),
            share: found.map_or(0.0, |found| found.share),
            mean: found.map(|found| SpreadJson::from(&found.mean)),
            worst_direction: found.map(|found| SpreadJson::from(&found.worst_direction)),
            histogram: found.map_or(Vec::new(), |found| found.histogram.iter().map(octave).collect()),
        }
    }
}

impl From<&Spread> for SpreadJson {
    fn from(spread: &Spread) -> Self {
        let percentiles = PERCENTILES.iter().zip(spread.percentiles);
        Self {
            least: spread.least,
            percentiles: percentiles
                .map(|(percent, value)| (format!("p{percent:02}"), value.into()))
                .collect(),
            most: spread.most,
            mean: spread.mean,
        }
    }
}

/// Where the time went, milliseconds.
#[derive(Debug, Serialize)]
pub struct Timings {
    pub load_ms: f64,
    pub setup_ms: f64,
    pub frame_ms: f64,
    pub write_ms: f64,
}

/// A parameter as the table has it.
#[derive(Debug, Serialize)]
pub struct ParamJson {
    pub name: &'static str,
    pub label: &'static str,
    pub unit: &'static str,
    pub min: f64,
    pub max: f64,
    pub step: f64,
    /// Absent where it follows from the combination.
    pub default: Option<f64>,
    pub default_rule: Option<&'static str>,
    pub help: &'static str,
    pub cost: &'static str,
}

/// Where something was published.
#[derive(Debug, Serialize)]
pub struct SourceJson {
    pub paper: &'static str,
    pub year: u16,
}

impl Machine {
    /// Names it.
    pub fn of(info: &wgpu::AdapterInfo) -> Self {
        let driver = [info.driver.as_str(), info.driver_info.as_str()];
        Self {
            adapter: info.name.clone(),
            driver: driver.iter().filter(|s| !s.is_empty()).copied().collect::<Vec<_>>().join(" "),
            backend: info.backend.to_string(),
        }
    }
}

impl SceneJson {
    /// Counts it.
    pub fn of(scene: &Scene) -> Self {
        let bounds = scene.bounds();
        Self {
            name: scene.name.clone(),
            triangles: scene.triangles(),
            instances: scene.instances.len(),
            meshes: scene.meshes.len(),
            materials: scene.materials.len(),
            images: scene.images.len(),
            lights: scene.lights.len(),
            cameras: scene.cameras.len(),
            bounds: BoundsJson {
                min: bounds.min.to_array().map(decimal),
                max: bounds.max.to_array().map(decimal),
            },
            animation: scene.playing.as_ref().map(|playing| AnimationJson {
                number: playing.number,
                name: playing.name.clone(),
                length_s: decimal(playing.length_s),
                time_s: decimal(playing.time_s),
            }),
        }
    }
}

impl MapFormat {
    /// What was settled on.
    pub fn of(chosen: &ChosenFormat) -> Self {
        Self {
            storage: chosen.storage.row().id,
            format: format!("{:?}", chosen.format),
            why: chosen.why.clone(),
        }
    }

    /// Of a renderer; `None` without maps.
    pub fn of_renderer(renderer: &Renderer<'_>) -> Option<Self> {
        renderer.map_format().map(Self::of)
    }
}

impl From<&PassReport> for PassJson {
    fn from(pass: &PassReport) -> Self {
        Self {
            name: pass.name.clone(),
            draws: pass.work.draws,
            instances: pass.work.instances,
            triangles: pass.work.triangles,
            vertices: pass.work.vertices,
            gpu_ms: pass.gpu_ms,
            statistics: pass.statistics.map(|s| StatisticsJson {
                vertex_runs: s.vertex_runs,
                clipped_triangles: s.clipped_triangles,
                fragment_runs: s.fragment_runs,
            }),
        }
    }
}

impl From<&Param> for ParamJson {
    fn from(param: &Param) -> Self {
        let (default, default_rule) = match param.default {
            ParamDefault::Fixed(value) => (Some(decimal(value)), None),
            ParamDefault::Derived { rule, .. } => (None, Some(rule)),
        };
        Self {
            name: param.name,
            label: param.label,
            unit: param.unit,
            min: decimal(param.min),
            max: decimal(param.max),
            step: decimal(param.step),
            default,
            default_rule,
            help: param.help,
            cost: param.cost,
        }
    }
}

impl From<Source> for SourceJson {
    fn from(source: Source) -> Self {
        Self { paper: source.paper, year: source.year }
    }
}

/// Prints one object.
///
/// # Errors
/// As [`say`].
pub fn print(value: &impl Serialize) -> Result<(), Fault> {
    let text = serde_json::to_string_pretty(value).map_err(|e| Fault::Failed(e.to_string()))?;
    say(&text)
}
