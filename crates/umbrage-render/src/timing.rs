//! What passes cost, as far as the adapter can tell: time stamps, and counts of vertices and fragments.

use crate::gpu::Gpu;

/// What the GPU counted in a pass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// Runs of the vertex shader.
    pub vertex_runs: u64,
    /// Triangles that were left after clipping.
    pub clipped_triangles: u64,
    /// Runs of the fragment shader.
    pub fragment_runs: u64,
}

/// What to measure of a frame beside its time from start to end. Measuring makes a frame slower: software
/// rasterisers, for one, finish all work before each time stamp.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// Nothing: for the time of the whole frame.
    Frame,
    /// Each pass's time on the GPU.
    Passes,
    /// Each pass's vertices and fragments, counted by the GPU.
    Counts,
}

/// Queries for a number of passes.
#[derive(Debug)]
pub struct Queries {
    stamps: Option<wgpu::QuerySet>,
    statistics: Option<wgpu::QuerySet>,
    /// Where results are resolved to, and where they can be read; only when something is measured.
    buffers: Option<(wgpu::Buffer, wgpu::Buffer)>,
    passes: u32,
    tick_ns: f64,
}

const STATISTICS: wgpu::PipelineStatisticsTypes = wgpu::PipelineStatisticsTypes::VERTEX_SHADER_INVOCATIONS
    .union(wgpu::PipelineStatisticsTypes::CLIPPER_PRIMITIVES_OUT)
    .union(wgpu::PipelineStatisticsTypes::FRAGMENT_SHADER_INVOCATIONS);
/// Query results may only be resolved to multiples of this.
const ALIGN: u64 = 256;

impl Queries {
    /// Room for `passes` passes.
    pub fn new(gpu: &Gpu, passes: u32, measure: Measure) -> Self {
        let set = |label, ty, count| {
            gpu.device.create_query_set(&wgpu::QuerySetDescriptor { label: Some(label), ty, count })
        };
        let buffer = |label, usage| {
            let size = Self::statistics_offset(passes) + 24 * u64::from(passes);
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        use wgpu::BufferUsages as Usage;
        let stamps = (measure == Measure::Passes && gpu.has_timestamps())
            .then(|| set("stamps", wgpu::QueryType::Timestamp, 2 * passes));
        let statistics = (measure == Measure::Counts && gpu.has_statistics())
            .then(|| set("statistics", wgpu::QueryType::PipelineStatistics(STATISTICS), passes));
        let buffers = (stamps.is_some() || statistics.is_some()).then(|| {
            let resolved = buffer("queries", Usage::QUERY_RESOLVE | Usage::COPY_SRC);
            (resolved, buffer("queries read", Usage::MAP_READ | Usage::COPY_DST))
        });
        Self { stamps, statistics, buffers, passes, tick_ns: f64::from(gpu.queue.get_timestamp_period()) }
    }

    fn statistics_offset(passes: u32) -> u64 {
        (16 * u64::from(passes)).next_multiple_of(ALIGN)
    }

    /// What goes into the descriptor of a pass.
    pub fn stamps(&self, pass: u32) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        self.stamps.as_ref().map(|query_set| wgpu::RenderPassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: Some(2 * pass),
            end_of_pass_write_index: Some(2 * pass + 1),
        })
    }

    /// What goes into the descriptor of a compute pass.
    pub fn compute_stamps(&self, pass: u32) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        self.stamps.as_ref().map(|query_set| wgpu::ComputePassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: Some(2 * pass),
            end_of_pass_write_index: Some(2 * pass + 1),
        })
    }

    /// Counts the work of `find`, which has neither vertices nor fragments: a query that was never begun has no end.
    pub fn count_compute(
        &self,
        recorded: &mut wgpu::ComputePass<'_>,
        pass: u32,
        find: impl FnOnce(&mut wgpu::ComputePass<'_>),
    ) {
        if let Some(set) = &self.statistics {
            recorded.begin_pipeline_statistics_query(set, pass);
        }
        find(recorded);
        if self.statistics.is_some() {
            recorded.end_pipeline_statistics_query();
        }
    }

    /// Counts the work of `draw`.
    pub fn count(
        &self,
        recorded: &mut wgpu::RenderPass<'_>,
        pass: u32,
        draw: impl FnOnce(&mut wgpu::RenderPass<'_>),
    ) {
        if let Some(set) = &self.statistics {
            recorded.begin_pipeline_statistics_query(set, pass);
        }
        draw(recorded);
        if self.statistics.is_some() {
            recorded.end_pipeline_statistics_query();
        }
    }

    /// Records the copy of all results to where they can be read.
    pub fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        let Some((resolved, read)) = &self.buffers else { return };
        if let Some(stamps) = &self.stamps {
            encoder.resolve_query_set(stamps, 0..2 * self.passes, resolved, 0);
        }
        if let Some(statistics) = &self.statistics {
            let offset = Self::statistics_offset(self.passes);
            encoder.resolve_query_set(statistics, 0..self.passes, resolved, offset);
        }
        encoder.copy_buffer_to_buffer(resolved, 0, read, 0, read.size());
    }

    /// Milliseconds and counts of each pass; `None` for what the adapter cannot tell.
    pub fn read(&self, gpu: &Gpu) -> Vec<(Option<f64>, Option<Statistics>)> {
        let nothing = vec![(None, None); self.passes as usize];
        let Some((_, read)) = &self.buffers else { return nothing };
        let Ok(bytes) = crate::readback::map(gpu, read) else { return nothing };
        let number = |at: u64| {
            let at = at as usize;
            bytes.get(at..at + 8).map_or(0, |b| u64::from_le_bytes(b.try_into().unwrap_or_default()))
        };
        (0..u64::from(self.passes))
            .map(|pass| {
                let ms = self.stamps.as_ref().map(|_| {
                    number(16 * pass + 8).saturating_sub(number(16 * pass)) as f64 * self.tick_ns * 1e-6
                });
                let counted = self.statistics.as_ref().map(|_| {
                    let at = Self::statistics_offset(self.passes) + 24 * pass;
                    Statistics {
                        vertex_runs: number(at),
                        clipped_triangles: number(at + 8),
                        fragment_runs: number(at + 16),
                    }
                });
                (ms, counted)
            })
            .collect()
    }
}
