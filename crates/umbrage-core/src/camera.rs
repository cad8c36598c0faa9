//! The eye: where it is, what it sees.

use crate::depth::DepthConvention;
use glam::{Mat3, Mat4, Vec3};

/// How the eye's picture is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// A pin-hole.
    Perspective {
        /// Full angle from bottom to top, radians, above 0 and below `PI`.
        fov_y_rad: f32,
    },
    /// Parallel.
    Orthographic {
        /// Half of what is seen from bottom to top, metres.
        half_height_m: f32,
    },
}

/// A camera in world space. It looks along its own -Z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Where the eye is, metres.
    pub position_world: Vec3,
    /// Where it looks; unit length.
    pub direction_world: Vec3,
    /// What is up in the picture; not parallel to the direction.
    pub up_world: Vec3,
    /// Pin-hole or parallel.
    pub projection: Projection,
    /// Nothing closer than this is drawn, metres, above 0.
    pub near_m: f32,
    /// Nothing farther than this is drawn, metres, above `near_m`.
    pub far_m: f32,
}

impl Camera {
    /// A pin-hole camera at `position_world` that looks at `target_world`.
    pub fn look_at(
        position_world: Vec3,
        target_world: Vec3,
        fov_y_rad: f32,
        near_m: f32,
        far_m: f32,
    ) -> Self {
        let direction_world = (target_world - position_world).try_normalize().unwrap_or(Vec3::NEG_Z);
        Self {
            position_world,
            direction_world,
            up_world: crate::light::up_for(direction_world),
            projection: Projection::Perspective { fov_y_rad },
            near_m,
            far_m,
        }
    }

    /// Is every number finite and in its range? The text names the first that is not.
    ///
    /// # Errors
    /// One clause that names the number, its value and what is allowed.
    pub fn check(&self) -> Result<(), String> {
        if !self.position_world.is_finite() {
            return Err(format!("the camera's position is {}; it must be finite", self.position_world));
        }
        if !self.direction_world.is_finite() || self.direction_world.length_squared() < 0.25 {
            return Err("the camera looks nowhere: its position and target are the same place".into());
        }
        if !(self.near_m > 0.0 && self.far_m > self.near_m && self.far_m.is_finite()) {
            let (near, far) = (self.near_m, self.far_m);
            return Err(format!(
                "the camera's near is {near} m and its far {far} m; 0 < near < far is needed"
            ));
        }
        match self.projection {
            Projection::Perspective { fov_y_rad } if !(fov_y_rad > 1e-4 && fov_y_rad < 3.13) => Err(format!(
                "the camera's field of view is {} degrees; above 0 and below 179 is allowed",
                fov_y_rad.to_degrees()
            )),
            Projection::Orthographic { half_height_m }
                if !(half_height_m > 0.0 && half_height_m.is_finite()) =>
            {
                Err(format!("the camera's half height is {half_height_m} m; it must be finite and above 0"))
            }
            _ => Ok(()),
        }
    }

    /// World to eye space.
    pub fn view_from_world(&self) -> Mat4 {
        let back = -self.direction_world.normalize();
        let up = if self.up_world.cross(back).length_squared() > 1e-8 {
            self.up_world
        } else {
            crate::light::up_for(back)
        };
        let right = up.cross(back).normalize();
        let world_from_view = Mat3::from_cols(right, back.cross(right), back);
        let view_from_world = world_from_view.transpose();
        Mat4::from_mat3(view_from_world) * Mat4::from_translation(-self.position_world)
    }

    /// Eye to clip space for an image of `aspect` (width over height).
    pub fn clip_from_view(&self, aspect: f32, depth: DepthConvention) -> Mat4 {
        match self.projection {
            Projection::Perspective { fov_y_rad } => {
                let half_height = (0.5 * fov_y_rad).tan();
                crate::projection::perspective(
                    half_height * aspect,
                    half_height,
                    self.near_m,
                    self.far_m,
                    depth,
                )
            }
            Projection::Orthographic { half_height_m } => {
                let half_width_m = half_height_m * aspect;
                crate::projection::orthographic(half_width_m, half_height_m, self.near_m, self.far_m, depth)
            }
        }
    }
}
