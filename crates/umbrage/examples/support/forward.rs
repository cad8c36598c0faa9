//! A forward renderer for examples that are about something else: `hello_shadow` shows how one comes to its first shadow.

use super::shapes::{Shape, Vertex};
use super::{Gpu, Result, Target};
use glam::{Mat4, Vec3, Vec4};
use umbrage::core::{Aabb, Light, LightKind};
use umbrage::{CasterMesh, MeshHandle, Shadows};

pub const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// As many as `forward.wgsl` has room for.
const MOST_LAMPS: usize = 64;

/// A mesh on the GPU, and as what it casts.
pub struct Mesh {
    pub vertices: wgpu::Buffer,
    pub indices: wgpu::Buffer,
    pub count: u32,
    pub caster: MeshHandle,
}

impl Mesh {
    pub fn new(gpu: &Gpu, shadows: &mut Shadows, shape: &Shape) -> Result<Self> {
        let count = shape.indices.len() as u32;
        let usage = wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST;
        let vertices = gpu.buffer(&shape.vertices, usage);
        let indices = gpu.buffer(&shape.indices, wgpu::BufferUsages::INDEX);
        let bounds = Aabb::from_points(shape.places());
        let mesh = CasterMesh::new(&vertices, 0..shape.vertices.len() as u32, bounds)
            .interleaved(0, size_of::<Vertex>() as u64)
            .indexed(&indices, wgpu::IndexFormat::Uint32, 0..count);
        let caster = shadows.add_mesh(&mesh)?;
        Ok(Self { vertices, indices, count, caster })
    }
}

/// A thing in the world, as the vertex shader reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Placed {
    pub world_from_object: Mat4,
    pub color: Vec4,
}

impl Placed {
    pub fn new(world_from_object: Mat4, color: [f32; 3]) -> Self {
        Self { world_from_object, color: Vec3::from(color).extend(1.0) }
    }
}

/// Mirrors `Lamp` of `forward.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Lamp {
    place: Vec4,
    beam: Vec4,
    color: Vec4,
    number: [u32; 4],
}

impl Lamp {
    fn new(number: u32, light: &Light) -> Self {
        let color = light.color * light.intensity;
        let (place, [inner, outer]) = match light.kind {
            LightKind::Directional => (-light.direction_world * 1e4, [-2.0, -3.0]),
            LightKind::Point => (light.position_world, [-2.0, -3.0]),
            LightKind::Spot { inner_rad, outer_rad } => {
                (light.position_world, [inner_rad.cos(), outer_rad.cos()])
            }
        };
        let range_m = if light.kind == LightKind::Directional { 0.0 } else { light.range_m.unwrap_or(1e4) };
        Self {
            place: place.extend(range_m),
            beam: light.direction_world.extend(outer),
            color: color.extend(inner),
            number: [number, 0, 0, 0],
        }
    }
}

/// Mirrors `Globals` of `forward.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Globals {
    clip_from_world: Mat4,
    ambient: Vec3,
    count: u32,
    lamps: [Lamp; MOST_LAMPS],
}

/// The renderer.
pub struct Forward {
    pub globals_layout: wgpu::BindGroupLayout,
    pipeline: wgpu::RenderPipeline,
    globals: wgpu::Buffer,
    pub group: wgpu::BindGroup,
    placed: wgpu::Buffer,
    depth: Option<wgpu::Texture>,
}

impl Forward {
    /// For at most so many things.
    pub fn new(gpu: &Gpu, format: wgpu::TextureFormat, shadows: &Shadows, things: usize) -> Self {
        let device = &gpu.device;
        let globals_layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
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
        });
        let room = |size: usize, usage| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size: size as u64,
                usage: usage | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let globals = room(size_of::<Globals>(), wgpu::BufferUsages::UNIFORM);
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("globals"),
            layout: &globals_layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: globals.as_entire_binding() }],
        });
        let placed = room(things * size_of::<Placed>(), wgpu::BufferUsages::VERTEX);
        let pipeline = Self::pipeline(gpu, format, &globals_layout, shadows);
        Self { globals_layout, pipeline, globals, group, placed, depth: None }
    }

    fn pipeline(
        gpu: &Gpu,
        format: wgpu::TextureFormat,
        globals: &wgpu::BindGroupLayout,
        shadows: &Shadows,
    ) -> wgpu::RenderPipeline {
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
        let text = shadows.wgsl(1) + include_str!("forward.wgsl");
        let layouts = [globals, shadows.bind_group_layout()];
        lit_pipeline(gpu, format, (text, ["vs", "fs"]), &layouts, &[Some(corner), Some(placed)])
    }

    /// Says what the next pass shows: the camera and the lights, each with its number in the shader.
    pub fn show(&self, gpu: &Gpu, clip_from_world: Mat4, ambient: f32, lights: &[(u32, Light)]) {
        let mut globals: Globals = bytemuck::Zeroable::zeroed();
        globals.clip_from_world = clip_from_world;
        globals.ambient = Vec3::splat(ambient);
        globals.count = lights.len().min(MOST_LAMPS) as u32;
        for (lamp, (number, light)) in globals.lamps.iter_mut().zip(lights) {
            *lamp = Lamp::new(*number, light);
        }
        gpu.queue.write_buffer(&self.globals, 0, bytemuck::bytes_of(&globals));
    }

    /// Says where things are.
    pub fn place(&self, gpu: &Gpu, things: &[Placed]) {
        gpu.queue.write_buffer(&self.placed, 0, bytemuck::cast_slice(things));
    }

    /// Begins the pass that draws the picture.
    pub fn begin<'a>(
        &mut self,
        gpu: &Gpu,
        encoder: &'a mut wgpu::CommandEncoder,
        target: &Target<'_>,
        load: wgpu::LoadOp<wgpu::Color>,
    ) -> wgpu::RenderPass<'a> {
        if self.depth.as_ref().is_some_and(|depth| [depth.width(), depth.height()] != target.size_px) {
            self.depth = None;
        }
        let make = || gpu.texture(target.size_px, DEPTH_FORMAT, wgpu::TextureUsages::empty());
        let depth = self.depth.get_or_insert_with(make).create_view(&Default::default());
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("forward"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: target.view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
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

    /// Draws things: of each mesh that many, in the order of [`Forward::place`].
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>, shadows: &Shadows, meshes: &[(&Mesh, u32)]) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.group, &[]);
        pass.set_bind_group(1, shadows.bind_group(), &[]);
        pass.set_vertex_buffer(1, self.placed.slice(..));
        let mut first = 0;
        for (mesh, count) in meshes {
            pass.set_vertex_buffer(0, mesh.vertices.slice(..));
            pass.set_index_buffer(mesh.indices.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..mesh.count, 0, first..first + count);
            first += count;
        }
    }
}

/// A pipeline of the forward pass: its text, and the entry points of vertices and pixels.
pub fn lit_pipeline(
    gpu: &Gpu,
    format: wgpu::TextureFormat,
    (wgsl, [vertex, pixel]): (String, [&str; 2]),
    groups: &[&wgpu::BindGroupLayout],
    buffers: &[Option<wgpu::VertexBufferLayout<'_>>],
) -> wgpu::RenderPipeline {
    let device = &gpu.device;
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("forward"),
        source: wgpu::ShaderSource::Wgsl(wgsl.into()),
    });
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("forward"),
        bind_group_layouts: &groups.iter().map(|group| Some(*group)).collect::<Vec<_>>(),
        immediate_size: 0,
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("forward"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some(vertex),
            compilation_options: Default::default(),
            buffers,
        },
        primitive: Default::default(),
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
            entry_point: Some(pixel),
            compilation_options: Default::default(),
            targets: &[Some(format.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}
