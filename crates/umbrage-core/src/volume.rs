//! Where a shadow volume can be seen, and where the eye may be in it.

use crate::bounds::Aabb;
use crate::frustum::{Frustum, cone_may_see};
use crate::light::{Light, LightKind};
use glam::{DMat3, DVec3, Mat4, UVec2, Vec3, Vec4, Vec4Swizzles};

/// A light as volumes are pulled from it: its place and 1, or the direction towards it and 0. World space.
pub fn light_point_world(light: &Light) -> Vec4 {
    match light.kind {
        LightKind::Directional => (-light.direction_world.normalize_or_zero()).extend(0.0),
        _ => light.position_world.extend(1.0),
    }
}

/// The same in a caster's object space, so that `dot(plane, light)` tells whether a triangle faces it. Computed in 64 bits.
///
/// By the adjugate, so that a matrix without inverse will do: what it makes flat is lit from across, as if it were very thin.
/// Zero for what it makes a line or a point: nothing of that faces anything.
pub fn light_point_object(light_world: Vec4, world_from_object: &Mat4) -> Vec4 {
    let [x, y, z, origin] = columns(world_from_object);
    let volume = x.dot(y.cross(z));
    let from_origin = light_world.xyz().as_dvec3() - origin * f64::from(light_world.w);
    let across = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y)).transpose() * from_origin;
    let light = across.extend(volume * f64::from(light_world.w)) * if volume < 0.0 { -1.0 } else { 1.0 };
    let place = (light / volume.abs()).as_vec4();
    if place.is_finite() { place } else { light.normalize_or_zero().as_vec4() }
}

/// Does a transform mirror? In 64 bits, and by the number that [`light_point_object`] asks: where rounding decides, both say the same.
pub fn is_mirrored(world_from_object: &Mat4) -> bool {
    let [x, y, z, _] = columns(world_from_object);
    x.dot(y.cross(z)) < 0.0
}

fn columns(m: &Mat4) -> [DVec3; 4] {
    [m.x_axis, m.y_axis, m.z_axis, m.w_axis].map(|column| column.xyz().as_dvec3())
}

/// May a light reach a box: is that within its range, and in its cone? Never false for one that it does.
pub fn light_may_reach(light: &Light, bounds_world: &Aabb) -> bool {
    let is_in_range = light.range_m.filter(|_| light.kind != LightKind::Directional).is_none_or(|range_m| {
        let nearest = light.position_world.clamp(bounds_world.min, bounds_world.max);
        nearest.distance(light.position_world) <= range_m
    });
    let is_in_cone = match light.kind {
        LightKind::Spot { outer_rad, .. } => {
            cone_may_see(light.position_world, light.direction_world.normalize(), outer_rad, bounds_world)
        }
        _ => true,
    };
    is_in_range && is_in_cone
}

/// May a light be inside of a caster, or on it? Then its closed parts have to cast from both sides.
pub fn light_may_be_inside(light_world: Vec4, bounds_world: &Aabb) -> bool {
    let margin = 1e-5 * bounds_world.size().max_element();
    let p = light_world.xyz();
    light_world.w != 0.0
        && p.cmpge(bounds_world.min - margin).all()
        && p.cmple(bounds_world.max + margin).all()
}

/// The four corners of the eye's near plane, in order around it, world space. `None` where the matrix has no inverse.
pub fn near_corners_world(clip_from_world: Mat4, ndc_near: f32) -> Option<[Vec3; 4]> {
    let world_from_clip = clip_from_world.as_dmat4().inverse();
    let corner = |x: f64, y: f64| {
        let p = world_from_clip * glam::DVec4::new(x, y, f64::from(ndc_near), 1.0);
        (p.truncate() / p.w).as_vec3()
    };
    let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    corners.iter().all(|p| p.is_finite()).then_some(corners)
}

/// May the near plane of the eye meet the shadow volume of a caster? If not, faces between eye and surface can be counted, which
/// needs no caps (Everitt and Kilgard 2002, section 4.4). True when in doubt.
///
/// What is between the near plane and the light is a pyramid (a prism for parallel light). A caster whose box lies wholly
/// outside of one of its sides shadows no point of the near plane.
pub fn eye_may_be_in_shadow(near_corners_world: &[Vec3; 4], light_world: Vec4, caster_world: &Aabb) -> bool {
    let middle = near_corners_world.iter().sum::<Vec3>() * 0.25;
    let to_light = light_world.xyz() - middle * light_world.w;
    let size = (near_corners_world[2] - near_corners_world[0]).length();
    let is_outside = |normal: Vec3, through: Vec3| {
        // The side that the pyramid is on counts as above 0; boxes get as much room as single precision needs.
        let farthest = Vec3::select(normal.cmpge(Vec3::ZERO), caster_world.max, caster_world.min);
        let scale = farthest.abs().max(through.abs()).max_element() + size;
        normal.dot(farthest - through) < -1e-5 * scale * normal.length()
    };
    // The near plane itself: nothing on its far side from the light is between them.
    let across =
        (near_corners_world[1] - near_corners_world[0]).cross(near_corners_world[3] - near_corners_world[0]);
    let along = across.normalize_or_zero().dot(to_light.normalize_or_zero());
    if along.abs() < 1e-3 {
        // The pyramid is flat, and the signs of its sides are rounding.
        return true;
    }
    if is_outside(across * along.signum(), middle) {
        return false;
    }
    // Seen from the light the corners run one way round or the other.
    (0..4).all(|i| {
        let (a, b) = (near_corners_world[i], near_corners_world[(i + 1) % 4]);
        let side = (b - a).cross(light_world.xyz() - a * light_world.w);
        let inwards = side * side.dot(middle - a).signum();
        !is_outside(inwards, a)
    })
}

/// A plane behind everything that a caster can darken, `(unit normal away from the light, minus distance)`: its volume may end
/// there, and what is not drawn beyond need not be counted. Of the sides of the scene's box (moved by the light's range) that
/// which is nearest. `None` where a part of the caster's shadow may miss all of them; then a volume has no end.
///
/// `before_world` are points that must be before the plane, too: from there no sight of the scene goes through the volume's far
/// end, so that its lid need not be drawn where faces before the surface are counted.
pub fn far_plane_world(
    light: &Light,
    caster_world: &Aabb,
    scene_world: &Aabb,
    before_world: &[Vec3],
) -> Option<Vec4> {
    let light_world = light_point_world(light);
    // Single precision moves both ends; what lies in the box's own side must be well before the plane.
    let margin_m = 1e-3 * scene_world.size().length();
    let corners = caster_world.corners();
    let range_m = light.range_m.filter(|_| light_world.w != 0.0).unwrap_or(f32::INFINITY);
    let planes = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z].map(|normal| {
        let farthest = Vec3::select(normal.cmpge(Vec3::ZERO), scene_world.max, scene_world.min);
        let reach_m = normal.dot(light_world.xyz()) + range_m;
        normal.extend(-(normal.dot(farthest).min(reach_m) + margin_m))
    });
    // How many times as far from the light as its caster the longest side ends; parallel light: metres.
    let length = |plane: &Vec4| {
        let of_corner = |p: &Vec3| {
            let way = *p * light_world.w - light_world.xyz();
            let speed = plane.xyz().dot(way);
            // Rays that run along the plane end very far away, where single precision is coarse.
            let meets = speed > 0.02 * way.length() && plane.dot(p.extend(1.0)) < 0.0;
            if meets { -plane.dot(p.extend(1.0)) / speed } else { f32::INFINITY }
        };
        corners.iter().map(of_corner).fold(0.0, f32::max)
    };
    let is_behind_all = |plane: &Vec4| before_world.iter().all(|p| plane.dot(p.extend(1.0)) < 0.0);
    let usable = planes.into_iter().filter(is_behind_all);
    let best = usable.map(|plane| (length(&plane), plane)).min_by(|a, b| a.0.total_cmp(&b.0));
    best.filter(|(length, _)| length.is_finite()).map(|(_, plane)| plane)
}

/// May the eye see any of what a caster darkens? `frustum` is the eye's. True when in doubt.
pub fn shadow_may_be_seen(frustum: &Frustum, light_world: Vec4, caster_world: &Aabb) -> bool {
    frustum.may_see_swept(caster_world, |p| p * light_world.w - light_world.xyz())
}

/// How long volumes are made where they cannot be without end, metres: so often the scene, light included.
///
/// A parallel eye sees every infinitely far point at the same place, so that no far lid covers its picture; and an end that a far
/// plane cuts is none. What is `times` as long ends behind all that is seen, but for a light nearer than a `times`-th of a
/// triangle's width to the triangle's plane.
pub fn finite_length_m(scene_world: &Aabb, light_world: Vec4, times: f32) -> f32 {
    let light = light_world.xyz();
    let all = if light_world.w == 0.0 {
        *scene_world
    } else {
        Aabb { min: scene_world.min.min(light), max: scene_world.max.max(light) }
    };
    if scene_world.is_empty() { 1.0 } else { times * all.size().length().max(f32::MIN_POSITIVE) }
}

/// Pixels: left, top, width, height.
pub type Scissor = [u32; 4];

/// The pixels that may show anything that the light reaches: its cone, or the ball of its range, as far as there is
/// anything. All of them for lights that reach everywhere; `None` when it can reach nothing that is seen.
pub fn lit_pixels(light: &Light, scene_world: &Aabb, clip_from_world: Mat4, size: UVec2) -> Option<Scissor> {
    let whole = [0, 0, size.x, size.y];
    let reach_m = light.range_m.filter(|_| light.kind != LightKind::Directional).unwrap_or(f32::INFINITY);
    let place = light.position_world;
    let farthest_m =
        scene_world.corners().iter().map(|p| p.distance(place)).fold(0.0, f32::max).min(reach_m) * 1.001;
    let ball = Aabb { min: place - reach_m.min(1e30), max: place + reach_m.min(1e30) };
    let met = Aabb { min: scene_world.min.max(ball.min), max: scene_world.max.min(ball.max) };
    let points = match light.kind {
        LightKind::Directional => return Some(whole),
        LightKind::Point if reach_m.is_infinite() => return Some(whole),
        _ if met.is_empty() => return None,
        LightKind::Point => met.corners(),
        LightKind::Spot { outer_rad, .. } => {
            let rotation = light.world_from_light_rotation();
            let (depth, wide) = (farthest_m, farthest_m * outer_rad.min(1.5).tan() * 1.001);
            let corner = |x: f32, y: f32| place + rotation * Vec3::new(x * wide, y * wide, -depth);
            let ends = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
            [place, place, place, place, ends[0], ends[1], ends[2], ends[3]]
        }
    };
    let (mut least, mut most) = (glam::Vec2::INFINITY, glam::Vec2::NEG_INFINITY);
    for point in points {
        let clip = clip_from_world * point.extend(1.0);
        if clip.w <= 1e-6 * clip.xyz().length() {
            // Beside or behind the eye: its place on the screen says nothing.
            return Some(whole);
        }
        let ndc = clip.xy() / clip.w;
        (least, most) = (least.min(ndc), most.max(ndc));
    }
    let extent = size.as_vec2();
    let to_px = |ndc: glam::Vec2| (ndc * glam::Vec2::new(0.5, -0.5) + 0.5) * extent;
    let (a, b) = (to_px(least), to_px(most));
    let from = (a.min(b).floor() - 1.0).max(glam::Vec2::ZERO).min(extent);
    let to = (a.max(b).ceil() + 1.0).max(glam::Vec2::ZERO).min(extent);
    let (from, to) = (from.as_uvec2(), to.as_uvec2());
    (to.x > from.x && to.y > from.y).then(|| [from.x, from.y, to.x - from.x, to.y - from.y])
}

#[cfg(test)]
#[path = "volume_tests.rs"]
mod tests;
