//! What an eye means for volumes: which are seen, how each is counted, and where it ends.

use super::meshes::Known;
use super::{VolumeEye, VolumeItem, VolumeSettings};
use crate::volume::{Counted, VolumeCaster};
use glam::{Vec3, Vec4};
use umbrage_core::volume as maths;
use umbrage_core::volume_cut::{end_before_eye_far, eye_far_plane_world, far_plane_cuts};
use umbrage_core::{Aabb, DepthConvention, Frustum, Light};

/// How many times as long as the scene the volumes of a parallel eye are.
const LENGTHS: f32 = 1e5;
/// The same where the device clips depth: the eye's far plane should then lie behind their ends
/// ([`umbrage_core::volume::finite_length_m`] of so many times), which costs depth its precision.
pub const CUT_LENGTHS: f32 = 64.0;

/// An eye with all that is asked of it for each caster.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sight {
    pub eye: VolumeEye,
    frustum: Frustum,
    near_world: Option<[Vec3; 4]>,
    /// Its far plane, where that cuts.
    far_world: Option<Vec4>,
    lengths: f32,
}

/// A light, and all that it may darken.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lit<'a> {
    pub light: &'a Light,
    pub light_world: Vec4,
    pub scene_world: &'a Aabb,
    pub settings: &'a VolumeSettings,
}

/// How a caster's volume is drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    pub caster: VolumeCaster,
    pub counted: Counted,
    pub is_seen: bool,
    pub is_cut: bool,
}

impl Sight {
    /// `unclipped`: has the device faces that no near or far plane cuts?
    pub fn new(eye: &VolumeEye, depth: DepthConvention, unclipped: bool) -> Self {
        let clip_from_world = eye.clip_from_world;
        // The planes that wgpu cuts at, whatever a convention says of -1.
        let depth = if depth.is_reversed() { depth } else { DepthConvention::ZeroToOne };
        Self {
            eye: *eye,
            frustum: Frustum::from_clip(clip_from_world, depth),
            near_world: maths::near_corners_world(clip_from_world, depth.ndc_near()),
            far_world: eye_far_plane_world(clip_from_world, depth).filter(|_| !unclipped),
            lengths: if unclipped { LENGTHS } else { CUT_LENGTHS },
        }
    }

    /// How a caster is drawn.
    pub fn of(&self, lit: &Lit<'_>, item: &VolumeItem, mesh: Known) -> Seen {
        let Lit { light, light_world, scene_world, settings } = *lit;
        let bounds_world = &item.bounds_world;
        let may_be_in =
            self.near_world.is_none_or(|near| maths::eye_may_be_in_shadow(&near, light_world, bounds_world));
        let counted = Counted::new(settings.choices.counting, may_be_in);
        let is_behind = counted == Counted::Behind;
        let both_sides = maths::light_may_be_inside(light_world, bounds_world);
        let eye = self.near_world.filter(|_| !is_behind);
        let eye = eye.as_ref().map_or(&[][..], |corners| corners);
        let mut far_plane_world = maths::far_plane_world(light, bounds_world, scene_world, eye);
        // A plane behind all that is seen goes before a length.
        let mut extrude_m = if self.eye.is_parallel && settings.extrude_m <= 0.0 && far_plane_world.is_none()
        {
            maths::finite_length_m(scene_world, light_world, self.lengths)
        } else {
            settings.extrude_m
        };
        let is_seen = maths::shadow_may_be_seen(&self.frustum, light_world, bounds_world);
        // What is counted before surfaces is counted before the far plane, too.
        let far_world = self.far_world.filter(|_| is_behind && is_seen);
        let mut is_cut = far_world
            .is_some_and(|far| far_plane_cuts(far, light_world, extrude_m, far_plane_world, bounds_world));
        let end = far_world
            .filter(|_| is_cut && settings.extrude_m <= 0.0)
            .and_then(|far| end_before_eye_far(far, light_world, bounds_world));
        if end.is_some() {
            (is_cut, extrude_m, far_plane_world) = (false, 0.0, end);
        }
        let caster = VolumeCaster {
            mesh: item.mesh,
            version: mesh.version,
            world_from_object: item.world_from_object,
            light_world,
            inset_m: settings.inset_m,
            extrude_m,
            far_plane_world,
            both_sides,
            // What is not closed may be seen from behind, and then its lid is looked through.
            near_caps: is_behind || both_sides || mesh.is_open,
            // What ends before the surface is left through its far lid.
            far_caps: is_behind || settings.extrude_m > 0.0,
            winding: VolumeCaster::winding_of(&item.world_from_object),
        };
        Seen { caster, counted, is_seen, is_cut }
    }
}
