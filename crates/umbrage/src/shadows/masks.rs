//! Projective masks of lights: of each caster one, looked up inline or taken away from V on the screen.

use super::casters::Casters;
use super::handles::{Store, index};
use super::lights::Lit;
use super::meshes::{Mesh, VertexKind};
use super::screen::V;
use super::{Frame, ShadowsError};
use crate::caster::{CasterVertices, GpuInstance, NO_DEFORM};
use crate::growing::Growing;
use crate::mask::{
    Blocker, BlockerMasks, MaskPart, MaskPipelines, MaskWarning, Receiver, SubtractDepth, SubtractPipelines,
    Subtraction, mask_range, record_subtract,
};
use slotmap::DefaultKey;
use umbrage_core::Aabb;
use umbrage_core::layout_mask::GpuMask;
use umbrage_core::masks::{Picture, Shadow};
use umbrage_core::technique::Settings;

/// What is drawn once more to be darkened.
#[derive(Debug)]
struct Darkened {
    mesh: DefaultKey,
    kind: VertexKind,
    object: u32,
    bounds_world: Aabb,
}

/// The masks of all lights.
#[derive(Debug)]
pub(super) struct Masks {
    settings: Settings,
    pub blockers: BlockerMasks,
    pipelines: Vec<(VertexKind, MaskPipelines)>,
    subtractions: Vec<(VertexKind, Subtraction)>,
    /// Each caster's number and mesh.
    parts: Vec<(u32, MaskPart)>,
    /// Meshes by their numbers.
    meshes: Vec<DefaultKey>,
    darkened: Vec<Darkened>,
    placed: Vec<GpuInstance>,
    instances: Growing,
    /// Casters that a light leaves to maps, while they are compared with those that it left before.
    left: Vec<usize>,
}

fn vertices(kind: VertexKind) -> CasterVertices<'static> {
    CasterVertices { stride: kind.stride, format: kind.format, deform: NO_DEFORM }
}

impl Masks {
    /// Without any, but for one that is bound until there are others.
    pub fn new(
        device: &wgpu::Device,
        settings: &Settings,
        cut_out_layout: &wgpu::BindGroupLayout,
    ) -> Result<Self, ShadowsError> {
        Ok(Self {
            blockers: BlockerMasks::new(device, settings, 1, 1, cut_out_layout, &CasterVertices::default())?,
            settings: settings.clone(),
            pipelines: Vec::new(),
            subtractions: Vec::new(),
            parts: Vec::new(),
            meshes: Vec::new(),
            darkened: Vec::new(),
            placed: Vec::new(),
            instances: Growing::new(device, "umbrage receivers", wgpu::BufferUsages::VERTEX, 0),
            left: Vec::new(),
        })
    }

    /// Tells masks what there is; true when what is bound is another now.
    #[allow(clippy::too_many_arguments, reason = "they are what shadows are made of, and it has one caller")]
    pub fn tell(
        &mut self,
        (device, queue): (&wgpu::Device, &wgpu::Queue),
        cut_out_layout: &wgpu::BindGroupLayout,
        frame: &Frame,
        depth_format: Option<wgpu::TextureFormat>,
        lights: &mut Store<Lit>,
        meshes: &Store<Mesh>,
        casters: &Casters,
        scene_world: &Aabb,
    ) -> Result<bool, ShadowsError> {
        let count = lights.iter().filter(|(_, lit)| lit.is_masked()).count();
        if count == 0 && self.blockers.count() == 0 {
            return Ok(false);
        }
        let mut is_other = false;
        if count > self.blockers.lights() {
            let vertices = CasterVertices::default();
            self.blockers = BlockerMasks::new(device, &self.settings, count, 1, cut_out_layout, &vertices)?;
            self.subtractions.clear();
            is_other = true;
        }
        let changes = self.blockers.changes();
        let picture =
            Picture { clip_from_world: frame.clip_from_world(), depth: frame.depth, size: frame.size_px };
        let of_casters = casters
            .all
            .iter()
            .map(|(key, caster)| Receiver { object: index(key) as u32, bounds_world: caster.bounds_world });
        let others = casters
            .receivers
            .iter()
            .map(|(_, other)| Receiver { object: GpuMask::NO_OWNER, bounds_world: other.bounds_world });
        self.blockers.begin(&picture, 0.0, of_casters.chain(others));
        if count > 0 {
            self.list_parts(device, cut_out_layout, meshes, casters);
        }
        let masked = lights.iter_mut().filter(|(_, lit)| lit.is_masked());
        for (number, (_, lit)) in masked.enumerate() {
            let blockers = self
                .parts
                .iter()
                .map(|(object, part)| Blocker { object: *object, parts: std::slice::from_ref(part) });
            let told = self.blockers.tell(number, &lit.light, &lit.settings, scene_world, blockers)?;
            self.left.clear();
            let mut is_crowded = false;
            for warning in told {
                match warning {
                    MaskWarning::Unmaskable { object, .. } => self.left.push(*object as usize),
                    _ => is_crowded = true,
                }
            }
            lit.mask_number = number;
            lit.is_crowded = is_crowded;
            if !is_crowded && self.left != lit.left_to_maps {
                leave(lit, &self.left);
            }
        }
        self.blockers.finish(device, queue)?;
        for (_, lit) in lights.iter_mut().filter(|(_, lit)| lit.is_masked()) {
            if lit.is_crowded {
                self.leave_rest(lit);
            }
            let range = self.blockers.of_light(lit.mask_number);
            lit.masks = if lit.is_subtractive { 0 } else { mask_range(&range) };
        }
        let format = depth_format.filter(|_| lights.iter().any(|(_, lit)| lit.is_subtractive));
        if let Some(format) = format {
            self.tell_darkened((device, queue), frame, format, meshes, casters);
        }
        Ok(is_other || changes != self.blockers.changes())
    }

    /// More blockers than a light may have masks: maps draw those that got none.
    fn leave_rest(&mut self, lit: &mut Lit) {
        let range = self.blockers.of_light(lit.mask_number);
        let masked =
            |object: u32| range.clone().any(|n| self.blockers.get(n).is_some_and(|m| m.object == object));
        self.left.clear();
        self.left
            .extend(self.parts.iter().map(|(object, _)| *object).filter(|o| !masked(*o)).map(|o| o as usize));
        if self.left != lit.left_to_maps {
            leave(lit, &self.left);
        }
    }

    fn list_parts(
        &mut self,
        device: &wgpu::Device,
        cut_out_layout: &wgpu::BindGroupLayout,
        meshes: &Store<Mesh>,
        casters: &Casters,
    ) {
        self.meshes.clear();
        for (key, mesh) in meshes.iter() {
            let number = index(key);
            self.meshes.resize(self.meshes.len().max(number + 1), DefaultKey::default());
            self.meshes[number] = key;
            if !self.pipelines.iter().any(|(kind, _)| *kind == mesh.kind) {
                let made = MaskPipelines::new(device, cut_out_layout, &vertices(mesh.kind));
                self.pipelines.push((mesh.kind, made));
            }
        }
        self.parts.clear();
        self.parts.extend(casters.all.iter().filter_map(|(key, caster)| {
            let mesh = caster.mesh?;
            let part = MaskPart {
                mesh: index(mesh.key) as u32,
                version: meshes.at(mesh.key)?.version,
                world_from_object: caster.world_from_object,
                bounds_world: caster.bounds_world,
            };
            Some((index(key) as u32, part))
        }));
    }

    /// Lists what is drawn once more to be darkened.
    fn tell_darkened(
        &mut self,
        (device, queue): (&wgpu::Device, &wgpu::Queue),
        frame: &Frame,
        format: wgpu::TextureFormat,
        meshes: &Store<Mesh>,
        casters: &Casters,
    ) {
        self.darkened.clear();
        self.placed.clear();
        let of_casters = casters
            .all
            .iter()
            .map(|(key, caster)| (caster.mesh, caster.placed, index(key) as u32, caster.bounds_world));
        let others = casters
            .receivers
            .iter()
            .map(|(_, other)| (other.mesh, other.placed, GpuMask::NO_OWNER, other.bounds_world));
        for (mesh, placed, object, bounds_world) in of_casters.chain(others) {
            let Some(mesh) = mesh.map(|mesh| mesh.key) else { continue };
            let Some(of_mesh) = meshes.at(mesh).filter(|mesh| mesh.cut_out.is_none()) else { continue };
            self.placed.push(placed);
            self.darkened.push(Darkened { mesh, kind: of_mesh.kind, object, bounds_world });
        }
        self.instances.write(device, queue, bytemuck::cast_slice(&self.placed));
        let eye_world = if frame.is_parallel() {
            let towards = frame.view_from_world.inverse().z_axis;
            towards.truncate().normalize_or_zero().extend(0.0)
        } else {
            frame.eye_world().extend(1.0)
        };
        for (_, mesh) in meshes.iter() {
            if self.subtractions.iter().any(|(kind, _)| *kind == mesh.kind) {
                continue;
            }
            let depth = SubtractDepth::inexact(format, frame.depth);
            let pipelines = SubtractPipelines::new(device, depth, V, &vertices(mesh.kind));
            self.subtractions.push((mesh.kind, Subtraction::new(device, pipelines, &self.blockers)));
        }
        for (_, subtraction) in &mut self.subtractions {
            subtraction.write(device, queue, &self.blockers, eye_world, 0.0);
        }
    }

    /// Draws masks that do not hold what they should; how many.
    pub fn record(&mut self, encoder: &mut wgpu::CommandEncoder, meshes: &Store<Mesh>) -> u64 {
        let Self { blockers, pipelines, meshes: keys, .. } = self;
        let drawn = blockers.record(
            encoder,
            false,
            |_| None,
            |recorded, _, mask| {
                for (at, part) in (mask.first_instance..).zip(mask.parts) {
                    let mesh = keys.get(part.mesh as usize).and_then(|key| meshes.at(*key));
                    let of_kind = |mesh: &Mesh| {
                        let found = pipelines.iter().find(|(kind, _)| *kind == mesh.kind);
                        found.map(|(_, pipelines)| pipelines)
                    };
                    let Some((mesh, pipelines)) = mesh.and_then(|mesh| Some((mesh, of_kind(mesh)?))) else {
                        continue;
                    };
                    if let Some(cut_out) = &mesh.cut_out {
                        recorded.set_pipeline(&pipelines.cut_out);
                        recorded.set_bind_group(1, &cut_out.group, &[]);
                        recorded.set_vertex_buffer(2, cut_out.vertices.slice(cut_out.offset..));
                    } else {
                        recorded.set_pipeline(&pipelines.solid);
                    }
                    mesh.draw(recorded, at..at + 1);
                }
            },
        );
        drawn as u64
    }

    /// Takes a light's masks away from its V.
    pub fn record_subtract(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        depth_stencil: &wgpu::TextureView,
        v: &wgpu::TextureView,
        number: usize,
        meshes: &Store<Mesh>,
    ) {
        let Some(picture) = self.blockers.picture() else { return };
        record_subtract(encoder, depth_stencil, v, None, |recorded| {
            for (kind, subtraction) in &self.subtractions {
                recorded.set_vertex_buffer(1, self.instances.buffer.slice(..));
                subtraction.draw(recorded, &self.blockers, number, |recorded, mask| {
                    let shadow = Shadow::new(mask.view, picture);
                    for (at, darkened) in (0u32..).zip(&self.darkened) {
                        let is_other = darkened.object != mask.object || darkened.object == GpuMask::NO_OWNER;
                        if darkened.kind != *kind || !is_other || shadow.on(&darkened.bounds_world).is_none()
                        {
                            continue;
                        }
                        if let Some(mesh) = meshes.at(darkened.mesh) {
                            mesh.draw(recorded, at..at + 1);
                        }
                    }
                });
            }
        });
    }

    /// Memory, bytes.
    pub fn memory_bytes(&self) -> u64 {
        self.blockers.memory_bytes() + self.subtractions.iter().map(|(_, s)| s.memory_bytes()).sum::<u64>()
    }
}

/// Leaves casters to maps.
fn leave(lit: &mut Lit, left: &[usize]) {
    lit.left_to_maps.clear();
    lit.left_to_maps.extend_from_slice(left);
    lit.views.iter_mut().for_each(super::views::View::redraw);
    lit.fit_is_stale = true;
}
