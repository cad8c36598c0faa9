//! What a light sees of the edges: the slow and sure way, triangle by triangle.

use super::{Adjacency, Edge};
use glam::Vec4;

impl Adjacency {
    /// Does the front of a triangle face the light? Not where the light is in its plane, nor where it has no area.
    fn facing(&self, triangle: u32, light_object: Vec4) -> bool {
        self.planes[triangle as usize].dot(light_object) > 0.0
    }

    /// Do both sides of a triangle cast?
    fn casts_twice(&self, triangle: u32, both_sides: bool) -> bool {
        both_sides || self.two_sided[triangle as usize]
    }

    /// The edges whose sides a shadow volume has, as often as it has them: `[a, b]` where the cap runs from `a` to `b`.
    /// The side that closes it runs back, so seen from outside it is `b, a, a far away, b far away`, counter-clockwise.
    ///
    /// `light_object` is the light's place and 1, or the direction towards it and 0, in object space. Closed parts cast with the triangles
    /// that face the light, which is enough for a light outside of them; with `both_sides` they cast with all, as open parts
    /// always do, each triangle turned to the light, and an edge between one that is turned and one that is not counts twice.
    ///
    /// Together with [`caps`](Self::caps) and their far ends the sides are closed, whatever the mesh.
    ///
    /// Cost: two products for each edge. Meant for tests and counts; a GPU finds silhouettes by itself.
    pub fn silhouette(&self, light_object: Vec4, both_sides: bool) -> Vec<[u32; 2]> {
        let mut sides = Vec::new();
        for edge in &self.edges {
            let times = self.multiplicity(edge, light_object, both_sides);
            let side = if times > 0 { [edge.a, edge.b] } else { [edge.b, edge.a] };
            sides.extend(std::iter::repeat_n(side, times.unsigned_abs() as usize));
        }
        sides
    }

    /// How often the caps run from the edge's `a` to its `b`, less how often they run back: -2 to 2.
    fn multiplicity(&self, edge: &Edge, light_object: Vec4, both_sides: bool) -> i32 {
        let left = i32::from(self.facing(edge.left, light_object));
        match edge.right {
            None => 2 * left - 1,
            Some(right) => {
                let right = i32::from(self.facing(right, light_object));
                if self.casts_twice(edge.left, both_sides) { 2 * (left - right) } else { left - right }
            }
        }
    }

    /// The lids of a shadow volume near the light: triangles that face it as they are, and of parts that cast from both sides
    /// the others too, turned by their first two corners. The far lids are the same triangles far away, turned.
    ///
    /// `light_object` and `both_sides` are those of [`silhouette`](Self::silhouette). Cost: a product for each triangle.
    pub fn caps(&self, light_object: Vec4, both_sides: bool) -> Vec<[u32; 3]> {
        let cap = |(number, &[a, b, c]): (u32, &[u32; 3])| {
            if self.facing(number, light_object) {
                Some([a, b, c])
            } else {
                self.casts_twice(number, both_sides).then_some([b, a, c])
            }
        };
        (0u32..).zip(&self.triangles).filter_map(cap).collect()
    }
}
