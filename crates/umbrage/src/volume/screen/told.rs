//! What volumes on the screen are told: the eye, a light's settings, its casters; and what did not go well.

use crate::soften::Softness;
use glam::{Mat4, UVec2};
use umbrage_core::Aabb;
use umbrage_core::technique::volume::Volume;
use umbrage_core::technique::{Method, Settings};

/// From where volumes are seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VolumeEye {
    /// The matrix that the surfaces were drawn with, bit for bit; its depth runs as [`super::ScreenVolumes::new`] was told.
    pub clip_from_world: Mat4,
    /// Its projection alone: blurs ask it how far away a pixel is.
    pub clip_from_view: Mat4,
    /// Width and height of depth and V, pixels, 1 or more.
    pub size_px: UVec2,
    /// Is it an eye whose rays are parallel?
    pub is_parallel: bool,
}

/// How a light's volumes are drawn: a technique's choices and parameters, looked up once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VolumeSettings {
    /// Silhouettes, counting, stencil, blur.
    pub choices: Volume,
    /// How far behind the surface volumes begin, metres, 0 or more.
    pub inset_m: f32,
    /// How long they are, metres; 0: behind all that is seen.
    pub extrude_m: f32,
    /// How V is blurred, where the choices say so.
    pub softness: Softness,
}

impl VolumeSettings {
    /// Those of a technique; `None` for other families.
    pub fn of(settings: &Settings) -> Option<Self> {
        let Method::Volume(choices) = settings.method else { return None };
        let value = |name| settings.value(name).unwrap_or(0.0);
        Some(Self {
            choices,
            inset_m: value("inset_m"),
            extrude_m: value("extrude_m"),
            softness: Softness {
                width_px: value("soft_px"),
                width_m: value("soft_m"),
                like: value("like_depth"),
            },
        })
    }
}

/// A caster of a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VolumeItem {
    /// Index of the mesh, see [`super::ScreenVolumes::set_mesh`].
    pub mesh: usize,
    /// Where it is: affine. The surfaces must have been drawn with the same numbers.
    pub world_from_object: Mat4,
    /// Box around it, world space, metres.
    pub bounds_world: Aabb,
}

/// What did not go well, and what to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum VolumeProblem {
    /// More than a buffer of the device holds.
    #[error(
        "mesh {mesh} throws no shadow: its edges do not fit into a buffer of this device; use the technique `linear`"
    )]
    MeshTooLarge {
        /// Its index.
        mesh: usize,
    },
    /// A caster is of a mesh that there is not.
    #[error("mesh {mesh} throws no shadow: it is not there; set it before casters are told")]
    NoMesh {
        /// Its index.
        mesh: usize,
    },
    /// More faces than a buffer of the device holds.
    #[error(
        "light {light} throws no shadow: the faces of its volumes do not fit into a buffer of this device; \
         use the technique `linear`, or meshes with fewer triangles"
    )]
    LightTooLarge {
        /// Its slot.
        light: usize,
    },
    /// The eye's far plane cuts volumes of casters that are counted behind surfaces.
    #[error(
        "light {light}: the eye's far plane cuts shadow volumes, so shadows may be missing or turned inside out; \
         use a projection without a far plane, or a device with DEPTH_CLIP_CONTROL"
    )]
    CutByFarPlane {
        /// Its slot.
        light: usize,
    },
    /// Nothing can be counted over such a depth.
    #[error(
        "volumes are counted in a stencil beside the depth, and {format:?} has none or no depth; use Depth24PlusStencil8, or \
             Depth32FloatStencil8 where the device has it"
    )]
    Format {
        /// Asked for.
        format: wgpu::TextureFormat,
    },
    /// An index or slot that nobody needs: lists are as long as the greatest.
    #[error("{what} {number} is too large; number from 0, below {limit}")]
    TooMany {
        /// `mesh` or `light`.
        what: &'static str,
        /// Asked for.
        number: usize,
        /// The first that is not.
        limit: usize,
    },
}
