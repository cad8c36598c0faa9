//! Dozens of lights over a hall of boxes: spots with `linear` maps, lamps with `hard` ones, a sun with `pcf`, all in one bind group
//! and one loop of the shader. A picture comes with what was counted: in the first frame, in one where nothing moved, and in two where
//! four crates did.
//!
//! `cargo run -p umbrage --example many_lights`, or `-- --headless OUT.png`; `--plain`: without casters.

#[path = "../support/mod.rs"]
pub(crate) mod support;

use glam::camera::rh::{proj::directx::perspective, view::look_at_mat4};
use glam::{Mat4, Vec3};
use support::forward::{Forward, Mesh, Placed};
use support::shapes::Shape;
use support::{Example, Gpu, Result, Target};
use umbrage::core::technique::Settings;
use umbrage::core::{Aabb, Light};
use umbrage::{CasterHandle, Frame, Shadows, ShadowsOptions};

fn main() -> std::process::ExitCode {
    support::run::<ManyLights>()
}

/// Crates that slide to and fro.
const SLIDING: usize = 4;
const HALF_LENGTH_M: f32 = 14.0;
const HALF_WIDTH_M: f32 = 7.0;

/// The example.
pub struct ManyLights {
    shadows: Shadows,
    forward: Forward,
    mesh: Mesh,
    lights: Vec<(u32, Light)>,
    things: Vec<Placed>,
    sliding: Vec<CasterHandle>,
    report: String,
}

fn placed(middle: Vec3, half: Vec3, turn_rad: f32, color: [f32; 3]) -> Placed {
    let turned = Mat4::from_translation(middle) * Mat4::from_rotation_y(turn_rad);
    Placed::new(turned * Mat4::from_scale(half), color)
}

fn sliding(number: usize, time_s: f32) -> Placed {
    let along = 1.5 * (0.8 * time_s + number as f32).sin() + 6.0 * number as f32 - 9.0;
    placed(Vec3::new(along, 0.45, 0.0), Vec3::splat(0.45), 0.3, [0.70, 0.52, 0.30])
}

/// Sliding crates first, what only receives last.
fn things() -> Vec<Placed> {
    let mut things: Vec<Placed> = (0..SLIDING).map(|number| sliding(number, 0.0)).collect();
    for i in 0..16 {
        let (x, z) = (3.4 * (i % 8) as f32 - 11.9, if i < 8 { -3.4 } else { 3.4 });
        things.push(placed(Vec3::new(x, 1.9, z), Vec3::new(0.28, 1.9, 0.28), 0.0, [0.60, 0.60, 0.62]));
        // A stack of crates beside each column, none like its neighbours.
        let turn_rad = 0.7 * i as f32;
        let side_m = 0.32 + 0.03 * (i * 5 % 7) as f32;
        let beside = Vec3::new(x + 1.5, side_m, z + 0.5 * turn_rad.sin());
        things.push(placed(beside, Vec3::splat(side_m), turn_rad, [0.58, 0.44, 0.30]));
        if i % 3 == 0 {
            let above = beside + Vec3::Y * (side_m + 0.25);
            things.push(placed(above, Vec3::splat(0.25), 1.3 * turn_rad, [0.42, 0.50, 0.58]));
        }
    }
    let (length, width) = (HALF_LENGTH_M, HALF_WIDTH_M);
    things.push(placed(Vec3::new(0.0, 1.5, -width), Vec3::new(length, 1.5, 0.15), 0.0, [0.62, 0.60, 0.58]));
    things.push(placed(Vec3::new(-length, 1.5, 0.0), Vec3::new(0.15, 1.5, width), 0.0, [0.62, 0.60, 0.58]));
    things.push(placed(Vec3::NEG_Y * 0.1, Vec3::new(length, 0.1, width), 0.0, [0.64, 0.62, 0.60]));
    things
}

/// Lights, each with the place of its technique among those of [`techniques`].
fn lights() -> Vec<(usize, Light)> {
    let hue = |i: usize| {
        let turn = |third: f32| 0.55 + 0.45 * (2.4 * i as f32 + third * std::f32::consts::TAU / 3.0).cos();
        Vec3::new(turn(0.0), turn(1.0), turn(2.0))
    };
    let mut lights = Vec::new();
    for i in 0..24 {
        let (x, z) = (3.4 * (i % 8) as f32 - 11.9, 4.4 * (i / 8) as f32 - 4.4);
        let place = Vec3::new(x, 4.6, z + 0.8);
        let spot = Light::spot(place, Vec3::new(x + 0.6, 0.0, z - 0.6), 0.38, 0.52);
        lights.push((0, Light { color: hue(i), intensity: 9.0, range_m: Some(8.0), ..spot }));
    }
    for i in 0..8 {
        let place = Vec3::new(3.4 * i as f32 - 10.2, 1.2, if i % 2 == 0 { -1.8 } else { 1.8 });
        let lamp = Light::lamp(place);
        lights.push((1, Light { color: hue(3 * i + 1), intensity: 1.1, range_m: Some(5.0), ..lamp }));
    }
    lights.push((2, Light { intensity: 0.4, ..Light::sun(-Vec3::new(0.8, 1.0, 0.35)) }));
    lights
}

/// Each with maps of a size that suits.
fn techniques() -> Result<[Settings; 3]> {
    Ok([
        Settings::new("linear", [("map_size", "256")])?,
        Settings::new("hard", [("map_size", "256")])?,
        Settings::new("pcf", [("map_size", "1024")])?,
    ])
}

impl Example for ManyLights {
    const NAME: &'static str = "many_lights";

    fn times_s(time_s: f32) -> Vec<f32> {
        vec![time_s, time_s, time_s + 1.0 / 60.0, time_s + 2.0 / 60.0]
    }

    fn new(gpu: &Gpu, format: wgpu::TextureFormat, plain: bool) -> Result<Self> {
        let techniques = techniques()?;
        let declared = techniques.iter().cloned();
        let options = declared.fold(ShadowsOptions::with([])?, ShadowsOptions::technique);
        let mut shadows = Shadows::new(&gpu.device, &gpu.queue, options)?;
        let mut numbered = Vec::new();
        for (technique, light) in lights() {
            let handle = shadows.add_light_with(light, &techniques[technique])?;
            numbered.push((shadows.light_index(handle)?, light));
        }
        let mesh = Mesh::new(gpu, &mut shadows, &Shape::cube())?;
        let things = things();
        let casting = if plain { 0 } else { things.len() - 1 };
        let casters = things.iter().take(casting);
        let casters = casters.map(|thing| shadows.add_caster(mesh.caster, thing.world_from_object));
        let mut casters = casters.collect::<std::result::Result<Vec<_>, _>>()?;
        casters.truncate(SLIDING);
        let floor = Vec3::new(HALF_LENGTH_M, 0.0, HALF_WIDTH_M);
        shadows.add_receiver(Aabb { min: -floor, max: floor })?;
        let forward = Forward::new(gpu, format, &shadows, things.len());
        let report = String::new();
        Ok(Self { shadows, forward, mesh, lights: numbered, things, sliding: casters, report })
    }

    fn draw(&mut self, gpu: &Gpu, target: &Target<'_>, time_s: f32) -> Result<()> {
        for (number, thing) in self.things.iter_mut().take(SLIDING).enumerate() {
            let now = sliding(number, time_s);
            if now.world_from_object != thing.world_from_object
                && let Some(caster) = self.sliding.get(number)
            {
                self.shadows.move_caster(*caster, now.world_from_object)?;
            }
            *thing = now;
        }
        self.forward.place(gpu, &self.things);
        let view_from_world = look_at_mat4(Vec3::new(10.0, 9.5, 13.0), Vec3::new(-1.0, 0.0, -0.4), Vec3::Y);
        let clip_from_view = perspective(0.75, target.aspect(), 0.1, 80.0);
        self.forward.show(gpu, clip_from_view * view_from_world, 0.05, &self.lights);
        let frame = Frame::from_matrices(view_from_world, clip_from_view, target.size_px);

        let prepared = self.shadows.prepare(&frame)?;
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let recorded = self.shadows.record(&mut encoder)?;
        let sky = wgpu::Color { r: 0.01, g: 0.012, b: 0.02, a: 1.0 };
        let mut pass = self.forward.begin(gpu, &mut encoder, target, wgpu::LoadOp::Clear(sky));
        self.forward.draw(&mut pass, &self.shadows, &[(&self.mesh, self.things.len() as u32)]);
        drop(pass);
        gpu.queue.submit([encoder.finish()]);
        self.report = format!(
            "{}{} lights, {} views: {} fitted, {} casters moved, {} bytes written; {} maps drawn, {} of them over a copy, {} draws, {} triangles; {:.1} MiB\n",
            // A window shows many frames, and asks for none of this.
            if self.report.len() < 1000 { self.report.as_str() } else { "" },
            prepared.lights,
            prepared.views,
            prepared.fitted,
            prepared.moved,
            prepared.written_bytes,
            recorded.maps,
            recorded.copied,
            recorded.draws,
            recorded.triangles,
            self.shadows.memory_bytes() as f64 / f64::from(1 << 20),
        );
        Ok(())
    }

    fn report(&self) -> String {
        self.report.trim_end().to_owned()
    }
}
