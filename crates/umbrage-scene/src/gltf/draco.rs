//! `KHR_draco_mesh_compression`: a primitive's attributes and indices out of one compressed piece.
//!
//! What is decoded is laid down in the form that the accessors announce, so that all later steps read it as they read
//! plain data.

use super::buffers::{primitive_compression, whole};
use super::document::Document;
use draco_core::{DecoderBuffer, Mesh, MeshDecoder};
use gltf::json::accessor::ComponentType;
use gltf::json::mesh::{Primitive, Semantic};
use gltf::json::validation::Checked;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// The extension's name.
pub(super) const NAME: &str = "KHR_draco_mesh_compression";

/// Decodes every primitive that has no plain data of its own.
pub(super) fn decompress(document: &mut Document<'_>) -> Result<(), String> {
    for mesh in 0..document.root.meshes.len() {
        for primitive in 0..document.root.meshes[mesh].primitives.len() {
            let json = &document.root.meshes[mesh].primitives[primitive];
            let Some(how) = primitive_compression(json) else { continue };
            if has_plain_data(document, json) {
                continue;
            }
            let decoded = decode(document, json, how)
                .map_err(|e| format!("{}: Draco: {e}", document.primitive_label(mesh, primitive)))?;
            document.decompressed_accessors.extend(decoded);
        }
    }
    Ok(())
}

/// A file may carry the same primitive uncompressed, for readers without the extension; that is the quicker way.
fn has_plain_data(document: &Document<'_>, primitive: &Primitive) -> bool {
    let positions = primitive.attributes.get(&Checked::Valid(Semantic::Positions));
    positions.is_some_and(|a| document.root.accessors[a.value()].buffer_view.is_some())
}

fn decode(
    document: &Document<'_>,
    primitive: &Primitive,
    how: &serde_json::Value,
) -> Result<Vec<(usize, Vec<u8>)>, String> {
    let view = whole(how, "bufferView").ok_or("`bufferView` is missing or no whole number")?;
    let source = document.view(usize::try_from(view).map_err(|e| e.to_string())?)?;
    let mesh = mesh(source)?;
    let (points, faces) = (mesh.num_points(), mesh.num_faces());
    let mut decoded = Vec::new();
    for (semantic, accessor) in &primitive.attributes {
        let Some(id) = how.get("attributes").and_then(|ids| whole(ids, &semantic.to_string())) else {
            continue;
        };
        let Some(attribute) = u32::try_from(id).ok().and_then(|id| mesh.attribute_by_unique_id(id)) else {
            return Err(format!("{} is attribute {id}, which is not in the data", semantic.to_string()));
        };
        let format = document.format(accessor.value())?;
        document.charge(points, format.width * 4)?;
        let values = attribute.read_f32s(points, format.width);
        decoded.push((accessor.value(), laid_down(values.into_iter(), format.component)));
    }
    if let Some(accessor) = primitive.indices {
        let format = document.format(accessor.value())?;
        document.charge(faces, 12)?;
        if points as u64 > 1 << (8 * format.component.size()) {
            return Err(format!("{points} vertices are more than its indices ({}) can name", format.name()));
        }
        let corners = mesh.faces().iter().flatten().map(|corner| corner.0);
        decoded.push((
            accessor.value(),
            match format.component {
                ComponentType::U8 => corners.map(|c| c as u8).collect(),
                ComponentType::U16 => corners.flat_map(|c| (c as u16).to_le_bytes()).collect(),
                _ => corners.flat_map(u32::to_le_bytes).collect(),
            },
        ));
    }
    Ok(decoded)
}

/// Damaged data is the decoder's to refuse. Should it stop on a broken assumption instead, the file is refused all the
/// same and the program goes on.
fn mesh(source: &[u8]) -> Result<Mesh, String> {
    let mut mesh = Mesh::new();
    let outcome = catch_unwind(AssertUnwindSafe(|| {
        MeshDecoder::new().decode(&mut DecoderBuffer::new(source), &mut mesh).map_err(|e| format!("{e:?}"))
    }));
    match outcome {
        Ok(Ok(())) => Ok(mesh),
        Ok(Err(e)) => Err(format!("the data is damaged ({e}); copy or export the file again")),
        Err(_) => Err("the data is damaged; copy or export the file again".into()),
    }
}

fn laid_down(values: impl Iterator<Item = f32>, component: ComponentType) -> Vec<u8> {
    match component {
        ComponentType::F32 => values.flat_map(f32::to_le_bytes).collect(),
        ComponentType::U32 => values.flat_map(|v| (v as u32).to_le_bytes()).collect(),
        ComponentType::U16 => values.flat_map(|v| (v as u16).to_le_bytes()).collect(),
        ComponentType::I16 => values.flat_map(|v| (v as i16).to_le_bytes()).collect(),
        ComponentType::U8 => values.map(|v| v as u8).collect(),
        ComponentType::I8 => values.map(|v| v as i8 as u8).collect(),
    }
}
