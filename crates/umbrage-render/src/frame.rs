//! One frame, as a list that can be read aloud.

use crate::draw_list::{Batch, Work};
use crate::options::View;
use crate::peeled::Peeled;
use crate::pipelines::MeshTarget;
use crate::readback;
use crate::renderer::{Renderer, Shadows, Translucent};
use crate::timing::{Measure, Queries, Statistics};
use crate::{RenderError, RenderOptions};
use glam::Vec3;
use std::time::Instant;
use umbrage::CasterPipelines;
use umbrage::caster::GpuCasterView;
use umbrage::core::DEPTH;
use umbrage::peel::record_peel_layer;

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
            for layer in 0..shadows.casters.len() {
                if let Some(peeled) = &shadows.peeled {
                    self.record_peel(&mut encoder, shadows, peeled, layer, &queries, pass);
                    work.push(self.work_of(&shadows.blocking(layer)));
                    pass += 1;
                }
                self.record_map(&mut encoder, shadows, layer, &queries, pass);
                work.push(self.work_of(&shadows.blocking(layer)));
                pass += 1;
                if let Some(translucent) = &shadows.translucent {
                    self.record_translucent(&mut encoder, (shadows, translucent), layer, &queries, pass);
                    let drawn = self.work_of(&shadows.tinting(layer));
                    work.extend([drawn; 2]);
                    pass += 2;
                }
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

    /// The picture: RGBA, 8 bits each, rows from the top. V is grey, or in the colours of the light that arrives.
    ///
    /// # Errors
    /// [`RenderError::Gpu`] when the device is lost.
    pub fn picture(&self) -> Result<Vec<u8>, RenderError> {
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
            _ => wgpu::Color::WHITE,
        }
    }

    fn blends(&self) -> bool {
        !self.blended.is_empty() && matches!(self.options.view, View::Final | View::Light)
    }

    fn pass_names(&self) -> Vec<String> {
        let mut names = Vec::new();
        if let Some(shadows) = &self.shadows {
            let peel = shadows.peeled.as_ref().map(|peeled| peeled.pass.name);
            let translucent = shadows.translucent.iter().flat_map(|t| &t.passes).map(|p| p.name);
            let of_a_view: Vec<_> = peel.into_iter().chain([shadows.pass.name]).chain(translucent).collect();
            let views = 0..shadows.casters.len();
            names.extend(views.flat_map(|view| of_a_view.iter().map(move |name| format!("{name} {view}"))));
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
                if let Some(peeled) = &shadows.peeled {
                    recorded.set_bind_group(1, peeled.peel.behind(0), &[]);
                }
                queries.count(recorded, pass, |recorded| {
                    self.draw_casters(recorded, shadows, &shadows.pipelines, layer);
                });
            },
        );
    }

    /// The colours of a layer, and the nearest translucent casters: passes `pass` and the next.
    fn record_translucent(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        (shadows, translucent): (&Shadows, &Translucent),
        layer: usize,
        queries: &Queries,
        pass: u32,
    ) {
        let [colors, nearest] = &translucent.passes;
        let draw = |recorded: &mut wgpu::RenderPass<'_>, pass, pipeline: &wgpu::RenderPipeline| {
            queries.count(recorded, pass, |recorded| {
                recorded.set_pipeline(pipeline);
                recorded.set_bind_group(0, &shadows.view_group, &[layer as u32 * GpuCasterView::STRIDE]);
                recorded.set_index_buffer(self.geometry.indices.slice(..), wgpu::IndexFormat::Uint32);
                recorded.set_vertex_buffer(1, self.instances.slice(..));
                for batch in &shadows.tinting(layer) {
                    let mesh = &self.geometry.meshes[batch.mesh];
                    let group = &self.materials[self.material_of_mesh[batch.mesh]].caster;
                    let (Some(group), Some(offset)) = (group, mesh.uv_color_offset) else { continue };
                    recorded.set_bind_group(1, group, &[]);
                    recorded.set_vertex_buffer(0, self.geometry.positions.slice(mesh.position_offset..));
                    recorded.set_vertex_buffer(2, self.geometry.uv_color.slice(offset..));
                    recorded.draw_indexed(mesh.indices.clone(), 0, batch.instances.clone());
                }
            });
        };
        let (maps, pipelines, at) = (&translucent.maps, &translucent.pipelines, layer as u32);
        let stamps = queries.stamps(pass);
        umbrage::record_color_pass(encoder, &shadows.maps, maps, at, colors, stamps, |recorded| {
            draw(recorded, pass, &pipelines.color);
        });
        let stamps = queries.stamps(pass + 1);
        umbrage::record_nearest_pass(encoder, maps, at, nearest, stamps, |recorded| {
            draw(recorded, pass + 1, &pipelines.nearest);
        });
    }

    fn record_peel(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        shadows: &Shadows,
        peeled: &Peeled,
        layer: usize,
        queries: &Queries,
        pass: u32,
    ) {
        let stamps = queries.stamps(pass);
        record_peel_layer(encoder, &peeled.peel, 0, &peeled.pass, stamps, |recorded| {
            queries.count(recorded, pass, |recorded| {
                self.draw_casters(recorded, shadows, &peeled.pipelines, layer);
            });
        });
    }

    fn draw_casters(
        &self,
        recorded: &mut wgpu::RenderPass<'_>,
        shadows: &Shadows,
        pipelines: &CasterPipelines,
        layer: usize,
    ) {
        recorded.set_bind_group(0, &shadows.view_group, &[layer as u32 * GpuCasterView::STRIDE]);
        recorded.set_index_buffer(self.geometry.indices.slice(..), wgpu::IndexFormat::Uint32);
        recorded.set_vertex_buffer(1, self.instances.slice(..));
        for batch in &shadows.blocking(layer) {
            self.draw_caster(recorded, pipelines, batch);
        }
    }

    fn draw_caster(&self, recorded: &mut wgpu::RenderPass<'_>, pipelines: &CasterPipelines, batch: &Batch) {
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

impl Shadows {
    /// The draws of a view's map: without translucent casters where those colour the light.
    fn blocking(&self, layer: usize) -> Vec<Batch> {
        let colors = self.translucent.is_some();
        self.casters[layer].iter().filter(|batch| !(colors && batch.variant.blend)).cloned().collect()
    }

    /// The draws of translucent casters.
    fn tinting(&self, layer: usize) -> Vec<Batch> {
        self.casters[layer].iter().filter(|batch| batch.variant.blend).cloned().collect()
    }
}

fn depth(view: &wgpu::TextureView, load: wgpu::LoadOp<f32>) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    wgpu::RenderPassDepthStencilAttachment {
        view,
        depth_ops: Some(wgpu::Operations { load, store: wgpu::StoreOp::Store }),
        stencil_ops: None,
    }
}
