//! Meshes whose edges are split, so that a vertex shader alone can pull a shadow volume out of them.

use crate::{Adjacency, Mesh};
use glam::{Vec3, Vec4};
use std::ops::Range;

/// A mesh in which no two triangles share a vertex, with ghosts between them: pairs of triangles that have no area until one
/// of their sides is moved.
///
/// Rule of extrusion: a vertex moves away from the light, to a distance or to infinity, where `dot(plane, light) <= 0`;
/// `light` is the light's place and 1, or the direction towards it and 0, in object space. Vertices from
/// [`first_reversed`](Self::first_reversed) on move where it is `< 0`: they stand for the back of a triangle whose
/// front does the opposite, also where the light is exactly in its plane.
///
/// What comes out is closed, its front faces outside, counter-clockwise, and equal to [`Adjacency::caps`],
/// [`Adjacency::silhouette`] and their far ends. Draw [`one_sided`](Self::one_sided) once, [`two_sided`](Self::two_sided)
/// twice and [`open`](Self::open) once. The second time of `two_sided` is the mesh's reverse: what would move stays, what would
/// stay moves, and the winding is turned. For lights that may be inside of closed parts, draw `one_sided` twice, too.
///
/// In the first drawing a ghost's diagonal runs from an end that stays, along the direction of the cap, to the far end of
/// the other; in the reverse it runs the other way. Both lie in the same plane.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SplitMesh {
    /// Object space, metres: three for each triangle of the [`Adjacency`], then two for each open edge.
    pub positions: Vec<Vec3>,
    /// For each vertex the plane of its triangle, as in [`Adjacency::planes`]; its negative from
    /// [`first_reversed`](Self::first_reversed) on.
    pub planes: Vec<Vec4>,
    /// Three for each triangle: first those that the ranges hold, in the ranges' order. In each range triangles of the mesh come
    /// before ghosts.
    pub indices: Vec<u32>,
    /// Indices of closed parts: triangles and ghosts.
    pub one_sided: Range<u32>,
    /// Indices of open parts: triangles, and ghosts between two of them.
    pub two_sided: Range<u32>,
    /// Indices of ghosts of open edges, between a triangle and its own reverse.
    pub open: Range<u32>,
    /// The first vertex of those that stand for the back of a triangle.
    pub first_reversed: u32,
}

impl SplitMesh {
    /// Splits `mesh`, whose edges are `adjacency`.
    ///
    /// Memory: 84 bytes a triangle for vertices, and 36 for indices of a closed mesh, in place of about 18 and 12. Cost: one pass
    /// over triangles and edges.
    pub fn new(mesh: &Mesh, adjacency: &Adjacency) -> Self {
        let triangles = &adjacency.triangles;
        let mut split = Self::default();
        for (corners, plane) in triangles.iter().zip(&adjacency.planes) {
            // An adjacency of another mesh makes a wrong volume, but no panic.
            let place = |i: u32| mesh.positions.get(i as usize).copied().unwrap_or_default();
            split.positions.extend(corners.map(place));
            split.planes.extend([*plane; 3]);
        }
        split.first_reversed = split.positions.len() as u32;
        split.one_sided = split.part(adjacency, false);
        split.two_sided = split.part(adjacency, true);
        let start = split.indices.len() as u32;
        for edge in adjacency.edges.iter().filter(|edge| edge.right.is_none()) {
            let front = [edge.a, edge.b].map(|place| corner(triangles, edge.left, place));
            let back = split.positions.len() as u32;
            for vertex in front {
                split.positions.push(split.positions[vertex as usize]);
                split.planes.push(-split.planes[vertex as usize]);
            }
            split.indices.extend(ghost(front, [back, back + 1]));
        }
        split.open = start..split.indices.len() as u32;
        split
    }

    /// Adds triangles and paired ghosts of all parts that are open, or of all that are not.
    fn part(&mut self, adjacency: &Adjacency, two_sided: bool) -> Range<u32> {
        let triangles = &adjacency.triangles;
        let belongs = |triangle: u32| adjacency.two_sided[triangle as usize] == two_sided;
        let start = self.indices.len() as u32;
        for triangle in (0..triangles.len() as u32).filter(|t| belongs(*t)) {
            self.indices.extend([0, 1, 2].map(|i| 3 * triangle + i));
        }
        for edge in adjacency.edges.iter().filter(|edge| belongs(edge.left)) {
            let Some(right) = edge.right else { continue };
            let ends = |triangle| [edge.a, edge.b].map(|place| corner(triangles, triangle, place));
            self.indices.extend(ghost(ends(edge.left), ends(right)));
        }
        start..self.indices.len() as u32
    }
}

/// The vertex of a triangle that is at a place.
fn corner(triangles: &[[u32; 3]], triangle: u32, place: u32) -> u32 {
    let corner = triangles[triangle as usize].iter().position(|p| *p == place).unwrap_or_default();
    3 * triangle + corner as u32
}

/// Between the ends of an edge as the triangle has them that runs from the first to the second, and as the other has them.
fn ghost([a_left, b_left]: [u32; 2], [a_right, b_right]: [u32; 2]) -> [u32; 6] {
    [a_left, a_right, b_right, a_left, b_right, b_left]
}
