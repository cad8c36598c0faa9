//! The reference renderer of Umbrage: any scene, lit and shadowed, without a window, on any wgpu adapter.
//!
//! A frame is [`Renderer::frame`]; everything before it is in [`Renderer::new`]. Surfaces go into a G-buffer of one
//! texel a pixel and are lit once each, so a scene of many small triangles pays for its light by the pixel.

mod density;
mod draw_list;
mod error;
mod exposure;
mod frame;
mod geometry;
pub mod gpu;
mod layout;
mod lights;
mod materials;
mod options;
pub mod picture;
mod pipelines;
mod readback;
mod renderer;
mod shaders;
mod surfaces;
mod targets;
mod textures;
mod timing;

pub use density::{DensityStatistics, EDGE_ON_COS, OctaveShare, PERCENTILES, Spread};
pub use draw_list::Work;
pub use error::RenderError;
pub use frame::{FrameReport, PassReport};
pub use gpu::Gpu;
pub use layout::MAX_LIGHTS;
pub use options::{GivenVisibility, RenderOptions, View};
pub use renderer::Renderer;
pub use surfaces::DrawnSurface;
pub use timing::{Measure, Statistics};
pub use umbrage;
