//! Small scenes that are only for tests.

use glam::{Affine2, Mat4, Vec2, Vec3, Vec4};
use umbrage_render::umbrage::core::{Aabb, Camera, Light, LightKind};
use umbrage_scene::{
    AlphaMode, Image, Instance, Material, Mesh, Scene, SceneCamera, SceneLight, TextureRef, Wrap,
};

/// A built-in scene.
pub fn builtin(name: &str) -> Scene {
    umbrage_scene::load(&format!("builtin:{name}")).expect("a built-in scene")
}

/// The same with another light.
pub fn with_light(mut scene: Scene, light: Light) -> Scene {
    scene.lights = vec![SceneLight { name: String::new(), light, cookie: None }];
    scene
}

/// The scene's first light, turned into parallel light from the same side.
pub fn sun_of(scene: &Scene) -> Light {
    Light { kind: LightKind::Directional, intensity: 3.0, near_m: None, far_m: None, ..scene.lights[0].light }
}

/// A rectangle: middle, half of its width, half of its height; its front is where `right x up` points.
pub fn sheet(center: Vec3, right: Vec3, up: Vec3, material: usize) -> Mesh {
    let positions = vec![center - right - up, center + right - up, center + right + up, center - right + up];
    Mesh {
        name: "sheet".into(),
        normals: vec![right.cross(up).normalize(); 4],
        uvs: vec![Vec2::new(0.0, 1.0), Vec2::ONE, Vec2::new(1.0, 0.0), Vec2::ZERO],
        indices: vec![0, 1, 2, 0, 2, 3],
        material,
        bounds: Aabb::from_points(positions.iter().copied()),
        positions,
        ..Mesh::default()
    }
}

/// A closed box around the origin, with normals along its faces.
pub fn cuboid(half: Vec3) -> Mesh {
    let mut mesh = Mesh { name: "box".into(), bounds: Aabb { min: -half, max: half }, ..Mesh::default() };
    for axis in 0..3 {
        for sign in [1.0f32, -1.0] {
            let pick = |i: usize| if i == axis { sign } else { 0.0 };
            let normal = Vec3::new(pick(0), pick(1), pick(2));
            let (a, b) = normal.any_orthonormal_pair();
            let first = mesh.positions.len() as u32;
            for (u, v) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                mesh.positions.push((normal + a * u + b * v) * half);
                mesh.normals.push(normal);
            }
            mesh.indices.extend([0, 1, 2, 0, 2, 3].map(|i| first + i));
        }
    }
    mesh
}

/// Puts meshes where they are, over a floor of 8 x 8 m, under a spot light, with a camera above.
pub fn over_floor(
    materials: Vec<Material>,
    images: Vec<Image>,
    meshes: Vec<Mesh>,
    placed: &[(usize, Mat4)],
) -> Scene {
    let mut scene = Scene { materials, images, meshes, ..Scene::default() };
    let floor = scene.materials.len();
    scene.materials.push(Material::default());
    scene.meshes.push(sheet(Vec3::ZERO, Vec3::X * 4.0, Vec3::NEG_Z * 4.0, floor));
    let place = |mesh, world_from_object| Instance {
        mesh,
        world_from_object,
        object: mesh as u32,
        ..Instance::default()
    };
    scene.instances = placed.iter().map(|(mesh, at)| place(*mesh, *at)).collect();
    scene.instances.push(place(scene.meshes.len() - 1, Mat4::IDENTITY));
    let camera = Camera::look_at(Vec3::new(0.0, 6.0, 6.0), Vec3::ZERO, 0.8, 0.1, 50.0);
    scene.cameras.push(SceneCamera { name: String::new(), camera });
    with_light(scene, Light::spot(Vec3::new(-2.0, 7.0, 2.0), Vec3::ZERO, 0.5, 0.6))
}

/// A picture of squares: every second one is missing.
pub fn checker(side: u32, alpha_of_missing: u8) -> Image {
    let pixel = move |i: u32| {
        let there = (i % side / (side / 4) + i / side / (side / 4)).is_multiple_of(2);
        [255, 255, 255, if there { 255 } else { alpha_of_missing }]
    };
    Image {
        name: "checker".into(),
        width: side,
        height: side,
        rgba: (0..side * side).flat_map(pixel).collect(),
    }
}

/// A sheet with square holes that floats over the floor.
pub fn cut_out(alpha: AlphaMode) -> Scene {
    let texture = TextureRef {
        image: 0,
        wrap: [Wrap::Repeat; 2],
        linear: false,
        uv_set: 0,
        uv_from_texcoord: Affine2::IDENTITY,
    };
    let material = Material {
        alpha,
        double_sided: true,
        base_color: Vec4::new(0.8, 0.5, 0.2, 1.0),
        base_color_texture: Some(texture),
        ..Material::default()
    };
    let sheet = sheet(Vec3::new(0.0, 1.0, 0.0), Vec3::X, Vec3::NEG_Z, 0);
    over_floor(vec![material], vec![checker(64, 0)], vec![sheet], &[(0, Mat4::IDENTITY)])
}

/// Panes of coloured glass over the floor: a red and a green one that overlap in the light, the green one with a picture of squares;
/// a violet one above a part of an opaque sheet, a blue one wholly in the sheet's shadow, and a yellow one half in it.
pub fn panes() -> Scene {
    let glass = |color: [f32; 4]| Material {
        alpha: AlphaMode::Blend,
        double_sided: true,
        base_color: Vec4::from(color),
        ..Material::default()
    };
    let squares = TextureRef {
        image: 0,
        wrap: [Wrap::Repeat; 2],
        linear: false,
        uv_set: 0,
        uv_from_texcoord: Affine2::IDENTITY,
    };
    let materials = vec![
        glass([1.0, 0.1, 0.1, 0.6]),
        Material { base_color_texture: Some(squares), ..glass([0.1, 1.0, 0.2, 0.5]) },
        glass([0.1, 0.2, 1.0, 0.5]),
        glass([1.0, 0.9, 0.1, 0.4]),
        glass([0.8, 0.2, 1.0, 0.5]),
        Material::default(),
    ];
    let flat =
        |center: Vec3, half: f32, material| sheet(center, Vec3::X * half, Vec3::NEG_Z * half, material);
    let meshes = vec![
        flat(Vec3::new(-1.3, 1.0, 0.6), 0.8, 0),
        flat(Vec3::new(-0.9, 1.5, 0.2), 0.8, 1),
        flat(Vec3::new(1.3, 0.4, -0.6), 0.35, 2),
        flat(Vec3::new(1.6, 0.8, 0.6), 0.6, 3),
        flat(Vec3::new(0.5, 2.0, -0.3), 0.4, 4),
        flat(Vec3::new(0.9, 1.5, -0.2), 0.8, 5),
    ];
    let placed: Vec<_> = (0..meshes.len()).map(|mesh| (mesh, Mat4::IDENTITY)).collect();
    over_floor(materials, vec![checker(64, 40)], meshes, &placed)
}
