//! Meshes on the GPU: positions apart from everything else, so that casters read nothing but positions.

use crate::layout::GpuFullVertex;
use glam::{Vec2, Vec3, Vec4};
use umbrage_scene::{AlphaMode, Material, Mesh, Scene};
use wgpu::util::DeviceExt;

/// Where a mesh lies in the buffers.
#[derive(Clone, Debug)]
pub struct MeshRange {
    /// Indices: first and past the last.
    pub indices: std::ops::Range<u32>,
    /// Distinct vertices.
    pub vertices: u32,
    /// Byte offset into positions.
    pub position_offset: u64,
    /// Byte offset into normals (plain) or full vertices.
    pub attribute_offset: u64,
    /// Texture coordinates and alpha of a cut-out caster, byte offset.
    pub uv_alpha_offset: Option<u64>,
    /// Texture coordinates and colour of a translucent caster, byte offset.
    pub uv_color_offset: Option<u64>,
    /// Does it read full vertices?
    pub full: bool,
}

/// All meshes of a scene.
#[derive(Debug)]
pub struct Geometry {
    /// `Float32x3`.
    pub positions: wgpu::Buffer,
    /// `Float32x3`, of plain meshes.
    pub normals: wgpu::Buffer,
    /// [`GpuFullVertex`], of the others.
    pub full: wgpu::Buffer,
    /// `Float32x3`, of cut-out casters.
    pub uv_alpha: wgpu::Buffer,
    /// `Float32x2` and `Float32x4`, of translucent casters.
    pub uv_color: wgpu::Buffer,
    /// `Uint32`.
    pub indices: wgpu::Buffer,
    /// One for each mesh of the scene.
    pub meshes: Vec<MeshRange>,
}

/// Does a mesh need more than position and normal?
fn needs_full(mesh: &Mesh, material: &Material) -> bool {
    let textured = material.base_color_texture.is_some()
        || material.metallic_roughness_texture.is_some()
        || material.normal_texture.is_some()
        || material.emissive_texture.is_some();
    textured || !mesh.colors.is_empty() || material.alpha != AlphaMode::Opaque
}

/// Alpha below which a caster lets light through: the mask's cutoff, or one half where alpha blends and translucent casters are
/// cut. `None`: solid.
pub fn caster_cutoff(material: &Material) -> Option<f32> {
    match material.alpha {
        AlphaMode::Opaque => None,
        AlphaMode::Mask { cutoff } => (cutoff > 0.0).then_some(cutoff),
        AlphaMode::Blend => Some(0.5),
    }
}

/// Texture coordinates of a vertex in the base colour's texture, transformed.
fn base_uv(mesh: &Mesh, material: &Material, vertex: usize) -> Vec2 {
    material.base_color_texture.map_or(Vec2::ZERO, |texture| {
        let set = if texture.uv_set == 1 { &mesh.uvs1 } else { &mesh.uvs };
        texture.uv_from_texcoord.transform_point2(set.get(vertex).copied().unwrap_or_default())
    })
}

/// Texture coordinates of the base colour, and the colour and alpha that its texture is multiplied by.
fn uv_colors<'a>(mesh: &'a Mesh, material: &'a Material) -> impl Iterator<Item = [f32; 6]> + 'a {
    (0..mesh.positions.len()).map(move |i| {
        let [u, v] = base_uv(mesh, material, i).to_array();
        let vertex_color = mesh.colors.get(i).map_or(Vec4::ONE, |c| Vec4::from(c.map(f32::from)) / 255.0);
        let [r, g, b, a] = (material.base_color * vertex_color).to_array();
        [u, v, r, g, b, a]
    })
}

/// Texture coordinates of the base colour, and alpha as a multiple of the cutoff.
fn uv_alphas<'a>(mesh: &'a Mesh, material: &'a Material, cutoff: f32) -> impl Iterator<Item = Vec3> + 'a {
    (0..mesh.positions.len()).map(move |i| {
        let uv = base_uv(mesh, material, i);
        let vertex_alpha = mesh.colors.get(i).map_or(1.0, |c| f32::from(c[3]) / 255.0);
        uv.extend(material.base_color.w * vertex_alpha / cutoff)
    })
}

fn full_vertices(mesh: &Mesh) -> impl Iterator<Item = GpuFullVertex> {
    (0..mesh.positions.len()).map(|i| {
        let uv = mesh.uvs.get(i).copied().unwrap_or_default();
        let uv1 = mesh.uvs1.get(i).copied().unwrap_or_default();
        GpuFullVertex {
            normal: mesh.normals.get(i).copied().unwrap_or(Vec3::Y),
            uv: [uv.x, uv.y, uv1.x, uv1.y],
            color: mesh.colors.get(i).copied().unwrap_or([255; 4]),
            tangent: mesh.tangents.get(i).map_or([0.0, 0.0, 0.0, 1.0], |t| t.to_array()),
        }
    })
}

impl Geometry {
    /// Uploads every mesh of a scene.
    pub fn new(device: &wgpu::Device, scene: &Scene) -> Self {
        let (mut positions, mut normals, mut full, mut uv_alpha, mut indices) = (
            Vec::<Vec3>::new(),
            Vec::<Vec3>::new(),
            Vec::<GpuFullVertex>::new(),
            Vec::<Vec3>::new(),
            Vec::<u32>::new(),
        );
        let mut uv_color = Vec::<[f32; 6]>::new();
        let meshes = scene.meshes.iter().map(|mesh| {
            let material = &scene.materials[mesh.material];
            let is_full = needs_full(mesh, material);
            let attribute_offset =
                if is_full { size_of_val(&full[..]) } else { size_of_val(&normals[..]) } as u64;
            let position_offset = size_of_val(&positions[..]) as u64;
            let uv_alpha_offset = caster_cutoff(material).map(|cutoff| {
                let offset = size_of_val(&uv_alpha[..]) as u64;
                uv_alpha.extend(uv_alphas(mesh, material, cutoff));
                offset
            });
            let uv_color_offset = (material.alpha == AlphaMode::Blend).then(|| {
                let offset = size_of_val(&uv_color[..]) as u64;
                uv_color.extend(uv_colors(mesh, material));
                offset
            });
            let first = indices.len() as u32;
            indices.extend_from_slice(&mesh.indices);
            positions.extend_from_slice(&mesh.positions);
            if is_full {
                full.extend(full_vertices(mesh));
            } else {
                normals.extend_from_slice(&mesh.normals);
            }
            MeshRange {
                indices: first..indices.len() as u32,
                vertices: mesh.positions.len() as u32,
                position_offset,
                attribute_offset,
                uv_alpha_offset,
                uv_color_offset,
                full: is_full,
            }
        });
        let meshes = meshes.collect();
        let buffer = |label, contents: &[u8], usage| {
            // An empty buffer cannot be bound.
            let contents = if contents.is_empty() { &[0u8; 64][..] } else { contents };
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some(label),
                contents,
                usage,
            })
        };
        // What may be posed anew is written to again.
        let vertex = wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST;
        Self {
            positions: buffer("positions", bytemuck::cast_slice(&positions), vertex),
            normals: buffer("normals", bytemuck::cast_slice(&normals), vertex),
            full: buffer("full vertices", bytemuck::cast_slice(&full), vertex),
            uv_alpha: buffer("caster uv and alpha", bytemuck::cast_slice(&uv_alpha), vertex),
            uv_color: buffer("caster uv and colour", bytemuck::cast_slice(&uv_color), vertex),
            indices: buffer("indices", bytemuck::cast_slice(&indices), wgpu::BufferUsages::INDEX),
            meshes,
        }
    }

    /// Writes a mesh's positions and normals (with what is interleaved with them) over those of mesh `index`, which has as many.
    pub fn repose(&self, queue: &wgpu::Queue, index: usize, mesh: &Mesh) {
        let range = &self.meshes[index];
        queue.write_buffer(&self.positions, range.position_offset, bytemuck::cast_slice(&mesh.positions));
        if range.full {
            let vertices: Vec<GpuFullVertex> = full_vertices(mesh).collect();
            queue.write_buffer(&self.full, range.attribute_offset, bytemuck::cast_slice(&vertices));
        } else {
            queue.write_buffer(&self.normals, range.attribute_offset, bytemuck::cast_slice(&mesh.normals));
        }
    }
}
