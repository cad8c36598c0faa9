//! The reference renderer of Umbrage: any scene, lit and shadowed, without a window, on any wgpu adapter.
//!
//! A frame is [`Renderer::frame`]; everything before it is in [`Renderer::new`]. Between frames a renderer can be told what
//! moved ([`Renderer::place`], [`Renderer::set_light`], [`Renderer::set_camera`]): maps that this leaves alone are looked up
//! as they are, and [`Renderer::schedule_maps`] lets others lag, or be drawn by a thread of their own. Surfaces go into a G-buffer of one
//! texel a pixel and are lit once each, so a scene of many small triangles pays for its light by the pixel.

mod bindings;
mod deform;
mod density;
mod draw_list;
mod error;
mod exposure;
mod eye;
mod families;
mod frame;
mod geometry;
pub mod gpu;
mod heat;
mod layout;
mod lights;
mod making;
mod maps;
mod maskable;
mod masks;
mod materials;
mod moving;
mod options;
mod outlines;
mod overdraw;
mod own_wgsl;
mod peeled;
pub mod picture;
mod pipelines;
mod readback;
mod renderer;
mod screen_v;
mod settled;
mod shaders;
mod surfaces;
mod targets;
mod textures;
mod threaded;
mod timing;
mod volumes;

pub use deform::deformed;
pub use density::{DensityStatistics, EDGE_ON_COS, OctaveShare, PERCENTILES, Spread};
pub use draw_list::Work;
pub use error::RenderError;
pub use frame::{FrameReport, PassReport};
pub use gpu::Gpu;
pub use layout::MAX_LIGHTS;
pub use options::{GivenVisibility, RenderOptions, View};
pub use overdraw::{FacesShare, Overdraw, OverdrawPart, OverdrawStatistics, Under};
pub use renderer::Renderer;
pub use surfaces::DrawnSurface;
pub use threaded::MapSchedule;
pub use timing::{Measure, Statistics};
pub use umbrage;
pub use volumes::Silhouettes;
