//! Which blockers have no mask, and why.

use super::budget::most_of_light;
use crate::bounds::Aabb;
use crate::fit::{MaskError, MaskOptions, MaskView, fit_mask};
use crate::light::Light;
use glam::Vec3;

/// Why a blocker gets no mask; a map can draw its shadow.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Unmaskable {
    /// A light that shines on it has no projection for its box.
    #[error(transparent)]
    Fit(#[from] MaskError),
    /// Larger blockers have taken all masks.
    #[error("a light has {most} masks of this size at most")]
    TooMany {
        /// How many there are for each light.
        most: usize,
    },
}

/// Which of a scene's blockers have masks.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Maskable {
    /// For each blocker why it has none; `None` for those that all lights can mask, and for those with an empty box.
    pub why: Vec<Option<Unmaskable>>,
    /// The reason of the largest blocker that has none.
    pub first: Option<Unmaskable>,
}

/// Decides which of the blockers with these boxes (world space, grown by what vertices may be moved) `lights` can mask. A blocker
/// that one of them cannot mask is masked by none, so that one map beside the masks can hold it. `throws(light, blocker)`: may
/// the blocker's shadow under the light, both by their numbers, be seen on anything? Where it may not no mask is fitted.
///
/// Where there are more blockers than masks, the larger ones get theirs.
///
/// Cost on the CPU: a fit for each light and blocker.
pub fn maskable(
    lights: &[Light],
    blockers_world: &[Aabb],
    options: &MaskOptions,
    throws: impl Fn(usize, usize) -> bool,
) -> Maskable {
    let mut found = Maskable { why: vec![None; blockers_world.len()], first: None };
    let most = most_of_light(lights.len(), options.size_texel);
    let mut numbers: Vec<usize> =
        (0..blockers_world.len()).filter(|number| !blockers_world[*number].is_empty()).collect();
    numbers.sort_by(|a, b| blockers_world[*b].radius().total_cmp(&blockers_world[*a].radius()));
    let mut wanted = 0;
    for number in numbers {
        let mut is_lit = false;
        let mut why = None;
        for (_, light) in lights.iter().enumerate().filter(|(light, _)| throws(*light, number)) {
            is_lit = true;
            let corners = blockers_world[number].corners();
            match fit_mask(light, corners.into_iter(), options) {
                Ok(_) | Err(MaskError::Unreached) => {}
                Err(error) => {
                    why = Some(Unmaskable::Fit(error));
                    break;
                }
            }
        }
        let why = why.or_else(|| (wanted >= most).then_some(Unmaskable::TooMany { most }));
        match why {
            Some(why) => {
                found.first.get_or_insert_with(|| why.clone());
                found.why[number] = Some(why);
            }
            None => wanted += usize::from(is_lit),
        }
    }
    found
}

/// Fits a mask to `points_world`, whose hull holds the blocker; where that has no projection, to the blocker's box. Where points are
/// dense at one end the other may lie too far aside of their mean; what [`maskable`] lets through has room around the middle of
/// its box.
///
/// Cost on the CPU: as [`fit_mask`].
///
/// # Errors
/// See [`MaskError`].
pub fn fit_blocker(
    light: &Light,
    points_world: impl Iterator<Item = Vec3> + Clone,
    bounds_world: &Aabb,
    options: &MaskOptions,
) -> Result<MaskView, MaskError> {
    fit_mask(light, points_world, options).or_else(|why| match why {
        MaskError::Unreached => Err(why),
        _ => fit_mask(light, bounds_world.corners().into_iter(), options),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::LightKind;
    use glam::Vec3;

    fn around(at: Vec3, half: f32) -> Aabb {
        Aabb { min: at - half, max: at + half }
    }

    fn lamp() -> Light {
        Light { kind: LightKind::Point, ..Light::default() }.aimed(Vec3::Y * 5.0, Vec3::ZERO)
    }

    #[test]
    fn what_a_light_is_inside_of_has_no_mask_and_all_else_has() {
        let blockers = [around(Vec3::ZERO, 0.5), around(Vec3::Y * 5.0, 1.0), Aabb::EMPTY];
        let found = maskable(&[lamp()], &blockers, &MaskOptions::default(), |_, _| true);
        assert_eq!(found.why, [None, Some(Unmaskable::Fit(MaskError::TooNear)), None]);
        assert_eq!(found.first, Some(Unmaskable::Fit(MaskError::TooNear)));
        let found = maskable(&[lamp()], &blockers, &MaskOptions::default(), |_, blocker| blocker != 1);
        assert_eq!(found.why, [None, None, None], "what throws no shadow needs no mask");
        let far = Light { range_m: Some(0.1), ..lamp() };
        let found = maskable(&[far], &blockers[..1], &MaskOptions::default(), |_, _| true);
        assert_eq!(found.first, None, "what is not reached needs no mask either");
    }

    #[test]
    fn the_largest_get_the_masks_there_are() {
        let options = MaskOptions { size_texel: 16384, ..MaskOptions::default() };
        assert_eq!(most_of_light(1, options.size_texel), 2);
        let blockers = [0.1, 0.3, 0.2].map(|half| around(Vec3::ZERO, half));
        let found = maskable(&[lamp()], &blockers, &options, |_, _| true);
        assert_eq!(found.why, [Some(Unmaskable::TooMany { most: 2 }), None, None]);
    }
}
