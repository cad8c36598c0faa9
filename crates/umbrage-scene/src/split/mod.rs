//! Edges split and ghosts put between them: in memory ([`SplitMesh`]) and in Wavefront OBJ files ([`split_obj`]).

mod mesh;
mod obj;
mod outline;
mod records;

pub use mesh::SplitMesh;
pub use obj::{SplitCounts, SplitObj, split_obj};
