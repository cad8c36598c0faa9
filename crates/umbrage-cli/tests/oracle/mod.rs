//! Where the page of `docs/guide/webgpu.html` has shadow, by rays: knows its scene, and nothing of maps, matrices or WGSL.

use glam::DVec3;
use serde::Deserialize;
use serde_json::Value;

/// What the page says that it draws.
#[derive(Deserialize)]
pub struct Scene {
    eye: Looking,
    light: Looking,
    boxes: Vec<Solid>,
    torus: Torus,
}

/// Something that looks from one place to another.
#[derive(Deserialize)]
struct Looking {
    from: Place,
    to: Place,
    /// Tangent of half the angle from bottom to top.
    tan: f64,
}

#[derive(Deserialize)]
struct Solid {
    at: Place,
    half: Place,
    /// Around Y, radians.
    turn: f64,
}

#[derive(Deserialize)]
struct Torus {
    at: Place,
    wide: f64,
    thick: f64,
}

/// World space, metres.
type Place = [f64; 3];

/// A point that a ray meets first.
struct Hit {
    object: usize,
    distance: f64,
    normal: DVec3,
}

/// The light at a pixel's centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sight {
    /// No surface, or one that the light does not reach for another reason than a shadow, or hardly.
    Other,
    /// Of this object.
    Lit(usize),
    /// Of this object.
    Shadow(usize),
}

impl Scene {
    /// What the page's own variables hold.
    pub fn new(said: Value) -> Self {
        serde_json::from_value(said).expect("the page's scene")
    }

    /// What is seen at a place of the picture, in pixels from its upper left corner.
    pub fn sight(&self, x: f64, y: f64, width: f64, height: f64) -> Sight {
        let from = DVec3::from(self.eye.from);
        let forward = (DVec3::from(self.eye.to) - from).normalize();
        let right = forward.cross(DVec3::Y).normalize();
        let up = right.cross(forward);
        let across = (2.0 * x - width) / height * self.eye.tan;
        let down = (2.0 * y / height - 1.0) * self.eye.tan;
        let way = (forward + right * across - up * down).normalize();
        let Some(hit) = self.first(from, way, f64::INFINITY) else { return Sight::Other };
        let p = from + way * hit.distance;
        let light = DVec3::from(self.light.from);
        let axis = (DVec3::from(self.light.to) - light).normalize();
        let to_light = (light - p).normalize();
        let cone = -to_light.dot(axis) > self.light.tan.atan().cos();
        if !cone || hit.normal.dot(to_light) < 0.25 {
            return Sight::Other;
        }
        let start = p + hit.normal * 1e-3;
        match self.first(start, to_light, start.distance(light)) {
            None => Sight::Lit(hit.object),
            Some(_) => Sight::Shadow(hit.object),
        }
    }

    fn first(&self, from: DVec3, way: DVec3, most: f64) -> Option<Hit> {
        let boxes = self.boxes.iter().enumerate().filter_map(|(i, solid)| {
            let (distance, normal) = solid.first(from, way)?;
            Some(Hit { object: i, distance, normal })
        });
        let torus = self.torus.first(from, way).map(|(distance, normal)| Hit {
            object: self.boxes.len(),
            distance,
            normal,
        });
        boxes.chain(torus).filter(|hit| hit.distance < most).min_by(|a, b| a.distance.total_cmp(&b.distance))
    }
}

impl Solid {
    /// Three pairs of planes (Kay and Kajiya 1986).
    fn first(&self, from: DVec3, way: DVec3) -> Option<(f64, DVec3)> {
        let turn = |angle: f64, p: DVec3| glam::DQuat::from_rotation_y(angle) * p;
        let (p, d) = (turn(-self.turn, from - DVec3::from(self.at)), turn(-self.turn, way));
        let half = DVec3::from(self.half);
        let (mut enter, mut leave, mut axis) = (0.0, f64::INFINITY, None);
        for i in 0..3 {
            let (a, b) = ((-half[i] - p[i]) / d[i], (half[i] - p[i]) / d[i]);
            if a.min(b) > enter {
                (enter, axis) = (a.min(b), Some(i));
            }
            leave = a.max(b).min(leave);
        }
        let axis = axis.filter(|_| enter < leave)?;
        let mut normal = DVec3::ZERO;
        normal[axis] = -d[axis].signum();
        Some((enter, turn(self.turn, normal)))
    }
}

impl Torus {
    /// How far the surface is, at most: steps of that length never go through it (Hart 1996, "Sphere Tracing").
    fn distance(&self, p: DVec3) -> f64 {
        (p.x.hypot(p.y) - self.wide).hypot(p.z) - self.thick
    }

    fn first(&self, from: DVec3, way: DVec3) -> Option<(f64, DVec3)> {
        let from = from - DVec3::from(self.at);
        let mut gone = 0.0;
        while gone < 30.0 {
            let p = from + way * gone;
            let step = self.distance(p);
            if step < 1e-5 {
                let ring = p.with_z(0.0).normalize() * self.wide;
                return Some((gone, (p - ring).normalize()));
            }
            gone += step;
        }
        None
    }
}
