//! Masks of a [`Shadows`], looked up inline and taken away on the screen, against rays.

use crate::common::*;
use glam::Vec3;
use umbrage::core::technique::Settings;
use umbrage::core::{Light, LightKind};
use umbrage::{Shadows, ShadowsOptions};

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth24PlusStencil8;

fn inside(p: &Vec3, light: &Light) -> bool {
    let LightKind::Spot { outer_rad, .. } = light.kind else { return true };
    (*p - light.position_world).normalize().dot(light.direction_world) > (outer_rad - 0.02).cos()
}

fn made(gpu: &Gpu, boxes: &[(Vec3, Vec3)]) -> (Shadows, Vec<umbrage::CasterHandle>) {
    let options = ShadowsOptions::with(["mask", "mask-subtractive", "volume", "pcf"])
        .and_then(|o| o.map_size(512))
        .expect("options")
        .depth_stencil(FORMAT);
    let mut shadows = Shadows::new(&gpu.device, &gpu.queue, options).expect("shadows");
    let mesh = add_cube(gpu, &mut shadows);
    shadows.add_receiver_mesh(mesh, placed(Vec3::ZERO, Vec3::new(5.0, 0.0, 5.0))).expect("ground");
    let caster = |(at, half): &(Vec3, Vec3)| shadows.add_caster(mesh, placed(*at, *half)).expect("a caster");
    let casters = boxes.iter().map(caster).collect();
    (shadows, casters)
}

/// Every family behind its own light in one frame, and each light through every family.
#[test]
fn families_share_a_frame_and_each_light_goes_through_all() {
    let Some(gpu) = gpu() else { return };
    let boxes = boxes(10, 8);
    let points = seen_points(&points(80), &boxes);
    let (mut shadows, _) = made(&gpu, &boxes);
    let probe = Probe::new(&gpu, &shadows);
    let depth = Depth::new(&gpu, FORMAT, &boxes);
    let lights = [sun(), spot(), Light { position_world: Vec3::new(0.3, 6.5, -0.2), ..lamp() }, sun()];
    let handles = lights.map(|light| shadows.add_light(light).expect("a light"));
    let families = ["mask", "mask-subtractive", "volume", "pcf"];
    for turn in 0..4 {
        for (i, handle) in handles.iter().enumerate() {
            shadows.set_technique_named(*handle, families[(i + turn) % 4]).expect("declared");
        }
        for (i, (light, handle)) in lights.iter().zip(handles).enumerate() {
            let number = shadows.light_index(handle).expect("a number");
            let seen = probe.shoot_over(&gpu, &mut shadows, &depth, number, &points);
            let (seen, judged): (Vec<_>, Vec<_>) =
                seen.iter().zip(&points).filter(|(_, p)| inside(p, light)).map(|(v, p)| (*v, *p)).unzip();
            let (sure, wrong) = judge(&seen, &judged, light, &boxes, 0.2);
            let family = families[(i + turn) % 4];
            assert!(sure > 700 && wrong <= sure / 100, "{family}, light {i}: {wrong} of {sure}");
        }
    }
    assert_eq!(shadows.warnings(), []);
}

/// A light inside of a caster's box cannot mask it: a map draws that caster, and masks the others.
#[test]
fn what_a_light_cannot_mask_is_left_to_its_map() {
    let Some(gpu) = gpu() else { return };
    let mut boxes = boxes(8, 9);
    let light = Light { position_world: Vec3::new(0.0, 4.0, 0.0), ..lamp() };
    // Beside the light at its height: no plane across its way holds all of its outline.
    boxes.push((Vec3::new(0.5, 4.0, 0.0), Vec3::new(0.2, 2.5, 2.5)));
    let points = seen_points(&points(80), &boxes);
    let (mut shadows, casters) = made(&gpu, &boxes);
    let probe = Probe::new(&gpu, &shadows);
    let depth = Depth::new(&gpu, FORMAT, &boxes);
    let handle = shadows.add_light(light).expect("a light");
    let number = shadows.light_index(handle).expect("a number");
    let seen = probe.shoot_over(&gpu, &mut shadows, &depth, number, &points);
    assert_eq!(shadows.prepare(&frame()).expect("prepared").views, 6, "the six tiles of a lamp's map");
    let (sure, wrong) = judge(&seen, &points, &light, &boxes, 0.2);
    assert!(sure > 1000 && wrong <= sure / 50, "{wrong} of {sure}");
    // When it is gone, so is the map.
    shadows.remove_caster(casters[8]).expect("removed");
    assert_eq!(shadows.prepare(&frame()).expect("prepared").views, 0);
}

/// The visibility buffer says what inline lookup says, of every family; and nothing of what is not lit.
#[test]
fn the_visibility_buffer_says_the_same() {
    let Some(gpu) = gpu() else { return };
    let boxes = boxes(10, 8);
    let points = seen_points(&points(80), &boxes);
    let (mut shadows, _) = made(&gpu, &boxes);
    let probe = Probe::new(&gpu, &shadows);
    let depth = Depth::new(&gpu, FORMAT, &boxes);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let early = shadows.record_visibility(&mut encoder, &depth.view).expect_err("not prepared").to_string();
    assert!(early.contains("`record_visibility`"), "{early}");
    assert!(shadows.visibility().is_none());
    let lights = [sun(), spot(), Light { position_world: Vec3::new(0.3, 6.5, -0.2), ..lamp() }, sun()];
    let handles = lights.map(|light| shadows.add_light(light).expect("a light"));
    for (handle, family) in handles.iter().zip(["mask", "pcf", "volume", "mask-subtractive"]) {
        shadows.set_technique_named(*handle, family).expect("declared");
    }
    for handle in handles {
        let number = shadows.light_index(handle).expect("a number");
        let (buffer, inline) = probe.shoot_both(&gpu, &mut shadows, &depth, number, &points);
        let differ = buffer.iter().zip(&inline).filter(|(a, b)| (**a - b.w).abs() > 0.1).count();
        let dark = inline.iter().filter(|v| v.w < 0.5).count();
        assert!(dark > 100, "light {number}: {dark} dark");
        assert!(differ <= points.len() / 100, "light {number}: {differ} of {} differ", points.len());
    }
    let (first, second) =
        (shadows.light_index(handles[0]).expect("0"), shadows.light_index(handles[1]).expect("1"));
    let (a, _) = probe.shoot_both(&gpu, &mut shadows, &depth, first, &points);
    let (b, _) = probe.shoot_both(&gpu, &mut shadows, &depth, second, &points);
    let differ = a.iter().zip(&b).filter(|(a, b)| (*a - *b).abs() > 0.1).count();
    assert!(differ > points.len() / 20, "each light has a layer of its own: {differ}");
}

#[test]
fn masks_of_another_size_are_refused() {
    let Some(gpu) = gpu() else { return };
    let (mut shadows, _) = made(&gpu, &boxes(2, 1));
    let light = shadows.add_light(sun()).expect("a light");
    let other = Settings::new("mask", [("mask_size", "64")]).expect("settings");
    let refused = shadows.set_technique(light, &other).expect_err("another size").to_string();
    assert!(refused.contains("`mask`"), "{refused}");
}
