//! One frame, as a list that can be read aloud.

use crate::draw_list::{Batch, Work};
use crate::options::View;
use crate::pipelines::MeshTarget;
use crate::readback;
use crate::renderer::{Renderer, Shadows};
use crate::timing::{Measure, Queries, Statistics};
use crate::{RenderError, RenderOptions};
use std::time::Instant;
use umbrage::caster::GpuCasterView;
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
    /// Milliseconds from the first command to the GPU's word that all is done.
    pub frame_ms: f64,
    /// In the order in which they ran.
    pub passes: Vec<PassReport>,
}

impl Renderer<'_> {
    /// Draws one frame, waits for it, and measures what was asked for, where the adapter can.
    ///
    /// # Errors
    /// [`RenderError::Gpu`] when the device refuses a command or is lost.
    pub fn frame(&self, measure: Measure) -> Result<FrameReport, RenderError> {
        let names = self.pass_names();
        let queries = Queries::new(self.gpu, names.len() as u32, measure);
        let start = Instant::now();
        let mut encoder =
            self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("frame") });
        let mut pass = 0;
        let mut work = Vec::with_capacity(names.len());
        // 1. Each light's map.
        if let Some(shadows) = &self.shadows {
            for (layer, casters) in shadows.casters.iter().enumerate() {
                self.record_map(&mut encoder, shadows, layer, &queries, pass);
                work.push(self.work_of(casters));
                pass += 1;
            }
        }
        // 2. Surfaces, into the G-buffer or lit at once.
        self.record_surfaces(&mut encoder, &queries, pass);
        work.push(self.work_of(&self.solid));
        pass += 1;
        // 3. Light on the G-buffer, or a debug view of it.
        if self.screen.is_some() {
            self.record_screen(&mut encoder, &queries, pass);
            work.push(Work { draws: 1, instances: 1, triangles: 1, vertices: 3 });
            pass += 1;
        }
        // 4. What is mixed by alpha, over it.
        if self.blends() {
            self.record_blended(&mut encoder, &queries, pass);
            work.push(self.work_of(&self.blended));
        }
        queries.resolve(&mut encoder);
        self.gpu.queue.submit([encoder.finish()]);
        readback::wait(self.gpu)?;
        let frame_ms = start.elapsed().as_secs_f64() * 1e3;
        let measured = queries.read(self.gpu);
        let passes = names
            .into_iter()
            .zip(work)
            .zip(measured)
            .map(|((name, work), (gpu_ms, statistics))| PassReport { name, work, gpu_ms, statistics })
            .collect();
        Ok(FrameReport { frame_ms, passes })
    }

    /// The picture: RGBA, 8 bits each, rows from the top. V is grey.
    ///
    /// # Errors
    /// [`RenderError::Gpu`] when the device is lost.
    pub fn picture(&self) -> Result<Vec<u8>, RenderError> {
        if self.options.view.is_density() {
            return self.density_picture();
        }
        if self.options.view != View::Visibility {
            return readback::texture(self.gpu, &self.targets.output);
        }
        let grey = |v: &f32| {
            let level = (v.clamp(0.0, 1.0) * 255.0).round() as u8;
            [level, level, level, 255]
        };
        Ok(self.visibility()?.iter().flat_map(grey).collect())
    }

    /// V of the shown light, unrounded, rows from the top. Only after a frame of [`View::Visibility`].
    ///
    /// # Errors
    /// [`RenderError::View`] for another view; [`RenderError::Gpu`] when the device is lost.
    pub fn visibility(&self) -> Result<Vec<f32>, RenderError> {
        if self.options.view != View::Visibility {
            return Err(RenderError::View("only the view `visibility` holds V".into()));
        }
        let bytes = readback::texture(self.gpu, &self.targets.output)?;
        Ok(bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect())
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
            view if view.is_density() => wgpu::Color::TRANSPARENT,
            _ => wgpu::Color::WHITE,
        }
    }

    fn blends(&self) -> bool {
        !self.blended.is_empty() && matches!(self.options.view, View::Final | View::Light)
    }

    fn pass_names(&self) -> Vec<String> {
        let mut names = Vec::new();
        if let Some(shadows) = &self.shadows {
            names.extend((0..shadows.casters.len()).map(|view| format!("{} {view}", shadows.pass.name)));
        }
        names.push(if self.screen.is_some() { "surfaces" } else { "lit surfaces" }.to_owned());
        if self.screen.is_some() {
            names.push(match self.options.view {
                View::Final | View::Light => "lighting".to_owned(),
                other => other.id().to_owned(),
            });
        }
        if self.blends() {
            names.push("blended".to_owned());
        }
        names
    }

    fn record_map(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        shadows: &Shadows,
        layer: usize,
        queries: &Queries,
        pass: u32,
    ) {
        let stamps = queries.stamps(pass);
        umbrage::record_caster_pass(
            encoder,
            &shadows.maps,
            layer as u32,
            &shadows.pass,
            stamps,
            |recorded| {
                queries.count(recorded, pass, |recorded| {
                    recorded.set_bind_group(0, &shadows.view_group, &[layer as u32 * GpuCasterView::STRIDE]);
                    recorded.set_index_buffer(self.geometry.indices.slice(..), wgpu::IndexFormat::Uint32);
                    recorded.set_vertex_buffer(1, self.instances.slice(..));
                    for batch in &shadows.casters[layer] {
                        self.draw_caster(recorded, shadows, batch);
                    }
                });
            },
        );
    }

    fn draw_caster(&self, recorded: &mut wgpu::RenderPass<'_>, shadows: &Shadows, batch: &Batch) {
        let mesh = &self.geometry.meshes[batch.mesh];
        let cut_out = &self.materials[self.material_of_mesh[batch.mesh]].caster;
        if let (Some(group), Some(offset)) = (cut_out, mesh.uv_alpha_offset) {
            recorded.set_pipeline(&shadows.pipelines.cut_out);
            recorded.set_bind_group(1, group, &[]);
            recorded.set_vertex_buffer(2, self.geometry.uv_alpha.slice(offset..));
        } else {
            recorded.set_pipeline(match (batch.back_hidden, batch.variant.mirrored) {
                (true, false) => &shadows.pipelines.closed,
                (true, true) => &shadows.pipelines.closed_mirrored,
                (false, _) => &shadows.pipelines.open,
            });
        }
        recorded.set_vertex_buffer(0, self.geometry.positions.slice(mesh.position_offset..));
        recorded.draw_indexed(mesh.indices.clone(), 0, batch.instances.clone());
    }

    fn record_surfaces(&self, encoder: &mut wgpu::CommandEncoder, queries: &Queries, pass: u32) {
        let cleared = self.cleared();
        let (view, resolve_target, clear, target) = match (&self.targets.gbuffer, &self.targets.multisampled)
        {
            (Some(gbuffer), _) => (gbuffer, None, wgpu::Color::TRANSPARENT, MeshTarget::Gbuffer),
            (None, Some(samples)) => {
                let target = MeshTarget::Forward { samples: self.options.samples };
                (samples, (!self.blends()).then_some(&self.targets.output_view), cleared, target)
            }
            (None, None) => (
                &self.targets.output_view,
                None,
                cleared,
                MeshTarget::Forward { samples: self.options.samples },
            ),
        };
        let mut recorded = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("surfaces"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(clear), store: wgpu::StoreOp::Store },
            })],
            depth_stencil_attachment: Some(depth(&self.targets.depth, wgpu::LoadOp::Clear(DEPTH.clear()))),
            timestamp_writes: queries.stamps(pass),
            occlusion_query_set: None,
            multiview_mask: None,
        });
        queries.count(&mut recorded, pass, |recorded| self.draw_meshes(recorded, &self.solid, target));
    }

    fn record_screen(&self, encoder: &mut wgpu::CommandEncoder, queries: &Queries, pass: u32) {
        let (Some(pipeline), Some(gbuffer)) = (&self.screen, &self.gbuffer_group) else { return };
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
            recorded.set_bind_group(0, &self.frame_group, &[]);
            recorded.set_bind_group(1, gbuffer, &[]);
            recorded.draw(0..3, 0..1);
        });
    }

    fn record_blended(&self, encoder: &mut wgpu::CommandEncoder, queries: &Queries, pass: u32) {
        let (view, resolve_target) = match &self.targets.multisampled {
            Some(samples) => (samples, Some(&self.targets.output_view)),
            None => (&self.targets.output_view, None),
        };
        let mut recorded = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("blended"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target,
                ops: wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store },
            })],
            depth_stencil_attachment: Some(depth(&self.targets.depth, wgpu::LoadOp::Load)),
            timestamp_writes: queries.stamps(pass),
            occlusion_query_set: None,
            multiview_mask: None,
        });
        let target = MeshTarget::Forward { samples: self.options.samples };
        queries.count(&mut recorded, pass, |recorded| self.draw_meshes(recorded, &self.blended, target));
    }

    fn draw_meshes(&self, recorded: &mut wgpu::RenderPass<'_>, batches: &[Batch], target: MeshTarget) {
        recorded.set_bind_group(0, &self.frame_group, &[]);
        recorded.set_index_buffer(self.geometry.indices.slice(..), wgpu::IndexFormat::Uint32);
        recorded.set_vertex_buffer(1, self.instances.slice(..));
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

fn depth(view: &wgpu::TextureView, load: wgpu::LoadOp<f32>) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    wgpu::RenderPassDepthStencilAttachment {
        view,
        depth_ops: Some(wgpu::Operations { load, store: wgpu::StoreOp::Store }),
        stencil_ops: None,
    }
}
