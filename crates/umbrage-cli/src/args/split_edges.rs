//! What `umbrage split-edges` takes.

use clap::Args;
use std::path::PathBuf;

const SPLIT_EDGES_EXAMPLES: &str = "Examples:
  umbrage split-edges model.obj -o model-split.obj
  umbrage split-edges leaves.obj -o leaves-split.obj --back-faces
      a model with open edges: its surfaces cast from both sides
  umbrage split-edges model.obj -o /dev/null --json
      only count: is the model closed?

What is written: every face gets vertices of its own with the face's normal, and between two faces that meet lies a ghost, a
quad without area, in the group `umbrage_ghosts` at the end. A vertex shader that moves each vertex whose normal faces away
from the light, away from the light, turns this into a closed shadow volume. Faces meet by place, not by index, whatever
their groups and materials. All other records stay as they are.

Faces are closed where each edge is used as often one way as the other. An edge that lacks its other face is open: its ghost
goes to a copy of the edge with the reversed normal, where the volume ends open, so that shadows leak there; a warning says so.
With --back-faces the reverse of each face of an open part follows it (a part is all that is connected through edges), and is
joined by ghosts of its own: the part is closed then, and casts whichever side the light sees. It costs twice the faces.

Volumes of loaded meshes do not need this command: Umbrage splits them in memory.";

/// `umbrage split-edges`
#[derive(Args, Debug)]
#[command(after_long_help = SPLIT_EDGES_EXAMPLES,
          after_help = "`umbrage split-edges --help` says what is written, and what to do about open edges.")]
pub struct SplitEdgesArgs {
    /// The .obj file; it is only read
    #[arg(value_name = "IN.OBJ")]
    pub input: PathBuf,

    /// Where the split copy goes; a file of that name is replaced, but never the input
    #[arg(short, long, value_name = "OUT.OBJ")]
    pub output: PathBuf,

    /// Add the reverse of every face of open parts, so that these cast from both sides
    #[arg(long)]
    pub back_faces: bool,

    /// Print one JSON object
    #[arg(long)]
    pub json: bool,

    /// Print nothing but errors
    #[arg(short, long, conflicts_with = "json")]
    pub quiet: bool,
}
