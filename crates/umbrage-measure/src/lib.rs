//! Techniques measured on a scene: how wrong each is beside what it costs.
//!
//! [`compare`] draws a scene with each technique under each of its lights alone, traces the truth of the same pixels, and
//! gives one [`Row`] for each technique, light and camera; [`report::write`] makes a page of them that opens from disk.

mod compare;
mod cost;
mod heat;
mod numbers;
mod reach;
pub mod report;
mod view;

pub use compare::{Cameras, Comparison, Plan, Row, compare};
pub use cost::Cost;
pub use heat::picture_of_v;
pub use numbers::{decimal, median, params};
pub use view::{TruthSummary, ViewSummary, ViewTruth};

use umbrage_render::RenderError;
use umbrage_truth::TruthError;

/// Told what is being done and what share of all is done, 0..1; says whether to go on.
pub type Progress<'a> = dyn Fn(&str, f32) -> std::ops::ControlFlow<()> + Sync + 'a;

/// Why nothing was measured.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeasureError {
    /// A picture cannot be drawn.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The truth cannot be found.
    #[error(transparent)]
    Truth(TruthError),
    /// [`Progress`] asked to stop.
    #[error("stopped before it was done; nothing was written")]
    Stopped,
    /// A picture cannot be packed, or a file not be written.
    #[error("{0}")]
    Write(String),
}

impl From<TruthError> for MeasureError {
    fn from(error: TruthError) -> Self {
        match error {
            TruthError::Stopped => Self::Stopped,
            other => Self::Truth(other),
        }
    }
}
