//! Edges of shadows that the picture does not show: behind what stands in front, or between two pixels' centres.
//!
//! The edge band is drawn where V* changes between pixels. A change that no pixel shows is as much beyond a technique's means.
//! So before a sure pixel is called wrong, the light's own view around it is looked at, with rays, as far as the technique
//! reaches: where that view is continuous, as at a crease between two lit surfaces, there is no edge and the error stands.

use crate::hierarchy::{Ray, Rays, Stack};
use crate::packet::LANES;
use crate::{Emitter, Seen};
use glam::{DVec3, Vec3};

/// Lines outward from a pixel's ray of light, and steps along each.
const LINES: u32 = 24;
const STEPS: u32 = 12;
/// How often a step is halved to tell a steep surface from two: 2^-24 of it then separates both sides.
const HALVINGS: u32 = 24;
/// A jump of distance counts from this share of the reach on.
const LEAST_JUMP: f64 = 0.01;

/// The rays of light around the one that meets a surface.
struct LightsView<'a> {
    seen: &'a Seen,
    /// To the light.
    way: DVec3,
    distance_m: f64,
    right: DVec3,
    up: DVec3,
}

impl<'a> LightsView<'a> {
    fn new(rays: &Rays<'_>, emitter: &Emitter, seen: &'a Seen) -> Self {
        let to = emitter.center(seen.p_world);
        let (right, up) = to.way.any_orthonormal_pair();
        // Parallel light comes from beyond everything.
        let distance_m = if to.distance_m.is_finite() { to.distance_m } else { -2.0 * rays.extent_m() };
        Self { seen, way: to.way, distance_m, right, up }
    }

    /// Where a ray of light beside the surface's own crosses the plane through it that faces the light.
    fn beside(&self, line: u32, distance_m: f64) -> DVec3 {
        let angle = std::f64::consts::TAU * f64::from(line) / f64::from(LINES);
        self.seen.p_world + (self.right * angle.cos() + self.up * angle.sin()) * distance_m
    }

    /// The ray from the light through such a place.
    fn ray(&self, through: DVec3) -> Ray {
        let origin_world = if self.distance_m > 0.0 {
            self.seen.p_world + self.way * self.distance_m
        } else {
            through - self.way * self.distance_m
        };
        let way = (through - origin_world).normalize();
        Ray { origin_world, way, from_m: 0.0, to_m: f64::INFINITY }
    }
}

/// Does V* change within `reach_m` of a surface, measured across the ray of light, though no pixel may show it? `is_lit`: the
/// surface itself is.
pub fn hides_change(
    rays: &Rays<'_>,
    emitter: &Emitter,
    seen: &Seen,
    is_lit: bool,
    reach_m: f64,
    stack: &mut Stack,
) -> bool {
    let view = LightsView::new(rays, emitter, seen);
    if is_lit {
        (0..LINES).any(|line| meets_silhouette(rays, &view, line, reach_m, stack))
    } else {
        is_lit_beside(rays, emitter, &view, reach_m, stack)
    }
}

/// Along a line of the light's view: does what it sees jump?
fn meets_silhouette(
    rays: &Rays<'_>,
    view: &LightsView<'_>,
    line: u32,
    reach_m: f64,
    stack: &mut Stack,
) -> bool {
    let least_m = LEAST_JUMP * reach_m;
    let mut depth_m = |distance_m: f64| {
        let ray = view.ray(view.beside(line, distance_m));
        rays.blocker(&ray, stack).map_or(f64::INFINITY, |found| found.distance_m)
    };
    let jump_m = |a: f64, b: f64| if a == b { 0.0 } else { (a - b).abs() };
    let mut last = (0.0, depth_m(0.0));
    for step in 1..=STEPS {
        let at = reach_m * f64::from(step) / f64::from(STEPS);
        let here = (at, depth_m(at));
        let (mut from, mut to) = (last, here);
        for _ in 0..HALVINGS {
            if jump_m(from.1, to.1) <= least_m {
                break;
            }
            let middle = 0.5 * (from.0 + to.0);
            let between = (middle, depth_m(middle));
            if jump_m(from.1, between.1) >= jump_m(between.1, to.1) {
                to = between;
            } else {
                from = between;
            }
        }
        if jump_m(from.1, to.1) > least_m {
            return true;
        }
        last = here;
    }
    false
}

/// Does light reach the plane of a dark surface somewhere beside it?
fn is_lit_beside(
    rays: &Rays<'_>,
    emitter: &Emitter,
    view: &LightsView<'_>,
    reach_m: f64,
    stack: &mut Stack,
) -> bool {
    let normal = view.seen.normal_world.as_dvec3();
    let on_plane = |through: DVec3| {
        let ray = view.ray(through);
        let slant = ray.way.dot(normal);
        let along_m = (view.seen.p_world - ray.origin_world).dot(normal) / slant;
        (slant < 0.0 && along_m.is_finite()).then(|| ray.origin_world + ray.way * along_m)
    };
    let places: Vec<DVec3> = (0..LINES)
        .flat_map(|line| (1..=STEPS).map(move |step| (line, reach_m * f64::from(step) / f64::from(STEPS))))
        .filter_map(|(line, at)| on_plane(view.beside(line, at)))
        .collect();
    places.chunks(LANES).any(|places| {
        let to_light = |p: &DVec3| {
            let origin_world = *p + normal * rays.offset_m();
            let to = emitter.center(origin_world);
            Ray { origin_world, way: to.way, from_m: 0.0, to_m: to.distance_m - rays.offset_m() }
        };
        let list: Vec<Ray> = places.iter().map(to_light).collect();
        rays.light_through(&list, stack)[..list.len()].iter().any(|v| *v != Vec3::ZERO)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use umbrage_core::Light;
    use umbrage_scene::{Instance, Material, Mesh, Scene};

    /// A floor, and a wall of 1 m that stands on it at x = 0 or floats above it; light comes from the left and from above.
    fn scene(floats_m: f32) -> (Scene, Light) {
        let quad = |corners: [Vec3; 4]| Mesh {
            positions: corners.to_vec(),
            normals: vec![Vec3::Y; 4],
            indices: vec![0, 1, 2, 0, 2, 3],
            bounds: umbrage_core::Aabb::from_points(corners),
            ..Mesh::default()
        };
        let at = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
        let floor = quad([at(-5.0, 0.0, 5.0), at(5.0, 0.0, 5.0), at(5.0, 0.0, -5.0), at(-5.0, 0.0, -5.0)]);
        let (low, high) = (floats_m, floats_m + 1.0);
        let wall = quad([at(0.0, low, 5.0), at(0.0, high, 5.0), at(0.0, high, -5.0), at(0.0, low, -5.0)]);
        let instance = |mesh| Instance { mesh, object: mesh as u32, ..Instance::default() };
        let scene = Scene {
            meshes: vec![floor, wall],
            instances: vec![instance(0), instance(1)],
            materials: vec![Material { double_sided: true, ..Material::default() }],
            ..Scene::default()
        };
        (scene, Light::spot(at(-4.0, 4.0, 0.0), Vec3::ZERO, 0.3, 0.5))
    }

    fn hides(floats_m: f32, x: f32, reach_m: f64) -> bool {
        let (scene, light) = scene(floats_m);
        let rays = Rays::new(&scene).expect("two quads");
        let seen = Seen { p_world: DVec3::new(x.into(), 0.0, 0.0), normal_world: Vec3::Y, slot: 0 };
        let emitter = Emitter::new(&light);
        let mut stack = Stack::default();
        let to = emitter.center(seen.p_world);
        let ray = Ray {
            origin_world: seen.p_world + DVec3::Y * rays.offset_m(),
            way: to.way,
            from_m: 0.0,
            to_m: to.distance_m,
        };
        let lit = rays.light_through(&[ray], &mut stack)[0] != Vec3::ZERO;
        hides_change(&rays, &emitter, &seen, lit, reach_m, &mut stack)
    }

    #[test]
    fn a_crease_between_lit_surfaces_hides_nothing() {
        assert!(!hides(0.0, -0.1, 0.3), "the floor before the foot of a wall that stands on it");
    }

    #[test]
    fn a_floating_edge_hides_a_shadow_s_edge_within_reach_only() {
        // The wall's lower edge throws its shadow's edge to x = 0.5 * 4 / 3.5 - ... : before it the floor is lit.
        assert!(hides(0.5, 0.4, 0.5) && !hides(0.5, -1.5, 0.3));
    }

    #[test]
    fn what_is_dark_next_to_light_is_unsure_and_deep_shadow_is_not() {
        assert!(hides(0.0, 0.05, 0.3), "behind the wall's foot the floor before it is lit");
        assert!(!hides(0.0, 0.6, 0.1), "in the middle of the wall's shadow");
    }
}
