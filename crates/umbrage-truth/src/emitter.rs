//! The shining surface of a light, sampled: where rays to it end.

use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};
use umbrage_core::{Light, LightKind, LightShape};

/// A light as rays see it.
#[derive(Clone, Copy, Debug)]
pub struct Emitter {
    shape: LightShape,
    parallel: bool,
    position_world: DVec3,
    /// Where its light travels to, and two axes across; unit length.
    direction: DVec3,
    right: DVec3,
    up: DVec3,
    /// Cosine of the cone's half angle; -1 without a cone.
    cos_outer: f64,
    range_m: f64,
}

/// A way to a point of the light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToLight {
    /// Unit length.
    pub way: DVec3,
    /// Metres; infinite for parallel light.
    pub distance_m: f64,
}

impl Emitter {
    /// Of a light whose numbers were checked.
    pub fn new(light: &Light) -> Self {
        let axes = light.world_from_light_rotation().as_dmat3();
        let cos_outer = match light.kind {
            LightKind::Spot { outer_rad, .. } => f64::from(outer_rad).cos(),
            _ => -1.0,
        };
        Self {
            shape: light.shape,
            parallel: light.kind == LightKind::Directional,
            position_world: light.position_world.as_dvec3(),
            direction: -axes.z_axis,
            right: axes.x_axis,
            up: axes.y_axis,
            cos_outer,
            range_m: light.range_m.map_or(f64::INFINITY, f64::from),
        }
    }

    /// Is it a mathematical point, so that one ray says it all?
    pub fn is_point(&self) -> bool {
        self.shape == LightShape::Point
    }

    /// The way to the light's middle.
    pub fn center(&self, p_world: DVec3) -> ToLight {
        if self.parallel {
            return ToLight { way: -self.direction, distance_m: f64::INFINITY };
        }
        towards(p_world, self.position_world)
    }

    /// Does the light shine on a place, were nothing in the way? Not outside its cone, not beyond its range.
    pub fn shines_on(&self, p_world: DVec3) -> bool {
        let center = self.center(p_world);
        -center.way.dot(self.direction) >= self.cos_outer
            && (self.parallel || center.distance_m <= self.range_m)
    }

    /// The way to the point of the light that `square`, in 0..1 twice, names. Points of equal area of the square are
    /// points of equal area of a disc or rectangle, and of equal solid angle of a sphere or sun.
    pub fn sample(&self, p_world: DVec3, square: DVec2) -> ToLight {
        match self.shape {
            LightShape::Point => self.center(p_world),
            LightShape::Disc { radius_m } => {
                let place = disc(square) * f64::from(radius_m);
                towards(p_world, self.position_world + self.right * place.x + self.up * place.y)
            }
            LightShape::Rectangle { width_m, height_m } => {
                let place = (square - 0.5) * DVec2::new(width_m.into(), height_m.into());
                towards(p_world, self.position_world + self.right * place.x + self.up * place.y)
            }
            LightShape::Sphere { radius_m } => {
                let center = self.center(p_world);
                let radius_m = f64::from(radius_m);
                let sin = radius_m / center.distance_m;
                if sin.is_nan() || sin >= 1.0 {
                    return center; // Inside of the light there is no shadow's side.
                }
                let way = cone(center.way, (1.0 - sin * sin).sqrt(), square);
                // Up to the sphere's near side.
                let along = center.distance_m * way.dot(center.way);
                let across2 = center.distance_m * center.distance_m - along * along;
                let distance_m = along - (radius_m * radius_m - across2).max(0.0).sqrt();
                ToLight { way, distance_m }
            }
            LightShape::Sun { angle_rad } => {
                let way = cone(-self.direction, (0.5 * f64::from(angle_rad)).cos(), square);
                ToLight { way, distance_m: f64::INFINITY }
            }
        }
    }
}

fn towards(from: DVec3, to: DVec3) -> ToLight {
    let offset = to - from;
    let distance_m = offset.length();
    ToLight { way: if distance_m > 0.0 { offset / distance_m } else { DVec3::Y }, distance_m }
}

/// Square to unit disc (Shirley and Chiu 1997, "A Low Distortion Map Between Disk and Square").
fn disc(square: DVec2) -> DVec2 {
    let p = square * 2.0 - 1.0;
    if p == DVec2::ZERO {
        return p;
    }
    let (radius, angle) = if p.x.abs() > p.y.abs() {
        (p.x, FRAC_PI_4 * (p.y / p.x))
    } else {
        (p.y, FRAC_PI_2 - FRAC_PI_4 * (p.x / p.y))
    };
    DVec2::from_angle(angle) * radius
}

/// A direction in the cone around `axis`, evenly by solid angle.
fn cone(axis: DVec3, cos: f64, square: DVec2) -> DVec3 {
    // The disc's map keeps neighbours together, which stratification needs.
    let place = disc(square);
    let share = place.length_squared().min(1.0);
    let z = 1.0 - share * (1.0 - cos);
    let across = (1.0 - z * z).max(0.0).sqrt();
    let (right, up) = axis.any_orthonormal_pair();
    let turn = if share > 0.0 { place / share.sqrt() } else { DVec2::ZERO };
    (axis * z + (right * turn.x + up * turn.y) * across).normalize()
}

/// The share of a light's points, projected on a line across the way to it, that lies below a given one: what the
/// profile of a straight edge's penumbra is made of. Returns the width between the shares 0.1 and 0.9, metres at the
/// light's distance (radians for a sun), for points projected on `axis_world`.
pub fn spread_10_90(emitter: &Emitter, p_world: DVec3, axis_world: DVec3) -> f64 {
    const SIDE: u32 = 48;
    let center = emitter.center(p_world);
    let reach = if center.distance_m.is_finite() { center.distance_m } else { 1.0 };
    let mut places: Vec<f64> = (0..SIDE * SIDE)
        .map(|i| {
            let square = DVec2::new(f64::from(i % SIDE) + 0.5, f64::from(i / SIDE) + 0.5) / f64::from(SIDE);
            let way = emitter.sample(p_world, square).way;
            // Onto the plane across the way to the middle, as the edge's shadow is cast.
            (way * (reach / way.dot(center.way))).dot(axis_world)
        })
        .collect();
    places.sort_by(f64::total_cmp);
    let at = |share: f64| places[(share * (places.len() - 1) as f64).round() as usize];
    at(0.9) - at(0.1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn light(shape: LightShape) -> Light {
        let kind =
            if matches!(shape, LightShape::Sun { .. }) { LightKind::Directional } else { LightKind::Point };
        Light { kind, shape, ..Light::default() }.aimed(Vec3::new(1.0, 5.0, 2.0), Vec3::ZERO)
    }

    fn grid() -> impl Iterator<Item = DVec2> {
        (0..32 * 32).map(|i| DVec2::new(f64::from(i % 32) + 0.5, f64::from(i / 32) + 0.5) / 32.0)
    }

    #[test]
    fn samples_lie_on_the_light_and_around_its_middle() {
        let at = DVec3::new(0.3, -0.2, 0.5);
        for shape in [
            LightShape::Point,
            LightShape::Sphere { radius_m: 0.5 },
            LightShape::Disc { radius_m: 0.5 },
            LightShape::Rectangle { width_m: 1.0, height_m: 0.4 },
        ] {
            let light = light(shape);
            let emitter = Emitter::new(&light);
            let middle = light.position_world.as_dvec3();
            let mut sum = DVec3::ZERO;
            for square in grid() {
                let to = emitter.sample(at, square);
                let p = at + to.way * to.distance_m;
                assert!((to.way.length() - 1.0).abs() < 1e-12);
                assert!(p.distance(middle) <= f64::from(shape.bounding_radius_m()) + 1e-9, "{shape:?}");
                if let LightShape::Sphere { radius_m } = shape {
                    assert!((p.distance(middle) - f64::from(radius_m)).abs() < 1e-9);
                }
                sum += to.way;
            }
            assert!(sum.normalize().dot(emitter.center(at).way) > 0.99999, "{shape:?}");
        }
    }

    #[test]
    fn a_sun_is_as_wide_as_it_says() {
        let emitter = Emitter::new(&light(LightShape::Sun { angle_rad: 0.2 }));
        let way = emitter.center(DVec3::ZERO).way;
        let angles: Vec<f64> =
            grid().map(|s| emitter.sample(DVec3::ZERO, s).way.angle_between(way)).collect();
        let widest = angles.iter().copied().fold(0.0, f64::max);
        assert!(widest < 0.1 && widest > 0.095, "{widest}");
        // Of the solid angle, the square of three quarters lies within three quarters of the angle.
        let inner = angles.iter().filter(|a| **a < 0.1 * 0.75).count();
        assert!((inner as f64 / angles.len() as f64 - 0.5625).abs() < 0.01, "{inner}");
    }

    #[test]
    fn the_spread_of_a_square_is_linear_and_that_of_a_disc_is_a_chord_s() {
        let axis = DVec3::X;
        let shine = |shape| {
            let light = Light { kind: LightKind::Point, shape, ..Light::default() };
            let light = Light { up_world: Vec3::NEG_Z, ..light.aimed(Vec3::Y * 4.0, Vec3::ZERO) };
            spread_10_90(&Emitter::new(&light), DVec3::ZERO, axis)
        };
        let square = shine(LightShape::Rectangle { width_m: 1.0, height_m: 1.0 });
        assert!((square - 0.8).abs() < 0.03, "{square}");
        // A chord at 0.687 radii from the middle cuts a tenth off.
        let disc = shine(LightShape::Disc { radius_m: 1.0 });
        assert!((disc - 2.0 * 0.687).abs() < 0.03, "{disc}");
        assert_eq!(shine(LightShape::Point), 0.0);
    }
}
