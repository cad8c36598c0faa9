//! A small forward renderer with everything of its own: vertices, camera, shader, one sun. To it one shadow is added: by the
//! lines that end with a mark. Without them it is a renderer that works. A test counts them.
//!
//! `cargo run -p umbrage --example hello_shadow`, or `-- --headless OUT.png`.

#[path = "../support/mod.rs"]
pub(crate) mod support;

use glam::camera::rh::{proj::directx::perspective, view::look_at_mat4};
use glam::{Mat4, Vec3, Vec4};
use support::shapes::{Shape, Vertex};
use support::{Example, Gpu, Result, Target};
use umbrage::core::{Aabb, Light}; // shadow
use umbrage::{CasterHandle, CasterMesh, Frame, Shadows, ShadowsOptions}; // shadow

fn main() -> std::process::ExitCode {
    support::run::<Hello>()
}

const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
const TO_SUN: Vec3 = Vec3::new(0.9, 1.0, -0.45);

/// A mesh on the GPU.
struct Mesh {
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    count: u32,
}

/// A thing in the world, as the vertex shader reads it.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Placed {
    world_from_object: Mat4,
    color: Vec4,
}

/// Mirrors `Globals` of `forward.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Globals {
    clip_from_world: Mat4,
    to_sun: Vec4,
}

/// The example.
pub struct Hello {
    pipeline: wgpu::RenderPipeline,
    globals: wgpu::Buffer,
    group: wgpu::BindGroup,
    meshes: Vec<Mesh>,
    /// Which mesh each thing is; the knot is the first, the ground the last.
    things: Vec<(usize, Placed)>,
    placed: wgpu::Buffer,
    depth: Option<wgpu::Texture>,
    shadows: Shadows,           // shadow
    casters: Vec<CasterHandle>, // shadow
}

fn thing(mesh: usize, world_from_object: Mat4, color: [f32; 3]) -> (usize, Placed) {
    (mesh, Placed { world_from_object, color: Vec3::from(color).extend(1.0) })
}

fn at(middle: Vec3, half: Vec3, turn_rad: f32) -> Mat4 {
    Mat4::from_translation(middle) * Mat4::from_rotation_y(turn_rad) * Mat4::from_scale(half)
}

fn knot_at(time_s: f32) -> Mat4 {
    at(Vec3::new(0.0, 1.55, 0.0), Vec3::ONE, 0.5 * time_s) * Mat4::from_rotation_x(1.2)
}

fn things() -> Vec<(usize, Placed)> {
    vec![
        thing(0, knot_at(0.0), [0.80, 0.36, 0.22]),
        thing(1, at(Vec3::new(-2.1, 0.6, 0.9), Vec3::new(0.35, 0.6, 0.35), 0.4), [0.28, 0.45, 0.70]),
        thing(1, at(Vec3::new(0.6, 0.25, -2.3), Vec3::new(0.9, 0.25, 0.3), -0.3), [0.35, 0.55, 0.35]),
        thing(2, at(Vec3::new(1.7, 0.5, 1.6), Vec3::splat(0.5), 0.0), [0.75, 0.70, 0.30]),
        thing(1, at(Vec3::NEG_Y * 0.1, Vec3::new(6.0, 0.1, 6.0), 0.0), [0.62, 0.60, 0.56]),
    ]
}

impl Example for Hello {
    const NAME: &'static str = "hello_shadow";

    fn new(gpu: &Gpu, format: wgpu::TextureFormat, plain: bool) -> Result<Self> {
        let mut shadows = Shadows::new(&gpu.device, &gpu.queue, ShadowsOptions::default())?; // shadow
        shadows.add_light(Light::sun(-TO_SUN))?; // shadow
        let things = things();
        let mut handles = Vec::new(); // shadow
        let mut meshes = Vec::new();
        for shape in [Shape::knot(0.22), Shape::cube(), Shape::ball()] {
            let count = shape.indices.len() as u32;
            let vertices = gpu.buffer(&shape.vertices, wgpu::BufferUsages::VERTEX);
            let indices = gpu.buffer(&shape.indices, wgpu::BufferUsages::INDEX);
            let bounds = Aabb::from_points(shape.places()); // shadow
            let mesh = CasterMesh::new(&vertices, 0..shape.vertices.len() as u32, bounds); // shadow
            let mesh = mesh.interleaved(0, size_of::<Vertex>() as u64); // shadow
            let mesh = mesh.indexed(&indices, wgpu::IndexFormat::Uint32, 0..count); // shadow
            handles.push(shadows.add_mesh(&mesh)?); // shadow
            meshes.push(Mesh { vertices, indices, count });
        }
        // All but the ground cast.
        let casting = if plain { 0 } else { things.len() - 1 }; // shadow
        let add = |(of, at): &(usize, Placed)| shadows.add_caster(handles[*of], at.world_from_object); // shadow
        let casters = things[..casting].iter().map(add).collect::<std::result::Result<_, _>>()?; // shadow
        let ground = Aabb { min: Vec3::new(-6.0, 0.0, -6.0), max: Vec3::new(6.0, 0.0, 6.0) }; // shadow
        shadows.add_receiver(ground)?; // shadow
        let placed: Vec<Placed> = things.iter().map(|(_, placed)| *placed).collect();
        let usage = wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST;
        let layout = globals_layout(&gpu.device);
        let globals = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("globals"),
            size: size_of::<Globals>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("globals"),
            layout: &layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: globals.as_entire_binding() }],
        });
        let pipeline = pipeline(
            &gpu.device,
            format,
            &layout,
            &shadows, // shadow
        );
        Ok(Self {
            pipeline,
            globals,
            group,
            meshes,
            placed: gpu.buffer(&placed, usage),
            things,
            depth: None,
            shadows, // shadow
            casters, // shadow
        })
    }

    fn draw(&mut self, gpu: &Gpu, target: &Target<'_>, time_s: f32) -> Result<()> {
        // The knot turns, and the camera walks around it.
        let (_, knot) = &mut self.things[0];
        knot.world_from_object = knot_at(time_s);
        gpu.queue.write_buffer(&self.placed, 0, bytemuck::bytes_of(knot));
        let turned = knot.world_from_object; // shadow
        let moved = self.casters.first().map(|knot| self.shadows.move_caster(*knot, turned)); // shadow
        moved.transpose()?; // shadow
        let around = 0.7 + 0.1 * time_s;
        let eye = Vec3::new(6.6 * around.sin(), 4.2, 6.6 * around.cos());
        let view_from_world = look_at_mat4(eye, Vec3::Y * 0.7, Vec3::Y);
        let clip_from_view = perspective(0.75, target.aspect(), 0.1, 50.0);
        let globals = Globals {
            clip_from_world: clip_from_view * view_from_world,
            to_sun: TO_SUN.normalize().extend(0.0),
        };
        gpu.queue.write_buffer(&self.globals, 0, bytemuck::bytes_of(&globals));
        self.shadows.prepare(&Frame::from_matrices(view_from_world, clip_from_view, target.size_px))?; // shadow

        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        self.shadows.record(&mut encoder)?; // shadow
        let mut pass = begin(gpu, &mut encoder, target, &mut self.depth);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.group, &[]);
        pass.set_bind_group(1, self.shadows.bind_group(), &[]); // shadow
        pass.set_vertex_buffer(1, self.placed.slice(..));
        for (number, (mesh, _)) in (0..).zip(&self.things) {
            let mesh = &self.meshes[*mesh];
            pass.set_vertex_buffer(0, mesh.vertices.slice(..));
            pass.set_index_buffer(mesh.indices.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..mesh.count, 0, number..number + 1);
        }
        drop(pass);
        gpu.queue.submit([encoder.finish()]);
        Ok(())
    }
}

fn globals_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("globals"),
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
    })
}

fn pipeline(
    device: &wgpu::Device,
    format: wgpu::TextureFormat,
    globals: &wgpu::BindGroupLayout,
    shadows: &Shadows, // shadow
) -> wgpu::RenderPipeline {
    let text = include_str!("forward.wgsl");
    let text = shadows.wgsl(1) + text; // shadow
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("forward"),
        source: wgpu::ShaderSource::Wgsl(text.into()),
    });
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("forward"),
        bind_group_layouts: &[
            Some(globals),
            Some(shadows.bind_group_layout()), // shadow
        ],
        immediate_size: 0,
    });
    let corner = wgpu::VertexBufferLayout {
        array_stride: size_of::<Vertex>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3],
    };
    let placed = wgpu::VertexBufferLayout {
        array_stride: size_of::<Placed>() as u64,
        step_mode: wgpu::VertexStepMode::Instance,
        attributes: &wgpu::vertex_attr_array![2 => Float32x4, 3 => Float32x4, 4 => Float32x4, 5 => Float32x4, 6 => Float32x4],
    };
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("forward"),
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
    })
}

/// Begins the pass that draws the picture; its depth is made anew when the picture has another size.
fn begin<'a>(
    gpu: &Gpu,
    encoder: &'a mut wgpu::CommandEncoder,
    target: &Target<'_>,
    depth: &mut Option<wgpu::Texture>,
) -> wgpu::RenderPass<'a> {
    if depth.as_ref().is_some_and(|depth| [depth.width(), depth.height()] != target.size_px) {
        *depth = None;
    }
    let depth = depth
        .get_or_insert_with(|| gpu.texture(target.size_px, DEPTH_FORMAT, wgpu::TextureUsages::empty()))
        .create_view(&Default::default());
    let sky = wgpu::Color { r: 0.02, g: 0.03, b: 0.05, a: 1.0 };
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("forward"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: target.view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(sky), store: wgpu::StoreOp::Store },
        })],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &depth,
            depth_ops: Some(wgpu::Operations {
                load: wgpu::LoadOp::Clear(1.0),
                store: wgpu::StoreOp::Discard,
            }),
            stencil_ops: None,
        }),
        ..Default::default()
    })
}
