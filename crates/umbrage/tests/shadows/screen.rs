//! V on the screen, over a depth that the caller drew with its own arithmetic, against rays.

use crate::common::*;
use glam::Vec3;
use umbrage::core::technique::Settings;
use umbrage::{CasterMesh, Shadows, ShadowsError, ShadowsOptions};

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth24PlusStencil8;

/// Volumes of every light, hard and soft, are right wherever rays are sure; and a light is switched to a map and back.
#[test]
fn volumes_agree_with_rays_and_are_switched_between_frames() {
    let Some(gpu) = gpu() else { return };
    let boxes = boxes(12, 5);
    let points = seen_points(&points(80), &boxes);
    assert!(points.len() > 3000, "{}", points.len());
    let options = ShadowsOptions::with(["volume", "volume-soft", "linear"])
        .and_then(|o| o.map_size(512))
        .expect("options")
        .depth_stencil(FORMAT);
    let mut shadows = Shadows::new(&gpu.device, &gpu.queue, options).expect("shadows");
    let probe = Probe::new(&gpu, &shadows);
    let mesh = add_cube(&gpu, &mut shadows);
    shadows.add_receiver(ground()).expect("ground");
    let casters: Vec<_> = boxes
        .iter()
        .map(|(at, half)| shadows.add_caster(mesh, placed(*at, *half)).expect("a caster"))
        .collect();
    let lights = [sun(), spot(), lamp()];
    let handles = lights.map(|light| shadows.add_light(light).expect("a light"));
    let depth = Depth::new(&gpu, FORMAT, &boxes);
    for technique in ["volume", "volume-soft", "linear", "volume"] {
        for (light, handle) in lights.iter().zip(handles) {
            shadows.set_technique_named(handle, technique).expect("declared");
            let number = shadows.light_index(handle).expect("a number");
            let seen = probe.shoot_over(&gpu, &mut shadows, &depth, number, &points);
            // A volume says nothing of the cone: what lies outside is the caller's to leave dark.
            let inside = |p: &&Vec3| {
                let umbrage::core::LightKind::Spot { outer_rad, .. } = light.kind else { return true };
                let along = (**p - light.position_world).normalize().dot(light.direction_world);
                along > (outer_rad - 0.02).cos()
            };
            let (kept, judged): (Vec<_>, Vec<_>) =
                points.iter().zip(&seen).filter(|(p, _)| inside(p)).map(|(p, v)| (*v, *p)).unzip();
            let reach_m = if technique == "volume-soft" { 0.35 } else { 0.08 };
            let (sure, wrong) = judge(&kept, &judged, light, &boxes, reach_m);
            assert!(sure > 700, "{technique} under a {} light: {sure} sure", light.kind.id());
            assert!(wrong <= sure / 300, "{technique} under a {} light: {wrong} of {sure}", light.kind.id());
        }
    }
    // Something moves: its volume goes with it.
    let number = shadows.light_index(handles[0]).expect("a number");
    let mut moved = boxes.clone();
    moved[3].0 += Vec3::new(0.7, 0.0, -0.4);
    shadows.move_caster(casters[3], placed(moved[3].0, moved[3].1)).expect("moved");
    let points = seen_points(&points, &moved);
    let depth = Depth::new(&gpu, FORMAT, &moved);
    let seen = probe.shoot_over(&gpu, &mut shadows, &depth, number, &points);
    let (sure, wrong) = judge(&seen, &points, &lights[0], &moved, 0.08);
    assert!(wrong <= sure / 300, "{wrong} of {sure}");
    let (_, before) = judge(&seen, &points, &lights[0], &boxes, 0.08);
    assert!(before > 10, "where it was there is no shadow: {before}");
}

/// What volumes cannot be made of is drawn into a map for the same light, and both count.
#[test]
fn casters_without_a_shape_are_left_to_a_map() {
    let Some(gpu) = gpu() else { return };
    let boxes = boxes(12, 6);
    let points = seen_points(&points(80), &boxes);
    let options = ShadowsOptions::with(["volume"]).and_then(|o| o.map_size(512)).expect("options");
    let mut shadows = Shadows::new(&gpu.device, &gpu.queue, options.depth_stencil(FORMAT)).expect("shadows");
    let probe = Probe::new(&gpu, &shadows);
    let cube = CubeBuffers::new(&gpu);
    let shaped = shadows.add_mesh(&cube.mesh()).expect("a mesh");
    let bounds = umbrage::core::Aabb { min: Vec3::NEG_ONE, max: Vec3::ONE };
    let bare = CasterMesh::new(&cube.positions, 0..8, bounds).indexed(
        &cube.indices,
        wgpu::IndexFormat::Uint32,
        0..36,
    );
    let bare = shadows.add_mesh(&bare).expect("a mesh");
    shadows.add_receiver(ground()).expect("ground");
    let light = shadows.add_light(sun()).expect("a light");
    let number = shadows.light_index(light).expect("a number");
    let depth = Depth::new(&gpu, FORMAT, &boxes);
    for (i, (at, half)) in boxes.iter().enumerate() {
        let mesh = if i % 2 == 0 { shaped } else { bare };
        shadows.add_caster(mesh, placed(*at, *half)).expect("a caster");
        if i == 0 {
            probe.shoot_over(&gpu, &mut shadows, &depth, number, &points);
            assert_eq!(shadows.prepare(&frame()).expect("prepared").views, 0, "no map without need");
        }
    }
    let seen = probe.shoot_over(&gpu, &mut shadows, &depth, number, &points);
    assert_eq!(shadows.prepare(&frame()).expect("prepared").views, 1);
    let (sure, wrong) = judge(&seen, &points, &sun(), &boxes, 0.12);
    assert!(sure > 2000 && wrong <= sure / 200, "{wrong} of {sure}");
}

/// What goes wrong though nothing is misused is told, as long as it does.
#[test]
fn volumes_that_the_far_plane_cuts_are_told() {
    let Some(gpu) = gpu() else { return };
    let options = ShadowsOptions::with(["volume"]).expect("options").depth_stencil(FORMAT);
    let mut shadows = Shadows::new(&gpu.device, &gpu.queue, options).expect("shadows");
    let mesh = add_cube(&gpu, &mut shadows);
    let (at, half) = boxes(1, 3)[0];
    shadows.add_caster(mesh, placed(at, half)).expect("a caster");
    let light = shadows.add_light(sun()).expect("a light");
    shadows.prepare(&frame()).expect("prepared");
    assert_eq!(shadows.warnings(), []);
    let far =
        Settings::new("volume", [("counting", "depth-fail"), ("extrude_m", "10000")]).expect("settings");
    shadows.set_technique(light, &far).expect("choices of volumes are free");
    shadows.prepare(&frame()).expect("prepared");
    let told = shadows.warnings()[0].to_string();
    assert!(
        told.contains("light 0") && told.contains("far plane") && told.contains("DEPTH_CLIP_CONTROL"),
        "{told}"
    );
    shadows.set_technique_named(light, "volume").expect("declared");
    shadows.prepare(&frame()).expect("prepared");
    assert_eq!(shadows.warnings(), []);
}

/// Lights and casters may be told from any thread.
#[test]
fn shadows_go_from_thread_to_thread() {
    fn goes<T: Send + Sync>() {}
    goes::<Shadows>();
}

#[test]
fn a_depth_that_does_not_fit_is_refused() {
    let Some([gpu, other]) = gpus() else { return };
    let boxes = boxes(2, 7);
    let options = ShadowsOptions::with(["volume", "volume-soft"]).expect("options").depth_stencil(FORMAT);
    let mut shadows = Shadows::new(&gpu.device, &gpu.queue, options).expect("shadows");
    let mesh = add_cube(&gpu, &mut shadows);
    shadows.add_caster(mesh, placed(boxes[0].0, boxes[0].1)).expect("a caster");
    let light = shadows.add_light(sun()).expect("a light");
    let depth = Depth::new(&gpu, FORMAT, &boxes);
    let foreign = Depth::new(&other, FORMAT, &boxes);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let refused = shadows.record_screen(&mut encoder, &depth.view).expect_err("not prepared");
    assert_eq!(refused, ShadowsError::NotPrepared { call: "record_screen" });
    let mut small = frame();
    small.size_px.x = 64;
    shadows.prepare(&small).expect("prepared");
    let refused = shadows.record_screen(&mut encoder, &depth.view).expect_err("too large").to_string();
    assert!(refused.contains("320x240") && refused.contains("64x240"), "{refused}");
    shadows.prepare(&frame()).expect("prepared");
    let refused = shadows.record_screen(&mut encoder, &foreign.view).expect_err("foreign").to_string();
    assert!(refused.contains("another device"), "{refused}");
    let plain = |usage, format, samples| {
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: 320, height: 240, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: samples,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | usage,
            view_formats: &[],
        });
        texture.create_view(&Default::default())
    };
    let none = wgpu::TextureUsages::empty();
    let float = plain(none, wgpu::TextureFormat::Depth32Float, 1);
    let refused = shadows.record_screen(&mut encoder, &float).expect_err("no stencil").to_string();
    assert!(refused.contains("Depth32Float") && refused.contains("depth_stencil"), "{refused}");
    let refused =
        shadows.record_screen(&mut encoder, &plain(none, FORMAT, 4)).expect_err("samples").to_string();
    assert!(refused.contains("samples"), "{refused}");
    shadows.set_technique_named(light, "volume-soft").expect("declared");
    shadows.prepare(&frame()).expect("prepared");
    let refused =
        shadows.record_screen(&mut encoder, &plain(none, FORMAT, 1)).expect_err("unreadable").to_string();
    assert!(refused.contains("TEXTURE_BINDING"), "{refused}");
    let layered = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width: 320, height: 240, depth_or_array_layers: 2 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: FORMAT,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    let second = layered.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2),
        base_array_layer: 1,
        array_layer_count: Some(1),
        ..Default::default()
    });
    for refused in [
        shadows.record_screen(&mut encoder, &second).expect_err("layered"),
        shadows.record_visibility(&mut encoder, &second).expect_err("layered"),
    ] {
        assert!(refused.to_string().contains("several layers"), "{refused}");
    }
    shadows.record_screen(&mut encoder, &depth.view).expect("and this one is fine");
    let mut huge = frame();
    huge.size_px.x = 100_000;
    for _ in 0..2 {
        let refused = shadows.prepare(&huge).expect_err("too large, also the second time").to_string();
        assert!(refused.contains("max_texture_dimension_2d"), "{refused}");
        let refused = shadows.record(&mut encoder).expect_err("no frame is prepared");
        assert_eq!(refused, ShadowsError::NotPrepared { call: "record" });
    }
    let mut reversed = frame();
    reversed.depth = umbrage::core::DepthConvention::Reversed;
    let refused = shadows.prepare(&reversed).expect_err("turned round").to_string();
    assert!(refused.contains("first frame"), "{refused}");
}
