//! Skins: vertices moved by the joints' poses as the nodes hold them, at rest or at a moment of an animation.

use super::document::{Document, label};
use super::geometry::Geometry;
use glam::{Mat3, Mat4, Vec3, Vec4};

/// For each joint: from the mesh's space to the world, by way of the joint's own space.
pub(super) fn matrices(document: &Document<'_>, skin: usize, world: &[Mat4]) -> Result<Vec<Mat4>, String> {
    let json = &document.root.skins[skin];
    let place = label("skin", skin, json.name.as_ref());
    if json.joints.is_empty() {
        return Err(format!("{place} has no joints; export the file again"));
    }
    let inverse_binds = match json.inverse_bind_matrices {
        None => vec![Mat4::IDENTITY; json.joints.len()],
        Some(accessor) => {
            let read = document.floats::<16>(accessor.value()).map_err(|e| format!("{place}: {e}"))?;
            read.iter().map(Mat4::from_cols_array).collect()
        }
    };
    if inverse_binds.len() < json.joints.len() {
        let (have, need) = (inverse_binds.len(), json.joints.len());
        return Err(format!(
            "{place}: {have} inverse bind matrices for {need} joints; export the file again"
        ));
    }
    let all: Vec<Mat4> =
        json.joints.iter().zip(&inverse_binds).map(|(joint, bind)| world[joint.value()] * *bind).collect();
    match all.iter().position(|matrix| !matrix.is_finite()) {
        Some(joint) => {
            Err(format!("{place}: the matrix of joint {joint} is not finite; export the file again"))
        }
        None => Ok(all),
    }
}

/// Moves positions, normals and tangents to the world.
pub(super) fn apply(joints: &[Mat4], geometry: &mut Geometry, place: &str) -> Result<(), String> {
    let bones = std::mem::take(&mut geometry.bones);
    for vertex in 0..geometry.positions.len() {
        let mut blend = Mat4::ZERO;
        let mut sum = 0.0;
        for (joint, weight) in
            bones.iter().flat_map(|set| set.joints[vertex].into_iter().zip(set.weights[vertex]))
        {
            if weight == 0.0 {
                continue;
            }
            let matrix = joints.get(joint as usize).ok_or_else(|| {
                let have = joints.len();
                format!("{place}: vertex {vertex} hangs on joint {joint}, but its skin has {have}; export it again")
            })?;
            blend += *matrix * weight;
            sum += weight;
        }
        // Rounded weights miss 1 by a little, and that must not move a vertex; without any, the first joint carries it.
        let blend = if sum.is_finite() && sum > 0.0 { blend * sum.recip() } else { joints[0] };
        geometry.positions[vertex] = blend.transform_point3(geometry.positions[vertex]);
        if let Some(normals) = &mut geometry.normals {
            normals[vertex] = normal_matrix(&blend) * normals[vertex];
        }
        if let Some(tangents) = &mut geometry.tangents {
            let tangent: Vec4 = tangents[vertex];
            tangents[vertex] = blend.transform_vector3(tangent.truncate()).extend(tangent.w);
        }
    }
    Ok(())
}

/// Turns normals as planes turn. The matrix of cofactors is the inverse transpose up to a factor, and exists always.
fn normal_matrix(matrix: &Mat4) -> Mat3 {
    let (x, y, z): (Vec3, Vec3, Vec3) =
        (matrix.x_axis.truncate(), matrix.y_axis.truncate(), matrix.z_axis.truncate());
    Mat3::from_cols(y.cross(z), z.cross(x), x.cross(y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gltf::geometry::Bones;

    fn one(joints: [u32; 4], weights: [f32; 4]) -> Geometry {
        Geometry {
            positions: vec![Vec3::X],
            normals: Some(vec![Vec3::X]),
            bones: vec![Bones { joints: vec![joints], weights: vec![weights] }],
            ..Default::default()
        }
    }

    #[test]
    fn weights_blend_and_need_not_sum_to_one() {
        let joints = [Mat4::from_translation(Vec3::Y), Mat4::from_translation(Vec3::NEG_Y * 3.0)];
        let mut geometry = one([0, 1, 0, 0], [0.25, 0.25, 0.0, 0.0]);
        apply(&joints, &mut geometry, "").unwrap();
        assert_eq!(geometry.positions[0], Vec3::new(1.0, -1.0, 0.0));
        let mut free = one([0; 4], [0.0; 4]);
        apply(&joints, &mut free, "").unwrap();
        assert_eq!(free.positions[0], Vec3::new(1.0, 1.0, 0.0));
    }

    #[test]
    fn normals_turn_as_planes_do() {
        let flat =
            Mat4::from_scale(Vec3::new(4.0, 1.0, 1.0)) * Mat4::from_rotation_z(std::f32::consts::FRAC_PI_4);
        let mut geometry = one([0; 4], [1.0, 0.0, 0.0, 0.0]);
        apply(&[flat], &mut geometry, "").unwrap();
        let normal = geometry.normals.unwrap()[0].normalize();
        let along = flat.transform_vector3(Vec3::Y);
        assert!(normal.dot(along).abs() < 1e-5, "{normal} is not upright on {along}");
    }

    #[test]
    fn a_joint_that_is_not_there_is_named() {
        let message =
            apply(&[Mat4::IDENTITY], &mut one([7, 0, 0, 0], [1.0, 0.0, 0.0, 0.0]), "mesh 0").unwrap_err();
        assert!(message.contains("joint 7"), "{message}");
    }
}
