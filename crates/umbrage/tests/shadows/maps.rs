//! Maps of a [`Shadows`], looked up inline, against rays.

use crate::common::*;
use glam::Vec3;
use umbrage::core::technique::{Family, Settings, TECHNIQUES};
use umbrage::core::{Aabb, Light};
use umbrage::{CasterMesh, Shadows, ShadowsOptions};

/// Every technique with maps, under every kind of light, is right wherever rays are sure; and none is right without casters.
#[test]
fn every_map_agrees_with_rays_under_every_light() {
    let Some(gpu) = gpu() else { return };
    let boxes = boxes(12, 1);
    let points = points(60);
    let maps: Vec<_> = TECHNIQUES.iter().filter(|row| row.method.family() == Family::Map).collect();
    assert!(maps.len() > 8);
    for row in maps {
        // What shares a shader is tested below; here each has its own.
        let options = ShadowsOptions::with([row.id]).and_then(|o| o.map_size(512)).expect("options");
        let mut shadows = Shadows::new(&gpu.device, &gpu.queue, options).expect("shadows");
        let probe = Probe::new(&gpu, &shadows);
        let mesh = add_cube(&gpu, &mut shadows);
        shadows.add_receiver(ground()).expect("ground");
        let lights = [sun(), spot(), lamp()];
        let handles = lights.map(|light| shadows.add_light(light).expect("a light"));
        let empty = probe.shoot(&gpu, &mut shadows, 0, &points);
        for (at, half) in &boxes {
            shadows.add_caster(mesh, placed(*at, *half)).expect("a caster");
        }
        for (light, handle) in lights.iter().zip(handles) {
            let number = shadows.light_index(handle).expect("a number");
            let seen = probe.shoot(&gpu, &mut shadows, number, &points);
            let (sure, wrong) = judge(&seen, &points, light, &boxes, 0.12);
            assert!(sure > 2000, "{}: {sure}", row.id);
            // `perspective` leaks where casters stand on the ground, and says so.
            let most =
                if row.id == "matrix-bias" || row.id == "perspective" { sure / 20 } else { sure / 200 };
            assert!(wrong <= most, "{} under a {} light: {wrong} of {sure}", row.id, light.kind.id());
        }
        let (sure, wrong) = judge(&empty, &points, &lights[0], &boxes, 0.12);
        assert!(wrong > sure / 20, "without casters {wrong} of {sure} would be right, too");
    }
}

/// Lights of different techniques, map sizes and storages side by side; one is switched while the others stay.
#[test]
fn techniques_share_a_frame_and_are_switched_between_frames() {
    let Some(gpu) = gpu() else { return };
    let boxes = boxes(12, 2);
    let points = points(60);
    let small = Settings::new("pcf", [("map_size", "256")]).expect("settings");
    let options = ShadowsOptions::with(["linear", "packed", "midpoint", "colored", "unshadowed"])
        .and_then(|o| o.map_size(512))
        .expect("options")
        .technique(small.clone());
    let mut shadows = Shadows::new(&gpu.device, &gpu.queue, options).expect("shadows");
    let probe = Probe::new(&gpu, &shadows);
    let mesh = add_cube(&gpu, &mut shadows);
    shadows.add_receiver(ground()).expect("ground");
    for (at, half) in &boxes {
        shadows.add_caster(mesh, placed(*at, *half)).expect("a caster");
    }
    let lights = [sun(), spot(), lamp(), Light { position_world: Vec3::new(2.0, 6.0, 1.0), ..lamp() }];
    let handles = lights.map(|light| shadows.add_light(light).expect("a light"));
    for (handle, name) in handles.iter().zip(["packed", "linear", "midpoint", "colored"]) {
        shadows.set_technique_named(*handle, name).expect(name);
    }
    let right = |shadows: &mut Shadows, which: usize| {
        let number = shadows.light_index(handles[which]).expect("a number");
        let seen = probe.shoot(&gpu, shadows, number, &points);
        let (sure, wrong) = judge(&seen, &points, &lights[which], &boxes, 0.2);
        assert!(sure > 1500 && wrong <= sure / 200, "light {which}: {wrong} of {sure}");
        seen
    };
    let before: Vec<_> = (0..4).map(|which| right(&mut shadows, which)).collect();
    shadows.set_technique(handles[1], &small).expect("declared");
    let after: Vec<_> = (0..4).map(|which| right(&mut shadows, which)).collect();
    for which in [0, 2, 3] {
        assert_eq!(before[which], after[which], "light {which} was not switched");
    }
    assert_ne!(before[1], after[1], "a wide filter is not a narrow one");
    shadows.set_technique_named(handles[1], "unshadowed").expect("declared");
    let number = shadows.light_index(handles[1]).expect("a number");
    assert!(probe.shoot(&gpu, &mut shadows, number, &points).iter().all(|v| v.w == 1.0));
    let refused = shadows.set_technique_named(handles[1], "kernel").expect_err("not declared").to_string();
    assert!(refused.contains("`kernel`") && refused.contains("midpoint"), "{refused}");
}

/// A midpoint is between two surfaces: behind what is open, a receiver has to be drawn; where none is, that is told.
#[test]
fn midpoints_behind_open_casters_are_those_of_receivers_meshes() {
    let Some(gpu) = gpu() else { return };
    let flag = [(Vec3::new(0.0, 2.0, 0.0), Vec3::new(1.5, 0.01, 1.5))];
    let points = points(60);
    for with_mesh in [false, true] {
        let options = ShadowsOptions::with(["midpoint"]).and_then(|o| o.map_size(512)).expect("options");
        let mut shadows = Shadows::new(&gpu.device, &gpu.queue, options).expect("shadows");
        let probe = Probe::new(&gpu, &shadows);
        // One side of a cube, flat: not closed.
        let cube = CubeBuffers::new(&gpu);
        let bounds = Aabb { min: Vec3::NEG_ONE, max: Vec3::ONE };
        let side = CasterMesh::new(&cube.positions, 0..8, bounds);
        let side = shadows
            .add_mesh(&side.indexed(&cube.indices, wgpu::IndexFormat::Uint32, 18..24))
            .expect("a mesh");
        shadows.add_caster(side, placed(flag[0].0, flag[0].1)).expect("a caster");
        if with_mesh {
            let flat = placed(Vec3::ZERO, Vec3::new(5.0, 0.0, 5.0));
            shadows.add_receiver_mesh(side, flat).expect("ground");
        } else {
            shadows.add_receiver(ground()).expect("ground");
        }
        shadows.add_light(sun()).expect("a light");
        let seen = probe.shoot(&gpu, &mut shadows, 0, &points);
        let (sure, wrong) = judge(&seen, &points, &sun(), &flag, 0.12);
        assert_eq!(wrong <= sure / 200, with_mesh, "{wrong} of {sure}");
        let told = shadows.warnings()[0].to_string();
        assert!(told.contains("`midpoint`") && told.contains("receivers with their meshes"), "{told}");
    }
}
