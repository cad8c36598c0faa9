//! Masks in somebody else's renderer: depth that runs either way, drawn by other arithmetic than the library's.

mod common;

use common::gpu;
use common::scenes::{cuboid, sheet};
use glam::{Mat4, UVec2, Vec3, Vec4};
use umbrage_render::Gpu;
use umbrage_render::umbrage::CasterPipelines;
use umbrage_render::umbrage::caster::{CasterStreams, CasterVertices};
use umbrage_render::umbrage::core::masks::Picture;
use umbrage_render::umbrage::core::technique::Settings;
use umbrage_render::umbrage::core::volume::light_point_world;
use umbrage_render::umbrage::core::{Aabb, Camera, DepthConvention, Light, LightKind, wgsl};
use umbrage_render::umbrage::mask::{
    Blocker, BlockerMasks, MaskPart, Receiver, SubtractDepth, SubtractPipelines, Subtraction, mask_range,
    masks_wgsl, record_subtract,
};
use umbrage_render::umbrage::volume::choose_count_format;
use umbrage_scene::Mesh;
use wgpu::util::DeviceExt;

const SIDE: u32 = 256;
const V_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R8Unorm;
/// Places far from the origin, so that arithmetic has something to round: 44 and 440 m.
const PLACES: [Vec3; 2] = [Vec3::new(37.3, 2.1, -23.7), Vec3::new(373.0, 2.1, -237.0)];

/// The other renderer's shader: V of one light, looked up inline.
const OWN: &str = "
struct Own {
    clip_from_world: mat4x4f,
    view_from_world: mat4x4f,
    clip_from_view: mat4x4f,
    eye: vec4f,
    light: vec4f,
    range: u32,
    by_view: u32,
    pad_0: u32,
    pad_1: u32,
}
@group(0) @binding(0) var<uniform> own: Own;

struct Seen {
    @builtin(position) @invariant position: vec4f,
    @location(0) p_world: vec3f,
    @location(1) @interpolate(flat) object: u32,
}

@vertex
fn vs(@location(0) p_object: vec3f, @location(1) x: vec4f, @location(2) y: vec4f, @location(3) z: vec4f,
    @builtin(instance_index) object: u32) -> Seen {
    let p = vec4f(p_object, 1.0);
    let p_world = vec3f(dot(x, p), dot(y, p), dot(z, p));
    if own.by_view == 1u {
        return Seen(own.clip_from_view * (own.view_from_world * vec4f(p_world, 1.0)), p_world, object);
    }
    return Seen(own.clip_from_world * vec4f(p_world, 1.0), p_world, object);
}

@fragment
fn fs(in: Seen) -> @location(0) vec4f {
    let across = cross(dpdx(in.p_world), dpdy(in.p_world));
    let to_eye = own.eye.xyz - in.p_world;
    let normal = select(-across, across, dot(across, to_eye) >= 0.0);
    let towards = own.light.xyz - in.p_world * own.light.w;
    let at = vec2u(in.position.xy);
    return vec4f(1.0 - umbrage_masks_coverage(own.range, at, in.object, in.p_world, normal, towards));
}
";

#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Own {
    matrices: [Mat4; 3],
    eye: Vec4,
    light: Vec4,
    numbers: [u32; 4],
}

/// Objects over a floor, each an instance of its number.
struct World {
    meshes: Vec<Mesh>,
    of_object: Vec<(usize, Mat4)>,
    buffers: Vec<(wgpu::Buffer, wgpu::Buffer)>,
    instances: wgpu::Buffer,
}

impl World {
    fn new(gpu: &Gpu, place: Vec3) -> Self {
        let meshes = vec![sheet(Vec3::ZERO, Vec3::X * 4.0, Vec3::NEG_Z * 4.0, 0), cuboid(Vec3::splat(0.5))];
        let turned = |at: Vec3, angle: f32| {
            Mat4::from_translation(place + at) * Mat4::from_axis_angle(Vec3::new(0.6, 0.8, 0.0), angle)
        };
        let of_object = vec![
            (0, Mat4::from_translation(place)),
            (1, turned(Vec3::new(-0.5, 0.9, 0.1), 0.3)),
            (1, turned(Vec3::new(0.4, 2.2, 0.3), 1.1)),
            (1, turned(Vec3::new(1.3, 0.8, -0.6), 2.0)),
        ];
        let buffer = |contents, usage| {
            gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
        };
        let buffers = meshes
            .iter()
            .map(|mesh| {
                (
                    buffer(bytemuck::cast_slice(&mesh.positions), wgpu::BufferUsages::VERTEX),
                    buffer(bytemuck::cast_slice(&mesh.indices), wgpu::BufferUsages::INDEX),
                )
            })
            .collect();
        let rows: Vec<[Vec4; 3]> = of_object.iter().map(|(_, m)| [m.row(0), m.row(1), m.row(2)]).collect();
        let instances = buffer(bytemuck::cast_slice(&rows), wgpu::BufferUsages::VERTEX);
        Self { meshes, of_object, buffers, instances }
    }

    fn bounds(&self, object: usize) -> Aabb {
        let (mesh, world_from_object) = &self.of_object[object];
        self.meshes[*mesh].bounds.transformed(world_from_object)
    }

    fn draw(&self, recorded: &mut wgpu::RenderPass<'_>, object: usize, instance: u32) {
        let mesh = self.of_object[object].0;
        recorded.set_vertex_buffer(0, self.buffers[mesh].0.slice(..));
        recorded.set_index_buffer(self.buffers[mesh].1.slice(..), wgpu::IndexFormat::Uint32);
        recorded.draw_indexed(0..self.meshes[mesh].indices.len() as u32, 0, instance..instance + 1);
    }
}

/// What is drawn, and how.
#[derive(Clone, Copy)]
struct Setup {
    convention: DepthConvention,
    by_view: bool,
    exact: bool,
    place: Vec3,
    light: Light,
    eye: Vec3,
}

fn masks_of(gpu: &Gpu, world: &World, setup: &Setup, picture: &Picture) -> BlockerMasks {
    let settings = Settings::new("mask-subtractive", [("mask_size", "64")]).expect("settings");
    let cut_out = CasterPipelines::cut_out_layout(&gpu.device);
    // Room for one, so that it has to grow.
    let mut masks =
        BlockerMasks::new(&gpu.device, &settings, 1, 1, &cut_out, &CasterVertices::default()).expect("masks");
    let objects = 0..world.of_object.len();
    let receivers = objects.clone().map(|i| Receiver { object: i as u32, bounds_world: world.bounds(i) });
    masks.begin(picture, 0.0, receivers);
    let whole = objects.fold(Aabb::EMPTY, |all, i| all.union(&world.bounds(i)));
    let parts: Vec<[MaskPart; 1]> = (1..world.of_object.len())
        .map(|i| {
            let (mesh, world_from_object) = world.of_object[i];
            [MaskPart { mesh: mesh as u32, version: 0, world_from_object, bounds_world: world.bounds(i) }]
        })
        .collect();
    let blockers = (1u32..).zip(&parts).map(|(object, parts)| Blocker { object, parts });
    let warnings = masks.tell(0, &setup.light, &settings, &whole, blockers).expect("told");
    assert!(warnings.is_empty(), "{warnings:?}");
    masks.finish(&gpu.device, &gpu.queue).expect("room");
    assert_eq!((masks.count(), masks.changes()), (3, 1));
    masks
}

fn read(gpu: &Gpu, texture: &wgpu::Texture) -> Vec<u8> {
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(SIDE * SIDE),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(SIDE),
                rows_per_image: None,
            },
        },
        texture.size(),
    );
    gpu.queue.submit([encoder.finish()]);
    buffer.map_async(wgpu::MapMode::Read, .., |result| result.expect("mapped"));
    gpu.device.poll(wgpu::PollType::Wait { submission_index: None, timeout: None }).expect("waited");
    buffer.get_mapped_range(..).expect("mapped").to_vec()
}

fn target(gpu: &Gpu, format: wgpu::TextureFormat) -> wgpu::Texture {
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width: SIDE, height: SIDE, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: if format == V_FORMAT {
            wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC
        } else {
            wgpu::TextureUsages::RENDER_ATTACHMENT
        },
        view_formats: &[],
    })
}

fn own_pipeline(gpu: &Gpu, setup: &Setup, format: wgpu::TextureFormat) -> wgpu::RenderPipeline {
    let text = wgsl::assemble(&["mask"]).expect("known") + &masks_wgsl(0, [3, 1, 2]) + OWN;
    let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(text.into()),
    });
    let nearer = match setup.convention {
        DepthConvention::Reversed => wgpu::CompareFunction::Greater,
        _ => wgpu::CompareFunction::Less,
    };
    gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: None,
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vs"),
            compilation_options: Default::default(),
            buffers: &[Some(CasterStreams::POSITIONS), Some(CasterStreams::INSTANCES)],
        },
        primitive: wgpu::PrimitiveState { cull_mode: Some(wgpu::Face::Back), ..Default::default() },
        depth_stencil: Some(wgpu::DepthStencilState {
            format,
            depth_write_enabled: Some(true),
            depth_compare: Some(nearer),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fs"),
            compilation_options: Default::default(),
            targets: &[Some(V_FORMAT.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// V, looked up inline and taken away from receivers.
fn both(gpu: &Gpu, setup: &Setup) -> [Vec<u8>; 2] {
    let device = &gpu.device;
    let world = World::new(gpu, setup.place);
    let camera = Camera::look_at(setup.eye, setup.place + Vec3::Y * 0.5, 0.9, 0.05, 200.0);
    let [clip_from_view, view_from_world] =
        [camera.clip_from_view(1.0, setup.convention), camera.view_from_world()];
    let clip_from_world = clip_from_view * view_from_world;
    let picture = Picture { clip_from_world, depth: setup.convention, size: UVec2::splat(SIDE) };
    let mut masks = masks_of(gpu, &world, setup, &picture);
    let format = choose_count_format(device);
    let depth = SubtractDepth {
        format,
        convention: setup.convention,
        exact: setup.exact,
        cull_mode: Some(wgpu::Face::Back),
    };
    let pipelines = SubtractPipelines::new(device, depth, V_FORMAT, &CasterVertices::default());
    let mut subtraction = Subtraction::new(device, pipelines, &masks);
    let eye = setup.eye.extend(1.0);
    subtraction.write(device, &gpu.queue, &masks, eye, 0.0);

    let pipeline = own_pipeline(gpu, setup, format);
    let light = light_point_world(&setup.light);
    let numbers = [mask_range(&masks.of_light(0)), u32::from(setup.by_view), 0, 0];
    let own = Own { matrices: [clip_from_world, view_from_world, clip_from_view], eye, light, numbers };
    let own = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: None,
        contents: bytemuck::bytes_of(&own),
        usage: wgpu::BufferUsages::UNIFORM,
    });
    let (list, array, sampler) = masks.bindings();
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: own.as_entire_binding() },
            wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(array) },
            wgpu::BindGroupEntry { binding: 2, resource: wgpu::BindingResource::Sampler(sampler) },
            wgpu::BindGroupEntry { binding: 3, resource: list.as_entire_binding() },
        ],
    });
    let [inline, subtracted] = [target(gpu, V_FORMAT), target(gpu, V_FORMAT)];
    let [inline_view, v] = [&inline, &subtracted].map(|texture| texture.create_view(&Default::default()));
    let depth = target(gpu, format).create_view(&Default::default());
    let mut encoder = device.create_command_encoder(&Default::default());
    let drawn = masks.pipelines().clone();
    let done = masks.record(
        &mut encoder,
        false,
        |_| None,
        |recorded, _, mask| {
            recorded.set_pipeline(&drawn.solid);
            world.draw(recorded, mask.object as usize, mask.first_instance);
        },
    );
    assert_eq!((done, masks.stale(false).count()), (3, 0), "all are drawn, and hold then what they should");
    {
        let mut recorded = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: None,
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &inline_view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::WHITE),
                    store: wgpu::StoreOp::Store,
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(setup.convention.clear()),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(0),
                    store: wgpu::StoreOp::Store,
                }),
            }),
            ..Default::default()
        });
        recorded.set_pipeline(&pipeline);
        recorded.set_bind_group(0, &group, &[]);
        recorded.set_vertex_buffer(1, world.instances.slice(..));
        (0..world.of_object.len()).for_each(|object| world.draw(&mut recorded, object, object as u32));
    }
    record_subtract(&mut encoder, &depth, &v, None, |recorded| {
        recorded.set_vertex_buffer(1, world.instances.slice(..));
        subtraction.draw(recorded, &masks, 0, |recorded, mask| {
            for object in (0..world.of_object.len()).filter(|object| *object as u32 != mask.object) {
                world.draw(recorded, object, object as u32);
            }
        });
    });
    gpu.queue.submit([encoder.finish()]);
    gpu.check().expect("no error of the device");
    [read(gpu, &inline), read(gpu, &subtracted)]
}

/// Pixels that differ by more than two steps of eight bits, and those that are dark inline.
fn compared([inline, subtracted]: &[Vec<u8>; 2]) -> [usize; 2] {
    let off = inline.iter().zip(subtracted).filter(|(a, b)| a.abs_diff(**b) > 2).count();
    [off, inline.iter().filter(|v| **v < 128).count()]
}

/// Of each kind of light and three eyes, at each place.
fn setups(convention: DepthConvention) -> impl Iterator<Item = Setup> {
    let of = move |place: Vec3, kind: usize, eye: Vec3| {
        let spot = Light::spot(place + Vec3::new(-1.2, 6.0, 1.0), place, 0.6, 0.7);
        let light = match kind {
            0 => spot,
            1 => Light { kind: LightKind::Point, ..spot },
            _ => Light { kind: LightKind::Directional, near_m: None, far_m: None, ..spot },
        };
        Setup { convention, by_view: false, exact: true, place, light, eye: place + eye }
    };
    let eyes = [Vec3::new(2.0, 3.5, 4.5), Vec3::new(-3.7, 0.6, 1.9), Vec3::new(20.0, 14.0, 31.0)];
    PLACES.into_iter().flat_map(move |place| {
        (0..3).flat_map(move |kind| eyes.into_iter().map(move |eye| of(place, kind, eye)))
    })
}

/// Depth of the same arithmetic is equal to the last bit, whichever way it runs.
#[test]
fn exact_depth_darkens_what_the_inline_lookup_darkens() {
    let Some(gpu) = gpu() else { return };
    for convention in [DepthConvention::Reversed, DepthConvention::ZeroToOne] {
        for setup in setups(convention) {
            let [off, dark] = compared(&both(&gpu, &setup));
            println!("{convention:?} {:?} {}: {off} off, {dark} dark", setup.light.kind, setup.place);
            assert!(off == 0 && dark > 50, "{convention:?} {:?}: {off} off, {dark} dark", setup.light.kind);
        }
    }
}

/// Depth of other arithmetic is some steps off; where silhouettes are cut at another place a pixel may differ.
#[test]
fn inexact_depth_darkens_what_the_inline_lookup_darkens() {
    let Some(gpu) = gpu() else { return };
    let mut missed = 0;
    for convention in [DepthConvention::Reversed, DepthConvention::ZeroToOne] {
        for setup in setups(convention) {
            for by_view in [false, true] {
                let setup = Setup { by_view, exact: false, ..setup };
                let [off, dark] = compared(&both(&gpu, &setup));
                let what = format!("{convention:?} {:?} {} {by_view}", setup.light.kind, setup.place);
                println!("{what}: {off} off, {dark} dark");
                assert!(off <= 4 && dark > 50, "{what}: {off} off, {dark} dark");
            }
            // The negative control: asked for equal depth, other arithmetic misses most of the shadow.
            missed += compared(&both(&gpu, &Setup { by_view: true, ..setup }))[0];
        }
    }
    println!("{missed} pixels are missed where equal depth is asked for");
    assert!(missed > 10_000, "{missed}");
}
