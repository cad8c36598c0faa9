//! `EXT_mesh_gpu_instancing`: one node that draws its mesh at many places.

use super::buffers::whole;
use super::document::Document;
use glam::{Mat4, Quat, Vec3};
use gltf::json::accessor::ComponentType::{F32, I8, I16};

/// Node from instance, for each instance; `None` for a node that is drawn once, as usual.
pub(super) fn places(document: &Document<'_>, node: usize) -> Result<Option<Vec<Mat4>>, String> {
    let extensions = document.root.nodes[node].extensions.as_ref();
    let Some(extension) = extensions.and_then(|e| e.others.get("EXT_mesh_gpu_instancing")) else {
        return Ok(None);
    };
    let at = |e: String| format!("{}, instancing: {e}", document.node_label(node));
    let find = |name: &str| -> Result<Option<usize>, String> {
        let Some(index) = extension.get("attributes").and_then(|a| whole(a, name)) else { return Ok(None) };
        match usize::try_from(index).ok().filter(|index| *index < document.root.accessors.len()) {
            Some(index) => Ok(Some(index)),
            None => Err(at(format!("{name} is accessor {index}, which does not exist"))),
        }
    };
    let vectors = |name: &str| -> Result<Option<Vec<Vec3>>, String> {
        let Some(accessor) = find(name)? else { return Ok(None) };
        if document.format(accessor).map_err(at)?.component != F32 {
            return Err(at(format!("{name} must be floats")));
        }
        Ok(Some(document.floats::<3>(accessor).map_err(at)?.into_iter().map(Vec3::from).collect()))
    };
    let (translations, scales) = (vectors("TRANSLATION")?, vectors("SCALE")?);
    let rotations = match find("ROTATION")? {
        None => None,
        Some(accessor) => {
            let format = document.format(accessor).map_err(at)?;
            if format.component != F32 && !(format.normalized && matches!(format.component, I8 | I16)) {
                return Err(at(format!("ROTATION is {}, which is not allowed", format.name())));
            }
            Some(document.floats::<4>(accessor).map_err(at)?)
        }
    };
    let counts = [
        translations.as_ref().map(Vec::len),
        rotations.as_ref().map(Vec::len),
        scales.as_ref().map(Vec::len),
    ];
    let mut counts = counts.into_iter().flatten();
    // Only attributes of its own (names with `_`) and no place: the extension asks for nothing.
    let Some(count) = counts.next() else { return Ok(None) };
    if let Some(other) = counts.find(|other| *other != count) {
        return Err(at(format!(
            "one attribute has {count} elements and another {other}; export the file again"
        )));
    }
    let matrix = |i: usize| {
        let rotation = rotations.as_ref().map_or(Quat::IDENTITY, |r| Quat::from_array(r[i]));
        let rotation = if rotation.length_squared() > 0.0 { rotation.normalize() } else { Quat::IDENTITY };
        let scale = scales.as_ref().map_or(Vec3::ONE, |s| s[i]);
        let translation = translations.as_ref().map_or(Vec3::ZERO, |t| t[i]);
        Mat4::from_scale_rotation_translation(scale, rotation, translation)
    };
    document.charge(count, size_of::<Mat4>()).map_err(at)?;
    Ok(Some((0..count).map(matrix).collect()))
}
