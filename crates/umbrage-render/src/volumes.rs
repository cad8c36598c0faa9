//! Shadow volumes of a scene's lights: which casters throw them, and what of them has to be found anew.

use crate::draw_list::Work;
use crate::gpu::Gpu;
use crate::moving::World;
use crate::readback;
use crate::screen_v::{SCREEN_V, screen_v};
use crate::targets::Targets;
use crate::timing::Queries;
use crate::{RenderError, RenderOptions};
use glam::{Mat4, UVec2};
use umbrage::core::edges::Adjacency;
use umbrage::core::technique::volume::{Soften, Volume};
use umbrage::core::technique::{Method, Settings};
use umbrage::core::volume as maths;
use umbrage::core::{Camera, DEPTH, Frustum, Projection};
use umbrage::layers::Layers;
use umbrage::soften::{SoftenedV, Softener, Softness, record_soften, soften};
use umbrage::volume::{
    Counted, Faces, VolumeCaster, VolumeLight, VolumeMesh, VolumePipelines, VolumeSource, Winding,
    count_volumes, draw_volumes, find_silhouettes, record_counts, record_silhouettes, record_visibility,
    write_visibility,
};
use umbrage_scene::{Mesh, Scene, SceneLight};

/// A parallel eye's volumes are so many times as long as the scene; and where the far plane is moved behind their ends, which costs
/// depth its precision, so many times.
const LENGTHS: f32 = 1e5;
const CUT_LENGTHS: f32 = 64.0;

/// What a light sees of edges, counted by the GPU.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Silhouettes {
    /// Edges of all its casters.
    pub edges_looked_at: u64,
    /// Those of the outline; twice where both of a part's sides cast. 0 with split edges, where nobody counts.
    pub silhouette_edges: u64,
    /// Triangles that face the light and close a volume.
    pub lids: u64,
    /// Triangles of all volumes that a frame draws into the stencil.
    pub triangles_drawn: u64,
}

/// What covering the screen asks of the GPU.
const SCREEN: Work = Work { draws: 1, instances: 1, triangles: 1, vertices: 3 };

/// The volumes of one light.
#[derive(Debug, Default)]
struct OfLight {
    volumes: Option<VolumeLight>,
    /// Do its faces have to be found?
    stale: bool,
    /// Casters whose shadow may be seen, by their numbers.
    draw: Vec<(usize, Counted)>,
    scissor: Option<maths::Scissor>,
}

/// A mesh, and whether any part of it casts from both sides.
#[derive(Debug)]
struct Shape {
    mesh: Option<VolumeMesh>,
    is_open: bool,
}

/// The volumes of all lights.
#[derive(Debug)]
pub(crate) struct Volumes {
    choices: Volume,
    /// Names of meshes that no buffer holds.
    too_large: Vec<String>,
    inset_m: f32,
    extrude_m: f32,
    pipelines: VolumePipelines,
    meshes: Vec<Option<VolumeMesh>>,
    /// For each mesh: casts any part of it from both sides?
    open: Vec<bool>,
    clip_from_world: wgpu::Buffer,
    lights: Vec<OfLight>,
    v: Layers,
    soft: Option<Soft>,
}

/// What blurs V, and V of each light.
#[derive(Debug)]
struct Soft {
    softness: Softness,
    softener: Softener,
    of_light: Vec<SoftenedV>,
}

fn shape(device: &wgpu::Device, pipelines: &VolumePipelines, mesh: &Mesh) -> Shape {
    let adjacency = Adjacency::new(&mesh.positions, &mesh.indices);
    let source = VolumeSource { positions: &mesh.positions, adjacency: &adjacency };
    Shape { mesh: VolumeMesh::new(device, pipelines, &source), is_open: adjacency.two_sided.contains(&true) }
}

impl Volumes {
    /// Uploads the meshes; `None` for other families. `by_map` are those that maps draw; depth is of `format`.
    pub fn new(
        gpu: &Gpu,
        scene: &Scene,
        options: &RenderOptions,
        by_map: &[bool],
        targets: &Targets,
        format: wgpu::TextureFormat,
        lights: usize,
    ) -> Option<Self> {
        let (settings, size) = (&options.settings, options.size);
        let Method::Volume(choices) = settings.method else { return None };
        let device = &gpu.device;
        let pipelines = VolumePipelines::new(device, choices.silhouette, format, SCREEN_V, DEPTH);
        let of = |(mesh, by_map): (&Mesh, &bool)| {
            if *by_map { Shape { mesh: None, is_open: false } } else { shape(device, &pipelines, mesh) }
        };
        let shapes: Vec<Shape> = scene.meshes.iter().zip(by_map).map(of).collect();
        // What has triangles with area, and yet no volume, is more than the device's buffers hold.
        let is_too_large = |(mesh, (shape, by_map)): &(&Mesh, (&Shape, &bool))| {
            let limits = device.limits();
            let most = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
            !**by_map && shape.mesh.is_none() && 16 * mesh.indices.len() as u64 > most
        };
        let judged = scene.meshes.iter().zip(shapes.iter().zip(by_map));
        let too_large = judged.filter(is_too_large).map(|(mesh, _)| mesh.name.clone()).collect();
        let mut made = Self {
            choices,
            too_large,
            inset_m: settings.value("inset_m").unwrap_or(0.0),
            extrude_m: settings.value("extrude_m").unwrap_or(0.0),
            open: shapes.iter().map(|shape| shape.is_open).collect(),
            meshes: shapes.into_iter().map(|shape| shape.mesh).collect(),
            pipelines,
            clip_from_world: device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("volume eye"),
                size: size_of::<Mat4>() as u64,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            lights: (0..lights).map(|_| OfLight::default()).collect(),
            v: screen_v(device, size, lights),
            soft: None,
        };
        if let Some(depth_only) = &targets.depth_only {
            made.soften(device, settings, size, depth_only);
        }
        Some(made)
    }

    /// Makes what blurs V, where the technique asks for it, over the depth of the surfaces.
    fn soften(
        &mut self,
        device: &wgpu::Device,
        settings: &Settings,
        size: UVec2,
        depth_only: &wgpu::TextureView,
    ) {
        if self.choices.soften != Soften::Blur {
            return;
        }
        let value = |name| settings.value(name).unwrap_or(0.0);
        let softness =
            Softness { width_px: value("soft_px"), width_m: value("soft_m"), like: value("like_depth") };
        let softener = Softener::new(device, SCREEN_V, size.to_array(), DEPTH);
        let of_light = (0..self.lights.len())
            .filter_map(|light| Some(softener.of(device, self.v.layer(light as u32)?, depth_only)))
            .collect();
        self.soft = Some(Soft { softness, softener, of_light });
    }

    /// V of all lights.
    pub fn v(&self) -> &Layers {
        &self.v
    }

    /// Gives a mesh another shape.
    pub fn reshape(&mut self, device: &wgpu::Device, index: usize, mesh: &Mesh) {
        if self.meshes[index].is_some() {
            let made = shape(device, &self.pipelines, mesh);
            (self.meshes[index], self.open[index]) = (made.mesh, made.is_open);
        }
    }

    /// The camera that volumes can be counted for: where a far plane would cut them, one without, and for a parallel eye one that is
    /// beyond their ends.
    pub fn camera(&self, gpu: &Gpu, world: &World) -> Camera {
        let camera = world.camera;
        if umbrage::caster::unclipped(&gpu.device) {
            return camera;
        }
        let far_m = match camera.projection {
            Projection::Perspective { .. } => f32::INFINITY,
            Projection::Orthographic { .. } => {
                let scene_world = world.items.whole();
                let length_m = |placed: &SceneLight| {
                    let light_world = maths::light_point_world(&placed.light);
                    self.extrude_m.max(maths::finite_length_m(&scene_world, light_world, CUT_LENGTHS))
                };
                let longest_m = world.lights.iter().map(length_m).fold(0.0, f32::max);
                let farthest_m = scene_world
                    .corners()
                    .iter()
                    .map(|p| p.distance(camera.position_world))
                    .fold(0.0, f32::max);
                (longest_m + farthest_m).max(camera.far_m)
            }
        };
        Camera { far_m, ..camera }
    }

    /// Lists what is drawn of the world from where it is seen. Faces that hold are kept.
    pub fn tell(
        &mut self,
        gpu: &Gpu,
        world: &World,
        clip_from_world: Mat4,
        size: UVec2,
        all_casters: bool,
    ) -> Vec<String> {
        let too_large = |name: &String| {
            format!(
                "mesh `{name}` throws no shadow: its edges do not fit into a buffer of this device; use the technique `linear`"
            )
        };
        let mut warnings: Vec<String> = self.too_large.iter().map(too_large).collect();
        gpu.queue.write_buffer(&self.clip_from_world, 0, bytemuck::bytes_of(&clip_from_world));
        if let Some(soft) = &self.soft {
            let clip_from_view =
                clip_from_world.as_dmat4() * world.camera.view_from_world().as_dmat4().inverse();
            soft.softener.write(&gpu.queue, &soft.softness, &clip_from_view.as_mat4());
        }
        let frustum = Frustum::from_clip(clip_from_world, DEPTH);
        let near_world = maths::near_corners_world(clip_from_world, DEPTH.ndc_near());
        let scene_world = world.items.whole();
        let is_parallel = matches!(world.camera.projection, Projection::Orthographic { .. });
        let lengths = if umbrage::caster::unclipped(&gpu.device) { LENGTHS } else { CUT_LENGTHS };
        for (index, placed) in world.lights.iter().enumerate().take(self.lights.len()) {
            let light = &placed.light;
            let light_world = maths::light_point_world(light);
            let scissor = maths::lit_pixels(light, &scene_world, clip_from_world, size);
            let extrude_m = if is_parallel && self.extrude_m <= 0.0 {
                maths::finite_length_m(&scene_world, light_world, lengths)
            } else {
                self.extrude_m
            };
            let mut draw = Vec::new();
            let mut casters = Vec::new();
            for placed in world.items.volume_casters(light, all_casters) {
                if self.meshes[placed.mesh].is_none() {
                    continue;
                }
                let may_be_in = near_world
                    .is_none_or(|near| maths::eye_may_be_in_shadow(&near, light_world, &placed.bounds_world));
                let counted = Counted::new(self.choices.counting, may_be_in);
                let both_sides = maths::light_may_be_inside(light_world, &placed.bounds_world);
                if maths::shadow_may_be_seen(&frustum, light_world, &placed.bounds_world) {
                    draw.push((casters.len(), counted));
                }
                let is_behind = counted == Counted::Behind;
                let eye = near_world.filter(|_| !is_behind);
                let eye = eye.as_ref().map_or(&[][..], |corners| corners);
                let far_plane_world = maths::far_plane_world(light, &placed.bounds_world, &scene_world, eye);
                casters.push(VolumeCaster {
                    mesh: placed.mesh,
                    version: world.mesh_versions[placed.mesh],
                    world_from_object: placed.world_from_object,
                    light_world,
                    inset_m: self.inset_m,
                    // A plane behind all that is seen goes before a length.
                    extrude_m: if far_plane_world.is_some() { self.extrude_m } else { extrude_m },
                    far_plane_world,
                    both_sides,
                    // What is not closed may be seen from behind, and then its lid is looked through.
                    near_caps: is_behind || both_sides || self.open[placed.mesh],
                    // What ends before the surface is left through its far lid.
                    far_caps: is_behind || self.extrude_m > 0.0,
                    winding: VolumeCaster::winding_of(&placed.world_from_object),
                });
            }
            let of_light = &mut self.lights[index];
            let kept = of_light.volumes.as_ref().map_or(&[][..], VolumeLight::casters);
            casters.iter_mut().zip(kept).for_each(|(caster, kept)| *caster = caster.keeping_lids(kept));
            (of_light.draw, of_light.scissor) = (draw, scissor);
            if of_light.volumes.as_ref().is_none_or(|volumes| volumes.casters() != casters) {
                of_light.volumes = VolumeLight::new(
                    &gpu.device,
                    &gpu.queue,
                    &self.pipelines,
                    &self.meshes,
                    casters,
                    &self.clip_from_world,
                );
                of_light.stale = true;
                if of_light.volumes.is_none() {
                    warnings.push(format!(
                        "light {index} throws no shadow: the faces of its volumes do not fit into a buffer of this device; \
                         use the technique `linear`, or meshes with fewer triangles"
                    ));
                }
            }
        }
        warnings
    }

    /// The passes of the next frame, in their order: names end in the light's number.
    pub fn pass_names(&self, reuse: bool) -> Vec<String> {
        let mut names = Vec::new();
        for (index, light) in self.lights.iter().enumerate() {
            if self.finds(light, reuse) {
                names.push(format!("silhouettes {index}"));
            }
            for faces in Faces::passes(self.choices.stencil) {
                names.push(format!("{} {index}", faces.pass_name()));
            }
            names.push(format!("mask {index}"));
            if self.soft.is_some() {
                names.extend([format!("blur-rows {index}"), format!("blur-columns {index}")]);
            }
        }
        names
    }

    fn finds(&self, light: &OfLight, reuse: bool) -> bool {
        (light.stale || !reuse)
            && self.choices.silhouette == umbrage::core::technique::volume::Silhouette::Compute
            && light.volumes.as_ref().is_some_and(|volumes| !volumes.casters().is_empty())
    }

    /// Records all of them, measured as passes number `first` and on; says what each asks of the GPU.
    pub fn record(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        depth_stencil: &wgpu::TextureView,
        size: UVec2,
        reuse: bool,
        (queries, first): (&Queries, u32),
    ) -> Vec<Work> {
        let mut pass = first;
        let mut works = Vec::new();
        for index in 0..self.lights.len() {
            let Some(v) = self.v.layer(index as u32) else { continue };
            let finds = self.finds(&self.lights[index], reuse);
            let stale = std::mem::replace(&mut self.lights[index].stale, false);
            let light = &self.lights[index];
            let empty = [0, 0, size.x, size.y];
            if let (true, Some(volumes)) = (finds, &light.volumes) {
                if !stale {
                    volumes.clear_counts(&gpu.queue);
                }
                record_silhouettes(encoder, queries.compute_stamps(pass), |recorded| {
                    queries.count_compute(recorded, pass, |recorded| {
                        find_silhouettes(recorded, &self.pipelines, volumes, &self.meshes);
                    });
                });
                works.push(Work { draws: volumes.casters().len() as u64, ..Work::default() });
                pass += 1;
            }
            let drawn = if light.scissor.is_some() { light.draw.as_slice() } else { &[] };
            for (turn, faces) in Faces::passes(self.choices.stencil).iter().enumerate() {
                let scissor = light.scissor.unwrap_or(empty);
                record_counts(encoder, depth_stencil, turn == 0, scissor, queries.stamps(pass), |recorded| {
                    queries.count(recorded, pass, |recorded| {
                        if let Some(volumes) = &light.volumes {
                            count_volumes(recorded, &self.pipelines, volumes, &self.meshes, *faces, drawn);
                        }
                    });
                });
                works.push(self.work(light, drawn));
                pass += 1;
            }
            record_visibility(encoder, depth_stencil, v, queries.stamps(pass), |recorded| {
                queries.count(recorded, pass, |recorded| write_visibility(recorded, &self.pipelines));
            });
            works.push(SCREEN);
            pass += 1;
            for columns in self.soft.iter().flat_map(|_| [false, true]) {
                let Some(soft) = &self.soft else { continue };
                record_soften(encoder, &soft.softener, v, columns, queries.stamps(pass), |recorded| {
                    queries.count(recorded, pass, |recorded| {
                        soften(recorded, &soft.softener, &soft.of_light[index], columns);
                    });
                });
                works.push(SCREEN);
                pass += 1;
            }
        }
        works
    }

    /// Pipelines that count, and make others.
    pub fn pipelines(&self) -> &VolumePipelines {
        &self.pipelines
    }

    /// Draws a light's volumes as they are counted, where they are, with pipelines of somebody else's; says what that asks of the
    /// GPU.
    pub fn draw_again<'a>(
        &self,
        recorded: &mut wgpu::RenderPass<'_>,
        light: usize,
        pipeline: impl Fn(Counted, Winding) -> &'a wgpu::RenderPipeline,
    ) -> Work {
        let light = &self.lights[light];
        let (Some(volumes), Some([x, y, width, height])) = (&light.volumes, light.scissor) else {
            return Work::default();
        };
        recorded.set_scissor_rect(x, y, width, height);
        draw_volumes(recorded, volumes, &self.meshes, &light.draw, pipeline);
        self.work(light, &light.draw)
    }

    /// What drawing volumes asks of the GPU. What a compute pass finds is not known here: [`crate::Renderer::silhouettes`] reads it back.
    fn work(&self, light: &OfLight, drawn: &[(usize, Counted)]) -> Work {
        let Some(volumes) = &light.volumes else { return Work::default() };
        drawn.iter().fold(Work::default(), |sum, (number, _)| {
            let caster = &volumes.casters()[*number];
            let mesh = self.meshes[caster.mesh].as_ref();
            let triangles = mesh.and_then(|mesh| mesh.split_triangles(caster.both_sides)).unwrap_or(0);
            Work {
                draws: sum.draws + 1,
                instances: sum.instances + 1,
                triangles: sum.triangles + triangles,
                ..sum
            }
        })
    }

    /// What the compute passes found, light by light; waits for the GPU.
    pub fn silhouettes(&self, gpu: &Gpu) -> Result<Vec<Silhouettes>, RenderError> {
        let turns = Faces::passes(self.choices.stencil).len() as u64;
        let of_light = |light: &OfLight| {
            let mut sum = Silhouettes::default();
            let Some(volumes) = &light.volumes else { return Ok(sum) };
            let bytes = readback::buffer(gpu, volumes.counts())?;
            let number = |at: usize| {
                bytes
                    .get(4 * at..4 * at + 4)
                    .map_or(0, |b| u64::from(u32::from_le_bytes(b.try_into().unwrap_or_default())))
            };
            for (i, caster) in volumes.casters().iter().enumerate() {
                let Some(mesh) = &self.meshes[caster.mesh] else { continue };
                sum.edges_looked_at += u64::from(mesh.edges());
                sum.silhouette_edges += number(8 * i + 5);
                sum.lids += number(8 * i + 6);
                if light.draw.iter().any(|(drawn, _)| *drawn == i) {
                    sum.triangles_drawn += turns
                        * match mesh.split_triangles(caster.both_sides) {
                            Some(all) => all,
                            None => number(8 * i) / 3,
                        };
                }
            }
            Ok(sum)
        };
        self.lights.iter().map(of_light).collect()
    }

    /// Memory of a light's faces and V, bytes.
    pub fn memory_of_light(&self, light: usize) -> u64 {
        let faces =
            self.lights.get(light).and_then(|of| of.volumes.as_ref()).map_or(0, VolumeLight::memory_bytes);
        faces + self.v.layer_bytes()
    }

    /// Memory of meshes, faces and V, bytes.
    pub fn memory_bytes(&self) -> u64 {
        let meshes: u64 = self.meshes.iter().flatten().map(VolumeMesh::memory_bytes).sum();
        let lights: u64 = self
            .lights
            .iter()
            .filter_map(|light| light.volumes.as_ref())
            .map(VolumeLight::memory_bytes)
            .sum();
        let soft = self.soft.as_ref().map_or(0, |soft| soft.softener.memory_bytes());
        meshes + lights + soft + self.v.memory_bytes()
    }
}
