//! Files that break the rules: each is loaded on purpose or refused in one line, and none stops the program.

#![allow(clippy::unwrap_used)]

mod common;

use common::glb::{F32, Glb, Random, U8, f32s, load, load_at};
use common::{assert_sound, shared};
use serde_json::{Value, json};
use umbrage_scene::{Pose, Scene, SceneError};

fn one_line(outcome: &Result<Scene, SceneError>, what: &str) {
    match outcome {
        Ok(scene) => assert_sound(scene),
        Err(e) => {
            let message = e.to_string();
            assert!(
                !message.contains('\n') && message.len() > 20 && message.len() < 600,
                "{what}: {message:?}"
            );
        }
    }
}

/// Files of gltf-validator's set that must fail for their own reason, and a word of it. The others show nothing (they
/// are fragments without a scene), which is an error too, but not theirs.
const REASONS: &[(&str, &str)] = &[
    ("accessor/unresolved_bufferviews.gltf", "bufferView 0 does not exist"),
    ("asset/1_0_version.gltf", "only glTF 2.0"),
    ("asset/invalid_version.gltf", "only glTF 2.0"),
    ("buffer/invalid_object.gltf", "line 7 column 24"),
    ("buffer/not_found.gltf", "no such file"),
    ("buffer_view/unresolved_buffer.gltf", "buffer 1 does not exist"),
    ("ext/KHR_lights_punctual/light/empty_light_object.gltf", "`type`"),
    ("ext/KHR_lights_punctual/light/empty_object.gltf", "`lights`"),
    ("ext/KHR_lights_punctual/node/empty_object.gltf", "`light`"),
    ("ext/KHR_lights_punctual/node/unresolved_light_no_root_ext.gltf", "light 0 does not exist"),
    ("ext/KHR_lights_punctual/node/unresolved_light_empty_root_array.gltf", "light 0 does not exist"),
    ("glb/empty_file.glb", "empty"),
    ("glb/empty_json_object.glb", "`asset`"),
    ("glb/invalid_magic.glb", "neither glTF"),
    ("glb/json_and_two_buffers.glb", "chunk 2"),
    ("glb/misplaced_bin_chunk.glb", "chunk 2"),
    ("glb/only_bin_chunk.glb", "not JSON"),
    ("glb/truncated_chunk_data.glb", "cut off"),
    ("glb/two_bin_chunks.glb", "not JSON"),
    ("glb/two_empty_json_chunks.glb", "chunk 1"),
    ("glb/unaligned_chunk.glb", "multiple of 4"),
    ("glb/zero_chunk_header.glb", "not JSON"),
    ("image/invalid_object.gltf", "line 7"),
    ("json/invalid_object.gltf", "neither glTF"),
    ("material/unresolved_emissive.gltf", "texture 0 does not exist"),
    ("material/unresolved_normal.gltf", "texture 0 does not exist"),
    ("mesh/empty_object.gltf", "`primitives`"),
    ("mesh/unresolved_material.gltf", "material 0 does not exist"),
    ("mesh/unresolved_positions.gltf", "accessor 0 does not exist"),
    ("node/infinite_transform.gltf", "out of range"),
    ("node/node_loop_scene.gltf", "again of"),
    ("node/unresolved_camera.gltf", "camera 0 does not exist"),
    ("node/unresolved_mesh.gltf", "mesh 0 does not exist"),
    ("root/invalid_array_elements.gltf", "line 6"),
    ("root/undefined_used_extensions.gltf", "KHR_extension"),
    ("scene/unresolved_default_scene.gltf", "scene 0 does not exist"),
    ("skin/unresolved_joint.gltf", "node 0 does not exist"),
    ("texture/unresolved_source.gltf", "image 0 does not exist"),
];

#[test]
fn every_file_of_the_validators_set_is_answered_in_one_line() {
    let Some(table) = shared("invalid/gltf-validator/EXPECTED.tsv") else { return };
    let table = std::fs::read_to_string(table).unwrap();
    let files: Vec<&str> = table.lines().skip(1).filter_map(|line| line.split('\t').next()).collect();
    assert!(files.len() > 125, "{} files", files.len());
    for (file, _) in REASONS {
        assert!(files.contains(file), "{file} is not in EXPECTED.tsv");
    }
    let mut wrong = Vec::new();
    for file in files {
        let path = shared(&format!("invalid/gltf-validator/{file}")).unwrap();
        let outcome = umbrage_scene::load(&path.to_string_lossy());
        one_line(&outcome, file);
        let message = outcome.map_or_else(|e| e.to_string(), |_| "loaded".into());
        let word = REASONS.iter().find(|(name, _)| *name == file).map_or("no triangles", |(_, word)| word);
        if !message.contains(word) {
            wrong.push(format!("{message}; \"{word}\" was expected"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The set's broken meshes hang on no node; put on one, each must be refused or drawn for a reason.
#[test]
fn the_validators_meshes_put_on_a_node() {
    let Some(folder) = shared("invalid/gltf-validator") else { return };
    for (file, word) in [
        // An attribute of the file's own making is not read, whatever its type.
        ("mesh/accessor_attribute_uint32.gltf", "without area"),
        ("mesh/accessor_unequal_count.gltf", "POSITION"),
        ("mesh/indices_invalid_format.gltf", "unsigned whole numbers"),
        ("mesh/position_accessor_invalid_format.gltf", "accessor"),
        ("mesh/unequal_joints.gltf", "must come together"),
        ("mesh/morph_attribute_invalid_count.gltf", "without area"),
        ("ext/KHR_mesh_quantization/primitive/non_required.gltf", "without area"),
    ] {
        let mut document: Value = serde_json::from_slice(&std::fs::read(folder.join(file)).unwrap()).unwrap();
        document["nodes"] = json!([{"mesh": 0}]);
        let outcome = load(document.to_string().as_bytes(), "gltf");
        one_line(&outcome, file);
        let message = outcome.map_or_else(|e| e.to_string(), |_| "loaded".into());
        assert!(message.contains(word), "{file}: {message}");
    }
}

type Damage = fn(&mut Glb);

#[test]
fn each_kind_of_damage_has_its_message() {
    let cases: &[(Damage, &str)] = &[
        (|g| g.json["accessors"][0]["count"] = json!(400), "do not lie in"),
        (|g| g.json["accessors"][0]["count"] = json!(u64::MAX), "do not lie in"),
        (|g| g.json["accessors"][0]["byteOffset"] = json!(u64::MAX - 3), "do not lie in"),
        (|g| g.json["accessors"][0]["type"] = json!("VEC9"), "type"),
        (|g| g.json["accessors"][0]["type"] = json!("VEC2"), "2 components"),
        (|g| g.json["accessors"][1]["componentType"] = json!(F32), "unsigned whole numbers"),
        (|g| g.json["bufferViews"][0]["byteLength"] = json!(u64::MAX), "do not lie in buffer 0"),
        (|g| g.json["bufferViews"][0]["byteOffset"] = json!(9999), "do not lie in buffer 0"),
        (|g| g.json["bufferViews"][0]["byteStride"] = json!(4), "byteStride 4"),
        (|g| g.json["buffers"] = json!([{"byteLength": 9999}]), "9999 bytes are announced"),
        (|g| g.json["buffers"] = json!([{"byteLength": 1}, {"byteLength": 9}]), "one passes"),
        (|g| g.json["nodes"][0]["mesh"] = json!(7), "mesh 7 does not exist"),
        (|g| g.json["nodes"][0]["skin"] = json!(0), "skin 0 does not exist"),
        (|g| g.json["nodes"][0]["children"] = json!([0]), "its own ancestor"),
        (|g| g.json["extensionsRequired"] = json!(["KHR_texture_basisu"]), "KHR_texture_basisu"),
        (|g| g.json["meshes"][0]["primitives"][0]["mode"] = json!(9), "mode"),
        (|g| g.json["nodes"][0]["scale"] = json!([0, 0, 0]), "no triangles"),
        (|g| g.json["meshes"][0]["name"] = json!("a\nb\u{1b}[0m"), "one passes"),
        (|g| g.json["materials"] = json!([{"alphaMode": "GLASS"}]), "one passes"),
    ];
    for (number, (damage, word)) in cases.iter().enumerate() {
        let mut glb = Glb::square();
        damage(&mut glb);
        let outcome = glb.load();
        one_line(&outcome, word);
        match outcome {
            Ok(_) => assert_eq!(*word, "one passes", "case {number}"),
            Err(e) => assert!(e.to_string().contains(word), "case {number}, {word}: {e}"),
        }
    }
}

#[test]
fn messages_name_mesh_primitive_vertex_and_index() {
    let mut glb = Glb::square();
    let far = glb.accessor(&[0, 1, 200], U8, "SCALAR", 3, false);
    glb.json["meshes"][0]["primitives"][0]["indices"] = json!(far);
    let message = glb.load().unwrap_err().to_string();
    assert!(
        message.contains("mesh 0 \"M\", primitive 0: index 2 is 200, but there are 4 vertices"),
        "{message}"
    );

    let mut nan = Glb::square();
    let positions = nan.accessor(&f32s(&[f32::NAN; 12]), F32, "VEC3", 4, false);
    nan.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(positions);
    let message = nan.load().unwrap_err().to_string();
    assert!(message.contains("mesh \"M\": vertex 0 is at [NaN"), "{message}");
}

/// A few hundred bytes must not fill the memory; the whole budget has its test beside `Document::charge`.
#[test]
fn what_a_small_file_may_ask_for_is_bounded() {
    for count in [(1_u64 << 24) + 1, 1 << 32, u64::MAX] {
        let mut glb = Glb::new();
        let zeros = glb.push("accessors", json!({"componentType": F32, "type": "VEC3", "count": count}));
        glb.primitive(json!({"attributes": {"POSITION": zeros}}));
        assert!(glb.load().unwrap_err().to_string().contains("announced without data"), "{count}");
    }
}

/// A file with every feature that reads bytes, as a start for damage.
fn rich() -> Glb {
    let mut glb = Glb::square();
    let joints = glb.accessor(&[0; 16], U8, "VEC4", 4, false);
    let weights = glb.accessor(&f32s(&[1.0, 0.0, 0.0, 0.0].repeat(4)), F32, "VEC4", 4, false);
    let uvs = glb.accessor(&f32s(&[0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0]), F32, "VEC2", 4, false);
    let normals = glb.accessor(&f32s(&[0.0, 0.0, 1.0].repeat(4)), F32, "VEC3", 4, false);
    let places = glb.view(&[2]);
    let values = glb.view(&f32s(&[2.0, 2.0, 0.0]));
    glb.json["accessors"][0]["sparse"] = json!({"count": 1, "indices": {"bufferView": places, "componentType": U8}, "values": {"bufferView": values}});
    let mut png = std::io::Cursor::new(Vec::new());
    image::DynamicImage::new_rgb8(4, 4).write_to(&mut png, image::ImageFormat::Png).unwrap();
    let picture = glb.view(&png.into_inner());
    glb.json["images"] = json!([{"bufferView": picture, "mimeType": "image/png"}]);
    glb.json["textures"] = json!([{"source": 0}]);
    glb.json["materials"] =
        json!([{"normalTexture": {"index": 0}, "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]);
    glb.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    glb.json["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": normals}]);
    glb.json["meshes"][0]["weights"] = json!([0.5]);
    let attributes = &mut glb.json["meshes"][0]["primitives"][0]["attributes"];
    for (name, accessor) in
        [("JOINTS_0", joints), ("WEIGHTS_0", weights), ("TEXCOORD_0", uvs), ("NORMAL", normals)]
    {
        attributes[name] = json!(accessor);
    }
    glb.json["nodes"] =
        json!([{"mesh": 0, "skin": 0, "children": [1, 2]}, {"name": "joint"}, {"mesh": 0, "camera": 0}]);
    glb.json["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}]);
    glb.json["skins"] = json!([{"joints": [1]}]);
    let turns = [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0; 3], [0.0; 3], [0.0, 1.0, 0.0], [0.0; 3]].concat();
    let turns = glb.accessor(&f32s(&turns), F32, "VEC3", 6, false);
    glb.animate(1, "translation", "CUBICSPLINE", &[0.0, 1.0], turns);
    let weights = glb.accessor(&f32s(&[0.0, 1.0]), F32, "SCALAR", 2, false);
    let number = glb.animate(0, "weights", "LINEAR", &[0.0, 1.0], weights);
    let more = glb.json["animations"][number].clone();
    let first = &mut glb.json["animations"][0];
    first["samplers"].as_array_mut().unwrap().push(more["samplers"][0].clone());
    first["channels"]
        .as_array_mut()
        .unwrap()
        .push(json!({"sampler": 1, "target": more["channels"][0]["target"]}));
    let vertices: Vec<[f32; 3]> = (0..4).map(|i| [i as f32, 0.0, 0.0]).collect();
    let coded = meshopt::encode_vertex_buffer(&vertices).unwrap();
    let view = glb.view(&coded);
    let offset = glb.json["bufferViews"][view]["byteOffset"].clone();
    glb.json["bufferViews"][view]["extensions"] = json!({"EXT_meshopt_compression":
        {"buffer": 0, "byteOffset": offset, "byteLength": coded.len(), "byteStride": 12, "count": 4, "mode": "ATTRIBUTES"}});
    glb
}

fn damaged(good: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = good.to_vec();
    match random.below(4) {
        0 => bytes.truncate(random.below(good.len())),
        1 => {
            let (from, to, length) = (random.below(good.len()), random.below(good.len()), random.below(64));
            let piece = good[from..(from + length).min(good.len())].to_vec();
            let end = (to + piece.len()).min(bytes.len());
            bytes.splice(to..end, piece);
        }
        kind => {
            for _ in 0..=random.below(if kind == 2 { 2 } else { 24 }) {
                let at = random.below(bytes.len());
                bytes[at] = if random.below(2) == 0 {
                    random.below(256) as u8
                } else {
                    bytes[at] ^ 1 << random.below(8)
                };
            }
        }
    }
    bytes
}

#[test]
fn two_thousand_corruptions_of_a_good_file_are_answered() {
    let good = rich();
    assert_sound(&good.load().unwrap());
    assert_sound(&good.load_at(0.5).unwrap());
    let good = good.bytes();
    let start = std::time::Instant::now();
    let mut random = Random(0x5EED);
    let mut loaded = 0;
    for round in 0..2000 {
        // Half of them at a moment of their animation.
        let bytes = damaged(&good, &mut random);
        let outcome = match round % 2 {
            0 => load(&bytes, "glb"),
            _ => load_at(&bytes, "glb", &Pose { time_s: 0.5, animation: None }),
        };
        one_line(&outcome, &format!("round {round}"));
        loaded += usize::from(outcome.is_ok());
    }
    // Neither all nor none: else the damage tests nothing.
    assert!(loaded > 20 && loaded < 1980, "{loaded} of 2000 still load");
    assert!(start.elapsed().as_secs() < 60, "{:?}", start.elapsed());
}

/// The compressed pieces go through decoders of other hands; damage in them must end as damage elsewhere does.
#[test]
fn corruptions_of_a_draco_file_are_answered() {
    let Some(folder) = shared("required-extensions/MorphPrimitivesTest-draco") else { return };
    let mut document: Value =
        serde_json::from_slice(&std::fs::read(folder.join("MorphPrimitivesTest.gltf")).unwrap()).unwrap();
    let bin = std::fs::read(folder.join("MorphPrimitivesTest.bin")).unwrap();
    for list in ["images", "textures", "materials"] {
        document.as_object_mut().unwrap().remove(list);
    }
    for primitive in document["meshes"][0]["primitives"].as_array_mut().unwrap() {
        primitive.as_object_mut().unwrap().remove("material");
    }
    document["buffers"][0].as_object_mut().unwrap().remove("uri");
    let mut glb = Glb { json: document, bin };
    assert_eq!(glb.load().unwrap().triangles(), 32);
    let good = glb.bin.clone();
    let mut random = Random(7);
    let (mut loaded, start) = (0, std::time::Instant::now());
    for round in 0..500 {
        glb.bin.clone_from(&good);
        for _ in 0..=random.below(3) {
            let at = 360 + random.below(520);
            glb.bin[at] = random.below(256) as u8;
        }
        let outcome = glb.load();
        one_line(&outcome, &format!("round {round}"));
        loaded += usize::from(outcome.is_ok());
    }
    assert!(loaded < 500, "no damage was noticed");
    assert!(start.elapsed().as_secs() < 60, "{:?}", start.elapsed());
}
