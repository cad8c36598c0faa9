//! Telling volumes what is as it was allocates nothing. A program of its own, because it counts what its threads allocate.

mod common;

use allocation_counter::measure;
use common::gpu;
use common::volumes::{ALL, cuboid, kinds};
use glam::{Mat4, UVec2, Vec3};
use umbrage_render::umbrage::core::technique::Settings;
use umbrage_render::umbrage::core::{Aabb, Camera, DEPTH, Light};
use umbrage_render::umbrage::volume::{
    ScreenVolumes, VolumeEye, VolumeItem, VolumeSettings, choose_count_format,
};

fn settings(pairs: &[(&str, &str)]) -> VolumeSettings {
    let settings = Settings::new("volume", pairs.iter().copied()).expect("settings");
    VolumeSettings::of(&settings).expect("a volume")
}

fn eye(x: f32) -> VolumeEye {
    let camera = Camera::look_at(Vec3::new(x, 3.0, 6.0), Vec3::ZERO, 0.8, 0.1, f32::INFINITY);
    let clip_from_view = camera.clip_from_view(1.0, DEPTH);
    VolumeEye {
        clip_from_world: clip_from_view * camera.view_from_world(),
        clip_from_view,
        size_px: UVec2::splat(64),
        is_parallel: false,
    }
}

#[test]
fn what_is_as_it_was_allocates_nothing() {
    let Some(gpu) = gpu() else { return };
    let format = choose_count_format(&gpu.device);
    let v = wgpu::TextureFormat::R8Unorm;
    let mut screen = ScreenVolumes::new(&gpu.device, &gpu.queue, format, DEPTH, v).expect("a stencil");
    let mesh = cuboid(Vec3::splat(0.4), &ALL);
    screen.set_mesh(0, &mesh.positions, &mesh.indices).expect("a mesh");
    let mut at = Vec3::new(0.0, 1.0, 0.0);
    let lights = kinds(Light::spot(Vec3::new(1.0, 5.0, 1.0), Vec3::ZERO, 0.5, 0.7));
    let choices = [
        settings(&[("counting", "depth-fail"), ("soften", "blur")]),
        settings(&[("counting", "depth-fail"), ("silhouette", "vertex")]),
        settings(&[("counting", "depth-fail"), ("stencil", "two-pass")]),
    ];
    let scene_world = Aabb { min: Vec3::splat(-4.0), max: Vec3::splat(4.0) };
    let item = |number: usize, at: Vec3| {
        let world_from_object = Mat4::from_translation(at + Vec3::X * (0.1 * number as f32 - 1.0));
        VolumeItem { mesh: 0, world_from_object, bounds_world: mesh.bounds.transformed(&world_from_object) }
    };
    let tell = |screen: &mut ScreenVolumes, x: f32, at: Vec3| {
        let begun = measure(|| screen.begin(&eye(x))).count_total;
        let told = measure(|| {
            for (slot, (light, choices)) in lights.iter().zip(&choices).enumerate() {
                screen.tell(slot, light, choices, &scene_world, (0..20).map(|number| item(number, at)));
            }
        });
        assert!(screen.problems().is_empty());
        (begun, told.count_total)
    };
    let (_, first) = tell(&mut screen, 0.0, at);
    assert!(first > 0, "the counter counts");
    assert_eq!(tell(&mut screen, 0.0, at), (0, 0), "nothing moved");
    assert_eq!(tell(&mut screen, 0.5, at).1, 0, "the eye moved");
    let bytes = screen.memory_bytes();
    at.y += 0.2;
    let moved = tell(&mut screen, 0.5, at).1;
    println!("{first} allocations at first, {moved} of wgpu's where all casters moved");
    assert_eq!(screen.memory_bytes(), bytes);
    assert_eq!(tell(&mut screen, 0.5, at), (0, 0), "it rests again");
}
