//! Faces of shadow volumes per pixel as the view `volumes` holds them, and what they come to.
//!
//! The view draws what lies under the faces, and adds the faces to it: see `wgsl/screen.wgsl` and `wgsl/overdraw.wgsl`. The
//! target is of 16-bit floats, which every device can add to. They count to 2048 exactly and stay there.

mod passes;
mod picture;

pub(crate) use passes::OverdrawPipelines;

use crate::heat::OCTAVES;
use crate::{RenderError, RenderOptions, Renderer, View, readback};
use half::f16;
use umbrage::core::technique::{Method, volume::Volume};

/// Where a stencil of eight bits is at 0 again.
const WRAPS_AT: i32 = 256;
/// The number of faces from which on they are not told apart.
const MOST_FACES: u32 = 2048;

/// What a pixel shows under the faces of a light's volumes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Under {
    /// Nothing.
    Nothing,
    /// A surface that faces the light and lies in its cone and range: lit or in shadow by what is counted.
    Receiver,
    /// Another surface: dark whatever is counted.
    Other,
}

/// Faces of a light's volumes in one pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Overdraw {
    /// How many are rasterised, before the surface and behind it: what counting costs. 0..=2048, where 2048 is that or more.
    pub faces: u32,
    /// What the stencil would hold if it had no end: how many volumes the surface is in. Below 0 where depth-pass counts from
    /// within a shadow. Exact where there are less than 2048 faces.
    pub count: i32,
    /// What is there.
    pub under: Under,
}

impl Overdraw {
    /// Does it show a receiver that the stencil calls lit?
    pub fn is_lit(&self) -> bool {
        self.under == Under::Receiver && self.count % WRAPS_AT == 0
    }

    /// Does it show a receiver that the stencil calls dark?
    pub fn is_in_shadow(&self) -> bool {
        self.under == Under::Receiver && !self.is_lit()
    }

    /// Is it lit because a stencil of eight bits wraps, and should it be dark?
    pub fn is_wrongly_lit(&self) -> bool {
        self.is_lit() && self.count != 0
    }
}

/// The same with the grey of what is there, 0..1.
#[derive(Clone, Copy, Debug)]
struct OverdrawPixel {
    overdraw: Overdraw,
    grey: f32,
}

/// Faces of volumes over a part of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OverdrawPart {
    /// Its pixels.
    pub pixels: usize,
    /// Faces in a pixel, the mean of them.
    pub mean: f64,
    /// The most in one pixel.
    pub most: u32,
}

/// How many pixels have so many faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FacesShare {
    /// Faces in a pixel, from here on.
    pub from: u32,
    /// Up to here, not with it; `None` of the last.
    pub to: Option<u32>,
    /// Share of the picture, 0..1.
    pub share: f64,
}

/// Faces of a light's volumes over a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct OverdrawStatistics {
    /// All that are rasterised.
    pub fragments: u64,
    /// All pixels.
    pub picture: OverdrawPart,
    /// Those that show a lit receiver; `None` where there is none.
    pub lit: Option<OverdrawPart>,
    /// Those that show a receiver in shadow; `None` where there is none.
    pub shadow: Option<OverdrawPart>,
    /// Of all pixels that show a surface, the count that is farthest from 0. A stencil holds up to 255.
    pub deepest_count: i32,
    /// Pixels that are lit because the stencil wraps.
    pub wrongly_lit_pixels: usize,
    /// Pixels with 2048 faces or more, which are told as 2048.
    pub unsure_pixels: usize,
    /// Shares of the picture by powers of two, together 1: none, 1, 2 and 3, and so on to 256 and more.
    pub histogram: Vec<FacesShare>,
}

fn part(pixels: &[OverdrawPixel], is_in: impl Fn(&Overdraw) -> bool) -> Option<OverdrawPart> {
    let faces: Vec<u32> =
        pixels.iter().filter(|pixel| is_in(&pixel.overdraw)).map(|pixel| pixel.overdraw.faces).collect();
    let most = *faces.iter().max()?;
    let sum: u64 = faces.iter().map(|faces| u64::from(*faces)).sum();
    Some(OverdrawPart { pixels: faces.len(), mean: sum as f64 / faces.len() as f64, most })
}

impl OverdrawStatistics {
    /// Of a picture, which has a pixel at least.
    fn of(pixels: &[OverdrawPixel]) -> Self {
        let all = || pixels.iter().map(|pixel| &pixel.overdraw);
        let mut counts = [0usize; OCTAVES as usize + 2];
        all().for_each(|o| {
            counts[(u32::BITS - o.faces.leading_zeros()).min(OCTAVES as u32 + 1) as usize] += 1
        });
        let share = |(cell, in_it): (u32, usize)| FacesShare {
            from: (1 << cell) >> 1,
            to: (cell <= OCTAVES as u32).then_some(1 << cell),
            share: in_it as f64 / pixels.len().max(1) as f64,
        };
        let surfaces = all().filter(|o| o.under != Under::Nothing);
        Self {
            fragments: all().map(|o| u64::from(o.faces)).sum(),
            picture: part(pixels, |_| true).unwrap_or(OverdrawPart { pixels: 0, mean: 0.0, most: 0 }),
            lit: part(pixels, Overdraw::is_lit),
            shadow: part(pixels, Overdraw::is_in_shadow),
            deepest_count: surfaces.map(|o| o.count).max_by_key(|count| count.abs()).unwrap_or(0),
            wrongly_lit_pixels: all().filter(|o| o.is_wrongly_lit()).count(),
            unsure_pixels: all().filter(|o| o.faces >= MOST_FACES).count(),
            histogram: (0..).zip(counts).map(share).collect(),
        }
    }

    /// What of it a user may not expect, of a light's volumes.
    pub fn warnings(&self, light: usize) -> Vec<String> {
        let mut warnings = Vec::new();
        if self.wrongly_lit_pixels > 0 {
            let (wrong, deepest) = (self.wrongly_lit_pixels, self.deepest_count);
            warnings.push(format!(
                "light {light}: {wrong} pixels are lit and should be dark, because so many volumes lie around them that the                  stencil is at 0 again (it wraps at {WRAPS_AT}, and the deepest count is {deepest}); let fewer casters stand                  behind each other, or use the technique `linear`"
            ));
        }
        if self.unsure_pixels > 0 {
            warnings.push(format!(
                "light {light}: {} pixels have {MOST_FACES} faces of volumes or more, which is as far as the view `volumes`                  counts, so whether their stencil wraps is not known; show fewer casters at once",
                self.unsure_pixels
            ));
        }
        warnings
    }
}

/// Are there volumes to be shown?
pub(crate) fn check(options: &RenderOptions) -> Result<(), RenderError> {
    match (options.view, options.settings.method) {
        (View::Volumes, Method::Volume(Volume { .. })) => Ok(()),
        (View::Volumes, _) => Err(RenderError::View(format!(
            "the view `volumes` counts faces of shadow volumes, and technique `{}` has none; use the technique `volume`",
            options.settings.technique.id
        ))),
        _ => Ok(()),
    }
}

impl Renderer<'_> {
    fn overdraw_pixels(&self) -> Result<Vec<OverdrawPixel>, RenderError> {
        if self.options.view != View::Volumes {
            return Err(RenderError::View("only the view `volumes` holds faces of volumes".into()));
        }
        let bytes = readback::texture(self.gpu, &self.targets.output)?;
        let channel = |b: &[u8], i: usize| f16::from_le_bytes([b[2 * i], b[2 * i + 1]]).to_f32();
        let pixel = |b: &[u8]| OverdrawPixel {
            overdraw: Overdraw {
                faces: channel(b, 0) as u32,
                count: channel(b, 1) as i32,
                under: match channel(b, 2) {
                    0.0 => Under::Nothing,
                    1.0 => Under::Receiver,
                    _ => Under::Other,
                },
            },
            grey: channel(b, 3),
        };
        Ok(bytes.chunks_exact(8).map(pixel).collect())
    }

    /// Faces of the shown light's volumes in each pixel, rows from the top. Only after a frame of [`View::Volumes`].
    ///
    /// # Errors
    /// [`RenderError::View`] for another view; [`RenderError::Gpu`] when the device is lost.
    pub fn overdraw(&self) -> Result<Vec<Overdraw>, RenderError> {
        Ok(self.overdraw_pixels()?.into_iter().map(|pixel| pixel.overdraw).collect())
    }

    /// What [`Self::overdraw`] comes to.
    ///
    /// # Errors
    /// As [`Self::overdraw`].
    pub fn overdraw_statistics(&self) -> Result<OverdrawStatistics, RenderError> {
        Ok(OverdrawStatistics::of(&self.overdraw_pixels()?))
    }

    /// The numbers as colours, with legend and histogram.
    pub(crate) fn overdraw_picture(&self) -> Result<Vec<u8>, RenderError> {
        let pixels = self.overdraw_pixels()?;
        Ok(picture::picture(self.options.size, &pixels, &OverdrawStatistics::of(&pixels)))
    }

    /// Adds to the warnings what the frame counted; nothing in other views.
    pub(crate) fn warn_of_overflow(&mut self) -> Result<(), RenderError> {
        if self.options.view == View::Volumes {
            let found = self.overdraw_statistics()?.warnings(self.options.shown_light);
            self.warnings.truncate(self.told_warnings);
            self.warnings.extend(found);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pixel(faces: u32, count: i32, under: Under) -> OverdrawPixel {
        OverdrawPixel { overdraw: Overdraw { faces, count, under }, grey: 0.5 }
    }

    #[test]
    fn statistics_tell_lit_from_shadow_and_wrong_from_right() {
        use Under::{Nothing, Other, Receiver};
        let pixels = [
            pixel(0, 0, Receiver),
            pixel(2, 0, Receiver),
            pixel(3, 1, Receiver),
            pixel(512, 256, Receiver),
            pixel(513, 257, Receiver),
            pixel(1024, -512, Other),
            pixel(2048, 1024, Nothing),
            pixel(1, 0, Nothing),
        ];
        let found = OverdrawStatistics::of(&pixels);
        assert_eq!(found.fragments, 4103);
        assert_eq!(found.picture, OverdrawPart { pixels: 8, mean: 4103.0 / 8.0, most: 2048 });
        assert_eq!(found.lit, Some(OverdrawPart { pixels: 3, mean: 514.0 / 3.0, most: 512 }));
        assert_eq!(found.shadow, Some(OverdrawPart { pixels: 2, mean: 258.0, most: 513 }));
        assert_eq!((found.deepest_count, found.wrongly_lit_pixels, found.unsure_pixels), (-512, 1, 1));
        let cells: Vec<_> = found.histogram.iter().map(|c| (c.from, c.to, (8.0 * c.share) as u32)).collect();
        assert_eq!(cells[..3], [(0, Some(1), 1), (1, Some(2), 1), (2, Some(4), 2)]);
        assert_eq!(cells[8..], [(128, Some(256), 0), (256, None, 4)]);
        let warnings = found.warnings(3);
        assert!(warnings.len() == 2 && warnings[0].starts_with("light 3: 1 pixels"), "{warnings:?}");
        assert!(OverdrawStatistics::of(&pixels[..3]).warnings(0).is_empty());
    }
}
