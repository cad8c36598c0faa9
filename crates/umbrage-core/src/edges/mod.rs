//! Which triangles meet at which edges, and what outline they show a light: shadow volumes are made of it.

mod pairing;
mod silhouette;
mod weld;

pub use pairing::{Pair, Pairs, Side, pair};
pub use weld::weld;

use glam::{DVec3, Vec3, Vec4};

/// More triangles than this are not looked at: their split form would have more vertices than 32 bits count.
const MAX_TRIANGLES: usize = (u32::MAX / 9) as usize;

/// The triangles of a mesh, their planes, and the edges at which they meet. Object space.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Adjacency {
    /// Corners as indices into the mesh's positions, in the mesh's order and rotation. Of all vertices at one place (the same
    /// bits, but -0 is 0) the first stands for all. Triangles with two corners at one place are left out, and so are
    /// those that name no vertex.
    pub triangles: Vec<[u32; 3]>,
    /// Plane of each triangle: unit normal and minus the distance from the origin, so that `dot(plane, (p, 1))` is above 0
    /// in front, metres. Computed in 64 bits. Zero where a triangle has no area, or one beyond all numbers.
    pub planes: Vec<Vec4>,
    /// For each triangle: is its part open, or turned inside out (as rooms are: its volume is below 0)? A part is all that is connected
    /// through edges. Such a part has to cast from both sides, see [`Adjacency::silhouette`].
    pub two_sided: Vec<bool>,
    /// Where triangles meet, and where they should. Sorted by lower, then by higher vertex.
    pub edges: Vec<Edge>,
    /// How many there are of each kind.
    pub counts: EdgeCounts,
}

/// Two triangles that meet, or one that meets none.
///
/// An edge of more than two triangles is several of these: uses one way are paired with uses the other way in the
/// triangles' order, and what is left over is open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    /// Where it begins, an index into the mesh's positions that [`Adjacency::triangles`] uses.
    pub a: u32,
    /// Where it ends.
    pub b: u32,
    /// The triangle that runs from `a` to `b`.
    pub left: u32,
    /// The triangle that runs from `b` to `a`. `None`: there is none, the edge is open.
    pub right: Option<u32>,
}

/// What a mesh is made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EdgeCounts {
    /// Places that triangles use.
    pub vertices: usize,
    /// Triangles that are looked at.
    pub triangles: usize,
    /// Different pairs of places that triangles join.
    pub edges: usize,
    /// Uses of edges that nothing runs against: one for each [`Edge`] without `right`.
    pub open: usize,
    /// Edges of more than two triangles.
    pub shared_by_more: usize,
    /// Triangles with two corners at one place, or naming no vertex: they are left out.
    pub degenerate: usize,
    /// Triangles with the corners and the winding of an earlier one. They are kept.
    pub duplicated: usize,
    /// Parts: triangles that share an edge are of one part.
    pub parts: usize,
    /// Parts with an open edge.
    pub open_parts: usize,
}

impl Adjacency {
    /// Finds what meets. Any mesh will do: also one with indices out of range, positions that are not finite, and edges
    /// of many triangles. Up to 477 million triangles are looked at.
    ///
    /// Cost: one sort of three sides a triangle; a quarter of a million triangles take about a tenth of a second.
    pub fn new(positions: &[Vec3], indices: &[u32]) -> Self {
        let welded = weld(positions);
        let mut triangles = Vec::with_capacity(indices.len() / 3);
        let mut degenerate = 0;
        for corners in indices.chunks_exact(3).take(MAX_TRIANGLES) {
            let place = |i: usize| welded.get(corners[i] as usize).copied();
            match (place(0), place(1), place(2)) {
                (Some(a), Some(b), Some(c)) if a != b && b != c && c != a => triangles.push([a, b, c]),
                _ => degenerate += 1,
            }
        }
        let Pairs { pairs, distinct, shared_by_more, part_of, open } =
            pair(sides(&triangles), triangles.len());
        let edge = |pair: &Pair| Edge {
            a: pair.left.from,
            b: pair.left.to,
            left: pair.left.face,
            right: pair.right.map(|side| side.face),
        };
        let counts = EdgeCounts {
            vertices: used(&triangles, positions.len()),
            triangles: triangles.len(),
            edges: distinct,
            open: pairs.iter().filter(|pair| pair.right.is_none()).count(),
            shared_by_more,
            degenerate,
            duplicated: duplicated(&triangles),
            parts: open.len(),
            open_parts: open.iter().filter(|open| **open).count(),
        };
        let corner = |i: u32| positions[i as usize].as_dvec3();
        let mut volumes = vec![(None, 0.0); open.len()];
        for (t, part) in triangles.iter().zip(&part_of) {
            let (origin, volume) = &mut volumes[*part as usize];
            // A closed part's volume is the same from everywhere, and most exact from a place on it.
            let origin = *origin.get_or_insert(corner(t[0]));
            let [a, b, c] = t.map(|i| corner(i) - origin);
            *volume += a.dot(b.cross(c));
        }
        let casts_twice = |part: &u32| open[*part as usize] || volumes[*part as usize].1 < 0.0;
        Self {
            planes: triangles.iter().map(|t| plane(t.map(corner))).collect(),
            two_sided: part_of.iter().map(casts_twice).collect(),
            edges: pairs.iter().map(edge).collect(),
            triangles,
            counts,
        }
    }
}

fn sides(triangles: &[[u32; 3]]) -> Vec<Side> {
    let mut sides = Vec::with_capacity(3 * triangles.len());
    for (face, t) in (0u32..).zip(triangles) {
        let side = |i: usize| Side { from: t[i], to: t[(i + 1) % 3], id: 3 * face + i as u32, face };
        sides.extend([side(0), side(1), side(2)]);
    }
    sides
}

/// Through three corners; zero where 32 bits do not hold it.
fn plane([a, b, c]: [DVec3; 3]) -> Vec4 {
    let plane = (b - a).cross(c - a).try_normalize().map(|n| n.extend(-n.dot(a)).as_vec4());
    plane.filter(|plane| plane.is_finite()).unwrap_or_default()
}

fn used(triangles: &[[u32; 3]], vertices: usize) -> usize {
    let mut used = vec![false; vertices];
    triangles.iter().flatten().for_each(|i| used[*i as usize] = true);
    used.iter().filter(|used| **used).count()
}

fn duplicated(triangles: &[[u32; 3]]) -> usize {
    let mut turned: Vec<[u32; 3]> = triangles
        .iter()
        .map(|&[a, b, c]| [[a, b, c], [b, c, a], [c, a, b]])
        .map(|turns| turns.into_iter().min().unwrap_or_default())
        .collect();
    turned.sort_unstable();
    turned.windows(2).filter(|pair| pair[0] == pair[1]).count()
}
