//! Projective masks of a scene's lights: what each is drawn with, and the receivers that lie in its shadow.

use crate::draw_list::{ReceiverBatch, Work};
use crate::geometry::Geometry;
use crate::gpu::Gpu;
use crate::lights::eye_of;
use crate::maps::Growing;
use crate::materials::MaterialEntry;
use crate::moving::World;
use crate::outlines::Outlines;
use crate::screen_v::{SCREEN_V, screen_v};
use crate::timing::Queries;
use crate::{RenderError, RenderOptions};
use glam::{Mat4, UVec2};
use std::ops::Range;
use std::sync::Arc;
use umbrage::caster::{CasterVertices, NO_DEFORM};
use umbrage::core::DEPTH;
use umbrage::core::fit::MaskView;
use umbrage::core::masks::{Picture, Shadow, fit_blocker, most_of_light, size_texel};
use umbrage::core::technique::mask::Receivers;
use umbrage::core::technique::{Method, Settings};
use umbrage::layers::Layers;
use umbrage::mask::{
    Blocker, BlockerMask, BlockerMasks, MasksError, Receiver, SubtractDepth, SubtractPipelines, Subtraction,
    record_subtract,
};
use umbrage_scene::{Mesh, Scene};

/// What takes masks away from receivers, pass by pass.
#[derive(Debug)]
struct Subtract {
    subtraction: Subtraction,
    instances: Growing,
    /// For each light: what is drawn for which mask.
    draws: Vec<Vec<(usize, ReceiverBatch)>>,
    v: Layers,
}

/// The masks of all lights.
#[derive(Debug)]
pub(crate) struct Masks {
    settings: Settings,
    masks: BlockerMasks,
    outlines: Outlines,
    deforms: bool,
    subtract: Option<Subtract>,
    geometry: Arc<Geometry>,
    materials: Arc<Vec<MaterialEntry>>,
    material_of_mesh: Arc<Vec<usize>>,
}

impl From<MasksError> for RenderError {
    fn from(error: MasksError) -> Self {
        match error {
            MasksError::Shadow(error) => error.into(),
            other => Self::View(other.to_string()),
        }
    }
}

impl Masks {
    /// Makes room for as many as there may be; `None` for other families.
    #[allow(
        clippy::too_many_arguments,
        reason = "they are what a renderer is made of, and it has one caller"
    )]
    pub fn new(
        gpu: &Gpu,
        scene: &Scene,
        options: &RenderOptions,
        caster_layout: &wgpu::BindGroupLayout,
        depth: wgpu::TextureFormat,
        lights: usize,
        (geometry, materials): (&Arc<Geometry>, &Arc<Vec<MaterialEntry>>),
    ) -> Result<Option<Self>, RenderError> {
        let settings = &options.settings;
        let (Method::Mask(choices), Some(size_texel)) = (settings.method, size_texel(settings)) else {
            return Ok(None);
        };
        let device = &gpu.device;
        // At once as many as there can be: bind groups of the frame then hold.
        let most = (lights * most_of_light(lights, size_texel)).min(lights * scene.objects() as usize);
        let vertices = CasterVertices::deformed(options.deform.as_deref().unwrap_or(NO_DEFORM));
        let masks = BlockerMasks::new(device, settings, lights, most, caster_layout, &vertices)?;
        let subtract = (choices.receivers == Receivers::Subtractive).then(|| {
            let depth = SubtractDepth::exact(depth, DEPTH);
            let pipelines = SubtractPipelines::new(device, depth, SCREEN_V, &vertices);
            Subtract {
                subtraction: Subtraction::new(device, pipelines, &masks),
                instances: Growing::new(device, "receivers", wgpu::BufferUsages::VERTEX, 0),
                draws: Vec::new(),
                v: screen_v(device, options.size, lights),
            }
        });
        let reach_m = options.deform.as_ref().map(|_| options.deform_reach_m);
        Ok(Some(Self {
            settings: settings.clone(),
            masks,
            outlines: Outlines::new(device, scene, settings, &choices, reach_m),
            deforms: options.deform.is_some(),
            subtract,
            geometry: Arc::clone(geometry),
            materials: Arc::clone(materials),
            material_of_mesh: Arc::new(scene.meshes.iter().map(|m| m.material).collect()),
        }))
    }

    /// V that was found on the screen, where receivers are drawn once more.
    pub fn v(&self) -> Option<&Layers> {
        self.subtract.as_ref().map(|subtract| &subtract.v)
    }

    /// What shaders look masks up with: the list of all, the masks, their sampler.
    pub fn bindings(&self) -> (wgpu::Buffer, wgpu::TextureView, wgpu::Sampler) {
        let (list, masks, sampler) = self.masks.bindings();
        (list.clone(), masks.clone(), sampler.clone())
    }

    /// The masks of a light: the first, and how many.
    pub fn of_light(&self, light: usize) -> Range<usize> {
        self.masks.of_light(light)
    }

    /// The view of each mask.
    pub fn views(&self) -> impl Iterator<Item = &MaskView> {
        self.masks.iter().map(|mask| mask.view)
    }

    /// Gives a mesh another shape.
    pub fn reshape(&mut self, index: usize, mesh: &Mesh) {
        self.outlines.reshape(index, mesh);
    }

    /// Fits all masks to the world. What could not be fitted is said.
    pub fn tell(
        &mut self,
        gpu: &Gpu,
        world: &World,
        clip_from_world: Mat4,
        size: UVec2,
    ) -> Result<Vec<String>, RenderError> {
        let mut warnings = Vec::new();
        let picture = Picture { clip_from_world, depth: DEPTH, size };
        let time_s = if self.deforms { world.time_s } else { 0.0 };
        let receivers =
            world.items.mask_boxes().map(|(object, bounds_world)| Receiver { object, bounds_world });
        self.masks.begin(&picture, time_s, receivers);
        let Method::Mask(choices) = self.settings.method else { return Ok(warnings) };
        let (deforms, outlines) = (self.deforms, &mut self.outlines);
        let whole = world.items.whole();
        for (index, light) in world.lights.iter().enumerate().take(self.masks.lights()) {
            let blockers = world.items.mask_blockers(&light.light, &world.mesh_versions);
            let blockers = blockers.iter().map(|(object, parts)| Blocker { object: *object, parts });
            let told = self.masks.tell_fitted(
                index,
                &light.light,
                &self.settings,
                &whole,
                blockers,
                |light, blocker, options| {
                    let points = outlines.fit_points_world(blocker.parts, choices.fit_to);
                    let mut view = fit_blocker(light, points.into_iter(), &blocker.bounds_world(), options)?;
                    // The box that a mask begins behind is that of what stands still: grown by all that may move, it would take
                    // in what stands around, and darken it.
                    if deforms {
                        view.bounds_world = outlines.rest_box_world(blocker.parts);
                    }
                    Ok(view)
                },
            )?;
            warnings.extend(told.iter().map(ToString::to_string));
        }
        self.masks.finish(&gpu.device, &gpu.queue)?;
        self.tell_receivers(gpu, world, &picture);
        Ok(warnings)
    }

    /// Lists the receivers of each mask, where they are drawn once more.
    fn tell_receivers(&mut self, gpu: &Gpu, world: &World, picture: &Picture) {
        let Some(subtract) = &mut self.subtract else { return };
        let (eye, eye_w) = eye_of(&world.camera);
        let (device, queue) = (&gpu.device, &gpu.queue);
        subtract.subtraction.write(device, queue, &self.masks, eye.extend(eye_w), world.time_s);
        let mut instances = Vec::new();
        subtract.draws.clear();
        subtract.draws.resize_with(self.masks.lights().min(world.lights.len()), Vec::new);
        for mask in self.masks.iter() {
            let shadow = Shadow::new(mask.view, picture);
            let batches = world.items.mask_receivers(&shadow, mask.object, &mut instances);
            let numbered = batches.into_iter().map(|batch| (mask.number, batch));
            subtract.draws[mask.light].extend(numbered);
        }
        subtract.instances.write(device, queue, bytemuck::cast_slice(&instances));
    }

    /// The masks whose shadow may be seen and that do not hold what they should; all that may be seen when nothing is reused.
    pub fn stale(&self, reuse: bool) -> Vec<usize> {
        self.masks.stale(!reuse).collect()
    }

    /// The passes that draw these masks, then those that take them from receivers.
    pub fn pass_names(&self, drawn: &[usize]) -> [Vec<String>; 2] {
        let drawn = drawn.iter().filter_map(|number| self.masks.get(*number));
        let masks = drawn.map(|mask| format!("mask {}.{}", mask.light, mask.object)).collect();
        let subtracted = self.subtract.iter().flat_map(|subtract| 0..subtract.draws.len());
        [masks, subtracted.map(|light| format!("subtract {light}")).collect()]
    }

    /// Records the passes that draw masks, those of [`Self::stale`], measured as passes number `first` and on.
    pub fn record(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        reuse: bool,
        (queries, first): (&Queries, u32),
    ) -> Vec<Work> {
        self.outlines.tidy();
        let mut outlines = Vec::new();
        for mask in self.masks.stale(!reuse).filter_map(|number| self.masks.get(number)) {
            let of_part = |part| self.outlines.indices(part, mask.view, mask.of);
            outlines.push(mask.parts.iter().map(of_part).collect::<Vec<_>>());
        }
        self.outlines.write(&gpu.device, &gpu.queue);
        let mut works = vec![Work::default(); outlines.len()];
        let pipelines = self.masks.pipelines().clone();
        let drawn = Drawn { geometry: &self.geometry, materials: &self.materials };
        let (material_of_mesh, indices) = (&self.material_of_mesh, self.outlines.buffer());
        self.masks.record(
            encoder,
            !reuse,
            |n| queries.stamps(first + n as u32),
            |recorded, n, mask| {
                queries.count(recorded, first + n as u32, |recorded| {
                    recorded.set_index_buffer(indices.slice(..), wgpu::IndexFormat::Uint32);
                    works[n] = drawn.draw(recorded, &pipelines, mask, &outlines[n], material_of_mesh);
                });
            },
        );
        works
    }

    /// Records the passes that take masks away from receivers, measured as passes number `first` and on.
    pub fn record_subtract(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        depth_stencil: &wgpu::TextureView,
        (queries, first): (&Queries, u32),
    ) -> Vec<Work> {
        let Some(subtract) = &self.subtract else { return Vec::new() };
        let mut works = Vec::new();
        for (light, draws) in subtract.draws.iter().enumerate() {
            let pass = first + light as u32;
            let mut work = Work::default();
            let Some(v) = subtract.v.layer(light as u32) else { continue };
            record_subtract(encoder, depth_stencil, v, queries.stamps(pass), |recorded| {
                queries.count(recorded, pass, |recorded| {
                    recorded.set_index_buffer(self.geometry.indices.slice(..), wgpu::IndexFormat::Uint32);
                    recorded.set_vertex_buffer(1, subtract.instances.buffer.slice(..));
                    subtract.subtraction.draw(recorded, &self.masks, light, |recorded, mask| {
                        for (_, batch) in draws.iter().filter(|(number, _)| *number == mask.number) {
                            self.draw_receivers(recorded, batch, &mut work);
                        }
                    });
                });
            });
            works.push(work);
        }
        works
    }

    fn draw_receivers(&self, recorded: &mut wgpu::RenderPass<'_>, batch: &ReceiverBatch, work: &mut Work) {
        let (at, size) = (batch.on_screen.min, batch.on_screen.size());
        recorded.set_scissor_rect(at.x, at.y, size.x, size.y);
        let mesh = &self.geometry.meshes[batch.mesh];
        recorded.set_vertex_buffer(0, self.geometry.positions.slice(mesh.position_offset..));
        recorded.draw_indexed(mesh.indices.clone(), 0, batch.instances.clone());
        let instances = u64::from(batch.instances.end - batch.instances.start);
        work.draws += 1;
        work.instances += instances;
        work.triangles += instances * (mesh.indices.len() as u64 / 3);
    }

    /// Memory of a light's masks and V, bytes.
    pub fn memory_of_light(&self, light: usize) -> u64 {
        let v = self.subtract.as_ref().map_or(0, |subtract| subtract.v.layer_bytes());
        self.masks.memory_of_light(light) + v
    }

    /// Memory of masks, outlines and V, bytes.
    pub fn memory_bytes(&self) -> u64 {
        let v = self.subtract.as_ref().map_or(0, |subtract| subtract.v.memory_bytes());
        self.masks.maps().memory_bytes() + self.outlines.memory_bytes() + v
    }
}

/// What masks are drawn from.
struct Drawn<'a> {
    geometry: &'a Geometry,
    materials: &'a [MaterialEntry],
}

impl Drawn<'_> {
    /// Draws the outlines of a blocker's parts.
    fn draw(
        &self,
        recorded: &mut wgpu::RenderPass<'_>,
        pipelines: &umbrage::mask::MaskPipelines,
        mask: &BlockerMask<'_>,
        outlines: &[Range<u32>],
        material_of_mesh: &[usize],
    ) -> Work {
        let mut work = Work::default();
        for (instance, (part, indices)) in (mask.first_instance..).zip(mask.parts.iter().zip(outlines)) {
            let mesh = &self.geometry.meshes[part.mesh as usize];
            let group = &self.materials[material_of_mesh[part.mesh as usize]].caster;
            if let (Some(group), Some(offset)) = (group, mesh.uv_alpha_offset) {
                recorded.set_pipeline(&pipelines.cut_out);
                recorded.set_bind_group(1, group, &[]);
                recorded.set_vertex_buffer(2, self.geometry.uv_alpha.slice(offset..));
            } else {
                recorded.set_pipeline(&pipelines.solid);
            }
            recorded.set_vertex_buffer(0, self.geometry.positions.slice(mesh.position_offset..));
            recorded.draw_indexed(indices.clone(), 0, instance..instance + 1);
            work.draws += 1;
            work.instances += 1;
            work.triangles += u64::from(indices.end - indices.start) / 3;
        }
        work
    }
}
