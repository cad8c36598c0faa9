//! Real-time shadows for `wgpu`: maps, and the passes that draw them, recorded into your own encoder.
//!
//! Nothing here submits, blocks or owns a target. [`umbrage_core`] (re-exported as [`core`]) holds the mathematics:
//! fits, tables, WGSL.

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
