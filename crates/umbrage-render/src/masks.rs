//! Projective masks of a scene's lights: which objects throw one, what each is drawn with, and which have to be drawn anew.

use crate::draw_list::{MaskPart, ReceiverBatch, Work};
use crate::geometry::Geometry;
use crate::gpu::Gpu;
use crate::layout::GpuInstance;
use crate::lights::eye_of;
use crate::maps::Growing;
use crate::materials::MaterialEntry;
use crate::moving::World;
use crate::outlines::Outlines;
use crate::screen_v::{SCREEN_V, screen_v};
use crate::timing::Queries;
use crate::{RenderError, RenderOptions};
use glam::{Mat4, UVec2};
use std::mem::offset_of;
use std::num::NonZeroU64;
use std::ops::Range;
use std::sync::Arc;
use umbrage::caster::{CasterVertices, GpuCasterView, NO_DEFORM};
use umbrage::core::fit::{MaskError, MaskOptions, MaskView, fit_mask};
use umbrage::core::layout_mask::GpuMask;
use umbrage::core::masks::{MOST_MASKS, Picture, Rect, Shadow, most_of_light};
use umbrage::core::technique::Method;
use umbrage::core::technique::mask::{Lookup, Mask, Receivers};
use umbrage::core::volume::light_point_world;
use umbrage::core::{Aabb, DEPTH, Light};
use umbrage::layers::Layers;
use umbrage::mask::{
    GpuReceiving, MaskMaps, MaskPipelines, Shadowed, SubtractPipelines, mask_sampler, record_mask_pass,
    record_subtract,
};
use umbrage_scene::{Mesh, Scene};

/// Mirrors `MaskList` of `shaders.rs`.
#[repr(C)]
pub struct GpuMaskList {
    pub masks: [GpuMask; MOST_MASKS],
    /// The first pixel that each may darken and the one past the last, 16 bits a number, and the object that it is of.
    pub seen: [[u32; 4]; MOST_MASKS],
}

/// All that a mask depends on.
#[derive(Debug, PartialEq)]
struct Content {
    view: GpuCasterView,
    parts: Vec<Part>,
}

/// A mesh of a blocker.
#[derive(Clone, Debug)]
struct Part {
    mesh: usize,
    /// Of the mesh's vertices.
    version: u64,
    /// Of its outline, which follows from the view, the mesh and its place.
    indices: Range<u32>,
    placed: GpuInstance,
}

impl PartialEq for Part {
    /// Where in a buffer an outline stands makes no other mask.
    fn eq(&self, other: &Self) -> bool {
        (self.mesh, self.version, &self.placed) == (other.mesh, other.version, &other.placed)
    }
}

/// One mask.
#[derive(Debug)]
struct OneMask {
    view: MaskView,
    object: u32,
    wanted: Arc<Content>,
    /// Its first instance in the buffer.
    first: u32,
    /// The pixels that it may darken.
    on_screen: Option<Rect>,
}

/// What takes masks away from receivers, pass by pass.
#[derive(Debug)]
struct Subtract {
    pipelines: SubtractPipelines,
    receiving: Vec<wgpu::Buffer>,
    list: wgpu::Buffer,
    groups: Vec<wgpu::BindGroup>,
    instances: Growing,
    /// For each light: what is drawn for which mask.
    draws: Vec<Vec<(usize, ReceiverBatch)>>,
    v: Layers,
}

/// The masks of all lights.
#[derive(Debug)]
pub(crate) struct Masks {
    choices: Mask,
    size_texel: u32,
    outlines: Outlines,
    deforms: bool,
    maps: MaskMaps,
    sampler: wgpu::Sampler,
    pipelines: MaskPipelines,
    matrices: wgpu::Buffer,
    view_group: wgpu::BindGroup,
    instances: Growing,
    list: wgpu::Buffer,
    masks: Vec<OneMask>,
    held: Vec<Option<Arc<Content>>>,
    of_light: Vec<Range<usize>>,
    subtract: Option<Subtract>,
    geometry: Arc<Geometry>,
    materials: Arc<Vec<MaterialEntry>>,
    material_of_mesh: Arc<Vec<usize>>,
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
        let Method::Mask(choices) = options.settings.method else { return Ok(None) };
        let device = &gpu.device;
        let settings = &options.settings;
        let size_texel = settings.value("mask_size").map_or(512, |size| size as u32);
        let most = (lights * most_of_light(lights, size_texel)).min(lights * scene.objects() as usize).max(1);
        let maps = MaskMaps::new(device, size_texel, most as u32)?;
        let sampler = mask_sampler(device, choices.lookup == Lookup::Linear);
        let vertices = CasterVertices::deformed(options.deform.as_deref().unwrap_or(NO_DEFORM));
        let pipelines = MaskPipelines::new(device, caster_layout, &vertices);
        let uniform = |label, size: u64| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let matrices = uniform("mask views", most as u64 * u64::from(GpuCasterView::STRIDE));
        let view_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("mask views"),
            layout: &pipelines.view_layout,
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                    buffer: &matrices,
                    offset: 0,
                    size: NonZeroU64::new(size_of::<GpuCasterView>() as u64),
                }),
            }],
        });
        let subtract = (choices.receivers == Receivers::Subtractive).then(|| {
            let pipelines = SubtractPipelines::new(device, depth, SCREEN_V, &vertices);
            let list = uniform("masks apart", most as u64 * u64::from(SubtractPipelines::STRIDE));
            let receiving: Vec<_> =
                (0..lights.max(1)).map(|_| uniform("receiving", size_of::<GpuReceiving>() as u64)).collect();
            let groups =
                receiving.iter().map(|of| pipelines.group(device, of, &list, &maps, &sampler)).collect();
            Subtract {
                groups,
                pipelines,
                receiving,
                list,
                instances: Growing::new(device, "receivers", wgpu::BufferUsages::VERTEX, 0),
                draws: Vec::new(),
                v: screen_v(device, options.size, lights),
            }
        });
        Ok(Some(Self {
            outlines: Outlines::new(
                device,
                scene,
                settings,
                &choices,
                options.deform.as_ref().map(|_| options.deform_reach_m),
            ),
            choices,
            size_texel,
            deforms: options.deform.is_some(),
            sampler,
            matrices,
            view_group,
            instances: Growing::new(device, "blockers", wgpu::BufferUsages::VERTEX, 0),
            list: uniform("masks", size_of::<GpuMaskList>() as u64),
            masks: Vec::new(),
            held: vec![None; most],
            of_light: Vec::new(),
            subtract,
            maps,
            pipelines,
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
        (self.list.clone(), self.maps.array().clone(), self.sampler.clone())
    }

    /// The masks of a light: the first, and how many.
    pub fn of_light(&self, light: usize) -> Range<usize> {
        self.of_light.get(light).cloned().unwrap_or_default()
    }

    /// The view of each mask.
    pub fn views(&self) -> impl Iterator<Item = &MaskView> {
        self.masks.iter().map(|mask| &mask.view)
    }

    /// Gives a mesh another shape.
    pub fn reshape(&mut self, index: usize, mesh: &Mesh) {
        self.outlines.reshape(index, mesh);
    }

    /// Fits all masks to the world. What could not be fitted is said.
    pub fn tell(&mut self, gpu: &Gpu, world: &World, clip_from_world: Mat4, size: UVec2) -> Vec<String> {
        let mut warnings = Vec::new();
        let picture = Picture { clip_from_world, depth: DEPTH, size };
        let options = MaskOptions::of(&self.choices, self.size_texel, &world.items.whole());
        let lights = world.lights.len().min(crate::MAX_LIGHTS);
        let most = most_of_light(lights, self.size_texel);
        self.outlines.tidy();
        self.masks.clear();
        self.of_light.clear();
        let mut placed: Vec<GpuInstance> = Vec::new();
        let time_s = if self.deforms { world.time_s } else { 0.0 };
        for (index, light) in world.lights.iter().enumerate().take(lights) {
            let first = self.masks.len();
            for (object, parts) in world.items.mask_blockers(&light.light) {
                if self.masks.len() - first >= most || self.masks.len() >= self.held.len() {
                    warnings
                        .push(format!("light {index}: more than {most} blockers; the rest throw no shadow"));
                    break;
                }
                let points = self.outlines.fit_points_world(&parts, self.choices.fit_to);
                let fitted = fit_mask(&light.light, points.iter().copied(), &options);
                // Where the points are dense at one end, the other may lie too far aside. What `unmaskable` lets through has room
                // around the middle of its box.
                let fitted = fitted.or_else(|why| match why {
                    MaskError::Unreached => Err(why),
                    _ => {
                        let whole = parts.iter().fold(Aabb::EMPTY, |all, part| all.union(&part.bounds_world));
                        fit_mask(&light.light, whole.corners().into_iter(), &options)
                    }
                });
                match fitted {
                    Ok(mut view) => {
                        // The box that a mask begins behind is that of what stands still: grown by all that may move, it would take
                        // in what stands around, and darken it.
                        if self.deforms {
                            view.bounds_world = self.outlines.rest_box_world(&parts);
                        }
                        let content = self.content(&view, &parts, &light.light, time_s, &world.mesh_versions);
                        let at = placed.len() as u32;
                        placed.extend(content.parts.iter().map(|part| part.placed));
                        let others = world.items.mask_boxes().filter(|(other, _)| *other != object);
                        let on_screen = Shadow::new(&view, &picture).over(others.map(|(_, bounds)| bounds));
                        let wanted = Arc::new(content);
                        self.masks.push(OneMask { view, object, wanted, first: at, on_screen });
                    }
                    Err(MaskError::Unreached) => {}
                    Err(why) => warnings.push(format!("light {index} has no mask of object {object}: {why}")),
                }
            }
            self.of_light.push(first..self.masks.len());
        }
        self.outlines.write(&gpu.device, &gpu.queue);
        self.instances.write(&gpu.device, &gpu.queue, bytemuck::cast_slice(&placed));
        let stride = GpuCasterView::STRIDE as usize;
        let mut bytes = vec![0u8; self.masks.len() * stride];
        for (mask, slot) in self.masks.iter().zip(bytes.chunks_mut(stride)) {
            slot[..size_of::<GpuCasterView>()].copy_from_slice(bytemuck::bytes_of(&mask.wanted.view));
        }
        gpu.queue.write_buffer(&self.matrices, 0, &bytes);
        let list: Vec<GpuMask> = (0u32..)
            .zip(&self.masks)
            .map(|(layer, mask)| GpuMask::new(&mask.view, layer, Some(mask.object)))
            .collect();
        gpu.queue.write_buffer(&self.list, 0, bytemuck::cast_slice(&list));
        let seen = |mask: &OneMask| {
            let rect = mask.on_screen.unwrap_or(Rect { min: UVec2::ZERO, max: UVec2::ZERO });
            let corner = |at: UVec2| at.x | (at.y << 16);
            [corner(rect.min), corner(rect.max), mask.object, 0]
        };
        let seen: Vec<[u32; 4]> = self.masks.iter().map(seen).collect();
        gpu.queue.write_buffer(&self.list, offset_of!(GpuMaskList, seen) as u64, bytemuck::cast_slice(&seen));
        self.tell_receivers(gpu, world, &picture, &list);
        warnings
    }

    fn content(
        &mut self,
        view: &MaskView,
        parts: &[MaskPart],
        light: &Light,
        time_s: f32,
        versions: &[u64],
    ) -> Content {
        let of_part = |part: &MaskPart| Part {
            mesh: part.mesh,
            version: versions[part.mesh],
            indices: self.outlines.indices(part, view, light),
            placed: GpuInstance::new(&part.world_from_object),
        };
        let parts: Vec<Part> = parts.iter().map(of_part).collect();
        Content { view: GpuCasterView::of_mask(view.clip_from_world(), time_s), parts }
    }

    /// Lists the receivers of each mask, where they are drawn once more.
    fn tell_receivers(&mut self, gpu: &Gpu, world: &World, picture: &Picture, list: &[GpuMask]) {
        let Some(subtract) = &mut self.subtract else { return };
        let stride = SubtractPipelines::STRIDE as usize;
        let mut bytes = vec![0u8; list.len() * stride];
        for (mask, slot) in list.iter().zip(bytes.chunks_mut(stride)) {
            slot[..size_of::<GpuMask>()].copy_from_slice(bytemuck::bytes_of(mask));
        }
        gpu.queue.write_buffer(&subtract.list, 0, &bytes);
        let (eye, eye_w) = eye_of(&world.camera);
        let mut instances = Vec::new();
        subtract.draws.clear();
        for (index, range) in self.of_light.iter().enumerate() {
            let light = light_point_world(&world.lights[index].light);
            let receiving = GpuReceiving {
                clip_from_world: picture.clip_from_world,
                eye: eye.extend(eye_w),
                light,
                time_s: world.time_s,
                pad: [0.0; 3],
            };
            gpu.queue.write_buffer(&subtract.receiving[index], 0, bytemuck::bytes_of(&receiving));
            let mut draws = Vec::new();
            for number in range.clone() {
                let mask = &self.masks[number];
                let shadow = Shadow::new(&mask.view, picture);
                let batches = world.items.mask_receivers(&shadow, mask.object, &mut instances);
                draws.extend(batches.into_iter().map(|batch| (number, batch)));
            }
            subtract.draws.push(draws);
        }
        subtract.instances.write(&gpu.device, &gpu.queue, bytemuck::cast_slice(&instances));
    }

    /// The masks whose shadow may be seen and that do not hold what they should; all that may be seen when nothing is reused.
    pub fn stale(&self, reuse: bool) -> Vec<usize> {
        let is_stale =
            |number: &usize| !reuse || self.held[*number].as_ref() != Some(&self.masks[*number].wanted);
        let is_seen = |number: &usize| self.masks[*number].on_screen.is_some();
        (0..self.masks.len()).filter(is_seen).filter(is_stale).collect()
    }

    /// The passes that draw these masks, then those that take them from receivers.
    pub fn pass_names(&self, drawn: &[usize]) -> [Vec<String>; 2] {
        let light_of =
            |number: usize| self.of_light.iter().position(|range| range.contains(&number)).unwrap_or(0);
        let masks =
            drawn.iter().map(|n| format!("mask {}.{}", light_of(*n), self.masks[*n].object)).collect();
        let subtracted = self.subtract.iter().flat_map(|_| 0..self.of_light.len());
        [masks, subtracted.map(|light| format!("subtract {light}")).collect()]
    }

    /// Records the passes that draw these masks, measured as passes number `first` and on.
    pub fn record(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        drawn: &[usize],
        (queries, first): (&Queries, u32),
    ) -> Vec<Work> {
        let mut works = Vec::new();
        for (pass, number) in (first..).zip(drawn) {
            let mask = &self.masks[*number];
            let mut work = Work::default();
            record_mask_pass(encoder, &self.maps, *number as u32, queries.stamps(pass), |recorded| {
                queries.count(recorded, pass, |recorded| {
                    recorded.set_bind_group(0, &self.view_group, &[*number as u32 * GpuCasterView::STRIDE]);
                    recorded.set_index_buffer(self.outlines.buffer().slice(..), wgpu::IndexFormat::Uint32);
                    recorded.set_vertex_buffer(1, self.instances.buffer.slice(..));
                    for (instance, part) in (mask.first..).zip(&mask.wanted.parts) {
                        let mesh = &self.geometry.meshes[part.mesh];
                        let group = &self.materials[self.material_of_mesh[part.mesh]].caster;
                        if let (Some(group), Some(offset)) = (group, mesh.uv_alpha_offset) {
                            recorded.set_pipeline(&self.pipelines.cut_out);
                            recorded.set_bind_group(1, group, &[]);
                            recorded.set_vertex_buffer(2, self.geometry.uv_alpha.slice(offset..));
                        } else {
                            recorded.set_pipeline(&self.pipelines.solid);
                        }
                        recorded.set_vertex_buffer(0, self.geometry.positions.slice(mesh.position_offset..));
                        recorded.draw_indexed(part.indices.clone(), 0, instance..instance + 1);
                        work.draws += 1;
                        work.instances += 1;
                        work.triangles += u64::from(part.indices.end - part.indices.start) / 3;
                    }
                });
            });
            works.push(work);
        }
        for number in drawn {
            self.held[*number] = Some(Arc::clone(&self.masks[*number].wanted));
        }
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
                    for shadowed in [Shadowed::Core, Shadowed::Fringe] {
                        // A mask that is not blended has no fringe.
                        if shadowed == Shadowed::Fringe && self.choices.lookup == Lookup::Nearest {
                            continue;
                        }
                        recorded.set_pipeline(subtract.pipelines.of(shadowed));
                        for (number, batch) in draws {
                            let (at, size) = (batch.on_screen.min, batch.on_screen.size());
                            recorded.set_scissor_rect(at.x, at.y, size.x, size.y);
                            let mesh = &self.geometry.meshes[batch.mesh];
                            let offset = *number as u32 * SubtractPipelines::STRIDE;
                            recorded.set_bind_group(0, &subtract.groups[light], &[offset]);
                            recorded
                                .set_vertex_buffer(0, self.geometry.positions.slice(mesh.position_offset..));
                            recorded.draw_indexed(mesh.indices.clone(), 0, batch.instances.clone());
                            work.draws += 1;
                            work.instances += u64::from(batch.instances.end - batch.instances.start);
                            work.triangles += u64::from(batch.instances.end - batch.instances.start)
                                * (mesh.indices.len() as u64 / 3);
                        }
                    }
                });
            });
            works.push(work);
        }
        works
    }

    /// Memory of a light's masks and V, bytes.
    pub fn memory_of_light(&self, light: usize) -> u64 {
        let v = self.subtract.as_ref().map_or(0, |subtract| subtract.v.layer_bytes());
        self.of_light(light).len() as u64 * u64::from(self.size_texel) * u64::from(self.size_texel) + v
    }

    /// Memory of masks, outlines and V, bytes.
    pub fn memory_bytes(&self) -> u64 {
        let v = self.subtract.as_ref().map_or(0, |subtract| subtract.v.memory_bytes());
        self.maps.memory_bytes() + self.outlines.memory_bytes() + v
    }
}
