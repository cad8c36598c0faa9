//! Every index in the document points at something. Checked once, so that later steps may simply index.
//!
//! Animations are not looked at: the one that plays, if any does, is checked where it is read.

use super::document::label;
use gltf::json;

/// The first reference that leads nowhere, named.
pub(super) fn check(root: &json::Root) -> Result<(), String> {
    bytes(root)?;
    surfaces(root)?;
    meshes(root)?;
    scenes(root)
}

fn exists(place: &str, what: &str, index: usize, count: usize) -> Result<(), String> {
    if index < count {
        return Ok(());
    }
    Err(format!("{place}: {what} {index} does not exist, the file has {count}; correct or export it again"))
}

fn bytes(root: &json::Root) -> Result<(), String> {
    for (i, view) in root.buffer_views.iter().enumerate() {
        exists(&format!("bufferView {i}"), "buffer", view.buffer.value(), root.buffers.len())?;
    }
    let views = root.buffer_views.len();
    for (i, accessor) in root.accessors.iter().enumerate() {
        let place = label("accessor", i, accessor.name.as_ref());
        let sparse = accessor.sparse.as_ref();
        let named = [
            accessor.buffer_view,
            sparse.map(|s| s.indices.buffer_view),
            sparse.map(|s| s.values.buffer_view),
        ];
        for view in named.into_iter().flatten() {
            exists(&place, "bufferView", view.value(), views)?;
        }
    }
    for (i, image) in root.images.iter().enumerate() {
        if let Some(view) = image.buffer_view {
            exists(&label("image", i, image.name.as_ref()), "bufferView", view.value(), views)?;
        }
    }
    Ok(())
}

fn surfaces(root: &json::Root) -> Result<(), String> {
    for (i, texture) in root.textures.iter().enumerate() {
        let place = label("texture", i, texture.name.as_ref());
        if let Some(sampler) = texture.sampler {
            exists(&place, "sampler", sampler.value(), root.samplers.len())?;
        }
        // The parser writes u32::MAX where `source` is missing, which is right for extensions' textures.
        if texture.source.value() != u32::MAX as usize {
            exists(&place, "image", texture.source.value(), root.images.len())?;
        }
    }
    let textures = root.textures.len();
    for (i, material) in root.materials.iter().enumerate() {
        let place = label("material", i, material.name.as_ref());
        let pbr = &material.pbr_metallic_roughness;
        let infos = [&pbr.base_color_texture, &pbr.metallic_roughness_texture, &material.emissive_texture];
        let named = infos.into_iter().flatten().map(|info| info.index);
        let normal = material.normal_texture.iter().map(|info| info.index);
        let occlusion = material.occlusion_texture.iter().map(|info| info.index);
        for texture in named.chain(normal).chain(occlusion) {
            exists(&place, "texture", texture.value(), textures)?;
        }
    }
    Ok(())
}

fn meshes(root: &json::Root) -> Result<(), String> {
    let accessors = root.accessors.len();
    for (i, mesh) in root.meshes.iter().enumerate() {
        for (k, primitive) in mesh.primitives.iter().enumerate() {
            let place = format!("{}, primitive {k}", label("mesh", i, mesh.name.as_ref()));
            let targets = primitive.targets.iter().flatten();
            let deltas = targets.flat_map(|t| [t.positions, t.normals, t.tangents]).flatten();
            for accessor in primitive.attributes.values().copied().chain(primitive.indices).chain(deltas) {
                exists(&place, "accessor", accessor.value(), accessors)?;
            }
            if let Some(material) = primitive.material {
                exists(&place, "material", material.value(), root.materials.len())?;
            }
        }
    }
    for (i, skin) in root.skins.iter().enumerate() {
        let place = label("skin", i, skin.name.as_ref());
        for joint in skin.joints.iter().copied().chain(skin.skeleton) {
            exists(&place, "node", joint.value(), root.nodes.len())?;
        }
        if let Some(matrices) = skin.inverse_bind_matrices {
            exists(&place, "accessor", matrices.value(), accessors)?;
        }
    }
    Ok(())
}

fn scenes(root: &json::Root) -> Result<(), String> {
    let lights =
        root.extensions.iter().flat_map(|e| &e.khr_lights_punctual).map(|l| l.lights.len()).sum::<usize>();
    for (i, node) in root.nodes.iter().enumerate() {
        let place = label("node", i, node.name.as_ref());
        let one = |what: &str, index: Option<usize>, count: usize| {
            index.map_or(Ok(()), |index| exists(&place, what, index, count))
        };
        one("mesh", node.mesh.map(|m| m.value()), root.meshes.len())?;
        one("skin", node.skin.map(|s| s.value()), root.skins.len())?;
        one("camera", node.camera.map(|c| c.value()), root.cameras.len())?;
        let light = node.extensions.iter().flat_map(|e| &e.khr_lights_punctual).next();
        one("light", light.map(|l| l.light.value()), lights)?;
        for child in node.children.iter().flatten() {
            exists(&place, "node", child.value(), root.nodes.len())?;
        }
    }
    for (i, scene) in root.scenes.iter().enumerate() {
        for node in &scene.nodes {
            exists(&label("scene", i, scene.name.as_ref()), "node", node.value(), root.nodes.len())?;
        }
    }
    match root.scene {
        Some(scene) => exists("the default scene", "scene", scene.value(), root.scenes.len()),
        None => Ok(()),
    }
}
