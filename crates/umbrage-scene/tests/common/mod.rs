//! What several tests need: where the shared scenes lie, and measures that share no code with the loader.

#![allow(dead_code, clippy::unwrap_used)]

pub mod glb;
pub mod volume;

use glam::Vec3;
use std::path::PathBuf;
use umbrage_scene::{Mesh, Scene};

/// A file of the shared scenes, or `None`, said aloud, where they are not laid out.
pub fn shared(file: &str) -> Option<PathBuf> {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/scenes");
    if root.is_dir() {
        return Some(root.join(file));
    }
    eprintln!("SKIPPED: {file}: there is no {}", root.display());
    None
}

/// Loads a shared scene; it must load.
pub fn load_shared(file: &str) -> Option<Scene> {
    let path = shared(file)?;
    Some(umbrage_scene::load(&path.to_string_lossy()).unwrap_or_else(|e| panic!("{e}")))
}

/// Edge lengths of the tight box around every vertex that is drawn.
pub fn extents(scene: &Scene) -> [f64; 3] {
    let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for instance in &scene.instances {
        let mesh = &scene.meshes[instance.mesh];
        for index in &mesh.indices {
            let p = instance.world_from_object * mesh.positions[*index as usize].extend(1.0);
            low = low.min(p.truncate());
            high = high.max(p.truncate());
        }
    }
    (high - low).to_array().map(f64::from)
}

/// What every loaded scene promises.
pub fn assert_sound(scene: &Scene) {
    assert!(!scene.materials.is_empty() && !scene.instances.is_empty());
    for warning in &scene.warnings {
        assert!(!warning.contains('\n') && !warning.is_empty(), "{warning:?}");
    }
    for instance in &scene.instances {
        assert!(instance.mesh < scene.meshes.len() && instance.world_from_object.is_finite());
    }
    for mesh in &scene.meshes {
        assert_mesh(mesh, scene.materials.len());
    }
    for material in &scene.materials {
        let textures = [
            material.base_color_texture,
            material.metallic_roughness_texture,
            material.normal_texture,
            material.emissive_texture,
        ];
        for texture in textures.into_iter().flatten() {
            assert!(texture.image < scene.images.len() && texture.uv_set < 2);
        }
    }
    for image in &scene.images {
        assert_eq!(image.rgba.len(), image.width as usize * image.height as usize * 4, "{}", image.name);
    }
}

fn assert_mesh(mesh: &Mesh, materials: usize) {
    let count = mesh.positions.len();
    assert!(mesh.material < materials && !mesh.indices.is_empty() && mesh.indices.len().is_multiple_of(3));
    assert!(mesh.indices.iter().all(|i| (*i as usize) < count));
    assert_eq!(mesh.normals.len(), count);
    for length in [mesh.tangents.len(), mesh.uvs.len(), mesh.uvs1.len(), mesh.colors.len()] {
        assert!(length == 0 || length == count, "{length} of {count}");
    }
    assert!(
        mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-3),
        "{}: normals are unit vectors",
        mesh.name
    );
    let unit = |t: &glam::Vec4| (t.truncate().length() - 1.0).abs() < 1e-3 && t.w.abs() == 1.0;
    assert!(mesh.tangents.iter().all(unit), "{}: tangents are unit vectors", mesh.name);
}
