//! Texels per pixel as the views `density` and `density-light` hold them, and what they come to.

mod picture;

use crate::heat::OCTAVES;
use crate::{RenderError, RenderOptions, Renderer, View, readback};
use umbrage::core::density::Density;
use umbrage::core::technique::{Bias, Method};

/// A receiver's triangle faces the light by more than this cosine: one that is edge-on has no texels in any map, and hardly
/// any light that a shadow could take away.
pub const EDGE_ON_COS: f32 = 0.1;

/// The percentiles that are told.
pub const PERCENTILES: [u8; 7] = [1, 5, 25, 50, 75, 95, 99];

/// One pixel of the target: see `wgsl/density.wgsl`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DensityPixel {
    mean: f32,
    least: f32,
    most: f32,
    /// 0: nothing is there; above 0 a receiver's grey, below 0 that of another surface.
    grey: f32,
}

impl DensityPixel {
    fn is_receiver(self) -> bool {
        self.grey > 0.0
    }
}

/// What a list of numbers spans.
#[derive(Clone, Debug, PartialEq)]
pub struct Spread {
    /// The least of them.
    pub least: f64,
    /// For each of [`PERCENTILES`], the number that so many of a hundred are not above.
    pub percentiles: [f64; PERCENTILES.len()],
    /// The greatest.
    pub most: f64,
    /// Geometric mean: 0 where any is 0.
    pub mean: f64,
}

impl Spread {
    fn of(mut values: Vec<f64>) -> Self {
        values.sort_by(f64::total_cmp);
        let last = values.len() - 1;
        let at = |share: f64| values[(share * last as f64).round() as usize];
        let logarithms: f64 = values.iter().map(|v| v.ln()).sum();
        Self {
            least: values[0],
            percentiles: PERCENTILES.map(|percent| at(f64::from(percent) / 100.0)),
            most: values[last],
            mean: (logarithms / values.len() as f64).exp(),
        }
    }
}

/// How many receivers have so many texels a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OctaveShare {
    /// Texels per pixel, from here on; 0 of the first.
    pub from: f64,
    /// Up to here, not with it; infinite of the last.
    pub to: f64,
    /// Share of all receivers, 0..1.
    pub share: f64,
}

/// Texels per pixel over all receivers of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct DensityStatistics {
    /// Pixels that show a receiver.
    pub pixels: usize,
    /// Their share of the picture; of [`View::DensityLight`]: of the map.
    pub share: f64,
    /// Square roots of the number of texels in a pixel.
    pub mean: Spread,
    /// Texels along the direction of each pixel in which there are fewest.
    pub worst_direction: Spread,
    /// Shares of `mean` by powers of two, all that there are together.
    pub histogram: Vec<OctaveShare>,
}

impl DensityStatistics {
    /// `None` without any receiver. `of` is the number of pixels that could show one.
    fn of(pixels: &[DensityPixel], of: f64) -> Option<Self> {
        let receivers: Vec<_> = pixels.iter().filter(|pixel| pixel.is_receiver()).collect();
        if receivers.is_empty() {
            return None;
        }
        let count = receivers.len() as f64;
        // From 1/16 to 16.
        let bounds: Vec<f64> = (0..=OCTAVES).map(|i| f64::from(i - OCTAVES / 2).exp2()).collect();
        let mut counts = vec![0usize; bounds.len() + 1];
        for receiver in &receivers {
            counts[bounds.partition_point(|bound| f64::from(receiver.mean) >= *bound)] += 1;
        }
        let octave = |(i, in_it): (usize, usize)| OctaveShare {
            from: if i == 0 { 0.0 } else { bounds[i - 1] },
            to: bounds.get(i).copied().unwrap_or(f64::INFINITY),
            share: in_it as f64 / count,
        };
        Some(Self {
            pixels: receivers.len(),
            share: count / of,
            mean: Spread::of(receivers.iter().map(|pixel| f64::from(pixel.mean)).collect()),
            worst_direction: Spread::of(receivers.iter().map(|pixel| f64::from(pixel.least)).collect()),
            histogram: counts.into_iter().enumerate().map(octave).collect(),
        })
    }
}

/// The map's texels are asked which surface they hold, so that map is drawn without bias. The numbers know of none.
pub(crate) fn options(mut options: RenderOptions) -> RenderOptions {
    if let (View::DensityLight, Method::Map(combination)) = (options.view, &mut options.settings.method) {
        combination.bias = Bias::None;
    }
    options
}

impl Renderer<'_> {
    fn density_pixels(&self) -> Result<Vec<DensityPixel>, RenderError> {
        if !self.options.view.is_density() {
            let message = "only the views `density` and `density-light` hold texels per pixel";
            return Err(RenderError::View(message.into()));
        }
        let bytes = readback::texture(self.gpu, &self.targets.output)?;
        let channel = |b: &[u8], i: usize| f32::from_le_bytes([b[i], b[i + 1], b[i + 2], b[i + 3]]);
        let pixel = |b: &[u8]| DensityPixel {
            mean: channel(b, 0),
            least: channel(b, 4),
            most: channel(b, 8),
            grey: channel(b, 12),
        };
        Ok(bytes.chunks_exact(16).map(pixel).collect())
    }

    /// Texels of the shown light's map in each pixel, rows from the top; `None` where no receiver of it is seen. Only after a
    /// frame of [`View::Density`] (pixels of the picture) or [`View::DensityLight`] (the map, letter-boxed).
    ///
    /// A receiver faces the light (see [`EDGE_ON_COS`]) and lies in its cone, range and map; whether it is in shadow does
    /// not count. Of an area light's several maps it is the first.
    ///
    /// # Errors
    /// [`RenderError::View`] for another view; [`RenderError::Gpu`] when the device is lost.
    pub fn density(&self) -> Result<Vec<Option<Density>>, RenderError> {
        let density = |pixel: DensityPixel| {
            let [mean, least, most] = [pixel.mean, pixel.least, pixel.most].map(f64::from);
            pixel.is_receiver().then_some(Density { mean, least, most })
        };
        Ok(self.density_pixels()?.into_iter().map(density).collect())
    }

    /// What [`Self::density`] comes to; `None` where the picture shows no receiver.
    ///
    /// # Errors
    /// As [`Self::density`].
    pub fn density_statistics(&self) -> Result<Option<DensityStatistics>, RenderError> {
        let pixels = self.density_pixels()?;
        Ok(DensityStatistics::of(&pixels, self.could_show(&pixels)))
    }

    /// How many pixels could show a receiver: all, or those of the map.
    fn could_show(&self, pixels: &[DensityPixel]) -> f64 {
        let all = match self.options.view {
            View::DensityLight => pixels.iter().filter(|pixel| pixel.grey != 0.0).count(),
            _ => pixels.len(),
        };
        all.max(1) as f64
    }

    /// The numbers as colours, with legend and histogram.
    pub(crate) fn density_picture(&self) -> Result<Vec<u8>, RenderError> {
        let pixels = self.density_pixels()?;
        let statistics = DensityStatistics::of(&pixels, self.could_show(&pixels));
        let shares: Vec<f64> =
            statistics.iter().flat_map(|found| &found.histogram).map(|octave| octave.share).collect();
        let size = self.options.size;
        // The letter-boxed map leaves room beside it.
        let beside_px = match self.options.view {
            View::DensityLight if self.views().len() == 1 => size.x.saturating_sub(size.y) / 2,
            _ => 0,
        };
        Ok(picture::picture(size, &pixels, &shares, beside_px))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pixel(mean: f32, grey: f32) -> DensityPixel {
        DensityPixel { mean, least: 0.5 * mean, most: 2.0 * mean, grey }
    }

    #[test]
    fn statistics_know_receivers_only() {
        let pixels: Vec<_> = [(0.01, 0.5), (0.5, 0.5), (1.0, 0.5), (1.99, 0.5), (64.0, 0.5)]
            .map(|(mean, grey)| pixel(mean, grey))
            .into_iter()
            .chain([pixel(9.0, 0.0), pixel(9.0, -0.5)])
            .collect();
        let found = DensityStatistics::of(&pixels, 10.0).expect("receivers");
        assert_eq!((found.pixels, found.share), (5, 0.5));
        assert_eq!(
            (found.mean.least, found.mean.percentiles[3], found.mean.most),
            (f64::from(0.01f32), 1.0, 64.0)
        );
        assert!((found.mean.mean - (0.01f64 * 0.5 * 1.99 * 64.0).powf(0.2)).abs() < 1e-6);
        assert!((found.worst_direction.mean - 0.5 * found.mean.mean).abs() < 1e-6);
        let filled: Vec<_> = found.histogram.iter().filter(|octave| octave.share > 0.0).collect();
        let filled: Vec<_> = filled.iter().map(|octave| (octave.from, octave.to, octave.share)).collect();
        let below = 1.0 / 16.0;
        assert_eq!(filled, [(0.0, below, 0.2), (0.5, 1.0, 0.2), (1.0, 2.0, 0.4), (16.0, f64::INFINITY, 0.2)]);
        assert_eq!(DensityStatistics::of(&[pixel(1.0, -0.5)], 1.0), None);
    }
}
