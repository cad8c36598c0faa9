//! The tests of [`crate::packet`] in AVX2, because compilers do not find it themselves; the same operations in the same
//! order, so that answers are the same to the last bit on every machine. A test compares the two.

use crate::packet::{GROWN, Hits, LANES, Lanes, Lanes64, Mask, Packet};
use bytemuck::cast;
use glam::Vec3;
use std::arch::x86_64::*;

/// Half a packet in double precision.
const HALF: usize = LANES / 2;

#[inline]
#[target_feature(enable = "avx2")]
fn single(lanes: &Lanes) -> __m256 {
    cast(*lanes)
}

#[inline]
#[target_feature(enable = "avx2")]
fn double(lanes: &Lanes64, half: usize) -> __m256d {
    let [low, high]: [__m256d; 2] = cast(*lanes);
    if half == 0 { low } else { high }
}

/// [`Packet::reach_box`] for rays that agree on the sides by which they enter, see [`Packet::agreed_sides`].
#[inline]
#[target_feature(enable = "avx2")]
pub fn reach_box_by(packet: &Packet, backwards: [bool; 3], min: Vec3, max: Vec3, mask: Mask) -> Mask {
    let (mut enter, mut leave) = (single(&packet.t_min_f32), single(&packet.t_max_f32));
    for axis in 0..3 {
        let (origin, inverse) = (single(&packet.origin_f32[axis]), single(&packet.inverse_f32[axis]));
        let (near, far) = if backwards[axis] { (max[axis], min[axis]) } else { (min[axis], max[axis]) };
        let near = _mm256_mul_ps(_mm256_sub_ps(_mm256_set1_ps(near), origin), inverse);
        let far = _mm256_mul_ps(_mm256_sub_ps(_mm256_set1_ps(far), origin), inverse);
        enter = _mm256_max_ps(near, enter);
        leave = _mm256_min_ps(far, leave);
    }
    _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(enter, leave)) as Mask & mask
}

/// [`Packet::reach_box`]
#[inline]
#[target_feature(enable = "avx2")]
pub fn reach_box(packet: &Packet, min: Vec3, max: Vec3, mask: Mask) -> Mask {
    let (mut enter, mut leave) = (single(&packet.t_min_f32), single(&packet.t_max_f32));
    for axis in 0..3 {
        let (origin, inverse) = (single(&packet.origin_f32[axis]), single(&packet.inverse_f32[axis]));
        let a = _mm256_mul_ps(_mm256_sub_ps(_mm256_set1_ps(min[axis]), origin), inverse);
        let b = _mm256_mul_ps(_mm256_sub_ps(_mm256_set1_ps(max[axis]), origin), inverse);
        enter = _mm256_max_ps(_mm256_min_ps(a, b), enter);
        leave = _mm256_min_ps(_mm256_max_ps(a, b), leave);
    }
    _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(enter, leave)) as Mask & mask
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
pub fn hit_triangle(packet: &Packet, corners: &[Vec3; 3], front_only: bool, mask: Mask) -> Hits {
    let a = corners[0].as_dvec3();
    let (ab, ac) = (spread(corners[1].as_dvec3() - a), spread(corners[2].as_dvec3() - a));
    let a = spread(a);
    let sign_bit = _mm256_set1_pd(-0.0);
    let zero = _mm256_setzero_pd();
    let (mut det, mut t, mut u, mut v) = ([zero; 2], [zero; 2], [zero; 2], [zero; 2]);
    let (mut sign, mut s, mut way) = ([zero; 2], [[zero; 3]; 2], [[zero; 3]; 2]);
    let mut hit: Mask = 0;
    for half in 0..2 {
        way[half] = [0, 1, 2].map(|i| double(&packet.way[i], half));
        let p = cross(&way[half], &ac);
        let turned = dot(&ab, &p);
        // From its back all signs are turned; undone here, so that nothing needs to be divided yet.
        sign[half] = _mm256_and_pd(turned, sign_bit);
        det[half] = if front_only { turned } else { _mm256_xor_pd(turned, sign[half]) };
        s[half] = [0, 1, 2].map(|i| _mm256_sub_pd(double(&packet.origin[i], half), a[i]));
        u[half] = _mm256_xor_pd(dot(&s[half], &p), sign[half]);
        let least = _mm256_mul_pd(_mm256_set1_pd(-GROWN), det[half]);
        let most = _mm256_mul_pd(_mm256_set1_pd(1.0 + GROWN), det[half]);
        let within = _mm256_and_pd(
            _mm256_cmp_pd::<_CMP_GE_OQ>(u[half], least),
            _mm256_cmp_pd::<_CMP_LE_OQ>(u[half], most),
        );
        hit |= (_mm256_movemask_pd(within) as Mask) << (half * HALF);
    }
    // Most packets pass a triangle on one side with all their rays.
    if hit & mask == 0 {
        return Hits::new(0, cast(det), cast(t), cast(u), cast(v));
    }
    hit = 0;
    for half in 0..2 {
        let q = cross(&s[half], &ab);
        v[half] = _mm256_xor_pd(dot(&way[half], &q), sign[half]);
        t[half] = _mm256_xor_pd(dot(&ac, &q), sign[half]);
        let least = _mm256_mul_pd(_mm256_set1_pd(-GROWN), det[half]);
        let most = _mm256_mul_pd(_mm256_set1_pd(1.0 + GROWN), det[half]);
        let within = _mm256_and_pd(
            _mm256_and_pd(
                _mm256_cmp_pd::<_CMP_GE_OQ>(u[half], least),
                _mm256_cmp_pd::<_CMP_GE_OQ>(v[half], least),
            ),
            _mm256_cmp_pd::<_CMP_LE_OQ>(_mm256_add_pd(u[half], v[half]), most),
        );
        let t_min = _mm256_mul_pd(double(&packet.t_min, half), det[half]);
        let t_max = _mm256_mul_pd(double(&packet.t_max, half), det[half]);
        let along = _mm256_and_pd(
            _mm256_and_pd(
                _mm256_cmp_pd::<_CMP_GT_OQ>(t[half], t_min),
                _mm256_cmp_pd::<_CMP_LT_OQ>(t[half], t_max),
            ),
            _mm256_cmp_pd::<_CMP_GT_OQ>(det[half], zero),
        );
        hit |= (_mm256_movemask_pd(_mm256_and_pd(within, along)) as Mask) << (half * HALF);
    }
    Hits::new(hit & mask, cast(det), cast(t), cast(u), cast(v))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::packet::lanes;
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
            let mut packet = Packet::empty();
            for lane in 0..LANES {
                let way = point().normalize();
                let way = match round % 5 {
                    0 => DVec3::Y,
                    1 => DVec3::new(way.x.abs(), -way.y.abs(), way.z.abs()),
                    _ => way,
                };
                packet.set(lane, point(), way, 0.0, if lane == 3 { f64::INFINITY } else { 2.0 });
            }
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
                let portable = packet.hit_triangle(&corners, front_only, mask);
                assert_eq!(hits.mask, portable.mask);
                for lane in lanes(hits.mask) {
                    let bits = |h: &Hits| [h.t[lane], h.u[lane], h.v[lane]].map(f64::to_bits);
                    assert_eq!(bits(&hits), bits(&portable));
                }
                triangles += u32::from(hits.mask != 0);
            }
        }
        assert!(boxes > 1000 && triangles > 1000 && agreed > 200, "{boxes} {triangles} {agreed}");
    }
}
