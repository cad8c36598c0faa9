//! What the camera sees: the surface at the centre of each pixel.

use crate::hierarchy::{Ray, Rays, Stack};
use crate::packet::LANES;
use crate::{Progress, TruthError};
use glam::{DVec3, UVec2, Vec3};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use umbrage_core::{Camera, Projection};

/// Pixels of a packet: neighbours across and down meet the same boxes.
pub(crate) const BLOCK: UVec2 = UVec2::new(4, 2);

/// The surface in a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// Metres.
    pub p_world: DVec3,
    /// Of the triangle itself, not the shading's; unit length, towards the eye.
    pub normal_world: Vec3,
    /// Which triangle, for [`Rays::instance`].
    pub slot: u32,
}

/// The surfaces of a picture, rows from the top.
#[derive(Clone, Debug)]
pub struct Surfaces {
    /// Pixels.
    pub size: UVec2,
    /// One for each pixel; `None` where nothing is.
    pub seen: Vec<Option<Seen>>,
    /// From where, and how, it was seen.
    pub camera: Camera,
    /// Rays that it took.
    pub rays: u64,
}

/// The camera's rays.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Eye {
    origin_world: DVec3,
    forward: DVec3,
    /// From the middle to the right and upper rim: at distance 1 for a pin-hole, anywhere for a parallel camera.
    to_right: DVec3,
    to_top: DVec3,
    parallel: bool,
    near_m: f64,
    far_m: f64,
}

impl Eye {
    pub fn new(camera: &Camera, size: UVec2) -> Self {
        let back = -camera.direction_world.as_dvec3().normalize();
        let up = camera.up_world.as_dvec3();
        // The same way out as the camera's own, where up and direction are parallel.
        let up = if up.cross(back).length_squared() > 1e-8 {
            up
        } else if back.y.abs() > 0.998 {
            DVec3::NEG_Z
        } else {
            DVec3::Y
        };
        let right = up.cross(back).normalize();
        let up = back.cross(right);
        let aspect = f64::from(size.x) / f64::from(size.y);
        let (half_height, parallel) = match camera.projection {
            Projection::Perspective { fov_y_rad } => ((0.5 * f64::from(fov_y_rad)).tan(), false),
            Projection::Orthographic { half_height_m } => (f64::from(half_height_m), true),
        };
        Self {
            origin_world: camera.position_world.as_dvec3(),
            forward: -back,
            to_right: right * (half_height * aspect),
            to_top: up * half_height,
            parallel,
            near_m: camera.near_m.into(),
            far_m: camera.far_m.into(),
        }
    }

    /// The ray through a place of the picture, pixels from its upper left corner.
    pub fn ray(&self, size: UVec2, x: f64, y: f64) -> Ray {
        let across = self.to_right * (x / f64::from(size.x) * 2.0 - 1.0)
            - self.to_top * (y / f64::from(size.y) * 2.0 - 1.0);
        let (origin_world, way) = if self.parallel {
            (self.origin_world + across, self.forward)
        } else {
            (self.origin_world, (self.forward + across).normalize())
        };
        // Near and far are planes across the camera's axis.
        let slant = way.dot(self.forward);
        Ray { origin_world, way, from_m: self.near_m / slant, to_m: self.far_m / slant }
    }

    /// Where a place appears, pixels from the picture's upper left corner; `None` behind the eye.
    pub fn pixel_of(&self, size: UVec2, p_world: DVec3) -> Option<(f64, f64)> {
        let offset = p_world - self.origin_world;
        let depth = if self.parallel { 1.0 } else { offset.dot(self.forward) };
        if depth <= 0.0 {
            return None;
        }
        let x = offset.dot(self.to_right) / self.to_right.length_squared() / depth;
        let y = offset.dot(self.to_top) / self.to_top.length_squared() / depth;
        Some((0.5 * (1.0 + x) * f64::from(size.x), 0.5 * (1.0 - y) * f64::from(size.y)))
    }
}

/// Calls `band` for each few rows, on all cores, and hands the rows back in order.
pub(crate) fn in_bands<T: Send>(
    size: UVec2,
    progress: &Progress<'_>,
    band: impl Fn(u32, &mut Stack) -> Vec<Vec<T>> + Sync,
) -> Result<Vec<T>, TruthError> {
    let bands = size.y.div_ceil(BLOCK.y);
    let done = AtomicUsize::new(0);
    let rows: Result<Vec<_>, TruthError> = (0..bands)
        .into_par_iter()
        .map_init(Stack::default, |stack, index| {
            let share = done.fetch_add(1, Ordering::Relaxed) as f32 / bands as f32;
            if progress(share).is_break() {
                return Err(TruthError::Stopped);
            }
            Ok(band(index * BLOCK.y, stack))
        })
        .collect();
    if progress(1.0).is_break() {
        return Err(TruthError::Stopped);
    }
    Ok(rows?.into_iter().flatten().flatten().collect())
}

/// The pixels of each block of a band that starts at row `y`, left to right; block by block.
pub(crate) fn blocks(size: UVec2, y: u32) -> impl Iterator<Item = impl Iterator<Item = UVec2> + Clone> {
    (0..size.x.div_ceil(BLOCK.x)).map(move |block| {
        let pixel = move |i: u32| UVec2::new(block * BLOCK.x + i % BLOCK.x, y + i / BLOCK.x);
        (0..BLOCK.element_product()).map(pixel).filter(move |p| p.x < size.x && p.y < size.y)
    })
}

/// Empty rows for the band that starts at row `y`.
pub(crate) fn rows_of<T: Clone>(size: UVec2, y: u32, value: T) -> Vec<Vec<T>> {
    (y..(y + BLOCK.y).min(size.y)).map(|_| vec![value.clone(); size.x as usize]).collect()
}

impl Surfaces {
    /// Looks through the centre of every pixel, as the renderer does. Surfaces mixed by alpha are looked through.
    ///
    /// # Errors
    /// [`TruthError::Camera`] for numbers that cannot be used, [`TruthError::Stopped`] when `progress` says so.
    pub fn new(
        rays: &Rays<'_>,
        camera: &Camera,
        size: UVec2,
        progress: &Progress<'_>,
    ) -> Result<Self, TruthError> {
        camera.check().map_err(TruthError::Camera)?;
        if size.x == 0 || size.y == 0 || size.x.max(size.y) > 1 << 15 {
            let value = u64::from(size.x).min(size.y.into());
            return Err(TruthError::OutOfRange { what: "the picture's edge", value, allowed: "1 to 32768" });
        }
        let eye = Eye::new(camera, size);
        let band = |y: u32, stack: &mut Stack| {
            let mut rows = rows_of(size, y, None);
            let mut sight = Vec::with_capacity(LANES);
            for block in blocks(size, y) {
                sight.clear();
                sight
                    .extend(block.clone().map(|p| eye.ray(size, f64::from(p.x) + 0.5, f64::from(p.y) + 0.5)));
                let found = rays.nearest(&sight, stack);
                for ((pixel, ray), found) in block.zip(&sight).zip(found) {
                    rows[(pixel.y - y) as usize][pixel.x as usize] = found.map(|found| {
                        let normal = rays.normal(found.slot);
                        let normal = if normal.dot(ray.way) > 0.0 { -normal } else { normal };
                        Seen {
                            p_world: ray.origin_world + ray.way * found.distance_m,
                            normal_world: normal.as_vec3(),
                            slot: found.slot,
                        }
                    });
                }
            }
            rows
        };
        let seen = in_bands(size, progress, band)?;
        Ok(Self { size, rays: seen.len() as u64, seen, camera: *camera })
    }

    /// Pixels.
    pub fn len(&self) -> usize {
        self.seen.len()
    }

    /// Never: a picture has pixels.
    pub fn is_empty(&self) -> bool {
        self.seen.is_empty()
    }

    /// What a pixel measures at its surface, across the line of sight, metres.
    pub fn pixel_m(&self, seen: &Seen) -> f64 {
        match self.camera.projection {
            Projection::Perspective { fov_y_rad } => {
                let offset = seen.p_world - self.camera.position_world.as_dvec3();
                let depth = offset.dot(self.camera.direction_world.as_dvec3().normalize());
                2.0 * depth * (0.5 * f64::from(fov_y_rad)).tan() / f64::from(self.size.y)
            }
            Projection::Orthographic { half_height_m } => {
                2.0 * f64::from(half_height_m) / f64::from(self.size.y)
            }
        }
    }

    /// Where a place appears in the picture, pixels from its upper left corner; `None` behind the eye.
    pub fn pixel_of(&self, p_world: DVec3) -> Option<(f64, f64)> {
        Eye::new(&self.camera, self.size).pixel_of(self.size, p_world)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_on_a_ray_appears_where_the_ray_went_through() {
        let size = UVec2::new(64, 36);
        let pin_hole = Camera::look_at(Vec3::new(1.0, 2.0, 5.0), Vec3::new(0.2, 0.1, 0.0), 0.9, 0.1, 50.0);
        let parallel = Camera { projection: Projection::Orthographic { half_height_m: 2.0 }, ..pin_hole };
        for camera in [pin_hole, parallel] {
            let eye = Eye::new(&camera, size);
            for (x, y) in [(0.5, 0.5), (32.0, 18.0), (63.5, 7.25)] {
                let ray = eye.ray(size, x, y);
                let found = eye.pixel_of(size, ray.origin_world + ray.way * 4.0).expect("before the eye");
                assert!((found.0 - x).abs() < 1e-9 && (found.1 - y).abs() < 1e-9, "{found:?}");
            }
        }
        assert_eq!(Eye::new(&pin_hole, size).pixel_of(size, DVec3::new(1.0, 2.0, 9.0)), None);
    }

    #[test]
    fn every_pixel_is_in_one_block() {
        let size = UVec2::new(7, 5);
        let mut seen = vec![0; 35];
        for y in (0..size.y).step_by(BLOCK.y as usize) {
            for pixel in blocks(size, y).flatten() {
                seen[(pixel.y * size.x + pixel.x) as usize] += 1;
            }
        }
        assert!(seen.iter().all(|count| *count == 1), "{seen:?}");
    }
}
