//! What can go wrong between a renderer and its [`Shadows`](super::Shadows). Each says what to do.

use crate::ShadowError;
use umbrage_core::LightError;
use umbrage_core::technique::SettingError;

/// Why a call was refused. Nothing has changed then, but that after a refused `prepare` recording is refused, too.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ShadowsError {
    /// Maps that the device cannot make.
    #[error(transparent)]
    Shadow(#[from] ShadowError),
    /// A technique or a setting that there is not.
    #[error(transparent)]
    Setting(#[from] SettingError),
    /// A light whose numbers cannot be used.
    #[error(transparent)]
    Light(#[from] LightError),
    /// Volumes that cannot be made.
    #[error(transparent)]
    Volume(#[from] crate::volume::VolumeProblem),
    /// Masks that cannot be made.
    #[error(transparent)]
    Mask(#[from] crate::mask::MasksError),
    /// A technique that the shader does not have.
    #[error(
        "the shader of these shadows has no `{asked}`; it has {declared}. Name it with `ShadowsOptions::technique` before `Shadows::new`"
    )]
    Undeclared {
        /// What was asked for, with the choices that differ.
        asked: String,
        /// What there is.
        declared: String,
    },
    /// More than a [`ShadowsOptions`](super::ShadowsOptions) allows.
    #[error(
        "{asked} {what} are more than {most}; raise `ShadowsOptions::{option}` (up to {limit}), or remove some"
    )]
    TooMany {
        /// Of what.
        what: &'static str,
        /// Asked for.
        asked: usize,
        /// What was set.
        most: u32,
        /// The option that allows more.
        option: &'static str,
        /// What it can be at most.
        limit: u32,
    },
    /// An option that cannot be used.
    #[error("`ShadowsOptions::{option}` is {value}; it must be {allowed}")]
    Option {
        /// Which.
        option: &'static str,
        /// What it was set to.
        value: String,
        /// What would do.
        allowed: String,
    },
    /// The device can do less than this needs.
    #[error("this device has {limit} = {has}, and {needed} are needed; {advice}")]
    Limit {
        /// Which limit, as `wgpu::Limits` calls it.
        limit: &'static str,
        /// The device's.
        has: u64,
        /// What would do.
        needed: u64,
        /// The way out.
        advice: &'static str,
    },
    /// A WGSL function of the user's own that cannot be used.
    #[error(
        "the kernel cannot be used: {reason}; it must define `fn umbrage_kernel(view: UmbrageView, right: vec4f, down: vec4f) -> vec4f`"
    )]
    Kernel {
        /// Why, one line.
        reason: String,
    },
    /// The handle of something that was removed.
    #[error("the {what} of this handle was removed; forget the handle, or add the {what} anew")]
    Removed {
        /// Which kind of handle.
        what: &'static str,
    },
    /// The handle of another [`Shadows`](super::Shadows).
    #[error("the handle of this {what} belongs to another `Shadows`; each knows only those that it gave")]
    OfAnother {
        /// Which kind of handle.
        what: &'static str,
    },
    /// A mesh that casters still use.
    #[error("{casters} casters still use this mesh; remove them first")]
    InUse {
        /// How many.
        casters: usize,
    },
    /// A buffer or a view of another device.
    #[error("the {what} was made by another device than `Shadows::new` got; make both with one device")]
    ForeignDevice {
        /// Which.
        what: &'static str,
    },
    /// A buffer that cannot be read as it is said to be.
    #[error("the {what} cannot be used: {reason}")]
    Buffer {
        /// Which.
        what: &'static str,
        /// Why, and the way out.
        reason: String,
    },
    /// A number that is not finite, or a matrix that is no transform.
    #[error("the {what} is {value}; it must be {allowed}")]
    Number {
        /// Of what.
        what: &'static str,
        /// As it is.
        value: String,
        /// What would do.
        allowed: &'static str,
    },
    /// `record` before `prepare`, or after something was added or removed since.
    #[error(
        "`{call}` was called before `prepare`: call `prepare` once a frame, after all changes and before recording"
    )]
    NotPrepared {
        /// Which call.
        call: &'static str,
    },
    /// Depth of another format than was said.
    #[error(
        "the depth has the format {has:?}, and these shadows were made for {wanted:?}; pass that, or set `ShadowsOptions::depth_stencil`"
    )]
    DepthFormat {
        /// What was passed.
        has: wgpu::TextureFormat,
        /// What was said.
        wanted: wgpu::TextureFormat,
    },
    /// Depth of another size than the frame.
    #[error(
        "the depth has {has_width}x{has_height} pixels and the frame {width}x{height}; pass the size to `prepare` that is drawn"
    )]
    DepthSize {
        /// The depth's.
        has_width: u32,
        /// The depth's.
        has_height: u32,
        /// The frame's.
        width: u32,
        /// The frame's.
        height: u32,
    },
}
