//! Eight rays at once: what they share of a hierarchy's boxes is tested with one instruction for all of them.
//!
//! Boxes are tested in single precision, conservatively (see [`crate::Rays`]); triangles in double precision, so that a
//! surface that shadows itself needs no epsilon to be told apart from one that does not.

use glam::{DVec3, Vec3};

/// Rays of a packet.
pub const LANES: usize = 8;

/// One bit a ray.
pub type Mask = u8;

/// Triangles are this much larger than they are, in shares of their edges: rays that hit the common edge of two then
/// never pass between them for rounding's sake.
pub(crate) const GROWN: f64 = 1e-12;

/// A coordinate of all rays.
pub(crate) type Lanes = [f32; LANES];
pub(crate) type Lanes64 = [f64; LANES];

/// The rays. All that a box needs is kept in single, all that a triangle needs in double precision.
#[derive(Clone, Copy, Debug)]
pub struct Packet {
    pub(crate) origin: [Lanes64; 3],
    pub(crate) way: [Lanes64; 3],
    pub(crate) origin_f32: [Lanes; 3],
    pub(crate) inverse_f32: [Lanes; 3],
    pub(crate) t_min: Lanes64,
    pub(crate) t_max: Lanes64,
    pub(crate) t_min_f32: Lanes,
    pub(crate) t_max_f32: Lanes,
    /// Where the first ray goes.
    lead: Vec3,
    /// One bit a ray, for each axis: does it go backwards along it?
    backwards: [Mask; 3],
    /// Rays that are there and not ended yet.
    pub active: Mask,
}

/// A single-precision number that is surely not above, or not below, a double.
#[inline(always)]
fn below(x: f64) -> f32 {
    let x = x as f32;
    if x.is_finite() { x - x.abs() * f32::EPSILON } else { x }
}

#[inline(always)]
fn above(x: f64) -> f32 {
    let x = x as f32;
    if x.is_finite() { x + x.abs() * f32::EPSILON } else { x }
}

/// A ray as a packet takes it: where it starts, where it goes, and between which multiples of `way` it counts.
#[derive(Clone, Copy, Debug)]
pub struct Lane {
    /// Relative to the scene's middle.
    pub origin: DVec3,
    /// Unit length.
    pub way: DVec3,
    /// Nearer does not count.
    pub t_min: f64,
    /// Farther does not count; may be infinite.
    pub t_max: f64,
}

impl Packet {
    /// A packet of one to [`LANES`] rays. Lanes that are left over repeat the last ray and are not active.
    #[inline(always)]
    pub fn new(rays: &[Lane]) -> Self {
        let count = rays.len().clamp(1, LANES);
        let ray = |lane: usize| &rays[lane.min(count - 1)];
        let mut made = Self {
            origin: [[0.0; LANES]; 3],
            way: [[0.0; LANES]; 3],
            origin_f32: [[0.0; LANES]; 3],
            inverse_f32: [[0.0; LANES]; 3],
            t_min: std::array::from_fn(|lane| ray(lane).t_min),
            t_max: std::array::from_fn(|lane| ray(lane).t_max),
            t_min_f32: [0.0; LANES],
            t_max_f32: [0.0; LANES],
            lead: rays[0].way.as_vec3(),
            backwards: [0; 3],
            active: Mask::MAX >> (LANES - count),
        };
        for axis in 0..3 {
            made.origin[axis] = std::array::from_fn(|lane| ray(lane).origin[axis]);
            made.way[axis] = std::array::from_fn(|lane| ray(lane).way[axis]);
            for lane in 0..LANES {
                made.origin_f32[axis][lane] = made.origin[axis][lane] as f32;
                // Never infinite: 0 times infinity has no order.
                let way = made.way[axis][lane] as f32;
                let least = 1e-18f32.copysign(way);
                made.inverse_f32[axis][lane] = 1.0 / if way.abs() < 1e-18 { least } else { way };
                made.backwards[axis] |= Mask::from(way.is_sign_negative()) << lane;
            }
        }
        for lane in 0..LANES {
            made.t_min_f32[lane] = below(made.t_min[lane]);
            made.t_max_f32[lane] = above(made.t_max[lane]);
        }
        made
    }

    /// The ray counts only up to here.
    pub fn end_at(&mut self, lane: usize, t_max: f64) {
        self.t_max[lane] = t_max;
        self.t_max_f32[lane] = above(t_max);
    }

    /// For each axis whether all rays go backwards along it; `None` when they do not agree. Rays that agree enter all boxes
    /// by the same three sides.
    pub fn agreed_sides(&self) -> Option<[bool; 3]> {
        let all = |axis: Mask| match axis & self.active {
            0 => Some(false),
            some if some == self.active => Some(true),
            _ => None,
        };
        let [x, y, z] = self.backwards.map(all);
        Some([x?, y?, z?])
    }

    /// Which of the rays in `mask` reach a box.
    #[inline(always)]
    pub fn reach_box(&self, min: Vec3, max: Vec3, mask: Mask) -> Mask {
        let (mut enter, mut leave) = (self.t_min_f32, self.t_max_f32);
        for axis in 0..3 {
            let (low, high) = (min[axis], max[axis]);
            let (origin, inverse) = (&self.origin_f32[axis], &self.inverse_f32[axis]);
            for i in 0..LANES {
                let a = (low - origin[i]) * inverse[i];
                let b = (high - origin[i]) * inverse[i];
                let (near, far) = if a < b { (a, b) } else { (b, a) };
                enter[i] = if near > enter[i] { near } else { enter[i] };
                leave[i] = if far < leave[i] { far } else { leave[i] };
            }
        }
        // Each lane's own bit, then all of them joined: a form that compilers turn into few instructions.
        let mut bits = [0u32; LANES];
        for i in 0..LANES {
            bits[i] = if enter[i] <= leave[i] { 1 << i } else { 0 };
        }
        joined(bits) as Mask & mask
    }

    /// How far along the first ray's way a place lies; a measure for order only.
    #[inline(always)]
    pub fn along(&self, p: Vec3) -> f32 {
        p.dot(self.lead)
    }

    /// Which rays of `mask` hit a triangle (Moeller and Trumbore 1997, "Fast, Minimum Storage Ray/Triangle
    /// Intersection"). `front_only`: rays that come from its back pass.
    #[inline(always)]
    pub fn hit_triangle(&self, corners: &[Vec3; 3], front_only: bool, mask: Mask) -> Mask {
        let mut hits = 0;
        for lane in lanes(mask) {
            let Solved { turned, det, u, v, t } = self.solve(corners, lane);
            // A determinant of 0 makes the strict ones false: rays within the plane pass.
            let inside = (u >= -GROWN * det)
                & (u <= (1.0 + GROWN) * det)
                & (v >= -GROWN * det)
                & (u + v <= (1.0 + GROWN) * det)
                & (t > self.t_min[lane] * det)
                & (t < self.t_max[lane] * det)
                & (det > 0.0)
                & !(front_only && turned);
            hits |= Mask::from(inside) << lane;
        }
        hits
    }

    /// Where a ray that hits a triangle hits it.
    pub fn hit_at(&self, corners: &[Vec3; 3], lane: usize) -> Hit {
        let Solved { det, u, v, t, .. } = self.solve(corners, lane);
        Hit { t: t / det, u: u / det, v: v / det }
    }

    #[inline(always)]
    fn solve(&self, corners: &[Vec3; 3], lane: usize) -> Solved {
        let a = corners[0].as_dvec3();
        let (ab, ac) = (corners[1].as_dvec3() - a, corners[2].as_dvec3() - a);
        let of_lane = |of: &[Lanes64; 3]| DVec3::new(of[0][lane], of[1][lane], of[2][lane]);
        let way = of_lane(&self.way);
        let p = way.cross(ac);
        let det = ab.dot(p);
        // From its back all signs are turned; undone here, so that nothing needs to be divided yet.
        let sign = if det.is_sign_negative() { -1.0 } else { 1.0 };
        let s = of_lane(&self.origin) - a;
        let q = s.cross(ab);
        Solved {
            turned: det.is_sign_negative(),
            det: sign * det,
            u: sign * s.dot(p),
            v: sign * way.dot(q),
            t: sign * ac.dot(q),
        }
    }
}

/// A ray's equation with a triangle's plane; `det`, above 0, still multiplies the others.
struct Solved {
    /// Does the ray come from the triangle's back?
    turned: bool,
    det: f64,
    u: f64,
    v: f64,
    t: f64,
}

#[inline(always)]
fn joined<T: Copy + Default + std::ops::BitOr<Output = T>>(bits: [T; LANES]) -> T {
    bits.into_iter().fold(T::default(), |joined, bit| joined | bit)
}

/// Where a ray hits a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Multiple of the ray's way.
    pub t: f64,
    /// Weight of the second corner.
    pub u: f64,
    /// Weight of the third corner.
    pub v: f64,
}

/// The lanes of a mask, lowest first.
pub fn lanes(mut mask: Mask) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        (mask != 0).then(|| {
            let lane = mask.trailing_zeros() as usize;
            mask &= mask - 1;
            lane
        })
    })
}
