//! A scene as a user's WGSL function leaves it: the same function that moves vertices as they are drawn, run once for each.

use crate::gpu::Gpu;
use crate::options::RenderOptions;
use crate::{RenderError, own_wgsl, readback};
use glam::{Mat4, Vec3, Vec4};
use umbrage::core::Aabb;
use umbrage_scene::{Instance, Mesh, Scene};
use wgpu::util::DeviceExt;

const SHADER: &str = include_str!("../wgsl/deform.wgsl");
const GROUP: u32 = 64;

/// The scene with every vertex moved, each instance with a mesh of its own in world space; unchanged when `options` have no
/// function. Normals stay: the renderer keeps them too.
///
/// # Errors
/// [`RenderError::Wgsl`] for a function that cannot be used, [`RenderError::Gpu`] when the device refuses.
pub fn deformed(gpu: &Gpu, scene: &Scene, options: &RenderOptions) -> Result<Scene, RenderError> {
    let Some(deform) = &options.deform else { return Ok(scene.clone()) };
    own_wgsl::check_deform(deform)?;
    let shader = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("deform"),
        source: wgpu::ShaderSource::Wgsl([deform, SHADER].join("\n").into()),
    });
    let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some("deform"),
        layout: None,
        module: &shader,
        entry_point: Some("move_vertices"),
        compilation_options: Default::default(),
        cache: None,
    });
    let mut moved = Scene { meshes: Vec::new(), instances: Vec::new(), ..scene.clone() };
    for placed in &scene.instances {
        let mesh = &scene.meshes[placed.mesh];
        let positions = run(gpu, &pipeline, mesh, &placed.world_from_object, options.time_s)?;
        let turn = glam::Mat3::from_mat4(placed.world_from_object);
        let normal_from_object = turn.inverse().transpose();
        // A mirrored transform turns the winding; where it becomes part of the positions, indices must turn.
        let mirrored = turn.determinant() < 0.0;
        let turned = |corners: &[u32]| [corners[0], corners[2], corners[1]];
        let indices = if mirrored {
            mesh.indices.chunks_exact(3).flat_map(turned).collect()
        } else {
            mesh.indices.clone()
        };
        moved.instances.push(Instance {
            mesh: moved.meshes.len(),
            world_from_object: Mat4::IDENTITY,
            ..placed.clone()
        });
        moved.meshes.push(Mesh {
            bounds: Aabb::from_points(positions.iter().copied()),
            normals: mesh.normals.iter().map(|n| (normal_from_object * *n).normalize_or_zero()).collect(),
            positions,
            indices,
            ..mesh.clone()
        });
    }
    Ok(moved)
}

/// The positions of a mesh after the function, world space.
fn run(
    gpu: &Gpu,
    pipeline: &wgpu::ComputePipeline,
    mesh: &Mesh,
    world_from_object: &Mat4,
    time_s: f32,
) -> Result<Vec<Vec3>, RenderError> {
    let count = mesh.positions.len();
    if count == 0 {
        return Ok(Vec::new());
    }
    let rows = [world_from_object.row(0), world_from_object.row(1), world_from_object.row(2)];
    let told = [rows[0], rows[1], rows[2], Vec4::new(time_s, 0.0, 0.0, 0.0)];
    let vertices: Vec<Vec4> = mesh.positions.iter().map(|p| p.extend(1.0)).collect();
    let make = |contents: &[u8], usage| {
        gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("deform"),
            contents,
            usage,
        })
    };
    let told = make(bytemuck::bytes_of(&told), wgpu::BufferUsages::UNIFORM);
    let vertices =
        make(bytemuck::cast_slice(&vertices), wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
    let read = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("deformed"),
        size: vertices.size(),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("deform"),
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: told.as_entire_binding() },
            wgpu::BindGroupEntry { binding: 1, resource: vertices.as_entire_binding() },
        ],
    });
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let mut pass = encoder.begin_compute_pass(&Default::default());
    pass.set_pipeline(pipeline);
    pass.set_bind_group(0, &group, &[]);
    // Groups in rows: one row holds 65,535 at most.
    let groups = (count as u32).div_ceil(GROUP);
    pass.dispatch_workgroups(groups.min(1024), groups.div_ceil(1024), 1);
    drop(pass);
    encoder.copy_buffer_to_buffer(&vertices, 0, &read, 0, vertices.size());
    gpu.queue.submit([encoder.finish()]);
    let bytes = readback::map(gpu, &read)?;
    Ok(bytemuck::pod_collect_to_vec::<u8, Vec4>(&bytes).into_iter().map(Vec4::truncate).collect())
}
