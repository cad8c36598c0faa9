//! Texels per pixel as a picture: colours over the dimmed scene, a legend, a histogram.

use super::{DensityPixel, OCTAVES};
use colorous::RED_YELLOW_BLUE;
use embedded_graphics::Pixel;
use embedded_graphics::mono_font::{MonoFont, MonoTextStyle, ascii};
use embedded_graphics::pixelcolor::Rgb888;
use embedded_graphics::prelude::{DrawTarget, Drawable, OriginDimensions, Point, RgbColor, Size};
use embedded_graphics::primitives::{PointsIter, Rectangle};
use embedded_graphics::text::{Alignment, Baseline, Text, TextStyle, TextStyleBuilder};
use glam::{UVec2, Vec3};
use std::convert::Infallible;

const TITLE: &str = "shadow map texels per pixel";
/// Ticks of the legend, as powers of two.
const TICKS: [(i32, &str); 5] = [(-4, "1/16"), (-2, "1/4"), (0, "1"), (2, "4"), (4, "16")];
const TEXT: Rgb888 = Rgb888::new(236, 236, 236);
const FAINT: Rgb888 = Rgb888::new(150, 150, 155);
/// Behind the legend, and how much of the picture it hides.
const PANEL: (Vec3, f32) = (Vec3::new(14.0, 14.0, 17.0), 0.86);
/// Where nothing is, and beside the map.
const NOTHING: Vec3 = Vec3::new(5.0, 5.0, 6.0);

/// The colour of so many texels a pixel: blue below one, pale yellow at it, red above (Brewer's RdYlBu, which stays readable
/// for every kind of colour blindness). Logarithmic from 1/16 to 16, the same beyond.
fn color(texels_per_pixel: f64) -> Vec3 {
    let share = 0.5 - texels_per_pixel.log2() / f64::from(OCTAVES);
    let color = RED_YELLOW_BLUE.eval_continuous(share.clamp(0.0, 1.0));
    Vec3::new(f32::from(color.r), f32::from(color.g), f32::from(color.b))
}

/// The same to draw with.
fn rgb888(texels_per_pixel: f64) -> Rgb888 {
    let [r, g, b] = color(texels_per_pixel).to_array().map(|level| level.round() as u8);
    Rgb888::new(r, g, b)
}

fn painted(pixel: &DensityPixel) -> [u8; 4] {
    let rgb = if pixel.is_receiver() {
        color(f64::from(pixel.mean)) * (0.58 + 0.42 * pixel.grey)
    } else if pixel.grey < 0.0 {
        Vec3::splat(16.0 - 66.0 * pixel.grey)
    } else {
        NOTHING
    };
    let [r, g, b] = rgb.to_array().map(|level| level.round() as u8);
    [r, g, b, 255]
}

/// The whole picture, RGBA. `shares` are those of the histogram, none where there is none.
/// `beside_px` is how much room there is at the left side of what is shown.
pub fn picture(size: UVec2, pixels: &[DensityPixel], shares: &[f64], beside_px: u32) -> Vec<u8> {
    let mut rgba: Vec<u8> = pixels.iter().flat_map(painted).collect();
    let mut canvas = Canvas { size, rgba: &mut rgba };
    if let Some(layout) = Layout::new(size, beside_px) {
        // A canvas cannot fail.
        let _ = layout.draw(&mut canvas, shares);
    }
    rgba
}

/// The picture as something to draw on.
struct Canvas<'a> {
    size: UVec2,
    rgba: &'a mut [u8],
}

impl Canvas<'_> {
    fn at(&mut self, p: Point) -> Option<&mut [u8]> {
        let (x, y) = (u32::try_from(p.x).ok()?, u32::try_from(p.y).ok()?);
        let at = 4 * (y as usize * self.size.x as usize + x as usize);
        (x < self.size.x).then(|| self.rgba.get_mut(at..at + 3)).flatten()
    }

    fn dim(&mut self, area: Rectangle) {
        for p in area.points() {
            if let Some(pixel) = self.at(p) {
                for (level, over) in pixel.iter_mut().zip(PANEL.0.to_array()) {
                    *level = (f32::from(*level) * (1.0 - PANEL.1) + over * PANEL.1).round() as u8;
                }
            }
        }
    }
}

impl OriginDimensions for Canvas<'_> {
    fn size(&self) -> Size {
        Size::new(self.size.x, self.size.y)
    }
}

impl DrawTarget for Canvas<'_> {
    type Color = Rgb888;
    type Error = Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<Rgb888>>>(&mut self, pixels: I) -> Result<(), Infallible> {
        for Pixel(p, color) in pixels {
            if let Some(pixel) = self.at(p) {
                pixel.copy_from_slice(&[color.r(), color.g(), color.b()]);
            }
        }
        Ok(())
    }
}

/// Fonts by the width of a legend's cell, pixels: what the widest line, and a number over a bar, leave room for.
const FONTS: [(u32, &MonoFont<'_>); 5] = [
    (29, &ascii::FONT_9X15),
    (22, &ascii::FONT_7X13),
    (17, &ascii::FONT_6X10),
    (15, &ascii::FONT_5X8),
    (11, &ascii::FONT_4X6),
];

/// Where the legend lies: a cell for each octave, and one for what is beyond on either side.
struct Layout {
    /// Upper left corner of the panel.
    corner: Point,
    cell: u32,
    pad: u32,
    font: &'static MonoFont<'static>,
    histogram: u32,
}

/// Height of a tick below the colours, with the gap to its name, pixels.
const TICK: u32 = 4;
const CELLS: u32 = OCTAVES as u32 + 2;

impl Layout {
    /// `None` where the picture is too small for one.
    fn new(size: UVec2, beside_px: u32) -> Option<Self> {
        let usual = (size.x * 3 / 10).clamp(150, 400).min(size.x / 2 + 40);
        // Beside is better than over, while the text stays readable.
        let width = if beside_px >= 200 { usual.min(beside_px - 16) } else { usual };
        let pad = (width / 28).clamp(4, 12);
        let cell = (width - 2 * pad) / CELLS;
        let (_, font) = FONTS.into_iter().find(|(least, _)| *least <= cell)?;
        let mut layout =
            Self { corner: Point::zero(), cell, pad, font, histogram: 4 * font.character_size.height };
        let margin = pad as i32;
        let top = size.y as i32 - layout.panel().height as i32 - margin;
        layout.corner = Point::new(margin, top);
        (top > size.y as i32 / 4).then_some(layout)
    }

    fn line(&self) -> u32 {
        self.font.character_size.height * 5 / 4
    }

    fn panel(&self) -> Size {
        // Title, numbers over the bars, bars; colours; ticks, words.
        let height = 2 * self.line() + self.histogram + self.line() + TICK + 2 * self.line();
        Size::new(CELLS * self.cell + 2 * self.pad, height + 2 * self.pad)
    }

    fn text(
        &self,
        canvas: &mut Canvas<'_>,
        text: &str,
        at: Point,
        alignment: Alignment,
        color: Rgb888,
    ) -> Drawn {
        let style: TextStyle = TextStyleBuilder::new().alignment(alignment).baseline(Baseline::Top).build();
        Text::with_text_style(text, at, MonoTextStyle::new(self.font, color), style).draw(canvas)?;
        Ok(())
    }

    fn draw(&self, canvas: &mut Canvas<'_>, shares: &[f64]) -> Drawn {
        canvas.dim(Rectangle::new(self.corner, self.panel()));
        let (line, cell) = (self.line() as i32, self.cell as i32);
        let inner = self.corner + Point::new(self.pad as i32, self.pad as i32);
        let width = cell * CELLS as i32;
        let title = if shares.is_empty() { "no receiver is in sight" } else { TITLE };
        self.text(canvas, title, inner + Point::new(width / 2, 0), Alignment::Center, TEXT)?;
        let foot = inner + Point::new(0, 2 * line + self.histogram as i32);
        self.draw_bars(canvas, shares, foot)?;
        // Colours of the octaves; between them they flow, as in the picture.
        for x in 0..width {
            let octave = (f64::from(x) + 0.5) / f64::from(cell) - 1.0 - f64::from(OCTAVES / 2);
            let column = Rectangle::new(foot + Point::new(x, 1), Size::new(1, self.line() - 1));
            canvas.fill_solid(&column, rgb888(octave.exp2()))?;
        }
        let below = foot + Point::new(0, line);
        for (power, name) in TICKS {
            let x = (power + OCTAVES / 2 + 1) * cell;
            canvas.fill_solid(
                &Rectangle::new(below + Point::new(x, -line / 2), Size::new(1, self.line() / 2)),
                Rgb888::BLACK,
            )?;
            canvas.fill_solid(&Rectangle::new(below + Point::new(x, 0), Size::new(1, 3)), TEXT)?;
            self.text(canvas, name, below + Point::new(x + 1, TICK as i32), Alignment::Center, TEXT)?;
        }
        let words = below + Point::new(0, line + TICK as i32);
        self.text(canvas, "too few", words, Alignment::Left, FAINT)?;
        self.text(canvas, "to spare", words + Point::new(width, 0), Alignment::Right, FAINT)
    }

    /// The bars that stand on `foot`, the tallest as high as the histogram, each under its share in percent.
    fn draw_bars(&self, canvas: &mut Canvas<'_>, shares: &[f64], foot: Point) -> Drawn {
        let tallest = shares.iter().copied().fold(0.0, f64::max);
        let cell = self.cell as i32;
        for (i, share) in (0..).zip(shares).filter(|(_, share)| **share > 0.0) {
            let height = ((share / tallest * f64::from(self.histogram)).round() as u32).max(1);
            let corner = foot + Point::new(i * cell + 1, -(height as i32));
            let middle = f64::from(i - OCTAVES / 2) - 0.5;
            canvas.fill_solid(
                &Rectangle::new(corner, Size::new(self.cell - 2, height)),
                rgb888(middle.exp2()),
            )?;
            let percent = match 100.0 * share {
                few if few < 1.0 => "<1".to_owned(),
                many => format!("{many:.0}"),
            };
            let label = foot + Point::new(i * cell + cell / 2, -(height as i32) - self.line() as i32);
            let sign = if i == first_tallest(shares, tallest) { "%" } else { "" };
            self.text(canvas, &format!("{percent}{sign}"), label, Alignment::Center, TEXT)?;
        }
        Ok(())
    }
}

/// The bar that carries the sign of percent.
fn first_tallest(shares: &[f64], tallest: f64) -> i32 {
    (0..).zip(shares).find(|(_, share)| **share >= tallest).map_or(0, |(i, _)| i)
}

type Drawn = Result<(), Infallible>;

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(size: UVec2, mean: f32, grey: f32) -> Vec<DensityPixel> {
        let pixel = DensityPixel { mean, least: mean, most: mean, grey };
        vec![pixel; size.element_product() as usize]
    }

    #[test]
    fn too_few_is_blue_and_to_spare_is_red() {
        let (few, one, many) = (color(1.0 / 16.0), color(1.0), color(16.0));
        assert!(few.z > 2.0 * few.x && many.x > 2.0 * many.z, "{few} {many}");
        assert!(one.min_element() > 150.0, "{one}");
        assert_eq!((color(0.0), color(1e-9), color(1e30)), (few, few, many));
        // What grows must not turn back: lightness rises up to one, and falls from it on.
        let light = |octave: i32| color(f64::from(octave).exp2()).dot(Vec3::new(0.21, 0.72, 0.07));
        assert!((-4..0).all(|i| light(i) < light(i + 1)) && (0..4).all(|i| light(i) > light(i + 1)));
    }

    #[test]
    fn a_legend_fits_every_picture_that_has_one() {
        let mut shares = vec![0.0; CELLS as usize];
        shares[3] = 1.0;
        for size in
            [(1, 1), (64, 36), (150, 10), (10, 900), (160, 120), (640, 360), (1280, 720), (3840, 2160)]
        {
            let size = UVec2::from(size);
            let drawn = picture(size, &flat(size, 1.0, 1.0), &shares, 0);
            assert_eq!(drawn.len(), 4 * size.element_product() as usize);
            if let Some(layout) = Layout::new(size, 0) {
                let panel = layout.panel();
                assert!(layout.corner.x >= 0 && layout.corner.x as u32 + panel.width <= size.x, "{size}");
                assert!(layout.corner.y >= 0 && layout.corner.y as u32 + panel.height <= size.y, "{size}");
                let title = TITLE.len() as u32 * layout.font.character_size.width;
                assert!(title <= CELLS * layout.cell, "{size}: the title has {title} px");
            }
        }
        assert!(
            Layout::new(UVec2::new(64, 36), 0).is_none() && Layout::new(UVec2::new(320, 180), 0).is_some()
        );
    }
}
