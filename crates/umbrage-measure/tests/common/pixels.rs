//! A technique against the truth, pixel by pixel, with an eye for edges.

use super::common::settings;
use super::scenes::with_light;
use glam::{IVec2, UVec2};
use umbrage_render::umbrage::core::technique::Settings;
use umbrage_render::umbrage::core::{Camera, Light};
use umbrage_render::{DrawnSurface, Gpu, Measure, RenderOptions, Renderer, View};
use umbrage_scene::Scene;
use umbrage_truth::{Emitter, Place, Quality, Rays, Seen, Stack, Surfaces, Visibility, hides_change, silent};

pub const SIZE: UVec2 = UVec2::new(240, 135);
/// Share of the judged pixels that may differ.
const MOST: f64 = 1e-3;
/// Two planes are one when a place on either lies so near to the other, pixels.
const SAME_PLANE_PX: f64 = 0.05;
/// More pixels than this in one picture are wrong wherever they are.
const MOST_LOOKED_AT: usize = 300;
/// A surface that light only grazes is lit or not by rounding: least cosine of what is judged.
const LEAST_COS: f64 = 1e-5;
/// No edge is looked for farther away, pixels.
const FAR_PX: i32 = 16;

/// What a picture has to do with the truth.
#[derive(Clone, Copy, Debug, Default)]
pub struct Found {
    /// Pixels that face the light, lie in its reach, and show what rays saw.
    pub judged: usize,
    /// Of them in shadow, by truth.
    pub dark: usize,
    /// Of them answered the other way.
    pub differ: usize,
    /// Of these, those that are dark or lit and farther than one pixel from any edge.
    pub acne: usize,
    leak: usize,
    /// How far the farthest of all that differ is from an edge, pixels.
    worst_px: i32,
    /// V that is neither 0 nor 1.
    neither: usize,
}

impl Found {
    /// What is not as it should be.
    pub fn broken(&self, what: &str) -> Option<String> {
        let right = self.differ as f64 <= MOST * self.judged as f64
            && (self.acne, self.leak, self.neither) == (0, 0, 0)
            && self.worst_px <= 1;
        (!right).then(|| format!("{what}: {self:?}"))
    }
}

/// The truth of a light in a picture.
pub struct Truth {
    pub surfaces: Surfaces,
    visibility: Visibility,
}

impl Truth {
    pub fn new(rays: &Rays<'_>, camera: &Camera, light: &Light) -> Self {
        let surfaces = Surfaces::new(rays, camera, SIZE, &silent).expect("surfaces");
        let visibility =
            Visibility::new(rays, &surfaces, light, &Quality::default(), &silent).expect("truth");
        Self { surfaces, visibility }
    }

    /// Did rasteriser and rays see the same, and is it judged?
    fn is_judged(&self, emitter: &Emitter, pixel: usize, drawn: Option<&DrawnSurface>) -> bool {
        let (Some(seen), Some(drawn)) = (&self.surfaces.seen[pixel], drawn) else { return false };
        let offset = drawn.p_world - seen.p_world;
        let pixel_m = self.surfaces.pixel_m(seen);
        // The picture is dark where the shading's normal faces away, whatever V is.
        self.visibility.place[pixel] == Place::Receiver
            && seen.normal_world.as_dvec3().dot(emitter.center(seen.p_world).way) > LEAST_COS
            && drawn.shading_normal_world.as_dvec3().dot(emitter.center(drawn.p_world).way) > 0.0
            && offset.dot(seen.normal_world.as_dvec3()).abs() <= SAME_PLANE_PX * pixel_m
            && offset.length() < 1e3 * pixel_m
    }

    fn is_on_plane(&self, of: &Seen, other: &Seen) -> bool {
        let off_m = (other.p_world - of.p_world).dot(of.normal_world.as_dvec3()).abs();
        off_m <= SAME_PLANE_PX * self.surfaces.pixel_m(of)
    }

    /// Is there an edge between two pixels: of a shadow, of a surface, or a crease?
    fn is_edge(&self, a: usize, b: usize) -> bool {
        let is_crease = match (&self.surfaces.seen[a], &self.surfaces.seen[b]) {
            (None, None) => false,
            (Some(a), Some(b)) => a.slot != b.slot && !(self.is_on_plane(a, b) && self.is_on_plane(b, a)),
            _ => true,
        };
        is_crease || self.visibility.v[a] != self.visibility.v[b]
    }

    /// How far the nearest edge is, pixels: it lies between neighbours in a square of that radius around the pixel.
    fn edge_px(&self, pixel: usize) -> i32 {
        let size = SIZE.as_ivec2();
        let middle = IVec2::new(pixel as i32 % size.x, pixel as i32 / size.x);
        let index = |p: IVec2| (p.y * size.x + p.x) as usize;
        let has_edge = |r: &i32| {
            let (least, most) = ((middle - *r).max(IVec2::ZERO), (middle + *r).min(size - 1));
            (least.y..=most.y).flat_map(|y| (least.x..=most.x).map(move |x| IVec2::new(x, y))).any(|p| {
                let next = [p + IVec2::X, p + IVec2::Y, p + IVec2::ONE, p + IVec2::new(-1, 1)];
                next.iter()
                    .filter(|n| n.cmpge(least).all() && n.cmple(most).all())
                    .any(|n| self.is_edge(index(p), index(*n)))
            })
        };
        (1..FAR_PX).find(has_edge).unwrap_or(FAR_PX)
    }

    /// The same, but for an edge within a pixel that no pixel's centre shows.
    fn any_edge_px(&self, rays: &Rays<'_>, emitter: &Emitter, pixel: usize) -> i32 {
        let is_hidden = self.surfaces.seen[pixel].is_some_and(|seen| {
            let (is_lit, pixel_m) = (self.visibility.v[pixel].x > 0.5, self.surfaces.pixel_m(&seen));
            hides_change(rays, emitter, &seen, is_lit, pixel_m, &mut Stack::default())
        });
        match self.edge_px(pixel) {
            far if far > 1 && is_hidden => 1,
            shown => shown,
        }
    }

    fn found(&self, rays: &Rays<'_>, light: &Light, v: &[f32], drawn: &[Option<DrawnSurface>]) -> Found {
        let emitter = Emitter::new(light);
        let mut found = Found::default();
        for pixel in (0..v.len()).filter(|i| self.is_judged(&emitter, *i, drawn[*i].as_ref())) {
            let expected = self.visibility.v[pixel].x;
            found.judged += 1;
            found.dark += usize::from(expected < 0.5);
            found.neither += usize::from(v[pixel] != 0.0 && v[pixel] != 1.0);
            if (v[pixel] - expected).abs() > 0.5 {
                found.differ += 1;
                // What is simply wrong needs no closer look.
                let is_hopeless = found.differ > MOST_LOOKED_AT;
                let edge_px = if is_hopeless { FAR_PX } else { self.any_edge_px(rays, &emitter, pixel) };
                found.worst_px = found.worst_px.max(edge_px);
                found.acne += usize::from(edge_px > 1 && expected > 0.5);
                found.leak += usize::from(edge_px > 1 && expected < 0.5);
            }
        }
        found
    }
}

/// A scene with its hierarchy.
pub struct Subject<'a> {
    gpu: &'a Gpu,
    pub rays: Rays<'a>,
    scene: &'a Scene,
}

impl<'a> Subject<'a> {
    pub fn new(gpu: &'a Gpu, scene: &'a Scene) -> Self {
        Self { gpu, rays: Rays::new(scene).expect("rays"), scene }
    }

    pub fn renderer(&self, camera: &Camera, light: Light, with: Settings) -> Renderer<'a> {
        let scene = with_light(self.scene.clone(), light);
        let options = RenderOptions { size: SIZE, view: View::Visibility, ..RenderOptions::new(with) };
        Renderer::new(self.gpu, &scene, camera, options).expect("a renderer")
    }

    /// Judges what a renderer draws of the light from a camera.
    pub fn judge(&self, renderer: &mut Renderer<'_>, truth: &Truth, light: &Light) -> Found {
        renderer.set_camera(&truth.surfaces.camera).expect("a camera");
        renderer.frame(Measure::Frame).expect("a frame");
        let v = renderer.visibility().expect("V");
        truth.found(&self.rays, light, &v, &renderer.surfaces().expect("surfaces"))
    }

    pub fn one(&self, camera: &Camera, light: Light) -> Found {
        let truth = Truth::new(&self.rays, camera, &light);
        self.judge(&mut self.renderer(camera, light, settings("volume", &[])), &truth, &light)
    }
}
