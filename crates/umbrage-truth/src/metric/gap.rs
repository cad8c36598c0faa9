//! The gap between a caster and its shadow (peter-panning).

use super::{Judged, grey, to_light};
use crate::eye::{in_bands, rows_of};
use crate::hierarchy::{Ray, Rays, Stack};
use crate::{Emitter, Place, Progress, Surfaces, TruthError, Visibility};
use glam::{UVec2, Vec3};
use umbrage_core::Light;

/// V above which a place counts as lit.
const LIT: f32 = 0.5;
/// How high above its surface a ray looks for the contact, in pixels there.
const HEIGHT_PX: f64 = 0.5;

/// Where a shadowed place's caster touches its surface.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Contact {
    /// Along the surface, metres.
    distance_m: f32,
    /// Where it is in the picture.
    pixel: (f32, f32),
}

/// Contacts of the shadows in a picture: for each shadowed pixel, how far along its surface, towards the light, the thing
/// that shadows it stands on that surface. Shadows of what floats have none.
#[derive(Clone, Debug)]
pub struct Contacts {
    size: UVec2,
    of_pixel: Vec<Option<Contact>>,
}

impl Contacts {
    /// Looks for them: from each place in full shadow a ray runs close above its surface to where the light is above; what
    /// it meets is the contact if the same thing blocks the light.
    ///
    /// # Errors
    /// [`TruthError::Stopped`] when `progress` says so.
    pub fn new(
        rays: &Rays<'_>,
        surfaces: &Surfaces,
        light: &Light,
        truth: &Visibility,
        progress: &Progress<'_>,
    ) -> Result<Self, TruthError> {
        let size = surfaces.size;
        let emitter = Emitter::new(light);
        let of = |pixel: usize, stack: &mut Stack| {
            let dark = truth.place[pixel] == Place::Receiver && truth.v[pixel].max_element() <= 0.0;
            let seen = surfaces.seen[pixel].filter(|_| dark)?;
            let normal = seen.normal_world.as_dvec3();
            let to_light = to_light(rays, &emitter, &seen);
            // A light straight above has no side that a shadow could begin on.
            let along = to_light.way.reject_from_normalized(normal).try_normalize()?;
            let blocker = rays.blocker(&to_light, stack)?;
            let height_m = HEIGHT_PX * surfaces.pixel_m(&seen);
            // Not farther than the light's own foot.
            let to_m = to_light.to_m * to_light.way.dot(along);
            let near = Ray { origin_world: seen.p_world + normal * height_m, way: along, from_m: 0.0, to_m };
            let foot = rays.blocker(&near, stack)?;
            let same = rays.instance(foot.slot) == rays.instance(blocker.slot);
            let (x, y) = surfaces.pixel_of(seen.p_world + along * foot.distance_m).filter(|_| same)?;
            Some(Contact { distance_m: foot.distance_m as f32, pixel: (x as f32, y as f32) })
        };
        let band = |y: u32, stack: &mut Stack| {
            let mut rows = rows_of(size, y, None);
            for (row, pixels) in rows.iter_mut().enumerate() {
                for (x, contact) in pixels.iter_mut().enumerate() {
                    *contact = of((y as usize + row) * size.x as usize + x, stack);
                }
            }
            rows
        };
        Ok(Self { size, of_pixel: in_bands(size, progress, band)? })
    }

    /// The greatest distance from a contact to where its shadow begins, metres: every place from the contact on is lit
    /// though it lies in shadow. 0 where shadows begin at their contacts; `None` where nothing touches, or only within
    /// what the technique cannot resolve.
    pub fn gap_m(&self, judged: &Judged, v: &[Vec3], reach_px: &[f32]) -> Option<f64> {
        self.gap(judged, v, reach_px, |_| 1.0)
    }

    /// [`Self::gap_m`] in other units: `unit_m` is how long one is at a pixel, metres.
    pub fn gap(
        &self,
        judged: &Judged,
        v: &[Vec3],
        reach_px: &[f32],
        unit_m: impl Fn(usize) -> f64,
    ) -> Option<f64> {
        let mut gap: Option<f64> = None;
        for (pixel, contact) in self.of_pixel.iter().enumerate() {
            let Some(contact) = contact.filter(|_| judged.is_sure(pixel, reach_px[pixel])) else { continue };
            let is_lit = self.is_lit_all_along(pixel, contact, judged, v);
            let lit = if is_lit { f64::from(contact.distance_m) / unit_m(pixel) } else { 0.0 };
            gap = Some(gap.unwrap_or(0.0).max(lit));
        }
        gap
    }

    fn is_lit_all_along(&self, pixel: usize, contact: Contact, judged: &Judged, v: &[Vec3]) -> bool {
        let is_lit = |pixel: usize| grey(v[pixel]) > LIT;
        if !is_lit(pixel) {
            return false;
        }
        let (width, height) = (self.size.x as usize, self.size.y as usize);
        let (x, y) = ((pixel % width) as f32 + 0.5, (pixel / width) as f32 + 0.5);
        let (dx, dy) = (contact.pixel.0 - x, contact.pixel.1 - y);
        let steps = dx.abs().max(dy.abs()).floor();
        // The pixel of the contact itself may show the caster.
        (1..steps as usize).all(|step| {
            let share = step as f32 / steps;
            let (x, y) = (x + dx * share, y + dy * share);
            if x < 0.0 || y < 0.0 || x >= width as f32 || y >= height as f32 {
                return true;
            }
            let at = y as usize * width + x as usize;
            // What stands before the shadow hides it, and says nothing about it.
            !judged.receivers()[at] || (judged.truth()[at].max_element() <= 0.0 && is_lit(at))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A shadow of a row of pixels: its contact is left of column 2, a pixel is 0.1 m.
    fn row(lit: &[usize]) -> (Contacts, Judged, Vec<Vec3>) {
        let size = UVec2::new(30, 1);
        let of_pixel = (0..30)
            .map(|x| (x >= 2).then(|| Contact { distance_m: 0.1 * (x - 1) as f32, pixel: (1.5, 0.5) }))
            .collect();
        let judged = Judged::new(size, vec![Vec3::ZERO; 30], &[true; 30], vec![true; 30]);
        let v = (0..30).map(|x| if lit.contains(&x) { Vec3::ONE } else { Vec3::ZERO }).collect();
        (Contacts { size, of_pixel }, judged, v)
    }

    fn gap(lit: &[usize]) -> f64 {
        let (contacts, judged, v) = row(lit);
        contacts.gap_m(&judged, &v, &[0.0; 30]).expect("there are contacts")
    }

    #[test]
    fn light_counts_from_the_contact_on_only() {
        assert_eq!(gap(&[]), 0.0);
        assert!((gap(&[2, 3, 4]) - 0.3).abs() < 1e-6);
        // A hole in the shadow is no gap.
        assert_eq!(gap(&[7, 8, 9]), 0.0);
        assert!((gap(&[2, 3, 7, 8]) - 0.2).abs() < 1e-6);
    }

    #[test]
    fn without_a_contact_or_within_reach_there_is_nothing_to_say() {
        let (mut contacts, _, v) = row(&[2]);
        let truth: Vec<Vec3> = (0..30).map(|x| if x < 28 { Vec3::ZERO } else { Vec3::ONE }).collect();
        let judged = Judged::new(contacts.size, truth, &[true; 30], vec![true; 30]);
        assert!(contacts.gap_m(&judged, &v, &[9.0; 30]).is_some());
        assert_eq!(contacts.gap_m(&judged, &v, &[90.0; 30]), None);
        contacts.of_pixel.fill(None);
        assert_eq!(contacts.gap_m(&judged, &v, &[0.0; 30]), None);
    }
}
