//! Heat maps: numbers as colours over the dimmed scene, with a legend and a histogram.

use embedded_graphics::Pixel;
use embedded_graphics::mono_font::{MonoFont, MonoTextStyle, ascii};
use embedded_graphics::pixelcolor::Rgb888;
use embedded_graphics::prelude::{DrawTarget, Drawable, OriginDimensions, Point, RgbColor, Size};
use embedded_graphics::primitives::{PointsIter, Rectangle};
use embedded_graphics::text::{Alignment, Baseline, Text, TextStyle, TextStyleBuilder};
use glam::{UVec2, Vec3};
use std::convert::Infallible;

/// Powers of two that a legend spans.
pub const OCTAVES: i32 = 8;
/// Cells of a legend: one for each of them, and one for what is beyond on either side.
pub const CELLS: u32 = OCTAVES as u32 + 2;
/// Letters that a line of every legend has room for.
#[cfg(test)]
pub const LINE: usize = 27;

/// Text that is read first.
pub const TEXT: Rgb888 = Rgb888::new(236, 236, 236);
/// Text that is read last.
pub const FAINT: Rgb888 = Rgb888::new(150, 150, 155);
/// Behind the legend, and how much of the picture it hides.
const PANEL: (Vec3, f32) = (Vec3::new(14.0, 14.0, 17.0), 0.86);
/// Where nothing is, and beside a map. 0..255.
pub const NOTHING: Vec3 = Vec3::new(5.0, 5.0, 6.0);

/// What a legend says.
#[derive(Clone, Copy, Debug)]
pub struct Legend<'a> {
    /// Over all of it; a line of 27 letters at most.
    pub title: &'a str,
    /// The colour at a place of the scale, which is told in cells from its left end. 0..255.
    pub color: fn(f64) -> Vec3,
    /// Places of the scale that have a name.
    pub ticks: &'a [(i32, &'a str)],
    /// Under its left and its right end.
    pub words: [(&'a str, Rgb888); 2],
    /// For each cell its share, together 1; none where nothing was counted.
    pub shares: &'a [f64],
}

/// A number's colour over a surface with that grey, 0..1.
pub fn over_scene(color: Vec3, grey: f32) -> Vec3 {
    color * (0.58 + 0.42 * grey)
}

/// A surface without a number, with that grey, 0..1.
pub fn scene(grey: f32) -> Vec3 {
    Vec3::splat(16.0 + 66.0 * grey)
}

/// A colour of 0..255 as a pixel.
pub fn rgba(color: Vec3) -> [u8; 4] {
    let [r, g, b] = color.to_array().map(|level| level.round() as u8);
    [r, g, b, 255]
}

fn rgb888(color: Vec3) -> Rgb888 {
    let [r, g, b, _] = rgba(color);
    Rgb888::new(r, g, b)
}

/// Draws the legend on the picture, RGBA, where that is large enough for one. `beside_px` is how much room there is at the left
/// side of what is shown.
pub fn draw_legend(size: UVec2, rgba: &mut [u8], legend: &Legend<'_>, beside_px: u32) {
    if let Some(layout) = Layout::new(size, beside_px) {
        // A canvas cannot fail.
        let _ = layout.draw(&mut Canvas { size, rgba }, legend);
    }
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

/// Where the legend lies.
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

    fn draw(&self, canvas: &mut Canvas<'_>, legend: &Legend<'_>) -> Drawn {
        canvas.dim(Rectangle::new(self.corner, self.panel()));
        let (line, cell) = (self.line() as i32, self.cell as i32);
        let inner = self.corner + Point::new(self.pad as i32, self.pad as i32);
        let width = cell * CELLS as i32;
        self.text(canvas, legend.title, inner + Point::new(width / 2, 0), Alignment::Center, TEXT)?;
        let foot = inner + Point::new(0, 2 * line + self.histogram as i32);
        self.draw_bars(canvas, legend, foot)?;
        // Between the cells colours flow, as in the picture.
        for x in 0..width {
            let place = (f64::from(x) + 0.5) / f64::from(cell);
            let column = Rectangle::new(foot + Point::new(x, 1), Size::new(1, self.line() - 1));
            canvas.fill_solid(&column, rgb888((legend.color)(place)))?;
        }
        let below = foot + Point::new(0, line);
        for (place, name) in legend.ticks {
            let x = *place * cell;
            canvas.fill_solid(
                &Rectangle::new(below + Point::new(x, -line / 2), Size::new(1, self.line() / 2)),
                Rgb888::BLACK,
            )?;
            canvas.fill_solid(&Rectangle::new(below + Point::new(x, 0), Size::new(1, 3)), TEXT)?;
            self.text(canvas, name, below + Point::new(x + 1, TICK as i32), Alignment::Center, TEXT)?;
        }
        let words = below + Point::new(0, line + TICK as i32);
        let [(left, left_color), (right, right_color)] = legend.words;
        self.text(canvas, left, words, Alignment::Left, left_color)?;
        self.text(canvas, right, words + Point::new(width, 0), Alignment::Right, right_color)
    }

    /// The bars that stand on `foot`, the tallest as high as the histogram, each under its share in percent.
    fn draw_bars(&self, canvas: &mut Canvas<'_>, legend: &Legend<'_>, foot: Point) -> Drawn {
        let shares = legend.shares;
        let tallest = shares.iter().copied().fold(0.0, f64::max);
        let cell = self.cell as i32;
        for (i, share) in (0..).zip(shares).filter(|(_, share)| **share > 0.0) {
            let height = ((share / tallest * f64::from(self.histogram)).round() as u32).max(1);
            let corner = foot + Point::new(i * cell + 1, -(height as i32));
            let color = rgb888((legend.color)(f64::from(i) + 0.5));
            canvas.fill_solid(&Rectangle::new(corner, Size::new(self.cell - 2, height)), color)?;
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

    #[test]
    fn a_legend_fits_every_picture_that_has_one() {
        let mut shares = vec![0.0; CELLS as usize];
        shares[3] = 1.0;
        let title = "m".repeat(LINE);
        let legend = Legend {
            title: &title,
            color: |_| Vec3::splat(255.0),
            ticks: &[(1, "1")],
            words: [("few", FAINT), ("many", FAINT)],
            shares: &shares,
        };
        for size in
            [(1, 1), (64, 36), (150, 10), (10, 900), (160, 120), (640, 360), (1280, 720), (3840, 2160)]
        {
            let size = UVec2::from(size);
            let mut picture = vec![0; 4 * size.element_product() as usize];
            draw_legend(size, &mut picture, &legend, 0);
            assert_eq!(picture.contains(&255), Layout::new(size, 0).is_some(), "{size}");
            if let Some(layout) = Layout::new(size, 0) {
                let panel = layout.panel();
                assert!(layout.corner.x >= 0 && layout.corner.x as u32 + panel.width <= size.x, "{size}");
                assert!(layout.corner.y >= 0 && layout.corner.y as u32 + panel.height <= size.y, "{size}");
                let title = LINE as u32 * layout.font.character_size.width;
                assert!(title <= CELLS * layout.cell, "{size}: the title has {title} px");
            }
        }
        assert!(
            Layout::new(UVec2::new(64, 36), 0).is_none() && Layout::new(UVec2::new(320, 180), 0).is_some()
        );
    }
}
