//! Projection matrices, right-handed, looking along -Z, for every depth convention.

use crate::depth::DepthConvention;
use glam::{Mat4, Vec4};

/// A symmetric perspective projection.
///
/// `tan_half_x` and `tan_half_y` are the tangents of the half angles; near and far are distances along the axis in
/// metres, `0 < near_m < far_m`. An infinite `far_m` makes a projection that cuts nothing far away, not even what is infinitely far
/// (w = 0): its depth is that of the far plane to the last bit.
pub fn perspective(
    tan_half_x: f32,
    tan_half_y: f32,
    near_m: f32,
    far_m: f32,
    depth: DepthConvention,
) -> Mat4 {
    // ndc = (a * z + b) / -z, with ndc(-near) and ndc(-far) as the convention asks. In f64: far / (far - near) loses
    // half of its digits in f32 when the planes lie far apart.
    let (near, far) = (f64::from(near_m), f64::from(far_m));
    let (at_near, at_far) = (f64::from(depth.ndc_near()), f64::from(depth.ndc_far()));
    let (a, b) = if far_m == f32::INFINITY {
        (-at_far, (at_near - at_far) * near)
    } else {
        ((at_near * near - at_far * far) / (far - near), (at_near - at_far) * near * far / (far - near))
    };
    Mat4::from_cols(
        Vec4::new(1.0 / tan_half_x, 0.0, 0.0, 0.0),
        Vec4::new(0.0, 1.0 / tan_half_y, 0.0, 0.0),
        Vec4::new(0.0, 0.0, a as f32, -1.0),
        Vec4::new(0.0, 0.0, b as f32, 0.0),
    )
}

/// A symmetric parallel projection; all lengths in metres.
pub fn orthographic(
    half_width_m: f32,
    half_height_m: f32,
    near_m: f32,
    far_m: f32,
    depth: DepthConvention,
) -> Mat4 {
    let (near, far) = (f64::from(near_m), f64::from(far_m));
    let (at_near, at_far) = (f64::from(depth.ndc_near()), f64::from(depth.ndc_far()));
    let a = (at_near - at_far) / (far - near);
    let b = at_near + a * near;
    Mat4::from_cols(
        Vec4::new(1.0 / half_width_m, 0.0, 0.0, 0.0),
        Vec4::new(0.0, 1.0 / half_height_m, 0.0, 0.0),
        Vec4::new(0.0, 0.0, a as f32, 0.0),
        Vec4::new(0.0, 0.0, b as f32, 1.0),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn planes_land_where_the_convention_says() {
        for depth in DepthConvention::ALL {
            for clip_from_view in
                [perspective(0.7, 0.4, 0.5, 80.0, depth), orthographic(7.0, 4.0, 0.5, 80.0, depth)]
            {
                let near = clip_from_view.project_point3(Vec3::new(0.0, 0.0, -0.5));
                let far = clip_from_view.project_point3(Vec3::new(0.0, 0.0, -80.0));
                assert!((near.z - depth.ndc_near()).abs() < 1e-5, "{depth:?} near {near}");
                assert!((far.z - depth.ndc_far()).abs() < 1e-5, "{depth:?} far {far}");
            }
        }
    }

    #[test]
    fn without_a_far_plane_nothing_far_is_cut() {
        let turned =
            Mat4::from_rotation_y(0.3) * Mat4::from_rotation_x(-0.8) * Mat4::from_translation(Vec3::ONE);
        for depth in DepthConvention::ALL {
            let endless = perspective(0.7, 0.4, 0.5, f32::INFINITY, depth);
            let near = endless.project_point3(Vec3::new(0.0, 0.0, -0.5));
            assert!((near.z - depth.ndc_near()).abs() < 1e-6, "{depth:?} near {near}");
            let far = perspective(0.7, 0.4, 0.5, 1e7, depth).project_point3(Vec3::new(0.0, 0.0, -90.0));
            let same = endless.project_point3(Vec3::new(0.0, 0.0, -90.0));
            assert!((far.z - same.z).abs() < 1e-6, "{depth:?}: {far} is not {same}");
            // What is infinitely far lies on the far plane exactly, whichever way the eye looks.
            for way in [Vec3::NEG_Z, Vec3::new(0.3, -0.8, -1.0), Vec3::new(-20.0, 3.0, -0.1)] {
                let clip = endless * turned * way.extend(0.0);
                assert_eq!(clip.z, depth.ndc_far() * clip.w, "{depth:?} {way}");
            }
        }
    }

    #[test]
    fn edges_of_the_frustum_are_edges_of_clip_space() {
        let clip_from_view = perspective(0.7, 0.4, 0.5, 80.0, DepthConvention::Reversed);
        let corner = clip_from_view.project_point3(Vec3::new(0.7 * 9.0, -0.4 * 9.0, -9.0));
        assert!((corner.x - 1.0).abs() < 1e-5 && (corner.y + 1.0).abs() < 1e-5, "{corner}");
    }
}
