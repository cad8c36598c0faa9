//! The passes of a frame, recorded into the caller's encoder.

use super::casting::{Casting, Pipelines};
use super::handles::{Id, LightHandle, Store, index};
use super::lights::Lit;
use super::meshes::Mesh;
use super::own::{OwnDraw, OwnTarget};
use super::pool::Pool;
use super::views::{Draw, Draws, How, Kept, View};
use super::{Shadows, ShadowsError};
use crate::caster::GpuCasterView;
use crate::peel::record_peel_layer;
use crate::{record_caster_pass, record_color_pass, record_nearest_pass};
use slotmap::DefaultKey;
use umbrage_core::technique::volume::Soften;

/// What a frame's recording asks of the GPU, counted on the CPU.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Recorded {
    /// Maps that were drawn, or drawn over.
    pub maps: u64,
    /// Of those, maps for which what stands still was copied, not drawn.
    pub copied: u64,
    /// Masks that were drawn.
    pub masks: u64,
    /// Draw calls into maps, without the caller's own.
    pub draws: u64,
    /// Triangles drawn into maps, without the caller's own.
    pub triangles: u64,
}

type Own<'a> = dyn FnMut(&OwnDraw<'_>, &mut wgpu::RenderPass<'_>) + 'a;

impl Shadows {
    /// Records the passes that draw maps which do not hold what they should: before whatever looks them up. Nothing where all do.
    ///
    /// # Errors
    /// [`ShadowsError::NotPrepared`].
    pub fn record(&mut self, encoder: &mut wgpu::CommandEncoder) -> Result<Recorded, ShadowsError> {
        self.record_with(encoder, |_, _| {})
    }

    /// The same, and `own` draws the casters of [`Shadows::add_own_caster`] in each pass that needs them, with pipelines as
    /// [`OwnTarget`] says. Bind group 0 is set ([`Shadows::own_draw_layout`], [`crate::caster::caster_view_wgsl`]) and has to stay; all
    /// else may be changed. Midpoint maps keep the nearest of these casters themselves, and coloured light takes them for opaque.
    ///
    /// # Errors
    /// [`ShadowsError::NotPrepared`].
    pub fn record_with(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        mut own: impl FnMut(&OwnDraw<'_>, &mut wgpu::RenderPass<'_>),
    ) -> Result<Recorded, ShadowsError> {
        if !self.is_prepared {
            return Err(ShadowsError::NotPrepared { call: "record" });
        }
        let mut done = Recorded::default();
        let Self { device, lights, meshes, castings, pools, view_group, moving_placed, .. } = self;
        let of = lights.id(DefaultKey::default());
        for (key, lit) in lights.iter_mut() {
            let Some(casting) = lit.casting.and_then(|casting| castings.get(casting)) else { continue };
            let pool = &pools[casting.pool];
            for (number, view) in (lit.first_view..).zip(&mut lit.views).filter(|(_, view)| !view.holds) {
                view.keep(device, casting, pool);
                let light = LightHandle(Id { key, ..of });
                let moving_placed = &moving_placed.buffer;
                let recorder = Recorder { meshes, pool, view_group, moving_placed, casting, number, light };
                recorder.record(encoder, view, &mut own, &mut done);
            }
        }
        if let Some(masks) = &mut self.masks {
            done.masks = masks.record(encoder, &self.meshes);
        }
        Ok(done)
    }

    /// Records the passes that find V on the screen, for lights whose technique does so (volumes, subtractive masks): after the
    /// depth of all that is lit is drawn, and before it is lit. Nothing for all other lights. `depth_stencil` is that depth, with
    /// its stencil, one sample a pixel: its depth stays, its stencil is overwritten. Soft volumes read it, so that its texture needs
    /// `TEXTURE_BINDING`.
    ///
    /// # Errors
    /// [`ShadowsError::NotPrepared`]; [`ShadowsError::DepthFormat`], [`ShadowsError::DepthSize`], [`ShadowsError::Buffer`] and
    /// [`ShadowsError::ForeignDevice`] for a depth that cannot be used.
    pub fn record_screen(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        depth_stencil: &wgpu::TextureView,
    ) -> Result<(), ShadowsError> {
        if !self.is_prepared {
            return Err(ShadowsError::NotPrepared { call: "record_screen" });
        }
        let Self { device, lights, meshes, screen, masks, .. } = self;
        let Some(screen) = screen.as_mut().filter(|screen| screen.count > 0) else { return Ok(()) };
        let blurs = |lit: &Lit| lit.volume.is_some_and(|volume| volume.choices.soften == Soften::Blur);
        screen.check(device, depth_stencil, lights.iter().any(|(_, lit)| blurs(lit)))?;
        let read = screen.checked.as_ref().and_then(|(_, read)| read.as_ref());
        if let Some(volumes) = &mut screen.volumes {
            let layer = |number: usize| lights.iter().find(|(key, _)| index(*key) == number)?.1.screen;
            let v = &screen.v;
            volumes.record(encoder, depth_stencil, read, |number| v.layer(layer(number)?), &mut ());
        }
        for (_, lit) in lights.iter().filter(|(_, lit)| lit.is_subtractive) {
            let v = lit.screen.and_then(|layer| screen.v.layer(layer));
            if let (Some(masks), Some(v)) = (masks.as_ref(), v) {
                masks.record_subtract(encoder, depth_stencil, v, lit.mask_number, meshes);
            }
        }
        Ok(())
    }
}

impl View {
    /// Makes a texture for what stands still, where copying it is cheaper than drawing it anew below what moves.
    fn keep(&mut self, device: &wgpu::Device, casting: &Casting, pool: &Pool) {
        let size_texel = pool.kind.size_texel;
        // Copying a texel costs about as much as a sixty-fourth of a triangle; a draw call as much as some thousand texels.
        let copied = u64::from(size_texel).pow(2) / 64;
        let drawn = self.still.triangles + 64 * self.still.list.len() as u64;
        let is_worth = drawn > copied || !self.still.own.is_empty();
        if self.kept.is_some() || self.moving.is_empty() || !is_worth || !casting.can_keep(&pool.kind) {
            return;
        }
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("umbrage what stands still"),
            size: wgpu::Extent3d { width: size_texel, height: size_texel, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: pool.kind.format.format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        self.kept = Some(Kept { texture, view, holds: false });
    }
}

/// One view to draw.
struct Recorder<'a> {
    meshes: &'a Store<Mesh>,
    pool: &'a Pool,
    view_group: &'a wgpu::BindGroup,
    moving_placed: &'a wgpu::Buffer,
    casting: &'a Casting,
    /// Of the view, in the table.
    number: u32,
    light: LightHandle,
}

/// Which of a view's lists.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Part {
    All,
    Still,
    Moving,
}

impl Recorder<'_> {
    fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        view: &mut View,
        own: &mut Own<'_>,
        done: &mut Recorded,
    ) {
        let pool = self.pool;
        let (maps, layer, pass) = (pool.maps(), view.layer, &self.casting.pass);
        let Some(target) = maps.layer(layer) else { return };
        if view.kept.is_some() && !view.moving.is_empty() {
            self.record_over_kept(encoder, view, target, own, done);
        } else {
            // 1. What a midpoint lies behind.
            if let Some((pass, peel)) = &self.casting.peel {
                record_peel_layer(encoder, peel, 0, pass, None, |recorded| {
                    self.draw(recorded, view, Part::All, |p| p.peel.as_ref().unwrap_or(&p.map), done);
                });
            }
            // 2. The map itself.
            record_caster_pass(encoder, maps, layer, pass, None, |recorded| {
                if let Some((_, peel)) = &self.casting.peel {
                    recorded.set_bind_group(1, peel.behind(0), &[]);
                }
                self.draw(recorded, view, Part::All, |p| &p.map, done);
                self.draw_own(recorded, view, Part::All, own);
            });
            // 3. The colours of translucent casters, and the nearest of them.
            if let (Some([colors, nearest]), Some(translucent)) =
                (&self.casting.translucent, pool.translucent())
            {
                record_color_pass(encoder, maps, translucent, layer, colors, None, |recorded| {
                    self.draw_translucent(recorded, view, false, done);
                });
                record_nearest_pass(encoder, translucent, layer, nearest, None, |recorded| {
                    self.draw_translucent(recorded, view, true, done);
                });
            }
        }
        view.holds = true;
        done.maps += 1;
    }

    /// What stands still is copied, and drawn before that only if it changed; what moves is drawn over it.
    fn record_over_kept(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        view: &mut View,
        target: &wgpu::TextureView,
        own: &mut Own<'_>,
        done: &mut Recorded,
    ) {
        let Some(mut kept) = view.kept.take() else { return };
        let clear = wgpu::LoadOp::Clear(self.casting.pass.clear_depth);
        if std::mem::replace(&mut kept.holds, true) {
            done.copied += 1;
        } else {
            let mut recorded = depth_pass(encoder, self.casting.pass.name, &kept.view, clear);
            self.draw(&mut recorded, view, Part::Still, |p| &p.map, done);
            self.draw_own(&mut recorded, view, Part::Still, own);
        }
        let whole = |texture, layer| wgpu::TexelCopyTextureInfo {
            texture,
            mip_level: 0,
            origin: wgpu::Origin3d { x: 0, y: 0, z: layer },
            aspect: wgpu::TextureAspect::All,
        };
        let maps = self.pool.maps();
        let size = wgpu::Extent3d { depth_or_array_layers: 1, ..kept.texture.size() };
        encoder.copy_texture_to_texture(whole(&kept.texture, 0), whole(maps.texture(), view.layer), size);
        let mut recorded = depth_pass(encoder, self.casting.pass.name, target, wgpu::LoadOp::Load);
        self.draw(&mut recorded, view, Part::Moving, |p| &p.map, done);
        self.draw_own(&mut recorded, view, Part::Moving, own);
        drop(recorded);
        view.kept = Some(kept);
    }

    fn bind_view(&self, recorded: &mut wgpu::RenderPass<'_>) {
        let offset = self.number * GpuCasterView::STRIDE;
        recorded.set_bind_group(0, self.view_group, &[offset]);
    }

    /// The lists of a part, each with its instances.
    fn lists<'a>(
        &'a self,
        view: &'a View,
        part: Part,
    ) -> impl Iterator<Item = (&'a Draws, &'a wgpu::Buffer)> {
        let still = (part != Part::Moving).then_some((&view.still, &view.still_placed.buffer));
        let moving = (part != Part::Still).then_some((&view.moving_draws, self.moving_placed));
        still.into_iter().chain(moving)
    }

    fn draw(
        &self,
        recorded: &mut wgpu::RenderPass<'_>,
        view: &View,
        part: Part,
        pipelines: impl Fn(&Pipelines) -> &crate::CasterPipelines,
        done: &mut Recorded,
    ) {
        self.bind_view(recorded);
        for (draws, placed) in self.lists(view, part) {
            recorded.set_vertex_buffer(1, placed.slice(..));
            for draw in &draws.list {
                let Some(mesh) = self.meshes.at(draw.mesh.key) else { continue };
                let Some(of_kind) = self.casting.of(mesh.kind) else { continue };
                let pipelines = pipelines(of_kind);
                recorded.set_pipeline(match draw.how {
                    How::Open => &pipelines.open,
                    How::Closed => &pipelines.closed,
                    How::ClosedMirrored => &pipelines.closed_mirrored,
                    How::CutOut => &pipelines.cut_out,
                });
                if let (How::CutOut, Some(cut_out)) = (draw.how, &mesh.cut_out) {
                    recorded.set_bind_group(pipelines.cut_out_group, &cut_out.group, &[]);
                    recorded.set_vertex_buffer(2, cut_out.vertices.slice(cut_out.offset..));
                }
                mesh.draw(recorded, draw.instances.clone());
                count(done, draw, mesh.triangles());
            }
        }
    }

    fn draw_translucent(
        &self,
        recorded: &mut wgpu::RenderPass<'_>,
        view: &View,
        nearest: bool,
        done: &mut Recorded,
    ) {
        self.bind_view(recorded);
        for (draws, placed) in self.lists(view, Part::All) {
            recorded.set_vertex_buffer(1, placed.slice(..));
            for draw in &draws.translucent {
                let Some(mesh) = self.meshes.at(draw.mesh.key) else { continue };
                let of_kind = self.casting.of(mesh.kind).and_then(|of_kind| of_kind.translucent.as_ref());
                let (Some(pipelines), Some(translucent)) = (of_kind, &mesh.translucent) else { continue };
                recorded.set_pipeline(if nearest { &pipelines.nearest } else { &pipelines.color });
                recorded.set_bind_group(1, &translucent.group, &[]);
                recorded.set_vertex_buffer(2, translucent.vertices.slice(translucent.offset..));
                mesh.draw(recorded, draw.instances.clone());
                count(done, draw, mesh.triangles());
            }
        }
    }

    fn draw_own(&self, recorded: &mut wgpu::RenderPass<'_>, view: &View, part: Part, own: &mut Own<'_>) {
        for (draws, _) in self.lists(view, part) {
            if draws.own.is_empty() {
                continue;
            }
            self.bind_view(recorded);
            let asked = OwnDraw {
                light: self.light,
                view: &view.view,
                target: OwnTarget::new(&self.pool.kind.format, &self.casting.pass),
                casters: &draws.own,
            };
            own(&asked, recorded);
        }
    }
}

fn count(done: &mut Recorded, draw: &Draw, triangles: u64) {
    done.draws += 1;
    done.triangles += draw.instances.len() as u64 * triangles;
}

fn depth_pass<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    name: &str,
    view: &wgpu::TextureView,
    load: wgpu::LoadOp<f32>,
) -> wgpu::RenderPass<'a> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(name),
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view,
            depth_ops: Some(wgpu::Operations { load, store: wgpu::StoreOp::Store }),
            stencil_ops: None,
        }),
        ..Default::default()
    })
}
