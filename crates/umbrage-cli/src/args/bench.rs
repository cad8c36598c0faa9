//! What `umbrage bench` takes.

use super::{SceneArgs, technique_ids};
use crate::specs::{self, Pair};
use clap::Args;

const BENCH_EXAMPLES: &str = "Examples:
  umbrage bench
  umbrage bench model.glb --techniques all --frames 60
  umbrage bench --lights-from cases.json:A knots.glb --techniques hard,linear --json

Frames of the techniques take turns, so that what else the machine does meets all of them alike. `shadow cost` is the
median minus that of the unshadowed frame. Vertex and fragment runs are counted in a frame of their own.";

/// `umbrage bench`
#[derive(Args, Debug)]
#[command(after_long_help = BENCH_EXAMPLES)]
pub struct BenchArgs {
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
