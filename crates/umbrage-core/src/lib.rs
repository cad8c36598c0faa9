//! The mathematics, tables and WGSL of real-time shadows, without any GPU API.
#![doc = ""]
//! Right-handed, metres, Y up. Matrices are named `a_from_b`; positions carry their space (`p_world`); units are in
//! names (`_m`, `_rad`, `_texel`, `_ms`). Visibility V is 1 where lit and 0 where shadowed.

pub mod area;
pub mod bounds;
pub mod camera;
pub mod density;
pub mod depth;
pub mod edges;
pub mod fit;
pub mod frustum;
pub mod idle;
pub mod layout;
pub mod layout_mask;
pub mod light;
pub mod lookup;
pub mod masks;
pub mod plan;
pub mod projection;
pub mod split;
pub mod technique;
pub mod volume;
pub mod volume_cut;
pub mod wgsl;

pub use bounds::Aabb;
pub use camera::{Camera, Projection};
pub use depth::{DEPTH, DepthConvention};
pub use frustum::{Frustum, cone_may_see};
pub use light::{Light, LightError, LightKind, LightShape};
