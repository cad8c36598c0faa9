//! Built-in scenes: repeatable, exact at every scale, and what their names promise.

// The lint's exception for tests does not see a test file's helpers.
#![allow(clippy::unwrap_used)]

use glam::Vec3;
use umbrage_core::{LightKind, Projection};
use umbrage_scene::{Scene, builtins, load};

fn build(spec: &str) -> Scene {
    load(&format!("builtin:{spec}")).unwrap()
}

/// What stands around the subject; it may reach beyond the picture and the cone.
fn is_room(name: &str) -> bool {
    ["floor", "wall", "ground"].contains(&name)
}

/// World positions of each instance, with its name.
fn placed(scene: &Scene) -> Vec<(String, Vec<Vec3>)> {
    let points = |i: &umbrage_scene::Instance| {
        scene.meshes[i.mesh].positions.iter().map(|p| i.world_from_object.transform_point3(*p)).collect()
    };
    scene.instances.iter().map(|i| (i.name.clone(), points(i))).collect()
}

#[test]
fn every_scene_is_whole() {
    assert_eq!(builtins()[0].name, "torus", "the default scene comes first");
    for builtin in builtins() {
        let scene = build(builtin.name);
        assert_eq!(scene.name, format!("builtin:{}", builtin.name));
        assert_eq!((scene.cameras.len(), scene.lights.len()), (1, 1));
        scene.cameras[0].camera.check().unwrap();
        scene.lights[0].light.check().unwrap();
        for mesh in &scene.meshes {
            assert_eq!(mesh.normals.len(), mesh.positions.len());
            assert_eq!(mesh.uvs.len(), mesh.positions.len());
            assert!(mesh.material < scene.materials.len());
            for t in mesh.indices.chunks_exact(3) {
                let [a, b, c] = [t[0], t[1], t[2]].map(|i| mesh.positions[i as usize]);
                let normal = mesh.normals[t[0] as usize];
                assert!(
                    (b - a).cross(c - a).dot(normal) > 0.0,
                    "{}: {} is turned or has no area",
                    builtin.name,
                    mesh.name
                );
            }
        }
        eprintln!("{}: {} triangles, {}", builtin.name, scene.triangles(), scene.bounds().size());
    }
    assert_eq!(build("knots").triangles(), 519_168, "as many as shared/scenes/knots has");
}

#[test]
fn a_seed_always_gives_the_same_and_another_gives_another() {
    for builtin in builtins() {
        let one = |seed: u32| placed(&build(&format!("{}?seed={seed}", builtin.name)));
        assert_eq!(one(7), one(7), "{}", builtin.name);
        assert_eq!(one(0), placed(&build(builtin.name)), "{}", builtin.name);
        // The angles of `tilt` are its point; no seed may change them.
        assert_eq!(one(7) == one(8), builtin.name == "tilt", "{}", builtin.name);
    }
}

#[test]
fn scale_multiplies_every_length_exactly() {
    for builtin in builtins() {
        let plain = build(builtin.name);
        for scale in [0.01f32, 0.5, 1000.0] {
            let scaled = build(&format!("{}?scale={scale}", builtin.name));
            for (a, b) in plain.meshes.iter().zip(&scaled.meshes) {
                assert!(
                    a.positions.iter().zip(&b.positions).all(|(p, q)| *p * scale == *q),
                    "{}",
                    builtin.name
                );
                assert_eq!((&a.normals, &a.indices), (&b.normals, &b.indices));
            }
            for (a, b) in plain.instances.iter().zip(&scaled.instances) {
                let place = |i: &umbrage_scene::Instance| i.world_from_object.w_axis.truncate();
                assert_eq!(place(a) * scale, place(b));
            }
            let (a, b) = (plain.cameras[0].camera, scaled.cameras[0].camera);
            assert_eq!(
                (a.position_world * scale, a.near_m * scale, a.far_m * scale),
                (b.position_world, b.near_m, b.far_m)
            );
            let (a, b) = (plain.lights[0].light, scaled.lights[0].light);
            assert_eq!(a.position_world * scale, b.position_world);
            let lux = |l: &umbrage_core::Light| l.illuminance_lux(l.position_world.length());
            assert!((lux(&a) / lux(&b) - 1.0).abs() < 1e-5, "surfaces are as bright as before");
        }
    }
}

#[test]
fn what_does_not_exist_is_refused_in_one_line_with_what_does() {
    for (spec, words) in [
        ("tours", &["did you mean torus", "contact"][..]),
        ("", &["torus, columns, tilt"]),
        ("torus?sede=3", &["did you mean seed"]),
        ("torus?scale=0", &["0.01 to 1000"]),
        ("torus?scale=nan", &["0.01 to 1000"]),
        ("torus?scale=1001", &["0.01 to 1000"]),
        ("torus?seed=-1", &["whole number"]),
        ("torus?seed", &["whole number"]),
        ("a\nb?\n", &["no built-in scene"]),
    ] {
        let message = load(&format!("builtin:{spec}")).expect_err(spec).to_string();
        assert!(!message.contains('\n') && words.iter().all(|w| message.contains(w)), "{message}");
    }
    assert!(load(&format!("builtin:{}", "x".repeat(1_000_000))).is_err());
    assert_eq!(build("torus?scale=2&seed=1").name, "builtin:torus");
}

#[test]
fn planes_are_turned_by_the_angle_in_their_name() {
    let scene = build("tilt");
    let light = scene.lights[0].light;
    let camera = scene.cameras[0].camera;
    let mut seen = Vec::new();
    for mesh in &scene.meshes {
        let degrees: f64 = mesh.name.strip_prefix("tilt ").unwrap().parse().unwrap();
        let [a, b, c] = [0, 1, 2].map(|i| mesh.positions[mesh.indices[i] as usize].as_dvec3());
        let normal = (b - a).cross(c - a).normalize();
        let center = mesh.bounds.center().as_dvec3();
        let measured = normal.angle_between(light.position_world.as_dvec3() - center).to_degrees();
        assert!((measured - degrees).abs() < 0.02, "{}: {measured}", mesh.name);
        let to_eye = (camera.position_world.as_dvec3() - center).normalize();
        assert!(normal.dot(to_eye) > 0.4, "{} is seen too flat: {}", mesh.name, normal.dot(to_eye));
        seen.push(degrees);
    }
    assert_eq!(seen, [0.0, 15.0, 30.0, 45.0, 60.0, 70.0, 75.0, 80.0, 83.0, 85.0, 87.0, 88.0, 89.0]);
}

/// Seen from the light (and from the eye) the spheres around the planes do not overlap, so nothing can hide anything.
#[test]
fn no_plane_shadows_or_hides_another() {
    let scene = build("tilt");
    let from = [scene.lights[0].light.position_world, scene.cameras[0].camera.position_world];
    for (i, a) in scene.meshes.iter().enumerate() {
        for b in &scene.meshes[..i] {
            for eye in from {
                let (to_a, to_b) = (a.bounds.center() - eye, b.bounds.center() - eye);
                // Half the diagonal of a plane of 0.8 m.
                let half = |v: Vec3| (0.8 * 0.5f32.sqrt() / v.length()).asin();
                let apart = to_a.angle_between(to_b) - half(to_a) - half(to_b);
                assert!(apart > 0.0, "{} and {} from {eye}: {} degrees", a.name, b.name, apart.to_degrees());
            }
        }
    }
}

#[test]
fn what_stands_on_the_ground_touches_it_exactly() {
    for scale in ["0.01", "1", "7.3", "1000"] {
        let scene = build(&format!("contact?scale={scale}&seed=5"));
        let mut standing = 0;
        for (name, points) in placed(&scene) {
            let lowest = points.iter().map(|p| p.y).fold(f32::INFINITY, f32::min);
            if name == "top box" {
                let low = placed(&scene).into_iter().find(|(n, _)| n == "low box").unwrap().1;
                assert_eq!(lowest, low.iter().map(|p| p.y).fold(0.0, f32::max), "it stands on the low box");
            } else {
                assert_eq!(lowest, 0.0, "{name} at scale {scale}");
                standing += 1;
            }
        }
        assert!(standing >= 10);
    }
    let bounds = |name: &str| build("contact").meshes.into_iter().find(|m| m.name == name).unwrap().bounds;
    assert_eq!(bounds("low box").max.x, bounds("high box").min.x, "side by side, without a gap");
    for (name, thickness) in [("wall 2 permille", 0.008), ("wall 20 permille", 0.08)] {
        assert!((bounds(name).size().z - thickness).abs() < 1e-6, "{name}");
    }
}

#[test]
fn the_leaning_board_touches_the_post() {
    let scene = build("contact");
    let mesh = |name: &str| scene.meshes.iter().find(|m| m.name == name).unwrap();
    let post = mesh("post").bounds;
    let edge = Vec3::new(post.min.x, post.max.y, 0.0);
    // The distance of the post's upper edge from the board's side that faces it.
    let board = mesh("board");
    let t = board.indices.chunks_exact(3).max_by(|a, b| {
        let x = |t: &[u32]| board.normals[t[0] as usize].x;
        x(a).total_cmp(&x(b))
    });
    let corner = t.unwrap()[0] as usize;
    let distance = (edge - board.positions[corner]).dot(board.normals[corner]);
    assert!(distance.abs() < 1e-5, "{distance}");
}

#[test]
fn camera_and_light_hold_the_subject() {
    for builtin in builtins() {
        for seed in [0, 3] {
            let scene = build(&format!("{}?seed={seed}", builtin.name));
            let (camera, light) = (scene.cameras[0].camera, scene.lights[0].light);
            let view = camera.view_from_world();
            let Projection::Perspective { fov_y_rad } = camera.projection else { panic!("a pin-hole") };
            let LightKind::Spot { outer_rad, .. } = light.kind else { panic!("a spot light") };
            let tan = (0.5 * fov_y_rad).tan();
            for (name, points) in placed(&scene).into_iter().filter(|(name, _)| !is_room(name)) {
                for p in points {
                    let p_view = view.transform_point3(p);
                    let depth = -p_view.z;
                    assert!(depth > camera.near_m && depth < camera.far_m, "{} {name}", builtin.name);
                    // `knots` has the frame and the cone that its description gives, which cut its corners.
                    if builtin.name == "knots" {
                        continue;
                    }
                    let (x, y) = (p_view.x / (tan * 16.0 / 9.0 * depth), p_view.y / (tan * depth));
                    assert!(x.abs() < 1.0 && y.abs() < 1.0, "{} {name} at {x} {y}", builtin.name);
                    let angle = (p - light.position_world).angle_between(light.direction_world);
                    assert!(angle < outer_rad, "{} {name}: {} degrees", builtin.name, angle.to_degrees());
                }
            }
        }
    }
}
