//! glTF features in files made on the spot, with expectations worked out by hand.

#![allow(clippy::unwrap_used)]

mod common;

use base64::Engine as _;
use common::glb::{F32, Glb, I8, I16, SQUARE, U8, U16, U32, f32s, load, temporary, u16s};
use common::{assert_sound, extents};
use glam::{Vec2, Vec3, Vec4};
use serde_json::json;
use umbrage_scene::{AlphaMode, Scene};

fn sound(glb: &Glb) -> Scene {
    let scene = glb.load().unwrap_or_else(|e| panic!("{e}"));
    assert_sound(&scene);
    scene
}

#[test]
fn a_square_is_two_triangles_with_flat_normals() {
    let scene = sound(&Glb::square());
    assert_eq!((scene.triangles(), scene.instances.len(), scene.meshes[0].name.as_str()), (2, 1, "M"));
    assert_eq!(scene.meshes[0].positions.len(), 6, "flat normals unshare");
    assert!(scene.meshes[0].normals.iter().all(|n| *n == Vec3::Z));
    assert_eq!(scene.materials.len(), 1);
    assert_eq!(scene.instances[0].name, "N");
    assert!(scene.name.starts_with("umbrage-scene-"));
}

#[test]
fn indices_of_every_type_and_none() {
    let corners = [0_u8, 1, 2, 0, 2, 3];
    let kinds = [
        (U8, corners.to_vec()),
        (U16, u16s(&corners.map(u16::from))),
        (U32, corners.iter().flat_map(|c| u32::from(*c).to_le_bytes()).collect()),
    ];
    for (component, bytes) in kinds {
        let mut glb = Glb::square();
        let indices = glb.accessor(&bytes, component, "SCALAR", 6, false);
        glb.json["meshes"][0]["primitives"][0]["indices"] = json!(indices);
        assert_eq!(sound(&glb).triangles(), 2, "{component}");
    }
    let mut plain = Glb::square();
    plain.json["meshes"][0]["primitives"][0].as_object_mut().unwrap().remove("indices");
    assert_eq!(sound(&plain).triangles(), 1, "four vertices are one triangle and one left over");
}

#[test]
fn strips_fans_points_and_lines() {
    for (mode, corners, triangles) in [(5, [0_u8, 1, 3, 2], 2), (6, [0, 1, 2, 3], 2)] {
        let mut glb = Glb::square();
        let indices = glb.accessor(&corners, U8, "SCALAR", 4, false);
        glb.json["meshes"][0]["primitives"][0]["indices"] = json!(indices);
        glb.json["meshes"][0]["primitives"][0]["mode"] = json!(mode);
        let scene = sound(&glb);
        assert_eq!(scene.triangles(), triangles, "mode {mode}");
        assert!(scene.meshes[0].normals.iter().all(|n| *n == Vec3::Z), "mode {mode}: all face the same way");
    }
    for mode in 0..4 {
        let mut glb = Glb::square();
        let mut lines = glb.json["meshes"][0]["primitives"][0].clone();
        lines["mode"] = json!(mode);
        glb.primitive(lines);
        let scene = sound(&glb);
        assert_eq!((scene.triangles(), scene.warnings.len()), (2, 1), "mode {mode}");
        glb.json["meshes"][0]["primitives"][0]["mode"] = json!(mode);
        assert!(glb.load().unwrap_err().to_string().contains("no triangles"), "mode {mode}");
    }
}

#[test]
fn quantized_positions_become_what_they_mean() {
    let signed: Vec<u8> = SQUARE.iter().map(|v| if *v == 1.0 { 127 } else { 0x80 }).collect();
    let short: Vec<u8> = SQUARE.iter().flat_map(|v| ((*v * 300.0) as i16).to_le_bytes()).collect();
    let cases =
        [(I8, signed, true, 2.0), (I16, short.clone(), false, 300.0), (U16, short, true, 300.0 / 65535.0)];
    for (component, bytes, normalized, size) in cases {
        let mut glb = Glb::square();
        let positions = glb.accessor(&bytes, component, "VEC3", 4, normalized);
        glb.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(positions);
        assert!(glb.load().unwrap_err().to_string().contains("KHR_mesh_quantization"));
        glb.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
        glb.json["extensionsUsed"] = json!(["KHR_mesh_quantization"]);
        let extents = extents(&sound(&glb));
        assert!((extents[0] - size).abs() < 1e-6, "{component}: {extents:?}");
    }
}

#[test]
fn interleaved_attributes_and_vertex_colours() {
    let mut glb = Glb::square();
    // Stride 8: two 16-bit texture coordinates, four bytes of colour.
    let mut bytes = Vec::new();
    for corner in 0..4_u8 {
        bytes.extend(u16s(&[65535 * u16::from(corner & 1), 0]));
        bytes.extend([corner * 10, 20, 30, 255]);
    }
    let view = glb.view(&bytes);
    glb.json["bufferViews"][view]["byteStride"] = json!(8);
    let uv = glb.push(
        "accessors",
        json!({"bufferView": view, "componentType": U16, "type": "VEC2", "count": 4, "normalized": true}),
    );
    let color = glb.push("accessors", json!({"bufferView": view, "byteOffset": 4, "componentType": U8, "type": "VEC4", "count": 4, "normalized": true}));
    let attributes = &mut glb.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["TEXCOORD_0"] = json!(uv);
    attributes["COLOR_0"] = json!(color);
    let mesh = &sound(&glb).meshes[0];
    assert_eq!(mesh.colors[1], [10, 20, 30, 255]);
    assert_eq!(mesh.uvs[1], Vec2::X);

    let three = glb.accessor(&f32s(&[0.5; 12]), F32, "VEC3", 4, false);
    glb.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(three);
    assert_eq!(sound(&glb).meshes[0].colors[0], [128, 128, 128, 255]);
    let deep = glb.accessor(&u16s(&[0xFFFF; 16]), U16, "VEC4", 4, true);
    glb.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(deep);
    assert_eq!(sound(&glb).meshes[0].colors[0], [255; 4]);
}

#[test]
fn sparse_accessors_with_and_without_a_base() {
    let mut glb = Glb::square();
    let places = glb.view(&[2]);
    let values = glb.view(&f32s(&[5.0, 7.0, 0.0]));
    let sparse = json!({"count": 1, "indices": {"bufferView": places, "componentType": U8}, "values": {"bufferView": values}});
    glb.json["accessors"][0]["sparse"] = sparse;
    assert_eq!(extents(&sound(&glb)), [5.0, 7.0, 0.0]);

    glb.json["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    assert!(glb.load().unwrap_err().to_string().contains("without area"), "the other three lie in one point");
    glb.json["accessors"][0]["count"] = json!(4_000_000_000_u64);
    assert!(glb.load().unwrap_err().to_string().contains("announced without data"));
    glb.json["accessors"][0]["count"] = json!(2);
    assert!(glb.load().unwrap_err().to_string().contains("sparse index 0 is 2"));
}

#[test]
fn buffers_in_data_uris_and_beside_the_file() {
    let glb = Glb::square();
    let mut document = glb.json.clone();
    let coded = base64::engine::general_purpose::STANDARD.encode(&glb.bin);
    let uri = format!("data:application/octet-stream;base64,{coded}");
    document["buffers"] = json!([{"byteLength": glb.bin.len(), "uri": uri}]);
    assert_eq!(load(document.to_string().as_bytes(), "gltf").unwrap().triangles(), 2);

    let companion = temporary("a b.bin");
    std::fs::write(&companion, &glb.bin).unwrap();
    let name = companion.file_name().unwrap().to_string_lossy().replace(' ', "%20");
    document["buffers"][0]["uri"] = json!(name);
    let outcome = load(document.to_string().as_bytes(), "gltf");
    std::fs::remove_file(companion).unwrap();
    assert_eq!(outcome.unwrap().triangles(), 2);
    let message = load(document.to_string().as_bytes(), "gltf").unwrap_err().to_string();
    assert!(message.contains("a b.bin") && message.contains("no such file"), "{message}");
}

#[test]
fn morph_weights_of_mesh_and_node() {
    let mut glb = Glb::square();
    let deltas = glb.accessor(
        &f32s(&[0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
        F32,
        "VEC3",
        4,
        false,
    );
    glb.json["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": deltas}]);
    assert_eq!(extents(&sound(&glb))[0], 1.0, "no weights: at rest");
    glb.json["meshes"][0]["weights"] = json!([0.5]);
    assert_eq!(extents(&sound(&glb))[0], 2.0);
    glb.json["nodes"] = json!([{"mesh": 0, "weights": [1.0]}, {"mesh": 0}, {"mesh": 0}]);
    glb.json["scenes"] = json!([{"nodes": [0, 1, 2]}]);
    let scene = sound(&glb);
    assert_eq!(extents(&scene)[0], 3.0, "the node's own weight holds");
    assert_eq!(scene.meshes.len(), 2, "the others share");
}

#[test]
fn a_skin_moves_vertices_and_its_nodes_place_is_ignored() {
    let mut glb = Glb::square();
    let joints = glb.accessor(&[0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0], U8, "VEC4", 4, false);
    let weights = glb.accessor(&f32s(&[1.0, 0.0, 0.0, 0.0].repeat(4)), F32, "VEC4", 4, false);
    let attributes = &mut glb.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] = json!(joints);
    attributes["WEIGHTS_0"] = json!(weights);
    glb.json["nodes"] = json!([
        {"mesh": 0, "skin": 0, "translation": [100, 100, 100]},
        {"name": "still"},
        {"name": "moved", "translation": [4, 0, 0]},
    ]);
    glb.json["skins"] = json!([{"joints": [1, 2]}]);
    let scene = sound(&glb);
    assert_eq!(extents(&scene), [5.0, 1.0, 0.0]);
    assert_eq!(scene.bounds().min, Vec3::ZERO);
    glb.json["skins"] = json!([{"joints": [1]}]);
    let message = glb.load().unwrap_err().to_string();
    assert!(message.contains("vertex 1 hangs on joint 1"), "{message}");
}

#[test]
fn instancing_places_one_mesh_many_times() {
    let mut glb = Glb::square();
    let places = glb.accessor(&f32s(&[0.0, 0.0, 0.0, 9.0, 0.0, 0.0, 0.0, 0.0, 3.0]), F32, "VEC3", 3, false);
    let scales = glb.accessor(&f32s(&[1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 1.0, 1.0, 1.0]), F32, "VEC3", 3, false);
    glb.json["nodes"][0]["extensions"] =
        json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": places, "SCALE": scales}}});
    let scene = sound(&glb);
    assert_eq!((scene.instances.len(), scene.meshes.len(), scene.triangles()), (3, 1, 6));
    assert_eq!(extents(&scene), [11.0, 2.0, 3.0]);
    glb.json["accessors"][scales]["count"] = json!(2);
    assert!(glb.load().unwrap_err().to_string().contains("one attribute has 3"));
}

#[test]
fn each_node_and_each_place_is_an_object() {
    let mut glb = Glb::square();
    let primitive = glb.json["meshes"][0]["primitives"][0].clone();
    glb.json["meshes"][0]["primitives"] = json!([primitive, primitive]);
    let places = glb.accessor(&f32s(&[0.0, 0.0, 0.0, 9.0, 0.0, 0.0]), F32, "VEC3", 2, false);
    glb.json["nodes"] = json!([
        {"mesh": 0, "name": "one"},
        {"name": "no mesh, no object"},
        {"mesh": 0, "name": "two",
         "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": places}}}},
        {"mesh": 0, "name": "last"},
    ]);
    glb.json["scenes"][0]["nodes"] = json!([0, 1, 2, 3]);
    let scene = sound(&glb);
    let objects: Vec<_> = scene.instances.iter().map(|i| (i.name.as_str(), i.object)).collect();
    let two = [("two", 1), ("two", 2), ("two", 1), ("two", 2)];
    assert_eq!(objects, [&[("one", 0), ("one", 0)][..], &two, &[("last", 3), ("last", 3)]].concat());
    assert_eq!(scene.objects(), 4);
}

#[test]
fn extras_say_roles_and_children_do_not_inherit_them() {
    let mut glb = Glb::square();
    let roles = |extras| json!({"mesh": 0, "name": "N", "extras": extras});
    let said = [
        (json!({"umbrage": {"blocker": false}}), [false, true], ""),
        (json!({"umbrage": {"blocker": false, "receiver": false}, "other": 1}), [false, false], ""),
        (json!({"umbrage": {"receiver": false, "blocker": true}}), [true, false], ""),
        (json!({"umbrage": {}}), [true, true], ""),
        (json!({"blocker": false}), [true, true], ""),
        (json!("umbrage"), [true, true], ""),
        (json!(null), [true, true], ""),
        (json!({"umbrage": false}), [true, true], "no object of `blocker`"),
        (json!({"umbrage": {"blocker": 0, "receiver": false}}), [true, false], "neither true nor false"),
        (json!({"umbrage": {"blokcer": false}}), [true, true], "`blokcer` is passed over"),
    ];
    for (extras, expected, warning) in said {
        let mut parent = roles(extras.clone());
        parent["children"] = json!([1]);
        glb.json["nodes"] = json!([parent, {"mesh": 0, "name": "child"}]);
        let scene = sound(&glb);
        let found = scene.instances.iter().map(|i| [i.roles.blocker, i.roles.receiver]);
        assert_eq!(found.collect::<Vec<_>>(), [expected, [true, true]], "{extras}");
        let warned = scene.warnings.iter().any(|w| w.contains(warning) && w.contains("extras.umbrage"));
        assert_eq!(warned, !warning.is_empty(), "{extras}: {:?}", scene.warnings);
    }
}

#[test]
fn materials_keep_what_the_file_says() {
    let mut glb = Glb::square();
    glb.json["materials"] = json!([
        {"name": "unused"},
        {"name": "A", "alphaMode": "MASK", "doubleSided": true, "emissiveFactor": [1, 0.5, 0],
         "pbrMetallicRoughness": {"baseColorFactor": [0.1, 0.2, 0.3, 0.4], "metallicFactor": 0.25},
         "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 8}, "KHR_materials_unlit": {}}},
    ]);
    glb.json["meshes"][0]["primitives"][0]["material"] = json!(1);
    let scene = sound(&glb);
    assert_eq!(scene.materials.len(), 1, "only what is used");
    let material = &scene.materials[0];
    assert_eq!((material.name.as_str(), material.alpha), ("A", AlphaMode::Mask { cutoff: 0.5 }));
    assert_eq!(material.base_color, Vec4::new(0.1, 0.2, 0.3, 0.4));
    assert_eq!(material.emissive, Vec3::new(8.0, 4.0, 0.0));
    assert!(material.double_sided && material.unlit);
}

#[test]
fn a_picture_that_cannot_be_had_is_a_warning() {
    let mut glb = Glb::square();
    glb.json["images"] = json!([{"uri": "not there.png"}]);
    glb.json["textures"] = json!([{"source": 0}]);
    glb.json["materials"] = json!([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]);
    glb.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    let scene = sound(&glb);
    assert!(scene.materials[0].base_color_texture.is_none() && scene.images.is_empty());
    assert!(scene.warnings[0].contains("not there.png"), "{:?}", scene.warnings);
}

#[test]
fn meshopt_attributes_indices_and_filters() {
    for extension in ["EXT_meshopt_compression", "KHR_meshopt_compression"] {
        let mut glb = Glb::square();
        let vertices: Vec<[f32; 3]> = SQUARE.chunks(3).map(|c| [c[0] * 2.0, c[1], c[2]]).collect();
        let coded = [
            (
                meshopt::encode_vertex_buffer(&vertices).unwrap(),
                json!({"mode": "ATTRIBUTES", "byteStride": 12, "count": 4}),
            ),
            (
                meshopt::encode_index_buffer(&[0, 1, 2, 0, 2, 3], 4).unwrap(),
                json!({"mode": "TRIANGLES", "byteStride": 2, "count": 6}),
            ),
            (
                meshopt::encode_index_sequence(&[0, 1, 2, 0, 2, 3], 4).unwrap(),
                json!({"mode": "INDICES", "byteStride": 4, "count": 6}),
            ),
        ];
        let mut views = Vec::new();
        for (bytes, mut how) in coded {
            let view = glb.view(&bytes);
            how["buffer"] = json!(0);
            how["byteOffset"] = glb.json["bufferViews"][view]["byteOffset"].clone();
            how["byteLength"] = json!(bytes.len());
            glb.json["bufferViews"][view]["extensions"] = json!({extension: how});
            views.push(view);
        }
        glb.json["accessors"][0]["bufferView"] = json!(views[0]);
        for (view, component) in [(views[1], U16), (views[2], U32)] {
            glb.json["accessors"][1]["bufferView"] = json!(view);
            glb.json["accessors"][1]["componentType"] = json!(component);
            let scene = sound(&glb);
            assert_eq!((scene.triangles(), extents(&scene)), (2, [2.0, 1.0, 0.0]), "{extension}");
        }
        glb.json["bufferViews"][views[0]]["extensions"][extension]["byteLength"] = json!(9);
        assert!(glb.load().unwrap_err().to_string().contains("meshopt"));
    }
}
