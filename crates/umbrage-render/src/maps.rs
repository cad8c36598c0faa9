//! The maps of all lights: what each should hold, what it holds, and what draws the difference.

use crate::RenderError;
use crate::draw_list::{Batch, Work};
use crate::geometry::Geometry;
use crate::layout::GpuInstance;
use crate::lights::Lights;
use crate::materials::MaterialEntry;
use crate::moving::World;
use crate::timing::Queries;
use std::num::NonZeroU64;
use std::sync::Arc;
use std::time::{Duration, Instant};
use umbrage::caster::GpuCasterView;
use umbrage::core::layout::GpuView;
use umbrage::core::plan::Pass;
use umbrage::core::technique::Settings;
use umbrage::{CasterPipelines, ChosenFormat, ShadowMaps};

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
    back_hidden: bool,
    mirrored: bool,
    instances: u32,
}

/// A buffer that grows.
#[derive(Debug)]
pub(crate) struct Growing {
    pub buffer: wgpu::Buffer,
    label: &'static str,
}

impl Growing {
    /// Room for `bytes` bytes at first, 64 at least: an empty buffer cannot be bound.
    pub fn new(device: &wgpu::Device, label: &'static str, usage: wgpu::BufferUsages, bytes: usize) -> Self {
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: bytes.max(64).next_multiple_of(16) as u64,
            usage: usage | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        Self { buffer, label }
    }

    /// Writes from its start on; true when it is another buffer now.
    pub fn write(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, bytes: &[u8]) -> bool {
        let grows = bytes.len() as u64 > self.buffer.size();
        if grows {
            let size = bytes.len().next_power_of_two();
            *self = Self::new(device, self.label, self.buffer.usage(), size);
        }
        if !bytes.is_empty() {
            queue.write_buffer(&self.buffer, 0, bytes);
        }
        grows
    }
}

/// One complete set of maps, with the matrices that they were drawn with.
#[derive(Debug)]
pub(crate) struct MapSet {
    maps: Option<ShadowMaps>,
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
    /// Without any map.
    pub fn new(device: &wgpu::Device) -> Self {
        use wgpu::BufferUsages as Usage;
        Self {
            maps: None,
            instances: Growing::new(device, "caster instances", Usage::VERTEX, 0),
            matrices: Growing::new(device, "caster views", Usage::UNIFORM, 0),
            view_group: None,
            views: Growing::new(device, "views", Usage::STORAGE, size_of::<GpuView>()),
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

/// What draws maps: it stays the same while the world moves.
#[derive(Debug)]
pub(crate) struct MapMaker {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    pub settings: Settings,
    pub format: ChosenFormat,
    /// `None` for techniques without maps.
    pub caster: Option<(Pass, CasterPipelines)>,
    pub geometry: Arc<Geometry>,
    pub materials: Arc<Vec<MaterialEntry>>,
    pub material_of_mesh: Arc<Vec<usize>>,
    pub exposure: f32,
    pub all_casters: bool,
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
        let lights = Lights::new(&world.lights, &self.settings, self.format.storage, self.exposure, &bounds)?;
        let mut placed = Vec::new();
        let of_views = lights.light_of_view.iter().zip(&lights.views);
        let casters: Vec<Vec<Batch>> =
            of_views.map(|of| world.items.casters(of, self.all_casters, &mut placed)).collect();
        if let Some((pass, pipelines)) = &self.caster {
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
        set.maps = Some(ShadowMaps::new(&self.device, &self.format, size_texel, views)?);
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

    /// Records the pass that draws one map, measured as pass number `queries.1` of a frame.
    pub fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        set: &mut MapSet,
        layer: usize,
        queries: Option<(&Queries, u32)>,
    ) {
        spin(self.load);
        let (Some((pass, pipelines)), Some(maps), Some(view_group)) =
            (&self.caster, &set.maps, &set.view_group)
        else {
            return;
        };
        let stamps = queries.and_then(|(queries, number)| queries.stamps(number));
        umbrage::record_caster_pass(encoder, maps, layer as u32, pass, stamps, |recorded| {
            let draw = |recorded: &mut wgpu::RenderPass<'_>| {
                recorded.set_bind_group(0, view_group, &[layer as u32 * GpuCasterView::STRIDE]);
                recorded.set_index_buffer(self.geometry.indices.slice(..), wgpu::IndexFormat::Uint32);
                recorded.set_vertex_buffer(1, set.instances.buffer.slice(..));
                for batch in &set.casters[layer] {
                    self.draw_caster(recorded, pipelines, batch);
                }
            };
            match queries {
                Some((queries, number)) => queries.count(recorded, number, draw),
                None => draw(recorded),
            }
        });
        set.held[layer] = Some(Arc::clone(&set.wanted[layer]));
    }

    fn draw_caster(&self, recorded: &mut wgpu::RenderPass<'_>, pipelines: &CasterPipelines, batch: &Batch) {
        let mesh = &self.geometry.meshes[batch.mesh];
        let cut_out = &self.materials[self.material_of_mesh[batch.mesh]].caster;
        if let (Some(group), Some(offset)) = (cut_out, mesh.uv_alpha_offset) {
            recorded.set_pipeline(&pipelines.cut_out);
            recorded.set_bind_group(1, group, &[]);
            recorded.set_vertex_buffer(2, self.geometry.uv_alpha.slice(offset..));
        } else {
            recorded.set_pipeline(match (batch.back_hidden, batch.variant.mirrored) {
                (true, false) => &pipelines.closed,
                (true, true) => &pipelines.closed_mirrored,
                (false, _) => &pipelines.open,
            });
        }
        recorded.set_vertex_buffer(0, self.geometry.positions.slice(mesh.position_offset..));
        recorded.draw_indexed(mesh.indices.clone(), 0, batch.instances.clone());
    }

    /// What drawing a map asks of the GPU.
    pub fn work(&self, set: &MapSet, layer: usize) -> Work {
        set.casters.get(layer).map_or_else(Work::default, |casters| Work::of(casters, &self.geometry))
    }
}

fn content(view: GpuCasterView, batches: &[Batch], placed: &[GpuInstance], versions: &[u64]) -> Content {
    let mut content = Content { view, draws: Vec::with_capacity(batches.len()), placed: Vec::new() };
    for batch in batches {
        let instances = batch.instances.start as usize..batch.instances.end as usize;
        content.draws.push(Draw {
            mesh: batch.mesh,
            version: versions[batch.mesh],
            back_hidden: batch.back_hidden,
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
