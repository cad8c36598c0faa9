//! All that can move: casters, a light, the corners of a mesh (a flag), and what the caller draws itself (grass). And the technique
//! of one light, which is another every two seconds.
//!
//! `cargo run -p umbrage --example animated`, or `-- --headless OUT.png --time S`; `--plain`: without casters.

#[path = "../support/mod.rs"]
pub(crate) mod support;

mod blades;

use blades::Blades;
use glam::camera::rh::{proj::directx::perspective, view::look_at_mat4};
use glam::{Mat4, Vec3};
use support::forward::{Forward, Mesh, Placed};
use support::shapes::Shape;
use support::{Example, Gpu, Result, Target};
use umbrage::core::{Aabb, Light};
use umbrage::{CasterHandle, Frame, LightHandle, Shadows, ShadowsOptions};

fn main() -> std::process::ExitCode {
    support::run::<Animated>()
}

/// What the sun is in turn.
const TECHNIQUES: [&str; 2] = ["pcf", "hard"];
/// Boxes that circle; after them come pole, ground and flag.
const CIRCLING: usize = 5;

/// The example.
pub struct Animated {
    shadows: Shadows,
    forward: Forward,
    blades: Blades,
    cube: Mesh,
    flag: Mesh,
    things: Vec<Placed>,
    circling: Vec<CasterHandle>,
    sun: LightHandle,
    lamp: LightHandle,
}

fn placed(middle: Vec3, half: Vec3, turn: Mat4, color: [f32; 3]) -> Placed {
    Placed::new(Mat4::from_translation(middle) * turn * Mat4::from_scale(half), color)
}

fn circling(number: usize, time_s: f32) -> Placed {
    let turn_rad = 0.6 * time_s + std::f32::consts::TAU * number as f32 / CIRCLING as f32;
    let middle =
        Vec3::new(1.7 * turn_rad.cos(), 1.1 + 0.4 * (2.0 * turn_rad).sin(), 1.7 * turn_rad.sin() - 0.9);
    let turn = Mat4::from_rotation_y(-turn_rad) * Mat4::from_rotation_x(time_s + number as f32);
    placed(middle, Vec3::new(0.42, 0.22, 0.30), turn, [0.32, 0.46 + 0.06 * number as f32, 0.72])
}

/// Bound to its pole at -X, and waving.
fn flag(time_s: f32) -> Shape {
    let mut flag = Shape::default();
    flag.grid([32, 12], |x, y| {
        let wave_rad = 7.0 * x - 4.0 * time_s + 1.2 * y;
        let slope = 0.32 * x * 7.0 * wave_rad.cos() + 0.32 * wave_rad.sin();
        let normal = Vec3::new(-slope, 0.0, 1.8).normalize();
        (Vec3::new(1.8 * x, 1.1 * y, 0.32 * x * wave_rad.sin()), normal)
    });
    flag
}

/// The flag never leaves this.
fn flag_bounds() -> Aabb {
    Aabb { min: Vec3::new(0.0, 0.0, -0.32), max: Vec3::new(1.8, 1.1, 0.32) }
}

fn things(time_s: f32) -> Vec<Placed> {
    let mut things: Vec<Placed> = (0..CIRCLING).map(|number| circling(number, time_s)).collect();
    let (pole, ground) = (Vec3::new(-2.6, 1.6, 1.2), Vec3::new(5.0, 0.1, 5.0));
    things.push(placed(pole, Vec3::new(0.05, 1.6, 0.05), Mat4::IDENTITY, [0.5, 0.5, 0.5]));
    things.push(placed(Vec3::NEG_Y * 0.1, ground, Mat4::IDENTITY, [0.62, 0.60, 0.55]));
    let flag_at = Vec3::new(pole.x, 2.0, pole.z);
    things.push(placed(flag_at, Vec3::ONE, Mat4::from_rotation_y(0.35), [0.78, 0.30, 0.24]));
    things
}

fn lamp(time_s: f32) -> Light {
    let place = Vec3::new(1.5 * (0.9 * time_s).sin(), 3.0, 1.2 * (0.9 * time_s).cos() - 0.9);
    let color = Vec3::new(1.0, 0.72, 0.42);
    Light { color, intensity: 4.0, ..Light::lamp(place) }
}

impl Example for Animated {
    const NAME: &'static str = "animated";
    const TIME_S: f32 = 1.0;

    fn new(gpu: &Gpu, format: wgpu::TextureFormat, plain: bool) -> Result<Self> {
        let options = ShadowsOptions::with(TECHNIQUES)?.map_size(1024)?;
        let mut shadows = Shadows::new(&gpu.device, &gpu.queue, options)?;
        let sun = Light { intensity: 0.7, ..Light::sun(Vec3::new(0.5, -1.0, 0.45)) };
        let sun = shadows.add_light(sun)?;
        let lamp = shadows.add_light(lamp(0.0))?;
        let things = things(0.0);
        let cube = Mesh::new(gpu, &mut shadows, &Shape::cube())?;
        let flag = Mesh::new(gpu, &mut shadows, &flag(0.0))?;
        shadows.reshape_mesh(flag.caster, flag_bounds())?;
        let mut circling = Vec::new();
        if !plain {
            for thing in &things[..=CIRCLING] {
                circling.push(shadows.add_caster(cube.caster, thing.world_from_object)?);
            }
            shadows.add_caster(flag.caster, things[CIRCLING + 2].world_from_object)?;
            // The pole stands still.
            circling.truncate(CIRCLING);
        }
        shadows.add_receiver(Aabb { min: Vec3::new(-5.0, 0.0, -5.0), max: Vec3::new(5.0, 0.0, 5.0) })?;
        let forward = Forward::new(gpu, format, &shadows, things.len());
        let blades = Blades::new(gpu, format, &mut shadows, &forward, !plain)?;
        Ok(Self { shadows, forward, blades, cube, flag, things, circling, sun, lamp })
    }

    fn draw(&mut self, gpu: &Gpu, target: &Target<'_>, time_s: f32) -> Result<()> {
        self.move_all(gpu, time_s)?;
        let view_from_world = look_at_mat4(Vec3::new(0.4, 4.8, 7.6), Vec3::new(0.0, 0.9, 0.0), Vec3::Y);
        let clip_from_view = perspective(0.75, target.aspect(), 0.1, 50.0);
        let mut lights = Vec::new();
        for handle in [self.sun, self.lamp] {
            lights.push((self.shadows.light_index(handle)?, *self.shadows.light(handle)?.0));
        }
        self.forward.show(gpu, clip_from_view * view_from_world, 0.10, &lights);
        self.forward.place(gpu, &self.things);

        self.shadows.prepare(&Frame::from_matrices(view_from_world, clip_from_view, target.size_px))?;
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let blades = &mut self.blades;
        self.shadows.record_with(&mut encoder, |asked, pass| blades.cast(&gpu.device, asked, pass))?;
        let sky = wgpu::Color { r: 0.16, g: 0.24, b: 0.36, a: 1.0 };
        let mut pass = self.forward.begin(gpu, &mut encoder, target, wgpu::LoadOp::Clear(sky));
        let boxes = self.things.len() as u32 - 1;
        self.forward.draw(&mut pass, &self.shadows, &[(&self.cube, boxes), (&self.flag, 1)]);
        self.blades.draw(&mut pass);
        drop(pass);
        gpu.queue.submit([encoder.finish()]);
        Ok(())
    }
}

impl Animated {
    fn move_all(&mut self, gpu: &Gpu, time_s: f32) -> Result<()> {
        self.things = things(time_s);
        for (caster, thing) in self.circling.iter().zip(&self.things) {
            self.shadows.move_caster(*caster, thing.world_from_object)?;
        }
        gpu.queue.write_buffer(&self.flag.vertices, 0, bytemuck::cast_slice(&flag(time_s).vertices));
        self.shadows.reshape_mesh(self.flag.caster, flag_bounds())?;
        self.blades.sway(gpu, &mut self.shadows, time_s)?;
        self.shadows.set_light(self.lamp, lamp(time_s))?;
        let technique = TECHNIQUES[(0.5 * time_s) as usize % TECHNIQUES.len()];
        // What it is already costs nothing.
        self.shadows.set_technique_named(self.sun, technique)?;
        Ok(())
    }
}
