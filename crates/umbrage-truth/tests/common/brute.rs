//! The oracle: visibility by rays in double precision, every triangle tried. It shares nothing with fits, maps or WGSL.

use glam::DVec3;
use umbrage_core::{Camera, Light, LightKind, Projection};
use umbrage_scene::Scene;

struct Triangle {
    a: DVec3,
    ab: DVec3,
    ac: DVec3,
    double_sided: bool,
}

struct Block {
    min: DVec3,
    max: DVec3,
    triangles: Vec<Triangle>,
}

/// A scene for rays: one block of triangles an instance, with a box around it.
pub struct Rays {
    blocks: Vec<Block>,
}

/// What the eye sees in a pixel.
pub struct Seen {
    pub p_world: DVec3,
    /// Unit length, towards the eye.
    pub normal: DVec3,
}

impl Rays {
    pub fn new(scene: &Scene) -> Self {
        let block = |instance: &umbrage_scene::Instance| {
            let mesh = &scene.meshes[instance.mesh];
            let world_from_object = instance.world_from_object.as_dmat4();
            let corner = |i: u32| world_from_object.transform_point3(mesh.positions[i as usize].as_dvec3());
            let double_sided = scene.materials[mesh.material].double_sided;
            let triangles: Vec<Triangle> = mesh
                .indices
                .chunks_exact(3)
                .map(|t| {
                    let [a, b, c] = [t[0], t[1], t[2]].map(corner);
                    Triangle { a, ab: b - a, ac: c - a, double_sided }
                })
                .collect();
            let all = || triangles.iter().flat_map(|t| [t.a, t.a + t.ab, t.a + t.ac]);
            let min = all().fold(DVec3::INFINITY, DVec3::min) - 1e-9;
            let max = all().fold(DVec3::NEG_INFINITY, DVec3::max) + 1e-9;
            Block { min, max, triangles }
        };
        Self { blocks: scene.instances.iter().map(block).collect() }
    }

    /// The nearest hit with `least < t < most`; `from_eye`: back faces of single-sided surfaces are looked through.
    fn nearest(
        &self,
        origin: DVec3,
        way: DVec3,
        least: f64,
        most: f64,
        from_eye: bool,
    ) -> Option<(f64, DVec3)> {
        let mut best: Option<(f64, DVec3)> = None;
        for block in &self.blocks {
            let farthest = best.map_or(most, |b| b.0);
            let (to_min, to_max) = ((block.min - origin) / way, (block.max - origin) / way);
            let (enter, leave) = (to_min.min(to_max).max_element(), to_min.max(to_max).min_element());
            if enter > leave || leave < least || enter > farthest {
                continue;
            }
            for triangle in &block.triangles {
                let farthest = best.map_or(most, |b| b.0);
                if let Some(t) = hit(triangle, origin, way, from_eye).filter(|t| *t > least && *t < farthest)
                {
                    best = Some((t, triangle.ab.cross(triangle.ac).normalize()));
                }
            }
        }
        best
    }

    /// What the centre of a pixel of a square picture shows.
    pub fn see(&self, camera: &Camera, x: u32, y: u32, side: u32) -> Option<Seen> {
        let Projection::Perspective { fov_y_rad } = camera.projection else { panic!("a pin-hole") };
        let back = -camera.direction_world.as_dvec3().normalize();
        let right = camera.up_world.as_dvec3().cross(back).normalize();
        let up = back.cross(right);
        let tan = (0.5 * f64::from(fov_y_rad)).tan();
        let on_picture = |i: u32| (f64::from(i) + 0.5) / f64::from(side) * 2.0 - 1.0;
        let way = (-back + right * (tan * on_picture(x)) - up * (tan * on_picture(y))).normalize();
        let origin = camera.position_world.as_dvec3();
        let (t, normal) = self.nearest(origin, way, 0.0, f64::INFINITY, true)?;
        Some(Seen { p_world: origin + way * t, normal: if normal.dot(way) > 0.0 { -normal } else { normal } })
    }

    /// Does the light reach the surface? `None` where the surface faces away from it.
    pub fn lit(&self, light: &Light, seen: &Seen) -> Option<bool> {
        let (to_light, distance) = match light.kind {
            LightKind::Directional => (-light.direction_world.as_dvec3(), f64::INFINITY),
            _ => {
                let offset = light.position_world.as_dvec3() - seen.p_world;
                (offset.normalize(), offset.length())
            }
        };
        if seen.normal.dot(to_light) <= 0.0 {
            return None;
        }
        if let LightKind::Spot { outer_rad, .. } = light.kind
            && (-to_light).dot(light.direction_world.as_dvec3().normalize()) < f64::from(outer_rad).cos()
        {
            return Some(false);
        }
        // Off the surface by what single-precision vertices may be off.
        let size = self.blocks.iter().map(|b| (b.max - b.min).length()).fold(0.0, f64::max);
        let origin = seen.p_world + seen.normal * (size * 2e-7);
        Some(self.nearest(origin, to_light, 0.0, distance, false).is_none())
    }
}

fn hit(triangle: &Triangle, origin: DVec3, way: DVec3, from_eye: bool) -> Option<f64> {
    // Moeller and Trumbore 1997.
    let p = way.cross(triangle.ac);
    let det = triangle.ab.dot(p);
    if det == 0.0 || (from_eye && !triangle.double_sided && det < 0.0) {
        return None;
    }
    let s = origin - triangle.a;
    let u = s.dot(p) / det;
    let q = s.cross(triangle.ab);
    let v = way.dot(q) / det;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0).then(|| triangle.ac.dot(q) / det)
}

/// Truth of a picture: V for each pixel, `None` where nothing is seen or the surface faces away.
pub fn truth(scene: &Scene, light: &Light, side: u32) -> Vec<Option<bool>> {
    let rays = Rays::new(scene);
    let camera = &scene.cameras[0].camera;
    let row = |y: u32| {
        (0..side)
            .map(|x| rays.see(camera, x, y, side).and_then(|seen| rays.lit(light, &seen)))
            .collect::<Vec<_>>()
    };
    let half = side / 2;
    let rows = std::thread::scope(|scope| {
        let below = scope.spawn(|| (half..side).flat_map(row).collect::<Vec<_>>());
        let mut all: Vec<_> = (0..half).flat_map(row).collect();
        all.extend(below.join().expect("rays"));
        all
    });
    assert_eq!(rows.len(), (side * side) as usize);
    rows
}
