//! A device, boxes that cast, points that ask how much of a light they see, and rays that know.

#![allow(dead_code, reason = "each test file uses a part of it")]

use glam::{Mat4, Vec3, Vec4};
use umbrage::core::{Aabb, Light, LightKind};
use umbrage::{CasterMesh, Frame, MeshHandle, Shadows};
use wgpu::util::DeviceExt;

pub struct Gpu {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
}

/// The software rasteriser, with default limits and no optional feature; a validation error panics. `None`, said loudly, where it is
/// missing; a failure where `UMBRAGE_GOLDEN_REQUIRED=1` says that it must not be.
pub fn gpu() -> Option<Gpu> {
    gpus().map(|[gpu, _]| gpu)
}

/// Two devices of one instance.
pub fn gpus() -> Option<[Gpu; 2]> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends: wgpu::Backends::PRIMARY,
        flags: wgpu::InstanceFlags::empty(),
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    let adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::PRIMARY));
    let found = adapters.into_iter().find(|adapter| adapter.get_info().name.contains("llvmpipe"));
    let Some(adapter) = found else {
        let required = std::env::var("UMBRAGE_GOLDEN_REQUIRED").is_ok_and(|v| v == "1");
        assert!(!required, "UMBRAGE_GOLDEN_REQUIRED=1, but there is no adapter llvmpipe");
        eprintln!("SKIPPED: there is no adapter llvmpipe");
        return None;
    };
    let make = || {
        let made = pollster::block_on(adapter.request_device(&Default::default()));
        let (device, queue) = made.expect("a device with default limits");
        Gpu { device, queue }
    };
    Some([make(), make()])
}

/// A cube from -1 to 1, wound to the outside.
pub fn cube() -> (Vec<Vec3>, Vec<u32>) {
    let corners = (0..8).map(|i| Vec3::new(side(i & 1), side(i & 2), side(i & 4))).collect();
    let indices = vec![
        0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1,
        7, 5,
    ];
    (corners, indices)
}

fn side(bit: i32) -> f32 {
    if bit == 0 { -1.0 } else { 1.0 }
}

pub struct CubeBuffers {
    pub positions: wgpu::Buffer,
    pub indices: wgpu::Buffer,
    pub shape: (Vec<Vec3>, Vec<u32>),
}

impl CubeBuffers {
    pub fn new(gpu: &Gpu) -> Self {
        let shape = cube();
        let make = |contents: &[u8], usage| {
            gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
        };
        Self {
            positions: make(bytemuck::cast_slice(&shape.0), wgpu::BufferUsages::VERTEX),
            indices: make(bytemuck::cast_slice(&shape.1), wgpu::BufferUsages::INDEX),
            shape,
        }
    }

    pub fn mesh(&self) -> CasterMesh<'_> {
        let bounds = Aabb { min: Vec3::NEG_ONE, max: Vec3::ONE };
        CasterMesh::new(&self.positions, 0..8, bounds)
            .indexed(&self.indices, wgpu::IndexFormat::Uint32, 0..36)
            .shape(&self.shape.0, &self.shape.1)
    }
}

pub fn add_cube(gpu: &Gpu, shadows: &mut Shadows) -> MeshHandle {
    shadows.add_mesh(&CubeBuffers::new(gpu).mesh()).expect("a mesh")
}

/// A box of half sizes around a middle.
pub fn placed(middle: Vec3, half: Vec3) -> Mat4 {
    Mat4::from_translation(middle) * Mat4::from_scale(half)
}

/// A box on the ground: an `Aabb` and the transform of the cube.
pub fn boxes(count: usize, seed: u32) -> Vec<(Vec3, Vec3)> {
    let mut state = seed.wrapping_mul(747_796_405).wrapping_add(1);
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1u32 << 24) as f32
    };
    (0..count)
        .map(|_| {
            let half = Vec3::new(0.15 + 0.4 * random(), 0.2 + 0.8 * random(), 0.15 + 0.4 * random());
            let at = Vec3::new(9.0 * random() - 4.5, half.y + 0.6 * random(), 9.0 * random() - 4.5);
            (at, half)
        })
        .collect()
}

pub fn ground() -> Aabb {
    Aabb { min: Vec3::new(-5.0, 0.0, -5.0), max: Vec3::new(5.0, 0.0, 5.0) }
}

pub fn sun() -> Light {
    Light { kind: LightKind::Directional, ..Light::default() }.aimed(Vec3::new(3.0, 5.0, 2.0), Vec3::ZERO)
}

pub fn spot() -> Light {
    Light::spot(Vec3::new(-3.0, 7.0, 4.0), Vec3::ZERO, 0.5, 0.7)
}

pub fn lamp() -> Light {
    Light { kind: LightKind::Point, position_world: Vec3::new(0.3, 3.5, -0.2), ..Light::default() }
}

pub fn frame() -> Frame {
    let camera = umbrage::core::Camera::look_at(Vec3::new(0.0, 6.0, 9.0), Vec3::ZERO, 0.9, 0.1, 60.0);
    Frame::from_camera(&camera, [320, 240], umbrage::core::DepthConvention::ZeroToOne)
}

/// The pixel of [`frame`] that shows a point.
pub fn pixel_of(p_world: Vec3) -> glam::Vec2 {
    let frame = frame();
    let clip = frame.clip_from_world() * p_world.extend(1.0);
    (clip.truncate().truncate() / clip.w * glam::Vec2::new(0.5, -0.5) + 0.5) * frame.size_px.as_vec2()
}

/// Those of some points that the eye of [`frame`] sees, moved onto the middle of their pixels.
pub fn seen_points(points: &[Vec3], boxes: &[(Vec3, Vec3)]) -> Vec<Vec3> {
    let frame = frame();
    let eye = frame.eye_world();
    let world_from_clip = frame.clip_from_world().inverse();
    let size = frame.size_px.as_vec2();
    let onto_middle = |p: &Vec3| {
        let pixel = pixel_of(*p).floor() + 0.5;
        let ndc = (pixel / size - 0.5) * glam::Vec2::new(2.0, -2.0);
        let through = world_from_clip.project_point3(ndc.extend(0.5));
        let way = through - eye;
        let on_ground = eye - way * (eye.y / way.y);
        let inside = pixel.cmpge(glam::Vec2::ZERO).all() && pixel.cmplt(size).all();
        let nothing_between = boxes.iter().all(|(middle, half)| {
            let near = (*middle - *half - eye) / (on_ground - eye);
            let far = (*middle + *half - eye) / (on_ground - eye);
            near.min(far).max_element().max(0.0) >= near.max(far).min_element().min(0.999)
        });
        (inside && nothing_between && on_ground.abs().max_element() < 4.8).then_some(on_ground)
    };
    points.iter().filter_map(onto_middle).collect()
}

/// A caller's own depth of the ground and boxes, drawn as renderers usually do: matrix by matrix, near 0 and far 1.
pub struct Depth {
    pub view: wgpu::TextureView,
    pipeline: wgpu::RenderPipeline,
    group: wgpu::BindGroup,
    instances: wgpu::Buffer,
    corners: wgpu::Buffer,
    count: u32,
}

impl Depth {
    pub fn new(gpu: &Gpu, format: wgpu::TextureFormat, boxes: &[(Vec3, Vec3)]) -> Self {
        let frame = frame();
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("the caller's depth"),
            size: wgpu::Extent3d {
                width: frame.size_px.x,
                height: frame.size_px.y,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: None,
            source: wgpu::ShaderSource::Wgsl(
                "struct Camera { view: mat4x4f, proj: mat4x4f }
                @group(0) @binding(0) var<uniform> camera: Camera;
                struct I { @location(1) a: vec4f, @location(2) b: vec4f, @location(3) c: vec4f, @location(4) d: vec4f }
                @vertex fn vs(@location(0) p: vec3f, i: I) -> @builtin(position) vec4f {
                    return camera.proj * (camera.view * (mat4x4f(i.a, i.b, i.c, i.d) * vec4f(p, 1.0)));
                }"
                .into(),
            ),
        });
        let pipeline = gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: None,
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: None,
                compilation_options: Default::default(),
                buffers: &[
                    Some(umbrage::CasterStreams::POSITIONS),
                    Some(wgpu::VertexBufferLayout {
                        array_stride: 64,
                        step_mode: wgpu::VertexStepMode::Instance,
                        attributes: &wgpu::vertex_attr_array![1 => Float32x4, 2 => Float32x4, 3 => Float32x4, 4 => Float32x4],
                    }),
                ],
            },
            primitive: Default::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::Less),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: Default::default(),
            fragment: None,
            multiview_mask: None,
            cache: None,
        });
        let make = |contents: &[u8], usage| {
            gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
        };
        let matrices = [frame.view_from_world, frame.clip_from_view];
        let camera = make(bytemuck::cast_slice(&matrices), wgpu::BufferUsages::UNIFORM);
        let (positions, indices) = cube();
        let corners: Vec<Vec3> = indices.iter().map(|i| positions[*i as usize]).collect();
        let flat = placed(Vec3::ZERO, Vec3::new(5.0, 0.0, 5.0));
        let all: Vec<Mat4> = boxes.iter().map(|(at, half)| placed(*at, *half)).chain([flat]).collect();
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: camera.as_entire_binding() }],
        });
        Self {
            view: texture.create_view(&Default::default()),
            pipeline,
            group,
            instances: make(bytemuck::cast_slice(&all), wgpu::BufferUsages::VERTEX),
            corners: make(bytemuck::cast_slice(&corners), wgpu::BufferUsages::VERTEX),
            count: all.len() as u32,
        }
    }

    pub fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("the caller's depth"),
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.view,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(0),
                    store: wgpu::StoreOp::Store,
                }),
            }),
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.group, &[]);
        pass.set_vertex_buffer(0, self.corners.slice(..));
        pass.set_vertex_buffer(1, self.instances.slice(..));
        pass.draw(0..36, 0..self.count);
    }
}

/// Points on the ground, a grid without any symmetry of the scene's.
pub fn points(across: u32) -> Vec<Vec3> {
    let at = |i: u32| 9.6 * ((i as f32 + 0.37) / across as f32) - 4.8;
    (0..across * across).map(|i| Vec3::new(at(i % across), 0.0, at(i / across))).collect()
}

/// Does a ray from `from` reach a light?
pub fn is_lit(from: Vec3, light: &Light, boxes: &[(Vec3, Vec3)]) -> bool {
    let way = match light.kind {
        LightKind::Directional => -light.direction_world.normalize() * 1e3,
        _ => light.position_world - from,
    };
    if let LightKind::Spot { outer_rad, .. } = light.kind {
        let along = (-way).normalize().dot(light.direction_world.normalize());
        if along < outer_rad.cos() {
            return false;
        }
    }
    boxes.iter().all(|(middle, half)| {
        let near = (*middle - *half - from) / way;
        let far = (*middle + *half - from) / way;
        let enters = near.min(far).max_element().max(1e-5);
        let leaves = near.max(far).min_element().min(1.0);
        enters >= leaves
    })
}

/// Is what rays say the same all around a point, so that no filter may say anything between?
pub fn is_sure(from: Vec3, light: &Light, boxes: &[(Vec3, Vec3)], reach_m: f32) -> bool {
    let here = is_lit(from, light, boxes);
    (0..16).all(|i| {
        let angle = i as f32 * std::f32::consts::TAU / 16.0;
        let aside = Vec3::new(angle.cos(), 0.0, angle.sin()) * reach_m * if i % 2 == 0 { 1.0 } else { 0.5 };
        is_lit(from + aside, light, boxes) == here
    })
}

/// V of a light at points with upward normals, as a compute shader asks for it.
pub struct Probe {
    pipeline: wgpu::ComputePipeline,
}

impl Probe {
    pub fn new(gpu: &Gpu, shadows: &Shadows) -> Self {
        let text = format!(
            "{}
struct Asked {{ p: vec3f, light: f32, pixel: vec4f }}
@group(0) @binding(0) var<storage, read> points: array<Asked>;
@group(0) @binding(1) var<storage, read_write> seen: array<vec4f>;
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {{
    if id.x < arrayLength(&points) {{
        let p = points[id.x];
        let light = u32(p.light);
        let rgb = umbrage_visibility_rgb(light, p.p, vec3f(0.0, 1.0, 0.0), p.pixel.xy);
        seen[id.x] = vec4f(rgb, umbrage_visibility(light, p.p, vec3f(0.0, 1.0, 0.0), p.pixel.xy));
    }}
}}",
            shadows.wgsl(1)
        );
        let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("probe"),
            source: wgpu::ShaderSource::Wgsl(text.into()),
        });
        let buffer = |read_only| wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Storage { read_only },
            has_dynamic_offset: false,
            min_binding_size: None,
        };
        let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty,
            count: None,
        };
        let own = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: None,
            entries: &[entry(0, buffer(true)), entry(1, buffer(false))],
        });
        let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &[Some(&own), Some(shadows.bind_group_layout())],
            immediate_size: 0,
        });
        let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("probe"),
            layout: Some(&layout),
            module: &module,
            entry_point: Some("main"),
            compilation_options: Default::default(),
            cache: None,
        });
        Self { pipeline }
    }

    /// After what `encoder` records already. Red, green, blue and their mean.
    pub fn ask(
        &self,
        gpu: &Gpu,
        mut encoder: wgpu::CommandEncoder,
        shadows: &Shadows,
        light: u32,
        points: &[Vec3],
    ) -> Vec<Vec4> {
        let asked: Vec<[Vec4; 2]> =
            points.iter().map(|p| [p.extend(light as f32), pixel_of(*p).extend(0.0).extend(0.0)]).collect();
        let count = points.len();
        let points = gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: None,
            contents: bytemuck::cast_slice(&asked),
            usage: wgpu::BufferUsages::STORAGE,
        });
        let make = |usage| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size: 16 * count as u64,
                usage,
                mapped_at_creation: false,
            })
        };
        let seen = make(wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
        let read = make(wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST);
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &self.pipeline.get_bind_group_layout(0),
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: points.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: seen.as_entire_binding() },
            ],
        });
        {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.set_bind_group(1, shadows.bind_group(), &[]);
            pass.dispatch_workgroups((asked.len() as u32).div_ceil(64), 1, 1);
        }
        encoder.copy_buffer_to_buffer(&seen, 0, &read, 0, 16 * asked.len() as u64);
        gpu.queue.submit([encoder.finish()]);
        read.map_async(wgpu::MapMode::Read, .., |result| result.expect("mapped"));
        gpu.device.poll(wgpu::PollType::wait_indefinitely()).expect("polled");
        let bytes = read.get_mapped_range(..).expect("a range");
        bytemuck::cast_slice(&bytes).to_vec()
    }

    /// The same with the screen's passes, over a depth.
    pub fn shoot_over(
        &self,
        gpu: &Gpu,
        shadows: &mut Shadows,
        depth: &Depth,
        light: u32,
        points: &[Vec3],
    ) -> Vec<Vec4> {
        shadows.prepare(&frame()).expect("prepared");
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        shadows.record(&mut encoder).expect("recorded");
        depth.record(&mut encoder);
        shadows.record_screen(&mut encoder, &depth.view).expect("recorded");
        self.ask(gpu, encoder, shadows, light, points)
    }

    /// What the visibility buffer says at the same points, and what inline lookup does.
    pub fn shoot_both(
        &self,
        gpu: &Gpu,
        shadows: &mut Shadows,
        depth: &Depth,
        light: u32,
        points: &[Vec3],
    ) -> (Vec<f32>, Vec<Vec4>) {
        let inline = self.shoot_over(gpu, shadows, depth, light, points);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        shadows.record_visibility(&mut encoder, &depth.view).expect("recorded");
        let texture = shadows.visibility().expect("V").texture().clone();
        let texel_bytes = texture.format().block_copy_size(None).expect("plain");
        let row = (texture.width() * texel_bytes).next_multiple_of(256);
        let read = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: u64::from(row * texture.height()),
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut from = texture.as_image_copy();
        from.origin.z = light;
        let layout =
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None };
        let size = wgpu::Extent3d { depth_or_array_layers: 1, ..texture.size() };
        encoder.copy_texture_to_buffer(from, wgpu::TexelCopyBufferInfo { buffer: &read, layout }, size);
        gpu.queue.submit([encoder.finish()]);
        read.map_async(wgpu::MapMode::Read, .., |result| result.expect("mapped"));
        gpu.device.poll(wgpu::PollType::wait_indefinitely()).expect("polled");
        let bytes = read.get_mapped_range(..).expect("a range");
        let at = |p: &Vec3| {
            let pixel = pixel_of(*p).as_uvec2();
            f32::from(bytes[(pixel.y * row + pixel.x * texel_bytes) as usize]) / 255.0
        };
        (points.iter().map(at).collect(), inline)
    }

    /// Prepares, records, and asks.
    pub fn shoot(&self, gpu: &Gpu, shadows: &mut Shadows, light: u32, points: &[Vec3]) -> Vec<Vec4> {
        shadows.prepare(&frame()).expect("prepared");
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        shadows.record(&mut encoder).expect("recorded");
        self.ask(gpu, encoder, shadows, light, points)
    }
}

/// How many points V and rays agree on: sure ones, and how many of them V is wrong at.
pub fn judge(
    seen: &[Vec4],
    points: &[Vec3],
    light: &Light,
    boxes: &[(Vec3, Vec3)],
    reach_m: f32,
) -> (usize, usize) {
    let sure = |p: &&(Vec3, f32)| is_sure(p.0, light, boxes, reach_m);
    let both: Vec<(Vec3, f32)> = points.iter().copied().zip(seen.iter().map(|v| v.w)).collect();
    let judged: Vec<_> = both.iter().filter(sure).collect();
    let wrong =
        judged.iter().filter(|(p, v)| (*v - f32::from(u8::from(is_lit(*p, light, boxes)))).abs() > 0.05);
    (judged.len(), wrong.count())
}
