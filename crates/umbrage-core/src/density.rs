//! Texels per pixel: how finely a map samples what a picture shows, in closed form.
//!
//! A picture and a map are both projections of the same surface. Near a point the surface is its tangent plane, and both
//! projections are linear there: `A` takes a step on the plane to pixels, `B` takes it to texels. `B * inverse(A)` is then
//! what a step of one pixel is in the map. Its determinant is the number of texels in a pixel; its least singular value
//! is how many texels lie along a pixel's worst direction, and below 1 a texel's edge can be seen. Where eye and light
//! face each other that number varies most: the duelling frusta of Everitt, Rege and Cebenoyan 2001, "Hardware Shadow
//! Mapping". `wgsl/density.wgsl` is the same formula for shaders.

use glam::{DMat2, DMat4, DVec2, DVec3, Mat4, UVec2, Vec3};

/// A projection onto something that has pixels or texels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Raster {
    clip_from_world: DMat4,
    size: DVec2,
}

impl Raster {
    /// The picture or map of `size` pixels or texels that a projection fills.
    pub fn new(clip_from_world: Mat4, size: UVec2) -> Self {
        Self { clip_from_world: clip_from_world.as_dmat4(), size: size.as_dvec2() }
    }

    /// How far a step of a metre along `way_world` from `p_world` goes: pixels or texels, y up. It is the derivative
    /// there, so exact for small steps only. Not finite where `p_world` lies in the plane of the eye.
    pub fn step(&self, p_world: DVec3, way_world: DVec3) -> DVec2 {
        let p = self.clip_from_world * p_world.extend(1.0);
        let d = self.clip_from_world * way_world.extend(0.0);
        // The derivative of x / w.
        (d.truncate().truncate() - p.truncate().truncate() * (d.w / p.w)) / p.w * 0.5 * self.size
    }

    /// Steps of a metre on a plane through `p_world`, along two unit vectors of it that are at right angles.
    fn steps(&self, p_world: DVec3, normal_world: DVec3) -> DMat2 {
        let (right, up) = normal_world.any_orthonormal_pair();
        DMat2::from_cols(self.step(p_world, right), self.step(p_world, up))
    }
}

/// How finely one raster samples another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Density {
    /// Linear mean: the square root of the number of texels in a pixel (or in a square metre).
    pub mean: f64,
    /// Texels along the direction in which there are fewest.
    pub least: f64,
    /// Texels along the direction in which there are most.
    pub most: f64,
}

impl Density {
    /// From the matrix that takes steps in one raster to steps in the other.
    ///
    /// The least singular value is found as determinant by greatest, so it does not lose its digits where the two differ
    /// by much. Numbers that are not finite (a surface edge-on to the eye) count as without bound.
    fn of(texel_from_step: DMat2) -> Self {
        let most = greatest_stretch(texel_from_step);
        let texels = texel_from_step.determinant().abs();
        if !(most.is_finite() && texels.is_finite()) {
            return Self { mean: f64::INFINITY, least: f64::INFINITY, most: f64::INFINITY };
        }
        let least = if most > 0.0 { texels / most } else { 0.0 };
        Self { mean: texels.sqrt(), least, most }
    }
}

/// Texels of `map` in a pixel of `picture`, on a surface with `normal_world` at `p_world`.
///
/// The normal's sign does not count; its length must be 1. Whether map or picture shows the point at all is not asked.
/// Edge-on to the light `least` is 0, edge-on to the eye everything is infinite.
pub fn texels_per_pixel(map: &Raster, picture: &Raster, p_world: DVec3, normal_world: DVec3) -> Density {
    let (px, texel) = (picture.steps(p_world, normal_world), map.steps(p_world, normal_world));
    Density::of(texel * px.inverse())
}

/// Texels of `map` in a metre of a surface with `normal_world` at `p_world`.
pub fn texels_per_metre(map: &Raster, p_world: Vec3, normal_world: Vec3) -> Density {
    Density::of(map.steps(p_world.as_dvec3(), normal_world.as_dvec3()))
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
    use crate::DEPTH;
    use crate::camera::Camera;
    use crate::projection::{orthographic, perspective};
    use proptest::prelude::*;

    #[test]
    fn the_stretch_is_the_greatest_singular_value() {
        let stretches = |m| {
            let d = Density::of(m);
            (d.least, d.mean, d.most)
        };
        let (least, mean, most) = stretches(DMat2::from_diagonal(DVec2::new(2.0, 5.0)));
        assert!((least - 2.0).abs() + (most - 5.0).abs() + (mean - 10f64.sqrt()).abs() < 1e-12);
        let (least, _, most) = stretches(DMat2::from_angle(0.7) * 3.0);
        assert!((least - 3.0).abs() + (most - 3.0).abs() < 1e-12);
        let (least, _, most) = stretches(DMat2::from_cols(DVec2::X, DVec2::ONE));
        let golden = 0.5 * (1.0 + 5f64.sqrt());
        assert!((most - golden).abs() + (least - 1.0 / golden).abs() < 1e-12);
        assert_eq!(Density::of(DMat2::ZERO).least, 0.0);
        assert_eq!(Density::of(DMat2::from_cols(DVec2::NAN, DVec2::X)).least, f64::INFINITY);
    }

    /// Where the ray through a place of the picture (pixels, rows down) meets a plane, by inverting the projection.
    fn cast(clip_from_world: DMat4, size: UVec2, px: DVec2, on_plane: DVec3, normal: DVec3) -> DVec3 {
        let ndc = DVec2::new(px.x, -px.y) / size.as_dvec2() * 2.0 + DVec2::new(-1.0, 1.0);
        let world_from_clip = clip_from_world.inverse();
        let (a, b) = (
            world_from_clip.project_point3(ndc.extend(0.9)),
            world_from_clip.project_point3(ndc.extend(0.1)),
        );
        let way = b - a;
        a + way * ((on_plane - a).dot(normal) / way.dot(normal))
    }

    /// Place in a raster, rows down.
    fn place(clip_from_world: DMat4, size: UVec2, p: DVec3) -> DVec2 {
        let ndc = clip_from_world.project_point3(p);
        (DVec2::new(ndc.x, -ndc.y) * 0.5 + 0.5) * size.as_dvec2()
    }

    proptest! {
        #[test]
        fn rays_through_neighbouring_pixels_agree(
            eye in (-5.0f32..5.0, 1.0f32..4.0, 4.0f32..9.0), light in (-6.0f32..6.0, 3.0f32..9.0, -6.0f32..6.0),
            n in (-0.6f64..0.6, -0.6f64..0.6), p in (-1.0f64..1.0, -1.0f64..1.0, -1.0f64..1.0), parallel in any::<bool>(),
        ) {
            let camera = Camera::look_at(Vec3::from(eye), Vec3::ZERO, 0.8, 0.1, 50.0);
            let picture_size = UVec2::new(640, 360);
            let eye_from_world = camera.clip_from_view(640.0 / 360.0, DEPTH) * camera.view_from_world();
            let map_camera = Camera::look_at(Vec3::from(light), Vec3::ZERO, 0.8, 0.1, 50.0);
            let lens = if parallel { orthographic(4.0, 3.0, 0.1, 50.0, DEPTH) }
                else { perspective(0.6, 0.5, 0.1, 50.0, DEPTH) };
            let map_from_world = lens * map_camera.view_from_world();
            let map_size = UVec2::new(512, 1024);
            let (p, normal) = (DVec3::from(p), DVec3::new(n.0, 1.0, n.1).normalize());
            let to = |v: Vec3| (v.as_dvec3() - p).normalize().dot(normal).abs();
            prop_assume!(to(Vec3::from(eye)) > 0.1 && to(Vec3::from(light)) > 0.1);

            let (map, picture) = (Raster::new(map_from_world, map_size), Raster::new(eye_from_world, picture_size));
            let found = texels_per_pixel(&map, &picture, p, normal);
            // The oracle: rays through places a hundredth of a pixel apart, met with the plane, looked up in the map.
            let (eye64, map64) = (eye_from_world.as_dmat4(), map_from_world.as_dmat4());
            let at = place(eye64, picture_size, p);
            let texel = |d: DVec2| place(map64, map_size, cast(eye64, picture_size, at + d, p, normal));
            let h = 0.01;
            let column = |d: DVec2| (texel(d * h) - texel(d * -h)) / (2.0 * h);
            let by_rays = Density::of(DMat2::from_cols(column(DVec2::X), column(DVec2::Y)));
            for (a, b) in [(found.mean, by_rays.mean), (found.least, by_rays.least), (found.most, by_rays.most)] {
                prop_assert!((a - b).abs() < 1e-3 * b.max(1e-3), "{found:?} {by_rays:?}");
            }
        }
    }

    #[test]
    fn a_surface_seen_by_light_and_eye_alike_has_a_texel_a_pixel() {
        let camera = Camera::look_at(Vec3::new(1.0, 2.0, 5.0), Vec3::ZERO, 0.7, 0.1, 50.0);
        let clip_from_world = camera.clip_from_view(1.0, DEPTH) * camera.view_from_world();
        let raster = |size| Raster::new(clip_from_world, UVec2::splat(size));
        let normal = DVec3::new(0.3, 1.0, 0.4).normalize();
        let density = texels_per_pixel(&raster(512), &raster(256), DVec3::new(0.2, 0.1, 0.0), normal);
        assert!((density.least - 2.0).abs() < 1e-6 && (density.most - 2.0).abs() < 1e-6, "{density:?}");
    }

    #[test]
    fn edges_are_told() {
        let above = Camera::look_at(Vec3::Y * 5.0, Vec3::ZERO, 0.7, 0.1, 50.0);
        let beside = Camera::look_at(Vec3::X * 5.0, Vec3::ZERO, 0.7, 0.1, 50.0);
        let [above, beside] = [above, beside].map(|camera| {
            Raster::new(camera.clip_from_view(1.0, DEPTH) * camera.view_from_world(), UVec2::splat(256))
        });
        // The ground, edge-on to what looks along it.
        let to_light = texels_per_pixel(&beside, &above, DVec3::ZERO, DVec3::Y);
        assert!(to_light.least < 1e-5 && to_light.most > 0.5, "{to_light:?}");
        let to_eye = texels_per_pixel(&above, &beside, DVec3::ZERO, DVec3::Y);
        assert!(to_eye.mean > 1e3, "{to_eye:?}");
        let metre = texels_per_metre(&above, Vec3::ZERO, Vec3::Y);
        assert!((metre.least - 128.0 / (5.0 * 0.35f64.tan())).abs() < 1e-3, "{metre:?}");
    }
}
