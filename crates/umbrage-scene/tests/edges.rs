//! Edges, silhouettes and split meshes: the shadow volume made of them is closed and holds what the light does not see.

mod common;

use common::volume::{End, Random, Soup, far, hidden, open_edges, points_around, winding};
use glam::{DVec3, Vec3, Vec4};
use proptest::prelude::*;
use std::collections::HashSet;
use umbrage_core::edges::Adjacency;
use umbrage_core::split::SplitMesh;
use umbrage_scene::{Mesh, load};

fn mesh(positions: Vec<Vec3>, triangles: &[[u32; 3]]) -> Mesh {
    let normals = vec![Vec3::Y; positions.len()];
    Mesh { positions, normals, indices: triangles.concat(), ..Mesh::default() }
}

fn named(scene: &str, name: &str) -> Mesh {
    let scene = load(scene).expect("a built-in");
    scene.meshes.into_iter().find(|m| m.name == name).unwrap_or_else(|| panic!("no {name}"))
}

/// A wavy sheet of `n` by `n` squares, seen from above counter-clockwise.
fn sheet(n: u32) -> Mesh {
    let at = |i: u32| i as f32 / n as f32 - 0.5;
    let wave = |x: f32, z: f32| 0.1 * (5.0 * x).sin() + 0.15 * (4.0 * z).cos();
    let places = (0..=n).flat_map(|i| (0..=n).map(move |j| (at(i), at(j))));
    let positions = places.map(|(x, z)| Vec3::new(x, wave(x, z), z)).collect();
    let squares = (0..n).flat_map(|i| (0..n).map(move |j| i * (n + 1) + j));
    let triangles: Vec<[u32; 3]> =
        squares.flat_map(|k| [[k, k + 1, k + n + 2], [k, k + n + 2, k + n + 1]]).collect();
    mesh(positions, &triangles)
}

/// Three leaves on one stem, two of them running up along it.
fn fans() -> Mesh {
    let positions = [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.4, 0.1], [-0.6, 0.5, 0.7], [-0.5, 0.6, -0.8]];
    mesh(positions.map(Vec3::from).to_vec(), &[[0, 1, 2], [0, 1, 3], [1, 0, 4]])
}

/// A band of `n` squares with half a twist: where it meets itself, both sides run the same way.
fn band(n: u32) -> Mesh {
    let mut positions = Vec::new();
    for i in 0..n {
        let turn = std::f32::consts::TAU * i as f32 / n as f32;
        for side in [-0.3f32, 0.3] {
            let out = 1.0 + side * (turn / 2.0).cos();
            positions.push(Vec3::new(out * turn.cos(), side * (turn / 2.0).sin(), out * turn.sin()));
        }
    }
    let mut triangles = Vec::new();
    for i in 0..n {
        let (a, b) = (2 * i, 2 * i + 1);
        let (c, d) = if i + 1 < n { (a + 2, b + 2) } else { (1, 0) };
        triangles.extend([[a, b, c], [b, d, c]]);
    }
    mesh(positions, &triangles)
}

/// A mesh of each kind, by number.
fn kind(number: usize) -> (&'static str, Mesh) {
    match number {
        0 => ("torus", named("builtin:torus", "torus")),
        1 => ("box", named("builtin:contact", "low box")),
        2 => ("sheet", sheet(5)),
        3 => ("fans", fans()),
        4 => ("band", band(9)),
        5 => ("triangle", mesh(vec![Vec3::ZERO, Vec3::X, Vec3::new(0.2, 0.3, 1.0)], &[[0, 1, 2]])),
        6 => {
            // Faces again, turned, and without area.
            let mut mesh = named("builtin:contact", "low box");
            let first = [mesh.indices[1], mesh.indices[2], mesh.indices[0]];
            mesh.indices.extend(first);
            mesh.indices.extend([5, 5, 7, first[0], first[0], first[0]]);
            ("repeated", mesh)
        }
        _ => {
            let (_, mut one) = kind(1);
            let (_, two) = kind(2);
            let start = one.positions.len() as u32;
            one.positions.extend(&two.positions);
            one.indices.extend(two.indices.iter().map(|i| i + start));
            ("box and sheet", one)
        }
    }
}
const KINDS: usize = 8;

fn near(soup: impl IntoIterator<Item = [u32; 3]>) -> Soup {
    soup.into_iter().map(|t| t.map(|i| (i, false))).collect()
}

/// Sides, wound to be seen from outside.
fn sides(edges: &[[u32; 2]]) -> Soup {
    let side = |&[a, b]: &[u32; 2]| [[(a, false), (b, true), (b, false)], [(a, false), (a, true), (b, true)]];
    edges.iter().flat_map(side).collect()
}

/// The whole volume, its far lids being the near ones.
fn volume(adjacency: &Adjacency, light: Vec4, both_sides: bool) -> Soup {
    let caps = adjacency.caps(light, both_sides);
    let mut soup = near(caps.iter().copied());
    soup.extend(sides(&adjacency.silhouette(light, both_sides)));
    soup.extend(caps.iter().map(|&[a, b, c]| [c, b, a].map(|i| (i, true))));
    soup
}

fn place(soup: &[[End; 3]], positions: &[Vec3], light: Vec4) -> Vec<[DVec3; 3]> {
    let at = |(i, moved): End| {
        let p = positions[i as usize].as_dvec3();
        if moved { far(p, light) } else { p }
    };
    soup.iter().map(|t| t.map(at)).collect()
}

fn corners(mesh: &Mesh) -> Vec<[DVec3; 3]> {
    let at = |i: u32| mesh.positions[i as usize].as_dvec3();
    mesh.indices.chunks_exact(3).map(|t| [at(t[0]), at(t[1]), at(t[2])]).collect()
}

/// Compares the volume with rays; how many points were in shadow.
fn judge(name: &str, mesh: &Mesh, light: Vec4, both_sides: bool, seed: u64) -> usize {
    let adjacency = Adjacency::new(&mesh.positions, &mesh.indices);
    let soup = volume(&adjacency, light, both_sides);
    assert_eq!(open_edges(&soup).len(), 0, "{name}: open, with light {light}");
    let (soup, truth) = (place(&soup, &mesh.positions, light), corners(mesh));
    let mut random = Random(seed);
    let mut dark = 0;
    for p in points_around(&mesh.positions, 12, &mut random) {
        let times = winding(&soup, p, random.point());
        let hidden = hidden(&truth, p, light);
        assert_eq!(times > 0, hidden, "{name}: {p} is inside {times} times, light {light}");
        assert!(times >= 0, "{name}: {p} is inside {times} times");
        dark += usize::from(hidden);
    }
    dark
}

fn light(at: [f32; 3], directional: bool) -> Vec4 {
    // Above all meshes, or outside of them.
    let at = Vec3::from(at);
    let at = if at.length() < 0.05 { Vec3::Y } else { at.normalize() };
    if directional { at.extend(0.0) } else { (at * 4.0).extend(1.0) }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_volume_holds_what_the_light_does_not_see(
        number in 0..KINDS, at: [i8; 3], directional: bool, both_sides: bool, seed: u64,
    ) {
        let (name, mesh) = kind(number);
        let at = at.map(|x| f32::from(x) / 127.0 + 1e-3);
        judge(name, &mesh, light(at, directional), both_sides, seed);
    }

    /// Triangles thrown together over a few places: edges of any number of faces, both ways and one way.
    #[test]
    fn scribbles_cast_right_shadows(
        triangles in prop::collection::vec([0..7u32, 0..7, 0..7], 1..24), at: [i8; 3], seed: u64,
    ) {
        let mut random = Random(seed);
        let positions = (0..7).map(|_| random.point().as_vec3()).collect();
        let mesh = mesh(positions, &triangles);
        let at = at.map(|x| f32::from(x) / 127.0 + 1e-3);
        let light = light(at, seed % 2 == 0);
        judge("scribble", &mesh, light, true, seed);
        let adjacency = Adjacency::new(&mesh.positions, &mesh.indices);
        prop_assert_eq!(open_edges(&volume(&adjacency, light, false)).len(), 0);
        check_counts(&mesh, &adjacency);
        check_split(&mesh, &adjacency, light);
    }

    #[test]
    fn a_split_mesh_pulls_out_the_same_volume(number in 0..KINDS, at: [i8; 3], directional: bool) {
        let (_, mesh) = kind(number);
        let at = at.map(|x| f32::from(x) / 64.0);
        check_split(&mesh, &Adjacency::new(&mesh.positions, &mesh.indices), light(at, directional));
    }

    #[test]
    fn rubbish_does_no_harm(
        indices in prop::collection::vec(prop_oneof![0..9u32, any::<u32>()], 0..40),
        bits in prop::collection::vec(any::<[u32; 3]>(), 0..9),
        light: [u32; 4],
    ) {
        let positions: Vec<Vec3> = bits.iter().map(|b| Vec3::from(b.map(f32::from_bits))).collect();
        let mesh = Mesh { positions, indices, ..Mesh::default() };
        let adjacency = Adjacency::new(&mesh.positions, &mesh.indices);
        let light = Vec4::from(light.map(f32::from_bits));
        prop_assert_eq!(open_edges(&volume(&adjacency, light, false)).len(), 0);
        prop_assert!(adjacency.planes.iter().all(|p| p.is_finite()));
        let split = SplitMesh::new(&mesh.positions, &adjacency);
        prop_assert!(split.indices.iter().all(|i| (*i as usize) < split.positions.len()));
    }
}

/// Counts by plain looks at every pair.
fn check_counts(mesh: &Mesh, adjacency: &Adjacency) {
    let counts = adjacency.counts;
    let triangles: Vec<&[u32]> =
        mesh.indices.chunks_exact(3).filter(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0]).collect();
    assert_eq!(counts.triangles, triangles.len());
    assert_eq!(counts.degenerate, mesh.indices.len() / 3 - triangles.len());
    let uses = |a: u32, b: u32| {
        triangles.iter().filter(|t| (0..3).any(|i| (t[i], t[(i + 1) % 3]) == (a, b))).count()
    };
    let (mut edges, mut open, mut shared) = (0, 0, 0);
    for a in 0..7 {
        for b in a + 1..7 {
            let (up, down) = (uses(a, b), uses(b, a));
            edges += usize::from(up + down > 0);
            shared += usize::from(up + down > 2);
            open += up.abs_diff(down);
        }
    }
    assert_eq!((counts.edges, counts.open, counts.shared_by_more), (edges, open, shared));
    assert_eq!(adjacency.edges.iter().filter(|e| e.right.is_none()).count(), open);
}

/// From the least corner on, so that rotation makes no difference. `None`: without area, whatever the places are.
fn turned<const N: usize>(mut ends: [End; N]) -> Option<[End; N]> {
    let least = (0..N).min_by_key(|i| ends[*i])?;
    ends.rotate_left(least);
    let different = |i: usize| (0..i).all(|j| ends[j] != ends[i]);
    (0..N).all(different).then_some(ends)
}

fn sorted<const N: usize>(soup: impl IntoIterator<Item = [End; N]>) -> Vec<[End; N]> {
    let mut all: Vec<_> = soup.into_iter().filter_map(turned).collect();
    all.sort_unstable();
    all
}

/// What a vertex shader makes of a split mesh, against silhouette and caps; lids as triangles, sides as quads, because
/// the reverse has the other diagonal. Where nothing is drawn twice, as triangles too.
fn check_split(mesh: &Mesh, adjacency: &Adjacency, light: Vec4) {
    let split = SplitMesh::new(&mesh.positions, adjacency);
    let mut names: Vec<u32> = adjacency.triangles.concat();
    // The second corners of open edges' ghosts are found by their place.
    for at in &split.positions[names.len()..] {
        let found = adjacency.triangles.iter().flatten().find(|i| mesh.positions[**i as usize] == *at);
        names.push(*found.expect("a place of the mesh"));
    }
    let moves = |v: u32| {
        let facing = split.planes[v as usize].dot(light);
        if v < split.first_reversed { facing <= 0.0 } else { facing < 0.0 }
    };
    let end = |v: u32, toggle: bool| (names[v as usize], moves(v) != toggle);
    let (mut lids, mut quads, mut soup) = (Vec::new(), Vec::new(), Vec::new());
    let first_ghost = |range: &std::ops::Range<u32>, triangles: usize| range.start as usize + 3 * triangles;
    let two_sided = adjacency.two_sided.iter().filter(|two| **two).count();
    let one_sided = adjacency.triangles.len() - two_sided;
    for (range, triangles, twice) in [
        (&split.one_sided, one_sided, false),
        (&split.two_sided, two_sided, false),
        (&split.two_sided, two_sided, true),
        (&split.open, 0, false),
    ] {
        let ghosts = first_ghost(range, triangles);
        for t in split.indices[range.start as usize..ghosts].chunks_exact(3) {
            let [a, b, c] = [t[0], t[1], t[2]].map(|v| end(v, twice));
            lids.push(if twice { [b, a, c] } else { [a, b, c] });
        }
        for q in split.indices[ghosts..range.end as usize].chunks_exact(6) {
            assert_eq!((q[0], q[2]), (q[3], q[4]), "two triangles along one diagonal");
            let [a, b, c, d] = [q[0], q[1], q[2], q[5]].map(|v| end(v, twice));
            quads.push(if twice { [d, c, b, a] } else { [a, b, c, d] });
            soup.extend([[a, b, c], [a, c, d]]);
        }
    }
    let both = [split.one_sided.end, split.two_sided.end, split.open.end];
    assert_eq!(both[2] as usize, split.indices.len());
    assert!(split.one_sided.start == 0 && split.two_sided.start == both[0] && split.open.start == both[1]);

    let caps = adjacency.caps(light, false);
    let facing: HashSet<&[u32; 3]> = caps.iter().collect();
    let mut expected = near(caps.iter().copied());
    for (t, two) in adjacency.triangles.iter().zip(&adjacency.two_sided) {
        let moved = t.map(|i| (i, true));
        // Far lids: what does not face the light, and of open parts the reverse of what does.
        match (facing.contains(t), two) {
            (false, _) => expected.push(moved),
            (true, true) => expected.push([moved[1], moved[0], moved[2]]),
            (true, false) => {}
        }
    }
    // A triangle and its reverse in one mesh would make `facing` ambiguous.
    let all: HashSet<&[u32; 3]> = adjacency.triangles.iter().collect();
    let reverses = |&[a, b, c]: &[u32; 3]| [[b, a, c], [a, c, b], [c, b, a]];
    let plain = all.iter().all(|t| reverses(t).iter().all(|r| !all.contains(r)));
    let silhouette = adjacency.silhouette(light, false);
    if plain {
        assert_eq!(sorted(lids.iter().copied()), sorted(expected));
    }
    let quad = |&[a, b]: &[u32; 2]| [(a, false), (a, true), (b, true), (b, false)];
    assert_eq!(sorted(quads), sorted(silhouette.iter().map(quad)));
    if two_sided == 0 {
        assert_eq!(sorted(soup), sorted(sides(&silhouette)));
    }
}

#[test]
fn a_closed_box_hides_what_is_inside_from_a_light_inside() {
    let mesh = named("builtin:contact", "low box");
    let middle = corners(&mesh).concat().iter().sum::<DVec3>() / mesh.indices.len() as f64;
    let light = (middle.as_vec3() + Vec3::splat(0.01)).extend(1.0);
    let dark: usize = (0..20).map(|seed| judge("box", &mesh, light, true, seed)).sum();
    assert!(dark > 50 && dark < 240, "{dark} of 240 points are outside of the box");
    let front_only = Adjacency::new(&mesh.positions, &mesh.indices).caps(light, false);
    assert!(front_only.is_empty(), "negative control: no front faces a light inside");
}

#[test]
fn an_open_sheet_casts_from_both_sides() {
    for light in [Vec4::new(0.3, 1.0, 0.1, 0.0), Vec4::new(0.3, -1.0, 0.1, 0.0)] {
        let dark: usize = (0..20).map(|seed| judge("sheet", &sheet(5), light, false, seed)).sum();
        assert!(dark > 20, "{dark} points in shadow are too few to tell");
    }
}

#[test]
fn a_light_in_a_plane_leaves_nothing_open() {
    let (_, cube) = kind(1);
    let top = cube.positions.iter().fold(f32::MIN, |top, p| top.max(p.y));
    let flat = mesh(vec![Vec3::ZERO, Vec3::Z, Vec3::X + Vec3::Z, Vec3::X], &[[0, 1, 2], [0, 2, 3]]);
    for (name, mesh, light) in [
        ("box", &cube, Vec4::new(9.0, top, 5.0, 1.0)),
        ("box", &cube, Vec4::new(1.0, 0.0, 0.0, 0.0)),
        ("flat", &flat, Vec4::new(3.0, 0.0, 4.0, 1.0)),
        ("flat", &flat, Vec4::new(1.0, 0.0, 1.0, 0.0)),
    ] {
        let adjacency = Adjacency::new(&mesh.positions, &mesh.indices);
        assert!(adjacency.planes.iter().any(|p| p.dot(light) == 0.0), "{name}: exactly in a plane");
        for seed in 0..20 {
            judge(name, mesh, light, false, seed);
        }
        check_split(mesh, &adjacency, light);
    }
}

#[test]
fn counts_are_those_of_shapes_that_are_known() {
    let counts = |number| Adjacency::new(&kind(number).1.positions, &kind(number).1.indices).counts;
    let cube = counts(1);
    assert_eq!((cube.vertices, cube.triangles, cube.edges, cube.open), (8, 12, 18, 0));
    assert_eq!((cube.parts, cube.open_parts, cube.degenerate, cube.duplicated), (1, 0, 0, 0));
    let torus = counts(0);
    assert_eq!((torus.vertices + torus.triangles, torus.open), (torus.edges, 0), "Euler: a torus has a hole");
    let sheet = counts(2);
    assert_eq!((sheet.vertices, sheet.edges, sheet.open, sheet.open_parts), (36, 85, 20, 1));
    let fans = counts(3);
    assert_eq!((fans.shared_by_more, fans.open, fans.edges, fans.parts), (1, 7, 7, 1));
    let band = counts(4);
    // Its one border has 18 edges, and where it meets itself two sides run the same way.
    assert_eq!((band.edges, band.open, band.shared_by_more), (36, 20, 0));
    let repeated = counts(6);
    assert_eq!((repeated.duplicated, repeated.degenerate, repeated.open), (1, 2, 3));
    let both = counts(7);
    assert_eq!((both.parts, both.open_parts), (2, 1));
    let one_sided = Adjacency::new(&kind(7).1.positions, &kind(7).1.indices)
        .two_sided
        .iter()
        .filter(|two| !**two)
        .count();
    assert_eq!(one_sided, 12, "the box casts with its fronts alone, whatever lies beside it");
}

#[test]
fn real_meshes_are_paired_in_time() {
    let Some(scene) = common::load_shared("scopia-trees/japaneseMaple/japaneseMaple.obj") else { return };
    for mesh in &scene.meshes {
        let started = std::time::Instant::now();
        let adjacency = Adjacency::new(&mesh.positions, &mesh.indices);
        let split = SplitMesh::new(&mesh.positions, &adjacency);
        eprintln!("{:?}: {:?}, {} indices", started.elapsed(), adjacency.counts, split.indices.len());
        assert_eq!(open_edges(&volume(&adjacency, Vec4::new(0.3, 1.0, 0.2, 0.0), false)).len(), 0);
    }
}
