//! Anything in any order: lights, techniques of all families, casters of all kinds, sizes of the picture. wgpu objects to nothing, and
//! in the end V is that of rays.

use crate::common::*;
use glam::Vec3;
use umbrage::core::technique::TECHNIQUES;
use umbrage::core::{Aabb, Light, LightKind};
use umbrage::{
    CasterHandle, CasterMesh, Frame, LightHandle, MeshHandle, ReceiverHandle, Shadows, ShadowsOptions,
};

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth24PlusStencil8;

struct Random(u32);

impl Random {
    fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.0 >> 8) as f32 / (1u32 << 24) as f32
    }

    fn below(&mut self, count: usize) -> usize {
        ((self.unit() * count as f32) as usize).min(count.saturating_sub(1))
    }
}

struct World {
    names: Vec<&'static str>,
    shadows: Shadows,
    shaped: MeshHandle,
    bare: MeshHandle,
    lights: Vec<(Light, LightHandle)>,
    casters: Vec<(Vec3, Vec3, CasterHandle)>,
    receivers: Vec<ReceiverHandle>,
    boxes_made: u32,
    random: Random,
}

impl World {
    fn new(gpu: &Gpu) -> Self {
        let names: Vec<&str> = TECHNIQUES.iter().map(|row| row.id).collect();
        let options =
            ShadowsOptions::with(names.iter().copied()).and_then(|o| o.map_size(128)).expect("options");
        let options = options.depth_stencil(FORMAT).at_most(12, 256);
        let mut shadows = Shadows::new(&gpu.device, &gpu.queue, options).expect("shadows");
        let cube = CubeBuffers::new(gpu);
        let shaped = shadows.add_mesh(&cube.mesh()).expect("a mesh");
        let bounds = Aabb { min: Vec3::NEG_ONE, max: Vec3::ONE };
        let bare = CasterMesh::new(&cube.positions, 0..8, bounds);
        let bare = bare.indexed(&cube.indices, wgpu::IndexFormat::Uint32, 0..36).closed();
        let bare = shadows.add_mesh(&bare).expect("a mesh");
        let flat = placed(Vec3::ZERO, Vec3::new(5.0, 0.0, 5.0));
        let receivers = vec![shadows.add_receiver_mesh(shaped, flat).expect("ground")];
        let (lights, casters) = (Vec::new(), Vec::new());
        Self { names, shadows, shaped, bare, lights, casters, receivers, boxes_made: 0, random: Random(5) }
    }

    fn boxes(&self) -> Vec<(Vec3, Vec3)> {
        self.casters.iter().map(|(at, half, _)| (*at, *half)).collect()
    }

    /// One change of any kind.
    fn change(&mut self) {
        match self.random.below(12) {
            0 | 1 if self.lights.len() < 10 => {
                let aside = Vec3::new(
                    4.0 * self.random.unit() - 2.0,
                    2.0 * self.random.unit(),
                    4.0 * self.random.unit() - 2.0,
                );
                let mut light = [sun(), spot(), lamp()][self.random.below(3)];
                light.position_world += aside;
                if self.random.unit() < 0.3 && light.kind != LightKind::Directional {
                    light.shape = umbrage::core::LightShape::Sphere { radius_m: 0.2 };
                }
                self.lights.push((light, self.shadows.add_light(light).expect("a light")));
            }
            2 if !self.lights.is_empty() => {
                let (_, handle) = self.lights.swap_remove(self.random.below(self.lights.len()));
                self.shadows.remove_light(handle).expect("removed");
            }
            3..=5 if !self.lights.is_empty() => {
                let name = self.names[self.random.below(self.names.len())];
                self.shadows
                    .set_technique_named(self.lights[self.random.below(self.lights.len())].1, name)
                    .expect(name);
            }
            6 if !self.lights.is_empty() => {
                let which = self.random.below(self.lights.len());
                self.lights[which].0.position_world +=
                    Vec3::new(self.random.unit() - 0.5, 0.0, self.random.unit() - 0.5);
                self.shadows.set_light(self.lights[which].1, self.lights[which].0).expect("moved");
            }
            7 | 8 if self.casters.len() < 40 => {
                for (at, half) in boxes(3, 1000 + self.boxes_made) {
                    let mesh = if self.random.unit() < 0.7 { self.shaped } else { self.bare };
                    // A mirrored one now and then.
                    let turned = if self.random.unit() < 0.3 { -half } else { half };
                    self.casters.push((
                        at,
                        half,
                        self.shadows.add_caster(mesh, placed(at, turned)).expect("a caster"),
                    ));
                }
                self.boxes_made += 1;
            }
            9 if self.casters.len() > 3 => {
                let (_, _, handle) = self.casters.swap_remove(self.random.below(self.casters.len()));
                self.shadows.remove_caster(handle).expect("removed");
            }
            10 if !self.casters.is_empty() => {
                for _ in 0..5 {
                    let which = self.random.below(self.casters.len());
                    let (at, half, handle) = &mut self.casters[which];
                    *at = (*at + Vec3::new(self.random.unit() - 0.5, 0.0, self.random.unit() - 0.5))
                        .clamp(Vec3::new(-4.0, at.y, -4.0), Vec3::new(4.0, at.y, 4.0));
                    self.shadows.move_caster(*handle, placed(*at, *half)).expect("moved");
                }
            }
            _ => {
                if self.random.unit() < 0.3 {
                    self.shadows.remove_receiver(self.receivers.remove(0)).expect("removed");
                    let flat = placed(Vec3::ZERO, Vec3::new(5.0, 0.0, 5.0));
                    self.receivers.push(self.shadows.add_receiver_mesh(self.shaped, flat).expect("ground"));
                }
            }
        }
    }

    /// A picture of another size, without its own depth: no screen is recorded then.
    fn glance(&mut self, gpu: &Gpu, width: u32) {
        let eye = Vec3::new(self.random.unit(), 5.0, 8.0);
        let camera = umbrage::core::Camera::look_at(eye, Vec3::ZERO, 0.8, 0.1, 50.0);
        let other = Frame::from_camera(&camera, [width, 48], umbrage::core::DepthConvention::ZeroToOne);
        self.shadows.prepare(&other).expect("prepared");
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        self.shadows.record(&mut encoder).expect("recorded");
        gpu.queue.submit([encoder.finish()]);
    }

    fn draw(&mut self, gpu: &Gpu) {
        let depth = Depth::new(gpu, FORMAT, &self.boxes());
        self.shadows.prepare(&frame()).expect("prepared");
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        self.shadows.record(&mut encoder).expect("recorded");
        depth.record(&mut encoder);
        self.shadows.record_screen(&mut encoder, &depth.view).expect("recorded");
        self.shadows.record_visibility(&mut encoder, &depth.view).expect("recorded");
        gpu.queue.submit([encoder.finish()]);
        gpu.device.poll(wgpu::PollType::wait_indefinitely()).expect("polled");
    }

    /// Every light is right with a plain map and with volumes.
    fn check(&mut self, gpu: &Gpu, probe: &Probe, depth: &Depth, points: &[Vec3]) {
        let boxes = self.boxes();
        for technique in ["linear", "volume"] {
            for (light, handle) in self.lights.clone() {
                self.shadows.set_technique_named(handle, technique).expect("declared");
                let number = self.shadows.light_index(handle).expect("a number");
                let seen = probe.shoot_over(gpu, &mut self.shadows, depth, number, points);
                let inside = |p: &Vec3| {
                    let LightKind::Spot { outer_rad, .. } = light.kind else { return true };
                    (*p - light.position_world).normalize().dot(light.direction_world)
                        > (outer_rad - 0.02).cos()
                };
                let (seen, judged): (Vec<_>, Vec<_>) =
                    seen.iter().zip(points).filter(|(_, p)| inside(p)).map(|(v, p)| (*v, *p)).unzip();
                let (sure, wrong) = judge(&seen, &judged, &light, &boxes, 0.3);
                assert!(wrong <= 1 + sure / 100, "{technique}, {} light: {wrong} of {sure}", light.kind.id());
            }
        }
    }
}

#[test]
fn anything_goes_in_any_order() {
    let Some(gpu) = gpu() else { return };
    let mut world = World::new(&gpu);
    let probe = Probe::new(&gpu, &world.shadows);
    for turn in 0..80 {
        world.change();
        if turn % 17 == 0 {
            world.glance(&gpu, 64 + turn);
        } else {
            world.draw(&gpu);
        }
    }
    let (lights, casters) = (world.lights.len(), world.casters.len());
    assert!(lights > 2 && casters > 6, "{lights} lights, {casters} casters");
    let boxes = world.boxes();
    let points = seen_points(&points(60), &boxes);
    let depth = Depth::new(&gpu, FORMAT, &boxes);
    world.check(&gpu, &probe, &depth, &points);
    let World { mut shadows, shaped, bare, casters, receivers, .. } = world;
    for (.., handle) in casters {
        shadows.remove_caster(handle).expect("removed");
    }
    for receiver in receivers {
        shadows.remove_receiver(receiver).expect("removed");
    }
    shadows.remove_mesh(shaped).expect("nobody uses it");
    shadows.remove_mesh(bare).expect("nobody uses it");
    let lit = probe.shoot_over(&gpu, &mut shadows, &depth, 0, &points);
    assert!(lit.iter().all(|v| v.w == 1.0), "nothing is left that casts");
}
