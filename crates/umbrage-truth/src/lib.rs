//! Ray-traced truth: how much of a light each pixel really sees, and how far a technique's answer is from it.
//!
//! It shares no code with fits, maps or WGSL: rays leave the camera through the renderer's pixel centres, hit the
//! scene's triangles and go on to the light. Everything is deterministic for a seed, whatever the number of cores.
//!
//! ```
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! use umbrage_truth::{Quality, Rays, Surfaces, Visibility, silent};
//! let scene = umbrage_scene::load("builtin:contact")?;
//! let rays = Rays::new(&scene)?;
//! let seen = Surfaces::new(&rays, &scene.cameras[0].camera, glam::UVec2::new(32, 18), &silent)?;
//! let truth = Visibility::new(&rays, &seen, &scene.lights[0].light, &Quality::default(), &silent)?;
//! assert!(truth.v.iter().any(|v| v.x == 0.0) && truth.v.iter().any(|v| v.x == 1.0));
//! # Ok(())
//! # }
//! ```

mod emitter;
mod eye;
mod hierarchy;
mod metric;
mod packet;
#[cfg(target_arch = "x86_64")]
mod packet_avx2;
mod samples;
mod surface;
mod triangles;
mod visibility;
mod walk;

pub use emitter::{Emitter, ToLight};
pub use eye::{Seen, Surfaces};
pub use hierarchy::{Found, Ray, Rays, Stack};
pub use metric::*;
pub use packet::LANES;
pub use samples::Samples;
pub use visibility::{Place, Quality, Visibility};

use std::ops::ControlFlow;

/// Is told what share of the work is done, 0..1, and says whether to go on. Called from any thread.
pub type Progress<'a> = dyn Fn(f32) -> ControlFlow<()> + Sync + 'a;

/// A [`Progress`] that says nothing and never stops.
pub fn silent(_: f32) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// Why there is no truth.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TruthError {
    /// The caller's [`Progress`] asked to stop.
    #[error("stopped before it was done")]
    Stopped,
    /// More triangles than can be counted.
    #[error("the scene draws {0} triangles; rays can be traced through {most} at most: leave instances out", most = triangles::MOST)]
    TooManyTriangles(u64),
    /// A light whose numbers cannot be used.
    #[error(transparent)]
    Light(#[from] umbrage_core::LightError),
    /// A camera whose numbers cannot be used.
    #[error("{0}")]
    Camera(String),
    /// No pixels, no samples, or more than can be had.
    #[error("{what} is {value}; it must be {allowed}")]
    OutOfRange {
        /// Which number.
        what: &'static str,
        /// What was handed in.
        value: u64,
        /// What would be accepted.
        allowed: &'static str,
    },
}
