//! Property tests of the transform chain. The oracle is the definition of the viewport transform, written out by hand.

use super::*;
use crate::projection::{orthographic, perspective};
use glam::Quat;
use proptest::prelude::*;

/// What the rasteriser does with a clip-space position: window coordinates in texels, rows down, and stored depth.
fn rasterised(clip: Vec4, depth: DepthConvention, size: UVec2) -> (Vec2, f32) {
    let ndc = clip.truncate() / clip.w;
    let window = Vec2::new((ndc.x + 1.0) * 0.5 * size.x as f32, (1.0 - ndc.y) * 0.5 * size.y as f32);
    let stored = if depth == DepthConvention::OpenGl { 0.5 * ndc.z + 0.5 } else { ndc.z };
    (window, stored)
}

fn rigid() -> impl Strategy<Value = Mat4> {
    let part = || -1.0f32..1.0;
    ((part(), part(), part(), 0.1f32..3.0), (-50.0f32..50.0, -50.0f32..50.0, -50.0f32..50.0)).prop_map(
        |((x, y, z, angle), (px, py, pz))| {
            let axis = Vec3::new(x, y, z).try_normalize().unwrap_or(Vec3::X);
            Mat4::from_rotation_translation(Quat::from_axis_angle(axis, angle), Vec3::new(px, py, pz))
        },
    )
}

fn convention() -> impl Strategy<Value = DepthConvention> {
    prop::sample::select(DepthConvention::ALL.to_vec())
}

/// A point in front of a light, in the light's own space, and inside its cone.
fn in_cone() -> impl Strategy<Value = Vec3> {
    (-0.95f32..0.95, -0.95f32..0.95, 1.0f32..90.0)
        .prop_map(|(x, y, z)| Vec3::new(x * z * 0.6, y * z * 0.6, -z))
}

fn close(a: f32, b: f32, tolerance: f32) -> bool {
    (a - b).abs() <= tolerance * a.abs().max(b.abs()).max(1.0)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    #[test]
    fn object_world_and_eye_lookups_agree(
        world_from_light in rigid(), world_from_object in rigid(), world_from_view in rigid(),
        p_light in in_cone(), depth in convention(), parallel in any::<bool>(),
    ) {
        let clip_from_light =
            if parallel { orthographic(60.0, 60.0, 0.5, 100.0, depth) } else { perspective(0.6, 0.6, 0.5, 100.0, depth) };
        let from_world = texture_from_world(clip_from_light * world_from_light.inverse(), depth, TextureOrigin::TopLeft);
        let p_world = world_from_light.transform_point3(p_light);
        let by_world = locate(&from_world, p_world);
        let p_object = world_from_object.inverse().transform_point3(p_world);
        let by_object = locate(&texture_from_object(from_world, world_from_object), p_object);
        let p_view = world_from_view.inverse().transform_point3(p_world);
        let by_view = locate(&texture_from_view(from_world, world_from_view), p_view);
        for other in [by_object, by_view] {
            prop_assert!(other.inside);
            prop_assert!(by_world.uv.abs_diff_eq(other.uv, 2e-4), "{by_world:?} {other:?}");
            prop_assert!(close(by_world.depth, other.depth, 2e-4), "{by_world:?} {other:?}");
        }
    }

    #[test]
    fn the_projected_texel_is_the_rasterised_one(
        world_from_light in rigid(), p_light in in_cone(), depth in convention(), size in 1u32..4096,
    ) {
        let size = UVec2::new(size, size / 2 + 1);
        let clip_from_world = perspective(0.6, 0.6, 0.5, 100.0, depth) * world_from_light.inverse();
        let p_world = world_from_light.transform_point3(p_light);
        let (window, stored) = rasterised(clip_from_world * p_world.extend(1.0), depth, size);
        let at = locate(&texture_from_world(clip_from_world, depth, TextureOrigin::TopLeft), p_world);
        let off = at.uv * size.as_vec2() - window;
        // Both chains round world positions, which are far from the origin beside their distance to the light: so many
        // texels does that move them.
        let rounded_m = 8.0 * f32::EPSILON * (p_world.abs().max_element() + world_from_light.w_axis.length());
        let allowed_texel = rounded_m / (p_light.z.abs() * 0.6f32.tan()) * size.as_vec2().max_element();
        prop_assert!(off.abs().max_element() < allowed_texel, "{off} texels apart, not {allowed_texel}");
        prop_assert!(close(at.depth, stored, 1e-4));
        // Away from a texel's border, where rounding may choose either side, the texel itself is the same.
        if (window - window.round()).abs().min_element() > allowed_texel {
            prop_assert_eq!(texel_at(at.uv, size), window.floor().as_uvec2());
        }
    }

    #[test]
    fn the_three_conventions_agree_on_who_is_nearer(a in in_cone(), b in in_cone()) {
        prop_assume!((a.z - b.z).abs() > 1e-2 * a.z.abs());
        for depth in DepthConvention::ALL {
            let from_light =
                texture_from_world(perspective(0.6, 0.6, 0.5, 100.0, depth), depth, TextureOrigin::TopLeft);
            let (a_depth, b_depth) = (locate(&from_light, a).depth, locate(&from_light, b).depth);
            prop_assert_eq!(depth.is_lit(a_depth, b_depth), a.z > b.z, "{:?}", depth);
        }
    }

    #[test]
    fn matrix_bias_moves_every_receiver_towards_the_light_alike(p in in_cone(), bias in 0.0f32..0.1) {
        for depth in DepthConvention::ALL {
            let plain = texture_from_world(perspective(0.6, 0.6, 0.5, 100.0, depth), depth, TextureOrigin::TopLeft);
            let (before, after) = (locate(&plain, p), locate(&(matrix_bias(bias, depth) * plain), p));
            prop_assert!((before.uv - after.uv).length() < 1e-5);
            let moved = (before.depth - after.depth) * depth.away();
            prop_assert!((moved - bias).abs() < 1e-5, "{depth:?} moved by {moved}, not {bias}");
        }
    }

    #[test]
    fn nothing_behind_the_light_is_inside(p in in_cone()) {
        for depth in DepthConvention::ALL {
            let from_light =
                texture_from_world(perspective(0.6, 0.6, 0.5, 100.0, depth), depth, TextureOrigin::TopLeft);
            prop_assert!(locate(&from_light, p).inside);
            prop_assert!(!locate(&from_light, -p).inside, "the phantom of {p}");
        }
    }

    #[test]
    fn texel_centres_are_their_own_texels(x in 0u32..4096, y in 0u32..4096, w in 1u32..4097, h in 1u32..4097) {
        let size = UVec2::new(w, h);
        let texel = UVec2::new(x % w, y % h);
        prop_assert_eq!(texel_at(texel_center(texel, size), size), texel);
    }

    #[test]
    fn the_two_origins_differ_by_a_flip(p in in_cone()) {
        let clip_from_light = perspective(0.6, 0.6, 0.5, 100.0, DepthConvention::OpenGl);
        let at = |origin| locate(&texture_from_world(clip_from_light, DepthConvention::OpenGl, origin), p).uv;
        let (down, up) = (at(TextureOrigin::TopLeft), at(TextureOrigin::BottomLeft));
        prop_assert!((down.x - up.x).abs() < 1e-6 && (down.y + up.y - 1.0).abs() < 1e-5);
    }
}

#[test]
fn direct3d9_needs_half_a_texel() {
    // The rasteriser of Direct3D 9 covers texel (3, 5) when the window position is (3, 5); the sampler finds that
    // texel's centre at (3.5, 5.5) / size.
    let size = UVec2::new(16, 32);
    let from_clip = |center| {
        texel_center_offset(center, size)
            * texture_from_clip(DepthConvention::ZeroToOne, TextureOrigin::TopLeft)
    };
    let ndc = Vec3::new(3.0 / 16.0 * 2.0 - 1.0, 1.0 - 5.0 / 32.0 * 2.0, 0.5);
    let uv = locate(&from_clip(TexelCenter::Direct3d9), ndc).uv;
    assert!(uv.abs_diff_eq(texel_center(UVec2::new(3, 5), size), 1e-6), "{uv}");
    let uncorrected = locate(&from_clip(TexelCenter::Half), ndc).uv;
    assert!(!uncorrected.abs_diff_eq(uv, 1e-3), "the correction must do something");
}
