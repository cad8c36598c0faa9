//! The masks of all lights: what each should hold, what it holds, and the passes that draw the difference.

use super::error::MasksError;
use super::light::{Blocker, Changed, LightMasks, MaskPart, MaskWarning, Receiver, Telling, fit_to_boxes};
use super::maps::{MaskMaps, mask_sampler};
use super::pipelines::{MaskPipelines, record_mask_pass};
use super::upload::Upload;
use crate::caster::{CasterVertices, GpuCasterView};
use glam::UVec2;
use std::ops::Range;
use umbrage_core::fit::{MaskError, MaskOptions, MaskView};
use umbrage_core::masks::{MOST_MASKS, Picture, Rect, most_of_light, size_texel};
use umbrage_core::technique::mask::{Lookup, Mask};
use umbrage_core::technique::{Method, Settings};
use umbrage_core::{Aabb, Light};

/// One mask, to be drawn or looked at.
#[derive(Clone, Copy, Debug)]
pub struct BlockerMask<'a> {
    /// Its number among all, which is its layer.
    pub number: usize,
    /// Its light's number.
    pub light: usize,
    /// The light.
    pub of: &'a Light,
    /// The blocker's object.
    pub object: u32,
    /// The blocker's meshes.
    pub parts: &'a [MaskPart],
    /// The instance of the first part in the buffer of instances; the other parts follow.
    pub first_instance: u32,
    /// Its view.
    pub view: &'a MaskView,
    /// The pixels that it may darken; `None` where it darkens none.
    pub on_screen: Option<Rect>,
}

/// Where a mask stands among its light's blockers.
#[derive(Clone, Copy, Debug)]
struct Numbered {
    light: usize,
    blocker: usize,
    first_instance: u32,
}

/// What a mask was drawn with.
#[derive(Debug, Default)]
struct Held {
    view: Option<GpuCasterView>,
    parts: Vec<MaskPart>,
}

/// The masks of any number of lights: a layer for each light and blocker, drawn again when what it shows differs.
///
/// In every frame [`Self::begin`], [`Self::tell`] for each light that shines, [`Self::finish`], [`Self::record`]. When nothing
/// changed since the last, none of them puts anything on the heap, writes or records; when only the eye moved, the pixels that
/// masks may darken are found and written anew, and nothing else.
#[derive(Debug)]
pub struct BlockerMasks {
    choices: Mask,
    size_texel: u32,
    most: usize,
    maps: MaskMaps,
    sampler: wgpu::Sampler,
    pipelines: MaskPipelines,
    upload: Upload,
    lights: Vec<LightMasks>,
    order: Vec<Numbered>,
    of_light: Vec<Range<usize>>,
    held: Vec<Held>,
    picture: Option<Picture>,
    receivers: Vec<Receiver>,
    time_s: f32,
    is_moved: bool,
    is_later: bool,
    changed: Changed,
    changes: u64,
    version: u64,
}

/// The mask of a number.
fn numbered<'a>(order: &[Numbered], lights: &'a [LightMasks], number: usize) -> Option<BlockerMask<'a>> {
    let Numbered { light, blocker, first_instance } = *order.get(number)?;
    let of_light = lights.get(light)?;
    let (mask, view) = of_light.mask(blocker)?;
    Some(BlockerMask {
        number,
        light,
        of: of_light.light()?,
        object: mask.object,
        parts: &mask.parts,
        first_instance,
        view,
        on_screen: mask.on_screen,
    })
}

/// All masks by their numbers.
fn in_order<'a>(order: &'a [Numbered], lights: &'a [LightMasks]) -> impl Iterator<Item = BlockerMask<'a>> {
    (0..order.len()).filter_map(|number| numbered(order, lights, number))
}

impl BlockerMasks {
    /// For `lights` lights with masks as `settings` say, and room for so many masks at first, one at least; there is made more
    /// when more are wanted, up to [`most_of_light`] a light. `cut_out_layout` is
    /// [`crate::CasterPipelines::cut_out_layout`].
    ///
    /// Memory: a byte a texel, and 45 KiB for the list.
    ///
    /// # Errors
    /// [`MasksError`] for techniques without masks, too many lights, or masks larger than the device's textures.
    pub fn new(
        device: &wgpu::Device,
        settings: &Settings,
        lights: usize,
        masks: usize,
        cut_out_layout: &wgpu::BindGroupLayout,
        vertices: &CasterVertices<'_>,
    ) -> Result<Self, MasksError> {
        let none = || MasksError::NoMasks { technique: settings.technique.id };
        let Method::Mask(choices) = settings.method else { return Err(none()) };
        let size_texel = size_texel(settings).ok_or_else(none)?;
        if lights > MOST_MASKS {
            return Err(MasksError::TooManyLights { lights });
        }
        let most = most_of_light(lights, size_texel);
        let maps = MaskMaps::new(device, size_texel, masks.clamp(1, most * lights.max(1)) as u32)?;
        let pipelines = MaskPipelines::new(device, cut_out_layout, vertices);
        Ok(Self {
            sampler: mask_sampler(device, choices.lookup == Lookup::Linear),
            choices,
            size_texel,
            most,
            upload: Upload::new(device, &pipelines.view_layout, maps.count()),
            maps,
            pipelines,
            lights: std::iter::repeat_with(LightMasks::default).take(lights).collect(),
            order: Vec::new(),
            of_light: vec![0..0; lights],
            held: Vec::new(),
            picture: None,
            receivers: Vec::new(),
            time_s: 0.0,
            is_moved: false,
            is_later: false,
            changed: Changed::default(),
            changes: 0,
            version: 0,
        })
    }

    /// Begins a frame: what shows the masks' shadows, what deforming vertices know of time (seconds; 0 where nothing deforms, or
    /// masks are drawn in every frame), and what shadows may fall on.
    pub fn begin(&mut self, picture: &Picture, time_s: f32, receivers: impl IntoIterator<Item = Receiver>) {
        self.is_moved = self.picture != Some(*picture);
        self.picture = Some(*picture);
        self.is_later = self.time_s != time_s;
        self.time_s = time_s;
        let mut count = 0;
        for receiver in receivers {
            match self.receivers.get_mut(count) {
                Some(known) if *known == receiver => {}
                Some(known) => (*known, self.is_moved) = (receiver, true),
                None => {
                    self.receivers.push(receiver);
                    self.is_moved = true;
                }
            }
            count += 1;
        }
        self.is_moved |= count != self.receivers.len();
        self.receivers.truncate(count);
        self.changed = Changed::default();
        for light in &mut self.lights {
            (light.was_told, light.is_told) = (light.is_told, false);
        }
    }

    /// Tells a light's blockers. Each is fitted to the corners of its parts' boxes; what was fitted to the same blocker and the
    /// same light is kept. A light that is not told between [`Self::begin`] and [`Self::finish`] has no masks.
    ///
    /// `light` is its number, from 0; `scene_world` the box around all.
    ///
    /// # Errors
    /// [`MasksError`] for a number that there is no room for, or settings that masks of one texture cannot all have.
    pub fn tell<'a>(
        &mut self,
        light: usize,
        of: &Light,
        settings: &Settings,
        scene_world: &Aabb,
        blockers: impl IntoIterator<Item = Blocker<'a>>,
    ) -> Result<&[MaskWarning], MasksError> {
        self.tell_fitted(light, of, settings, scene_world, blockers, fit_to_boxes)
    }

    /// The same, with a fit of one's own: it is asked for each blocker that is not as it was.
    ///
    /// # Errors
    /// As [`Self::tell`].
    pub fn tell_fitted<'a>(
        &mut self,
        light: usize,
        of: &Light,
        settings: &Settings,
        scene_world: &Aabb,
        blockers: impl IntoIterator<Item = Blocker<'a>>,
        fit: impl FnMut(&Light, &Blocker<'a>, &MaskOptions) -> Result<MaskView, MaskError>,
    ) -> Result<&[MaskWarning], MasksError> {
        let none = || MasksError::NoMasks { technique: settings.technique.id };
        let Method::Mask(choices) = settings.method else { return Err(none()) };
        let asked = size_texel(settings).ok_or_else(none)?;
        if asked != self.size_texel {
            return Err(MasksError::OtherSize { light, asked, size_texel: self.size_texel });
        }
        if choices.lookup != self.choices.lookup {
            return Err(MasksError::OtherLookup { light, asked: choices.lookup.row().id });
        }
        let lights = self.lights.len();
        let nobody =
            Picture { clip_from_world: glam::Mat4::ZERO, depth: umbrage_core::DEPTH, size: UVec2::ZERO };
        let told = self.lights.get_mut(light).ok_or(MasksError::NoLight { light, lights })?;
        let telling = Telling {
            number: light,
            light: of,
            options: &MaskOptions::of(&choices, asked, scene_world),
            most: self.most,
            picture: self.picture.as_ref().unwrap_or(&nobody),
            receivers: &self.receivers,
            is_moved: self.is_moved,
        };
        let changed = told.tell(&telling, blockers, fit);
        self.changed.masks |= changed.masks;
        self.changed.pixels |= changed.pixels;
        Ok(&told.warnings)
    }

    /// Ends what began: numbers the masks, and hands the GPU what is not as it was, with the next submission.
    ///
    /// # Errors
    /// [`crate::ShadowError::TooLarge`] where more masks are wanted than the device's textures have layers.
    pub fn finish(&mut self, device: &wgpu::Device, queue: &wgpu::Queue) -> Result<(), MasksError> {
        self.changed.masks |= self.lights.iter().any(|light| light.is_told != light.was_told);
        if self.changed.masks {
            self.number();
        }
        if self.order.len() > self.maps.count() as usize {
            let most = (self.most * self.lights.len().max(1)).min(MOST_MASKS);
            let count = self.order.len().next_power_of_two().min(most).max(self.order.len());
            self.maps = MaskMaps::new(device, self.size_texel, count as u32)?;
            self.upload.grow(device, &self.pipelines.view_layout, self.maps.count());
            self.held.iter_mut().for_each(|held| held.view = None);
            self.changes += 1;
            self.changed.masks = true;
        }
        if self.changed.masks || self.is_later {
            let masks = in_order(&self.order, &self.lights);
            self.upload.write_masks(device, queue, masks, self.time_s);
            self.version += 1;
        }
        if self.changed.masks || self.changed.pixels {
            self.upload.write_pixels(queue, in_order(&self.order, &self.lights));
        }
        Ok(())
    }

    /// Numbers all masks, light by light.
    fn number(&mut self) {
        self.order.clear();
        let mut first_instance = 0;
        for (number, (light, range)) in self.lights.iter().zip(&mut self.of_light).enumerate() {
            let first = self.order.len();
            for (blocker, mask) in light.masks().take(MOST_MASKS - first) {
                self.order.push(Numbered { light: number, blocker, first_instance });
                first_instance += mask.parts.len() as u32;
            }
            *range = first..self.order.len();
        }
        let most = self.order.len().max(self.held.len());
        self.held.resize_with(most, Held::default);
    }

    /// All masks by their numbers, as [`Self::finish`] left them.
    pub fn iter(&self) -> impl Iterator<Item = BlockerMask<'_>> {
        in_order(&self.order, &self.lights)
    }

    /// The mask of a number; `None` past the last.
    pub fn get(&self, number: usize) -> Option<BlockerMask<'_>> {
        numbered(&self.order, &self.lights, number)
    }

    /// How many masks there are.
    pub fn count(&self) -> usize {
        self.order.len()
    }

    /// The numbers of a light's masks; nothing for lights that were not told.
    pub fn of_light(&self, light: usize) -> Range<usize> {
        self.of_light.get(light).cloned().unwrap_or_default()
    }

    /// What did not go well with a light when it was told last.
    pub fn warnings(&self, light: usize) -> &[MaskWarning] {
        self.lights.get(light).map(|light| light.warnings.as_slice()).unwrap_or_default()
    }

    /// The masks whose shadow may be seen and that do not hold what they should; with `all`, every one that may be seen.
    pub fn stale(&self, all: bool) -> impl Iterator<Item = usize> {
        let is_drawn = move |mask: &BlockerMask<'_>| mask.on_screen.is_some() && (all || self.is_stale(mask));
        self.iter().filter(is_drawn).map(|mask| mask.number)
    }

    fn is_stale(&self, mask: &BlockerMask<'_>) -> bool {
        let (Some(held), Some(view)) = (self.held.get(mask.number), self.upload.views.get(mask.number))
        else {
            return true;
        };
        let same_parts = held.parts.len() == mask.parts.len()
            && held.parts.iter().zip(mask.parts).all(|(held, part)| held.draws_as(part));
        held.view.as_ref() != Some(view) || !same_parts
    }

    /// Records a pass for each of [`Self::stale`], in their order; how many there were. `stamps(n)` are the time stamps of the n-th,
    /// `draw(pass, n, mask)` draws its parts: the view is bound as group 0 and instances as vertex buffer 1, so a part needs a
    /// pipeline of [`Self::pipelines`], its positions as vertex buffer 0, and a draw of the instance
    /// `mask.first_instance` plus its place among `mask.parts`.
    pub fn record<'q>(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        all: bool,
        mut stamps: impl FnMut(usize) -> Option<wgpu::RenderPassTimestampWrites<'q>>,
        mut draw: impl FnMut(&mut wgpu::RenderPass<'_>, usize, &BlockerMask<'_>),
    ) -> usize {
        let mut done = 0;
        for number in 0..self.order.len() {
            let Some(mask) = self.get(number) else { continue };
            if mask.on_screen.is_none() || !(all || self.is_stale(&mask)) {
                continue;
            }
            record_mask_pass(encoder, &self.maps, number as u32, stamps(done), |recorded| {
                recorded.set_bind_group(0, &self.upload.view_group, &[number as u32 * GpuCasterView::STRIDE]);
                recorded.set_vertex_buffer(1, self.upload.instances.slice(..));
                draw(recorded, done, &mask);
            });
            done += 1;
            let Numbered { light, blocker, .. } = self.order[number];
            let drawn = self.lights.get(light).and_then(|light| light.mask(blocker));
            if let (Some((drawn, _)), Some(held)) = (drawn, self.held.get_mut(number)) {
                held.view = self.upload.views.get(number).copied();
                held.parts.clear();
                held.parts.extend_from_slice(&drawn.parts);
            }
        }
        done
    }

    /// What shaders look masks up with, in the order of [`super::masks_wgsl`]: the list of all, the masks, their sampler. Others
    /// after [`Self::changes`] has grown.
    pub fn bindings(&self) -> (&wgpu::Buffer, &wgpu::TextureView, &wgpu::Sampler) {
        (&self.upload.list, self.maps.array(), &self.sampler)
    }

    /// How often the texture was made anew for want of room: bind groups of before show masks that are drawn no more.
    pub fn changes(&self) -> u64 {
        self.changes
    }

    /// Counts how often any mask was fitted, numbered or timed anew.
    pub(super) fn version(&self) -> u64 {
        self.version
    }

    /// The masks themselves.
    pub fn maps(&self) -> &MaskMaps {
        &self.maps
    }

    /// What draws blockers.
    pub fn pipelines(&self) -> &MaskPipelines {
        &self.pipelines
    }

    /// What the technique chose.
    pub fn choices(&self) -> &Mask {
        &self.choices
    }

    /// The picture that shows the shadows, once [`Self::begin`] said so.
    pub fn picture(&self) -> Option<&Picture> {
        self.picture.as_ref()
    }

    /// How many lights there is room for.
    pub fn lights(&self) -> usize {
        self.lights.len()
    }

    /// Memory of a light's masks, bytes.
    pub fn memory_of_light(&self, light: usize) -> u64 {
        self.of_light(light).len() as u64 * self.maps.layer_bytes()
    }

    /// Memory of masks, list and instances, bytes.
    pub fn memory_bytes(&self) -> u64 {
        self.maps.memory_bytes() + self.upload.memory_bytes()
    }
}
