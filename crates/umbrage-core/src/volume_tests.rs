use super::*;
use crate::camera::Camera;
use crate::depth::DEPTH;
use proptest::prelude::*;

fn point(range: std::ops::Range<f32>) -> impl Strategy<Value = Vec3> {
    (range.clone(), range.clone(), range).prop_map(|(x, y, z)| Vec3::new(x, y, z))
}

fn around(center: Vec3, half: f32) -> Aabb {
    Aabb { min: center - half, max: center + half }
}

/// Does the segment (or, for w = 0, the ray) from `p` to the light meet the box? Slabs, in 64 bits.
fn is_hidden(p: Vec3, light: Vec4, bounds: &Aabb) -> bool {
    let way = (light.xyz() - p * light.w).as_dvec3();
    let (mut from, mut to) = (0.0f64, if light.w == 0.0 { f64::INFINITY } else { 1.0 });
    for axis in 0..3 {
        let (low, high) = (f64::from(bounds.min[axis] - p[axis]), f64::from(bounds.max[axis] - p[axis]));
        if way[axis] == 0.0 {
            if low > 0.0 || high < 0.0 {
                return false;
            }
            continue;
        }
        let (a, b) = (low / way[axis], high / way[axis]);
        (from, to) = (from.max(a.min(b)), to.min(a.max(b)));
    }
    from <= to
}

fn camera(position: Vec3, target: Vec3) -> Mat4 {
    let camera = Camera::look_at(position, target, 0.9, 0.1, 50.0);
    camera.clip_from_view(1.5, DEPTH) * camera.view_from_world()
}

proptest! {
    #[test]
    fn whenever_a_point_of_the_near_plane_is_hidden_the_eye_may_be_in_the_shadow(
        eye in point(-5.0..5.0), target in point(-5.0..5.0), light in point(-8.0..8.0), parallel: bool,
        center in point(-6.0..6.0), half in 0.05f32..1.5, u in 0.0f32..1.0, v in 0.0f32..1.0,
    ) {
        let corners = near_corners_world(camera(eye, target), DEPTH.ndc_near()).expect("a plane");
        let light = light.extend(if parallel { 0.0 } else { 1.0 });
        let caster = around(center, half);
        let p = corners[0] + u * (corners[1] - corners[0]) + v * (corners[3] - corners[0]);
        if is_hidden(p, light, &caster) {
            prop_assert!(eye_may_be_in_shadow(&corners, light, &caster));
        }
    }

    #[test]
    fn whenever_a_seen_point_is_hidden_the_shadow_may_be_seen(
        eye in point(-5.0..5.0), target in point(-5.0..5.0), light in point(-8.0..8.0), parallel: bool,
        center in point(-6.0..6.0), half in 0.05f32..1.5, p in point(-6.0..6.0),
    ) {
        let clip_from_world = camera(eye, target);
        let frustum = Frustum::from_clip(clip_from_world, DEPTH);
        let light = light.extend(if parallel { 0.0 } else { 1.0 });
        let caster = around(center, half);
        if frustum.may_see(&around(p, 0.0)) && is_hidden(p, light, &caster) {
            prop_assert!(shadow_may_be_seen(&frustum, light, &caster));
        }
    }

    #[test]
    fn every_lit_pixel_is_within_the_scissor(
        eye in point(-5.0..5.0), target in point(-5.0..5.0), place in point(-4.0..4.0), aim in point(-4.0..4.0),
        range in 0.2f32..4.0, outer in 0.05f32..1.4, is_spot: bool, p in point(-5.0..5.0),
    ) {
        let kind = if is_spot { LightKind::Spot { inner_rad: 0.0, outer_rad: outer } } else { LightKind::Point };
        let light = Light { kind, range_m: Some(range), ..Light::default() }.aimed(place, aim);
        let scene = around(Vec3::ZERO, 5.0);
        let clip_from_world = camera(eye, target);
        let size = UVec2::new(320, 200);
        let way = p - place;
        let in_cone = !is_spot || way.normalize_or_zero().dot(light.direction_world.normalize()) >= outer.cos();
        if way.length() > range || !in_cone || !Frustum::from_clip(clip_from_world, DEPTH).may_see(&around(p, 0.0)) {
            return Ok(());
        }
        let clip = clip_from_world * p.extend(1.0);
        let px = (clip.xy() / clip.w * glam::Vec2::new(0.5, -0.5) + 0.5) * size.as_vec2();
        let Some([x, y, w, h]) = lit_pixels(&light, &scene, clip_from_world, size) else {
            return Err(TestCaseError::fail("a lit point is seen, and there is no scissor"));
        };
        prop_assert!(px.x >= x as f32 - 1e-2 && px.y >= y as f32 - 1e-2, "{px} {x} {y}");
        prop_assert!(px.x <= (x + w) as f32 + 1e-2 && px.y <= (y + h) as f32 + 1e-2, "{px} {x} {y} {w} {h}");
    }
}

#[test]
fn a_caster_far_from_the_way_to_the_light_needs_no_caps_and_a_far_shadow_is_not_seen() {
    let clip_from_world = camera(Vec3::new(0.0, 0.0, 5.0), Vec3::ZERO);
    let corners = near_corners_world(clip_from_world, DEPTH.ndc_near()).expect("a plane");
    let light = Vec4::new(0.0, 10.0, 0.0, 1.0);
    assert!(!eye_may_be_in_shadow(&corners, light, &around(Vec3::ZERO, 1.0)));
    assert!(eye_may_be_in_shadow(&corners, light, &around(Vec3::new(0.0, 5.0, 2.5), 1.0)));
    let frustum = Frustum::from_clip(clip_from_world, DEPTH);
    // Behind the eye, and the shadow falls further back; then one whose shadow falls into view.
    assert!(!shadow_may_be_seen(
        &frustum,
        Vec4::new(0.0, 0.0, -10.0, 1.0),
        &around(Vec3::new(0.0, 0.0, 9.0), 1.0)
    ));
    assert!(shadow_may_be_seen(
        &frustum,
        Vec4::new(0.0, 0.0, 30.0, 1.0),
        &around(Vec3::new(0.0, 0.0, 9.0), 1.0)
    ));
    // A small lamp in a corner of a large picture.
    let lamp =
        Light { range_m: Some(0.2), kind: LightKind::Point, ..Light::default() }.aimed(Vec3::ZERO, Vec3::Y);
    let [_, _, w, h] =
        lit_pixels(&lamp, &around(Vec3::ZERO, 5.0), clip_from_world, UVec2::new(320, 200)).expect("seen");
    assert!(w < 60 && h < 60, "{w} {h}");
}

proptest! {
    #[test]
    fn every_hidden_point_of_the_scene_is_before_the_far_plane_and_every_ray_through_the_caster_meets_it(
        light in point(-8.0..8.0), kind in 0usize..3, center in point(-4.0..4.0), half in 0.05f32..1.0,
        p in point(-5.0..5.0), range in 0.5f32..20.0, at in point(-1.0..1.0),
    ) {
        let kind = [LightKind::Directional, LightKind::Point, LightKind::Spot { inner_rad: 0.1, outer_rad: 0.7 }][kind];
        let light = Light { kind, range_m: Some(range), ..Light::default() }.aimed(light, Vec3::ZERO);
        let (caster, scene) = (around(center, half), around(Vec3::ZERO, 5.0));
        let Some(plane) = far_plane_world(&light, &caster, &scene, &[]) else { return Ok(()) };
        let light_world = light_point_world(&light);
        let is_lit = light_world.w == 0.0 || p.distance(light.position_world) <= range;
        if is_lit && is_hidden(p, light_world, &caster) {
            prop_assert!(plane.dot(p.extend(1.0)) < 0.0);
        }
        let q = center + at * half;
        let way = q * light_world.w - light_world.xyz();
        prop_assert!(plane.xyz().dot(way) > 0.0 && plane.dot(q.extend(1.0)) < 0.0);
    }
}

#[test]
fn a_volume_over_a_floor_ends_below_it() {
    let lamp =
        Light { kind: LightKind::Point, range_m: None, ..Light::default() }.aimed(Vec3::Y * 4.0, Vec3::ZERO);
    let scene = Aabb { min: Vec3::new(-5.0, 0.0, -5.0), max: Vec3::new(5.0, 2.0, 5.0) };
    let block = around(Vec3::new(1.0, 1.0, 0.0), 0.5);
    let plane = far_plane_world(&lamp, &block, &scene, &[Vec3::Y]).expect("the floor");
    assert!(plane.xyz() == Vec3::NEG_Y && plane.w < 0.0 && plane.w > -0.1, "{plane}");
    // A caster all around the lamp has no such plane.
    assert_eq!(far_plane_world(&lamp, &around(Vec3::Y * 4.0, 1.0), &scene, &[]), None);
    // An eye below the floor looks into it.
    let other = far_plane_world(&lamp, &block, &scene, &[Vec3::NEG_Y]).expect("a wall");
    assert!(other.xyz() != Vec3::NEG_Y, "{other}");
}

#[test]
fn what_must_end_ends_behind_scene_and_light() {
    let scene = around(Vec3::ZERO, 1.0);
    let sun = finite_length_m(&scene, Vec4::new(0.0, 900.0, 0.0, 0.0), 2.0);
    assert!((sun - 2.0 * 12f32.sqrt()).abs() < 1e-4, "a direction is no place: {sun}");
    assert!(finite_length_m(&scene, Vec4::new(0.0, 9.0, 0.0, 1.0), 2.0) > 20.0);
    assert!(finite_length_m(&around(Vec3::ONE, 0.0), Vec4::new(0.0, 1.0, 0.0, 0.0), 2.0) > 0.0);
    assert_eq!(finite_length_m(&Aabb::EMPTY, Vec4::W, 2.0), 1.0);
}

#[test]
fn a_light_has_a_side_of_what_a_matrix_makes_flat() {
    let light = Vec4::new(2.0, 3.0, -1.0, 1.0);
    let place = Mat4::from_translation(Vec3::new(0.3, 1.0, 0.0)) * Mat4::from_rotation_x(0.4);
    for scale in [Vec3::ONE, Vec3::new(-2.0, 0.5, 1.0), Vec3::new(1e-3, 1e3, 1.0)] {
        let world_from_object = place * Mat4::from_scale(scale);
        let found = light_point_object(light, &world_from_object);
        assert!((world_from_object * found).distance(light) < 1e-4, "{scale}: {found}");
        assert_eq!(is_mirrored(&world_from_object), scale.x < 0.0);
    }
    // Flat along y: only where the light is across that plane counts.
    for (light, sign) in [(Vec4::new(5.0, 3.0, 0.0, 1.0), 1.0), (Vec4::new(5.0, -3.0, 0.0, 1.0), -1.0)] {
        let flat = Mat4::from_translation(Vec3::Y) * Mat4::from_scale(Vec3::new(2.0, 0.0, 2.0));
        assert_eq!(light_point_object(light, &flat), Vec4::Y * sign);
        let line = Mat4::from_scale(Vec3::X);
        assert_eq!(light_point_object(light, &line), Vec4::ZERO);
    }
}
