//! Before a frame is recorded: what moved is found, lights are fitted, lists are made and handed over.

use super::casting::Casting;
use super::handles::{LightHandle, index};
use super::lights::{Lit, count_views};
use super::table::GpuLit;
use super::views::Drawn;
use super::wgsl::{Resources, group};
use super::{Frame, Shadows, ShadowsError, options};
use crate::caster::GpuCasterView;
use crate::volume::VolumeProblem;
use umbrage_core::fit::{Eye, Fallback, FitError};
use umbrage_core::layout::GpuView;
use umbrage_core::technique::{Bias, Settings};
use umbrage_core::volume::light_point_world;
use umbrage_core::{Aabb, LightKind};

/// What a frame's preparation did: counts, for those who want to see where time goes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Prepared {
    /// Lights that there are.
    pub lights: u64,
    /// Views of them.
    pub views: u64,
    /// Casters that moved, or were added, since the last frame.
    pub moved: u64,
    /// Lights that were fitted anew.
    pub fitted: u64,
    /// Views whose map has to be drawn, or drawn over, when this frame is recorded.
    pub stale_views: u64,
    /// Handed to the GPU, bytes.
    pub written_bytes: u64,
}

/// What did not go as one may expect.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ShadowsWarning {
    /// A map is laid more plainly than was asked for.
    #[error("a light's map is laid more plainly than its technique asks for: {why}")]
    Fallback {
        /// Which light.
        light: LightHandle,
        /// Why.
        why: Fallback,
    },
    /// Volumes that could not be made as asked for; its light is a [`Shadows::light_index`].
    #[error(transparent)]
    Volume(VolumeProblem),
    /// Meshes that are not closed, under a technique that needs solids.
    #[error(
        "{meshes} meshes with casters are not closed, and `{technique}` holds what lies behind a caster's front: an open caster shadows \
         itself, or throws no shadow where nothing is drawn behind it; add receivers with their meshes, say `closed` of solids, or use \
         `linear`"
    )]
    OpenMeshes {
        /// Which light.
        light: LightHandle,
        /// Its technique.
        technique: &'static str,
        /// How many.
        meshes: usize,
    },
    /// A light has no map.
    #[error("a light throws no shadow: {why}")]
    NoMap {
        /// Which light.
        light: LightHandle,
        /// Why.
        why: FitError,
    },
}

impl Shadows {
    /// Makes ready what the next [`Shadows::record`] draws and what shaders look up. Call it once a frame, after all changes, and after
    /// what was recorded for the last frame was submitted: it writes to buffers that the last frame reads.
    ///
    /// Maps that are fitted to the scene serve any number of eyes. Volumes, masks and maps that follow the eye are for one: several
    /// eyes in one submission need a `Shadows` each.
    ///
    /// Cost on the CPU: that of what moved, times the number of views; where nothing changed, a few comparisons. Fitting a light
    /// anew costs some nanoseconds for each caster; it happens when the light moves, or something leaves the room that its maps
    /// have. Lights whose maps follow the eye are fitted whenever that moves.
    ///
    /// # Errors
    /// [`ShadowsError::Number`] for a frame that is no picture, [`ShadowsError::TooMany`] views, [`ShadowsError::Shadow`] when maps
    /// cannot be made. Recording is then refused until a frame is prepared.
    pub fn prepare(&mut self, frame: &Frame) -> Result<Prepared, ShadowsError> {
        frame.check()?;
        self.is_prepared = false;
        let done = self.prepare_checked(frame);
        match done {
            Ok(_) => self.is_prepared = true,
            // Nothing is known of what was told in part.
            Err(_) => self.frame = None,
        }
        done
    }

    fn prepare_checked(&mut self, frame: &Frame) -> Result<Prepared, ShadowsError> {
        let eye_moved = self.frame.as_ref() != Some(frame);
        self.frame = Some(*frame);
        let moved = self.casters.begin(u64::from(self.options.still_frames));
        let mut done = Prepared {
            lights: self.lights.len() as u64,
            moved: self.casters.changes.moved,
            ..Prepared::default()
        };
        let is_due = |lit: &Lit| lit.fit_is_stale || lit.is_loose || eye_moved && lit.follows_eye();
        let changed = moved || self.lights_changed || self.lights.iter().any(|(_, lit)| is_due(lit));
        if changed || eye_moved {
            self.tell_screen(frame)?;
        }
        // Masks may have left casters to maps.
        let changed = changed || self.lights.iter().any(|(_, lit)| lit.fit_is_stale);
        if changed {
            self.fit_lights(frame, eye_moved, &mut done)?;
            self.list_views(&mut done);
        }
        if changed || eye_moved {
            self.write_lights(&mut done);
        }
        self.casters.changes.clear();
        done.views = count_views(&self.lights) as u64;
        done.stale_views = self.stale_views();
        Ok(done)
    }

    /// Says to volumes and masks what there is, and makes room for V on the screen.
    fn tell_screen(&mut self, frame: &Frame) -> Result<(), ShadowsError> {
        let is_asked = self.screen.is_some() || self.masks.is_some();
        if is_asked && self.casters.has_changed() {
            self.casters.boxes_world(&mut self.scratch.boxes);
            self.scene_world = self.scratch.boxes.iter().fold(Aabb::EMPTY, |all, one| all.union(one));
        }
        let gpu = (&self.device, &self.queue);
        if let Some(screen) = &mut self.screen {
            let mut count = 0;
            for (_, lit) in self.lights.iter_mut() {
                lit.screen = lit.is_on_screen().then_some(count);
                count += u32::from(lit.screen.is_some());
            }
            self.group_is_stale |= screen.make_room(&self.device, frame, count)?;
            screen.tell(gpu, frame, &self.lights, &self.meshes, &self.casters, &self.scene_world)?;
        }
        if let Some(masks) = &mut self.masks {
            let (layout, scene) = (&self.cut_out_layout, &self.scene_world);
            let format = self.screen.as_ref().map(|screen| screen.depth_format);
            let (lights, meshes, casters) = (&mut self.lights, &self.meshes, &self.casters);
            self.group_is_stale |= masks.tell(gpu, layout, frame, format, lights, meshes, casters, scene)?;
        }
        Ok(())
    }

    fn stale_views(&self) -> u64 {
        let stale = |lit: &Lit| lit.views.iter().filter(|view| !view.holds).count() as u64;
        self.lights.iter().map(|(_, lit)| stale(lit)).sum()
    }

    /// Fits the lights that have to be, makes room for their maps, and writes the table.
    fn fit_lights(
        &mut self,
        frame: &Frame,
        eye_moved: bool,
        done: &mut Prepared,
    ) -> Result<(), ShadowsError> {
        let Self { casters, lights, meshes, pools, declared, device, scratch, .. } = self;
        let changes = &casters.changes;
        let mut loose_turn = true;
        let mut has_boxes = false;
        for (_, lit) in lights.iter_mut() {
            let has_map_casters = casters.left_to_maps(meshes, lit.family()) || !lit.left_to_maps.is_empty();
            if has_map_casters != lit.has_map_casters {
                (lit.has_map_casters, lit.fit_is_stale) = (has_map_casters, true);
            }
            lit.is_loose |= changes.loose;
            let follows = lit.follows_eye() && (eye_moved || changes.moving || changes.all);
            let lacks_room = || changes.room.iter().any(|room| !lit.has_room_for(room));
            let mut is_due = lit.fit_is_stale || changes.all || follows || lacks_room();
            // One at a time: nothing is wrong with a map that has room to spare.
            if !is_due && lit.is_loose && std::mem::replace(&mut loose_turn, false) {
                is_due = true;
            }
            let pool = lit.lookup.map(|lookup| declared.lookups[lookup].pool);
            let Some(index) = pool.filter(|_| is_due) else {
                // Without maps there is nothing to fit.
                if pool.is_none() {
                    (lit.fit_is_stale, lit.is_loose) = (false, false);
                }
                continue;
            };
            if !std::mem::replace(&mut has_boxes, true) {
                casters.boxes_world(&mut scratch.boxes);
            }
            let eye = Eye { camera: frame.camera(), aspect: frame.aspect() };
            let boxes: &[Aabb] = &scratch.boxes;
            self.lights_changed |= lit.fit(device, &mut pools[index], boxes, eye)?;
            done.fitted += 1;
        }
        let views = count_views(&self.lights);
        if views > self.options.most_views as usize {
            self.lights.iter_mut().for_each(|(_, lit)| lit.fit_is_stale = true);
            return Err(ShadowsError::TooMany {
                what: "views",
                asked: views,
                most: self.options.most_views,
                option: "most_views",
                limit: options::LIMIT,
            });
        }
        for (index, pool) in self.pools.iter_mut().enumerate() {
            if !pool.make_room(&self.device)? {
                continue;
            }
            self.group_is_stale = true;
            for (_, lit) in self.lights.iter_mut() {
                if lit.lookup.map(|lookup| self.declared.lookups[lookup].pool) == Some(index) {
                    lit.views.iter_mut().for_each(|view| view.holds = false);
                }
            }
        }
        self.choose_castings()?;
        self.number_views(done);
        self.lights_changed = false;
        Ok(())
    }

    /// Writes what shaders know of lights, and makes the bind group anew where something in it is another.
    fn write_lights(&mut self, done: &mut Prepared) {
        let table = &mut self.scratch.table;
        table.clear();
        for (key, lit) in self.lights.iter() {
            table.resize(table.len().max(index(key) + 1), GpuLit::default());
            table[index(key)] = on_gpu(lit);
        }
        done.written_bytes += self.table.write_lights(&self.queue, table);
        self.warn();
        if std::mem::replace(&mut self.group_is_stale, false) {
            let resources = Resources {
                table: &self.table,
                pools: &self.pools,
                comparison: &self.comparison,
                point: &self.point,
                screen: self.screen.as_ref().map(|screen| screen.v.array()),
                masks: self.masks.as_ref().map(|masks| masks.blockers.bindings()),
            };
            self.group = group(&self.device, &self.layout, &self.declared, &resources);
        }
    }

    /// Which passes draw each light's maps, and the pipelines that they need.
    fn choose_castings(&mut self) -> Result<(), ShadowsError> {
        for (_, lit) in self.lights.iter_mut() {
            let (Some(settings), Some(lookup)) = (&lit.map_settings, lit.lookup) else { continue };
            if lit.casting.is_some() || lit.views.is_empty() {
                continue;
            }
            let pool = self.declared.lookups[lookup].pool;
            lit.casting = self.castings.iter().position(|casting| casting.draws(settings, pool));
            if lit.casting.is_none() {
                let kind = &self.pools[pool].kind;
                if let Some(casting) = Casting::new(&self.device, settings, pool, kind)? {
                    self.castings.push(casting);
                    lit.casting = Some(self.castings.len() - 1);
                }
            }
        }
        for casting in &mut self.castings {
            let pool = &self.pools[casting.pool].kind;
            for (_, mesh) in self.meshes.iter() {
                casting.provide(&self.device, mesh.kind, pool, &self.cut_out_layout);
            }
        }
        Ok(())
    }

    /// Gives views their numbers and writes those that changed, and the lights.
    fn number_views(&mut self, done: &mut Prepared) {
        let mut number = 0;
        for (_, lit) in self.lights.iter_mut() {
            let first_view = number;
            let renumbered = std::mem::replace(&mut lit.first_view, first_view) != first_view;
            let pass = lit.casting.map(|casting| &self.castings[casting].pass);
            let storage = lit.lookup.map(|l| self.pools[self.declared.lookups[l].pool].kind.format.storage);
            for view in &mut lit.views {
                if renumbered || view.matrix_is_stale {
                    if let (Some(pass), Some(settings), Some(storage)) = (pass, &lit.map_settings, storage) {
                        let on_gpu = GpuView::new(&view.view, view.layer, settings, storage);
                        done.written_bytes += self.table.write_view(&self.queue, number, &on_gpu);
                        let matrix = GpuCasterView::new(&view.view, pass, 0.0);
                        let at = u64::from(number) * u64::from(GpuCasterView::STRIDE);
                        self.queue.write_buffer(&self.matrices, at, bytemuck::bytes_of(&matrix));
                        done.written_bytes += size_of::<GpuCasterView>() as u64;
                    }
                    view.matrix_is_stale = false;
                }
                number += 1;
            }
        }
    }

    /// Lists what each view draws that does not hold what it should.
    fn list_views(&mut self, done: &mut Prepared) {
        let Self { casters, lights, meshes, castings, pools, scratch, device, queue, moving_placed, .. } =
            self;
        scratch.moving_placed.clear();
        let is_all = casters.changes.all;
        for (_, lit) in lights.iter_mut() {
            let Some(casting) = lit.casting.map(|casting| &castings[casting]) else { continue };
            let drawn = Drawn {
                meshes,
                cull: casting.pass.cull,
                colored: pools[casting.pool].kind.colored,
                family: lit.settings.method.family(),
                left: &lit.left_to_maps,
            };
            for view in &mut lit.views {
                if is_all || casters.changes.still.iter().any(|gone| view.may_see(gone)) {
                    view.redraw();
                }
                if !casters.changes.settled.is_empty() {
                    view.let_stand(&casters.changes.settled, casters);
                }
                view.look_for_moving(casters, &drawn, &mut scratch.seen);
                if view.holds {
                    continue;
                }
                let queues = (&*device, &*queue);
                done.written_bytes += view.list_still(queues, casters, &drawn, &mut scratch.placed);
                view.list_moving(casters, &drawn, &mut scratch.moving_placed);
            }
        }
        let bytes: &[u8] = bytemuck::cast_slice(&scratch.moving_placed);
        moving_placed.write(device, queue, bytes);
        done.written_bytes += bytes.len() as u64;
    }

    fn warn(&mut self) {
        self.warnings.clear();
        let open = self.meshes.iter().filter(|(_, mesh)| mesh.casters > 0 && !mesh.closed).count();
        for (key, lit) in self.lights.iter() {
            let light = LightHandle(self.lights.id(key));
            self.warnings.extend(lit.fallback.map(|why| ShadowsWarning::Fallback { light, why }));
            self.warnings.extend(lit.failure.clone().map(|why| ShadowsWarning::NoMap { light, why }));
            let technique = lit.settings.technique.id;
            let needs_solids = open > 0 && !lit.views.is_empty() && needs_solids(&lit.settings);
            let told = needs_solids.then_some(ShadowsWarning::OpenMeshes { light, technique, meshes: open });
            self.warnings.extend(told);
        }
        let volumes = self.screen.as_ref().and_then(|screen| screen.volumes.as_ref());
        let problems = volumes.map_or(&[][..], |volumes| volumes.problems());
        self.warnings.extend(problems.iter().copied().map(ShadowsWarning::Volume));
    }
}

/// Does a map hold what lies behind the front of its casters?
fn needs_solids(settings: &Settings) -> bool {
    settings.combination().is_some_and(|c| matches!(c.bias, Bias::Midpoint | Bias::SecondDepth))
}

/// A light as the shader knows it.
fn on_gpu(lit: &Lit) -> GpuLit {
    let has_map = !lit.views.is_empty();
    let is = |yes: bool| u32::from(yes);
    GpuLit {
        point: light_point_world(&lit.light),
        lookup: lit.lookup.filter(|_| has_map).map_or(0, |lookup| lookup as u32 + 1),
        first_view: lit.first_view,
        places: lit.places,
        tiles: if lit.light.kind == LightKind::Point { 6 } else { 1 },
        masks: lit.masks,
        screen: lit.screen.map_or(0, |layer| layer + 1),
        lit_outside: is(lit.light.kind == LightKind::Directional || lit.places > 1),
        pad: 0,
    }
}
