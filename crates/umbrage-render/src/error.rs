//! What can go wrong between a scene and a picture. Every message says what, where and what to do.

/// Why there is no picture.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// No adapter, or none of the name that was asked for.
    #[error("{0}")]
    NoAdapter(String),
    /// The adapter gave no device.
    #[error("the adapter {adapter} gave no device: {reason}")]
    NoDevice {
        /// Its name.
        adapter: String,
        /// What it said.
        reason: String,
    },
    /// A picture that no texture can hold.
    #[error(
        "a picture of {width}x{height} pixels cannot be drawn; each side must be 1 to {limit} on this adapter"
    )]
    Size {
        /// Asked for, pixels.
        width: u32,
        /// Asked for, pixels.
        height: u32,
        /// The device's limit, pixels.
        limit: u32,
    },
    /// A number of samples that the adapter does not do.
    #[error("{asked} samples a pixel cannot be drawn; this adapter does {available}")]
    Samples {
        /// Asked for.
        asked: u32,
        /// What there is.
        available: String,
    },
    /// The camera has a number that cannot be used.
    #[error("{0}")]
    Camera(String),
    /// The light has a number that cannot be used.
    #[error(transparent)]
    Light(#[from] umbrage::core::LightError),
    /// The shadow maps cannot be made.
    #[error(transparent)]
    Shadow(#[from] umbrage::ShadowError),
    /// The view shows a light that is not there or has no map.
    #[error("{0}")]
    View(String),
    /// A WGSL function of the user's own that cannot be used.
    #[error("the {what} function cannot be used: {reason}; it must be `{wanted}`")]
    Wgsl {
        /// Which.
        what: &'static str,
        /// How it is called.
        wanted: &'static str,
        /// Where and why, one line.
        reason: String,
    },
    /// What a renderer was told to change cannot be changed so.
    #[error("{0}")]
    Change(String),
    /// The GPU ran out of memory, or refused a command.
    #[error("the GPU refused the frame: {0}")]
    Gpu(String),
}
