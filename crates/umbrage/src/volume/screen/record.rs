//! The passes of volumes on the screen, in their order.

use super::{ScreenVolumes, ToldVolumes};
use crate::soften::{SoftenedV, Softener, Softness, record_soften, soften};
use crate::volume::{
    Faces, count_volumes, find_silhouettes, record_counts, record_silhouettes, record_visibility,
    write_visibility,
};
use glam::Mat4;
use std::fmt;
use umbrage_core::technique::volume::Soften;

/// A pass of a light. Displays as its name in the plan, then the light's slot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VolumePass {
    /// Finds faces, in a compute pass.
    Silhouettes {
        /// Slot.
        light: usize,
    },
    /// Counts faces.
    Counts {
        /// Slot.
        light: usize,
        /// Which.
        faces: Faces,
    },
    /// Writes V.
    Visibility {
        /// Slot.
        light: usize,
    },
    /// Blurs V.
    Blur {
        /// Slot.
        light: usize,
        /// Along columns, or along rows?
        columns: bool,
    },
}

impl fmt::Display for VolumePass {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Silhouettes { light } => write!(f, "silhouettes {light}"),
            Self::Counts { light, faces } => write!(f, "{} {light}", faces.pass_name()),
            Self::Visibility { light } => write!(f, "mask {light}"),
            Self::Blur { light, columns: false } => write!(f, "blur-rows {light}"),
            Self::Blur { light, columns: true } => write!(f, "blur-columns {light}"),
        }
    }
}

/// What a pass asks of the GPU, counted on the CPU.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct VolumeWork {
    /// Casters that are drawn, or whose faces are found; 1 where the screen is covered.
    pub draws: u64,
    /// Triangles, as far as they are known here: not those that a compute pass finds.
    pub triangles: u64,
}

const SCREEN: VolumeWork = VolumeWork { draws: 1, triangles: 1 };

/// Somebody who measures passes. All methods may stay as they are: `()` watches nothing.
pub trait PassWatch {
    /// Time stamps of the next pass, if that is a compute pass.
    fn compute_stamps(&self) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        None
    }

    /// Time stamps of the next pass, if it draws.
    fn render_stamps(&self) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        None
    }

    /// Calls `find` once, which records the next pass: queries can be put around it.
    fn compute(
        &self,
        recorded: &mut wgpu::ComputePass<'_>,
        find: &mut dyn FnMut(&mut wgpu::ComputePass<'_>),
    ) {
        find(recorded);
    }

    /// Calls `draw` once, which records the next pass: queries can be put around it.
    fn render(&self, recorded: &mut wgpu::RenderPass<'_>, draw: &mut dyn FnMut(&mut wgpu::RenderPass<'_>)) {
        draw(recorded);
    }

    /// A pass was recorded.
    fn done(&mut self, pass: VolumePass, work: VolumeWork) {
        let _ = (pass, work);
    }
}

impl PassWatch for () {}

/// A light's V as it is blurred, and what that was made for.
#[derive(Debug)]
pub(super) struct Soft {
    v: wgpu::TextureView,
    depth: wgpu::TextureView,
    size_px: [u32; 2],
    softened: SoftenedV,
    written: Option<(Softness, Mat4)>,
}

impl ToldVolumes<'_> {
    /// What drawing them once asks of the GPU.
    pub fn work(&self) -> VolumeWork {
        let of = |number: usize| {
            let caster = self.light.casters().get(number)?;
            self.meshes.get(caster.mesh)?.as_ref()?.split_triangles(caster.both_sides)
        };
        let triangles = self.draw.iter().map(|(number, _)| of(*number).unwrap_or(0)).sum();
        VolumeWork { draws: self.draw.len() as u64, triangles }
    }

    fn finds(&self) -> bool {
        self.light.stale_casters() > 0
    }
}

impl ScreenVolumes {
    /// The slots that were told of, in order.
    pub fn lights(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.slots.len()).filter(|slot| self.slots[*slot].told == self.telling)
    }

    /// The passes that [`Self::record`] would record now, in their order, where it gets depth to read and V for each light.
    pub fn passes(&self) -> impl Iterator<Item = VolumePass> + '_ {
        self.lights().filter_map(|light| Some((light, self.told(light)?))).flat_map(|(light, told)| {
            let choices = told.settings.choices;
            let finds = told.finds().then_some(VolumePass::Silhouettes { light });
            let counts = Faces::passes(choices.stencil)
                .iter()
                .map(move |faces| VolumePass::Counts { light, faces: *faces });
            let blurs = (choices.soften == Soften::Blur)
                .then(|| [false, true].map(|columns| VolumePass::Blur { light, columns }));
            let visibility = [VolumePass::Visibility { light }];
            finds.into_iter().chain(counts).chain(visibility).chain(blurs.into_iter().flatten())
        })
    }

    /// Records all lights: what faces have to be found, the stencil's counts, V, and its blur. `depth_stencil` holds the depth of the
    /// lit surfaces, which stays; its stencil is overwritten. `depth_only` is its depth to be read (the texture needs
    /// `TEXTURE_BINDING`): without, nothing is blurred. `v` gives the target of each light, all of it written; a light without is
    /// left out. `watch` may be `&mut ()`.
    ///
    /// Cost: three passes a light at most beside its blur's two, and the pixels of its volumes.
    pub fn record<'v>(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        depth_stencil: &wgpu::TextureView,
        depth_only: Option<&wgpu::TextureView>,
        v: impl Fn(usize) -> Option<&'v wgpu::TextureView>,
        watch: &mut dyn PassWatch,
    ) {
        for slot in 0..self.slots.len() {
            let Some(v) = v(slot).filter(|_| self.slots[slot].told == self.telling) else { continue };
            self.record_faces(encoder, slot, watch);
            self.record_light(encoder, slot, (depth_stencil, v), watch);
            if let Some(depth_only) = depth_only {
                self.record_blur(encoder, slot, (depth_only, v), watch);
            }
        }
    }

    fn record_faces(&mut self, encoder: &mut wgpu::CommandEncoder, light: usize, watch: &mut dyn PassWatch) {
        let Some(told) = self.told(light).filter(ToldVolumes::finds) else { return };
        let found = told.light.stale_casters() as u64;
        record_silhouettes(encoder, watch.compute_stamps(), |recorded| {
            watch.compute(recorded, &mut |recorded| {
                find_silhouettes(recorded, told.pipelines, told.light, told.meshes);
            });
        });
        watch.done(VolumePass::Silhouettes { light }, VolumeWork { draws: found, triangles: 0 });
        self.slots[light].volumes.found();
        self.casters_found += found;
    }

    fn record_light(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        light: usize,
        (depth_stencil, v): (&wgpu::TextureView, &wgpu::TextureView),
        watch: &mut dyn PassWatch,
    ) {
        let (Some(told), Some(sight)) = (self.told(light), &self.sight) else { return };
        let [width, height] = sight.eye.size_px.to_array();
        let scissor = told.scissor.unwrap_or([0, 0, width, height]);
        for (turn, faces) in Faces::passes(told.settings.choices.stencil).iter().enumerate() {
            record_counts(encoder, depth_stencil, turn == 0, scissor, watch.render_stamps(), |recorded| {
                watch.render(recorded, &mut |recorded| {
                    count_volumes(recorded, told.pipelines, told.light, told.meshes, *faces, told.draw);
                });
            });
            watch.done(VolumePass::Counts { light, faces: *faces }, told.work());
        }
        record_visibility(encoder, depth_stencil, v, watch.render_stamps(), |recorded| {
            watch.render(recorded, &mut |recorded| write_visibility(recorded, told.pipelines));
        });
        watch.done(VolumePass::Visibility { light }, SCREEN);
    }

    fn record_blur(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        light: usize,
        (depth, v): (&wgpu::TextureView, &wgpu::TextureView),
        watch: &mut dyn PassWatch,
    ) {
        let (Some(settings), Some(sight)) = (self.slots[light].settings, &self.sight) else { return };
        if settings.choices.soften != Soften::Blur {
            return;
        }
        let size_px = sight.eye.size_px.to_array();
        let formats = self.meshes.formats;
        let softener = self
            .softener
            .get_or_insert_with(|| Softener::new(&self.device, formats.v, size_px, formats.convention));
        softener.resize(&self.device, size_px);
        let kept = self.slots[light].soft.take();
        let kept = kept.filter(|soft| (&soft.v, &soft.depth, soft.size_px) == (v, depth, size_px));
        let soft = self.slots[light].soft.insert(kept.unwrap_or_else(|| Soft {
            v: v.clone(),
            depth: depth.clone(),
            size_px,
            softened: softener.of(&self.device, v, depth),
            written: None,
        }));
        let now = Some((settings.softness, sight.eye.clip_from_view));
        if soft.written != now {
            softener.write(&self.queue, &soft.softened, &settings.softness, &sight.eye.clip_from_view);
            soft.written = now;
        }
        for columns in [false, true] {
            record_soften(encoder, softener, v, columns, watch.render_stamps(), |recorded| {
                watch.render(recorded, &mut |recorded| soften(recorded, softener, &soft.softened, columns));
            });
            watch.done(VolumePass::Blur { light, columns }, SCREEN);
        }
    }
}
