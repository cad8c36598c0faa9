//! Row H7 on the GPU: the texel that the lookup maths names is the one that the rasteriser writes.

mod common;

use common::scenes::{sheet, with_light};
use common::{gpu, settings, shoot};
use glam::{UVec2, Vec3};
use umbrage_render::View;
use umbrage_render::umbrage::core::fit::{FitOptions, ShadowView, fit};
use umbrage_render::umbrage::core::lookup::{locate, texel_at, texel_center};
use umbrage_render::umbrage::core::{Aabb, Camera, Light, LightKind};
use umbrage_scene::{Instance, Material, Scene, SceneCamera};

const SIDE: u32 = 64;

/// A square that faces the light, eight tenths of a texel wide, in the middle of a texel at 5 m.
fn speck(light: &Light, view: &ShadowView, texel: UVec2) -> (Scene, Vec3) {
    let uv = texel_center(texel, UVec2::splat(SIDE));
    let ndc = Vec3::new(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y, 0.5);
    let clip_from_world = view.clip_from_world();
    let on_ray = clip_from_world.inverse().project_point3(ndc);
    // Anywhere on the ray through the texel's centre; parallel light has parallel rays.
    let axes = light.world_from_light_rotation();
    let p_light = view.light_from_world.transform_point3(on_ray);
    let p_light = if view.perspective { p_light * (5.0 / -p_light.z) } else { p_light };
    let p_world = view.light_from_world.inverse().transform_point3(p_light);
    let half = 0.4 * view.texel_size_m(5.0);
    let mesh = sheet(p_world, axes.x_axis * half, axes.y_axis * half, 0);
    let mut scene = Scene { materials: vec![Material::default()], meshes: vec![mesh], ..Scene::default() };
    let world_from_object = glam::Mat4::IDENTITY;
    scene.instances = vec![Instance { world_from_object, ..Instance::default() }];
    let camera = Camera::look_at(Vec3::new(0.0, 1.0, 9.0), Vec3::ZERO, 0.8, 0.1, 50.0);
    scene.cameras = vec![SceneCamera { name: String::new(), camera }];
    (with_light(scene, *light), p_world)
}

#[test]
fn the_texel_that_is_written_is_the_one_that_is_looked_up() {
    let Some(gpu) = gpu() else { return };
    let light = Light {
        near_m: Some(1.0),
        far_m: Some(9.0),
        ..Light::spot(Vec3::new(1.0, 6.0, 2.0), Vec3::ZERO, 0.5, 0.6)
    };
    assert!(matches!(light.kind, LightKind::Spot { .. }));
    let options = FitOptions { size_texel: SIDE, ..FitOptions::default() };
    let around = Aabb { min: Vec3::splat(-3.0), max: Vec3::splat(3.0) };
    let view = fit(&light, &[around], &options).expect("a view");
    let mut seen = 0;
    for texel in [(0, 0), (63, 0), (0, 63), (63, 63), (31, 32), (7, 50), (40, 13)].map(UVec2::from) {
        let (scene, p_world) = speck(&light, &view, texel);
        let at = locate(&view.texture_from_world(), p_world);
        assert!(at.inside);
        assert_eq!(texel_at(at.uv, UVec2::splat(SIDE)), texel);
        // The picture of the map is as large as the map: a pixel a texel, rows down.
        let shot = shoot(&gpu, &scene, settings("linear", &[("map_size", "64")]), View::Depth, SIDE);
        let written: Vec<UVec2> = (0..SIDE * SIDE)
            .filter(|i| shot.rgba[4 * *i as usize] < 255)
            .map(|i| UVec2::new(i % SIDE, i / SIDE))
            .collect();
        assert_eq!(written, [texel], "looked up {at:?}");
        seen += 1;
    }
    assert_eq!(seen, 7);
}
