//! Axis-aligned boxes.

use glam::{Mat4, Vec3};

/// An axis-aligned box. An empty one has `min > max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Smallest corner.
    pub min: Vec3,
    /// Largest corner.
    pub max: Vec3,
}

impl Default for Aabb {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl Aabb {
    /// Holds nothing; joins as the neutral element.
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// The smallest box around points. Points that are not finite are passed over.
    pub fn from_points(points: impl IntoIterator<Item = Vec3>) -> Self {
        points
            .into_iter()
            .filter(|p| p.is_finite())
            .fold(Self::EMPTY, |b, p| Self { min: b.min.min(p), max: b.max.max(p) })
    }

    /// Does it hold nothing?
    pub fn is_empty(&self) -> bool {
        self.min.cmpgt(self.max).any()
    }

    /// The smallest box around both.
    pub fn union(&self, other: &Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The middle; the origin when empty.
    pub fn center(&self) -> Vec3 {
        if self.is_empty() { Vec3::ZERO } else { 0.5 * (self.min + self.max) }
    }

    /// Edge lengths; zero when empty.
    pub fn size(&self) -> Vec3 {
        if self.is_empty() { Vec3::ZERO } else { self.max - self.min }
    }

    /// Radius of the sphere around the box.
    pub fn radius(&self) -> f32 {
        0.5 * self.size().length()
    }

    /// The eight corners.
    pub fn corners(&self) -> [Vec3; 8] {
        std::array::from_fn(|i| {
            Vec3::new(
                if i & 1 == 0 { self.min.x } else { self.max.x },
                if i & 2 == 0 { self.min.y } else { self.max.y },
                if i & 4 == 0 { self.min.z } else { self.max.z },
            )
        })
    }

    /// The box around this box after an affine transform.
    pub fn transformed(&self, to_from_here: &Mat4) -> Self {
        if self.is_empty() {
            return *self;
        }
        Self::from_points(self.corners().map(|p| to_from_here.transform_point3(p)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn empty_is_neutral_and_stays_empty() {
        let unit = Aabb { min: Vec3::ZERO, max: Vec3::ONE };
        assert_eq!(Aabb::EMPTY.union(&unit), unit);
        assert!(Aabb::EMPTY.transformed(&Mat4::from_scale(Vec3::splat(2.0))).is_empty());
        assert_eq!(Aabb::EMPTY.radius(), 0.0);
    }

    #[test]
    fn points_that_are_not_finite_are_passed_over() {
        let points = [Vec3::ZERO, Vec3::splat(f32::NAN), Vec3::ONE, Vec3::splat(f32::INFINITY)];
        assert_eq!(Aabb::from_points(points), Aabb { min: Vec3::ZERO, max: Vec3::ONE });
    }
}
