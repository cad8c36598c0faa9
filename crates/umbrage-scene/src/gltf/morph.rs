//! Morph targets: the mesh with the weights that it has at rest, or that an animation gives it.

use super::document::Document;
use super::geometry::Geometry;
use glam::Vec3;
use gltf::json::mesh::Primitive;

/// Adds each target's differences, times its weight. Targets without a weight have none.
pub(super) fn apply(
    document: &Document<'_>,
    primitive: &Primitive,
    weights: &[f32],
    geometry: &mut Geometry,
    place: &str,
) -> Result<(), String> {
    let targets = primitive.targets.iter().flatten();
    for (number, (target, weight)) in targets.zip(weights).enumerate() {
        if *weight == 0.0 || !weight.is_finite() {
            continue;
        }
        let count = geometry.positions.len();
        let deltas = |accessor: usize| -> Result<Vec<Vec3>, String> {
            let at = |e| format!("{place}, morph target {number}: {e}");
            document.expect_delta(accessor).map_err(at)?;
            let read = document.floats::<3>(accessor).map_err(at)?;
            if read.len() != count {
                return Err(at(format!("{} elements for {count} vertices", read.len())));
            }
            Ok(read.into_iter().map(Vec3::from).collect())
        };
        if let Some(accessor) = target.positions {
            for (position, delta) in geometry.positions.iter_mut().zip(deltas(accessor.value())?) {
                *position += *weight * delta;
            }
        }
        if let (Some(accessor), Some(normals)) = (target.normals, &mut geometry.normals) {
            for (normal, delta) in normals.iter_mut().zip(deltas(accessor.value())?) {
                *normal += *weight * delta;
            }
        }
        if let (Some(accessor), Some(tangents)) = (target.tangents, &mut geometry.tangents) {
            for (tangent, delta) in tangents.iter_mut().zip(deltas(accessor.value())?) {
                *tangent += (*weight * delta).extend(0.0);
            }
        }
    }
    Ok(())
}
