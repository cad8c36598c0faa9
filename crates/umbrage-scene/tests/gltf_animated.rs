//! Animations: files made on the spot with places worked out by hand, broken ones, and files that others made.

#![allow(clippy::unwrap_used)]

mod common;

use common::glb::{F32, Glb, I8, I16, U8, U16, f32s, load_at, u16s};
use common::{assert_sound, extents, shared};
use glam::Vec3;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use umbrage_scene::{Pose, Scene, SceneError};

fn at(glb: &Glb, time_s: f32) -> Scene {
    let scene = glb.load_at(time_s).unwrap_or_else(|e| panic!("{e}"));
    assert_sound(&scene);
    scene
}

fn pose(time_s: f32, animation: impl Into<Option<&'static str>>) -> Pose {
    Pose { time_s, animation: animation.into().map(str::to_owned) }
}

/// Where the square's corner (1, 0, 0) is.
fn corner(scene: &Scene) -> Vec3 {
    scene.instances[0].world_from_object.transform_point3(Vec3::X)
}

fn near(a: Vec3, b: Vec3) -> bool {
    (a - b).length() < 1e-5
}

/// A square moved by one channel.
fn moved(path: &str, how: &str, times: &[f32], width: &str, values: &[f32]) -> Glb {
    let mut glb = Glb::square();
    let count = values.len() / if width == "VEC4" { 4 } else { 3 };
    let values = glb.accessor(&f32s(values), F32, width, count, false);
    glb.animate(0, path, how, times, values);
    glb
}

#[test]
fn a_translation_is_half_way_at_half_time_and_the_clip_loops() {
    let glb = moved("translation", "LINEAR", &[0.0, 2.0], "VEC3", &[0.0, 0.0, 0.0, 4.0, 2.0, -6.0]);
    let whole = Vec3::new(4.0, 2.0, -6.0);
    for (time, share) in
        [(0.0, 0.0), (1.0, 0.5), (1.5, 0.75), (2.0, 1.0), (2.5, 0.25), (-0.5, 0.75), (41.0, 0.5)]
    {
        let scene = at(&glb, time);
        assert!(near(corner(&scene), Vec3::X + whole * share), "{time}: {}", corner(&scene));
        let playing = scene.playing.unwrap();
        assert_eq!((playing.number, playing.length_s, playing.time_s), (0, 2.0, 2.0 * share), "{time}");
    }
    assert_eq!(corner(&glb.load().unwrap()), Vec3::X, "without a time it is at rest");
    assert!(glb.load().unwrap().playing.is_none());
}

#[test]
fn a_turn_of_90_degrees_is_45_at_half_time() {
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let mut glb =
        moved("rotation", "LINEAR", &[0.0, 1.0], "VEC4", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, half, half]);
    assert!(near(corner(&at(&glb, 0.5)), Vec3::new(half, half, 0.0)));
    // A third of the way is 30 degrees: blending numbers instead of turning would give 29.
    let third = Vec3::new(0.75_f32.sqrt(), 0.5, 0.0);
    assert!(near(corner(&at(&glb, 1.0 / 3.0)), third), "{}", corner(&at(&glb, 1.0 / 3.0)));
    glb.json["animations"][0]["samplers"][0].as_object_mut().unwrap().remove("interpolation");
    assert!(near(corner(&at(&glb, 0.5)), Vec3::new(half, half, 0.0)), "LINEAR is the default");
}

#[test]
fn steps_hold_and_splines_follow_the_closed_form() {
    let glb =
        moved("scale", "STEP", &[0.0, 1.0, 2.0], "VEC3", &[1.0, 1.0, 1.0, 3.0, 1.0, 1.0, 5.0, 1.0, 1.0]);
    for (time, size) in [(0.0, 1.0), (0.99, 1.0), (1.0, 3.0), (1.99, 3.0), (2.0, 5.0)] {
        assert_eq!(corner(&at(&glb, time)).x, size, "{time}");
    }
    // Two seconds long, from 1 with slope 3 to 5 with slope -2, in x; at the middle the specification's polynomials are
    // 1/2, 1/8, 1/2 and -1/8, the slopes times two seconds: 0.5 + 0.75 + 2.5 + 0.5.
    let mut values = [0.0; 18];
    (values[3], values[6], values[9], values[12]) = (1.0, 3.0, -2.0, 5.0);
    // Unused: the tangent before the first key and behind the last.
    (values[0], values[15]) = (99.0, 99.0);
    let glb = moved("translation", "CUBICSPLINE", &[1.0, 3.0], "VEC3", &values);
    for (time, x) in [(0.0, 1.0), (1.0, 1.0), (2.0, 4.25), (3.0, 5.0)] {
        assert!(near(corner(&at(&glb, time)), Vec3::X * (1.0 + x)), "{time}: {}", corner(&at(&glb, time)));
    }
}

#[test]
fn normalized_rotations_and_weights_are_decoded() {
    let byte = (std::f32::consts::FRAC_1_SQRT_2 * 127.0).round() as u8;
    let short = u16s(&[0, 0, (std::f32::consts::FRAC_1_SQRT_2 * 32767.0).round() as u16]);
    let short: Vec<u8> = [short.as_slice(), &short[4..6]].concat();
    for (component, bytes) in [(I8, vec![0, 0, byte, byte]), (I16, short)] {
        let mut glb = Glb::square();
        let values = glb.accessor(&bytes, component, "VEC4", 1, true);
        glb.animate(0, "rotation", "LINEAR", &[0.0], values);
        assert!(near(corner(&at(&glb, 0.0)), Vec3::Y), "{component}");
        glb.json["accessors"][values]["normalized"] = json!(false);
        assert!(glb.load_at(0.0).unwrap_err().to_string().contains("not allowed"), "{component}");
    }
    let mut glb = morphed();
    let values = glb.accessor(&u16s(&[0, 0, 0xFFFF, 0]), U16, "SCALAR", 4, true);
    glb.animate(0, "weights", "LINEAR", &[0.0, 1.0], values);
    assert!((extents(&at(&glb, 0.5))[0] - 2.0).abs() < 1e-6);
}

/// A square whose right side its first morph target moves by 2 along x, and whose top the second moves by 4 along y.
fn morphed() -> Glb {
    let mut glb = Glb::square();
    let [mut right, mut top] = [[0.0; 12]; 2];
    (right[3], right[6]) = (2.0, 2.0);
    (top[7], top[10]) = (4.0, 4.0);
    let [right, top] = [right, top].map(|deltas| glb.accessor(&f32s(&deltas), F32, "VEC3", 4, false));
    glb.json["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": right}, {"POSITION": top}]);
    glb
}

#[test]
fn weights_morph_one_node_and_leave_the_others_of_its_mesh() {
    let mut glb = morphed();
    glb.json["meshes"][0]["weights"] = json!([0.0, 0.25]);
    glb.json["nodes"] = json!([{"mesh": 0}, {"mesh": 0}, {"mesh": 0, "translation": [0, 0, 1]}]);
    glb.json["scenes"] = json!([{"nodes": [0, 1, 2]}]);
    let values = glb.accessor(&f32s(&[0.0, 0.0, 1.0, 0.5]), F32, "SCALAR", 4, false);
    glb.animate(0, "weights", "LINEAR", &[0.0, 1.0], values);
    let scene = at(&glb, 0.5);
    let size = |i: usize| scene.meshes[scene.instances[i].mesh].bounds.max;
    assert_eq!((size(0), size(1)), (Vec3::new(2.0, 2.0, 0.0), Vec3::new(1.0, 2.0, 0.0)));
    assert_eq!((scene.meshes.len(), scene.instances[1].mesh), (2, scene.instances[2].mesh));
    // The closed form again, for splines of several weights: tangents 0, so half way at half time.
    let mut values = vec![0.0; 12];
    (values[8], values[9]) = (1.0, 0.5);
    let mut glb = morphed();
    let values = glb.accessor(&f32s(&values), F32, "SCALAR", 12, false);
    glb.animate(0, "weights", "CUBICSPLINE", &[0.0, 1.0], values);
    assert_eq!(extents(&at(&glb, 0.5)), [2.0, 2.0, 0.0]);
}

#[test]
fn an_animated_joint_moves_the_skin() {
    let mut glb = Glb::square();
    let joints = glb.accessor(&[0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0], U8, "VEC4", 4, false);
    let weights = glb.accessor(&f32s(&[1.0, 0.0, 0.0, 0.0].repeat(4)), F32, "VEC4", 4, false);
    let attributes = &mut glb.json["meshes"][0]["primitives"][0]["attributes"];
    (attributes["JOINTS_0"], attributes["WEIGHTS_0"]) = (json!(joints), json!(weights));
    glb.json["nodes"] = json!([{"mesh": 0, "skin": 0}, {}, {"children": [3]}, {"translation": [1, 0, 0]}]);
    // The joint hangs on the node that moves, and outside the scene.
    glb.json["skins"] = json!([{"joints": [1, 3]}]);
    let values = glb.accessor(&f32s(&[0.0, 0.0, 0.0, 6.0, 0.0, 0.0]), F32, "VEC3", 2, false);
    glb.animate(2, "translation", "LINEAR", &[0.0, 3.0], values);
    for (time, x) in [(0.0, 2.0), (1.0, 4.0), (3.0, 8.0)] {
        assert_eq!(extents(&at(&glb, time)), [x, 1.0, 0.0], "{time}");
    }
    assert_eq!(extents(&glb.load().unwrap()), [2.0, 1.0, 0.0]);
}

#[test]
fn parents_lights_and_cameras_move_and_meshes_stay_shared() {
    let mut glb = moved("translation", "LINEAR", &[0.0, 1.0], "VEC3", &[0.0, 0.0, 0.0, 0.0, 2.0, 0.0]);
    glb.json["nodes"] = json!([{"children": [1, 2, 3, 4]}, {"mesh": 0}, {"mesh": 0, "translation": [3, 0, 0]},
        {"camera": 0}, {"extensions": {"KHR_lights_punctual": {"light": 0}}}]);
    glb.json["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}]);
    glb.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [{"type": "point"}]}});
    let scene = at(&glb, 0.5);
    assert_eq!((scene.meshes.len(), scene.instances.len()), (1, 2));
    assert_eq!(scene.cameras[0].camera.position_world, Vec3::Y);
    assert_eq!(scene.lights[0].light.position_world, Vec3::Y);
    assert!(near(corner(&scene), Vec3::new(1.0, 1.0, 0.0)));
}

#[test]
fn sparse_keys_and_a_choice_of_animations() {
    let mut glb = moved("translation", "STEP", &[0.0, 1.0], "VEC3", &[0.0; 6]);
    let values = glb.json["animations"][0]["samplers"][0]["output"].as_u64().unwrap() as usize;
    let (places, sparse) = (glb.view(&[1]), glb.view(&f32s(&[0.0, 7.0, 0.0])));
    glb.json["accessors"][values]["sparse"] = json!({"count": 1,
        "indices": {"bufferView": places, "componentType": U8}, "values": {"bufferView": sparse}});
    assert!(near(corner(&at(&glb, 1.0)), Vec3::new(1.0, 7.0, 0.0)));

    let other = glb.accessor(&f32s(&[0.0, 0.0, 9.0]), F32, "VEC3", 1, false);
    let number = glb.animate(0, "translation", "LINEAR", &[0.0], other);
    glb.json["animations"][number]["name"] = json!("Run");
    for (animation, z) in [(None, 0.0), (Some("Run"), 9.0), (Some("1"), 9.0), (Some("0"), 0.0)] {
        let scene = load_at(&glb.bytes(), "glb", &pose(0.5, animation)).unwrap();
        assert_eq!(corner(&scene).z, z, "{animation:?}");
    }
    let error = load_at(&glb.bytes(), "glb", &pose(0.5, "Ran")).unwrap_err();
    assert!(matches!(error, SceneError::Pose { .. }));
    assert!(error.to_string().contains("no animation \"Ran\"; there are 0, 1 \"Run\""), "{error}");
    // What does not play is not looked at.
    glb.json["animations"][0] = json!({"channels": 3});
    assert!(load_at(&glb.bytes(), "glb", &pose(0.5, "Run")).is_ok() && glb.load().is_ok());
    assert!(glb.load_at(0.5).is_err());
}

#[test]
fn what_does_not_move_says_so() {
    let is_told = |scene: &Scene| scene.warnings.iter().any(|w| w.contains("no animation"));
    for spec in ["builtin:torus", "builtin:knots"] {
        let scene = umbrage_scene::load_at(spec, &pose(1.0, None)).unwrap();
        assert!(is_told(&scene) && scene.playing.is_none(), "{spec}");
        assert!(!is_told(&umbrage_scene::load(spec).unwrap()));
        let error = umbrage_scene::load_at(spec, &pose(1.0, "Run")).unwrap_err().to_string();
        assert!(error.contains(spec) && error.contains("\"Run\""), "{error}");
        for time in [f32::NAN, f32::INFINITY] {
            let error = umbrage_scene::load_at(spec, &pose(time, None)).unwrap_err().to_string();
            assert!(error.contains("not finite"), "{error}");
        }
    }
    assert!(is_told(&at(&Glb::square(), 1.0)));
}

#[test]
fn pointers_are_one_warning_and_the_other_channels_play() {
    let mut glb = moved("translation", "LINEAR", &[0.0], "VEC3", &[0.0, 5.0, 0.0]);
    let pointer = json!({"sampler": 0, "target": {"path": "pointer",
        "extensions": {"KHR_animation_pointer": {"pointer": "/materials/0/emissiveFactor"}}}});
    let channels = glb.json["animations"][0]["channels"].as_array_mut().unwrap();
    channels.extend([pointer.clone(), pointer, json!({"sampler": 0, "target": {"path": "scale"}})]);
    for declared in [json!([]), json!(["KHR_animation_pointer"])] {
        glb.json["extensionsUsed"] = declared;
        let scene = at(&glb, 0.0);
        assert!(near(corner(&scene), Vec3::new(1.0, 5.0, 0.0)));
        assert_eq!(scene.warnings.len(), 1, "{:?}", scene.warnings);
        assert!(scene.warnings[0].contains("KHR_animation_pointer"), "{:?}", scene.warnings);
    }
}

type Damage = fn(&mut Glb);

#[test]
fn each_kind_of_damage_has_its_message() {
    fn sampler(glb: &mut Glb) -> &mut Value {
        &mut glb.json["animations"][0]["samplers"][0]
    }
    fn channel(glb: &mut Glb) -> &mut Value {
        &mut glb.json["animations"][0]["channels"][0]
    }
    fn times(glb: &mut Glb, times: &[f32]) {
        let input = glb.accessor(&f32s(times), F32, "SCALAR", times.len(), false);
        sampler(glb)["input"] = json!(input);
    }
    let cases: &[(Damage, &str)] = &[
        (|g| times(g, &[1.0, 0.0]), "key 1 is at 0 s, before key 0 at 1 s"),
        (|g| times(g, &[0.0, f32::NAN]), "time of key 1 is not finite"),
        (|g| times(g, &[0.0, 1.0, 2.0]), "3 keys need 9 numbers and have 6"),
        (|g| times(g, &[]), "no keys"),
        (|g| sampler(g)["interpolation"] = json!("CUBICSPLINE"), "2 keys need 18 numbers and have 6"),
        (
            |g| sampler(g)["interpolation"] = json!("CATMULLROMSPLINE"),
            "\"CATMULLROMSPLINE\" is none of LINEAR",
        ),
        (|g| sampler(g)["input"] = json!(1), "times: accessor 1 is 1 x U8, not floats"),
        (|g| sampler(g)["input"] = json!(0), "times: accessor 0 has 3 components"),
        (|g| sampler(g)["input"] = json!(99), "times: accessor 99 does not exist"),
        (|g| sampler(g)["output"] = json!(99), "values: accessor 99 does not exist"),
        (|g| sampler(g)["output"] = json!(1), "values: accessor 1 is 1 x U8, which is not allowed"),
        (|g| sampler(g)["output"] = json!(-1), "invalid value"),
        (|g| channel(g)["sampler"] = json!(7), "sampler 7 does not exist, there are 1"),
        (
            |g| channel(g)["target"]["node"] = json!(7),
            "channel 0 (translation of node 7): that node does not exist",
        ),
        (
            |g| channel(g)["target"]["path"] = json!("rotation"),
            "has 3 components for each element; 4 are needed",
        ),
        (|g| channel(g)["target"]["path"] = json!("weights"), "no mesh with morph targets"),
        (|g| channel(g)["target"] = json!({}), "missing field `path`"),
        (|g| g.json["animations"][0] = json!({"channels": []}), "missing field `samplers`"),
        (|g| g.json["animations"] = json!({}), "its animations: "),
        (
            |g| g.json["nodes"][0]["matrix"] = json!([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]),
            "a matrix",
        ),
        (|g| g.json["accessors"][2]["count"] = json!(u64::MAX), "do not lie in"),
    ];
    for (number, (damage, word)) in cases.iter().enumerate() {
        let mut glb = moved("translation", "LINEAR", &[0.0, 1.0], "VEC3", &[0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
        glb.json["animations"][0]["name"] = json!("a\nb");
        assert!(at(&glb, 0.5).warnings.is_empty());
        damage(&mut glb);
        let message = glb.load_at(0.5).expect_err(word).to_string();
        assert!(message.contains(word), "case {number}, {word}: {message}");
        assert!(!message.contains('\n') && message.contains(".glb: ") && message.len() < 600, "{message}");
        assert!(message.contains("without a time"), "the way out: {message}");
        if !word.starts_with("its animations") {
            assert!(message.contains("animation 0 \"a b\"") || word.contains("missing field"), "{message}");
        }
        assert!(glb.load().is_ok(), "case {number}: at rest it is not looked at");
    }
    let glb = moved("translation", "LINEAR", &[0.0, 1.0], "VEC3", &[0.0, 0.0, 0.0, 1.0, f32::NAN, 1.0]);
    let message = glb.load_at(0.5).unwrap_err().to_string();
    assert!(message.contains("channel 0 (translation of node 0 \"N\"): its value at 0.5 s"), "{message}");
    let mut glb = moved("scale", "LINEAR", &[0.0], "VEC3", &[2.0; 3]);
    let twice = glb.json["animations"][0]["channels"][0].clone();
    glb.json["animations"][0]["channels"].as_array_mut().unwrap().push(twice);
    assert!(at(&glb, 0.0).warnings[0].contains("moves the scale of node 0 \"N\" twice"));
}

/// gltf-validator's broken animations: each has its answer, with a time and without.
#[test]
fn the_validators_animations() {
    let Some(folder) = shared("invalid/gltf-validator") else { return };
    for (file, word) in [
        ("animation/channel_duplicate_targets.gltf", "no triangles"),
        ("animation/channel_node_no_morphs.gltf", "no mesh with morph targets"),
        ("animation/empty_objects.gltf", "missing field"),
        ("animation/sampler_input_format_invalid.gltf", "times: "),
        ("animation/sampler_output_count_invalid.gltf", "numbers and have"),
        ("animation/sampler_too_few_cubic_frames.gltf", "no triangles"),
        ("animation/unresolved_channel_target.gltf", "that node does not exist"),
        ("animation/unresolved_sampler_output.gltf", "does not exist"),
        // A key before 0 and two at one time: against the rules, but it is clear what they mean.
        ("animation_data/invalid_input_values.gltf", "no triangles"),
        ("animation_data/quaternion_non_unit_values.gltf", "no triangles"),
        (
            "ext/KHR_animation_pointer/animation/channel/target/invalid_channel_target_node.gltf",
            "no triangles",
        ),
        ("ext/KHR_animation_pointer/animation/channel/target/invalid_pointer_syntax.gltf", "no triangles"),
        ("ext/KHR_animation_pointer/animation/channel/target/unexpected_extension.gltf", "no triangles"),
    ] {
        let path = folder.join(file);
        let error = umbrage_scene::load_at(&path.to_string_lossy(), &pose(0.5, None)).expect_err(file);
        let message = error.to_string();
        assert!(message.contains(word) && !message.contains('\n'), "{file}: {message}");
    }
}

/// Boxes of animated files, worked out anew from the files' bytes by a script that shares nothing with the loader.
const EXTENTS: &[(&str, &str, f32, [f64; 3])] = &[
    ("fox/Fox.glb", "0", 1.0, [33.80238, 76.82511, 147.01289]),
    ("fox/Fox.glb", "1", 0.3, [25.18543, 76.58788, 161.43003]),
    ("fox/Fox.glb", "2", 0.9, [33.41089, 69.48928, 163.71818]),
    ("loader-features/RiggedFigure/RiggedFigure.glb", "0", 0.6, [0.89071, 1.46761, 0.34074]),
    ("loader-features/BoxAnimated/BoxAnimated.glb", "0", 2.2, [1.0, 3.61178, 1.16891]),
    ("loader-features/AnimatedMorphCube/AnimatedMorphCube.glb", "0", 1.7, [2.0, 2.0, 0.13592]),
    ("morph-stress-test/MorphStressTest.glb", "1", 0.9, [4.0, 1.58726, 1.0]),
    ("mannequiny/mannequiny.glb", "5", 0.25, [0.79734, 1.61631, 1.00504]),
    ("recursive-skeletons/RecursiveSkeletons.glb", "0", 0.7, [167.11181, 125.79771, 149.07769]),
    ("loader-features/InterpolationTest/InterpolationTest.glb", "0", 0.5, [8.73512, 10.11838, 2.00894]),
    ("loader-features/InterpolationTest/InterpolationTest.glb", "1", 0.5, [8.73512, 10.11838, 2.00894]),
    ("loader-features/InterpolationTest/InterpolationTest.glb", "2", 0.5, [8.73512, 10.11838, 2.00367]),
    ("loader-features/InterpolationTest/InterpolationTest.glb", "3", 0.5, [8.73512, 10.11838, 2.00894]),
    ("loader-features/InterpolationTest/InterpolationTest.glb", "4", 0.5, [9.13511, 10.11838, 2.00894]),
    ("loader-features/InterpolationTest/InterpolationTest.glb", "5", 0.5, [9.05956, 10.11838, 2.00894]),
    ("loader-features/InterpolationTest/InterpolationTest.glb", "6", 0.5, [8.73512, 13.15946, 2.00894]),
    ("loader-features/InterpolationTest/InterpolationTest.glb", "7", 0.5, [8.73512, 12.74346, 2.00894]),
    ("loader-features/InterpolationTest/InterpolationTest.glb", "8", 0.5, [8.73512, 12.35946, 2.00894]),
];

#[test]
fn moments_of_files_that_others_made() {
    for (file, animation, time_s, printed) in EXTENTS {
        let Some(path) = shared(file) else { return };
        let scene = umbrage_scene::load_at(&path.to_string_lossy(), &pose(*time_s, *animation)).unwrap();
        assert_sound(&scene);
        let size = extents(&scene);
        let longest = printed.iter().copied().fold(0.0, f64::max);
        for (value, printed) in std::iter::zip(size, printed) {
            assert!((value - printed).abs() < 2e-5 * longest, "{file} {animation}: {size:?}, {printed:?}");
        }
    }
}

/// Every glTF below a folder.
fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap().flatten() {
        let path = entry.path();
        if path.is_dir() && !path.ends_with("invalid") {
            files(&path, found);
        } else if path.extension().is_some_and(|e| e == "gltf" || e == "glb") {
            found.push(path);
        }
    }
}

/// Each vertex that is drawn, in the world.
fn vertices(scene: &Scene) -> Vec<Vec3> {
    let of = |instance: &umbrage_scene::Instance| {
        let world = instance.world_from_object;
        let mesh = &scene.meshes[instance.mesh];
        mesh.indices.iter().map(|i| world.transform_point3(mesh.positions[*i as usize])).collect::<Vec<_>>()
    };
    scene.instances.iter().flat_map(of).collect()
}

#[test]
fn every_animation_of_every_shared_file_moves_and_stays_finite() {
    let Some(folder) = shared("") else { return };
    let mut all = Vec::new();
    files(&folder, &mut all);
    let mut animated = 0;
    for path in all {
        let bytes = std::fs::read(&path).unwrap();
        if !bytes.windows(12).any(|w| w == b"\"animations\"") {
            continue;
        }
        animated += 1;
        let spec = path.to_string_lossy();
        let mut number = 0;
        loop {
            let load =
                |time_s| umbrage_scene::load_at(&spec, &Pose { time_s, animation: Some(number.to_string()) });
            let first = match load(0.0) {
                Ok(scene) => scene,
                Err(SceneError::Pose { .. }) if number > 0 => break,
                Err(e) => panic!("{e}"),
            };
            assert_sound(&first);
            let length_s = first.playing.as_ref().unwrap().length_s;
            let start = vertices(&first);
            assert!(length_s > 0.0 && start.iter().all(|p| p.is_finite()), "{spec} {number}");
            let mut moves = false;
            for share in [0.21, 0.5, 0.83, 1.0, 1.4] {
                let scene = load(share * length_s).unwrap();
                assert_sound(&scene);
                let places = vertices(&scene);
                assert!(places.iter().all(|p| p.is_finite()), "{spec} {number} at {share}");
                let reach = 1e-4 * scene.bounds().radius();
                moves |= places.len() != start.len()
                    || std::iter::zip(&places, &start).any(|(a, b)| a.distance(*b) > reach);
            }
            assert!(moves, "{spec}: animation {number} moves nothing");
            println!("{spec}: animation {number}, {length_s} s");
            number += 1;
        }
    }
    assert!(animated >= 9, "{animated} animated files were found");
}
