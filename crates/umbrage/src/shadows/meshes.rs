//! Meshes of the caller's: which of their buffers casters are drawn from.

use super::ShadowsError;
use super::foreign::is_foreign_buffer;
use glam::Vec3;
use std::ops::Range;
use umbrage_core::Aabb;
use umbrage_core::edges::Adjacency;

/// Where a mesh is: buffers that the caller keeps drawing from. They are borrowed only to be named: `wgpu` keeps them.
#[derive(Clone, Debug)]
pub struct CasterMesh<'a> {
    positions: &'a wgpu::Buffer,
    offset: u64,
    stride: u64,
    format: wgpu::VertexFormat,
    vertices: Range<u32>,
    indices: Option<(&'a wgpu::Buffer, wgpu::IndexFormat, Range<u32>)>,
    bounds_object: Aabb,
    closed: bool,
    shape: Option<(&'a [Vec3], &'a [u32])>,
    cut_out: Option<CutOut<'a>>,
    translucent: Option<Translucent<'a>>,
}

/// What cuts holes into a mesh.
#[derive(Clone, Copy, Debug)]
pub struct CutOut<'a> {
    /// For each vertex three floats, 12 bytes: texture coordinates, and 1 over the alpha below which there is a hole (times the
    /// material's own alpha).
    pub uv_alpha: &'a wgpu::Buffer,
    /// Where its first vertex is, bytes.
    pub offset: u64,
    /// Its alpha counts.
    pub texture: &'a wgpu::TextureView,
    /// How it is read.
    pub sampler: &'a wgpu::Sampler,
}

/// What lets light through in colours, for techniques that colour light; all others draw the mesh as if it were solid, or cut out.
#[derive(Clone, Copy, Debug)]
pub struct Translucent<'a> {
    /// For each vertex six floats, 24 bytes: texture coordinates, and the linear colour and alpha that the texture is
    /// multiplied by.
    pub uv_color: &'a wgpu::Buffer,
    /// Where its first vertex is, bytes.
    pub offset: u64,
    /// Base colour and alpha.
    pub texture: &'a wgpu::TextureView,
    /// How it is read.
    pub sampler: &'a wgpu::Sampler,
}

impl<'a> CasterMesh<'a> {
    /// A mesh of tightly packed positions, three floats each, drawn without indices, inside of `bounds_object` (object space,
    /// metres). `vertices` are the first and the one past the last.
    pub fn new(positions: &'a wgpu::Buffer, vertices: Range<u32>, bounds_object: Aabb) -> Self {
        Self {
            positions,
            offset: 0,
            stride: 12,
            format: wgpu::VertexFormat::Float32x3,
            vertices,
            indices: None,
            bounds_object,
            closed: false,
            shape: None,
            cut_out: None,
            translucent: None,
        }
    }

    /// Positions among other attributes: the first is `offset` bytes in, and `stride` bytes lie from one to the next. Multiples
    /// of 4.
    #[must_use]
    pub fn interleaved(self, offset: u64, stride: u64) -> Self {
        Self { offset, stride, ..self }
    }

    /// Positions of another format: one that a shader reads as three or four floats.
    #[must_use]
    pub fn format(self, format: wgpu::VertexFormat) -> Self {
        Self { format, ..self }
    }

    /// Drawn with these indices.
    #[must_use]
    pub fn indexed(self, buffer: &'a wgpu::Buffer, format: wgpu::IndexFormat, indices: Range<u32>) -> Self {
        Self { indices: Some((buffer, format, indices)), ..self }
    }

    /// A solid whose every edge joins two triangles that are wound alike. Half of it is then not drawn, and second-depth maps can
    /// hold its far side. Default: no; found by itself where there is a [shape](Self::shape).
    #[must_use]
    pub fn closed(self) -> Self {
        Self { closed: true, ..self }
    }

    /// The same triangles on the CPU, for shadow volumes, which need to know what joins what; without it, a light whose technique
    /// makes volumes draws this mesh into a map. Copied to buffers of their own; once a mesh, at the cost of a sort of its
    /// edges (a tenth of a second for 250,000 triangles).
    #[must_use]
    pub fn shape(self, positions: &'a [Vec3], indices: &'a [u32]) -> Self {
        Self { shape: Some((positions, indices)), ..self }
    }

    pub(super) fn shape_on_cpu(&self) -> Option<(&'a [Vec3], &'a [u32])> {
        self.shape
    }

    /// With holes.
    #[must_use]
    pub fn cut_out(self, cut_out: CutOut<'a>) -> Self {
        Self { cut_out: Some(cut_out), ..self }
    }

    /// Lets light through in colours.
    #[must_use]
    pub fn translucent(self, translucent: Translucent<'a>) -> Self {
        Self { translucent: Some(translucent), ..self }
    }
}

/// Which pipelines draw a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct VertexKind {
    pub stride: u64,
    pub format: wgpu::VertexFormat,
}

/// A stream of attributes with its texture.
#[derive(Debug)]
pub(super) struct Textured {
    pub vertices: wgpu::Buffer,
    pub offset: u64,
    pub group: wgpu::BindGroup,
}

/// A mesh as it is drawn.
#[derive(Debug)]
pub(super) struct Mesh {
    pub positions: wgpu::Buffer,
    pub offset: u64,
    pub kind: VertexKind,
    pub vertices: Range<u32>,
    pub indices: Option<(wgpu::Buffer, wgpu::IndexFormat, Range<u32>)>,
    pub bounds_object: Aabb,
    pub closed: bool,
    /// Has it a shape that volumes can be made of?
    pub has_shape: bool,
    pub cut_out: Option<Textured>,
    pub translucent: Option<Textured>,
    /// Casters that use it.
    pub casters: usize,
    /// Counts how often its vertices changed.
    pub version: u64,
}

fn buffer(what: &'static str, reason: impl Into<String>) -> ShadowsError {
    ShadowsError::Buffer { what, reason: reason.into() }
}

/// Bytes that a format's first three floats are read from; `None` for formats that are not read as three floats.
fn is_position(format: wgpu::VertexFormat) -> bool {
    use wgpu::VertexFormat as F;
    matches!(
        format,
        F::Float32x3 | F::Float32x4 | F::Float16x4 | F::Snorm16x4 | F::Unorm16x4 | F::Snorm8x4 | F::Unorm8x4
    )
}

fn check(
    device: &wgpu::Device,
    what: &'static str,
    given: &wgpu::Buffer,
    usage: wgpu::BufferUsages,
    bytes: Range<u64>,
) -> Result<(), ShadowsError> {
    if !given.usage().contains(usage) {
        return Err(buffer(what, format!("it was made without {usage:?}; add that to its usage")));
    }
    if bytes.end > given.size() {
        return Err(buffer(
            what,
            format!(
                "it has {} bytes, and bytes up to {} are to be read; pass the right range",
                given.size(),
                bytes.end
            ),
        ));
    }
    if is_foreign_buffer(device, given, usage == wgpu::BufferUsages::INDEX) {
        return Err(ShadowsError::ForeignDevice { what });
    }
    Ok(())
}

impl Mesh {
    /// Checks what can be checked, and makes the bind groups of textures.
    pub fn new(
        device: &wgpu::Device,
        cut_out_layout: &wgpu::BindGroupLayout,
        given: &CasterMesh<'_>,
    ) -> Result<Self, ShadowsError> {
        use wgpu::BufferUsages as Usage;
        let positions = "buffer of positions";
        if !is_position(given.format) {
            return Err(buffer(
                positions,
                format!("{:?} is not read as three floats; Float32x3 is", given.format),
            ));
        }
        if !given.offset.is_multiple_of(4)
            || !given.stride.is_multiple_of(4)
            || given.stride < given.format.size()
        {
            let (offset, stride) = (given.offset, given.stride);
            return Err(buffer(
                positions,
                format!(
                    "offset {offset} and stride {stride} bytes; both must be multiples of 4, and the stride not below the position's own {} bytes",
                    given.format.size()
                ),
            ));
        }
        if !(given.bounds_object.is_empty() || is_finite(&given.bounds_object)) {
            return Err(ShadowsError::Number {
                what: "mesh's box",
                value: format!("{:?}", given.bounds_object),
                allowed: "finite",
            });
        }
        let last = |count: u32, stride: u64, size: u64| {
            u64::from(count).checked_sub(1).map_or(0, |before| before * stride + size)
        };
        let end = given.offset + last(given.vertices.end, given.stride, given.format.size());
        check(device, positions, given.positions, Usage::VERTEX, given.offset..end)?;
        if let Some((indices, format, range)) = &given.indices {
            let end = u64::from(range.end) * format.byte_size() as u64;
            check(device, "buffer of indices", indices, Usage::INDEX, 0..end)?;
        }
        let textured = |what, vertices: &wgpu::Buffer, offset: u64, bytes, texture, sampler| {
            let end = offset + last(given.vertices.end, bytes, bytes);
            check(device, what, vertices, Usage::VERTEX, offset..end)?;
            let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("umbrage caster texture"),
                layout: cut_out_layout,
                entries: &[
                    wgpu::BindGroupEntry {
                        binding: 0,
                        resource: wgpu::BindingResource::TextureView(texture),
                    },
                    wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(sampler) },
                ],
            });
            Ok::<_, ShadowsError>(Textured { vertices: vertices.clone(), offset, group })
        };
        let cut_out = given
            .cut_out
            .map(|c| textured("buffer of uv and alpha", c.uv_alpha, c.offset, 12, c.texture, c.sampler));
        let translucent = given
            .translucent
            .map(|t| textured("buffer of uv and colour", t.uv_color, t.offset, 24, t.texture, t.sampler));
        let closed_by_shape = given.shape.is_some_and(|(positions, indices)| {
            let adjacency = Adjacency::new(positions, indices);
            !adjacency.triangles.is_empty() && !adjacency.two_sided.contains(&true)
        });
        Ok(Self {
            positions: given.positions.clone(),
            offset: given.offset,
            kind: VertexKind { stride: given.stride, format: given.format },
            vertices: given.vertices.clone(),
            indices: given.indices.as_ref().map(|(b, format, range)| ((*b).clone(), *format, range.clone())),
            bounds_object: given.bounds_object,
            closed: (given.closed || closed_by_shape) && given.cut_out.is_none(),
            has_shape: given.shape.is_some(),
            cut_out: cut_out.transpose()?,
            translucent: translucent.transpose()?,
            casters: 0,
            version: 0,
        })
    }

    /// Can volumes be made of it? They know no holes.
    pub fn makes_volumes(&self) -> bool {
        self.has_shape && self.cut_out.is_none()
    }

    /// Triangles of one instance.
    pub fn triangles(&self) -> u64 {
        let range = self.indices.as_ref().map_or(&self.vertices, |(_, _, range)| range);
        range.len() as u64 / 3
    }

    /// Draws instances of it; slot 1 and pipeline must be set.
    pub fn draw(&self, recorded: &mut wgpu::RenderPass<'_>, instances: Range<u32>) {
        recorded.set_vertex_buffer(0, self.positions.slice(self.offset..));
        match &self.indices {
            Some((buffer, format, range)) => {
                recorded.set_index_buffer(buffer.slice(..), *format);
                recorded.draw_indexed(range.clone(), 0, instances);
            }
            None => recorded.draw(self.vertices.clone(), instances),
        }
    }
}

/// Are both corners finite?
pub(super) fn is_finite(bounds: &Aabb) -> bool {
    bounds.min.is_finite() && bounds.max.is_finite()
}
