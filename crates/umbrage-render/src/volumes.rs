//! Shadow volumes of a scene's lights: `umbrage` draws them, this says which casters there are and what each pass cost.

use crate::draw_list::Work;
use crate::gpu::Gpu;
use crate::moving::World;
use crate::readback;
use crate::screen_v::{SCREEN_V, screen_v};
use crate::targets::Targets;
use crate::timing::Queries;
use crate::{RenderError, RenderOptions};
use glam::{Mat4, UVec2};
use umbrage::core::volume as maths;
use umbrage::core::{Camera, DEPTH, Projection};
use umbrage::layers::Layers;
use umbrage::volume::{
    CUT_LENGTHS, Counted, Faces, PassWatch, ScreenVolumes, VolumeEye, VolumePass, VolumePipelines,
    VolumeProblem, VolumeSettings, VolumeWork, Winding, draw_volumes,
};
use umbrage_scene::{Mesh, Scene, SceneLight};

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

/// What drawing volumes asks of the GPU. What a compute pass finds is not known here: [`crate::Renderer::silhouettes`] reads it back.
fn work_of(work: VolumeWork) -> Work {
    Work { draws: work.draws, instances: work.draws, triangles: work.triangles, vertices: 0 }
}

/// The volumes of all lights.
#[derive(Debug)]
pub(crate) struct Volumes {
    settings: VolumeSettings,
    screen: ScreenVolumes,
    names: Vec<String>,
    /// Which of them maps draw.
    by_map: Vec<bool>,
    lights: usize,
    v: Layers,
}

/// Measures passes from a number on.
struct Watch<'a> {
    queries: &'a Queries,
    pass: u32,
    works: Vec<Work>,
}

impl PassWatch for Watch<'_> {
    fn compute_stamps(&self) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        self.queries.compute_stamps(self.pass)
    }

    fn render_stamps(&self) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        self.queries.stamps(self.pass)
    }

    fn compute(
        &self,
        recorded: &mut wgpu::ComputePass<'_>,
        find: &mut dyn FnMut(&mut wgpu::ComputePass<'_>),
    ) {
        self.queries.count_compute(recorded, self.pass, find);
    }

    fn render(&self, recorded: &mut wgpu::RenderPass<'_>, draw: &mut dyn FnMut(&mut wgpu::RenderPass<'_>)) {
        self.queries.count(recorded, self.pass, draw);
    }

    fn done(&mut self, pass: VolumePass, work: VolumeWork) {
        self.pass += 1;
        self.works.push(match pass {
            VolumePass::Silhouettes { .. } => Work { draws: work.draws, ..Work::default() },
            VolumePass::Counts { .. } => work_of(work),
            VolumePass::Visibility { .. } | VolumePass::Blur { .. } => SCREEN,
        });
    }
}

impl Volumes {
    /// Uploads the meshes; `None` for other families. `by_map` are those that maps draw; depth is of `format`.
    pub fn new(
        gpu: &Gpu,
        scene: &Scene,
        options: &RenderOptions,
        by_map: &[bool],
        format: wgpu::TextureFormat,
        lights: usize,
    ) -> Option<Self> {
        let settings = VolumeSettings::of(&options.settings)?;
        let mut screen = ScreenVolumes::new(&gpu.device, &gpu.queue, format, DEPTH, SCREEN_V).ok()?;
        screen.prepare(settings.choices.silhouette);
        let mut made = Self {
            settings,
            screen,
            names: scene.meshes.iter().map(|mesh| mesh.name.clone()).collect(),
            by_map: by_map.to_vec(),
            lights,
            v: screen_v(&gpu.device, options.size, lights),
        };
        scene.meshes.iter().enumerate().for_each(|(index, mesh)| made.reshape(index, mesh));
        Some(made)
    }

    /// V of all lights.
    pub fn v(&self) -> &Layers {
        &self.v
    }

    /// Gives a mesh a shape. One that is too large is told of when it should throw a shadow.
    pub fn reshape(&mut self, index: usize, mesh: &Mesh) {
        if !self.by_map[index] {
            let _ = self.screen.set_mesh(index, &mesh.positions, &mesh.indices);
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
                    self.settings.extrude_m.max(maths::finite_length_m(
                        &scene_world,
                        light_world,
                        CUT_LENGTHS,
                    ))
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
        world: &World,
        clip_from_world: Mat4,
        size: UVec2,
        all_casters: bool,
    ) -> Vec<String> {
        let clip_from_view = clip_from_world.as_dmat4() * world.camera.view_from_world().as_dmat4().inverse();
        self.screen.begin(&VolumeEye {
            clip_from_world,
            clip_from_view: clip_from_view.as_mat4(),
            size_px: size,
            is_parallel: matches!(world.camera.projection, Projection::Orthographic { .. }),
        });
        let scene_world = world.items.whole();
        for (index, placed) in world.lights.iter().enumerate().take(self.lights) {
            let casters = world.items.volume_casters(&placed.light, all_casters);
            let is_drawn = |item: &umbrage::volume::VolumeItem| !self.by_map[item.mesh];
            let casters = casters.filter(is_drawn);
            self.screen.tell(index, &placed.light, &self.settings, &scene_world, casters);
        }
        let warning = |problem: &VolumeProblem| match problem {
            VolumeProblem::MeshTooLarge { mesh } => problem.to_string().replacen(
                &format!("mesh {mesh}"),
                &format!("mesh `{}`", self.names[*mesh]),
                1,
            ),
            _ => problem.to_string(),
        };
        self.screen.problems().iter().map(warning).collect()
    }

    /// Forgets all faces: the next frame finds them once more.
    pub fn forget_faces(&mut self) {
        self.screen.forget_faces();
    }

    /// The passes of the next frame, in their order: names end in the light's number.
    pub fn pass_names(&self) -> impl Iterator<Item = String> + '_ {
        self.screen.passes().map(|pass| pass.to_string())
    }

    /// Records all of them over the targets' depth, measured as passes number `first` and on; says what each asks of the GPU.
    pub fn record(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        targets: &Targets,
        (queries, first): (&Queries, u32),
    ) -> Vec<Work> {
        let mut watch = Watch { queries, pass: first, works: Vec::new() };
        let (v, depth_only) = (&self.v, targets.depth_only.as_ref());
        self.screen.record(encoder, &targets.depth, depth_only, |light| v.layer(light as u32), &mut watch);
        watch.works
    }

    /// Pipelines that count, and make others.
    pub fn pipelines(&self) -> Option<&VolumePipelines> {
        self.screen.pipelines(self.settings.choices.silhouette)
    }

    /// Draws a light's volumes as they are counted, where they are, with pipelines of somebody else's; says what that asks of the
    /// GPU.
    pub fn draw_again<'a>(
        &self,
        recorded: &mut wgpu::RenderPass<'_>,
        light: usize,
        pipeline: impl Fn(Counted, Winding) -> &'a wgpu::RenderPipeline,
    ) -> Work {
        let Some(told) = self.screen.told(light) else { return Work::default() };
        let Some([x, y, width, height]) = told.scissor else { return Work::default() };
        recorded.set_scissor_rect(x, y, width, height);
        draw_volumes(recorded, told.light, told.meshes, told.draw, pipeline);
        work_of(told.work())
    }

    /// What the compute passes found, light by light; waits for the GPU.
    pub fn silhouettes(&self, gpu: &Gpu) -> Result<Vec<Silhouettes>, RenderError> {
        let turns = Faces::passes(self.settings.choices.stencil).len() as u64;
        let of_light = |light: usize| {
            let mut sum = Silhouettes::default();
            let Some(told) = self.screen.told(light) else { return Ok(sum) };
            let Some(counts) = told.light.counts() else { return Ok(sum) };
            let bytes = readback::buffer(gpu, counts)?;
            let number = |at: usize| {
                bytes
                    .get(4 * at..4 * at + 4)
                    .map_or(0, |b| u64::from(u32::from_le_bytes(b.try_into().unwrap_or_default())))
            };
            for (i, caster) in told.light.casters().iter().enumerate() {
                let Some(mesh) = &told.meshes[caster.mesh] else { continue };
                sum.edges_looked_at += u64::from(mesh.edges());
                sum.silhouette_edges += number(8 * i + 5);
                sum.lids += number(8 * i + 6);
                if told.draw.iter().any(|(drawn, _)| *drawn == i) {
                    sum.triangles_drawn += turns
                        * match mesh.split_triangles(caster.both_sides) {
                            Some(all) => all,
                            None => number(8 * i) / 3,
                        };
                }
            }
            Ok(sum)
        };
        (0..self.lights).map(of_light).collect()
    }

    /// Memory of a light's faces and V, bytes.
    pub fn memory_of_light(&self, light: usize) -> u64 {
        self.screen.memory_of_light(light) + self.v.layer_bytes()
    }

    /// Memory of meshes, faces and V, bytes.
    pub fn memory_bytes(&self) -> u64 {
        self.screen.memory_bytes() + self.v.memory_bytes()
    }
}
