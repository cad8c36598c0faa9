//! The truth of one light in one picture: what share of the light each pixel sees.

use crate::emitter::Emitter;
use crate::eye::{Seen, Surfaces, blocks, in_bands, rows_of};
use crate::hierarchy::{Ray, Rays, Stack};
use crate::packet::LANES;
use crate::samples::Samples;
use crate::{Progress, TruthError};
use glam::{DVec2, DVec3, UVec2, Vec3};
use umbrage_core::Light;

/// How carefully to look.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Quality {
    /// Rays from each pixel to a light that is no point. 1 to 65,536, default 64; powers of two are spread best.
    pub samples: u32,
    /// Which of many equally good sets of rays. Default 0.
    pub seed: u32,
}

impl Default for Quality {
    fn default() -> Self {
        Self { samples: 64, seed: 0 }
    }
}

/// What a pixel is to a light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Nothing is seen there. V is 1.
    Nothing,
    /// The surface's triangle faces away from the light's middle. V is 0.
    Away,
    /// Outside of the light's cone, or beyond its range. V is 0.
    Unreached,
    /// The surface faces the light, but its object is no receiver. V is 1.
    Exempt,
    /// The surface faces the light, which would shine on it were nothing in the way.
    Receiver,
}

/// The truth of one light, rows from the top.
#[derive(Clone, Debug)]
pub struct Visibility {
    /// Pixels.
    pub size: UVec2,
    /// The share of the light that arrives, for red, green and blue: 1 lit, 0 shadowed.
    pub v: Vec<Vec3>,
    /// What each pixel is to the light.
    pub place: Vec<Place>,
    /// Rays from each receiver: 1 for a light that is a point.
    pub samples: u32,
    /// Rays that it took, those of the eye not counted.
    pub rays: u64,
}

/// A ray from a surface to the light.
fn shadow_ray(rays: &Rays<'_>, emitter: &Emitter, seen: &Seen, square: Option<DVec2>) -> Ray {
    let origin_world = seen.p_world + seen.normal_world.as_dvec3() * rays.offset_m();
    let to =
        square.map_or_else(|| emitter.center(origin_world), |square| emitter.sample(origin_world, square));
    // What lies on the light itself does not shadow it.
    Ray { origin_world, way: to.way, from_m: 0.0, to_m: to.distance_m - rays.offset_m() }
}

fn place_of(rays: &Rays<'_>, emitter: &Emitter, seen: &Option<Seen>) -> Place {
    let Some(seen) = seen else { return Place::Nothing };
    if !emitter.shines_on(seen.p_world) {
        Place::Unreached
    } else if seen.normal_world.as_dvec3().dot(emitter.center(seen.p_world).way) <= 0.0 {
        Place::Away
    } else if rays.is_exempt(seen.slot) {
        Place::Exempt
    } else {
        Place::Receiver
    }
}

/// What V is where no ray is needed.
fn settled(place: Place) -> Vec3 {
    if matches!(place, Place::Nothing | Place::Exempt) { Vec3::ONE } else { Vec3::ZERO }
}

impl Visibility {
    /// Traces the light's rays from every receiver. A light that is a point takes one exact ray each.
    ///
    /// # Errors
    /// [`TruthError::Light`] and [`TruthError::OutOfRange`] for numbers that cannot be used, [`TruthError::Stopped`] when
    /// `progress` says so.
    pub fn new(
        rays: &Rays<'_>,
        surfaces: &Surfaces,
        light: &Light,
        quality: &Quality,
        progress: &Progress<'_>,
    ) -> Result<Self, TruthError> {
        light.check()?;
        if !(1..=65_536).contains(&quality.samples) {
            let value = quality.samples.into();
            return Err(TruthError::OutOfRange {
                what: "the number of samples",
                value,
                allowed: "1 to 65536",
            });
        }
        let emitter = Emitter::new(light);
        let size = surfaces.size;
        let at = |p: UVec2| (p.y * size.x + p.x) as usize;
        let place: Vec<Place> = surfaces.seen.iter().map(|seen| place_of(rays, &emitter, seen)).collect();
        let receivers = place.iter().filter(|place| **place == Place::Receiver).count() as u64;

        let (v, samples) = if emitter.is_point() {
            let band = |y: u32, stack: &mut Stack| {
                let mut rows = rows_of(size, y, Vec3::ZERO);
                for block in blocks(size, y) {
                    one_ray_each(
                        rays,
                        surfaces,
                        &emitter,
                        &place,
                        block.map(|p| (p, at(p))),
                        stack,
                        |p, v| {
                            rows[(p.y - y) as usize][p.x as usize] = v;
                        },
                    );
                }
                rows
            };
            (in_bands(size, progress, band)?, 1)
        } else {
            let samples = Samples::new(quality);
            let band = |y: u32, stack: &mut Stack| {
                let mut rows = rows_of(size, y, Vec3::ZERO);
                for pixel in blocks(size, y).flatten() {
                    let index = at(pixel);
                    rows[(pixel.y - y) as usize][pixel.x as usize] = match &surfaces.seen[index] {
                        Some(seen) if place[index] == Place::Receiver => {
                            let squares = samples.of_pixel(index as u32);
                            share_seen(rays, &emitter, seen, squares, stack)
                        }
                        _ => settled(place[index]),
                    };
                }
                rows
            };
            (in_bands(size, progress, band)?, quality.samples)
        };
        Ok(Self { size, v, place, samples, rays: receivers * u64::from(samples) })
    }

    /// Pixels that face the light and lie in its reach.
    pub fn receivers(&self) -> usize {
        self.place.iter().filter(|place| **place == Place::Receiver).count()
    }
}

/// One exact ray from each receiver of a block.
fn one_ray_each(
    rays: &Rays<'_>,
    surfaces: &Surfaces,
    emitter: &Emitter,
    place: &[Place],
    block: impl Iterator<Item = (UVec2, usize)>,
    stack: &mut Stack,
    mut put: impl FnMut(UVec2, Vec3),
) {
    let mut pixels = Vec::with_capacity(LANES);
    let mut shadow = Vec::with_capacity(LANES);
    for (pixel, index) in block {
        match &surfaces.seen[index] {
            Some(seen) if place[index] == Place::Receiver => {
                pixels.push(pixel);
                shadow.push(shadow_ray(rays, emitter, seen, None));
            }
            _ => put(pixel, settled(place[index])),
        }
    }
    if !shadow.is_empty() {
        let light = rays.light_through(&shadow, stack);
        pixels.into_iter().zip(light).for_each(|(pixel, v)| put(pixel, v));
    }
}

/// The share of an area light that a surface sees. What lies below the surface's own plane is not seen.
fn share_seen(
    rays: &Rays<'_>,
    emitter: &Emitter,
    seen: &Seen,
    squares: impl Iterator<Item = DVec2>,
    stack: &mut Stack,
) -> Vec3 {
    let normal = seen.normal_world.as_dvec3();
    let mut sum = DVec3::ZERO;
    let mut count = 0u32;
    let mut waiting = [Ray { origin_world: DVec3::ZERO, way: DVec3::Y, from_m: 0.0, to_m: 0.0 }; LANES];
    let mut filled = 0;
    let mut trace = |waiting: &[Ray]| {
        let light = rays.light_through(waiting, stack);
        sum += light[..waiting.len()].iter().map(|v| v.as_dvec3()).sum::<DVec3>();
    };
    for square in squares {
        count += 1;
        let ray = shadow_ray(rays, emitter, seen, Some(square));
        if ray.way.dot(normal) <= 0.0 {
            continue;
        }
        waiting[filled] = ray;
        filled += 1;
        if filled == LANES {
            trace(&waiting);
            filled = 0;
        }
    }
    if filled > 0 {
        trace(&waiting[..filled]);
    }
    (sum / f64::from(count)).as_vec3()
}
