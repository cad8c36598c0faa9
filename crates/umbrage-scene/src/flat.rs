//! Is a mesh flat?

use crate::Mesh;
use glam::{Vec3, Vec4};

/// The plane that holds every corner of every triangle, `(unit normal, minus distance from the origin)`, in object space.
/// `None` when there is none: a corner is off by more than a millionth of the mesh's size.
pub fn plane_of(mesh: &Mesh) -> Option<Vec4> {
    let corner = |i: &u32| mesh.positions[*i as usize];
    let first = corner(mesh.indices.first()?);
    let size = mesh.bounds.size().max_element();
    // The farthest corner, and the one that spans the largest triangle with it: the best conditioned plane.
    let farthest = |from: Vec3, measure: &dyn Fn(Vec3) -> f32| {
        let far = |best: (f32, Vec3), p: Vec3| if measure(p) > best.0 { (measure(p), p) } else { best };
        mesh.indices.iter().map(corner).fold((0.0, from), far).1
    };
    let second = farthest(first, &|p| p.distance_squared(first));
    let third = farthest(first, &|p| (p - first).cross(second - first).length_squared());
    let normal = (second - first).cross(third - first).try_normalize()?;
    let off = |p: Vec3| (p - first).dot(normal).abs();
    mesh.indices.iter().all(|i| off(corner(i)) <= 1e-6 * size).then(|| normal.extend(-normal.dot(first)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floors_are_flat_and_solids_are_not() {
        let scene = crate::load("builtin:contact").expect("a built-in");
        let mesh = |name: &str| scene.meshes.iter().find(|m| m.name == name).expect(name);
        let plane = plane_of(mesh("ground")).expect("a plane");
        assert!(plane.abs().abs_diff_eq(Vec4::new(0.0, 1.0, 0.0, 0.0), 1e-6), "{plane}");
        assert_eq!(plane_of(mesh("low box")), None);
        let mut bent = mesh("ground").clone();
        bent.positions[0].y += 1e-3;
        assert_eq!(plane_of(&bent), None);
    }
}
