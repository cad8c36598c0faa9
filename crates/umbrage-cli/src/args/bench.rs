//! What `umbrage bench` takes.

use super::{SceneArgs, technique_ids};
use crate::specs::{self, Pair};
use clap::{Args, Subcommand};
use umbrage_render::umbrage::core::technique::DEFAULT;

const BENCH_EXAMPLES: &str = "Examples:
  umbrage bench
  umbrage bench model.glb --techniques all --frames 60
  umbrage bench --lights-from cases.json:A knots.glb --techniques hard,linear --json

`umbrage bench threaded` measures maps that a thread draws; `umbrage bench threaded --help` says more.
Frames of the techniques take turns, so that what else the machine does meets all of them alike. `shadow cost` is the
median minus that of the unshadowed frame. Vertex and fragment runs are counted in a frame of their own.";

/// `umbrage bench`
#[derive(Args, Debug)]
#[command(after_long_help = BENCH_EXAMPLES, args_conflicts_with_subcommands = true)]
pub struct BenchArgs {
    /// Another measurement.
    #[command(subcommand)]
    pub other: Option<BenchCommand>,

    /// Scene, lights, picture, machine.
    #[command(flatten)]
    pub scene: SceneArgs,

    /// Which techniques, by commas, or all; unshadowed is always measured
    #[arg(short, long, value_name = "ID,...", default_value = "unshadowed,linear", value_delimiter = ',',
          value_parser = technique_ids(&["all"]), help_heading = "Shadow")]
    pub techniques: Vec<String>,

    /// Change a choice or parameter in every technique but unshadowed; all of them must have it
    #[arg(short, long, value_name = "KEY=VALUE", value_parser = specs::pair, help_heading = "Shadow")]
    pub set: Vec<Pair>,

    /// Look up maps as they are while nothing moves, as an application would; without it every frame draws all its maps,
    /// so that costs are those of a moving scene
    #[arg(long, help_heading = "Shadow")]
    pub reuse: bool,

    /// Measured frames of each technique, after one that warms up
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..=10_000), help_heading = "Output")]
    pub frames: u32,

    /// Print one JSON object
    #[arg(long, help_heading = "Output")]
    pub json: bool,
}

/// What else can be measured.
#[derive(Debug, Subcommand)]
pub enum BenchCommand {
    /// Draw maps on a thread of their own, and measure what that brings and how old shadows get
    Threaded(Box<ThreadedArgs>),
}

const THREADED_EXAMPLES: &str = "Examples:
  umbrage bench threaded
  umbrage bench threaded builtin:columns --interval-ms 100 --map-load-ms 20
  umbrage bench threaded --seconds 5 --frame-load-ms 0 --json

The scene's largest caster that is not flat moves in a circle. There are rows without load, with load for each map, for each
frame, and for both; in each, maps are drawn by every frame, by a frame at the interval, and by a thread at the interval.
The picture has 640x360 pixels unless --size says otherwise. `age` is how long ago the casters were last where the maps show them.";

/// `umbrage bench threaded`
#[derive(Args, Debug)]
#[command(after_long_help = THREADED_EXAMPLES)]
pub struct ThreadedArgs {
    /// Scene, lights, picture, machine.
    #[command(flatten)]
    pub scene: SceneArgs,

    /// How shadows are made
    #[arg(short, long, value_name = "ID", default_value = DEFAULT, value_parser = technique_ids(&[]), help_heading = "Shadow")]
    pub technique: String,

    /// Change a choice or parameter of the technique; may be given several times
    #[arg(short, long, value_name = "KEY=VALUE", value_parser = specs::pair, help_heading = "Shadow")]
    pub set: Vec<Pair>,

    /// How often maps are drawn where not every frame draws them, milliseconds
    #[arg(long, value_name = "MS", default_value_t = 50.0, value_parser = specs::milliseconds, allow_negative_numbers = true, help_heading = "Threads")]
    pub interval_ms: f32,

    /// Simulated work of the application for each map that is drawn, milliseconds of one core
    #[arg(long, value_name = "MS", default_value_t = 10.0, value_parser = specs::milliseconds, allow_negative_numbers = true, help_heading = "Threads")]
    pub map_load_ms: f32,

    /// Simulated work of the application for each frame, milliseconds of one core
    #[arg(long, value_name = "MS", default_value_t = 10.0, value_parser = specs::milliseconds, allow_negative_numbers = true, help_heading = "Threads")]
    pub frame_load_ms: f32,

    /// How long each row is measured
    #[arg(long, value_name = "S", default_value_t = 0.5, value_parser = specs::row_seconds, allow_negative_numbers = true, help_heading = "Output")]
    pub seconds: f32,

    /// Print one JSON object
    #[arg(long, help_heading = "Output")]
    pub json: bool,
}
