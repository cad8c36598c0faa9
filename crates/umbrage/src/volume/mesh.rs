//! A mesh on the GPU as volumes need it.

use super::VolumePipelines;
use glam::{Vec3, Vec4};
use std::ops::Range;
use umbrage_core::edges::Adjacency;
use umbrage_core::split::SplitMesh;
use umbrage_core::technique::volume::Silhouette;
use wgpu::util::DeviceExt;

/// What a volume is made from.
#[derive(Clone, Copy, Debug)]
pub struct VolumeSource<'a> {
    /// Object space, metres.
    pub positions: &'a [Vec3],
    /// Of the same mesh.
    pub adjacency: &'a Adjacency,
}

/// A mesh whose volumes can be drawn.
#[derive(Debug)]
pub struct VolumeMesh {
    pub(super) position_group: wgpu::BindGroup,
    pub(super) edge_group: wgpu::BindGroup,
    split: Option<Split>,
    triangles: u32,
    edges: u32,
    open_edges: u32,
    twice_edges: u32,
    bytes: u64,
}

/// Split edges, drawn as they are.
#[derive(Debug)]
pub(super) struct Split {
    pub vertices: wgpu::Buffer,
    pub indices: wgpu::Buffer,
    first_back: u32,
    one_sided: Range<u32>,
    two_sided: Range<u32>,
    open: Range<u32>,
}

impl Split {
    /// Indices, and whether they are drawn as the mesh's reverse.
    pub fn draws(&self, both_sides: bool) -> impl Iterator<Item = (Range<u32>, bool)> {
        // Ghosts of open edges join a triangle and its own reverse: once is enough.
        let as_is = (self.one_sided.start..self.open.end, false);
        let reversed =
            if both_sides { self.one_sided.start..self.two_sided.end } else { self.two_sided.clone() };
        [as_is, (reversed, true)].into_iter().filter(|(range, _)| !range.is_empty())
    }
}

#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct SplitVertex {
    p_object: Vec3,
    plane: [f32; 4],
}

/// The vertex buffer of split edges: position, then plane.
pub(super) const SPLIT_VERTICES: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: size_of::<SplitVertex>() as u64,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x4],
};

impl VolumeMesh {
    /// Uploads a mesh. `None` when it has no triangle with area, or is larger than a storage buffer of this device may be.
    ///
    /// Memory: 12 bytes a vertex, 32 a triangle and 16 an edge; with split edges 144 a triangle.
    pub fn new(
        device: &wgpu::Device,
        pipelines: &VolumePipelines,
        source: &VolumeSource<'_>,
    ) -> Option<Self> {
        let adjacency = source.adjacency;
        if adjacency.triangles.is_empty() {
            return None;
        }
        let split =
            (pipelines.silhouette == Silhouette::Vertex).then(|| SplitMesh::new(source.positions, adjacency));
        let twice = |triangle: u32| adjacency.two_sided[triangle as usize];
        let corners = adjacency.triangles.iter().zip(&adjacency.two_sided);
        let triangles: Vec<[u32; 4]> =
            corners.map(|(&[a, b, c], twice)| [a, b, c, u32::from(*twice)]).collect();
        let ends =
            |edge: &umbrage_core::edges::Edge| [edge.a, edge.b, edge.left, edge.right.unwrap_or(u32::MAX)];
        let edges: Vec<[u32; 4]> = adjacency.edges.iter().map(ends).collect();
        let lists: [(&'static str, &[u8]); 4] = if split.is_some() {
            // The vertex shader reads none of them.
            [("no positions", &[]), ("no triangles", &[]), ("no planes", &[]), ("no edges", &[])]
        } else {
            [
                ("volume positions", bytemuck::cast_slice(source.positions)),
                ("volume triangles", bytemuck::cast_slice(&triangles)),
                ("volume planes", bytemuck::cast_slice::<Vec4, u8>(&adjacency.planes)),
                ("volume edges", bytemuck::cast_slice(&edges)),
            ]
        };
        let limits = device.limits();
        let most = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        let largest = lists.iter().map(|(_, bytes)| bytes.len() as u64).max().unwrap_or(0);
        if largest > most
            || split.as_ref().is_some_and(|s| 28 * s.positions.len() as u64 > limits.max_buffer_size)
        {
            return None;
        }
        let storage = |(label, bytes): (&'static str, &[u8])| {
            // An empty buffer cannot be bound.
            let contents = if bytes.is_empty() { &[0u8; 16][..] } else { bytes };
            let usage = wgpu::BufferUsages::STORAGE;
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some(label),
                contents,
                usage,
            })
        };
        let [positions, triangle_list, planes, edge_list] = lists.map(storage);
        let group = |label, layout, buffers: &[&wgpu::Buffer]| {
            let entries: Vec<_> = (0u32..)
                .zip(buffers)
                .map(|(binding, buffer)| wgpu::BindGroupEntry {
                    binding,
                    resource: buffer.as_entire_binding(),
                })
                .collect();
            device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some(label),
                layout,
                entries: &entries,
            })
        };
        let open_edges = adjacency.edges.iter().filter(|edge| edge.right.is_none()).count() as u32;
        let twice_edges =
            adjacency.edges.iter().filter(|e| e.right.is_some() && twice(e.left)).count() as u32;
        let split = split.map(|split| upload(device, &split));
        let bytes = lists.iter().map(|(_, bytes)| bytes.len() as u64).sum::<u64>()
            + split.as_ref().map_or(0, |split| split.vertices.size() + split.indices.size());
        Some(Self {
            position_group: group("volume positions", &pipelines.position_layout, &[&positions]),
            edge_group: group("volume edges", &pipelines.edge_layout, &[&triangle_list, &planes, &edge_list]),
            split,
            triangles: triangles.len() as u32,
            edges: edges.len() as u32,
            open_edges,
            twice_edges,
            bytes,
        })
    }

    pub(super) fn split(&self) -> Option<&Split> {
        self.split.as_ref()
    }

    pub(super) fn first_back(&self) -> u32 {
        self.split.as_ref().map_or(0, |split| split.first_back)
    }

    /// Triangles that volumes are made of.
    pub fn triangles(&self) -> u32 {
        self.triangles
    }

    /// Edges that are looked at.
    pub fn edges(&self) -> u32 {
        self.edges
    }

    /// Memory, bytes.
    pub fn memory_bytes(&self) -> u64 {
        self.bytes
    }

    /// Triangles that a draw of its split edges has; `None` where a compute pass finds them.
    pub fn split_triangles(&self, both_sides: bool) -> Option<u64> {
        let split = self.split.as_ref()?;
        Some(split.draws(both_sides).map(|(range, _)| u64::from(range.end - range.start) / 3).sum())
    }

    /// The most indices that its volume can have.
    pub(super) fn most_indices(&self, both_sides: bool, of_quad: u32, of_cap: u32) -> u32 {
        if self.split.is_some() {
            return 0;
        }
        let paired = self.edges - self.open_edges;
        let quads = self.open_edges + paired + if both_sides { paired } else { self.twice_edges };
        quads.saturating_mul(of_quad).saturating_add(self.triangles.saturating_mul(of_cap))
    }
}

fn upload(device: &wgpu::Device, split: &SplitMesh) -> Split {
    let vertices: Vec<SplitVertex> = split
        .positions
        .iter()
        .zip(&split.planes)
        .map(|(p, plane)| SplitVertex { p_object: *p, plane: plane.to_array() })
        .collect();
    let buffer = |label, contents: &[u8], usage| {
        device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: Some(label), contents, usage })
    };
    Split {
        vertices: buffer("split vertices", bytemuck::cast_slice(&vertices), wgpu::BufferUsages::VERTEX),
        indices: buffer("split indices", bytemuck::cast_slice(&split.indices), wgpu::BufferUsages::INDEX),
        first_back: split.first_reversed,
        one_sided: split.one_sided.clone(),
        two_sided: split.two_sided.clone(),
        open: split.open.clone(),
    }
}
