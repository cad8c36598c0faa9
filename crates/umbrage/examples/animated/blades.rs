//! Grass that the caller draws: no mesh tells Umbrage of it, only a box. The caller's own pipeline draws it into the maps.

use super::support::forward::{Forward, lit_pipeline};
use super::support::{Gpu, Result};
use glam::Vec3;
use umbrage::caster::caster_view_wgsl;
use umbrage::core::Aabb;
use umbrage::shadows::{OwnDraw, OwnTarget};
use umbrage::{CasterHandle, Shadows};

const COUNT: usize = 420;
const MIDDLE_WORLD: Vec3 = Vec3::new(2.6, 0.0, 1.5);
const RADIUS_M: f32 = 1.3;

/// Mirrors `Blade` of `blades.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Blade {
    root: [f32; 4],
    lean: [f32; 4],
}

const LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: size_of::<Blade>() as u64,
    step_mode: wgpu::VertexStepMode::Instance,
    attributes: &wgpu::vertex_attr_array![0 => Float32x4, 1 => Float32x4],
};

/// The grass.
pub struct Blades {
    blades: wgpu::Buffer,
    lit: wgpu::RenderPipeline,
    caster: Option<CasterHandle>,
    /// Bind group 0 of what casts.
    view_layout: wgpu::BindGroupLayout,
    /// One for each kind of map that was asked for so far.
    casting: Vec<(OwnTarget, wgpu::RenderPipeline)>,
}

/// Where all of it is, whichever way it leans.
fn bounds_world() -> Aabb {
    let reach = Vec3::new(RADIUS_M + 0.5, 0.0, RADIUS_M + 0.5);
    Aabb { min: MIDDLE_WORLD - reach, max: MIDDLE_WORLD + reach + Vec3::Y }
}

fn blade(number: usize, time_s: f32) -> Blade {
    // Sunflower seeds are spread so: evenly, and in no rows.
    let share = (number as f32 + 0.5) / COUNT as f32;
    let turn_rad = 2.399_963 * number as f32;
    let root = MIDDLE_WORLD + RADIUS_M * share.sqrt() * Vec3::new(turn_rad.cos(), 0.0, turn_rad.sin());
    let height_m = 0.45 + 0.3 * (7.0 * turn_rad).sin().abs();
    let sway_m = 0.22 * (1.7 * time_s + 1.3 * root.x).sin() + 0.06 * (5.0 * turn_rad).sin();
    Blade {
        root: root.extend(height_m).to_array(),
        lean: [sway_m, 0.0, 0.3 * sway_m, (3.0 * turn_rad).cos()],
    }
}

impl Blades {
    /// `casts`: do they?
    pub fn new(
        gpu: &Gpu,
        format: wgpu::TextureFormat,
        shadows: &mut Shadows,
        forward: &Forward,
        casts: bool,
    ) -> Result<Self> {
        let library = shadows.wgsl(1);
        let text = [
            library.as_str(),
            include_str!("../support/forward.wgsl"),
            include_str!("blades.wgsl"),
            include_str!("lit.wgsl"),
        ];
        let groups = [&forward.globals_layout, shadows.bind_group_layout()];
        let lit = (text.join("\n"), ["vs_blade", "fs_blade"]);
        let lit = lit_pipeline(gpu, format, lit, &groups, &[Some(LAYOUT)]);
        let now: Vec<Blade> = (0..COUNT).map(|number| blade(number, 0.0)).collect();
        Ok(Self {
            blades: gpu.buffer(&now, wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST),
            lit,
            caster: casts.then(|| shadows.add_own_caster(bounds_world())).transpose()?,
            view_layout: shadows.own_draw_layout().clone(),
            casting: Vec::new(),
        })
    }

    /// Sways.
    pub fn sway(&self, gpu: &Gpu, shadows: &mut Shadows, time_s: f32) -> Result<()> {
        let now: Vec<Blade> = (0..COUNT).map(|number| blade(number, time_s)).collect();
        gpu.queue.write_buffer(&self.blades, 0, bytemuck::cast_slice(&now));
        if let Some(caster) = self.caster {
            // In the same box, but otherwise: maps that hold it have to be drawn anew.
            shadows.move_own_caster(caster, bounds_world())?;
        }
        Ok(())
    }

    /// Draws it into a map: the closure of `Shadows::record_with`.
    pub fn cast(&mut self, device: &wgpu::Device, asked: &OwnDraw<'_>, pass: &mut wgpu::RenderPass<'_>) {
        let made = self.casting.iter().position(|(target, _)| *target == asked.target);
        let made = made.unwrap_or_else(|| {
            let pipeline = casting_pipeline(device, &self.view_layout, &asked.target);
            self.casting.push((asked.target.clone(), pipeline));
            self.casting.len() - 1
        });
        pass.set_pipeline(&self.casting[made].1);
        pass.set_vertex_buffer(0, self.blades.slice(..));
        pass.draw(0..3, 0..COUNT as u32);
    }

    /// Draws it into the picture, after what [`Forward::draw`] drew.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.lit);
        pass.set_vertex_buffer(0, self.blades.slice(..));
        pass.draw(0..3, 0..COUNT as u32);
    }
}

fn casting_pipeline(
    device: &wgpu::Device,
    view_layout: &wgpu::BindGroupLayout,
    target: &OwnTarget,
) -> wgpu::RenderPipeline {
    let text = [&caster_view_wgsl(), include_str!("blades.wgsl"), include_str!("cast.wgsl")].join("\n");
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("blades cast"),
        source: wgpu::ShaderSource::Wgsl(text.into()),
    });
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("blades cast"),
        bind_group_layouts: &[Some(view_layout)],
        immediate_size: 0,
    });
    let constants = [("UMBRAGE_CHANNELS", target.channels)];
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("blades cast"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vs"),
            compilation_options: Default::default(),
            buffers: &[Some(LAYOUT)],
        },
        primitive: Default::default(),
        depth_stencil: Some(target.depth_stencil.clone()),
        multisample: Default::default(),
        // Depth is all that is drawn, but for maps that keep distance in colours.
        fragment: target.color.is_some().then(|| wgpu::FragmentState {
            module: &module,
            entry_point: Some("fs_color"),
            compilation_options: wgpu::PipelineCompilationOptions {
                constants: &constants,
                ..Default::default()
            },
            targets: std::slice::from_ref(&target.color),
        }),
        multiview_mask: None,
        cache: None,
    })
}
