//! The tests of [`crate::packet`] in AVX2, because compilers do not find it themselves; the same operations in the same
//! order, so that answers are the same to the last bit on every machine. A test compares the two.

use crate::packet::{GROWN, LANES, Lanes, Lanes64, Mask, Packet};
use bytemuck::cast;
use glam::Vec3;
use std::arch::x86_64::*;

/// Rays that fit into a vector of single and of double precision.
const SINGLES: usize = 8;
const DOUBLES: usize = 4;

/// A coordinate of all rays as vectors.
type Singles = [__m256; LANES / SINGLES];
type Doubles = [__m256d; LANES / DOUBLES];

#[inline]
#[target_feature(enable = "avx2")]
fn singles(lanes: &Lanes) -> Singles {
    cast(*lanes)
}

#[inline]
#[target_feature(enable = "avx2")]
fn doubles(lanes: &Lanes64, part: usize) -> __m256d {
    let all: Doubles = cast(*lanes);
    all[part]
}

/// [`Packet::reach_box`] for rays that agree on the sides by which they enter, see [`Packet::agreed_sides`].
#[inline]
#[target_feature(enable = "avx2")]
pub fn reach_box_by(packet: &Packet, backwards: [bool; 3], min: Vec3, max: Vec3, mask: Mask) -> Mask {
    let (mut enter, mut leave) = (singles(&packet.t_min_f32), singles(&packet.t_max_f32));
    for axis in 0..3 {
        let (origin, inverse) = (singles(&packet.origin_f32[axis]), singles(&packet.inverse_f32[axis]));
        let (near, far) = if backwards[axis] { (max[axis], min[axis]) } else { (min[axis], max[axis]) };
        let (near, far) = (_mm256_set1_ps(near), _mm256_set1_ps(far));
        for i in 0..enter.len() {
            enter[i] = _mm256_max_ps(_mm256_mul_ps(_mm256_sub_ps(near, origin[i]), inverse[i]), enter[i]);
            leave[i] = _mm256_min_ps(_mm256_mul_ps(_mm256_sub_ps(far, origin[i]), inverse[i]), leave[i]);
        }
    }
    reached(enter, leave) & mask
}

/// [`Packet::reach_box`]
#[inline]
#[target_feature(enable = "avx2")]
pub fn reach_box(packet: &Packet, min: Vec3, max: Vec3, mask: Mask) -> Mask {
    let (mut enter, mut leave) = (singles(&packet.t_min_f32), singles(&packet.t_max_f32));
    for axis in 0..3 {
        let (origin, inverse) = (singles(&packet.origin_f32[axis]), singles(&packet.inverse_f32[axis]));
        let (low, high) = (_mm256_set1_ps(min[axis]), _mm256_set1_ps(max[axis]));
        for i in 0..enter.len() {
            let a = _mm256_mul_ps(_mm256_sub_ps(low, origin[i]), inverse[i]);
            let b = _mm256_mul_ps(_mm256_sub_ps(high, origin[i]), inverse[i]);
            enter[i] = _mm256_max_ps(_mm256_min_ps(a, b), enter[i]);
            leave[i] = _mm256_min_ps(_mm256_max_ps(a, b), leave[i]);
        }
    }
    reached(enter, leave) & mask
}

#[inline]
#[target_feature(enable = "avx2")]
fn reached(enter: Singles, leave: Singles) -> Mask {
    let mut mask = 0;
    for i in 0..enter.len() {
        let hit = _mm256_cmp_ps::<_CMP_LE_OQ>(enter[i], leave[i]);
        mask |= (_mm256_movemask_ps(hit) as Mask) << (i * SINGLES);
    }
    mask
}

type Vector = [__m256d; 3];

#[inline]
#[target_feature(enable = "avx2")]
fn cross(a: &Vector, b: &Vector) -> Vector {
    let part = |i: usize, j: usize| _mm256_sub_pd(_mm256_mul_pd(a[i], b[j]), _mm256_mul_pd(a[j], b[i]));
    [part(1, 2), part(2, 0), part(0, 1)]
}

#[inline]
#[target_feature(enable = "avx2")]
fn dot(a: &Vector, b: &Vector) -> __m256d {
    let [x, y, z] = [0, 1, 2].map(|i| _mm256_mul_pd(a[i], b[i]));
    _mm256_add_pd(_mm256_add_pd(x, y), z)
}

#[inline]
#[target_feature(enable = "avx2")]
fn spread(v: glam::DVec3) -> Vector {
    v.to_array().map(|x| _mm256_set1_pd(x))
}

/// [`Packet::hit_triangle`]
#[inline]
#[target_feature(enable = "avx2")]
pub fn hit_triangle(packet: &Packet, corners: &[Vec3; 3], front_only: bool, mask: Mask) -> Mask {
    let a = corners[0].as_dvec3();
    let (ab, ac) = (spread(corners[1].as_dvec3() - a), spread(corners[2].as_dvec3() - a));
    let a = spread(a);
    let sign_bit = _mm256_set1_pd(-0.0);
    let zero = _mm256_setzero_pd();
    let mut hit: Mask = 0;
    for part in 0..LANES / DOUBLES {
        let way = [0, 1, 2].map(|i| doubles(&packet.way[i], part));
        let p = cross(&way, &ac);
        let turned = dot(&ab, &p);
        // From its back all signs are turned; undone here, so that nothing needs to be divided yet.
        let sign = _mm256_and_pd(turned, sign_bit);
        let det = if front_only { turned } else { _mm256_xor_pd(turned, sign) };
        let s = [0, 1, 2].map(|i| _mm256_sub_pd(doubles(&packet.origin[i], part), a[i]));
        let u = _mm256_xor_pd(dot(&s, &p), sign);
        let least = _mm256_mul_pd(_mm256_set1_pd(-GROWN), det);
        let most = _mm256_mul_pd(_mm256_set1_pd(1.0 + GROWN), det);
        let between =
            _mm256_and_pd(_mm256_cmp_pd::<_CMP_GE_OQ>(u, least), _mm256_cmp_pd::<_CMP_LE_OQ>(u, most));
        // Most rays pass a triangle on one side, with all their neighbours.
        if _mm256_movemask_pd(between) == 0 {
            continue;
        }
        let q = cross(&s, &ab);
        let v = _mm256_xor_pd(dot(&way, &q), sign);
        let t = _mm256_xor_pd(dot(&ac, &q), sign);
        let within = _mm256_and_pd(
            _mm256_cmp_pd::<_CMP_GE_OQ>(v, least),
            _mm256_cmp_pd::<_CMP_LE_OQ>(_mm256_add_pd(u, v), most),
        );
        let along = _mm256_and_pd(
            _mm256_cmp_pd::<_CMP_GT_OQ>(t, _mm256_mul_pd(doubles(&packet.t_min, part), det)),
            _mm256_cmp_pd::<_CMP_LT_OQ>(t, _mm256_mul_pd(doubles(&packet.t_max, part), det)),
        );
        let solid = _mm256_and_pd(between, _mm256_cmp_pd::<_CMP_GT_OQ>(det, zero));
        let all = _mm256_and_pd(_mm256_and_pd(within, along), solid);
        hit |= (_mm256_movemask_pd(all) as Mask) << (part * DOUBLES);
    }
    hit & mask
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::packet::{Lane, lanes};
    use glam::DVec3;

    /// Numbers from -1 to 1.
    fn numbers(mut seed: u64) -> impl FnMut() -> f64 {
        move || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        }
    }

    #[test]
    fn answers_are_the_same_to_the_last_bit() {
        if !is_x86_feature_detected!("avx2") {
            eprintln!("SKIPPED: this machine has no AVX2");
            return;
        }
        let mut number = numbers(7);
        let mut point = move || DVec3::new(number(), number(), number());
        let (mut boxes, mut triangles, mut agreed) = (0, 0, 0);
        for round in 0..20_000 {
            let rays = [0; LANES].map(|_| {
                let way = point().normalize();
                let way = match round % 5 {
                    0 => DVec3::Y,
                    1 => DVec3::new(way.x.abs(), -way.y.abs(), way.z.abs()),
                    _ => way,
                };
                Lane {
                    origin: point(),
                    way,
                    t_min: 0.0,
                    t_max: if round % 7 == 3 { f64::INFINITY } else { 2.0 },
                }
            });
            let packet = Packet::new(&rays);
            let corners = [point(), point(), point()].map(|p| p.as_vec3());
            let (min, max) = (corners[0].min(corners[1]), corners[0].max(corners[1]));
            let mask = if round % 3 == 0 { 0xa7 } else { 0xff };
            // SAFETY: asked for above.
            #[allow(unsafe_code)]
            let reached = unsafe { reach_box(&packet, min, max, mask) };
            assert_eq!(reached, packet.reach_box(min, max, mask));
            if let Some(backwards) = packet.agreed_sides() {
                // SAFETY: asked for above.
                #[allow(unsafe_code)]
                let by = unsafe { reach_box_by(&packet, backwards, min, max, mask) };
                assert_eq!(by, reached);
                agreed += u32::from(by != 0);
            }
            boxes += u32::from(reached != 0);
            for front_only in [false, true] {
                // SAFETY: asked for above.
                #[allow(unsafe_code)]
                let hits = unsafe { hit_triangle(&packet, &corners, front_only, mask) };
                assert_eq!(hits, packet.hit_triangle(&corners, front_only, mask));
                for lane in lanes(hits) {
                    let hit = packet.hit_at(&corners, lane);
                    assert!(hit.t > 0.0 && hit.u >= -GROWN && hit.v >= -GROWN, "{hit:?}");
                }
                triangles += u32::from(hits != 0);
            }
        }
        assert!(boxes > 1000 && triangles > 1000 && agreed > 200, "{boxes} {triangles} {agreed}");
    }
}
