//! The volumes of any number of lights over one depth, for a renderer that knows casters and matrices and nothing of stencils.

mod meshes;
mod record;
mod sight;
mod told;

pub use record::{PassWatch, VolumePass, VolumeWork};
pub use sight::CUT_LENGTHS;
pub use told::{VolumeEye, VolumeItem, VolumeProblem, VolumeSettings};

use super::{COUNT_FORMATS, Counted, VolumeCaster, VolumeLight, VolumeMesh, VolumePipelines};
use crate::caster::unclipped;
use crate::soften::Softener;
use glam::{Mat4, Vec3};
use meshes::{Formats, Meshes};
use record::Soft;
use sight::{Lit, Sight};
use umbrage_core::technique::volume::Silhouette;
use umbrage_core::volume as maths;
use umbrage_core::volume::Scissor;
use umbrage_core::{Aabb, DepthConvention, Light};

/// More lights than anybody has; lists are as long as the greatest slot.
const MOST_LIGHTS: usize = 1 << 16;

/// The volumes of one light.
#[derive(Debug, Default)]
struct Slot {
    /// When it was told of last; 0: never.
    told: u64,
    settings: Option<VolumeSettings>,
    volumes: VolumeLight,
    /// Casters whose shadow may be seen, by their numbers.
    draw: Vec<(usize, Counted)>,
    /// `None`: the light reaches nothing that is seen.
    scissor: Option<Scissor>,
    soft: Option<Soft>,
}

/// The volumes of lights over one depth, seen by one eye.
///
/// Each frame: [`Self::begin`], [`Self::tell`] for each light, and [`Self::record`] after the surfaces' depth. Each light may have
/// settings of its own. What did not change costs no pass, no upload and no allocation here: faces hold until their light or caster
/// moves, and lists keep their memory. A second eye in the same submission needs a second value, because both would write one matrix.
///
/// Where depth is clipped ([`crate::caster::unclipped`]) the eye's projection should have no far plane: see [`super`]. Volumes that
/// would be cut are ended before it where all of their light meets it; the others are told as [`VolumeProblem::CutByFarPlane`].
#[derive(Debug)]
pub struct ScreenVolumes {
    device: wgpu::Device,
    queue: wgpu::Queue,
    meshes: Meshes,
    clip_from_world: wgpu::Buffer,
    sight: Option<Sight>,
    slots: Vec<Slot>,
    softener: Option<Softener>,
    /// Of the slot that is told, before it is compared.
    casters: Vec<VolumeCaster>,
    problems: Vec<VolumeProblem>,
    /// Counts frames.
    telling: u64,
    casters_found: u64,
}

/// What there is of a light.
#[derive(Clone, Copy, Debug)]
pub struct ToldVolumes<'a> {
    /// Its casters and their faces.
    pub light: &'a VolumeLight,
    /// Casters whose shadow may be seen, by their numbers, and how each is counted.
    pub draw: &'a [(usize, Counted)],
    /// The pixels that the light may reach; `None`: none.
    pub scissor: Option<Scissor>,
    /// How they are drawn.
    pub settings: &'a VolumeSettings,
    /// What casters' meshes index.
    pub meshes: &'a [Option<VolumeMesh>],
    /// What counts them, and makes pipelines that draw them in another way.
    pub pipelines: &'a VolumePipelines,
}

impl ScreenVolumes {
    /// Volumes over a depth of `depth_format`, one of [`super::COUNT_FORMATS`], that runs as `depth` says, both in the buffer and in the
    /// eye's projection, and has one sample a pixel; V is written to targets of `v_format`. Pipelines are made when a light first needs
    /// them, or by [`Self::prepare`].
    ///
    /// # Errors
    /// [`VolumeProblem::Format`] for another format.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        depth_format: wgpu::TextureFormat,
        depth: DepthConvention,
        v_format: wgpu::TextureFormat,
    ) -> Result<Self, VolumeProblem> {
        if !COUNT_FORMATS.contains(&depth_format) {
            return Err(VolumeProblem::Format { format: depth_format });
        }
        let clip_from_world = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("volume eye"),
            size: size_of::<Mat4>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        Ok(Self {
            device: device.clone(),
            queue: queue.clone(),
            meshes: Meshes::new(Formats { depth: depth_format, v: v_format, convention: depth }),
            clip_from_world,
            sight: None,
            slots: Vec::new(),
            softener: None,
            casters: Vec::new(),
            problems: Vec::new(),
            telling: 1,
            casters_found: 0,
        })
    }

    /// Makes the pipelines of one way to find faces now, and all meshes for it: no light then waits for them. Cost: a compute and
    /// thirteen render pipelines, and the upload of every mesh.
    pub fn prepare(&mut self, silhouette: Silhouette) -> Option<&VolumePipelines> {
        self.meshes.prepare(&self.device, silhouette);
        self.pipelines(silhouette)
    }

    /// The pipelines of one way to find faces, where they were made.
    pub fn pipelines(&self, silhouette: Silhouette) -> Option<&VolumePipelines> {
        self.meshes.mode(silhouette).map(|mode| &mode.pipelines)
    }

    /// Sets a mesh, or gives it another shape: positions in object space, metres, three indices a triangle. Any mesh will do, closed
    /// or not; what names no position is left out. `index` is the caller's, from 0 on without large gaps.
    ///
    /// Cost: its edges are found (0.4 microseconds a triangle). Memory: see [`VolumeMesh::new`], for each way to find faces that a
    /// light uses; and on the CPU 12 bytes a vertex, about 60 a triangle.
    ///
    /// # Errors
    /// [`VolumeProblem::MeshTooLarge`] for the device's buffers, of a way to find faces that was made already; it is set all the same,
    /// for the other. [`VolumeProblem::TooMany`] for an index beyond reason.
    pub fn set_mesh(
        &mut self,
        index: usize,
        positions: &[Vec3],
        indices: &[u32],
    ) -> Result<(), VolumeProblem> {
        self.meshes.set(&self.device, index, positions, indices)
    }

    /// Takes a mesh away; nothing where there is none. Casters of it are told as [`VolumeProblem::NoMesh`] from then on.
    pub fn remove_mesh(&mut self, index: usize) {
        self.meshes.remove(index);
    }

    /// Tells shapes of a mesh apart: another number after each [`Self::set_mesh`], whatever the index. `None` where there is no mesh.
    pub fn mesh_version(&self, index: usize) -> Option<u64> {
        self.meshes.version(index)
    }

    /// Begins to tell a frame. Lights that were not told of since the last time are dropped.
    pub fn begin(&mut self, eye: &VolumeEye) {
        let telling = self.telling;
        self.slots.iter_mut().filter(|slot| slot.told != telling).for_each(|slot| *slot = Slot::default());
        self.telling += 1;
        self.problems.clear();
        let was = self.sight.as_ref().map(|sight| sight.eye);
        if was == Some(*eye) {
            return;
        }
        if was.is_none_or(|was| was.clip_from_world != eye.clip_from_world) {
            self.queue.write_buffer(&self.clip_from_world, 0, bytemuck::bytes_of(&eye.clip_from_world));
        }
        self.sight = Some(Sight::new(eye, self.meshes.formats.convention, unclipped(&self.device)));
    }

    /// Says what a light is and which casters it has, after [`Self::begin`]: `light` must be one that [`Light::check`] lets through.
    /// `scene_world` is a box around all that the light may darken and all casters: volumes end behind it. Casters that the light does
    /// not reach are left out; those that are seen to shadow nothing, such as floors, are the caller's to leave out. What did not go
    /// well is in [`Self::problems`].
    ///
    /// Cost: about half a microsecond a caster where nothing moved, one where all did (10,000 casters, one core).
    pub fn tell(
        &mut self,
        slot: usize,
        light: &Light,
        settings: &VolumeSettings,
        scene_world: &Aabb,
        items: impl IntoIterator<Item = VolumeItem>,
    ) {
        let Some(sight) = self.sight else { return };
        if slot >= MOST_LIGHTS {
            self.problems.push(VolumeProblem::TooMany { what: "light", number: slot, limit: MOST_LIGHTS });
            return;
        }
        if self.slots.len() <= slot {
            self.slots.resize_with(slot + 1, Slot::default);
        }
        let silhouette = settings.choices.silhouette;
        self.meshes.prepare(&self.device, silhouette);
        let Some(mode) = self.meshes.mode(silhouette) else { return };
        let of_light = &mut self.slots[slot];
        if of_light.settings.is_some_and(|was| was.choices.silhouette != silhouette) {
            of_light.volumes = VolumeLight::default();
        }
        (of_light.told, of_light.settings) = (self.telling, Some(*settings));
        of_light.draw.clear();
        self.casters.clear();
        let eye = &sight.eye;
        of_light.scissor = maths::lit_pixels(light, scene_world, eye.clip_from_world, eye.size_px);
        let light_world = maths::light_point_world(light);
        let lit = Lit { light, light_world, scene_world, settings };
        for item in items {
            if item.bounds_world.is_empty() || !maths::light_may_reach(light, &item.bounds_world) {
                continue;
            }
            let mesh = match self.meshes.known(silhouette, item.mesh) {
                Ok(Some(mesh)) => mesh,
                Ok(None) => continue,
                Err(problem) => {
                    note(&mut self.problems, problem);
                    continue;
                }
            };
            let seen = sight.of(&lit, &item, mesh);
            let number = self.casters.len();
            if seen.is_seen {
                of_light.draw.push((number, seen.counted));
            }
            if seen.is_cut {
                note(&mut self.problems, VolumeProblem::CutByFarPlane { light: slot });
            }
            let kept = of_light.volumes.casters().get(number);
            self.casters.push(kept.map_or(seen.caster, |kept| seen.caster.keeping_lids(kept)));
        }
        let gpu = (&self.device, &self.queue);
        let (pipelines, meshes) = (&mode.pipelines, mode.meshes.as_slice());
        if of_light.volumes.tell(gpu, pipelines, meshes, &self.casters, &self.clip_from_world).is_err() {
            note(&mut self.problems, VolumeProblem::LightTooLarge { light: slot });
            of_light.draw.clear();
        }
    }

    /// What did not go well since [`Self::begin`].
    pub fn problems(&self) -> &[VolumeProblem] {
        &self.problems
    }

    /// Forgets all faces, so that the next [`Self::record`] finds them once more: for whoever measures what they cost.
    pub fn forget_faces(&mut self) {
        for slot in &mut self.slots {
            let silhouette = slot.settings.map(|settings| settings.choices.silhouette);
            if let Some(mode) = silhouette.and_then(|silhouette| self.meshes.mode(silhouette)) {
                slot.volumes.forget(&self.queue, &mode.pipelines);
            }
        }
    }

    /// For how many casters faces were found since [`Self::new`], each light's counted. With split edges nothing is found.
    pub fn casters_found(&self) -> u64 {
        self.casters_found
    }

    /// What there is of a light; `None` where it was not told of.
    pub fn told(&self, slot: usize) -> Option<ToldVolumes<'_>> {
        let of_light = self.slots.get(slot).filter(|of_light| of_light.told == self.telling)?;
        let settings = of_light.settings.as_ref()?;
        let mode = self.meshes.mode(settings.choices.silhouette)?;
        Some(ToldVolumes {
            light: &of_light.volumes,
            draw: if of_light.scissor.is_some() { &of_light.draw } else { &[] },
            scissor: of_light.scissor,
            settings,
            meshes: &mode.meshes,
            pipelines: &mode.pipelines,
        })
    }

    /// Memory of a light's faces, bytes; 0 for what was not told of.
    pub fn memory_of_light(&self, slot: usize) -> u64 {
        self.told(slot).map_or(0, |told| told.light.memory_bytes())
    }

    /// Memory of meshes, faces and what a blur needs, on the GPU, bytes. V and depth are the caller's.
    pub fn memory_bytes(&self) -> u64 {
        let lights: u64 = self.slots.iter().map(|slot| slot.volumes.memory_bytes()).sum();
        let soft = self.softener.as_ref().map_or(0, Softener::memory_bytes);
        self.meshes.memory_bytes() + lights + soft
    }
}

/// Notes what is not noted yet.
fn note(problems: &mut Vec<VolumeProblem>, problem: VolumeProblem) {
    if !problems.contains(&problem) {
        problems.push(problem);
    }
}
