//! One frame, as a list that can be read aloud.

use crate::draw_list::{Batch, Work};
use crate::options::View;
use crate::pipelines::MeshTarget;
use crate::readback;
use crate::renderer::Renderer;
use crate::threaded::{MapSchedule, locked};
use crate::timing::{Measure, Queries, Statistics};
use crate::volumes::Volumes;
use crate::{RenderError, RenderOptions};
use glam::Vec3;
use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Instant;
use umbrage::core::DEPTH;

/// What a pass did.
#[derive(Clone, Debug)]
pub struct PassReport {
    /// Its name in the plan; the light's index follows where there is one pass for each.
    pub name: String,
    /// What was asked of the GPU.
    pub work: Work,
    /// Milliseconds on the GPU, where the adapter can tell.
    pub gpu_ms: Option<f64>,
    /// What the GPU counted, where it was asked to and can.
    pub statistics: Option<Statistics>,
}

/// What a frame did.
#[derive(Clone, Debug)]
pub struct FrameReport {
    /// Milliseconds from the first command to the GPU's word that all is done. Fits, culling and uploads for what moved are
    /// in it.
    pub frame_ms: f64,
    /// In the order in which they ran. A map that is reused has no pass.
    pub passes: Vec<PassReport>,
    /// Maps that were drawn for this frame; by a thread: since the frame before.
    pub maps_drawn: u64,
    /// Maps that were looked up as they were.
    pub maps_reused: u64,
    /// How many frames ago the world was last as the maps show it. 0 unless a [`crate::MapSchedule`] lets them lag.
    pub maps_age_frames: u64,
    /// The same in milliseconds, from frame start to frame start.
    pub maps_age_ms: f64,
}

/// When each state of the world was last that of a frame: version, number of the frame, its start.
#[derive(Debug, Default)]
pub(crate) struct Ages {
    frames: u64,
    last_seen: VecDeque<(u64, u64, Instant)>,
}

impl Ages {
    /// A frame begins, in this state of the world.
    fn begin(&mut self, version: u64, start: Instant) {
        self.frames += 1;
        self.last_seen.retain(|seen| seen.0 != version);
        self.last_seen.push_back((version, self.frames, start));
    }

    /// Age of what shows `version`, in frames and milliseconds. States before it are forgotten. What no frame was in (it was
    /// drawn before the first) is as old as the oldest known.
    fn of(&mut self, version: u64, start: Instant) -> (u64, f64) {
        while self.last_seen.len() > 1 && self.last_seen.front().is_some_and(|seen| seen.0 < version) {
            self.last_seen.pop_front();
        }
        self.last_seen.front().map_or((0, 0.0), |(_, frame, at)| {
            (self.frames - frame, start.saturating_duration_since(*at).as_secs_f64() * 1e3)
        })
    }
}

impl Renderer<'_> {
    /// Draws one frame, waits for it, and measures what was asked for, where the adapter can. Maps that hold what they
    /// should are looked up as they are.
    ///
    /// # Errors
    /// [`RenderError::Gpu`] when the device refuses a command or is lost; [`RenderError::View`] and [`RenderError::Shadow`]
    /// when what was changed leaves nothing to show or no room.
    pub fn frame(&mut self, measure: Measure) -> Result<FrameReport, RenderError> {
        let start = Instant::now();
        let (index, by_thread) = match &self.thread {
            Some(thread) => thread.exchange(&self.world)?,
            None => (0, 0),
        };
        let set = Arc::clone(&self.sets[index]);
        let mut set = locked(&set);
        let drawn = if self.are_maps_due(start) {
            self.maker.refresh(&mut set, &self.world)?;
            set.stale(!self.options.reuse)
        } else {
            Vec::new()
        };
        self.tell(index, &set)?;

        let stale = self.masks.as_ref().map(|masks| masks.stale(self.options.reuse)).unwrap_or_default();
        if let Some(volumes) = self.volumes.as_mut().filter(|_| !self.options.reuse) {
            volumes.forget_faces();
        }
        let names = self.pass_names(&drawn, &stale);
        let queries = Queries::new(self.gpu, names.len() as u32, measure);
        let mut encoder =
            self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("frame") });
        let mut pass = 0;
        let mut work = Vec::with_capacity(names.len());
        // 1. Each light's map that does not hold what it should.
        for layer in &drawn {
            self.maker.record(&mut encoder, &mut set, *layer, Some((&queries, pass)));
            let of_map = self.maker.work(&set, *layer);
            pass += of_map.len() as u32;
            work.extend(of_map);
        }
        //    And each mask that does not.
        if let Some(masks) = &mut self.masks {
            let done = masks.record(self.gpu, &mut encoder, self.options.reuse, (&queries, pass));
            pass += done.len() as u32;
            work.extend(done);
        }
        // 2. Surfaces, into the G-buffer.
        if let Some(gbuffer) = &self.targets.gbuffer {
            self.record_surfaces(&mut encoder, gbuffer, &queries, pass);
            work.push(self.work_of(&self.solid));
            pass += 1;
        }
        // 3. What is counted over them, or taken away from them.
        if let Some(volumes) = &mut self.volumes {
            let done = volumes.record(&mut encoder, &self.targets, (&queries, pass));
            pass += done.len() as u32;
            work.extend(done);
        }
        if let Some(masks) = &self.masks {
            let done = masks.record_subtract(&mut encoder, &self.targets.depth, (&queries, pass));
            pass += done.len() as u32;
            work.extend(done);
        }
        // 4. Light on the G-buffer, or a debug view of it; or on surfaces as they are drawn.
        if self.screen.is_some() {
            self.record_screen(&mut encoder, &queries, pass);
            work.push(Work { draws: 1, instances: 1, triangles: 1, vertices: 3 });
            pass += 1;
        } else {
            self.record_lit_surfaces(&mut encoder, &queries, pass);
            work.push(self.work_of(&self.solid));
            pass += 1;
        }
        if let Some(done) = self.record_overdraw(&mut encoder, &queries, pass) {
            work.push(done);
            pass += 1;
        }
        // 5. What is mixed by alpha, over it.
        if self.blends() {
            self.record_blended(&mut encoder, &queries, pass);
            work.push(self.work_of(&self.blended));
        }
        queries.resolve(&mut encoder);
        let submitted = self.gpu.queue.submit([encoder.finish()]);
        if let Some(thread) = &self.thread {
            thread.release();
        }
        let (count, version) = (set.count() as u64, set.version.unwrap_or(self.world.version));
        drop(set);
        readback::wait_for(self.gpu, Some(submitted))?;
        let frame_ms = start.elapsed().as_secs_f64() * 1e3;
        let measured = queries.read(self.gpu);
        let passes = names
            .into_iter()
            .zip(work)
            .zip(measured)
            .map(|((name, work), (gpu_ms, statistics))| PassReport { name, work, gpu_ms, statistics })
            .collect();
        let maps_drawn = if self.thread.is_some() { by_thread } else { drawn.len() as u64 };
        self.warn_of_overflow()?;
        self.ages.begin(self.world.version, start);
        let (maps_age_frames, maps_age_ms) = self.ages.of(version, start);
        let maps_reused = count.saturating_sub(maps_drawn);
        Ok(FrameReport { frame_ms, passes, maps_drawn, maps_reused, maps_age_frames, maps_age_ms })
    }

    /// Is it the frame's to draw maps, and time to?
    fn are_maps_due(&mut self, now: Instant) -> bool {
        let due = match self.schedule {
            MapSchedule::EachFrame => true,
            MapSchedule::Every(interval) => self.drawn_at.is_none_or(|at| now >= at + interval),
            MapSchedule::Threaded(_) => false,
        };
        if due {
            self.drawn_at = Some(now);
        }
        due
    }

    /// The picture: RGBA, 8 bits each, rows from the top. V is grey, or in the colours of the light that arrives.
    ///
    /// # Errors
    /// [`RenderError::Gpu`] when the device is lost.
    pub fn picture(&self) -> Result<Vec<u8>, RenderError> {
        if self.options.view.is_density() {
            return self.density_picture();
        }
        if self.options.view == View::Volumes {
            return self.overdraw_picture();
        }
        if self.options.view != View::Visibility {
            return readback::texture(self.gpu, &self.targets.output);
        }
        let level = |v: f32| (v.clamp(0.0, 1.0) * 255.0).round() as u8;
        let pixel = |v: &Vec3| [level(v.x), level(v.y), level(v.z), 255];
        Ok(self.visibility_rgb()?.iter().flat_map(pixel).collect())
    }

    /// V of the shown light, unrounded, rows from the top: of coloured light the mean of red, green and blue. Only after a
    /// frame of [`View::Visibility`].
    ///
    /// # Errors
    /// [`RenderError::View`] for another view; [`RenderError::Gpu`] when the device is lost.
    pub fn visibility(&self) -> Result<Vec<f32>, RenderError> {
        // Exact for equal numbers, which a sum of three is not.
        let mean = |v: Vec3| if v.x == v.y && v.y == v.z { v.x } else { v.element_sum() / 3.0 };
        Ok(self.visibility_rgb()?.into_iter().map(mean).collect())
    }

    /// V of the shown light in red, green and blue, unrounded, rows from the top; three equal numbers where the technique does
    /// not colour light. Only after a frame of [`View::Visibility`].
    ///
    /// # Errors
    /// [`RenderError::View`] for another view; [`RenderError::Gpu`] when the device is lost.
    pub fn visibility_rgb(&self) -> Result<Vec<Vec3>, RenderError> {
        if self.options.view != View::Visibility {
            return Err(RenderError::View("only the view `visibility` holds V".into()));
        }
        let bytes = readback::texture(self.gpu, &self.targets.output)?;
        let number = |b: &[u8]| f32::from_le_bytes([b[0], b[1], b[2], b[3]]);
        Ok(if self.options.colors_light() {
            let color = |b: &[u8]| Vec3::new(number(b), number(&b[4..]), number(&b[8..]));
            bytes.chunks_exact(16).map(color).collect()
        } else {
            bytes.chunks_exact(4).map(|b| Vec3::splat(number(b))).collect()
        })
    }

    /// What the picture was asked to be.
    pub fn options(&self) -> &RenderOptions {
        &self.options
    }

    /// What the picture shows where nothing is: the background, or white in the debug views.
    fn cleared(&self) -> wgpu::Color {
        let background = self.options.background.as_dvec3();
        match self.options.view {
            View::Final | View::Light => {
                wgpu::Color { r: background.x, g: background.y, b: background.z, a: 1.0 }
            }
            View::Volumes => wgpu::Color::TRANSPARENT,
            view if view.is_density() => wgpu::Color::TRANSPARENT,
            _ => wgpu::Color::WHITE,
        }
    }

    fn blends(&self) -> bool {
        !self.blended.is_empty() && matches!(self.options.view, View::Final | View::Light)
    }

    fn pass_names(&self, drawn: &[usize], stale_masks: &[usize]) -> Vec<String> {
        let of_map = self.maker.pass_names();
        let of_view =
            |view: &usize| of_map.iter().map(move |name| format!("{name} {view}")).collect::<Vec<_>>();
        let mut names: Vec<String> = drawn.iter().flat_map(of_view).collect();
        let of_masks = self.masks.as_ref().map(|masks| masks.pass_names(stale_masks));
        let [masks, subtracted] = of_masks.unwrap_or_default();
        names.extend(masks);
        if self.targets.gbuffer.is_some() {
            names.push("surfaces".to_owned());
        }
        names.extend(subtracted);
        names.extend(self.volumes.iter().flat_map(Volumes::pass_names));
        names.push(match self.options.view {
            _ if self.screen.is_none() => "lit surfaces".to_owned(),
            View::Final | View::Light => "lighting".to_owned(),
            other => other.id().to_owned(),
        });
        names.extend(self.overdraw.as_ref().map(|_| format!("overdraw {}", self.options.shown_light)));
        if self.blends() {
            names.push("blended".to_owned());
        }
        names
    }

    fn record_surfaces(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        gbuffer: &wgpu::TextureView,
        queries: &Queries,
        pass: u32,
    ) {
        let clear = wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT);
        let target = (gbuffer, None, clear);
        let objects = self.targets.objects.as_ref();
        let depth = depth(&self.targets.depth, wgpu::LoadOp::Clear(DEPTH.clear()));
        let mut recorded = mesh_pass(encoder, "surfaces", target, objects, depth, queries.stamps(pass));
        queries.count(&mut recorded, pass, |recorded| {
            self.draw_meshes(recorded, &self.solid, MeshTarget::Gbuffer);
        });
    }

    fn record_lit_surfaces(&self, encoder: &mut wgpu::CommandEncoder, queries: &Queries, pass: u32) {
        let clear = wgpu::LoadOp::Clear(self.cleared());
        let output = &self.targets.output_view;
        let target = match &self.targets.multisampled {
            Some(samples) => (samples, (!self.blends()).then_some(output), clear),
            None => (output, None, clear),
        };
        let depth = depth(self.targets.forward_depth(), wgpu::LoadOp::Clear(DEPTH.clear()));
        let mut recorded = mesh_pass(encoder, "lit surfaces", target, None, depth, queries.stamps(pass));
        let target = MeshTarget::Forward { samples: self.options.samples };
        queries.count(&mut recorded, pass, |recorded| self.draw_meshes(recorded, &self.solid, target));
    }

    fn record_screen(&self, encoder: &mut wgpu::CommandEncoder, queries: &Queries, pass: u32) {
        let (Some(pipeline), Some(gbuffer)) = (&self.screen, &self.gbuffer_group) else { return };
        let Some(frame_group) = &self.frame_group else { return };
        let mut recorded = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("screen"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &self.targets.output_view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(self.cleared()),
                    store: wgpu::StoreOp::Store,
                },
            })],
            // Read only: the shader reads it too.
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.targets.depth,
                depth_ops: None,
                stencil_ops: None,
            }),
            timestamp_writes: queries.stamps(pass),
            occlusion_query_set: None,
            multiview_mask: None,
        });
        queries.count(&mut recorded, pass, |recorded| {
            recorded.set_pipeline(pipeline);
            recorded.set_bind_group(0, frame_group, &[]);
            recorded.set_bind_group(1, gbuffer, &[]);
            recorded.draw(0..3, 0..1);
        });
    }

    fn record_blended(&self, encoder: &mut wgpu::CommandEncoder, queries: &Queries, pass: u32) {
        let output = &self.targets.output_view;
        let target = match &self.targets.multisampled {
            Some(samples) => (samples, Some(output), wgpu::LoadOp::Load),
            None => (output, None, wgpu::LoadOp::Load),
        };
        let depth = depth(self.targets.forward_depth(), wgpu::LoadOp::Load);
        let mut recorded = mesh_pass(encoder, "blended", target, None, depth, queries.stamps(pass));
        let target = MeshTarget::Forward { samples: self.options.samples };
        queries.count(&mut recorded, pass, |recorded| self.draw_meshes(recorded, &self.blended, target));
    }

    fn draw_meshes(&self, recorded: &mut wgpu::RenderPass<'_>, batches: &[Batch], target: MeshTarget) {
        let Some(frame_group) = &self.frame_group else { return };
        recorded.set_bind_group(0, frame_group, &[]);
        recorded.set_index_buffer(self.geometry.indices.slice(..), wgpu::IndexFormat::Uint32);
        recorded.set_vertex_buffer(1, self.instances.buffer.slice(..));
        recorded.set_vertex_buffer(3, self.objects.buffer.slice(..));
        for batch in batches {
            let mesh = &self.geometry.meshes[batch.mesh];
            let Some(pipeline) = self.mesh_pipelines.get(target, batch.variant) else { continue };
            recorded.set_pipeline(pipeline);
            recorded.set_bind_group(1, &self.materials[self.material_of_mesh[batch.mesh]].bind_group, &[]);
            recorded.set_vertex_buffer(0, self.geometry.positions.slice(mesh.position_offset..));
            let attributes = if mesh.full { &self.geometry.full } else { &self.geometry.normals };
            recorded.set_vertex_buffer(2, attributes.slice(mesh.attribute_offset..));
            recorded.draw_indexed(mesh.indices.clone(), 0, batch.instances.clone());
        }
    }
}

/// Begins a pass that draws meshes: target, what it is resolved to, and how it begins; with it, what keeps each pixel's object.
fn mesh_pass<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    label: &str,
    (view, resolve_target, load): (&wgpu::TextureView, Option<&wgpu::TextureView>, wgpu::LoadOp<wgpu::Color>),
    objects: Option<&wgpu::TextureView>,
    depth: wgpu::RenderPassDepthStencilAttachment<'_>,
    timestamp_writes: Option<wgpu::RenderPassTimestampWrites<'_>>,
) -> wgpu::RenderPass<'a> {
    let attachment = |view, resolve_target, load| {
        let ops = wgpu::Operations { load, store: wgpu::StoreOp::Store };
        Some(wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target, ops })
    };
    let nothing = wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT);
    let attachments =
        [attachment(view, resolve_target, load), attachment(objects.unwrap_or(view), None, nothing)];
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(label),
        color_attachments: &attachments[..if objects.is_some() { 2 } else { 1 }],
        depth_stencil_attachment: Some(depth),
        timestamp_writes,
        occlusion_query_set: None,
        multiview_mask: None,
    })
}

fn depth(view: &wgpu::TextureView, load: wgpu::LoadOp<f32>) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    wgpu::RenderPassDepthStencilAttachment {
        view,
        depth_ops: Some(wgpu::Operations { load, store: wgpu::StoreOp::Store }),
        stencil_ops: None,
    }
}
