//! A light's casters on the GPU, and the faces that a compute pass finds for them.

use super::{VolumeCaster, VolumeMesh, VolumePipelines};
use glam::Vec4;
use std::num::NonZeroU64;
use std::ops::Range;
use umbrage_core::volume::light_point_object;

/// Mirrors `VolumeCaster` of `wgsl/volume_caster.wgsl`; see there for what each field means.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub(super) struct GpuVolumeCaster {
    pub rows: [Vec4; 3],
    pub light_object: Vec4,
    pub light_world: Vec4,
    pub far_plane: Vec4,
    pub inset_m: f32,
    pub extrude_m: f32,
    pub triangles: u32,
    pub edges: u32,
    pub first_index: u32,
    pub first_count: u32,
    pub flags: u32,
    pub reversed: u32,
    pub first_back: u32,
    pub pad: [u32; 3],
}

const BOTH_SIDES: u32 = 1;
const NEAR_CAPS: u32 = 2;
const FAR_CAPS: u32 = 4;
const ENDS_IN_A_POINT: u32 = 8;

/// Bytes from one caster to the next: every device allows dynamic offsets of this many.
const STRIDE: u64 = 256;
/// Numbers of each caster's counts.
const COUNTS: u64 = 8;

/// A caster's numbers on the GPU; its indices begin at `first_index`. With it, where those of the next caster begin: `None` past
/// what 32 bits count.
fn gpu_caster(
    caster: &VolumeCaster,
    mesh: &VolumeMesh,
    number: usize,
    first_index: u32,
) -> Option<(GpuVolumeCaster, u32)> {
    let flags = [
        (caster.both_sides, BOTH_SIDES),
        (caster.near_caps, NEAR_CAPS),
        // They would be one place.
        (caster.far_caps && !caster.ends_in_a_point(), FAR_CAPS),
        (caster.ends_in_a_point(), ENDS_IN_A_POINT),
    ];
    let flags = flags.iter().filter(|(on, _)| *on).map(|(_, flag)| flag).sum();
    let world = &caster.world_from_object;
    let made = GpuVolumeCaster {
        rows: [world.row(0), world.row(1), world.row(2)],
        light_object: light_point_object(caster.light_world, world),
        light_world: caster.light_world,
        far_plane: caster.far_plane_world.unwrap_or_default(),
        inset_m: caster.inset_m,
        extrude_m: caster.extrude_m,
        triangles: mesh.triangles(),
        edges: mesh.edges(),
        first_index,
        first_count: COUNTS as u32 * number as u32,
        flags,
        reversed: 0,
        first_back: mesh.first_back(),
        pad: [0; 3],
    };
    let of_quad = if caster.ends_in_a_point() { 3 } else { 6 };
    let of_cap = 3 * ((flags & NEAR_CAPS) / NEAR_CAPS + (flags & FAR_CAPS) / FAR_CAPS);
    let indices = mesh.most_indices(caster.both_sides, of_quad, of_cap);
    Some((made, first_index.checked_add(indices)?))
}

impl GpuVolumeCaster {
    /// Are the faces that a compute pass finds the same? It looks at the light's place among the planes, and at where faces go; not
    /// at where they end.
    fn has_faces_of(&self, other: &Self) -> bool {
        let of = |c: &Self| (c.triangles, c.edges, c.first_index, c.first_count, c.flags);
        self.light_object == other.light_object && of(self) == of(other)
    }
}

/// Buffers for some number of casters and indices.
#[derive(Debug)]
pub(super) struct Room {
    /// Each caster twice: as it is, and reversed.
    uniforms: wgpu::Buffer,
    pub counts: wgpu::Buffer,
    pub indices: wgpu::Buffer,
    pub silhouette_group: wgpu::BindGroup,
    pub draw_group: wgpu::BindGroup,
}

impl Room {
    fn new(
        device: &wgpu::Device,
        pipelines: &VolumePipelines,
        casters: u64,
        index_bytes: u64,
        clip_from_world: &wgpu::Buffer,
    ) -> Self {
        use wgpu::BufferUsages as Usage;
        let buffer = |label, size, usage| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        let uniforms = buffer("volume casters", 2 * STRIDE * casters, Usage::UNIFORM | Usage::COPY_DST);
        let count_usage = Usage::STORAGE | Usage::INDIRECT | Usage::COPY_DST | Usage::COPY_SRC;
        let counts = buffer("volume counts", 4 * COUNTS * casters, count_usage);
        let indices = buffer("volume indices", index_bytes, Usage::STORAGE | Usage::INDEX);
        let caster = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: &uniforms,
            offset: 0,
            size: NonZeroU64::new(size_of::<GpuVolumeCaster>() as u64),
        });
        let group = |label, layout, resources: &[wgpu::BindingResource<'_>]| {
            let entries: Vec<_> = (0u32..)
                .zip(resources)
                .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource: resource.clone() })
                .collect();
            device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some(label),
                layout,
                entries: &entries,
            })
        };
        Self {
            silhouette_group: group(
                "silhouettes",
                &pipelines.silhouette_layout,
                &[caster.clone(), counts.as_entire_binding(), indices.as_entire_binding()],
            ),
            draw_group: group(
                "volumes",
                &pipelines.draw_layout,
                &[caster, clip_from_world.as_entire_binding()],
            ),
            uniforms,
            counts,
            indices,
        }
    }

    fn holds(&self, casters: u64, index_bytes: u64) -> bool {
        self.uniforms.size() >= 2 * STRIDE * casters && self.indices.size() >= index_bytes
    }

    /// Writes some neighbours' numbers, each twice, by way of `bytes`.
    fn write_casters(
        &self,
        queue: &wgpu::Queue,
        first: usize,
        made: &[GpuVolumeCaster],
        bytes: &mut Vec<u8>,
    ) {
        bytes.clear();
        for made in made {
            for reversed in [0, 1] {
                let start = bytes.len();
                let made = GpuVolumeCaster { reversed, ..*made };
                bytes.extend_from_slice(bytemuck::bytes_of(&made));
                bytes.resize(start + STRIDE as usize, 0);
            }
        }
        queue.write_buffer(&self.uniforms, 2 * STRIDE * first as u64, bytes);
    }

    /// Indices of some neighbours are counted up from nothing; one instance each.
    fn write_nothing_found(
        &self,
        queue: &wgpu::Queue,
        first: usize,
        made: &[GpuVolumeCaster],
        bytes: &mut Vec<u8>,
    ) {
        bytes.clear();
        for made in made {
            bytes.extend_from_slice(bytemuck::bytes_of(&[0, 1, made.first_index, 0, 0, 0, 0, 0u32]));
        }
        queue.write_buffer(&self.counts, 4 * COUNTS * first as u64, bytes);
    }
}

/// Calls `write` for each run of neighbours that are marked.
fn for_runs(marked: &[bool], mut write: impl FnMut(Range<usize>)) {
    let mut start = 0;
    for run in marked.chunk_by(|a, b| a == b) {
        if run[0] {
            write(start..start + run.len());
        }
        start += run.len();
    }
}

/// The casters of one light: none, to begin with.
#[derive(Debug, Default)]
pub struct VolumeLight {
    casters: Vec<VolumeCaster>,
    /// The same as they are on the GPU, and as they are to be.
    made: Vec<GpuVolumeCaster>,
    next: Vec<GpuVolumeCaster>,
    /// Whose faces have to be found?
    stale: Vec<bool>,
    /// While it is told: whose numbers are others, and whose faces, and what is written of them.
    moved: Vec<bool>,
    anew: Vec<bool>,
    bytes: Vec<u8>,
    pub(super) room: Option<Room>,
}

/// The faces of a light's casters may be more than a buffer of this device holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "the faces of these volumes do not fit into a buffer of this device; use the technique `linear`, or meshes with fewer triangles"
)]
pub struct TooManyFaces;

impl VolumeLight {
    /// Says which casters it has. What is as it was costs nothing, buffers that are large enough stay, and only faces that may have
    /// changed are found anew. `clip_from_world` is a uniform buffer that holds that matrix, for all lights; it and `pipelines` are
    /// those that the light was first told of.
    ///
    /// Memory: for each caster 512 bytes, and 24 for each edge and cap triangle that its mesh may show.
    ///
    /// # Errors
    /// [`TooManyFaces`]; the light then has no caster.
    pub fn tell(
        &mut self,
        (device, queue): (&wgpu::Device, &wgpu::Queue),
        pipelines: &VolumePipelines,
        meshes: &[Option<VolumeMesh>],
        casters: &[VolumeCaster],
        clip_from_world: &wgpu::Buffer,
    ) -> Result<(), TooManyFaces> {
        if self.casters == casters {
            return Ok(());
        }
        let Some(indices) = self.lay_out(meshes, casters) else { return Err(self.refuse()) };
        let limits = device.limits();
        let index_bytes = 4 * u64::from(indices).max(4);
        let most = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        if index_bytes > most || 2 * STRIDE * casters.len() as u64 > most {
            return Err(self.refuse());
        }
        let count = casters.len().max(1) as u64;
        let room = match self.room.take().filter(|room| room.holds(count, index_bytes)) {
            Some(room) => room,
            None => {
                self.made.clear();
                self.casters.clear();
                Room::new(device, pipelines, count, index_bytes, clip_from_world)
            }
        };
        self.stale.resize(casters.len(), false);
        self.moved.clear();
        self.anew.clear();
        for (number, (caster, next)) in casters.iter().zip(&self.next).enumerate() {
            let was = self.made.get(number);
            let is_same_mesh = self
                .casters
                .get(number)
                .is_some_and(|was| (was.mesh, was.version) == (caster.mesh, caster.version));
            let is_anew = !is_same_mesh || was.is_none_or(|was| !was.has_faces_of(next));
            self.moved.push(was != Some(next));
            self.anew.push(is_anew);
            if is_anew {
                self.stale[number] = pipelines.finds_faces() && next.edges > 0;
            }
        }
        let (next, bytes) = (&self.next, &mut self.bytes);
        for_runs(&self.moved, |run| room.write_casters(queue, run.start, &next[run], bytes));
        for_runs(&self.anew, |run| room.write_nothing_found(queue, run.start, &next[run], bytes));
        self.room = Some(room);
        std::mem::swap(&mut self.made, &mut self.next);
        self.casters.clear();
        self.casters.extend_from_slice(casters);
        Ok(())
    }

    /// Says where the indices of each caster go; and how many there are.
    fn lay_out(&mut self, meshes: &[Option<VolumeMesh>], casters: &[VolumeCaster]) -> Option<u32> {
        self.next.clear();
        let mut first_index = 0;
        for (number, caster) in casters.iter().enumerate() {
            let made = match meshes.get(caster.mesh).and_then(Option::as_ref) {
                Some(mesh) => {
                    let (made, next) = gpu_caster(caster, mesh, number, first_index)?;
                    first_index = next;
                    made
                }
                None => bytemuck::Zeroable::zeroed(),
            };
            self.next.push(made);
        }
        Some(first_index)
    }

    fn refuse(&mut self) -> TooManyFaces {
        *self = Self::default();
        TooManyFaces
    }

    /// Its casters, by their numbers.
    pub fn casters(&self) -> &[VolumeCaster] {
        &self.casters
    }

    /// For how many casters faces have to be found.
    pub fn stale_casters(&self) -> usize {
        self.stale.iter().filter(|stale| **stale).count()
    }

    /// Has the faces of a caster to be found?
    pub(super) fn is_stale(&self, number: usize) -> bool {
        self.stale.get(number).is_some_and(|stale| *stale)
    }

    /// All faces hold from now on: [`super::find_silhouettes`] was recorded.
    pub fn found(&mut self) {
        self.stale.fill(false);
    }

    /// Forgets all faces, so that they are found once more: from the next submission on.
    pub fn forget(&mut self, queue: &wgpu::Queue, pipelines: &VolumePipelines) {
        let Some(room) = &self.room else { return };
        room.write_nothing_found(queue, 0, &self.made, &mut self.bytes);
        for (made, stale) in self.made.iter().zip(&mut self.stale) {
            *stale = pipelines.finds_faces() && made.edges > 0;
        }
    }

    /// For each caster eight numbers, of which the first is how many indices were found, the sixth how many silhouette edges and
    /// the seventh how many lids. To be copied and read back; `None` before the first caster.
    pub fn counts(&self) -> Option<&wgpu::Buffer> {
        self.room.as_ref().map(|room| &room.counts)
    }

    /// Memory, bytes.
    pub fn memory_bytes(&self) -> u64 {
        self.room.as_ref().map_or(0, |room| room.uniforms.size() + room.counts.size() + room.indices.size())
    }

    pub(super) fn offset(&self, number: usize, reversed: bool) -> u32 {
        (2 * number as u32 + u32::from(reversed)) * STRIDE as u32
    }

    pub(super) fn counts_offset(&self, number: usize) -> u64 {
        4 * COUNTS * number as u64
    }
}
