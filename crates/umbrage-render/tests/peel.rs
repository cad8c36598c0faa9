//! Depth peeling against depths that are known, and against a ray caster of a few lines that shares nothing with it.

mod common;

use common::gpu;
use common::scenes::builtin;
use glam::{DVec3, Mat4, Vec3, Vec4};
use umbrage_render::Gpu;
use umbrage_render::umbrage::caster::{CasterVertices, GpuCasterView, NO_DEFORM};
use umbrage_render::umbrage::core::DEPTH;
use umbrage_render::umbrage::core::projection::perspective;
use umbrage_render::umbrage::{CasterPipelines, Peel, PeelPipelines, ShadowError, record_peel};
use wgpu::util::DeviceExt;

const SIDE: u32 = 64;

/// Triangles at home, and the alpha of each corner if they are cut out.
struct Caster {
    corners: Vec<Vec3>,
    uv_alpha: Option<Vec<Vec3>>,
}

fn buffer(gpu: &Gpu, contents: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
    gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
}

/// A white texture of one texel, as group 1 of cut-out casters.
fn white(gpu: &Gpu, layout: &wgpu::BindGroupLayout) -> wgpu::BindGroup {
    let texture = gpu.device.create_texture_with_data(
        &gpu.queue,
        &wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: 1, height: 1, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8Unorm,
            usage: wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        },
        wgpu::util::TextureDataOrder::LayerMajor,
        &[255; 4],
    );
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout,
        entries: &[
            wgpu::BindGroupEntry {
                binding: 0,
                resource: wgpu::BindingResource::TextureView(&texture.create_view(&Default::default())),
            },
            wgpu::BindGroupEntry {
                binding: 1,
                resource: wgpu::BindingResource::Sampler(&gpu.device.create_sampler(&Default::default())),
            },
        ],
    })
}

fn read(gpu: &Gpu, peel: &Peel) -> Vec<Vec<f32>> {
    let row = 4 * SIDE;
    let out = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(row * SIDE * peel.layers()),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let layout =
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: Some(SIDE) };
    encoder.copy_texture_to_buffer(
        peel.texture().as_image_copy(),
        wgpu::TexelCopyBufferInfo { buffer: &out, layout },
        peel.texture().size(),
    );
    gpu.queue.submit([encoder.finish()]);
    out.map_async(wgpu::MapMode::Read, .., |mapped| mapped.expect("mapped"));
    gpu.device.poll(wgpu::PollType::Wait { submission_index: None, timeout: None }).expect("a device");
    let bytes = out.get_mapped_range(..).expect("mapped").to_vec();
    let depths: Vec<f32> =
        bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
    depths.chunks_exact((SIDE * SIDE) as usize).map(<[f32]>::to_vec).collect()
}

/// The layers of casters, each as rows from the top.
fn peeled(
    gpu: &Gpu,
    casters: &[Caster],
    clip_from_world: Mat4,
    layers: u32,
    (deform, time_s): (&str, f32),
) -> Vec<Vec<f32>> {
    let cut_out_layout = CasterPipelines::cut_out_layout(&gpu.device);
    let pipelines = PeelPipelines::new(&gpu.device, &cut_out_layout, &CasterVertices::deformed(deform));
    let peel = Peel::new(&gpu.device, SIDE, layers).expect("layers");
    let view = GpuCasterView {
        clip_from_world,
        near_m: 1.0,
        far_m: 10.0,
        perspective: 1,
        offset_slope: 0.0,
        offset_depth: 0.0,
        time_s,
        pad: [0.0; 2],
    };
    let view = buffer(gpu, bytemuck::bytes_of(&view), wgpu::BufferUsages::UNIFORM);
    let view_group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipelines.nearest.view_layout,
        entries: &[wgpu::BindGroupEntry {
            binding: 0,
            resource: wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer: &view,
                offset: 0,
                size: std::num::NonZeroU64::new(size_of::<GpuCasterView>() as u64),
            }),
        }],
    });
    let white = white(gpu, &cut_out_layout);
    let rows = [Vec4::X, Vec4::Y, Vec4::Z];
    let vertex = wgpu::BufferUsages::VERTEX;
    let instance = buffer(gpu, bytemuck::cast_slice(&rows), vertex);
    let buffers: Vec<_> = casters
        .iter()
        .map(|caster| {
            let of = |data: &[Vec3]| buffer(gpu, bytemuck::cast_slice(data), vertex);
            (of(&caster.corners), caster.uv_alpha.as_ref().map(|data| of(data)))
        })
        .collect();
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    record_peel(&mut encoder, &peel, &pipelines, |recorded, pipelines| {
        recorded.set_bind_group(0, &view_group, &[0]);
        recorded.set_vertex_buffer(1, instance.slice(..));
        for (caster, (corners, uv_alpha)) in casters.iter().zip(&buffers) {
            recorded.set_pipeline(if uv_alpha.is_some() { &pipelines.cut_out } else { &pipelines.open });
            if let Some(uv_alpha) = uv_alpha {
                recorded.set_bind_group(pipelines.cut_out_group, &white, &[]);
                recorded.set_vertex_buffer(2, uv_alpha.slice(..));
            }
            recorded.set_vertex_buffer(0, corners.slice(..));
            recorded.draw(0..caster.corners.len() as u32, 0..1);
        }
    });
    gpu.queue.submit([encoder.finish()]);
    assert_eq!(peel.memory_bytes(), u64::from(4 * SIDE * SIDE * layers));
    read(gpu, &peel)
}

/// A square around the axis at `z`; the corners in x, alpha -1 on the left and 3 on the right.
fn square(z: f32, half: f32, cut_out: bool) -> Caster {
    let corner = |x: f32, y: f32| Vec3::new(x * half, y * half, z);
    let (a, b, c, d) = (corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0));
    let corners = vec![a, b, c, a, c, d];
    let alpha = |p: &Vec3| Vec3::new(0.5, 0.5, 1.0 + 2.0 * p.x / half);
    let uv_alpha = cut_out.then(|| corners.iter().map(alpha).collect());
    Caster { corners, uv_alpha }
}

/// x and y from -1 to 1, z from 1 (near) to 0 (far): z is the stored depth.
fn flat_view() -> Mat4 {
    assert!(DEPTH.is_reversed());
    Mat4::IDENTITY
}

#[test]
fn a_stack_of_squares_comes_off_one_by_one() {
    let Some(gpu) = gpu() else { return };
    // Drawn in no order; two at the same depth are one layer; the neighbours of one float step are two.
    let step = f32::from_bits(0.5f32.to_bits() - 1);
    let depths = [0.25, 0.75, step, 0.5, 0.75, 0.0625];
    let casters: Vec<Caster> = depths.iter().map(|z| square(*z, 0.5, false)).collect();
    let layers = peeled(&gpu, &casters, flat_view(), 8, (NO_DEFORM, 0.0));
    let expected = [0.75, 0.5, step, 0.25, 0.0625, 0.0, 0.0, 0.0];
    for (i, (layer, expected)) in layers.iter().zip(expected).enumerate() {
        for (at, depth) in (0u32..).zip(layer) {
            let (x, y) = (at % SIDE, at / SIDE);
            let covered = (16..48).contains(&x) && (16..48).contains(&y);
            assert_eq!(*depth, if covered { expected } else { 0.0 }, "layer {i} at {x} {y}");
        }
    }
}

#[test]
fn cut_out_and_deforming_casters_peel_too() {
    let Some(gpu) = gpu() else { return };
    let casters = [square(0.75, 1.0, true), square(0.5, 1.0, false), square(0.25, 1.0, true)];
    let moved = "fn umbrage_deform(p_world: vec3f, p_object: vec3f, time_s: f32) -> vec3f {
    return p_world + vec3f(0.0, 0.0, 0.125 * time_s);
}";
    for (deform, raised) in [((NO_DEFORM, 1.0), 0.0), ((moved, 1.0), 0.125)] {
        let layers = peeled(&gpu, &casters, flat_view(), 4, deform);
        // The left half of the cut-out squares is a hole.
        let (left, right) = ([0.5, 0.0, 0.0, 0.0], [0.75, 0.5, 0.25, 0.0]);
        for (i, layer) in layers.iter().enumerate() {
            let at = |x: usize| layer[20 * SIDE as usize + x];
            let raise = |depth: f32| if depth > 0.0 { depth + raised } else { depth };
            assert_eq!((at(10), at(50)), (raise(left[i]), raise(right[i])), "layer {i}");
        }
    }
}

#[test]
fn more_layers_than_there_can_be_are_refused() {
    let Some(gpu) = gpu() else { return };
    let most = gpu.device.limits().max_texture_array_layers;
    assert!(Peel::new(&gpu.device, 1, most).is_ok());
    for (size, layers) in [(1, most + 1), (1, 0), (0, 1), (u32::MAX, 1)] {
        assert!(matches!(Peel::new(&gpu.device, size, layers), Err(ShadowError::TooLarge { .. })));
    }
}

/// How far along the axis a ray through `direction` (z = -1) meets each triangle, sorted.
fn hits(corners: &[Vec3], direction: DVec3) -> Vec<f64> {
    let mut hits: Vec<f64> = corners
        .chunks_exact(3)
        .filter_map(|t| {
            let [a, b, c] = [t[0], t[1], t[2]].map(|p| p.as_dvec3());
            let volume = |p: DVec3, q: DVec3| direction.dot(p.cross(q));
            let (u, v, w) = (volume(a, b), volume(b, c), volume(c, a));
            let inside = (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
            let normal = (b - a).cross(c - a);
            let along = normal.dot(direction);
            (inside && along != 0.0).then(|| normal.dot(a) / along)
        })
        .collect();
    hits.sort_by(f64::total_cmp);
    hits.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
    hits
}

#[test]
fn a_torus_peels_as_rays_meet_it() {
    let Some(gpu) = gpu() else { return };
    let scene = builtin("torus");
    let mesh = scene.meshes.iter().find(|m| m.name == "torus").expect("a torus");
    // Seen from the side, so that rays meet it up to four times.
    let turn = Mat4::from_translation(Vec3::NEG_Z * 4.0)
        * Mat4::from_rotation_x(-0.8)
        * Mat4::from_translation(-mesh.bounds.center());
    let corners: Vec<Vec3> =
        mesh.indices.iter().map(|i| turn.transform_point3(mesh.positions[*i as usize])).collect();
    let tan_half = 0.35;
    let (near_m, far_m) = (1.0, 10.0);
    let clip_from_world = perspective(tan_half, tan_half, near_m, far_m, DEPTH);
    let caster = Caster { corners: corners.clone(), uv_alpha: None };
    let layers = peeled(&gpu, &[caster], clip_from_world, 6, (NO_DEFORM, 0.0));
    let mut met = [0usize; 7];
    let (mut covered, mut off) = (0, 0);
    for y in 0..SIDE {
        for x in 0..SIDE {
            let ndc = |i: u32| (2.0 * (f64::from(i) + 0.5) / f64::from(SIDE) - 1.0) * f64::from(tan_half);
            let hits = hits(&corners, DVec3::new(ndc(x), -ndc(y), -1.0));
            met[hits.len().min(6)] += 1;
            covered += usize::from(!hits.is_empty());
            // A layer that is clear is at the far plane.
            let at_m = |layer: usize| {
                let depth = f64::from(layers[layer][(y * SIDE + x) as usize]);
                let (near, far) = (f64::from(near_m), f64::from(far_m));
                near * far / (near + depth * (far - near))
            };
            let is_right = (0..6).all(|layer| {
                let expected_m = hits.get(layer).copied().unwrap_or(f64::from(far_m));
                // Rasterisers move corners to a grid of 1/256 of a pixel, which tells where the surface is steep.
                (at_m(layer) - expected_m).abs() < 0.01
            });
            off += usize::from(!is_right);
        }
    }
    println!("rays that meet 0, 1, 2.. surfaces: {met:?}; {off} of {covered} differ");
    assert!(met[2] > 300 && met[4] > 100, "{met:?}");
    // Those are on silhouettes, where the grid decides whether a sample is covered.
    assert!(off * 100 < covered, "{off} of {covered}");
}
