//! Walks of packets through the hierarchy: what is nearest, how much light passes. Each exists once, for any
//! way to test boxes and triangles, and is made for the instructions that this machine has.

use crate::hierarchy::{Found, NO_CHILD, Rays, Stack};
use crate::packet::{LANES, Lane, Mask, Packet, lanes};
use glam::Vec3;
use std::ops::Range;

/// How rays are tested against a box and against a triangle.
trait Box8: Fn(&Packet, Vec3, Vec3, Mask) -> Mask {}
impl<T: Fn(&Packet, Vec3, Vec3, Mask) -> Mask> Box8 for T {}
trait Triangle8: Fn(&Packet, &[Vec3; 3], bool, Mask) -> Mask {}
impl<T: Fn(&Packet, &[Vec3; 3], bool, Mask) -> Mask> Triangle8 for T {}

/// Visits all leaves that rays of the packet reach; `visit` ends rays by taking them out of `packet.active` or by
/// shortening them.
#[inline(always)]
fn walk(
    rays: &Rays<'_>,
    packet: &mut Packet,
    stack: &mut Stack,
    reach_box: impl Box8,
    mut visit: impl FnMut(&mut Packet, Mask, Range<usize>),
) {
    let stack = &mut stack.0;
    stack.clear();
    if !rays.nodes.is_empty() {
        stack.push((0, 0, packet.active));
    }
    while let Some((index, count, mask)) = stack.pop() {
        let mask = mask & packet.active;
        if mask == 0 {
            continue;
        }
        if count > 0 {
            visit(packet, mask, index as usize..(index + count) as usize);
            if packet.active == 0 {
                return;
            }
            continue;
        }
        // Those that are reached, nearest last, so that it is visited first.
        let bottom = stack.len();
        let mut away = [0.0; 4];
        for child in &rays.nodes[index as usize] {
            if child.first_index == NO_CHILD {
                break;
            }
            let reached = reach_box(packet, child.min, child.max, mask);
            if reached == 0 {
                continue;
            }
            let far = packet.along(child.min + child.max);
            stack.push((child.first_index, child.prim_count, reached));
            let mut place = stack.len() - 1 - bottom;
            while place > 0 && away[place - 1] < far {
                away[place] = away[place - 1];
                stack.swap(bottom + place, bottom + place - 1);
                place -= 1;
            }
            away[place] = far;
        }
    }
}

/// What rays meet first.
#[derive(Debug)]
pub struct Nearest {
    /// Do rays of sight look? They pass blended surfaces and the backs of single-sided ones; light passes neither, but
    /// for what a surface lets through and what is no blocker.
    pub sight: bool,
    /// One for each ray.
    pub found: [Option<Found>; LANES],
}

#[inline(always)]
fn find_nearest_by(
    rays: &Rays<'_>,
    packet: &mut Packet,
    nearest: &mut Nearest,
    stack: &mut Stack,
    reach_box: impl Box8,
    hit_triangle: impl Triangle8,
) {
    walk(rays, packet, stack, reach_box, |packet, mask, slots| {
        for slot in slots {
            let tag = rays.triangles.tags[slot];
            if nearest.sight && tag.is_blended() {
                continue;
            }
            let front_only = nearest.sight && !tag.is_double_sided();
            let corners = &rays.triangles.corners[slot].0;
            for lane in lanes(hit_triangle(packet, corners, front_only, mask)) {
                let hit = packet.hit_at(corners, lane);
                if tag.is_pierceable() && rays.pierced(tag, hit.u, hit.v, nearest.sight) != Vec3::ZERO {
                    continue;
                }
                packet.end_at(lane, hit.t);
                nearest.found[lane] = Some(Found { distance_m: hit.t, slot: slot as u32 });
            }
        }
    });
}

#[inline(always)]
fn pass_light_by(
    rays: &Rays<'_>,
    packet: &mut Packet,
    light: &mut [Vec3; LANES],
    stack: &mut Stack,
    reach_box: impl Box8,
    hit_triangle: impl Triangle8,
) {
    walk(rays, packet, stack, reach_box, |packet, mask, slots| {
        for slot in slots {
            let tag = rays.triangles.tags[slot];
            let hits = hit_triangle(packet, &rays.triangles.corners[slot].0, false, mask & packet.active);
            if hits == 0 {
                continue;
            }
            if !tag.is_pierceable() {
                packet.active &= !hits;
                lanes(hits).for_each(|lane| light[lane] = Vec3::ZERO);
                continue;
            }
            for lane in lanes(hits) {
                let hit = packet.hit_at(&rays.triangles.corners[slot].0, lane);
                light[lane] *= rays.pierced(tag, hit.u, hit.v, false);
                if light[lane] == Vec3::ZERO {
                    packet.active &= !(1 << lane);
                }
            }
        }
    });
}

/// Makes a walk for AVX2 and for machines without it, and the function that chooses.
macro_rules! for_this_machine {
    ($(#[$doc:meta])* $name:ident, $by:ident, $out:ty) => {
        $(#[$doc])*
        pub fn $name(rays: &Rays<'_>, lanes: &[Lane], out: &mut $out, stack: &mut Stack) {
            #[cfg(target_arch = "x86_64")]
            {
                use crate::packet_avx2::{hit_triangle, reach_box, reach_box_by};

                #[target_feature(enable = "avx2")]
                fn avx2(rays: &Rays<'_>, lanes: &[Lane], out: &mut $out, stack: &mut Stack) {
                    let packet = &mut Packet::new(lanes);
                    let triangle =
                        |p: &Packet, corners: &[Vec3; 3], front, mask| hit_triangle(p, corners, front, mask);
                    match packet.agreed_sides() {
                        Some(sides) => {
                            let by = |p: &Packet, min, max, mask| reach_box_by(p, sides, min, max, mask);
                            $by(rays, packet, out, stack, by, triangle)
                        }
                        None => {
                            let any = |p: &Packet, min, max, mask| reach_box(p, min, max, mask);
                            $by(rays, packet, out, stack, any, triangle)
                        }
                    }
                }

                if is_x86_feature_detected!("avx2") {
                    // SAFETY: the machine was asked and has what the function is compiled for.
                    #[allow(unsafe_code)]
                    return unsafe { avx2(rays, lanes, out, stack) };
                }
            }
            let packet = &mut Packet::new(lanes);
            $by(rays, packet, out, stack, Packet::reach_box, Packet::hit_triangle);
        }
    };
}

for_this_machine!(
    /// What each ray meets first.
    find_nearest,
    find_nearest_by,
    Nearest
);
for_this_machine!(
    /// Multiplies `light` by what passes along each ray.
    pass_light,
    pass_light_by,
    [Vec3; LANES]
);
