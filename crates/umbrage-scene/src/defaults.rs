//! What a scene needs to be looked at and lacks: a camera, a light, a ground.

use crate::{Instance, Material, Mesh, Reflectance, Scene, SceneCamera, SceneLight};
use glam::{Vec2, Vec3};
use umbrage_core::{Aabb, Camera, Light};

/// Full angle of the camera from bottom to top.
const FOV_Y_RAD: f32 = 40.0 * std::f32::consts::PI / 180.0;
/// Room around the subject in the default picture.
const FRAME_MARGIN: f32 = 1.12;
/// From the subject to the eye: the front right, above. Not yet of unit length.
const TO_EYE: Vec3 = Vec3::new(0.6, 0.45, 1.0);
/// From the subject to the light: the eye's upper left, in front of the subject. Not yet of unit length.
const TO_LIGHT: Vec3 = Vec3::new(-0.75, 1.25, 0.85);
/// Distance of the light in radii of the subject.
const LIGHT_RADII: f32 = 4.0;
/// The light's cone is wider than the subject by this: what the subject throws its shadow on is lit too.
const CONE_MARGIN: f32 = 2.0;
/// Share of the cone's angle that has the full light.
const CONE_INNER: f32 = 0.6;
/// How far the ground lies below the lowest point, in radii: what lies flat must not fight with it for pixels.
const GROUND_GAP: f32 = 5e-4;
/// Half the ground's edge in radii of the footprint.
const GROUND_RADII: f32 = 3.2;

/// The sphere around a scene; a scene without extent has one of a metre.
fn sphere_around(bounds: &Aabb) -> (Vec3, f32) {
    let center = bounds.center();
    // Halves before squares: the far ends of the number range must not overflow.
    let half = 0.5 * bounds.size();
    let largest = half.max_element();
    let radius = if largest > 0.0 && largest.is_finite() { largest * (half / largest).length() } else { 1.0 };
    // Far from the origin the numbers are too coarse for a tiny subject: stay where steps can be told apart.
    (center, radius.max(1e-5 * center.abs().max_element()))
}

/// How far the default eye stands from the middle so that its picture of 16:9 just holds the box, with a margin; and
/// how far from the eye the box begins.
fn framing_distance(bounds: &Aabb, radius: f32) -> (f32, f32) {
    let back = TO_EYE.normalize();
    let right = Vec3::Y.cross(back).normalize();
    let up = back.cross(right);
    let tan = (0.5 * FOV_Y_RAD).tan() / FRAME_MARGIN;
    let corners = bounds.corners().map(|p| p - bounds.center());
    let corners = if bounds.is_empty() { [Vec3::ZERO; 8] } else { corners };
    let towards = corners.iter().map(|p| p.dot(back)).fold(0.0, f32::max);
    let holds = |p: &Vec3| p.dot(back) + (p.dot(up).abs() / tan).max(p.dot(right).abs() / (tan * 16.0 / 9.0));
    let distance = corners.iter().map(holds).fold(towards + 0.5 * radius, f32::max);
    (distance, distance - towards)
}

/// Gives a scene without camera a camera, and one without light a light.
///
/// The camera stands in front, to the right and above, at 40 degrees, and its picture of 16:9 holds the whole box around
/// the scene. The light is a white spot light from its upper left; its cone is twice as wide as
/// the sphere, full up to 60 % of the angle, and gives pi lux at the sphere's middle, so that white paper there has a
/// radiance of 1.
/// Returns one clause for each that was added.
pub fn add_defaults(scene: &mut Scene) -> Vec<String> {
    let bounds = scene.bounds();
    let (center, radius) = sphere_around(&bounds);
    let mut notes = Vec::new();
    if scene.cameras.is_empty() {
        let (distance, closest) = framing_distance(&bounds, radius);
        let eye = center + TO_EYE.normalize() * distance;
        // Both planes leave room for a ground around the subject, which comes closer to the eye and goes farther.
        let (near, far) = ((0.05 * distance).min(0.5 * closest), distance + 2.0 * GROUND_RADII * radius);
        let camera = Camera::look_at(eye, center, FOV_Y_RAD, near, far);
        scene.cameras.push(SceneCamera { name: "default camera".into(), camera });
        notes.push(format!(
            "no camera in the scene: one was placed {distance:.3} m from its middle (40 degrees, {near:.3} to {far:.3} m)"
        ));
    }
    if scene.lights.is_empty() {
        let distance = LIGHT_RADII * radius;
        let outer = (CONE_MARGIN / LIGHT_RADII).asin();
        let place = center + TO_LIGHT.normalize() * distance;
        let intensity = std::f32::consts::PI * distance * distance;
        let light = Light { intensity, ..Light::spot(place, center, CONE_INNER * outer, outer) };
        scene.lights.push(SceneLight { name: "default light".into(), light, cookie: None });
        let degrees = outer.to_degrees();
        notes.push(format!(
            "no light in the scene: a spot light of {intensity:.3} cd was placed {distance:.3} m from its middle ({degrees:.1} degrees)"
        ));
    }
    notes
}

/// Lays a matte ground just under the scene's lowest point, 3.2 times as large as its footprint, so that a lone object has
/// something to throw its shadow on. Call it after [`add_defaults`], which frames all that it finds.
pub fn add_ground(scene: &mut Scene) {
    let bounds = scene.bounds();
    let (center, radius) = sphere_around(&bounds);
    let footprint = (0.5 * Vec2::new(bounds.size().x, bounds.size().z)).length();
    let half =
        GROUND_RADII * if footprint > 0.1 * radius && footprint.is_finite() { footprint } else { radius };
    let y = if bounds.is_empty() { 0.0 } else { bounds.min.y - GROUND_GAP * radius };
    let corner = |x: f32, z: f32| Vec3::new(center.x + x * half, y, center.z + z * half);
    let positions = vec![corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0), corner(-1.0, -1.0)];
    let material = scene.materials.len();
    scene.materials.push(Material {
        name: "ground".into(),
        base_color: Vec3::splat(0.6).extend(1.0),
        reflectance: Reflectance::MetallicRoughness { metallic: 0.0, roughness: 1.0 },
        // An object may be looked at from below.
        double_sided: true,
        ..Material::default()
    });
    let mesh = scene.meshes.len();
    scene.meshes.push(Mesh {
        name: "ground".into(),
        bounds: Aabb::from_points(positions.iter().copied()),
        positions,
        normals: vec![Vec3::Y; 4],
        uvs: vec![Vec2::new(0.0, 1.0), Vec2::ONE, Vec2::new(1.0, 0.0), Vec2::ZERO],
        indices: vec![0, 1, 2, 0, 2, 3],
        material,
        ..Mesh::default()
    });
    let object = scene.objects();
    scene.instances.push(Instance { name: "ground".into(), mesh, object, ..Instance::default() });
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One upright triangle, `size` high, away from the origin.
    fn lone(size: f32) -> Scene {
        let positions: Vec<Vec3> =
            [Vec3::ZERO, Vec3::X, Vec3::Y].map(|p| (p + Vec3::new(2.0, -3.0, 1.0)) * size).into();
        let mesh = Mesh {
            bounds: Aabb::from_points(positions.iter().copied()),
            positions,
            normals: vec![Vec3::Z; 3],
            indices: vec![0, 1, 2],
            ..Mesh::default()
        };
        Scene {
            meshes: vec![mesh],
            materials: vec![Material::default()],
            instances: vec![Instance::default()],
            ..Scene::default()
        }
    }

    #[test]
    fn the_subject_is_framed_and_lit_at_every_size() {
        for size in [1e-3, 0.1, 1.0, 300.0, 1e5] {
            let mut scene = lone(size);
            let notes = add_defaults(&mut scene);
            assert_eq!(notes.len(), 2);
            add_ground(&mut scene);
            let camera = scene.cameras[0].camera;
            camera.check().unwrap();
            let light = scene.lights[0].light;
            light.check().unwrap();
            let view = camera.view_from_world();
            for p in &scene.meshes[0].positions {
                let p_view = view.transform_point3(*p);
                let tan = (0.5 * FOV_Y_RAD).tan();
                assert!(
                    p_view.y.abs() < tan * -p_view.z && p_view.x.abs() < tan * 16.0 / 9.0 * -p_view.z,
                    "{size}"
                );
                let umbrage_core::LightKind::Spot { inner_rad, .. } = light.kind else { panic!() };
                let angle = (*p - light.position_world).angle_between(light.direction_world);
                assert!(angle < inner_rad / CONE_INNER, "{size}: {angle}");
            }
            let corner = scene.meshes[1].bounds.corners().map(|p| -view.transform_point3(p).z);
            assert!(corner.iter().all(|z| *z < camera.far_m), "{size}: the ground's far corner is cut");
            let lux =
                light.illuminance_lux(light.position_world.distance(sphere_around(&lone(size).bounds()).0));
            assert!((lux / std::f32::consts::PI - 1.0).abs() < 1e-3, "{size}: {lux}");
            let gap = (scene.meshes[0].bounds.min.y - scene.meshes[1].bounds.max.y) / size;
            assert!(gap > 1e-5 && gap < 1e-2, "{size}: {gap}");
        }
    }

    #[test]
    fn what_is_there_stays() {
        let mut scene = lone(1.0);
        add_defaults(&mut scene);
        assert_eq!(add_defaults(&mut scene), Vec::<String>::new());
        assert_eq!((scene.cameras.len(), scene.lights.len()), (1, 1));
    }

    #[test]
    fn empty_and_enormous_scenes_get_finite_numbers() {
        let mut point = lone(1.0);
        point.meshes[0].bounds = Aabb::from_points([Vec3::ONE]);
        for mut scene in [Scene::default(), point, lone(1e14)] {
            add_defaults(&mut scene);
            add_ground(&mut scene);
            assert_eq!(scene.cameras[0].camera.check(), Ok(()));
            assert_eq!(scene.lights[0].light.check(), Ok(()));
        }
    }
}
