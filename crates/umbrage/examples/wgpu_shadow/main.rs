//! The scene of wgpu's own example `shadow`, with shadows by Umbrage: a plane, four cubes that turn, two coloured lamps.
//!
//! After `examples/src/shadow` of <https://github.com/gfx-rs/wgpu> (MIT or Apache-2.0), commit 64a61ee5: its numbers, none of its text.
//! `docs/guide/wgpu-shadow.md` has both pictures and counts the lines of both.
//!
//! `cargo run -p umbrage --example wgpu_shadow`, or `-- --headless OUT.png`; `--plain`: without casters.

#[path = "../support/mod.rs"]
pub(crate) mod support;

use glam::camera::rh::{proj::directx::perspective, view::look_at_mat4};
use glam::{Mat4, Quat, Vec3, Vec4};
use std::f32::consts::FRAC_PI_4;
use support::{Example, Gpu, Result, Target};
use umbrage::core::{Aabb, Light};
use umbrage::{CasterHandle, CasterMesh, Frame, Shadows, ShadowsOptions};
use wgpu::BufferUsages as Usage;

fn main() -> std::process::ExitCode {
    support::run::<WgpuShadow>()
}

/// The example.
pub struct WgpuShadow {
    shadows: Shadows,
    casters: Vec<CasterHandle>,
    pipeline: wgpu::RenderPipeline,
    scene: wgpu::Buffer,
    group: wgpu::BindGroup,
    corners: wgpu::Buffer,
    indices: wgpu::Buffer,
    placed: wgpu::Buffer,
}

/// Mirrors `Scene` of `forward.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Scene {
    clip_from_world: Mat4,
    lamp_world: [Vec4; 2],
    lamp_color: [Vec4; 2],
}

#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Placed {
    color: Vec4,
    world_from_object: Mat4,
}

const LAMPS: [(Vec3, Vec3); 2] = [
    (Vec3::new(7.0, -5.0, 10.0), Vec3::new(0.5, 1.0, 0.5)),
    (Vec3::new(-5.0, 7.0, 10.0), Vec3::new(1.0, 0.5, 0.5)),
];

/// Corners of a cube, places and normals of 8 bits: the side that faces up first, which is the plane, too.
fn cube() -> Vec<[[i8; 4]; 2]> {
    let axes = [(Vec3::Z, Vec3::X), (Vec3::NEG_Z, Vec3::Y), (Vec3::X, Vec3::Y), (Vec3::NEG_X, Vec3::Z)];
    let sides = axes.into_iter().chain([(Vec3::Y, Vec3::Z), (Vec3::NEG_Y, Vec3::X)]);
    let bytes = |v: Vec3| (v * 127.0).extend(0.0).to_array().map(|x| x as i8);
    let corner = |(normal, right): (Vec3, Vec3), x, y| {
        [bytes(normal + x * right + y * normal.cross(right)), bytes(normal)]
    };
    let signs = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    sides.flat_map(|side| signs.map(|(x, y)| corner(side, x, y))).collect()
}

/// The plane, and the cubes after so many frames of a sixtieth of a second.
fn placed(frames: f32) -> Vec<Placed> {
    let plane = Mat4::from_translation(Vec3::NEG_Z) * Mat4::from_scale(Vec3::new(7.0, 7.0, 1.0));
    let mut placed = vec![Placed { color: Vec4::ONE, world_from_object: plane }];
    let cubes =
        [(-2.0, -2.0, 10.0, 0.7), (2.0, -2.0, 50.0, 1.3), (-2.0, 2.0, 140.0, 1.1), (2.0, 2.0, 210.0, 0.9)];
    for ((x, y, degrees, scale), speed) in cubes.into_iter().zip(1u8..) {
        let middle = Vec3::new(x, y, 2.0);
        let turned = Quat::from_axis_angle(middle.normalize(), f32::to_radians(degrees));
        let stands = Mat4::from_scale_rotation_translation(Vec3::splat(scale), turned, middle);
        let turns = Mat4::from_rotation_x((0.1 * f32::from(speed) * frames).to_radians());
        placed.push(Placed { color: Vec3::Y.extend(1.0), world_from_object: stands * turns });
    }
    placed
}

impl Example for WgpuShadow {
    const NAME: &'static str = "wgpu_shadow";

    fn new(gpu: &Gpu, format: wgpu::TextureFormat, plain: bool) -> Result<Self> {
        let mut shadows = Shadows::new(&gpu.device, &gpu.queue, ShadowsOptions::default())?;
        for (lamp_world, _) in LAMPS {
            // Wide enough for all of the plane: theirs shine outside of their maps, too.
            shadows.add_light(Light::spot(lamp_world, Vec3::ZERO, 0.0, 0.9))?;
        }
        let corners = gpu.buffer(&cube(), Usage::VERTEX);
        let indices: Vec<u16> = (0..6).flat_map(|side| [0, 1, 2, 2, 3, 0].map(|i| 4 * side + i)).collect();
        let indices = gpu.buffer(&indices, Usage::INDEX);
        let cube = CasterMesh::new(&corners, 0..24, Aabb { min: Vec3::NEG_ONE, max: Vec3::ONE })
            .interleaved(0, 8)
            .format(wgpu::VertexFormat::Snorm8x4)
            .indexed(&indices, wgpu::IndexFormat::Uint16, 0..36);
        let cube = shadows.add_mesh(&cube)?;
        let placed = placed(0.0);
        let casting = if plain { &[] } else { &placed[1..] };
        let casters = casting.iter().map(|placed| shadows.add_caster(cube, placed.world_from_object));
        let casters = casters.collect::<std::result::Result<_, _>>()?;
        shadows.add_receiver(Aabb { min: Vec3::new(-7.0, -7.0, 0.0), max: Vec3::new(7.0, 7.0, 0.0) })?;
        let scene = Scene {
            clip_from_world: Mat4::IDENTITY,
            lamp_world: LAMPS.map(|(place, _)| place.extend(1.0)),
            lamp_color: LAMPS.map(|(_, color)| color.extend(1.0)),
        };
        let scene = gpu.buffer(&[scene], Usage::UNIFORM | Usage::COPY_DST);
        let placed = gpu.buffer(&placed, Usage::VERTEX | Usage::COPY_DST);
        let (pipeline, group) = pipeline(gpu, format, &shadows, &scene);
        Ok(Self { shadows, casters, pipeline, scene, group, corners, indices, placed })
    }

    fn draw(&mut self, gpu: &Gpu, target: &Target<'_>, time_s: f32) -> Result<()> {
        let view_from_world = look_at_mat4(Vec3::new(3.0, -10.0, 6.0), Vec3::ZERO, Vec3::Z);
        let clip_from_view = perspective(FRAC_PI_4, target.aspect(), 1.0, 20.0);
        gpu.queue.write_buffer(&self.scene, 0, bytemuck::bytes_of(&(clip_from_view * view_from_world)));
        let placed = placed(60.0 * time_s);
        gpu.queue.write_buffer(&self.placed, 0, bytemuck::cast_slice(&placed));
        for (caster, placed) in self.casters.iter().zip(&placed[1..]) {
            self.shadows.move_caster(*caster, placed.world_from_object)?;
        }
        self.shadows.prepare(&Frame::from_matrices(view_from_world, clip_from_view, target.size_px))?;

        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        self.shadows.record(&mut encoder)?;
        // Anew for each frame, so that there is nothing to do when the window gets another size.
        let depth = gpu.texture(target.size_px, DEPTH_FORMAT, wgpu::TextureUsages::empty());
        let sky = wgpu::Color { r: 0.1, g: 0.2, b: 0.3, a: 1.0 };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: target.view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(sky), store: wgpu::StoreOp::Store },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &depth.create_view(&Default::default()),
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.group, &[]);
        pass.set_bind_group(1, self.shadows.bind_group(), &[]);
        pass.set_vertex_buffer(0, self.corners.slice(..));
        pass.set_vertex_buffer(1, self.placed.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint16);
        pass.draw_indexed(0..6, 0, 0..1);
        pass.draw_indexed(0..36, 0, 1..5);
        drop(pass);
        gpu.queue.submit([encoder.finish()]);
        Ok(())
    }
}

const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// The forward pass's pipeline, and its own bind group.
fn pipeline(
    gpu: &Gpu,
    format: wgpu::TextureFormat,
    shadows: &Shadows,
    scene: &wgpu::Buffer,
) -> (wgpu::RenderPipeline, wgpu::BindGroup) {
    let device = &gpu.device;
    let text = shadows.wgsl(1) + include_str!("forward.wgsl");
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(text.into()),
    });
    let scene_layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: None,
        entries: &[wgpu::BindGroupLayoutEntry {
            binding: 0,
            visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Uniform,
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        }],
    });
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &[Some(&scene_layout), Some(shadows.bind_group_layout())],
        immediate_size: 0,
    });
    let corner = wgpu::VertexBufferLayout {
        array_stride: 8,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &wgpu::vertex_attr_array![0 => Snorm8x4, 1 => Snorm8x4],
    };
    let placed = wgpu::VertexBufferLayout {
        array_stride: size_of::<Placed>() as u64,
        step_mode: wgpu::VertexStepMode::Instance,
        attributes: &wgpu::vertex_attr_array![2 => Float32x4, 3 => Float32x4, 4 => Float32x4, 5 => Float32x4, 6 => Float32x4],
    };
    let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: None,
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vs"),
            compilation_options: Default::default(),
            buffers: &[Some(corner), Some(placed)],
        },
        primitive: wgpu::PrimitiveState { cull_mode: Some(wgpu::Face::Back), ..Default::default() },
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Less),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fs"),
            compilation_options: Default::default(),
            targets: &[Some(format.into())],
        }),
        multiview_mask: None,
        cache: None,
    });
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &scene_layout,
        entries: &[wgpu::BindGroupEntry { binding: 0, resource: scene.as_entire_binding() }],
    });
    (pipeline, group)
}
