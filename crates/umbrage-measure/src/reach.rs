//! What a technique cannot resolve, pixel by pixel.

use glam::{DVec3, Mat4, UVec2};
use umbrage_render::umbrage::core::DEPTH;
use umbrage_render::umbrage::core::density::{Raster, texels_per_metre, texels_per_pixel};
use umbrage_render::umbrage::core::fit::{MaskView, ShadowView};
use umbrage_render::umbrage::core::technique::Settings;
use umbrage_truth::{LEAST_REACH_PX, Seen, Surfaces};

/// How far a technique reaches around each surface.
#[derive(Debug)]
pub struct Reach {
    maps: Vec<(ShadowView, Raster)>,
    /// The filter's radius and one texel more.
    texels: f64,
    /// Views of masks, of which several may be laid over one surface.
    masks: Vec<(Mat4, Raster)>,
    /// Radius of a blur on the screen, pixels, or on the surface, metres.
    blur: Blur,
}

/// How far a blur of the picture reaches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Blur {
    /// Pixels.
    Px(f32),
    /// Metres on the surface.
    Metres(f32),
}

impl Reach {
    /// Of maps of `size_texel` drawn in `views`, with a filter of radius `filter_texel`. Of several views, that one counts in
    /// whose middle a surface lies: the tile of a point light. Without a map there is nothing that a texel hides.
    pub fn new(views: &[ShadowView], size_texel: u32, filter_texel: f32) -> Self {
        let maps = views.iter().map(|view| (*view, view.raster(size_texel))).collect();
        Self { maps, texels: f64::from(filter_texel) + 1.0, masks: Vec::new(), blur: Blur::Px(0.0) }
    }

    /// Of what a technique drew, whose maps are these: a blur on the screen reaches further.
    pub fn of(settings: &Settings, views: &[ShadowView], masks: &[MaskView]) -> Self {
        let maps = settings.fallback();
        let maps = maps.as_ref().unwrap_or(settings);
        let radius = |name: &str| 0.5 * settings.value(name).unwrap_or(0.0);
        let blur =
            if radius("soft_m") > 0.0 { Blur::Metres(radius("soft_m")) } else { Blur::Px(radius("soft_px")) };
        let raster = |view: &MaskView| Raster::new(view.clip_from_world(), UVec2::splat(view.size_texel));
        let masks = masks.iter().map(|view| (view.clip_from_world(), raster(view))).collect();
        Self { blur, masks, ..Self::new(views, maps.map_size_texel(), maps.reach_texel()) }
    }

    /// Is there any map?
    pub fn has_map(&self) -> bool {
        !self.maps.is_empty()
    }

    /// The masks that are laid over a place.
    fn masks_over(&self, p_world: DVec3) -> impl Iterator<Item = &Raster> {
        let is_over = move |(clip_from_world, _): &&(Mat4, Raster)| {
            let clip = clip_from_world.as_dmat4() * p_world.extend(1.0);
            clip.w > 0.0 && clip.x.abs() <= clip.w && clip.y.abs() <= clip.w
        };
        self.masks.iter().filter(is_over).map(|(_, raster)| raster)
    }

    fn map_of(&self, p_world: DVec3) -> Option<&Raster> {
        let off_middle = |view: &ShadowView| {
            let clip = view.clip_from_world().as_dmat4() * p_world.extend(1.0);
            if clip.w > 0.0 { (clip.x / clip.w).abs().max((clip.y / clip.w).abs()) } else { f64::INFINITY }
        };
        let nearest = self.maps.iter().min_by(|a, b| off_middle(&a.0).total_cmp(&off_middle(&b.0)));
        nearest.map(|(_, raster)| raster)
    }

    /// Reach of every pixel, pixels: two, or as many as the reach's texels are long on the screen, where a texel's shadow on
    /// the surface is seen at its longest. Infinite where the surface is edge-on to the light.
    pub fn px(&self, surfaces: &Surfaces) -> Vec<f32> {
        let aspect = surfaces.size.x as f32 / surfaces.size.y as f32;
        let camera = &surfaces.camera;
        let clip_from_world = camera.clip_from_view(aspect, DEPTH) * camera.view_from_world();
        let picture = Raster::new(clip_from_world, surfaces.size);
        let reach = |seen: &Option<Seen>| {
            let Some(seen) = seen else { return LEAST_REACH_PX };
            // A blur that is no whole number of pixels wide ends in the next.
            let least_px = match self.blur {
                Blur::Px(radius_px) if radius_px > 0.0 => LEAST_REACH_PX.max(radius_px + 1.0),
                Blur::Metres(radius_m) => LEAST_REACH_PX.max(radius_m / surfaces.pixel_m(seen) as f32 + 1.0),
                Blur::Px(_) => LEAST_REACH_PX,
            };
            let of_map = |map: &Raster| {
                // A texel is longest where a pixel has fewest of them. Exact for warped views too.
                let density = texels_per_pixel(map, &picture, seen.p_world, seen.normal_world.as_dvec3());
                (self.texels / density.least) as f32
            };
            let least_px = self.masks_over(seen.p_world).map(of_map).fold(least_px, f32::max);
            let Some(map) = self.map_of(seen.p_world) else { return least_px };
            of_map(map).max(least_px)
        };
        surfaces.seen.iter().map(reach).collect()
    }

    /// Width of a texel at a place, across the ray of light `way`, where it is widest, metres; `None` without a map, and where a
    /// map has no finite width.
    pub fn texel_m(&self, p_world: DVec3, way: DVec3) -> Option<f64> {
        let map = self.map_of(p_world)?;
        let texel_m = 1.0 / texels_per_metre(map, p_world.as_vec3(), way.as_vec3()).least;
        (texel_m.is_finite() && texel_m > 0.0).then_some(texel_m)
    }

    /// The reach around a surface, across the ray of light `way`, metres; 0 without a map.
    pub fn across_light_m(&self, p_world: DVec3, way: DVec3) -> f64 {
        self.texel_m(p_world, way).map_or(0.0, |texel_m| self.texels * texel_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec3, UVec2, Vec3};
    use umbrage_render::umbrage::core::fit::{FitOptions, fit};
    use umbrage_render::umbrage::core::{Aabb, Camera, Light, LightKind, Projection};

    /// The ground from straight above, a pixel a metre, and a sun so high above the horizon.
    fn reach(elevation_rad: f32, filter_texel: f32) -> (f32, f32) {
        let camera = Camera {
            projection: Projection::Orthographic { half_height_m: 8.0 },
            ..Camera::look_at(Vec3::Y * 9.0, Vec3::ZERO, 1.0, 0.1, 20.0)
        };
        let seen = Seen { p_world: DVec3::new(0.5, 0.0, -0.5), normal_world: Vec3::Y, slot: 0 };
        let surfaces = Surfaces { size: UVec2::splat(16), seen: vec![Some(seen); 256], camera, rays: 0 };
        let toward = Vec3::new(elevation_rad.cos(), elevation_rad.sin(), 0.0);
        let sun = Light { kind: LightKind::Directional, ..Light::default() }.aimed(toward * 30.0, Vec3::ZERO);
        let bounds = [Aabb { min: Vec3::splat(-20.0), max: Vec3::splat(20.0) }];
        let view =
            fit(&sun, &bounds, &FitOptions { size_texel: 4, ..FitOptions::default() }).expect("a view");
        (Reach::new(&[view], 4, filter_texel).px(&surfaces)[0], view.texel_m)
    }

    #[test]
    fn a_texel_is_as_long_as_its_shadow_on_the_surface() {
        let (above, texel_m) = reach(std::f32::consts::FRAC_PI_2, 1.0);
        assert!(texel_m > 4.0 && (above - 2.0 * texel_m).abs() < 1e-2 * above, "{above} {texel_m}");
        let (low, texel_m) = reach(0.3, 1.0);
        assert!((low - 2.0 * texel_m / 0.3f32.sin()).abs() < 1e-2 * low, "{low} {texel_m}");
        let (wide, _) = reach(0.3, 3.0);
        assert!((wide - 2.0 * low).abs() < 1e-3 * wide, "{wide} {low}");
        assert!(reach(0.0, 1.0).0 > 1e5);
    }

    #[test]
    fn a_texel_is_as_wide_across_the_light_as_its_view_says() {
        let sun =
            Light { kind: LightKind::Directional, ..Light::default() }.aimed(Vec3::Y * 30.0, Vec3::ZERO);
        let bounds = [Aabb { min: Vec3::splat(-20.0), max: Vec3::splat(20.0) }];
        let view =
            fit(&sun, &bounds, &FitOptions { size_texel: 4, ..FitOptions::default() }).expect("a view");
        let found = Reach::new(&[view], 4, 3.0).texel_m(DVec3::ZERO, DVec3::Y).expect("a map");
        assert!((found - f64::from(view.texel_m)).abs() < 1e-4 * found, "{found} {}", view.texel_m);
        assert_eq!(Reach::new(&[], 0, 0.0).texel_m(DVec3::ZERO, DVec3::Y), None);
    }
}
