//! Volumes of meshes, matrices and lights that are none: a right picture, or an empty one.

mod common;

use common::gpu;
use common::scenes::{over_floor, with_light};
use common::volumes::*;
use glam::{Mat4, Vec3};
use umbrage_render::umbrage::core::{Camera, Light};
use umbrage_scene::{Material, Mesh};

/// Whatever the mesh: the count above 0 exactly where a map of two-sided triangles is dark.
#[test]
fn meshes_that_are_none() {
    let Some(gpu) = gpu() else { return };
    let corners = [Vec3::new(-0.8, 0.0, 0.6), Vec3::new(0.8, 0.1, 0.6), Vec3::new(0.0, 0.3, -0.8)];
    let turned_out = {
        let mut mesh = cuboid(Vec3::splat(0.5), &ALL);
        mesh.indices.chunks_exact_mut(3).for_each(|t| t.swap(0, 1));
        mesh
    };
    let with_rubbish = {
        let mut mesh = cuboid(Vec3::splat(0.5), &ALL);
        mesh.indices.extend([0, 0, 1, 2, 2, 2, 3, 1, 3]);
        mesh.positions.extend([Vec3::new(0.5, 0.5, 0.5), Vec3::new(0.5, 0.0, 0.5)]);
        mesh.normals.extend([Vec3::Y; 2]);
        // No area: three places on a line.
        mesh.indices.extend([7, 9, 5, 8, 9, 5]);
        mesh
    };
    let twice = {
        let mut mesh = cuboid(Vec3::splat(0.5), &ALL);
        mesh.indices.extend(mesh.indices.clone());
        mesh
    };
    let fan = mesh(
        &[Vec3::new(0.0, -0.5, 0.0), Vec3::new(0.0, 0.5, 0.0), Vec3::X, Vec3::NEG_X, Vec3::Z],
        &[0, 1, 2, 0, 1, 3, 0, 1, 4],
    );
    let nothing = mesh(&corners, &[]);
    let point = mesh(&[Vec3::ZERO; 3], &[0, 1, 2]);
    let some = |mesh: Mesh| placed(vec![mesh], &[(0, above(0.9))]);
    for (name, scene, least) in [
        ("one triangle", some(mesh(&corners, &[0, 1, 2])), 100),
        ("one triangle from behind", some(mesh(&corners, &[0, 2, 1])), 100),
        ("both sides of a triangle", some(mesh(&corners, &[0, 1, 2, 0, 2, 1])), 100),
        ("a triangle twice", some(mesh(&corners, &[0, 1, 2, 0, 1, 2])), 100),
        ("degenerate faces", some(with_rubbish), 100),
        ("every face twice", some(twice), 100),
        ("inside out", some(turned_out), 100),
        ("a box without lid", some(cuboid(Vec3::splat(0.5), &[0, 1, 2, 4, 5])), 100),
        ("two sides of a box", some(cuboid(Vec3::splat(0.5), &[0, 3])), 100),
        ("three sheets at an edge", some(fan), 50),
        ("no triangle", some(nothing), 0),
        ("a point", some(point), 0),
    ] {
        for light in kinds(scene.lights[0].light) {
            let scene = with_light(scene.clone(), light);
            let v = visibility(&gpu, &scene, &[]);
            let shadow = dark(&gpu, &scene, &v);
            let map = by(&gpu, &scene, "linear", &[("map_size", "2048")]);
            let off = off(&v, &map);
            println!("{name} {}: {shadow} dark, {off} differ from a map", light.kind.id());
            assert!(shadow >= least, "{name}: {shadow}");
            assert!(off <= 20, "{name} {}: {off} differ from a map", light.kind.id());
            for pairs in [[("silhouette", "vertex")], [("counting", "depth-fail")]] {
                assert_eq!(v, visibility(&gpu, &scene, &pairs), "{name} {}: {pairs:?}", light.kind.id());
            }
        }
    }
}

/// A room seen from inside, one-sided, and the light outside of it; then a volume that ends.
#[test]
fn rooms_are_dark_and_short_volumes_end() {
    let Some(gpu) = gpu() else { return };
    let mut room = cuboid(Vec3::new(3.5, 2.0, 3.5), &ALL);
    room.indices.chunks_exact_mut(3).for_each(|t| t.swap(0, 1));
    let scene = over_floor(vec![Material::default()], vec![], vec![room], &[(0, above(1.9))]);
    for light in kinds(Light::spot(Vec3::new(-2.0, 9.0, 2.0), Vec3::ZERO, 0.5, 0.6)) {
        let mut scene = with_light(scene.clone(), light);
        let (eye, target) = (Vec3::new(2.0, 2.0, 2.5), Vec3::new(-1.0, 0.0, -1.0));
        scene.cameras[0].camera = Camera::look_at(eye, target, 1.2, 0.05, 40.0);
        let v = visibility(&gpu, &scene, &[]);
        assert_eq!(v.iter().filter(|v| **v > 0.5).count(), 0, "{}: light in the room", light.kind.id());
        assert_eq!(v, visibility(&gpu, &scene, &[("silhouette", "vertex")]), "{}", light.kind.id());
    }
    let scene = placed(vec![cuboid(Vec3::splat(0.4), &ALL)], &[(0, above(2.5))]);
    let long = dark(&gpu, &scene, &visibility(&gpu, &scene, &[]));
    for (length, least, most) in [("0.5", 0, 0), ("40", long, long)] {
        for counting in ["auto", "depth-fail", "depth-pass"] {
            for silhouette in ["compute", "vertex"] {
                let pairs = [("extrude_m", length), ("counting", counting), ("silhouette", silhouette)];
                let dark = dark(&gpu, &scene, &visibility(&gpu, &scene, &pairs));
                assert!((least..=most).contains(&dark), "{pairs:?}: {dark} of {long}");
            }
        }
    }
}

/// Flat by its matrix, a line by its matrix, and nothing.
#[test]
fn matrices_without_inverse() {
    let Some(gpu) = gpu() else { return };
    let turn = Mat4::from_rotation_x(0.3);
    for (name, scale, least) in [
        ("flat", Vec3::new(1.0, 0.0, 1.0), 100),
        ("flat and mirrored", Vec3::new(-1.0, 0.0, 1.0), 100),
        ("a line", Vec3::new(1.0, 0.0, 0.0), 0),
        ("a point", Vec3::ZERO, 0),
    ] {
        for faces in [&ALL[..], &[0, 1, 2, 4, 5]] {
            let scene = placed(
                vec![cuboid(Vec3::splat(0.6), faces)],
                &[(0, above(1.0) * turn * Mat4::from_scale(scale))],
            );
            for light in kinds(scene.lights[0].light) {
                let scene = with_light(scene.clone(), light);
                let v = visibility(&gpu, &scene, &[]);
                let shadow = dark(&gpu, &scene, &v);
                let off = off(&v, &by(&gpu, &scene, "linear", &[("map_size", "2048")]));
                println!(
                    "{name} {} {} faces: {shadow} dark, {off} differ from a map",
                    light.kind.id(),
                    faces.len()
                );
                assert!(shadow >= least && off <= 20, "{name}: {shadow} {off}");
                let vertex =
                    visibility(&gpu, &scene, &[("silhouette", "vertex"), ("counting", "depth-fail")]);
                assert_eq!(self::off(&v, &vertex), 0, "{name}");
            }
        }
    }
}

/// On a face, in its plane, at a corner, inside: whatever the light's place, no two ways differ, and most of the floor is right.
#[test]
fn lights_on_and_in_meshes() {
    let Some(gpu) = gpu() else { return };
    let scene = placed(vec![cuboid(Vec3::new(0.5, 0.5, 0.5), &ALL)], &[(0, above(1.5))]);
    for (name, place, least, most) in [
        ("in the middle", Vec3::new(0.0, 1.5, 0.0), 2000, 20_000),
        ("just inside", Vec3::new(0.0, 1.999, 0.0), 2000, 20_000),
        ("on the top", Vec3::new(0.1, 2.0, 0.2), 500, 20_000),
        ("just above the top", Vec3::new(0.1, 2.001, 0.2), 500, 20_000),
        ("at a corner", Vec3::new(0.5, 2.0, 0.5), 500, 20_000),
        ("on an edge", Vec3::new(0.5, 2.0, 0.1), 500, 20_000),
        ("in the plane of the top", Vec3::new(2.0, 2.0, 0.3), 10, 20_000),
        ("in two planes", Vec3::new(0.5, 2.0, 2.0), 10, 20_000),
        ("on the floor", Vec3::new(1.5, 0.0, 0.0), 0, 20_000),
    ] {
        let light = Light { position_world: place, ..kinds(scene.lights[0].light)[1] };
        let scene = with_light(scene.clone(), light);
        let v = visibility(&gpu, &scene, &[]);
        let shadow = dark(&gpu, &scene, &v);
        println!("light {name}: {shadow} dark");
        assert!((least..=most).contains(&shadow), "light {name}: {shadow}");
        for pairs in [
            &[("silhouette", "vertex")][..],
            &[("counting", "depth-fail")],
            &[("silhouette", "vertex"), ("counting", "depth-fail"), ("stencil", "two-pass")],
        ] {
            let off = off(&v, &visibility(&gpu, &scene, pairs));
            println!("light {name}: {off} {pairs:?}");
            assert_eq!(off, 0, "light {name}: {pairs:?}");
        }
    }
}
