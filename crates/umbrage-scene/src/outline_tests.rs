//! What outlines promise: fewer triangles, the same contour, no holes, and an answer to any input.

use super::*;
use glam::{Mat3, UVec2, Vec2};

fn named(scene: &str, name: &str) -> Mesh {
    let scene = crate::load(scene).expect("a built-in");
    scene.meshes.into_iter().find(|m| m.name == name).unwrap_or_else(|| panic!("no {name}"))
}

/// The texels that triangles cover, seen along the -Z of `view_from_object`; the mesh's sphere is as wide as the picture.
fn drawn(mesh: &Mesh, indices: &[u32], view_from_object: Mat3, n: u32) -> Vec<bool> {
    let mut covered = vec![false; (n * n) as usize];
    let texel_m = 2.0 * mesh.bounds.radius() / n as f32;
    let place = |i: u32| {
        let p = view_from_object * (mesh.positions[i as usize] - mesh.bounds.center());
        (Vec2::new(p.x, p.y) / texel_m + 0.5 * n as f32).as_dvec2()
    };
    for triangle in indices.chunks_exact(3) {
        let [a, b, c] = [0, 1, 2].map(|i| place(triangle[i]));
        let low = (a.min(b).min(c) - 0.5).floor().max(glam::DVec2::ZERO).as_uvec2();
        let high = (a.max(b).max(c) + 0.5).ceil().as_uvec2().min(UVec2::splat(n));
        for (y, x) in (low.y..high.y).flat_map(|y| (low.x..high.x).map(move |x| (y, x))) {
            let p = UVec2::new(x, y).as_dvec2() + 0.5;
            let sides = [(a, b), (b, c), (c, a)].map(|(a, b)| (b - a).perp_dot(p - a));
            if sides.iter().all(|s| *s >= 0.0) || sides.iter().all(|s| *s <= 0.0) {
                covered[(y * n + x) as usize] = true;
            }
        }
    }
    covered
}

/// Views from all around.
fn ways() -> impl Iterator<Item = Mat3> {
    (0..7).map(|i| Mat3::from_rotation_x(0.4 + 0.9 * i as f32) * Mat3::from_rotation_y(2.4 * i as f32))
}

/// How many texels differ, as a share of those covered, and how many lie farther than `reach` texels from the same answer in
/// the other picture.
fn differences(a: &[bool], b: &[bool], n: u32, reach: i32) -> (f64, usize) {
    let at = |of: &[bool], x: i32, y: i32| {
        let inside = x >= 0 && y >= 0 && x < n as i32 && y < n as i32;
        inside && of[(y * n as i32 + x) as usize]
    };
    let places = || (0..n as i32).flat_map(|y| (0..n as i32).map(move |x| (x, y)));
    let differing: Vec<_> = places().filter(|(x, y)| at(a, *x, *y) != at(b, *x, *y)).collect();
    let near = |of: &[bool], x: i32, y: i32, is: bool| {
        (-reach..=reach).any(|dy| (-reach..=reach).any(|dx| at(of, x + dx, y + dy) == is))
    };
    let far = differing.iter().filter(|(x, y)| {
        let (here, there) = (at(a, *x, *y), at(b, *x, *y));
        !near(b, *x, *y, here) || !near(a, *x, *y, there)
    });
    (differing.len() as f64 / a.iter().filter(|c| **c).count().max(1) as f64, far.count())
}

#[test]
fn the_outline_of_fewer_triangles_is_the_same_to_the_texel() {
    let n = 256;
    for (scene, name) in [("builtin:torus", "torus"), ("builtin:knots", "knot")] {
        let scene = crate::load(scene).expect("a built-in");
        let mesh =
            scene.meshes.iter().find(|m| m.name.starts_with(name)).unwrap_or_else(|| panic!("no {name}"));
        let texel_m = 2.0 * mesh.bounds.radius() / n as f32;
        let outline = mesh.outline(0.5 * texel_m);
        assert!(
            outline.indices.len() < mesh.indices.len() * 3 / 4,
            "{name}: {} of {}",
            outline.indices.len(),
            mesh.indices.len()
        );
        assert!(outline.error_m > 0.0 && outline.error_m <= 0.5 * texel_m);
        let thin = Mesh { indices: outline.indices.clone(), ..mesh.clone() };
        assert_eq!(is_closed(&thin), is_closed(mesh));
        for way in ways() {
            let full = drawn(mesh, &mesh.indices, way, n);
            let (share, far) = differences(&full, &drawn(mesh, &outline.indices, way, n), n, 2);
            assert!(share < 0.03 && far == 0, "{name}: {share} of the texels, {far} far off");
        }
        // Far coarser ones are seen to differ.
        let coarse = mesh.outline(16.0 * texel_m);
        let way = ways().next().expect("seven");
        let (share, far) =
            differences(&drawn(mesh, &mesh.indices, way, n), &drawn(mesh, &coarse.indices, way, n), n, 2);
        assert!(share > 0.03 && far > 0, "{name}: {share} {far}");
    }
}

#[test]
fn nothing_grows_and_nothing_is_out_of_range() {
    for name in ["builtin:torus", "builtin:columns", "builtin:tilt", "builtin:contact"] {
        for mesh in crate::load(name).expect("a built-in").meshes {
            for error_m in [1e-6, 0.01, 1.0, 1e6] {
                let outline = mesh.outline(error_m);
                assert!(!outline.indices.is_empty() && outline.indices.len() <= mesh.indices.len());
                assert!(outline.indices.len().is_multiple_of(3));
                assert!(outline.indices.iter().all(|i| (*i as usize) < mesh.positions.len()));
            }
        }
    }
}

#[test]
fn any_input_has_an_answer() {
    let mesh = named("builtin:torus", "torus");
    for error_m in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert_eq!(mesh.outline(error_m).indices, mesh.indices);
    }
    let with = |change: fn(&mut Mesh)| {
        let mut changed = mesh.clone();
        change(&mut changed);
        let outline = changed.outline(0.05);
        let _ = changed.fit_points();
        outline.indices == changed.indices
    };
    assert!(with(|m| m.indices[4] = u32::MAX));
    assert!(with(|m| m.positions[0] = Vec3::NAN) && with(|m| m.positions.clear()));
    assert!(with(|m| m.indices.clear()));
    // A corner that no triangle uses may be anywhere.
    assert!(!with(|m| m.positions.push(Vec3::NAN)));
}

#[test]
fn points_to_fit_to_hold_the_mesh_and_leave_out_what_is_unused() {
    let mut mesh = named("builtin:torus", "torus");
    let used = mesh.fit_points();
    // The inner half of a torus is in nobody's way.
    assert!(used.len() * 5 < mesh.positions.len() * 3, "{} of {}", used.len(), mesh.positions.len());
    mesh.positions.push(Vec3::splat(1e3));
    assert_eq!(mesh.fit_points(), used);
}
