//! Cameras in world space.

use super::document::{Document, label};
use super::nodes::Tree;
use crate::SceneCamera;
use glam::{Mat4, Vec3};
use gltf::json::camera::{Camera as JsonCamera, Type};
use gltf::json::validation::Checked;
use umbrage_core::{Aabb, Camera, Projection};

/// The cameras of the drawn nodes. One that makes no sense is left out with a warning.
pub(super) fn read(
    document: &Document<'_>,
    tree: &Tree,
    bounds: &Aabb,
    warnings: &mut Vec<String>,
) -> Vec<SceneCamera> {
    let mut cameras = Vec::new();
    for &node in &tree.drawn {
        let json = &document.root.nodes[node];
        let Some(index) = json.camera.map(|camera| camera.value()) else { continue };
        let camera = &document.root.cameras[index];
        let name = camera.name.as_ref().or(json.name.as_ref());
        let placed =
            place(camera, &tree.world[node], bounds).and_then(|camera| camera.check().map(|()| camera));
        match placed {
            Ok(camera) => cameras.push(SceneCamera { name: name.cloned().unwrap_or_default(), camera }),
            Err(e) => warnings.push(format!("{}: {e}; it is left out", label("camera", index, name))),
        }
    }
    cameras
}

fn place(json: &JsonCamera, world_from_camera: &Mat4, bounds: &Aabb) -> Result<Camera, String> {
    let axis = |axis: Vec3| world_from_camera.transform_vector3(axis).try_normalize();
    let nothing = "its node is scaled to nothing";
    let position_world = world_from_camera.w_axis.truncate();
    let (projection, near_m, far_m) = match (json.type_, &json.perspective, &json.orthographic) {
        (Checked::Valid(Type::Perspective), Some(lens), _) => {
            let projection = Projection::Perspective { fov_y_rad: lens.yfov };
            (projection, lens.znear, lens.zfar.unwrap_or_else(|| far_of(position_world, lens.znear, bounds)))
        }
        // The specification forbids 0 and warns of negative magnitudes, which mirror.
        (Checked::Valid(Type::Orthographic), _, Some(box_)) => {
            // A near plane at the eye is allowed there, and Umbrage wants one before it.
            let near_m = if box_.znear == 0.0 { box_.zfar * 1e-5 } else { box_.znear };
            (Projection::Orthographic { half_height_m: box_.ymag.abs() }, near_m, box_.zfar)
        }
        _ => return Err("it has no perspective and no orthographic part that suits its type".into()),
    };
    Ok(Camera {
        position_world,
        direction_world: axis(Vec3::NEG_Z).ok_or(nothing)?,
        up_world: axis(Vec3::Y).ok_or(nothing)?,
        projection,
        near_m,
        far_m,
    })
}

/// A camera without a far plane sees to the end of the scene.
fn far_of(position_world: Vec3, near_m: f32, bounds: &Aabb) -> f32 {
    let reach =
        bounds.corners().into_iter().map(|corner| corner.distance(position_world)).fold(0.0, f32::max);
    let reach = if reach.is_finite() { 1.01 * reach } else { 0.0 };
    reach.max(near_m * 1000.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_a_far_plane_the_scene_ends_the_view() {
        let bounds = Aabb { min: Vec3::splat(-10.0), max: Vec3::splat(10.0) };
        let far = far_of(Vec3::new(0.0, 0.0, 20.0), 0.01, &bounds);
        assert!(far > (100.0_f32 + 100.0 + 900.0).sqrt() && far < 35.0, "{far}");
        assert_eq!(far_of(Vec3::ZERO, 0.5, &Aabb::EMPTY), 500.0);
    }
}
