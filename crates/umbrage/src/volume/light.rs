//! A light's casters on the GPU, and the faces that a compute pass finds for them.

use super::{VolumeMesh, VolumePipelines};
use glam::{Mat4, Vec4};
use std::num::NonZeroU64;
use umbrage_core::volume::{is_mirrored, light_point_object};

/// Which way round the front of a caster's triangles runs on the screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Winding {
    /// As in the mesh.
    AsIs,
    /// Its transform mirrors, or its reverse is drawn.
    Turned,
}

impl Winding {
    /// Turned once more, if so asked.
    pub fn turned(self, also: bool) -> Self {
        if (self == Self::Turned) == also { Self::AsIs } else { Self::Turned }
    }
}

/// A caster of a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VolumeCaster {
    /// Index into the list of meshes.
    pub mesh: usize,
    /// Counts how often the mesh got another shape: a volume holds as long as this and all else here.
    pub version: u64,
    /// Affine.
    pub world_from_object: Mat4,
    /// The light: see [`umbrage_core::volume::light_point_world`].
    pub light_world: Vec4,
    /// How far behind the surface, along the light, the volume begins, metres.
    pub inset_m: f32,
    /// How long it is, metres; 0: as long as `far_plane_world` says.
    pub extrude_m: f32,
    /// Where it ends: see [`umbrage_core::volume::far_plane_world`]. `None`: nowhere.
    pub far_plane_world: Option<Vec4>,
    /// Closed parts cast from both sides too: for a light that may be inside of them.
    pub both_sides: bool,
    /// Lids at the lit surface: for faces counted behind, and for open meshes.
    pub near_caps: bool,
    /// Lids at the far end: for faces counted behind, and where the eye may see it.
    pub far_caps: bool,
    /// Follows from the transform: see [`VolumeCaster::winding_of`].
    pub winding: Winding,
}

impl VolumeCaster {
    /// Has it lids at all?
    pub fn has_caps(&self) -> bool {
        self.near_caps || self.far_caps
    }

    /// With the lids of `kept` too, if that is the same caster otherwise: faces that were found with lids are right without need for
    /// them, and need not be found again when the eye leaves a shadow.
    pub fn keeping_lids(self, kept: &Self) -> Self {
        let lids = Self { near_caps: kept.near_caps, far_caps: kept.far_caps, ..self };
        let both = Self {
            near_caps: self.near_caps || kept.near_caps,
            far_caps: self.far_caps || kept.far_caps,
            ..self
        };
        if lids == *kept { both } else { self }
    }

    /// The winding of a transform.
    pub fn winding_of(world_from_object: &Mat4) -> Winding {
        if is_mirrored(world_from_object) { Winding::Turned } else { Winding::AsIs }
    }

    /// Parallel light without end: all of the volume's far end is one place.
    fn ends_in_a_point(&self) -> bool {
        self.light_world.w == 0.0 && self.extrude_m <= 0.0 && self.far_plane_world.is_none()
    }
}

/// Mirrors `VolumeCaster` of `wgsl/volume_caster.wgsl`; see there for what each field means.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
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

/// The casters of one light.
#[derive(Debug)]
pub struct VolumeLight {
    casters: Vec<VolumeCaster>,
    /// Each twice: as it is, and reversed.
    uniforms: wgpu::Buffer,
    pub(super) counts: wgpu::Buffer,
    pub(super) indices: wgpu::Buffer,
    pub(super) silhouette_group: wgpu::BindGroup,
    pub(super) draw_group: wgpu::BindGroup,
}

impl VolumeLight {
    /// Room for a light's casters, and the numbers of each. `clip_from_world` is a uniform buffer that holds that matrix, for all
    /// lights. `None` when their faces may be more than a buffer of this device holds.
    ///
    /// Memory: for each caster 512 bytes, and 24 for each edge and cap triangle that its mesh may show.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        pipelines: &VolumePipelines,
        meshes: &[Option<VolumeMesh>],
        casters: Vec<VolumeCaster>,
        clip_from_world: &wgpu::Buffer,
    ) -> Option<Self> {
        let mut uniforms = vec![0u8; (2 * STRIDE) as usize * casters.len().max(1)];
        let mut counts = vec![0u32; COUNTS as usize * casters.len().max(1)];
        let mut first_index = 0u32;
        for (number, caster) in casters.iter().enumerate() {
            let Some(mesh) = meshes.get(caster.mesh).and_then(Option::as_ref) else { continue };
            let flags = [
                (caster.both_sides, BOTH_SIDES),
                (caster.near_caps, NEAR_CAPS),
                // They would be one place.
                (caster.far_caps && !caster.ends_in_a_point(), FAR_CAPS),
                (caster.ends_in_a_point(), ENDS_IN_A_POINT),
            ];
            let flags = flags.iter().filter(|(on, _)| *on).map(|(_, flag)| flag).sum();
            let first_count = COUNTS as u32 * number as u32;
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
                first_count,
                flags,
                reversed: 0,
                first_back: mesh.first_back(),
                pad: [0; 3],
            };
            for (reversed, twin) in [(0, 2 * number), (1, 2 * number + 1)] {
                let at = twin * STRIDE as usize;
                let made = GpuVolumeCaster { reversed, ..made };
                uniforms[at..at + size_of::<GpuVolumeCaster>()].copy_from_slice(bytemuck::bytes_of(&made));
            }
            // Indices are counted up from nothing; one instance.
            counts[first_count as usize + 1] = 1;
            counts[first_count as usize + 2] = first_index;
            let of_quad = if caster.ends_in_a_point() { 3 } else { 6 };
            let of_cap = 3 * ((flags & NEAR_CAPS) / NEAR_CAPS + (flags & FAR_CAPS) / FAR_CAPS);
            first_index = first_index.checked_add(mesh.most_indices(caster.both_sides, of_quad, of_cap))?;
        }
        let limits = device.limits();
        let bytes = 4 * u64::from(first_index).max(4);
        if bytes > limits.max_storage_buffer_binding_size.min(limits.max_buffer_size) {
            return None;
        }
        use wgpu::BufferUsages as Usage;
        let buffer = |label, size, usage| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        let uniform = buffer("volume casters", uniforms.len() as u64, Usage::UNIFORM | Usage::COPY_DST);
        let count_usage = Usage::STORAGE | Usage::INDIRECT | Usage::COPY_DST | Usage::COPY_SRC;
        let count_buffer = buffer("volume counts", 4 * counts.len() as u64, count_usage);
        let indices = buffer("volume indices", bytes, Usage::STORAGE | Usage::INDEX);
        queue.write_buffer(&uniform, 0, &uniforms);
        queue.write_buffer(&count_buffer, 0, bytemuck::cast_slice(&counts));
        let caster = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: &uniform,
            offset: 0,
            size: NonZeroU64::new(size_of::<GpuVolumeCaster>() as u64),
        });
        let group = |label, layout, resources: Vec<wgpu::BindingResource<'_>>| {
            let entries: Vec<_> = (0u32..)
                .zip(resources)
                .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
                .collect();
            device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some(label),
                layout,
                entries: &entries,
            })
        };
        Some(Self {
            silhouette_group: group(
                "silhouettes",
                &pipelines.silhouette_layout,
                vec![caster.clone(), count_buffer.as_entire_binding(), indices.as_entire_binding()],
            ),
            draw_group: group(
                "volumes",
                &pipelines.draw_layout,
                vec![caster, clip_from_world.as_entire_binding()],
            ),
            casters,
            uniforms: uniform,
            counts: count_buffer,
            indices,
        })
    }

    /// Its casters, by their numbers.
    pub fn casters(&self) -> &[VolumeCaster] {
        &self.casters
    }

    /// Makes the counts nothing again, before the faces are found once more: from the next submission on.
    pub fn clear_counts(&self, queue: &wgpu::Queue) {
        for number in 0..self.casters.len() {
            let at = self.counts_offset(number);
            queue.write_buffer(&self.counts, at, bytemuck::bytes_of(&0u32));
            queue.write_buffer(&self.counts, at + 20, bytemuck::cast_slice(&[0u32; 2]));
        }
    }

    /// For each caster eight numbers, of which the first is how many indices were found, the sixth how many silhouette edges and
    /// the seventh how many lids. To be copied and read back.
    pub fn counts(&self) -> &wgpu::Buffer {
        &self.counts
    }

    /// Memory, bytes.
    pub fn memory_bytes(&self) -> u64 {
        self.uniforms.size() + self.counts.size() + self.indices.size()
    }

    pub(super) fn offset(&self, number: usize, reversed: bool) -> u32 {
        (2 * number as u32 + u32::from(reversed)) * STRIDE as u32
    }

    pub(super) fn counts_offset(&self, number: usize) -> u64 {
        4 * COUNTS * number as u64
    }
}
