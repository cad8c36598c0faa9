//! Is a mesh the skin of something solid?

use crate::Mesh;
use umbrage_core::edges::weld;

/// Is the surface closed and turned outwards?
///
/// Vertices are welded by position. Closed means that every edge is used as often one way as the other, so that any line
/// enters as often as it leaves; then a surface's back faces can be left out wherever it is seen from outside, and
/// whatever lies behind it is still covered. Edges of more than two faces count by orientation. Turned outwards
/// means that the enclosed volume is positive.
///
/// Cost: one sort of three numbers a triangle.
pub fn is_closed(mesh: &Mesh) -> bool {
    if mesh.indices.len() < 12 {
        return false;
    }
    let welded = weld(&mesh.positions);
    let mut edges: Vec<u64> = Vec::with_capacity(mesh.indices.len());
    let mut volume = 0.0f64;
    let middle = mesh.bounds.center();
    for triangle in mesh.indices.chunks_exact(3) {
        let corner = |i: usize| welded[triangle[i] as usize];
        for (a, b) in [(corner(0), corner(1)), (corner(1), corner(2)), (corner(2), corner(0))] {
            if a != b {
                // The lowest bit tells the direction, so that both directions of an edge sort together.
                let (low, high) = (u64::from(a.min(b)), u64::from(a.max(b)));
                edges.push((low << 33) | (high << 1) | u64::from(a > b));
            }
        }
        let [a, b, c] = [0, 1, 2].map(|i| (mesh.positions[triangle[i] as usize] - middle).as_dvec3());
        volume += a.dot(b.cross(c));
    }
    edges.sort_unstable();
    volume > 0.0
        && edges
            .chunk_by(|a, b| a >> 1 == b >> 1)
            .all(|edge| edge.iter().filter(|e| *e & 1 == 1).count() * 2 == edge.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(scene: &str, name: &str) -> Mesh {
        let scene = crate::load(scene).expect("a built-in");
        scene.meshes.into_iter().find(|m| m.name == name).unwrap_or_else(|| panic!("no {name}"))
    }

    #[test]
    fn a_torus_is_closed_until_a_triangle_is_missing_or_turned_or_all_are_turned() {
        let mesh = named("builtin:torus", "torus");
        assert!(is_closed(&mesh));
        let holed = Mesh { indices: mesh.indices[3..].to_vec(), ..mesh.clone() };
        assert!(!is_closed(&holed));
        let mut turned = mesh.clone();
        turned.indices.swap(0, 1);
        assert!(!is_closed(&turned));
        let mut inside_out = mesh.clone();
        inside_out.indices.chunks_exact_mut(3).for_each(|t| t.swap(0, 1));
        assert!(!is_closed(&inside_out));
    }

    #[test]
    fn a_plane_is_open_and_a_box_is_not() {
        assert!(!is_closed(&named("builtin:contact", "ground")));
        assert!(is_closed(&named("builtin:contact", "low box")));
    }
}
