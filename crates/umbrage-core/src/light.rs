//! Lights: what shines, where, how far. The names and units follow `KHR_lights_punctual`.

use glam::{Mat3, Vec3};

/// What shape a light throws its light in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// Parallel light that travels along the light's direction. Intensity in lux.
    Directional,
    /// The same in every direction from a place. Intensity in candela.
    Point,
    /// A cone around the light's direction. Intensity in candela.
    Spot {
        /// Angle from the axis up to which the light has its full intensity. Radians, `0 ..= outer_rad`, default 0.
        inner_rad: f32,
        /// Angle from the axis at which the light ends. Radians, above 0 and below `PI / 2`, default `PI / 4`.
        outer_rad: f32,
    },
}

impl LightKind {
    /// `directional`, `point` or `spot`.
    pub fn id(&self) -> &'static str {
        match self {
            Self::Directional => "directional",
            Self::Point => "point",
            Self::Spot { .. } => "spot",
        }
    }
}

/// What shines: the surface that light comes from. A point throws hard shadows, everything else soft ones.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum LightShape {
    /// A mathematical point, or light that is exactly parallel.
    #[default]
    Point,
    /// A sphere around the light's place.
    Sphere {
        /// Metres, above 0.
        radius_m: f32,
    },
    /// A disc across the light's direction.
    Disc {
        /// Metres, above 0.
        radius_m: f32,
    },
    /// A rectangle across the light's direction; its height runs along the light's up.
    Rectangle {
        /// Metres, above 0.
        width_m: f32,
        /// Metres, above 0.
        height_m: f32,
    },
    /// The disc of a sun, as seen from anywhere; for directional lights only.
    Sun {
        /// Across the whole disc, radians, above 0 and below `PI`. That of the real sun is 0.0093 (0.53 degrees).
        angle_rad: f32,
    },
}

impl LightShape {
    /// No point of the shape is farther than this from the light's place. 0 for a point and for a sun.
    pub fn bounding_radius_m(&self) -> f32 {
        match *self {
            Self::Point | Self::Sun { .. } => 0.0,
            Self::Sphere { radius_m } | Self::Disc { radius_m } => radius_m,
            Self::Rectangle { width_m, height_m } => 0.5 * width_m.hypot(height_m),
        }
    }

    /// The same shape with every length multiplied; angles stay.
    pub fn scaled(self, factor: f32) -> Self {
        match self {
            Self::Point | Self::Sun { .. } => self,
            Self::Sphere { radius_m } => Self::Sphere { radius_m: radius_m * factor },
            Self::Disc { radius_m } => Self::Disc { radius_m: radius_m * factor },
            Self::Rectangle { width_m, height_m } => {
                Self::Rectangle { width_m: width_m * factor, height_m: height_m * factor }
            }
        }
    }

    fn check(&self, kind: &LightKind) -> Result<(), LightError> {
        let parallel = *kind == LightKind::Directional;
        let refuse = |what, value: f32, allowed| {
            Err(LightError::OutOfRange { what, value: value.to_string(), allowed })
        };
        let is_length = |x: f32| x.is_finite() && x > 0.0;
        match *self {
            Self::Point => Ok(()),
            Self::Sun { angle_rad } if !(angle_rad > 0.0 && angle_rad < std::f32::consts::PI) => {
                refuse("angle", angle_rad.to_degrees(), "above 0 and below 180 degrees")
            }
            Self::Sun { .. } if parallel => Ok(()),
            Self::Sun { angle_rad } => {
                refuse("angle", angle_rad.to_degrees(), "left out: only a directional light has one")
            }
            Self::Sphere { radius_m } | Self::Disc { radius_m } if !is_length(radius_m) => {
                refuse("radius", radius_m, "finite and above 0")
            }
            Self::Rectangle { width_m, .. } if !is_length(width_m) => {
                refuse("width", width_m, "finite and above 0")
            }
            Self::Rectangle { height_m, .. } if !is_length(height_m) => {
                refuse("height", height_m, "finite and above 0")
            }
            Self::Sphere { radius_m: size } | Self::Disc { radius_m: size } if parallel => {
                refuse("radius", size, "left out: a directional light has an angle instead")
            }
            Self::Rectangle { width_m, .. } if parallel => {
                refuse("width", width_m, "left out: a directional light has an angle instead")
            }
            _ => Ok(()),
        }
    }
}

/// A light in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Shape and cone angles.
    pub kind: LightKind,
    /// Where it is, metres. A directional light has no place; its position is then only where views of it start.
    pub position_world: Vec3,
    /// Where its light travels to; unit length.
    pub direction_world: Vec3,
    /// Which way is up in the light's own image (the roll of its map and cookie); not parallel to the direction.
    pub up_world: Vec3,
    /// Linear RGB, each channel 0 or more. Default white.
    pub color: Vec3,
    /// Candela for point and spot lights, lux for directional ones. 0 or more.
    pub intensity: f32,
    /// Distance at which the light fades to nothing, metres. `None`: it never does.
    pub range_m: Option<f32>,
    /// What shines. Intensity and falloff stay those of the light's middle. Default: a point.
    pub shape: LightShape,
    /// Near plane of the shadow map, metres from the light. `None`: fitted to the casters.
    pub near_m: Option<f32>,
    /// Far plane of the shadow map, metres from the light. `None`: fitted to casters and receivers.
    pub far_m: Option<f32>,
}

impl Default for Light {
    /// A white spot light of 100 cd at the origin, straight down, 45 degrees from axis to edge.
    fn default() -> Self {
        Self {
            kind: LightKind::Spot { inner_rad: 0.0, outer_rad: std::f32::consts::FRAC_PI_4 },
            position_world: Vec3::ZERO,
            direction_world: Vec3::NEG_Y,
            up_world: Vec3::NEG_Z,
            color: Vec3::ONE,
            intensity: 100.0,
            range_m: None,
            shape: LightShape::Point,
            near_m: None,
            far_m: None,
        }
    }
}

/// Why a light cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LightError {
    /// A number that is infinite, not a number, or outside its range.
    #[error("the light's {what} is {value}; it must be {allowed}")]
    OutOfRange {
        /// Which number.
        what: &'static str,
        /// What was handed in.
        value: String,
        /// What would be accepted.
        allowed: &'static str,
    },
}

impl Light {
    /// A spot light at `position_world` that looks at `target_world`.
    pub fn spot(position_world: Vec3, target_world: Vec3, inner_rad: f32, outer_rad: f32) -> Self {
        Self { kind: LightKind::Spot { inner_rad, outer_rad }, ..Self::default() }
            .aimed(position_world, target_world)
    }

    /// The same light, moved to `position_world` and turned to `target_world`, with an up vector that suits.
    /// When both are the same place the direction stays as it was.
    pub fn aimed(self, position_world: Vec3, target_world: Vec3) -> Self {
        let direction_world = (target_world - position_world).try_normalize().unwrap_or(self.direction_world);
        Self { position_world, direction_world, up_world: up_for(direction_world), ..self }
    }

    /// Checks every number.
    ///
    /// # Errors
    /// [`LightError::OutOfRange`] names the first number that is not finite or not in its range.
    pub fn check(&self) -> Result<(), LightError> {
        let refuse = |what, value: String, allowed| Err(LightError::OutOfRange { what, value, allowed });
        if !self.position_world.is_finite() {
            return refuse("position", self.position_world.to_string(), "three finite numbers");
        }
        if !self.direction_world.is_finite() || self.direction_world.length_squared() < 0.25 {
            return refuse("direction", self.direction_world.to_string(), "a unit vector");
        }
        if !self.color.is_finite() || self.color.min_element() < 0.0 {
            return refuse("color", self.color.to_string(), "three finite numbers of 0 or more");
        }
        if !(self.intensity.is_finite() && self.intensity >= 0.0) {
            return refuse("intensity", self.intensity.to_string(), "finite and 0 or more");
        }
        self.shape.check(&self.kind)?;
        for (what, value) in [("range", self.range_m), ("near", self.near_m), ("far", self.far_m)] {
            if let Some(value) = value.filter(|v| !(v.is_finite() && *v > 0.0)) {
                return refuse(what, value.to_string(), "finite and above 0");
            }
        }
        if let (Some(near), Some(far)) = (self.near_m, self.far_m)
            && near >= far
        {
            return refuse("near", near.to_string(), "below far");
        }
        if let LightKind::Spot { inner_rad, outer_rad } = self.kind {
            if !(outer_rad > 0.0 && outer_rad < std::f32::consts::FRAC_PI_2) {
                let degrees = outer_rad.to_degrees();
                return refuse(
                    "outer cone angle",
                    format!("{degrees} degrees"),
                    "above 0 and below 90 degrees",
                );
            }
            if !(inner_rad >= 0.0 && inner_rad <= outer_rad) {
                let degrees = inner_rad.to_degrees();
                return refuse(
                    "inner cone angle",
                    format!("{degrees} degrees"),
                    "between 0 and the outer angle",
                );
            }
        }
        Ok(())
    }

    /// Parallel white light of 1 lux that travels along `direction_world`, of any length.
    pub fn sun(direction_world: Vec3) -> Self {
        let direction_world = direction_world.try_normalize().unwrap_or(Vec3::NEG_Y);
        Self {
            kind: LightKind::Directional,
            direction_world,
            up_world: up_for(direction_world),
            intensity: 1.0,
            ..Self::default()
        }
    }

    /// A white point light of 100 candela at a place, metres.
    pub fn lamp(position_world: Vec3) -> Self {
        Self { kind: LightKind::Point, position_world, ..Self::default() }
    }

    /// The light's own axes as columns: right, up, backwards (the light looks along its own -Z, as cameras do).
    pub fn world_from_light_rotation(&self) -> Mat3 {
        let back = -self.direction_world.normalize();
        let up =
            if self.up_world.cross(back).length_squared() > 1e-8 { self.up_world } else { up_for(-back) };
        let right = up.cross(back).normalize();
        Mat3::from_cols(right, back.cross(right), back)
    }

    /// Illuminance on a surface that faces the light at `distance_m`: lux. Cone, cookie and range are left out.
    pub fn illuminance_lux(&self, distance_m: f32) -> f32 {
        match self.kind {
            LightKind::Directional => self.intensity,
            _ => self.intensity / (distance_m * distance_m).max(f32::MIN_POSITIVE),
        }
    }
}

/// An up vector that is never parallel to `direction`: world Y, or -Z when the direction is within 3 degrees of Y.
pub fn up_for(direction: Vec3) -> Vec3 {
    if direction.y.abs() > 0.998 { Vec3::NEG_Z } else { Vec3::Y }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_right_handed_whatever_the_direction() {
        for direction in [Vec3::X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::new(1.0, -2.0, 0.5).normalize()] {
            let light = Light::default().aimed(Vec3::ZERO, direction * 3.0);
            let axes = light.world_from_light_rotation();
            assert!((axes.determinant() - 1.0).abs() < 1e-5, "{direction}");
            assert!((axes * Vec3::NEG_Z - direction).length() < 1e-5, "{direction}");
        }
    }

    #[test]
    fn each_bad_number_is_named() {
        let good = Light::default();
        assert_eq!(good.check(), Ok(()));
        let spot = |inner_rad, outer_rad| LightKind::Spot { inner_rad, outer_rad };
        for (light, word) in [
            (Light { position_world: Vec3::splat(f32::NAN), ..good }, "position"),
            (Light { direction_world: Vec3::ZERO, ..good }, "direction"),
            (Light { color: Vec3::splat(-1.0), ..good }, "color"),
            (Light { intensity: f32::INFINITY, ..good }, "intensity"),
            (Light { shape: LightShape::Sphere { radius_m: -1.0 }, ..good }, "radius"),
            (Light { shape: LightShape::Disc { radius_m: f32::NAN }, ..good }, "radius"),
            (Light { shape: LightShape::Rectangle { width_m: 1.0, height_m: 0.0 }, ..good }, "height"),
            (Light { shape: LightShape::Sun { angle_rad: 0.01 }, ..good }, "angle"),
            (
                Light { kind: LightKind::Directional, shape: LightShape::Sphere { radius_m: 1.0 }, ..good },
                "radius",
            ),
            (Light { range_m: Some(0.0), ..good }, "range"),
            (Light { near_m: Some(2.0), far_m: Some(1.0), ..good }, "near"),
            (Light { kind: spot(0.0, 2.0), ..good }, "outer cone"),
            (Light { kind: spot(1.0, 0.5), ..good }, "inner cone"),
        ] {
            let message = light.check().expect_err(word).to_string();
            assert!(message.contains(word), "{message}");
        }
    }
}
