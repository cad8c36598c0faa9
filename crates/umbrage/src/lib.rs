//! Real-time shadows for `wgpu`: in your renderer, with your meshes, passes and materials.
//!
//! [`Shadows`] holds lights and casters by handle, gives any technique to each light, records the passes into your encoder and gives
//! your shader one bind group and one function. Nothing here submits, waits or owns your targets; where nothing moved, nothing is
//! drawn, written or allocated.
//!
//! # A first shadow
//!
//! ```no_run
//! use glam::{Mat4, Vec3};
//! use umbrage::core::{Aabb, Light};
//! use umbrage::{CasterMesh, Frame, Shadows, ShadowsError, ShadowsOptions};
//!
//! // Once: which techniques there may be, what casts, what shines.
//! fn set_up(
//!     device: &wgpu::Device,
//!     queue: &wgpu::Queue,
//!     vertices: &wgpu::Buffer,
//!     indices: &wgpu::Buffer,
//! ) -> Result<Shadows, ShadowsError> {
//!     let mut shadows = Shadows::new(device, queue, ShadowsOptions::default())?;
//!     // Positions are the first 12 of every 24 bytes.
//!     let bounds = Aabb { min: Vec3::splat(-1.0), max: Vec3::splat(1.0) };
//!     let mesh = CasterMesh::new(vertices, 0..24, bounds)
//!         .interleaved(0, 24)
//!         .indexed(indices, wgpu::IndexFormat::Uint32, 0..36);
//!     let mesh = shadows.add_mesh(&mesh)?;
//!     shadows.add_caster(mesh, Mat4::from_translation(Vec3::Y))?;
//!     shadows.add_receiver(Aabb { min: Vec3::new(-9.0, 0.0, -9.0), max: Vec3::new(9.0, 0.0, 9.0) })?;
//!     shadows.add_light(Light::sun(Vec3::new(-3.0, -5.0, -2.0)))?;
//!     Ok(shadows)
//! }
//!
//! // Where you make the pipeline that lights surfaces: one more group, and text before your own.
//! fn shader(shadows: &Shadows, own: &str) -> String {
//!     // fs: let v = umbrage_visibility(0u, p_world, cross(dpdx(p_world), dpdy(p_world)), position.xy);
//!     [shadows.wgsl(1).as_str(), own].join("\n")
//! }
//!
//! // Each frame, before your own passes.
//! fn frame(
//!     shadows: &mut Shadows,
//!     encoder: &mut wgpu::CommandEncoder,
//!     (view_from_world, clip_from_view): (Mat4, Mat4),
//! ) -> Result<(), ShadowsError> {
//!     shadows.prepare(&Frame::from_matrices(view_from_world, clip_from_view, [1280, 720]))?;
//!     shadows.record(encoder)?;
//!     // Then, in the pass that lights: pass.set_bind_group(1, shadows.bind_group(), &[]);
//!     Ok(())
//! }
//! ```
//!
//! # More
//!
//! - What is called when, and what each family needs: `docs/guide/renderer.md`.
//! - Techniques: name more than one in [`ShadowsOptions`], and give each light its own with [`Shadows::set_technique_named`], at any
//!   time. `umbrage techniques` lists them with their parameters.
//! - Volumes and subtractive masks find V on the screen: call [`Shadows::record_screen`] after your depth is drawn.
//! - V without a change to your shaders: [`Shadows::record_visibility`].
//! - Meshes that no buffer describes: [`Shadows::add_own_caster`] and [`Shadows::record_with`].
//! - The passes alone, in their modules below, for renderers with their own bookkeeping; the mathematics alone, in
//!   [`umbrage_core`] (re-exported as [`core`]): fits, tables, WGSL modules without bindings.
//!
//! Units are metres, radians, texels and pixels, in names. World space is right-handed. Maps are reversed in depth; your own depth
//! may run either way.

pub mod caster;
pub mod format;
pub mod growing;
pub mod layers;
pub mod maps;
pub mod mask;
pub mod peel;
pub mod shadows;
pub mod soften;
pub mod translucent;
pub mod volume;

pub use caster::{CasterPipelines, CasterStreams, CasterVertices, record_caster_pass};
pub use format::{ChosenFormat, choose_format};
pub use maps::ShadowMaps;
pub use peel::{Peel, PeelPipelines, record_peel};
pub use shadows::{
    CasterHandle, CasterMesh, Frame, LightHandle, MeshHandle, ReceiverHandle, Shadows, ShadowsError,
    ShadowsOptions,
};
pub use translucent::{TranslucentMaps, TranslucentPipelines, record_color_pass, record_nearest_pass};
pub use umbrage_core as core;

/// What can go wrong on the GPU's side. Each says what to do.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ShadowError {
    /// The adapter cannot draw to this depth format or cannot compare with it.
    #[error(
        "the adapter cannot use {storage} shadow maps (it lacks {lacks}); set storage=auto, or one of: {available}"
    )]
    Format {
        /// Which storage was asked for.
        storage: &'static str,
        /// What the adapter lacks.
        lacks: &'static str,
        /// What it has.
        available: String,
    },
    /// A map larger than the device's textures may be.
    #[error(
        "a {size_texel}x{size_texel} shadow map with {layers} layers is more than this device's textures may have ({limit}x{limit}, {layer_limit} layers); set a smaller map_size, fewer views, or fewer lights"
    )]
    TooLarge {
        /// Asked for, texels.
        size_texel: u32,
        /// Asked for.
        layers: u32,
        /// The device's limit, texels.
        limit: u32,
        /// The device's limit.
        layer_limit: u32,
    },
}
