//! A caster of a light, as volumes are made of it.

use glam::{Mat4, Vec4};
use umbrage_core::volume::is_mirrored;

/// Which way round the front of a caster's triangles runs on the screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Winding {
    /// As in the mesh.
    AsIs,
    /// Its transform mirrors, or its reverse is drawn.
    Turned,
}

impl Winding {
    /// Turned once more, if so asked.
    pub fn turned(self, also: bool) -> Self {
        if (self == Self::Turned) == also { Self::AsIs } else { Self::Turned }
    }
}

/// A caster of a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VolumeCaster {
    /// Index into the list of meshes.
    pub mesh: usize,
    /// Counts how often the mesh got another shape: a volume holds as long as this and all else here.
    pub version: u64,
    /// Affine.
    pub world_from_object: Mat4,
    /// The light: see [`umbrage_core::volume::light_point_world`].
    pub light_world: Vec4,
    /// How far behind the surface, along the light, the volume begins, metres.
    pub inset_m: f32,
    /// How long it is, metres; 0: as long as `far_plane_world` says.
    pub extrude_m: f32,
    /// Where it ends: see [`umbrage_core::volume::far_plane_world`]. `None`: nowhere.
    pub far_plane_world: Option<Vec4>,
    /// Closed parts cast from both sides too: for a light that may be inside of them.
    pub both_sides: bool,
    /// Lids at the lit surface: for faces counted behind, and for open meshes.
    pub near_caps: bool,
    /// Lids at the far end: for faces counted behind, and where the eye may see it.
    pub far_caps: bool,
    /// Follows from the transform: see [`VolumeCaster::winding_of`].
    pub winding: Winding,
}

impl VolumeCaster {
    /// Has it lids at all?
    pub fn has_caps(&self) -> bool {
        self.near_caps || self.far_caps
    }

    /// With the lids of `kept` too, if that is the same caster otherwise: faces that were found with lids are right without need for
    /// them, and need not be found again when the eye leaves a shadow.
    pub fn keeping_lids(self, kept: &Self) -> Self {
        let lids = Self { near_caps: kept.near_caps, far_caps: kept.far_caps, ..self };
        let both = Self {
            near_caps: self.near_caps || kept.near_caps,
            far_caps: self.far_caps || kept.far_caps,
            ..self
        };
        if lids == *kept { both } else { self }
    }

    /// The winding of a transform.
    pub fn winding_of(world_from_object: &Mat4) -> Winding {
        if is_mirrored(world_from_object) { Winding::Turned } else { Winding::AsIs }
    }

    /// Parallel light without end: all of the volume's far end is one place.
    pub(super) fn ends_in_a_point(&self) -> bool {
        self.light_world.w == 0.0 && self.extrude_m <= 0.0 && self.far_plane_world.is_none()
    }
}
