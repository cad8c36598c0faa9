//! A filter of one's own: a function in WGSL that weighs the texels around a surface's place in the map. Here it makes a lamp into a
//! ring light. The left half of the picture has the default kernel, a bell of the same width.
//!
//! `cargo run -p umbrage --example custom_filter`, or `-- --headless OUT.png`; `--plain`: the bell on both sides.

#[path = "../support/mod.rs"]
pub(crate) mod support;

use glam::camera::rh::{proj::directx::perspective, view::look_at_mat4};
use glam::{Mat4, Vec3};
use support::forward::{Forward, Mesh, Placed};
use support::shapes::Shape;
use support::{Example, Gpu, Result, Target};
use umbrage::core::technique::Settings;
use umbrage::core::{Aabb, Light};
use umbrage::{Frame, Shadows, ShadowsOptions};

fn main() -> std::process::ExitCode {
    support::run::<CustomFilter>()
}

/// One kernel, and all that is drawn with it.
struct Half {
    shadows: Shadows,
    mesh: Mesh,
    forward: Forward,
    lights: [(u32, Light); 1],
}

/// The example.
pub struct CustomFilter {
    halves: [Half; 2],
    things: Vec<Placed>,
}

fn things() -> Vec<Placed> {
    let placed = |middle: Vec3, half: Vec3, color| {
        Placed::new(Mat4::from_translation(middle) * Mat4::from_scale(half), color)
    };
    let mut things = vec![placed(Vec3::NEG_Y * 0.1, Vec3::new(5.0, 0.1, 4.0), [0.66, 0.64, 0.60])];
    // The same on both sides.
    for side in [-1.6f32, 1.6] {
        for i in 0..4 {
            let x = side - 0.9 + 0.6 * i as f32;
            let height_m = 0.5 + 0.14 * i as f32;
            things.push(placed(
                Vec3::new(x, height_m, -0.4),
                Vec3::new(0.035, height_m, 0.035),
                [0.30, 0.42, 0.62],
            ));
        }
        things.push(placed(Vec3::new(side, 0.9, -1.2), Vec3::new(1.1, 0.05, 0.05), [0.72, 0.36, 0.26]));
        things.push(placed(Vec3::new(side, 0.22, 1.0), Vec3::splat(0.22), [0.74, 0.66, 0.30]));
    }
    things
}

impl Half {
    fn new(gpu: &Gpu, format: wgpu::TextureFormat, side: f32, own: bool, things: &[Placed]) -> Result<Self> {
        // The technique `kernel` compares with each texel that its kernel reaches, and blends by the kernel's weights. The default
        // bias makes filters narrow where shadows begin; here all of the kernel is to be seen.
        let choices = [("width", "17"), ("map_size", "512"), ("bias", "receiver-plane")];
        let technique = Settings::new("kernel", choices)?;
        let mut options = ShadowsOptions::with([])?.technique(technique);
        if own {
            options = options.kernel(include_str!("ring.wgsl"));
        }
        let mut shadows = Shadows::new(&gpu.device, &gpu.queue, options)?;
        let light = Light::spot(Vec3::new(side, 4.6, -4.2), Vec3::new(side, 0.0, 0.0), 0.4, 0.62);
        let light = Light { intensity: 34.0, ..light };
        let handle = shadows.add_light(light)?;
        let number = shadows.light_index(handle)?;
        shadows.add_receiver(Aabb { min: Vec3::new(-5.0, 0.0, -4.0), max: Vec3::new(5.0, 0.0, 4.0) })?;
        let mesh = Mesh::new(gpu, &mut shadows, &Shape::cube())?;
        for thing in &things[1..] {
            shadows.add_caster(mesh.caster, thing.world_from_object)?;
        }
        let forward = Forward::new(gpu, format, &shadows, things.len());
        forward.place(gpu, things);
        Ok(Self { shadows, mesh, forward, lights: [(number, light)] })
    }
}

impl Example for CustomFilter {
    const NAME: &'static str = "custom_filter";

    fn new(gpu: &Gpu, format: wgpu::TextureFormat, plain: bool) -> Result<Self> {
        let things = things();
        let halves =
            [Half::new(gpu, format, -1.6, false, &things)?, Half::new(gpu, format, 1.6, !plain, &things)?];
        Ok(Self { halves, things })
    }

    fn draw(&mut self, gpu: &Gpu, target: &Target<'_>, time_s: f32) -> Result<()> {
        let aside = 0.4 * (0.5 * time_s).sin();
        let view_from_world = look_at_mat4(Vec3::new(aside, 4.4, 5.2), Vec3::new(0.0, 0.1, 0.2), Vec3::Y);
        let clip_from_view = perspective(0.72, target.aspect(), 0.1, 50.0);
        let frame = Frame::from_matrices(view_from_world, clip_from_view, target.size_px);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let [width, height] = target.size_px;
        let middle = width / 2;
        for (number, half) in self.halves.iter_mut().enumerate() {
            half.shadows.prepare(&frame)?;
            half.shadows.record(&mut encoder)?;
            half.forward.show(gpu, clip_from_view * view_from_world, 0.12, &half.lights);
            let load = if number == 0 { wgpu::LoadOp::Clear(wgpu::Color::BLACK) } else { wgpu::LoadOp::Load };
            let mut pass = half.forward.begin(gpu, &mut encoder, target, load);
            // A line between the two stays black.
            match number {
                0 => pass.set_scissor_rect(0, 0, middle.saturating_sub(1), height),
                _ => pass.set_scissor_rect(middle, 0, width - middle, height),
            }
            half.forward.draw(&mut pass, &half.shadows, &[(&half.mesh, self.things.len() as u32)]);
        }
        gpu.queue.submit([encoder.finish()]);
        Ok(())
    }
}
