//! The mathematics, tables and WGSL of real-time shadows, without any GPU API.
#![doc = ""]
//! Right-handed, metres, Y up. Matrices are named `a_from_b`; positions carry their space (`p_world`); units are in
//! names (`_m`, `_rad`, `_texel`, `_ms`). Visibility V is 1 where lit and 0 where shadowed.

pub mod bounds;
pub mod camera;
pub mod depth;
pub mod light;
pub mod projection;

pub use bounds::Aabb;
pub use camera::{Camera, Projection};
pub use depth::{DEPTH, DepthConvention};
pub use light::{Light, LightError, LightKind};
