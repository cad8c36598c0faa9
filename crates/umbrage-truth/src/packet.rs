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

/// A coordinate of eight rays.
pub(crate) type Lanes = [f32; LANES];
pub(crate) type Lanes64 = [f64; LANES];

/// Eight rays. All that a box needs is kept in single, all that a triangle needs in double precision.
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

/// The least and greatest that a double can be in single precision.
fn below(x: f64) -> f32 {
    let rounded = x as f32;
    if f64::from(rounded) > x { rounded.next_down() } else { rounded }
}

fn above(x: f64) -> f32 {
    let rounded = x as f32;
    if f64::from(rounded) < x { rounded.next_up() } else { rounded }
}

impl Packet {
    /// A packet without rays.
    pub fn empty() -> Self {
        Self {
            origin: [[0.0; LANES]; 3],
            way: [[1.0; LANES]; 3],
            origin_f32: [[0.0; LANES]; 3],
            inverse_f32: [[1.0; LANES]; 3],
            t_min: [0.0; LANES],
            t_max: [0.0; LANES],
            t_min_f32: [0.0; LANES],
            t_max_f32: [-1.0; LANES],
            lead: Vec3::X,
            backwards: [0; 3],
            active: 0,
        }
    }

    /// Puts a ray into a lane: where it starts, where it goes, and between which multiples of `way` it counts.
    pub fn set(&mut self, lane: usize, origin: DVec3, way: DVec3, t_min: f64, t_max: f64) {
        if lane == 0 {
            self.lead = way.as_vec3();
        }
        for axis in 0..3 {
            self.origin[axis][lane] = origin[axis];
            self.way[axis][lane] = way[axis];
            self.origin_f32[axis][lane] = origin[axis] as f32;
            // Never infinite: 0 times infinity has no order.
            let way = way[axis] as f32;
            let least = 1e-18f32.copysign(way);
            self.inverse_f32[axis][lane] = 1.0 / if way.abs() < 1e-18 { least } else { way };
            self.backwards[axis] |= Mask::from(way.is_sign_negative()) << lane;
        }
        self.t_min[lane] = t_min;
        self.t_min_f32[lane] = below(t_min);
        self.active |= 1 << lane;
        self.end_at(lane, t_max);
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

    /// Does the first of the rays come by `a` before it comes by `b`?
    #[inline(always)]
    pub fn meets_first(&self, a: Vec3, b: Vec3) -> bool {
        (a - b).dot(self.lead) <= 0.0
    }

    /// Where the rays of `mask` hit a triangle (Moeller and Trumbore 1997, "Fast, Minimum Storage Ray/Triangle
    /// Intersection"). `front_only`: rays that come from its back pass.
    #[inline(always)]
    pub fn hit_triangle(&self, corners: &[Vec3; 3], front_only: bool, mask: Mask) -> Hits {
        let a = corners[0].as_dvec3();
        let (ab, ac) = (corners[1].as_dvec3() - a, corners[2].as_dvec3() - a);
        let [ox, oy, oz] = &self.origin;
        let [wx, wy, wz] = &self.way;
        let (mut det, mut u, mut v, mut t) = ([0.0; LANES], [0.0; LANES], [0.0; LANES], [0.0; LANES]);
        let mut bits = [0u64; LANES];
        let back = if front_only { -1.0 } else { 1.0 };
        for i in 0..LANES {
            let (px, py, pz) =
                (wy[i] * ac.z - wz[i] * ac.y, wz[i] * ac.x - wx[i] * ac.z, wx[i] * ac.y - wy[i] * ac.x);
            let turned = ab.x * px + ab.y * py + ab.z * pz;
            // From its back all signs are turned; undone here, so that nothing needs to be divided yet.
            let sign = if turned < 0.0 { -1.0 } else { 1.0 };
            det[i] = turned * if turned < 0.0 { -back } else { 1.0 };
            let (sx, sy, sz) = (ox[i] - a.x, oy[i] - a.y, oz[i] - a.z);
            u[i] = sign * (sx * px + sy * py + sz * pz);
            let (qx, qy, qz) = (sy * ab.z - sz * ab.y, sz * ab.x - sx * ab.z, sx * ab.y - sy * ab.x);
            v[i] = sign * (wx[i] * qx + wy[i] * qy + wz[i] * qz);
            t[i] = sign * (ac.x * qx + ac.y * qy + ac.z * qz);
            // A determinant of 0 makes the strict ones false: rays within the plane pass.
            let inside = (u[i] >= -GROWN * det[i])
                & (v[i] >= -GROWN * det[i])
                & (u[i] + v[i] <= (1.0 + GROWN) * det[i])
                & (t[i] > self.t_min[i] * det[i])
                & (t[i] < self.t_max[i] * det[i])
                & (det[i] > 0.0);
            bits[i] = if inside { 1 << i } else { 0 };
        }
        let mask = joined(bits) as Mask & mask;
        Hits::new(mask, det, t, u, v)
    }
}

#[inline(always)]
fn joined<T: Copy + std::ops::BitOr<Output = T>>(bits: [T; LANES]) -> T {
    ((bits[0] | bits[4]) | (bits[2] | bits[6])) | ((bits[1] | bits[5]) | (bits[3] | bits[7]))
}

/// Where eight rays hit a triangle; only what `mask` names counts.
#[derive(Clone, Copy, Debug)]
pub struct Hits {
    /// Which rays do.
    pub mask: Mask,
    /// Multiple of each ray's way.
    pub t: Lanes64,
    /// Weight of the second corner.
    pub u: Lanes64,
    /// Weight of the third corner.
    pub v: Lanes64,
}

impl Hits {
    /// From numbers that the determinant still multiplies.
    #[inline(always)]
    pub fn new(mask: Mask, det: Lanes64, mut t: Lanes64, mut u: Lanes64, mut v: Lanes64) -> Self {
        for lane in lanes(mask) {
            let inverse = 1.0 / det[lane];
            t[lane] *= inverse;
            u[lane] *= inverse;
            v[lane] *= inverse;
        }
        Self { mask, t, u, v }
    }
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
