//! What a technique cannot resolve, pixel by pixel.

use glam::{DMat2, DMat4, DVec2, DVec3, DVec4};
use umbrage_render::umbrage::core::DEPTH;
use umbrage_render::umbrage::core::fit::ShadowView;
use umbrage_truth::{LEAST_REACH_PX, Seen, Surfaces};

/// How far a technique reaches around each surface.
#[derive(Debug)]
pub struct Reach {
    maps: Vec<Lookup>,
    /// The filter's radius and one texel more.
    texels: f64,
}

impl Reach {
    /// Of maps of `size_texel` drawn in `views`, with a filter of radius `filter_texel`. Of several views, that one counts in
    /// whose middle a surface lies: the tile of a point light. Without a map there is nothing that a texel hides.
    pub fn new(views: &[ShadowView], size_texel: u32, filter_texel: f32) -> Self {
        let map = |view: &ShadowView| Lookup {
            clip_from_world: view.clip_from_world().as_dmat4(),
            size: DVec2::splat(f64::from(size_texel)),
        };
        Self { maps: views.iter().map(map).collect(), texels: f64::from(filter_texel) + 1.0 }
    }

    fn map_of(&self, p_world: DVec3) -> Option<&Lookup> {
        let off_middle = |map: &Lookup| {
            let clip = map.clip_from_world * p_world.extend(1.0);
            if clip.w > 0.0 { (clip.x / clip.w).abs().max((clip.y / clip.w).abs()) } else { f64::INFINITY }
        };
        self.maps.iter().min_by(|a, b| off_middle(a).total_cmp(&off_middle(b)))
    }

    /// Reach of every pixel, pixels: two, or as many as the reach's texels are long on the screen, where a texel's shadow on
    /// the surface is seen at its longest. Infinite where the surface is edge-on to the light.
    pub fn px(&self, surfaces: &Surfaces) -> Vec<f32> {
        let aspect = surfaces.size.x as f32 / surfaces.size.y as f32;
        let camera = &surfaces.camera;
        let clip_from_world = camera.clip_from_view(aspect, DEPTH) * camera.view_from_world();
        let picture = Lookup { clip_from_world: clip_from_world.as_dmat4(), size: surfaces.size.as_dvec2() };
        let reach = |seen: &Option<Seen>| {
            let Some(seen) = seen else { return LEAST_REACH_PX };
            let Some(map) = self.map_of(seen.p_world) else { return LEAST_REACH_PX };
            let px_per_texel = px_per_texel(&picture, map, seen.p_world, seen.normal_world.as_dvec3());
            ((self.texels * px_per_texel) as f32).max(LEAST_REACH_PX)
        };
        surfaces.seen.iter().map(reach).collect()
    }

    /// The reach around a surface, across the ray of light `way`, metres; 0 without a map.
    pub fn across_light_m(&self, p_world: DVec3, way: DVec3) -> f64 {
        let Some(map) = self.map_of(p_world) else { return 0.0 };
        let (right, up) = way.any_orthonormal_pair();
        let m_from_texel = DMat2::from_cols(map.step(p_world, right), map.step(p_world, up)).inverse();
        let length = self.texels * greatest_stretch(m_from_texel);
        if length.is_finite() { length } else { 0.0 }
    }
}

/// A projection onto something that has pixels or texels.
#[derive(Debug)]
struct Lookup {
    clip_from_world: DMat4,
    size: DVec2,
}

impl Lookup {
    /// How far a step of a metre along `way` from `p_world` goes, pixels or texels.
    fn step(&self, p_world: DVec3, way: DVec3) -> DVec2 {
        let p = self.clip_from_world * p_world.extend(1.0);
        let d: DVec4 = self.clip_from_world * way.extend(0.0);
        // The derivative of x / w.
        (d.truncate().truncate() - p.truncate().truncate() * (d.w / p.w)) / p.w * 0.5 * self.size
    }
}

/// Pixels that a texel's shadow on a surface is long, where it is longest.
fn px_per_texel(picture: &Lookup, map: &Lookup, p_world: DVec3, normal_world: DVec3) -> f64 {
    let (right, up) = normal_world.any_orthonormal_pair();
    let steps = |lookup: &Lookup| DMat2::from_cols(lookup.step(p_world, right), lookup.step(p_world, up));
    let px_from_texel = steps(picture) * steps(map).inverse();
    let length = greatest_stretch(px_from_texel);
    if length.is_finite() { length } else { f64::INFINITY }
}

/// The greatest singular value: how long the longest image of a unit vector is.
fn greatest_stretch(m: DMat2) -> f64 {
    let (a, b) = (m.x_axis, m.y_axis);
    let mean = 0.5 * (a.length_squared() + b.length_squared());
    let half = 0.5 * (a.length_squared() - b.length_squared());
    (mean + half.hypot(a.dot(b))).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{UVec2, Vec3};
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
        let view = fit(&sun, &bounds, &FitOptions { size_texel: 4, least_near: 1e-4, border_texel: 0.0 })
            .expect("a view");
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
    fn the_stretch_is_the_greatest_singular_value() {
        assert!((greatest_stretch(DMat2::from_diagonal(DVec2::new(2.0, 5.0))) - 5.0).abs() < 1e-12);
        assert!((greatest_stretch(DMat2::from_angle(0.7) * 3.0) - 3.0).abs() < 1e-12);
        let shear = DMat2::from_cols(DVec2::new(1.0, 0.0), DVec2::new(1.0, 1.0));
        assert!((greatest_stretch(shear) - 0.5 * (1.0 + 5f64.sqrt())).abs() < 1e-12);
    }
}
