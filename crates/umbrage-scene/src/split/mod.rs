//! Edges split and ghosts put between them in Wavefront OBJ files. In memory it is [`umbrage_core::split`].

mod obj;
mod outline;
mod records;

pub use obj::{SplitCounts, SplitObj, split_obj};
