//! Shadow volumes as soups of triangles, and the truth by rays. Shares no code with what it judges.

use glam::{DVec3, Vec3, Vec4};
use std::collections::BTreeMap;

/// A vertex of a soup: which place, and has it moved away from the light?
pub type End = (u32, bool);

/// Triangles by name of their corners.
pub type Soup = Vec<[End; 3]>;

/// How often each directed edge is used more one way than the other; nothing where the soup is closed.
pub fn open_edges(soup: &[[End; 3]]) -> BTreeMap<(End, End), i64> {
    let mut uses = BTreeMap::new();
    for t in soup {
        for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
            *uses.entry((a.min(b), a.max(b))).or_insert(0) += if a < b { 1 } else { -1 };
        }
    }
    uses.retain(|(a, b), n| a != b && *n != 0);
    uses
}

/// Where a place is once it has moved so far that no test point is behind it.
pub fn far(p: DVec3, light: Vec4) -> DVec3 {
    let light = light.as_dvec4();
    if light.w == 0.0 {
        p - light.truncate().normalize() * 1e4
    } else {
        light.truncate() + (p - light.truncate()) * 1e4
    }
}

/// Distance in lengths of `along`, and is it met from behind?
fn hit([a, b, c]: [DVec3; 3], from: DVec3, along: DVec3) -> Option<(f64, bool)> {
    let normal = (b - a).cross(c - a);
    let slope = normal.dot(along);
    if slope == 0.0 {
        return None;
    }
    let t = normal.dot(a - from) / slope;
    // The same side of all three edges, seen along the ray.
    let side = |p: DVec3, q: DVec3| along.dot((p - from).cross(q - from));
    let sides = [side(a, b), side(b, c), side(c, a)];
    let inside = sides.iter().all(|s| *s > 0.0) || sides.iter().all(|s| *s < 0.0);
    inside.then_some((t, slope > 0.0))
}

/// How often the surface is left on the way from `from`, less how often it is entered: how often `from` is inside.
pub fn winding(triangles: &[[DVec3; 3]], from: DVec3, along: DVec3) -> i64 {
    let hits = triangles.iter().filter_map(|t| hit(*t, from, along)).filter(|(t, _)| *t > 0.0);
    hits.map(|(_, leaves)| if leaves { 1 } else { -1 }).sum()
}

/// Is anything between the point and the light?
pub fn hidden(triangles: &[[DVec3; 3]], from: DVec3, light: Vec4) -> bool {
    let light = light.as_dvec4();
    let (along, end) =
        if light.w == 0.0 { (light.truncate(), f64::INFINITY) } else { (light.truncate() - from, 1.0) };
    triangles.iter().filter_map(|t| hit(*t, from, along)).any(|(t, _)| t > 0.0 && t < end)
}

/// Random numbers that are the same everywhere.
pub struct Random(pub u64);

impl Random {
    /// From -1 to 1.
    pub fn signed(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let mixed = (self.0 ^ (self.0 >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        (mixed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// In a cube of half the edge length 1.
    pub fn point(&mut self) -> DVec3 {
        DVec3::new(self.signed(), self.signed(), self.signed())
    }
}

/// Points around a mesh, in a box half as long again.
pub fn points_around(positions: &[Vec3], count: usize, random: &mut Random) -> Vec<DVec3> {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for p in positions {
        low = low.min(p.as_dvec3());
        high = high.max(p.as_dvec3());
    }
    let (middle, size) = ((low + high) / 2.0, high - low);
    // Flat ones have room around them, too.
    let half = size * 0.75 + size.max_element() * 0.1;
    (0..count).map(|_| middle + random.point() * half).collect()
}
