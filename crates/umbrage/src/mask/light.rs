//! The masks of one light: what it was told, and what was fitted to it.

use glam::Mat4;
use umbrage_core::fit::{MaskError, MaskOptions, MaskView};
use umbrage_core::layout_mask::GpuMask;
use umbrage_core::masks::{Picture, Rect, Shadow, fit_blocker};
use umbrage_core::{Aabb, Light};

/// A mesh of a blocker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaskPart {
    /// Number of the mesh: the caller's own.
    pub mesh: u32,
    /// Counts how often the mesh, or the holes in it, got another shape.
    pub version: u64,
    /// Where it is; affine.
    pub world_from_object: Mat4,
    /// Box around it in world space, grown by what a deformation may move its vertices.
    pub bounds_world: Aabb,
}

impl MaskPart {
    /// Do both draw the same into the same view? Where a box lies makes no other mask.
    pub(super) fn draws_as(&self, other: &Self) -> bool {
        (self.mesh, self.version, self.world_from_object)
            == (other.mesh, other.version, other.world_from_object)
    }
}

/// What throws a mask: an object with all of its parts.
#[derive(Clone, Copy, Debug)]
pub struct Blocker<'a> {
    /// Number of the object, below 0xfffffffe, or [`GpuMask::NO_OWNER`]. Receivers of the same number are not darkened by it.
    pub object: u32,
    /// Its meshes. All are drawn into one mask.
    pub parts: &'a [MaskPart],
}

impl Blocker<'_> {
    /// Box around all of it, world space.
    pub fn bounds_world(&self) -> Aabb {
        self.parts.iter().fold(Aabb::EMPTY, |all, part| all.union(&part.bounds_world))
    }
}

/// What a shadow may fall on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Receiver {
    /// Number of the object, or [`GpuMask::NO_OWNER`].
    pub object: u32,
    /// Box around it, world space.
    pub bounds_world: Aabb,
}

impl Receiver {
    /// May a mask of that object darken it?
    pub(super) fn is_darkened_by(&self, object: u32) -> bool {
        self.object != object || object == GpuMask::NO_OWNER
    }
}

/// What did not go as a user may expect. The light is a number of [`super::BlockerMasks::tell`].
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MaskWarning {
    /// Blockers without a mask. Say fewer, smaller masks or fewer lights.
    #[error("light {light}: more than {most} blockers; the rest throw no shadow")]
    TooManyBlockers {
        /// The light's number.
        light: usize,
        /// How many masks it may have.
        most: usize,
    },
    /// A blocker that this light cannot mask; [`umbrage_core::masks::maskable`] says so before, and a map can draw it.
    #[error("light {light} has no mask of object {object}: {why}")]
    Unmaskable {
        /// The light's number.
        light: usize,
        /// The blocker's object.
        object: u32,
        /// What the fit said.
        why: MaskError,
    },
}

/// Fits a mask to the corners of its parts' boxes: for callers that have no vertices on the CPU.
///
/// # Errors
/// See [`MaskError`].
pub fn fit_to_boxes(
    light: &Light,
    blocker: &Blocker<'_>,
    options: &MaskOptions,
) -> Result<MaskView, MaskError> {
    let points = blocker.parts.iter().flat_map(|part| part.bounds_world.corners());
    fit_blocker(light, points, &blocker.bounds_world(), options)
}

/// A blocker of a light, and its mask if it has one.
#[derive(Debug)]
pub(super) struct OneMask {
    pub object: u32,
    pub parts: Vec<MaskPart>,
    pub fitted: Result<MaskView, MaskError>,
    /// The pixels that it may darken.
    pub on_screen: Option<Rect>,
    /// Was it fitted after its pixels were found?
    is_new: bool,
}

/// What has to be done for what a light was told.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Changed {
    /// Masks are others, or are others' parts.
    pub masks: bool,
    /// The pixels that they may darken are others.
    pub pixels: bool,
}

/// One light.
#[derive(Debug, Default)]
pub(super) struct LightMasks {
    told: Option<(Light, MaskOptions)>,
    blockers: Vec<OneMask>,
    /// How many of `blockers` were told last; the rest keep their memory.
    count: usize,
    pub warnings: Vec<MaskWarning>,
    /// Was it told in this frame, and in the one before?
    pub is_told: bool,
    pub was_told: bool,
}

/// What a light is told.
#[derive(Clone, Copy, Debug)]
pub(super) struct Telling<'a> {
    pub number: usize,
    pub light: &'a Light,
    pub options: &'a MaskOptions,
    /// Most masks.
    pub most: usize,
    pub picture: &'a Picture,
    pub receivers: &'a [Receiver],
    /// Are picture or receivers others than when pixels were found?
    pub is_moved: bool,
}

impl LightMasks {
    /// Fits masks to blockers that are not as they were, and finds the pixels that they may darken. Nothing is put on the heap
    /// where nothing changed, nor where fewer blockers or parts come than ever came.
    pub fn tell<'a>(
        &mut self,
        telling: &Telling<'_>,
        blockers: impl IntoIterator<Item = Blocker<'a>>,
        mut fit: impl FnMut(&Light, &Blocker<'a>, &MaskOptions) -> Result<MaskView, MaskError>,
    ) -> Changed {
        let of_light = (*telling.light, *telling.options);
        let same_light = self.told == Some(of_light);
        self.told = Some(of_light);
        let mut changed = Changed { masks: !self.was_told, pixels: !self.was_told };
        self.is_told = true;
        self.warnings.clear();
        let (mut count, mut fitted) = (0, 0);
        for blocker in blockers {
            if fitted >= telling.most {
                let warning = MaskWarning::TooManyBlockers { light: telling.number, most: telling.most };
                self.warnings.push(warning);
                break;
            }
            let known = self.blockers.get_mut(count);
            let is_same = known.as_ref().is_some_and(|known| {
                count < self.count
                    && same_light
                    && known.object == blocker.object
                    && known.parts == blocker.parts
            });
            if !is_same {
                changed = Changed { masks: true, pixels: true };
                let view = fit(telling.light, &blocker, telling.options);
                match known {
                    Some(known) => {
                        known.parts.clear();
                        known.parts.extend_from_slice(blocker.parts);
                        (known.object, known.fitted, known.is_new) = (blocker.object, view, true);
                    }
                    None => self.blockers.push(OneMask {
                        object: blocker.object,
                        parts: blocker.parts.to_vec(),
                        fitted: view,
                        on_screen: None,
                        is_new: true,
                    }),
                }
            }
            match &self.blockers[count].fitted {
                Ok(_) => fitted += 1,
                Err(MaskError::Unreached) => {}
                Err(why) => self.warnings.push(MaskWarning::Unmaskable {
                    light: telling.number,
                    object: blocker.object,
                    why: why.clone(),
                }),
            }
            count += 1;
        }
        changed.masks |= count != self.count;
        changed.pixels |= count != self.count;
        self.count = count;
        let is_moved = telling.is_moved || !self.was_told;
        changed.pixels |= self.find_pixels(telling, is_moved);
        changed
    }

    /// The pixels that each mask may darken; true when any are others.
    fn find_pixels(&mut self, telling: &Telling<'_>, is_moved: bool) -> bool {
        let mut changed = false;
        for mask in &mut self.blockers[..self.count] {
            if !(mask.is_new || is_moved) {
                continue;
            }
            mask.is_new = false;
            let Ok(view) = &mask.fitted else { continue };
            let object = mask.object;
            let darkened = telling.receivers.iter().filter(|other| other.is_darkened_by(object));
            let on_screen = Shadow::new(view, telling.picture).over(darkened.map(|other| other.bounds_world));
            changed |= mask.on_screen != on_screen;
            mask.on_screen = on_screen;
        }
        changed
    }

    /// The light, once it was told.
    pub fn light(&self) -> Option<&Light> {
        self.told.as_ref().map(|(light, _)| light)
    }

    /// Its blockers that have a mask, each with its number among all of them.
    pub fn masks(&self) -> impl Iterator<Item = (usize, &OneMask)> {
        let count = if self.is_told { self.count } else { 0 };
        self.blockers[..count].iter().enumerate().filter(|(_, mask)| mask.fitted.is_ok())
    }

    /// A blocker that has a mask.
    pub fn mask(&self, number: usize) -> Option<(&OneMask, &MaskView)> {
        let mask = self.blockers.get(number)?;
        Some((mask, mask.fitted.as_ref().ok()?))
    }
}
