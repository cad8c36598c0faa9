//! The last gate that every loaded scene passes, whatever its format: what goes out of it can be drawn without a look
//! back at any index or number.

use crate::{Image, Instance, Material, Mesh, Scene, SceneError, TextureRef};
use glam::{DVec3, Mat4, Vec2, Vec3};
use std::path::Path;
use umbrage_core::Aabb;

/// Checks a scene, takes out what draws nothing, and computes bounds.
///
/// # Errors
/// [`SceneError::Malformed`] names the first number or index that cannot be drawn with, [`SceneError::NoTriangles`] says
/// that nothing is left.
pub(crate) fn check(mut scene: Scene, path: &Path) -> Result<Scene, SceneError> {
    let malformed = |what: String| SceneError::malformed(path, what);
    if scene.materials.is_empty() {
        scene.materials.push(Material::default());
    }
    scene.images.iter().try_for_each(image).map_err(malformed)?;
    materials(&scene).map_err(malformed)?;
    let mut dropped = 0;
    let mut bad_uvs = 0;
    for (number, mesh) in scene.meshes.iter_mut().enumerate() {
        let place = if mesh.name.is_empty() {
            format!("mesh {number}")
        } else {
            format!("mesh \"{}\"", one_line(&mesh.name))
        };
        lists(mesh, scene.materials.len()).map_err(|e| malformed(format!("{place}: {e}")))?;
        bad_uvs += repair_uvs(mesh);
        dropped += drop_flat(mesh);
        mesh.bounds = Aabb::from_points(mesh.indices.iter().map(|i| mesh.positions[*i as usize]));
    }
    if bad_uvs > 0 {
        scene.warnings.push(format!("{bad_uvs} texture coordinates were not finite and are now 0"));
    }
    if dropped > 0 {
        scene.warnings.push(format!("{dropped} triangles without area are left out"));
    }
    instances(&mut scene).map_err(malformed)?;
    if scene.instances.is_empty() {
        let what = if dropped > 0 {
            "all of its triangles are without area"
        } else {
            "nothing that is shown has a mesh of triangles"
        };
        return Err(SceneError::NoTriangles {
            path: path.to_owned(),
            what: format!("{what}; check the export"),
        });
    }
    lights_and_cameras(&mut scene).map_err(malformed)?;
    Ok(scene)
}

/// Names come from files; a message is one line.
fn one_line(name: &str) -> String {
    name.chars().take(60).map(|c| if c.is_control() { ' ' } else { c }).collect()
}

fn image(image: &Image) -> Result<(), String> {
    let need = u64::from(image.width) * u64::from(image.height) * 4;
    if need > 0 && image.rgba.len() as u64 == need {
        return Ok(());
    }
    let (name, width, height) = (one_line(&image.name), image.width, image.height);
    Err(format!(
        "image \"{name}\": {width} x {height} pixels and {} bytes do not go together",
        image.rgba.len()
    ))
}

fn materials(scene: &Scene) -> Result<(), String> {
    for (number, material) in scene.materials.iter().enumerate() {
        let name = one_line(&material.name);
        let textures = [
            material.base_color_texture,
            material.metallic_roughness_texture,
            material.normal_texture,
            material.emissive_texture,
        ];
        let broken = |texture: &TextureRef| {
            texture.image >= scene.images.len() || texture.uv_set > 1 || !texture.uv_from_texcoord.is_finite()
        };
        if textures.iter().flatten().any(broken) {
            return Err(format!(
                "material {number} \"{name}\": a texture's image, uv set or transform is out of range"
            ));
        }
        let numbers = material.base_color.is_finite() && material.emissive.is_finite();
        if !numbers || !material.normal_scale.is_finite() {
            return Err(format!(
                "material {number} \"{name}\": one of its colours or scales is not finite; correct it"
            ));
        }
    }
    Ok(())
}

fn lists(mesh: &Mesh, materials: usize) -> Result<(), String> {
    let count = mesh.positions.len();
    let lengths = [
        ("tangents", mesh.tangents.len()),
        ("texture coordinates", mesh.uvs.len()),
        ("second texture coordinates", mesh.uvs1.len()),
        ("colours", mesh.colors.len()),
    ];
    for (what, length) in lengths {
        if length != 0 && length != count {
            return Err(format!("{length} {what} for {count} vertices"));
        }
    }
    if mesh.normals.len() != count {
        return Err(format!("{} normals for {count} vertices", mesh.normals.len()));
    }
    if !mesh.indices.len().is_multiple_of(3) {
        return Err(format!("{} indices are no whole triangles", mesh.indices.len()));
    }
    if mesh.material >= materials {
        return Err(format!("material {} of {materials} does not exist", mesh.material));
    }
    if let Some((at, index)) = mesh.indices.iter().enumerate().find(|(_, i)| **i as usize >= count) {
        return Err(format!("index {at} is {index}, but there are {count} vertices"));
    }
    // Vertices that no triangle uses are never drawn, so their numbers do not matter.
    if let Some(vertex) = mesh.indices.iter().find(|i| !mesh.positions[**i as usize].is_finite()) {
        let position = mesh.positions[*vertex as usize];
        return Err(format!("vertex {vertex} is at {position}, which is not finite; export the file again"));
    }
    let normals = mesh.indices.iter().find(|i| !mesh.normals[**i as usize].is_finite());
    let tangents =
        mesh.indices.iter().find(|i| mesh.tangents.get(**i as usize).is_some_and(|t| !t.is_finite()));
    match normals.or(tangents) {
        Some(vertex) => {
            Err(format!("the normal or tangent of vertex {vertex} is not finite; export the file again"))
        }
        None => Ok(()),
    }
}

fn repair_uvs(mesh: &mut Mesh) -> usize {
    let broken = mesh.uvs.iter_mut().chain(&mut mesh.uvs1).filter(|uv| !uv.is_finite());
    broken.map(|uv| *uv = Vec2::ZERO).count()
}

/// Takes out triangles whose corners lie on one line. In 64 bits: a small scene's areas are small too.
fn drop_flat(mesh: &mut Mesh) -> usize {
    let positions = &mesh.positions;
    let flat = |corners: &[u32]| {
        let [a, b, c]: [DVec3; 3] = std::array::from_fn(|i| positions[corners[i] as usize].as_dvec3());
        (b - a).cross(c - a) == DVec3::ZERO
    };
    let before = mesh.indices.len();
    if mesh.indices.chunks_exact(3).any(flat) {
        mesh.indices = mesh.indices.chunks_exact(3).filter(|t| !flat(t)).flatten().copied().collect();
    }
    (before - mesh.indices.len()) / 3
}

/// Checks instances; takes out meshes without triangles and instances that show nothing.
fn instances(scene: &mut Scene) -> Result<(), String> {
    for (number, Instance { name, mesh, world_from_object, .. }) in scene.instances.iter().enumerate() {
        let place = format!("instance {number} \"{}\"", one_line(name));
        let Some(mesh) = scene.meshes.get(*mesh) else {
            return Err(format!("{place}: mesh {mesh} of {} does not exist", scene.meshes.len()));
        };
        let affine = (world_from_object.row(3) - Vec3::ZERO.extend(1.0)).abs().max_element() < 1e-4;
        if !world_from_object.is_finite() || !affine {
            return Err(format!("{place}: its transform is not finite or not affine; correct it"));
        }
        let farthest = mesh.bounds.corners().map(|p| world_from_object.transform_point3(p));
        if !mesh.bounds.is_empty() && !farthest.iter().all(|p| p.is_finite()) {
            return Err(format!("{place}: it reaches farther than 32-bit numbers do; scale it down"));
        }
    }
    let mut places = Vec::with_capacity(scene.meshes.len());
    let mut kept = 0;
    for mesh in &scene.meshes {
        places.push((!mesh.indices.is_empty()).then_some(kept));
        kept += usize::from(!mesh.indices.is_empty());
    }
    scene.meshes.retain(|mesh| !mesh.indices.is_empty());
    scene.instances.retain_mut(|instance| match places[instance.mesh] {
        Some(mesh) => {
            instance.mesh = mesh;
            has_area(&instance.world_from_object)
        }
        None => false,
    });
    // Objects that are left keep their order and close the gaps.
    let mut numbers: Vec<u32> = scene.instances.iter().map(|instance| instance.object).collect();
    numbers.sort_unstable();
    numbers.dedup();
    for instance in &mut scene.instances {
        instance.object = numbers.partition_point(|number| *number < instance.object) as u32;
    }
    Ok(())
}

/// Is anything left of a surface under this transform? Scaled to a line or a point it is the usual way to hide a node.
fn has_area(matrix: &Mat4) -> bool {
    let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(|axis| axis.truncate().as_dvec3());
    [x.cross(y), y.cross(z), z.cross(x)].iter().any(|area| *area != DVec3::ZERO)
}

fn lights_and_cameras(scene: &mut Scene) -> Result<(), String> {
    for (number, light) in scene.lights.iter().enumerate() {
        light.light.check().map_err(|e| format!("light {number} \"{}\": {e}", one_line(&light.name)))?;
        if light.cookie.is_some_and(|image| image >= scene.images.len()) {
            return Err(format!("light {number} \"{}\": its slide does not exist", one_line(&light.name)));
        }
    }
    for (number, camera) in scene.cameras.iter().enumerate() {
        camera.camera.check().map_err(|e| format!("camera {number} \"{}\": {e}", one_line(&camera.name)))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle() -> Scene {
        Scene {
            meshes: vec![Mesh {
                name: "M".into(),
                positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::X * 2.0],
                normals: vec![Vec3::Z; 4],
                indices: vec![0, 1, 2],
                ..Mesh::default()
            }],
            instances: vec![Instance { name: "I".into(), ..Instance::default() }],
            ..Scene::default()
        }
    }

    fn gate(scene: Scene) -> Result<Scene, SceneError> {
        check(scene, Path::new("x.obj"))
    }

    #[test]
    fn a_sound_scene_passes_and_gains_what_it_lacks() {
        let scene = gate(triangle()).unwrap();
        assert_eq!(scene.materials.len(), 1);
        assert_eq!(scene.meshes[0].bounds.max, Vec3::new(1.0, 1.0, 0.0), "the unused vertex does not count");
        assert!(scene.warnings.is_empty());
    }

    #[test]
    fn every_broken_number_is_named() {
        type Break = fn(&mut Scene);
        let cases: [(Break, &str); 9] = [
            (|s| s.meshes[0].positions[1].x = f32::NAN, "mesh \"M\": vertex 1"),
            (|s| s.meshes[0].indices[2] = 9, "index 2 is 9"),
            (|s| s.meshes[0].indices.truncate(2), "whole triangles"),
            (|s| s.meshes[0].material = 5, "material 5"),
            (|s| s.meshes[0].normals.truncate(1), "1 normals"),
            (|s| s.meshes[0].normals[0].x = f32::INFINITY, "normal or tangent of vertex 0"),
            (|s| s.instances[0].mesh = 3, "instance 0 \"I\": mesh 3"),
            (|s| s.instances[0].world_from_object.w_axis.x = f32::NAN, "instance 0 \"I\""),
            (|s| s.instances[0].world_from_object = Mat4::from_scale(Vec3::splat(3e38)) * 2.0, "instance 0"),
        ];
        for (damage, word) in cases {
            let mut scene = triangle();
            damage(&mut scene);
            let message = gate(scene).expect_err(word).to_string();
            assert!(message.contains(word), "{word}: {message}");
            assert!(!message.contains('\n'));
        }
    }

    #[test]
    fn what_shows_nothing_is_taken_out_and_counted() {
        let mut scene = triangle();
        scene.meshes[0].indices.extend([0, 1, 3, 0, 0, 1]);
        let scene = gate(scene).unwrap();
        assert_eq!(scene.triangles(), 1);
        assert!(scene.warnings[0].starts_with("2 triangles"), "{:?}", scene.warnings);

        let mut empty = triangle();
        empty.meshes[0].indices = vec![0, 1, 3];
        assert!(matches!(gate(empty), Err(SceneError::NoTriangles { .. })));
        let mut hidden = triangle();
        hidden.instances[0].world_from_object = Mat4::from_scale(Vec3::ZERO);
        assert!(matches!(gate(hidden), Err(SceneError::NoTriangles { .. })));
    }

    #[test]
    fn empty_meshes_go_and_indices_follow() {
        let mut scene = triangle();
        scene.meshes.insert(0, Mesh::default());
        scene.instances[0].mesh = 1;
        scene.instances[0].object = 7;
        scene.instances.push(Instance { object: 1, ..Instance::default() });
        let scene = gate(scene).unwrap();
        assert_eq!((scene.meshes.len(), scene.instances.len(), scene.instances[0].mesh), (1, 1, 0));
        assert_eq!(scene.instances[0].object, 0, "numbers have no gaps");
    }
}
