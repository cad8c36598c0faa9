//! The maps of all lights: what each should hold, what it holds, and what draws the difference.

use crate::RenderError;
use crate::draw_list::{Batch, Work, open_casters};
use crate::geometry::Geometry;
use crate::layout::GpuInstance;
use crate::lights::Lights;
use crate::materials::MaterialEntry;
use crate::moving::World;
use crate::peeled::Peeled;
use crate::timing::Queries;
use std::num::NonZeroU64;
use std::sync::Arc;
use std::time::{Duration, Instant};
use umbrage::caster::GpuCasterView;
use umbrage::core::fit::Eye;
use umbrage::core::layout::GpuView;
use umbrage::core::plan::{Cull, Pass};
use umbrage::core::technique::Settings;
pub(crate) use umbrage::growing::Growing;
use umbrage::peel::record_peel_layer;
use umbrage::{CasterPipelines, ChosenFormat, ShadowMaps, TranslucentMaps, TranslucentPipelines};

/// All that a map depends on. Two maps of equal content are equal to the last bit.
#[derive(Debug, PartialEq)]
struct Content {
    view: GpuCasterView,
    draws: Vec<Draw>,
    /// Instances of all draws in turn.
    placed: Vec<GpuInstance>,
}

/// One draw of a map. Material and pipeline follow from these.
#[derive(Debug, PartialEq)]
struct Draw {
    mesh: usize,
    /// Of the mesh's vertices.
    version: u64,
    one_sided: bool,
    mirrored: bool,
    instances: u32,
}

/// One complete set of maps, with the matrices that they were drawn with.
#[derive(Debug)]
pub(crate) struct MapSet {
    maps: Option<ShadowMaps>,
    /// Of translucent casters, where those colour the light.
    translucent: Option<TranslucentMaps>,
    instances: Growing,
    matrices: Growing,
    view_group: Option<wgpu::BindGroup>,
    /// The matrices of the lookup.
    pub views: Growing,
    pub lights: Lights,
    /// Draws of each view.
    casters: Vec<Vec<Batch>>,
    wanted: Vec<Arc<Content>>,
    held: Vec<Option<Arc<Content>>>,
    /// Which state of the world it is for.
    pub version: Option<u64>,
    /// Counts what a bind group or a uniform depends on.
    pub changes: u64,
}

impl MapSet {
    /// Without any map, for so many views at most.
    pub fn new(device: &wgpu::Device, views: usize) -> Self {
        use wgpu::BufferUsages as Usage;
        Self {
            maps: None,
            translucent: None,
            instances: Growing::new(device, "caster instances", Usage::VERTEX, 0),
            matrices: Growing::new(device, "caster views", Usage::UNIFORM, 0),
            view_group: None,
            views: Growing::new(
                device,
                "views",
                Usage::STORAGE | Usage::UNIFORM,
                size_of::<GpuView>() * views.max(1),
            ),
            lights: Lights::default(),
            casters: Vec::new(),
            wanted: Vec::new(),
            held: Vec::new(),
            version: None,
            changes: 0,
        }
    }

    /// The maps, if any light has one.
    pub fn maps(&self) -> Option<&ShadowMaps> {
        self.maps.as_ref()
    }

    /// The maps of translucent casters, where those colour the light.
    pub fn translucent(&self) -> Option<&TranslucentMaps> {
        self.translucent.as_ref()
    }

    /// Memory of all of them, bytes.
    pub fn memory_bytes(&self) -> u64 {
        let translucent = self.translucent.as_ref().map_or(0, TranslucentMaps::memory_bytes);
        self.maps.as_ref().map_or(0, ShadowMaps::memory_bytes) + translucent
    }

    /// The draws of a view's map: without translucent casters where those colour the light.
    fn blocking(&self, layer: usize) -> Vec<Batch> {
        let colors = self.translucent.is_some();
        self.casters[layer].iter().filter(|batch| !(colors && batch.variant.blend)).cloned().collect()
    }

    /// The draws of translucent casters.
    fn tinting(&self, layer: usize) -> Vec<Batch> {
        self.casters[layer].iter().filter(|batch| batch.variant.blend).cloned().collect()
    }

    /// How many maps there are.
    pub fn count(&self) -> usize {
        self.wanted.len()
    }

    /// The maps that do not hold what they should; with `all`, every one.
    pub fn stale(&self, all: bool) -> Vec<usize> {
        let is_stale = |layer: &usize| all || self.held[*layer].as_ref() != Some(&self.wanted[*layer]);
        (0..self.wanted.len()).filter(is_stale).collect()
    }
}

/// The passes of a technique that draw casters, with their pipelines.
#[derive(Debug)]
pub(crate) struct Casting {
    pub pass: Pass,
    pub pipelines: CasterPipelines,
    /// What is drawn before each map, if anything.
    pub peeled: Option<Peeled>,
    /// Where translucent casters colour the light: their colours, then the nearest of them.
    pub translucent: Option<([Pass; 2], TranslucentPipelines)>,
}

impl Casting {
    /// The passes of each view, in their order.
    pub fn names(&self) -> Vec<&'static str> {
        let peel = self.peeled.iter().map(|peeled| peeled.pass.name);
        let translucent = self.translucent.iter().flat_map(|(passes, _)| passes).map(|pass| pass.name);
        peel.chain([self.pass.name]).chain(translucent).collect()
    }
}

/// What draws maps: it stays the same while the world moves.
#[derive(Debug)]
pub(crate) struct MapMaker {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    pub settings: Settings,
    pub format: ChosenFormat,
    /// `None` for techniques without maps.
    pub casting: Option<Casting>,
    pub geometry: Arc<Geometry>,
    pub materials: Arc<Vec<MaterialEntry>>,
    pub material_of_mesh: Arc<Vec<usize>>,
    pub mesh_names: Vec<String>,
    pub exposure: f32,
    /// Width of the picture over its height.
    pub aspect: f32,
    pub all_casters: bool,
    /// Only casters that the technique's own family cannot draw.
    pub only_by_map: bool,
    pub deforms: bool,
    pub load: Duration,
}

impl MapMaker {
    /// Fits the lights to the world, lists their casters, and hands both to the GPU with the next submission. Nothing is
    /// drawn. No cost when the set is for this world already.
    pub fn refresh(&self, set: &mut MapSet, world: &World) -> Result<(), RenderError> {
        if set.version == Some(world.version) {
            return Ok(());
        }
        let bounds = world.items.bounds_world();
        let eye = Eye { camera: world.camera, aspect: self.aspect };
        let mut lights =
            Lights::new(&world.lights, &self.settings, self.format.storage, self.exposure, &bounds, eye)?;
        let mut placed = Vec::new();
        let cull = self.casting.as_ref().map_or(Cull::BackOfClosed, |casting| casting.pass.cull);
        let of_views = lights.light_of_view.iter().zip(&lights.views);
        let casters: Vec<Vec<Batch>> = of_views
            .map(|of| world.items.casters(of, self.all_casters, self.only_by_map, cull, &mut placed))
            .collect();
        lights.warnings.extend(open_casters(&self.mesh_names, &self.settings, &casters));
        if let Some(Casting { pass, pipelines, .. }) = &self.casting {
            let regrown = self.make_room(set, lights.views.len() as u32)?;
            // Time is a reason to draw again only where something moves by it.
            let time_s = if self.deforms { world.time_s } else { 0.0 };
            let views: Vec<_> =
                lights.views.iter().map(|view| GpuCasterView::new(view, pass, time_s)).collect();
            set.wanted = views
                .iter()
                .zip(&casters)
                .map(|(view, batches)| Arc::new(content(*view, batches, &placed, &world.mesh_versions)))
                .collect();
            if regrown {
                set.held.clear();
            }
            set.held.resize(set.wanted.len(), None);
            self.write_matrices(set, pipelines, &views);
        }
        set.instances.write(&self.device, &self.queue, bytemuck::cast_slice(&placed));
        set.views.write(&self.device, &self.queue, bytemuck::cast_slice(&lights.gpu_views));
        set.casters = casters;
        set.lights = lights;
        set.version = Some(world.version);
        set.changes += 1;
        Ok(())
    }

    /// Maps for so many views; true when they are new and hold nothing. Maps are only ever added.
    fn make_room(&self, set: &mut MapSet, views: u32) -> Result<bool, RenderError> {
        let has = set.maps.as_ref().map_or(0, ShadowMaps::layer_count);
        if views as usize <= has {
            return Ok(false);
        }
        let size_texel = self.settings.map_size_texel();
        let maps = ShadowMaps::new(&self.device, &self.format, size_texel, views)?;
        let colors = self.casting.as_ref().is_some_and(|casting| casting.translucent.is_some());
        set.maps = Some(if colors { maps.keeping_scratch() } else { maps });
        set.translucent = colors
            .then(|| TranslucentMaps::new(&self.device, &self.format, size_texel, views))
            .transpose()?;
        Ok(true)
    }

    fn write_matrices(&self, set: &mut MapSet, pipelines: &CasterPipelines, views: &[GpuCasterView]) {
        let stride = GpuCasterView::STRIDE as usize;
        let mut bytes = vec![0u8; views.len().max(1) * stride];
        for (view, slot) in views.iter().zip(bytes.chunks_mut(stride)) {
            slot[..size_of::<GpuCasterView>()].copy_from_slice(bytemuck::bytes_of(view));
        }
        if !set.matrices.write(&self.device, &self.queue, &bytes) && set.view_group.is_some() {
            return;
        }
        set.view_group = Some(self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("caster view"),
            layout: &pipelines.view_layout,
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                    buffer: &set.matrices.buffer,
                    offset: 0,
                    size: NonZeroU64::new(size_of::<GpuCasterView>() as u64),
                }),
            }],
        }));
    }

    /// Records the passes that draw one map, measured as passes number `queries.1` and on of a frame.
    pub fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        set: &mut MapSet,
        layer: usize,
        queries: Option<(&Queries, u32)>,
    ) {
        spin(self.load);
        let (Some(casting), Some(maps)) = (&self.casting, &set.maps) else { return };
        let blocking = set.blocking(layer);
        let at = layer as u32;
        // 1. What a midpoint lies behind.
        let mut number = queries.map_or(0, |(_, number)| number);
        let stamps = |number| queries.and_then(|(queries, _)| queries.stamps(number));
        if let Some(peeled) = &casting.peeled {
            record_peel_layer(encoder, &peeled.peel, 0, &peeled.pass, stamps(number), |recorded| {
                counted(recorded, queries, number, |recorded| {
                    self.draw_casters(recorded, set, &peeled.pipelines, layer, &blocking);
                });
            });
            number += 1;
        }
        // 2. The map itself.
        umbrage::record_caster_pass(encoder, maps, at, &casting.pass, stamps(number), |recorded| {
            if let Some(peeled) = &casting.peeled {
                recorded.set_bind_group(1, peeled.peel.behind(0), &[]);
            }
            counted(recorded, queries, number, |recorded| {
                self.draw_casters(recorded, set, &casting.pipelines, layer, &blocking);
            });
        });
        // 3. The colours of translucent casters, and the nearest of them.
        if let (Some(([colors, nearest], pipelines)), Some(translucent)) =
            (&casting.translucent, &set.translucent)
        {
            let tinting = set.tinting(layer);
            let [first, second] = [number + 1, number + 2];
            umbrage::record_color_pass(encoder, maps, translucent, at, colors, stamps(first), |recorded| {
                counted(recorded, queries, first, |recorded| {
                    self.draw_translucent(recorded, set, &pipelines.color, layer, &tinting);
                });
            });
            umbrage::record_nearest_pass(encoder, translucent, at, nearest, stamps(second), |recorded| {
                counted(recorded, queries, second, |recorded| {
                    self.draw_translucent(recorded, set, &pipelines.nearest, layer, &tinting);
                });
            });
        }
        set.held[layer] = Some(Arc::clone(&set.wanted[layer]));
    }

    fn bind_view(&self, recorded: &mut wgpu::RenderPass<'_>, set: &MapSet, layer: usize) {
        if let Some(view_group) = &set.view_group {
            recorded.set_bind_group(0, view_group, &[layer as u32 * GpuCasterView::STRIDE]);
        }
        recorded.set_index_buffer(self.geometry.indices.slice(..), wgpu::IndexFormat::Uint32);
        recorded.set_vertex_buffer(1, set.instances.buffer.slice(..));
    }

    fn draw_casters(
        &self,
        recorded: &mut wgpu::RenderPass<'_>,
        set: &MapSet,
        pipelines: &CasterPipelines,
        layer: usize,
        batches: &[Batch],
    ) {
        self.bind_view(recorded, set, layer);
        for batch in batches {
            let mesh = &self.geometry.meshes[batch.mesh];
            let cut_out = &self.materials[self.material_of_mesh[batch.mesh]].caster;
            if let (Some(group), Some(offset)) = (cut_out, mesh.uv_alpha_offset) {
                recorded.set_pipeline(&pipelines.cut_out);
                recorded.set_bind_group(pipelines.cut_out_group, group, &[]);
                recorded.set_vertex_buffer(2, self.geometry.uv_alpha.slice(offset..));
            } else {
                recorded.set_pipeline(match (batch.one_sided, batch.variant.mirrored) {
                    (true, false) => &pipelines.closed,
                    (true, true) => &pipelines.closed_mirrored,
                    (false, _) => &pipelines.open,
                });
            }
            recorded.set_vertex_buffer(0, self.geometry.positions.slice(mesh.position_offset..));
            recorded.draw_indexed(mesh.indices.clone(), 0, batch.instances.clone());
        }
    }

    fn draw_translucent(
        &self,
        recorded: &mut wgpu::RenderPass<'_>,
        set: &MapSet,
        pipeline: &wgpu::RenderPipeline,
        layer: usize,
        batches: &[Batch],
    ) {
        recorded.set_pipeline(pipeline);
        self.bind_view(recorded, set, layer);
        for batch in batches {
            let mesh = &self.geometry.meshes[batch.mesh];
            let group = &self.materials[self.material_of_mesh[batch.mesh]].caster;
            let (Some(group), Some(offset)) = (group, mesh.uv_color_offset) else { continue };
            recorded.set_bind_group(1, group, &[]);
            recorded.set_vertex_buffer(0, self.geometry.positions.slice(mesh.position_offset..));
            recorded.set_vertex_buffer(2, self.geometry.uv_color.slice(offset..));
            recorded.draw_indexed(mesh.indices.clone(), 0, batch.instances.clone());
        }
    }

    /// The passes of each view, in their order.
    pub fn pass_names(&self) -> Vec<&'static str> {
        self.casting.as_ref().map(Casting::names).unwrap_or_default()
    }

    /// What drawing a map asks of the GPU, pass by pass.
    pub fn work(&self, set: &MapSet, layer: usize) -> Vec<Work> {
        let Some(casting) = self.casting.as_ref().filter(|_| layer < set.casters.len()) else {
            return Vec::new();
        };
        let blocking = Work::of(&set.blocking(layer), &self.geometry);
        let tinting = Work::of(&set.tinting(layer), &self.geometry);
        let opaque = 1 + usize::from(casting.peeled.is_some());
        let translucent = if casting.translucent.is_some() { 2 } else { 0 };
        std::iter::repeat_n(blocking, opaque).chain(std::iter::repeat_n(tinting, translucent)).collect()
    }
}

/// Draws, counted by the GPU where it is asked to.
fn counted(
    recorded: &mut wgpu::RenderPass<'_>,
    queries: Option<(&Queries, u32)>,
    number: u32,
    draw: impl FnOnce(&mut wgpu::RenderPass<'_>),
) {
    match queries {
        Some((queries, _)) => queries.count(recorded, number, draw),
        None => draw(recorded),
    }
}

fn content(view: GpuCasterView, batches: &[Batch], placed: &[GpuInstance], versions: &[u64]) -> Content {
    let mut content = Content { view, draws: Vec::with_capacity(batches.len()), placed: Vec::new() };
    for batch in batches {
        let instances = batch.instances.start as usize..batch.instances.end as usize;
        content.draws.push(Draw {
            mesh: batch.mesh,
            version: versions[batch.mesh],
            one_sided: batch.one_sided,
            mirrored: batch.variant.mirrored,
            instances: batch.instances.end - batch.instances.start,
        });
        content.placed.extend_from_slice(&placed[instances]);
    }
    content
}

/// Keeps a core busy.
pub(crate) fn spin(time: Duration) {
    let start = Instant::now();
    while start.elapsed() < time {
        std::hint::spin_loop();
    }
}
