//! What shadows have to know of a frame: from where it is seen, and how large it is.

use super::ShadowsError;
use glam::{Mat4, UVec2, Vec3, Vec4};
use umbrage_core::{Camera, DepthConvention, Projection};

/// One frame.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Frame {
    /// World to eye space (the eye looks along -Z).
    pub view_from_world: Mat4,
    /// Eye to clip space.
    pub clip_from_view: Mat4,
    /// Of the picture, pixels.
    pub size_px: UVec2,
    /// Which way the picture's depth runs: [`DepthConvention::ZeroToOne`] or [`DepthConvention::Reversed`].
    pub depth: DepthConvention,
}

impl Frame {
    /// From the two matrices that a renderer draws with. Whether its depth is reversed is read off `clip_from_view`.
    ///
    /// Units: metres, pixels. Cost: none. What cannot be used is refused by `Shadows::prepare`.
    pub fn from_matrices(view_from_world: Mat4, clip_from_view: Mat4, size_px: [u32; 2]) -> Self {
        let depth = depth_of(&clip_from_view);
        Self { view_from_world, clip_from_view, size_px: UVec2::from_array(size_px), depth }
    }

    /// From a camera, whose depth runs as `depth` says.
    pub fn from_camera(camera: &Camera, size_px: [u32; 2], depth: DepthConvention) -> Self {
        let aspect = size_px[0].max(1) as f32 / size_px[1].max(1) as f32;
        Self {
            view_from_world: camera.view_from_world(),
            clip_from_view: camera.clip_from_view(aspect, depth),
            size_px: UVec2::from_array(size_px),
            depth,
        }
    }

    /// World to clip space.
    pub fn clip_from_world(&self) -> Mat4 {
        self.clip_from_view * self.view_from_world
    }

    /// Does everything look equally large wherever it is?
    pub fn is_parallel(&self) -> bool {
        self.clip_from_view.row(3) == Vec4::W
    }

    /// Where the eye is, world space.
    pub fn eye_world(&self) -> Vec3 {
        self.view_from_world.inverse().w_axis.truncate()
    }

    /// Width over height.
    pub fn aspect(&self) -> f32 {
        self.size_px.x.max(1) as f32 / self.size_px.y.max(1) as f32
    }

    /// The same as a camera, for fits that follow the eye. Off-centre pictures are taken for centred ones that hold them.
    pub fn camera(&self) -> Camera {
        let world_from_view = self.view_from_world.inverse();
        let half = |row: usize| {
            let scale = self.clip_from_view.row(row);
            let shift = self.clip_from_view.row(row).z.abs();
            (1.0 + if self.is_parallel() { 0.0 } else { shift })
                / scale.truncate().truncate().length().max(1e-6)
        };
        let projection = if self.is_parallel() {
            Projection::Orthographic { half_height_m: half(1) }
        } else {
            Projection::Perspective { fov_y_rad: 2.0 * half(1).atan() }
        };
        let [near_m, far_m] = self.near_and_far_m();
        Camera {
            position_world: world_from_view.w_axis.truncate(),
            direction_world: -world_from_view.z_axis.truncate().normalize_or_zero(),
            up_world: world_from_view.y_axis.truncate(),
            projection,
            near_m,
            far_m,
        }
    }

    fn near_and_far_m(&self) -> [f32; 2] {
        let [zero, one] = ends(&self.clip_from_view);
        let (near, far) = if self.depth.is_reversed() { (one, zero) } else { (zero, one) };
        // A picture without a far plane still shows nothing that is farther than this.
        let far = if far.is_finite() && far > near { far } else { near.max(1e-6) * 1e7 };
        [near, far]
    }

    pub(super) fn check(&self) -> Result<(), ShadowsError> {
        let refuse = |what, value: String, allowed| Err(ShadowsError::Number { what, value, allowed });
        let matrix = |what, matrix: &Mat4| {
            let is_usable = matrix.is_finite() && matrix.as_dmat4().determinant() != 0.0;
            if is_usable { Ok(()) } else { refuse(what, format!("{matrix}"), "finite, with an inverse") }
        };
        matrix("frame's view_from_world", &self.view_from_world)?;
        matrix("frame's clip_from_view", &self.clip_from_view)?;
        if self.size_px.min_element() == 0 {
            return refuse("frame's size", format!("{} pixels", self.size_px), "1 pixel or more each way");
        }
        if self.depth == DepthConvention::OpenGl {
            return refuse("frame's depth", "OpenGl".into(), "ZeroToOne or Reversed: WebGPU has no other");
        }
        Ok(())
    }
}

/// How far from the eye clip space has the depths 0 and 1, metres; infinite where there is no such place.
fn ends(clip_from_view: &Mat4) -> [f32; 2] {
    let (z, w) = (clip_from_view.row(2), clip_from_view.row(3));
    // Along the axis the point (0, 0, -d, 1) has the depth (z.w - d z.z) / (w.w - d w.z).
    [0.0, 1.0].map(|depth| {
        let (over, under) = (z.w - depth * w.w, z.z - depth * w.z);
        if under == 0.0 { f32::INFINITY } else { over / under }
    })
}

fn depth_of(clip_from_view: &Mat4) -> DepthConvention {
    let [zero, one] = ends(clip_from_view);
    let is_before = |a: f32, b: f32| a.is_finite() && (a < b || !b.is_finite());
    if is_before(one, zero) { DepthConvention::Reversed } else { DepthConvention::ZeroToOne }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_camera_comes_back_out_of_its_matrices() {
        let perspective =
            Camera::look_at(Vec3::new(1.0, 2.0, 3.0), Vec3::new(-4.0, 0.5, 2.0), 0.9, 0.25, 80.0);
        let parallel = Camera { projection: Projection::Orthographic { half_height_m: 3.0 }, ..perspective };
        for camera in [perspective, parallel] {
            for depth in [DepthConvention::ZeroToOne, DepthConvention::Reversed] {
                let made = Frame::from_camera(&camera, [640, 360], depth);
                let frame = Frame::from_matrices(made.view_from_world, made.clip_from_view, [640, 360]);
                assert_eq!((frame.depth, frame.is_parallel()), (depth, camera == parallel));
                let back = frame.camera();
                assert!((back.near_m - 0.25).abs() < 1e-3 && (back.far_m - 80.0).abs() < 0.1, "{back:?}");
                assert!(back.position_world.distance(camera.position_world) < 1e-5);
                assert!(back.direction_world.distance(camera.direction_world) < 1e-5);
                let again = back.clip_from_view(frame.aspect(), depth);
                assert!(
                    (again - frame.clip_from_view).abs_diff_eq(Mat4::ZERO, 2e-3),
                    "{again} {}",
                    frame.clip_from_view
                );
                assert_eq!(frame.check(), Ok(()));
            }
        }
    }

    #[test]
    fn pictures_without_a_far_plane_are_told_apart_too() {
        for depth in [DepthConvention::ZeroToOne, DepthConvention::Reversed] {
            let clip = umbrage_core::projection::perspective(1.0, 1.0, 0.5, f32::INFINITY, depth);
            let frame = Frame::from_matrices(Mat4::IDENTITY, clip, [8, 8]);
            assert_eq!(frame.depth, depth);
            assert!((frame.camera().near_m - 0.5).abs() < 1e-6 && frame.camera().far_m > 1e5);
        }
    }

    #[test]
    fn what_is_no_picture_is_refused() {
        let camera = Camera::look_at(Vec3::ZERO, Vec3::X, 1.0, 0.1, 10.0);
        let good = Frame::from_camera(&camera, [8, 8], DepthConvention::ZeroToOne);
        for (frame, word) in [
            (Frame { view_from_world: Mat4::NAN, ..good }, "view_from_world"),
            (Frame { clip_from_view: Mat4::ZERO, ..good }, "clip_from_view"),
            (Frame { size_px: UVec2::new(8, 0), ..good }, "size"),
            (Frame { depth: DepthConvention::OpenGl, ..good }, "depth"),
        ] {
            assert!(frame.check().expect_err(word).to_string().contains(word));
        }
    }
}
