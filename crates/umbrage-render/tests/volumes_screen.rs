//! Volumes over somebody else's depth: drawn here with passes of the test's own, in both conventions of depth.

mod common;

use common::gpu;
use common::volumes::{ALL, cuboid};
use glam::{Mat4, Quat, UVec2, Vec3, Vec4};
use umbrage_render::Gpu;
use umbrage_render::umbrage::core::projection::{orthographic, perspective};
use umbrage_render::umbrage::core::technique::Settings;
use umbrage_render::umbrage::core::{Aabb, Camera, DepthConvention, Light, LightKind};
use umbrage_render::umbrage::volume::{
    ScreenVolumes, VolumeEye, VolumeItem, VolumeProblem, VolumeSettings, choose_count_format,
};
use wgpu::util::DeviceExt;

const SIDE: u32 = 256;
const V: wgpu::TextureFormat = wgpu::TextureFormat::R8Unorm;
const BOTH: [DepthConvention; 2] = [DepthConvention::Reversed, DepthConvention::ZeroToOne];

const SURFACES: &str = "
struct Object { clip_from_world: mat4x4f, row_x: vec4f, row_y: vec4f, row_z: vec4f }
@group(0) @binding(0) var<uniform> object: Object;
struct Drawn { @builtin(position) @invariant position: vec4f }
@vertex fn vs(@location(0) p_object: vec3f) -> Drawn {
    let p = vec4f(p_object, 1.0);
    let p_world = vec3f(dot(object.row_x, p), dot(object.row_y, p), dot(object.row_z, p));
    return Drawn(object.clip_from_world * vec4f(p_world, 1.0));
}";

/// An object of the little world: a mesh, where it is, and whether it throws shadows.
#[derive(Clone, Debug)]
struct Object {
    mesh: usize,
    world_from_object: Mat4,
    casts: bool,
}

/// All that can move.
#[derive(Clone, Debug)]
struct World {
    meshes: Vec<(Vec<Vec3>, Vec<u32>)>,
    objects: Vec<Object>,
    lights: Vec<(Light, VolumeSettings)>,
    camera: Camera,
    /// Metres; infinite: no far plane.
    far_m: f32,
}

impl World {
    fn bounds(&self, object: &Object) -> Aabb {
        let corners = self.meshes[object.mesh].0.iter().copied();
        Aabb::from_points(corners).transformed(&object.world_from_object)
    }

    fn whole(&self) -> Aabb {
        self.objects.iter().fold(Aabb::EMPTY, |all, object| all.union(&self.bounds(object)))
    }

    fn eye(&self, depth: DepthConvention, is_parallel: bool) -> VolumeEye {
        let clip_from_view = if is_parallel {
            orthographic(3.0, 3.0, 0.1, self.far_m, depth)
        } else {
            perspective(0.6, 0.6, 0.1, self.far_m, depth)
        };
        VolumeEye {
            clip_from_world: clip_from_view * self.camera.view_from_world(),
            clip_from_view,
            size_px: UVec2::splat(SIDE),
            is_parallel,
        }
    }
}

fn settings(pairs: &[(&str, &str)]) -> VolumeSettings {
    let settings = Settings::new("volume", pairs.iter().copied()).expect("settings");
    VolumeSettings::of(&settings).expect("a volume")
}

fn sun(direction: Vec3) -> Light {
    Light {
        kind: LightKind::Directional,
        near_m: None,
        far_m: None,
        ..Light::spot(Vec3::ZERO, direction, 0.4, 0.6)
    }
}

/// A floor, a closed box, an open one, and a mirrored one; a spot and a sun.
fn world() -> World {
    let of = |half: Vec3, faces: &[usize]| {
        let mesh = cuboid(half, faces);
        (mesh.positions, mesh.indices)
    };
    let at = |p: Vec3, angle: f32| {
        Mat4::from_rotation_translation(Quat::from_axis_angle(Vec3::new(0.6, 0.8, 0.0), angle), p)
    };
    let object = |mesh, world_from_object, casts| Object { mesh, world_from_object, casts };
    World {
        meshes: vec![
            of(Vec3::new(4.0, 0.05, 4.0), &ALL),
            of(Vec3::splat(0.4), &ALL),
            of(Vec3::new(0.5, 0.3, 0.4), &[0, 1, 2, 4, 5]),
        ],
        objects: vec![
            object(0, Mat4::from_translation(Vec3::NEG_Y * 0.05), false),
            object(1, at(Vec3::new(-0.9, 0.9, 0.3), 0.7), true),
            object(2, at(Vec3::new(0.8, 0.8, -0.4), 1.3), true),
            object(1, at(Vec3::new(0.2, 1.5, 1.0), 2.1) * Mat4::from_scale(Vec3::new(-0.7, 0.5, 0.9)), true),
        ],
        lights: vec![
            (Light::spot(Vec3::new(1.5, 5.0, 1.0), Vec3::ZERO, 0.5, 0.7), settings(&[])),
            (sun(Vec3::new(0.4, -1.0, 0.3)), settings(&[("silhouette", "vertex")])),
        ],
        camera: Camera::look_at(Vec3::new(2.5, 3.5, 5.0), Vec3::new(0.0, 0.3, 0.0), 0.8, 0.1, 50.0),
        far_m: f32::INFINITY,
    }
}

/// Somebody else's renderer: depth alone.
struct Rig<'a> {
    gpu: &'a Gpu,
    depth: DepthConvention,
    pipeline: wgpu::RenderPipeline,
    depth_texture: wgpu::Texture,
    depth_stencil: wgpu::TextureView,
    depth_only: wgpu::TextureView,
    v: Vec<(wgpu::Texture, wgpu::TextureView)>,
    screen: ScreenVolumes,
    is_parallel: bool,
}

fn buffer(gpu: &Gpu, contents: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
    gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
}

fn surfaces(gpu: &Gpu, depth: DepthConvention, format: wgpu::TextureFormat) -> wgpu::RenderPipeline {
    let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(SURFACES.into()),
    });
    let nearer =
        if depth.is_reversed() { wgpu::CompareFunction::Greater } else { wgpu::CompareFunction::Less };
    gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: None,
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: None,
            compilation_options: Default::default(),
            buffers: &[Some(wgpu::VertexBufferLayout {
                array_stride: 12,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes: &wgpu::vertex_attr_array![0 => Float32x3],
            })],
        },
        primitive: Default::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format,
            depth_write_enabled: Some(true),
            depth_compare: Some(nearer),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: None,
        multiview_mask: None,
        cache: None,
    })
}

impl<'a> Rig<'a> {
    fn new(gpu: &'a Gpu, world: &World, depth: DepthConvention) -> Self {
        let format = choose_count_format(&gpu.device);
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: SIDE, height: SIDE, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                | wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let depth_only = texture.create_view(&wgpu::TextureViewDescriptor {
            aspect: wgpu::TextureAspect::DepthOnly,
            ..Default::default()
        });
        let mut screen = ScreenVolumes::new(&gpu.device, &gpu.queue, format, depth, V).expect("a stencil");
        for (index, (positions, indices)) in world.meshes.iter().enumerate() {
            screen.set_mesh(index, positions, indices).expect("a mesh that fits");
        }
        Self {
            gpu,
            depth,
            pipeline: surfaces(gpu, depth, format),
            depth_stencil: texture.create_view(&Default::default()),
            depth_texture: texture,
            depth_only,
            v: (0..2).map(|_| target(gpu)).collect(),
            screen,
            is_parallel: false,
        }
    }

    fn tell(&mut self, world: &World) {
        let whole = world.whole();
        self.screen.begin(&world.eye(self.depth, self.is_parallel));
        for (slot, (light, settings)) in world.lights.iter().enumerate() {
            let casters = world.objects.iter().filter(|object| object.casts).map(|object| VolumeItem {
                mesh: object.mesh,
                world_from_object: object.world_from_object,
                bounds_world: world.bounds(object),
            });
            self.screen.tell(slot, light, settings, &whole, casters);
        }
    }

    /// V of each light, rows from the top.
    fn frame(&mut self, world: &World) -> Vec<Vec<u8>> {
        self.tell(world);
        let clip_from_world = world.eye(self.depth, self.is_parallel).clip_from_world;
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        let made: Vec<_> =
            world.objects.iter().map(|object| self.upload(world, object, clip_from_world)).collect();
        {
            let mut recorded = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: None,
                color_attachments: &[],
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: &self.depth_stencil,
                    depth_ops: Some(wgpu::Operations {
                        load: wgpu::LoadOp::Clear(self.depth.clear()),
                        store: wgpu::StoreOp::Store,
                    }),
                    stencil_ops: None,
                }),
                timestamp_writes: None,
                occlusion_query_set: None,
                multiview_mask: None,
            });
            recorded.set_pipeline(&self.pipeline);
            for (group, vertices, indices) in &made {
                recorded.set_bind_group(0, group, &[]);
                recorded.set_vertex_buffer(0, vertices.slice(..));
                recorded.set_index_buffer(indices.slice(..), wgpu::IndexFormat::Uint32);
                recorded.draw_indexed(0..(indices.size() / 4) as u32, 0, 0..1);
            }
        }
        let v = &self.v;
        let (depth_stencil, depth_only) = (&self.depth_stencil, Some(&self.depth_only));
        self.screen.record(&mut encoder, depth_stencil, depth_only, |slot| Some(&v.get(slot)?.1), &mut ());
        self.gpu.queue.submit([encoder.finish()]);
        self.v
            .iter()
            .take(world.lights.len())
            .map(|(texture, _)| read(self.gpu, texture, wgpu::TextureAspect::All))
            .collect()
    }

    /// Where there is a surface.
    fn covered(&self) -> Vec<bool> {
        let bytes = read(self.gpu, &self.depth_texture, wgpu::TextureAspect::DepthOnly);
        let stored = |b: &[u8]| f32::from_le_bytes([b[0], b[1], b[2], b[3]]);
        bytes.chunks_exact(4).map(|b| stored(b) != self.depth.clear()).collect()
    }

    fn upload(
        &self,
        world: &World,
        object: &Object,
        clip_from_world: Mat4,
    ) -> (wgpu::BindGroup, wgpu::Buffer, wgpu::Buffer) {
        let m = &object.world_from_object;
        let rows: [Vec4; 7] = [
            clip_from_world.x_axis,
            clip_from_world.y_axis,
            clip_from_world.z_axis,
            clip_from_world.w_axis,
            m.row(0),
            m.row(1),
            m.row(2),
        ];
        let uniform = buffer(self.gpu, bytemuck::cast_slice(&rows), wgpu::BufferUsages::UNIFORM);
        let group = self.gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &self.pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() }],
        });
        let (positions, indices) = &world.meshes[object.mesh];
        let vertices = buffer(self.gpu, bytemuck::cast_slice(positions), wgpu::BufferUsages::VERTEX);
        (group, vertices, buffer(self.gpu, bytemuck::cast_slice(indices), wgpu::BufferUsages::INDEX))
    }
}

fn target(gpu: &Gpu) -> (wgpu::Texture, wgpu::TextureView) {
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width: SIDE, height: SIDE, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: V,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT
            | wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    let view = texture.create_view(&Default::default());
    (texture, view)
}

/// A row has a multiple of 256 bytes, as copies need them.
fn read(gpu: &Gpu, texture: &wgpu::Texture, aspect: wgpu::TextureAspect) -> Vec<u8> {
    let row = SIDE * texture.format().block_copy_size(Some(aspect)).expect("one plane");
    let out = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(row * SIDE),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let layout =
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: Some(SIDE) };
    encoder.copy_texture_to_buffer(
        wgpu::TexelCopyTextureInfo { aspect, ..texture.as_image_copy() },
        wgpu::TexelCopyBufferInfo { buffer: &out, layout },
        texture.size(),
    );
    gpu.queue.submit([encoder.finish()]);
    out.map_async(wgpu::MapMode::Read, .., |mapped| mapped.expect("mapped"));
    gpu.device.poll(wgpu::PollType::Wait { submission_index: None, timeout: None }).expect("a device");
    out.get_mapped_range(..).expect("mapped").to_vec()
}

fn differing(a: &[u8], b: &[u8]) -> usize {
    a.iter().zip(b).filter(|(a, b)| a.abs_diff(**b) > 40).count()
}

fn dark(v: &[u8]) -> usize {
    v.iter().filter(|v| **v < 128).count()
}

const CHOICES: [&[(&str, &str)]; 7] = [
    &[],
    &[("counting", "depth-fail")],
    &[("counting", "depth-pass")],
    &[("silhouette", "vertex"), ("counting", "depth-fail"), ("stencil", "two-pass")],
    &[("extrude_m", "2.5")],
    &[("inset_m", "0.01")],
    &[("soften", "blur"), ("soft_px", "9")],
];

#[test]
fn both_conventions_of_depth_have_the_same_shadows() {
    let Some(gpu) = gpu() else { return };
    let outside = world().camera;
    let inside = Camera::look_at(Vec3::new(0.35, 0.3, 1.1), Vec3::new(-1.0, 0.1, -3.0), 0.8, 0.1, 50.0);
    for (far_m, is_parallel, camera) in [
        (f32::INFINITY, false, outside),
        (f32::INFINITY, false, inside),
        (30.0, false, outside),
        (30.0, true, outside),
    ] {
        for choices in CHOICES {
            let mut world = World { camera, far_m, ..world() };
            world.lights.iter_mut().for_each(|(_, of_light)| *of_light = settings(choices));
            let [reversed, forward] = BOTH.map(|depth| {
                let mut rig = Rig::new(&gpu, &world, depth);
                rig.is_parallel = is_parallel;
                let v = rig.frame(&world);
                assert_eq!(rig.screen.problems(), [], "{depth:?} {choices:?}");
                v
            });
            for (light, (a, b)) in reversed.iter().zip(&forward).enumerate() {
                let (off, dark) = (differing(a, b), dark(a));
                println!("far {far_m} {choices:?} light {light}: {off} of {dark} dark pixels");
                assert!(dark > 1000 && dark < (SIDE * SIDE) as usize * 3 / 4, "{choices:?}: {dark}");
                assert!(off <= 20, "far {far_m} {choices:?} light {light}: {off} pixels differ");
            }
        }
    }
}

#[test]
fn a_far_plane_that_cuts_is_ended_before_or_told() {
    let Some(gpu) = gpu() else { return };
    let cut = Gpu::without(Some("llvmpipe"), wgpu::Features::DEPTH_CLIP_CONTROL).expect("a device");
    let mut world = world();
    world.camera = Camera::look_at(Vec3::new(0.5, 2.0, 6.5), Vec3::new(0.0, 0.3, 0.0), 0.8, 0.1, 50.0);
    let fail = settings(&[("counting", "depth-fail")]);
    // Away from the eye and low: all volumes reach far beyond a plane at 9 m, and so does the scene.
    world.lights = vec![(sun(Vec3::new(0.5, -0.7, -1.0)), fail)];
    world.far_m = 9.0;
    for depth in BOTH {
        let mut whole = Rig::new(&gpu, &world, depth);
        let truth = whole.frame(&world);
        let mut rig = Rig::new(&cut, &world, depth);
        let v = rig.frame(&world);
        let covered = rig.covered();
        assert!(covered == whole.covered());
        let on_surfaces = |v: &[u8]| v.iter().zip(&covered).filter(|(_, on)| **on).map(|(v, _)| *v).collect();
        let [v, truth]: [Vec<u8>; 2] = [&v[0], &truth[0]].map(|v| on_surfaces(v));
        let (off, lit) = (differing(&v, &truth), v.len() - dark(&truth));
        println!("{depth:?}: {off} of {} dark and {lit} lit pixels", dark(&truth));
        assert!(dark(&truth) > 500 && lit > 1000, "{depth:?}");
        assert!(rig.screen.problems().is_empty() && off <= 20, "{depth:?}: {off}");
        // A lamp between casters and far plane shines both ways; no end is behind all of its shadow.
        let lamp =
            Light { kind: LightKind::Point, ..Light::spot(Vec3::new(0.9, 0.8, -0.4), Vec3::NEG_Y, 0.5, 0.7) };
        let mut told = world.clone();
        told.lights = vec![(lamp, fail)];
        rig.frame(&told);
        assert_eq!(rig.screen.problems(), [VolumeProblem::CutByFarPlane { light: 0 }]);
        assert!(rig.screen.problems()[0].to_string().contains("without a far plane"));
        told.far_m = f32::INFINITY;
        rig.frame(&told);
        assert_eq!(rig.screen.problems(), []);
    }
}

/// Whatever moved, the picture is that of volumes that never knew anything else; and only what moved is found anew.
#[test]
fn what_is_kept_is_right_and_what_holds_is_kept() {
    let Some(gpu) = gpu() else { return };
    let mut world = world();
    let mut rig = Rig::new(&gpu, &world, DepthConvention::ZeroToOne);
    let mut found = 0;
    let mut check = |rig: &mut Rig<'_>, world: &World, expected: Option<u64>, what: &str| {
        let v = rig.frame(world);
        let fresh = Rig::new(&gpu, world, DepthConvention::ZeroToOne).frame(world);
        assert!(v == fresh, "{what}: not the picture of fresh volumes");
        let now = rig.screen.casters_found();
        assert!(expected.is_none_or(|expected| now - found == expected), "{what}: {} found", now - found);
        found = now;
    };
    // The sun's are split edges, of which none are found.
    check(&mut rig, &world, Some(3), "first");
    check(&mut rig, &world, Some(0), "nothing");
    assert!(rig.screen.passes().all(|pass| !pass.to_string().starts_with("silhouettes")));
    world.camera.position_world += Vec3::new(-1.0, 0.5, 0.2);
    check(&mut rig, &world, Some(0), "the eye");
    let step = Mat4::from_translation(Vec3::new(0.1, 0.05, -0.1));
    world.objects[2].world_from_object = step * world.objects[2].world_from_object;
    check(&mut rig, &world, Some(1), "one caster");
    world.objects[0].world_from_object = step * world.objects[0].world_from_object;
    check(&mut rig, &world, Some(0), "a receiver, and with it where volumes end");
    let bytes = rig.screen.memory_bytes();
    world.objects.swap(1, 2);
    check(&mut rig, &world, None, "another order");
    assert_eq!(rig.screen.memory_bytes(), bytes, "the same casters need no other buffers");
    let more =
        Object { world_from_object: step * step * world.objects[3].world_from_object, ..world.objects[2] };
    world.objects.push(more);
    check(&mut rig, &world, None, "one more");
    world.objects.remove(1);
    check(&mut rig, &world, None, "one less");
    world.lights[0].0.position_world.x += 0.3;
    check(&mut rig, &world, Some(3), "a light");
    world.lights.swap(0, 1);
    check(&mut rig, &world, None, "lights change places, and their ways to find faces");
    world.lights[1].1 = settings(&[("soften", "blur"), ("soft_px", "7"), ("stencil", "two-pass")]);
    check(&mut rig, &world, Some(0), "a blur");
    world.lights[0].1 = settings(&[("soften", "blur"), ("soft_m", "0.2")]);
    check(&mut rig, &world, None, "another blur beside it");
    world.meshes[1].0.iter_mut().for_each(|p| p.x += 0.5 * p.y);
    let before = rig.screen.mesh_version(1);
    rig.screen.set_mesh(1, &world.meshes[1].0, &world.meshes[1].1).expect("a mesh");
    assert!(rig.screen.mesh_version(1) != before && before.is_some());
    check(&mut rig, &world, None, "another shape");
    world.lights.truncate(1);
    check(&mut rig, &world, Some(0), "a light less");
    assert_eq!(rig.screen.lights().collect::<Vec<_>>(), [0]);
    let with = rig.screen.memory_bytes();
    rig.tell(&world);
    assert!(rig.screen.memory_bytes() <= with && rig.screen.told(1).is_none());
    rig.screen.remove_mesh(1);
    rig.tell(&world);
    assert_eq!(rig.screen.problems(), [VolumeProblem::NoMesh { mesh: 1 }]);
    let plain = wgpu::TextureFormat::Depth32Float;
    let refused = ScreenVolumes::new(&gpu.device, &gpu.queue, plain, rig.depth, V).map(|_| ());
    assert_eq!(refused, Err(VolumeProblem::Format { format: plain }));
    assert!(rig.screen.set_mesh(usize::MAX, &[], &[]).is_err_and(|e| e.to_string().contains("mesh")));
}
