//! The truth against what geometry says without any ray.

mod common;

use common::{looking_down, scene, sheet, truth};
use glam::{DVec3, Mat4, UVec2, Vec3};
use std::f64::consts::PI;
use umbrage_core::{Aabb, Light, LightKind, LightShape};
use umbrage_scene::{Material, Mesh, Scene};
use umbrage_truth::{Edges, Judged, Quality, Rays, Surfaces, Visibility, silent};

/// Height of the light and of the edge, metres.
const LIGHT_M: f32 = 4.0;
const EDGE_M: f32 = 1.0;

fn lamp(shape: LightShape) -> Light {
    let light = Light { kind: LightKind::Point, shape, ..Light::default() };
    let light = light.aimed(Vec3::Y * LIGHT_M, Vec3::ZERO);
    // Its sides along x and z, so that the edge is parallel to one of a square's.
    Light { up_world: Vec3::NEG_Z, ..light }
}

/// A ground, and over the half of it with x < 0 a sheet.
fn straight_edge() -> Scene {
    let half = sheet(Vec3::new(-10.0, EDGE_M, 0.0), Vec3::X * 10.0, Vec3::NEG_Z * 20.0, 0);
    let ground = sheet(Vec3::ZERO, Vec3::X * 20.0, Vec3::NEG_Z * 20.0, 0);
    scene(vec![Material::default()], vec![ground, half])
}

/// The share of a light with a straight side, or of a disc, on the lit side of a line `c` radii from its middle.
fn share_of_square(c: f64) -> f64 {
    (0.5 - 0.5 * c).clamp(0.0, 1.0)
}

fn share_of_disc(c: f64) -> f64 {
    let c = c.clamp(-1.0, 1.0);
    (c.acos() - c * (1.0 - c * c).sqrt()) / PI
}

/// Root of the mean square of V* minus the closed form, along a line across the edge.
fn edge_error(shape: LightShape, radius: f64, samples: u32, share: fn(f64) -> f64) -> f64 {
    let size = UVec2::new(256, 16);
    // 1.1 penumbrae: x from -0.37 to 0.37 for a light of 1 m.
    let camera = looking_down(Vec3::ZERO, 0.5, 0.37 / 16.0);
    let (surfaces, found) = truth(&straight_edge(), &camera, &lamp(shape), size, samples);
    let squares = surfaces.seen.iter().zip(&found.v).map(|(seen, v)| {
        let x = seen.expect("the ground").p_world.x;
        let scale = f64::from((LIGHT_M - EDGE_M) / EDGE_M);
        (f64::from(v.x) - share(-x * scale / radius)).powi(2)
    });
    (squares.sum::<f64>() / found.v.len() as f64).sqrt()
}

#[test]
fn a_straight_edge_under_a_square_and_a_disc() {
    let square = LightShape::Rectangle { width_m: 2.0, height_m: 2.0 };
    let disc = LightShape::Disc { radius_m: 1.0 };
    for (shape, share) in [(square, share_of_square as fn(f64) -> f64), (disc, share_of_disc)] {
        let errors = [16, 64, 256, 1024].map(|samples| edge_error(shape, 1.0, samples, share));
        // Random samples would gain a factor of 2 for each four times as many; stratified ones, of which only those
        // that lie on the edge are in doubt, 2.8.
        let rate = (errors[0] / errors[3]).ln() / 64f64.ln();
        println!("{shape:?}: RMS {errors:.5?}, proportional to samples^-{rate:.2}");
        assert!(errors[3] < 0.01, "{shape:?}: {errors:?}");
        assert!(rate > 0.65, "{shape:?}: {rate}");
        assert!(errors[0] > 0.005, "the test must be able to fail: {errors:?}");
    }
}

#[test]
fn a_different_seed_is_as_good_and_the_same_is_the_same() {
    let (scene, camera) = (straight_edge(), looking_down(Vec3::ZERO, 0.5, 0.02));
    let light = lamp(LightShape::Disc { radius_m: 1.0 });
    let with = |threads: usize| {
        let pool = rayon_pool(threads);
        pool.install(|| truth(&scene, &camera, &light, UVec2::new(64, 16), 32).1)
    };
    let (one, three) = (with(1), with(3));
    assert_eq!(one.v, three.v, "whatever the number of cores");
    assert_eq!(one.rays, 64 * 16 * 32);
}

fn rayon_pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads")
}

/// A ball over the ground, straight under a shining ball.
const BALL_M: f32 = 0.5;
const BALL_HEIGHT_M: f32 = 1.5;
const LAMP_M: f32 = 0.3;

fn ball_over_ground() -> Scene {
    let ground = sheet(Vec3::ZERO, Vec3::X * 20.0, Vec3::NEG_Z * 20.0, 0);
    let mut made = scene(vec![Material::default()], vec![ground, sphere(768, 384)]);
    made.instances[1].world_from_object =
        Mat4::from_translation(Vec3::Y * BALL_HEIGHT_M) * Mat4::from_scale(Vec3::splat(BALL_M));
    made
}

/// A unit ball.
fn sphere(around: u32, down: u32) -> Mesh {
    let at = |i: u32, j: u32| {
        let (a, b) = (i as f64 / around as f64 * 2.0 * PI, j as f64 / down as f64 * PI);
        DVec3::new(a.cos() * b.sin(), b.cos(), a.sin() * b.sin()).as_vec3()
    };
    let positions: Vec<Vec3> = (0..=down).flat_map(|j| (0..=around).map(move |i| at(i, j))).collect();
    let index = |i: u32, j: u32| j * (around + 1) + i;
    let quad = |i: u32, j: u32| {
        let [a, b, c, d] = [index(i, j), index(i + 1, j), index(i, j + 1), index(i + 1, j + 1)];
        [a, b, d, a, d, c]
    };
    let indices = (0..down).flat_map(|j| (0..around).flat_map(move |i| quad(i, j))).collect();
    Mesh {
        normals: positions.clone(),
        bounds: Aabb::from_points(positions.iter().copied()),
        positions,
        indices,
        ..Default::default()
    }
}

/// The share of the shining ball, by solid angle, that a place on the ground sees beside the dark one: no ray, only two
/// cones of directions.
fn share_beside_ball(x: f64) -> f64 {
    let p = DVec3::new(x, 0.0, 0.0);
    let cone = |height: f32, radius: f32| {
        let offset = DVec3::Y * f64::from(height) - p;
        (offset.normalize(), (1.0 - (f64::from(radius) / offset.length()).powi(2)).sqrt())
    };
    let ((to_lamp, lamp_cos), (to_ball, ball_cos)) = (cone(LIGHT_M, LAMP_M), cone(BALL_HEIGHT_M, BALL_M));
    let (right, up) = to_lamp.any_orthonormal_pair();
    const STEPS: u32 = 400;
    let mut seen = 0;
    for i in 0..STEPS * STEPS {
        let (u, v) = (f64::from(i % STEPS) + 0.5, f64::from(i / STEPS) + 0.5);
        let cos = 1.0 - u / f64::from(STEPS) * (1.0 - lamp_cos);
        let (sin, turn) = ((1.0 - cos * cos).sqrt(), v / f64::from(STEPS) * 2.0 * PI);
        let way = to_lamp * cos + (right * turn.cos() + up * turn.sin()) * sin;
        seen += u32::from(way.dot(to_ball) < ball_cos);
    }
    f64::from(seen) / f64::from(STEPS * STEPS)
}

#[test]
fn a_ball_over_a_plane() {
    let [h, c, r, l] = [LIGHT_M, BALL_HEIGHT_M, BALL_M, LAMP_M].map(f64::from);
    // Lines that touch both balls on the same side meet above the light, those that cross meet between the two.
    let radius_of = |apex: f64| apex * ((r / (apex - c)).asin()).tan();
    let umbra = radius_of(h + (h - c) * l / (r - l));
    let penumbra = radius_of(c + (h - c) * r / (l + r));

    let camera = looking_down(Vec3::new(0.6, 0.0, 0.0), 0.4, 0.7 / 32.0);
    let light = lamp(LightShape::Sphere { radius_m: LAMP_M });
    let (surfaces, found) = truth(&ball_over_ground(), &camera, &light, UVec2::new(1024, 32), 1024);
    let profile: Vec<(f64, f64)> = surfaces
        .seen
        .iter()
        .zip(&found.v)
        .map(|(seen, v)| (seen.expect("the ground").p_world.length(), f64::from(v.x)))
        .filter(|(x, _)| *x < 1.28)
        .collect();
    let dark = profile.iter().filter(|(_, v)| *v == 0.0).map(|(x, _)| *x).fold(0.0, f64::max);
    let lit = profile.iter().filter(|(_, v)| *v == 1.0).map(|(x, _)| *x).fold(f64::INFINITY, f64::min);
    println!("umbra {umbra:.4}, found {dark:.4}; penumbra {penumbra:.4}, found {lit:.4}");
    assert!((dark / umbra - 1.0).abs() < 0.01 && (lit / penumbra - 1.0).abs() < 0.01);
    // Every 61st pixel: the closed form is a sum of 160,000 directions.
    let some: Vec<_> =
        profile.iter().step_by(61).filter(|(x, _)| *x > 0.9 * umbra && *x < 1.1 * penumbra).collect();
    let squares: f64 = some.iter().map(|(x, v)| (v - share_beside_ball(*x)).powi(2)).sum();
    let rms = (squares / some.len() as f64).sqrt();
    println!("profile of {} places: RMS {rms:.5}", some.len());
    assert!(some.len() > 100 && rms < 0.01, "{rms}");
}

#[test]
fn the_truth_s_own_penumbra_is_that_of_similar_triangles() {
    let built = straight_edge();
    let rays = Rays::new(&built).expect("rays");
    let camera = looking_down(Vec3::ZERO, 0.5, 0.37);
    let surfaces = Surfaces::new(&rays, &camera, UVec2::splat(128), &silent).expect("surfaces");
    for shape in [
        LightShape::Rectangle { width_m: 1.0, height_m: 1.0 },
        LightShape::Disc { radius_m: 0.6 },
        LightShape::Sphere { radius_m: 0.4 },
    ] {
        let light = lamp(shape);
        let quality = Quality { samples: 256, seed: 0 };
        let found = Visibility::new(&rays, &surfaces, &light, &quality, &silent).expect("truth");
        let all = vec![true; found.v.len()];
        let judged = Judged::new(surfaces.size, found.v.clone(), &all, all.clone());
        let edges = Edges::new(&rays, &surfaces, &light, &judged);
        let ratio = edges.ratio(&found.v).expect("edges");
        println!("{shape:?}: {} edges, {ratio:.3} of what similar triangles give", edges.len());
        assert!(edges.len() > 50 && (ratio - 1.0).abs() < 0.05, "{shape:?}: {ratio}");
        let hard: Vec<Vec3> =
            found.v.iter().map(|v| Vec3::splat(if v.x > 0.5 { 1.0 } else { 0.0 })).collect();
        assert!(edges.ratio(&hard).expect("edges") < 0.25);
    }
}
