//! Rows N4 and N6 to N11: projective masks darken what their blocker takes from the light, once, and nothing else.

mod common;

use common::found::{Found, SIDE, boxes, found, found_with, kinds};
use common::scenes::{builtin, cuboid, cut_out, over_floor, sheet, sun_of, with_light};
use common::{gpu, settings};
use glam::{DVec3, Mat4, UVec2, Vec3};
use umbrage_render::umbrage::core::fit::Region;
use umbrage_render::umbrage::core::{Aabb, Camera, Light, LightKind};
use umbrage_render::{Gpu, Measure, RenderOptions, Renderer, View};
use umbrage_scene::{AlphaMode, Material};

/// Both ways to draw receivers.
const BOTH: [&str; 2] = ["mask", "mask-subtractive"];

/// The most that two pictures of V differ by.
fn most_off(a: &[f32], b: &[f32]) -> f32 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

const EIGHT_BITS: f32 = 1.0 / 255.0;

/// How near the ray of light to a place comes to a box before it gets there, metres: 0 where it meets it.
fn clearance_m(light: &Light, p_world: DVec3, blocker: &Aabb) -> f64 {
    let far_m = 100.0;
    let source = match light.kind {
        LightKind::Directional => p_world - far_m * light.direction_world.as_dvec3(),
        _ => light.position_world.as_dvec3(),
    };
    let (low, high) = (blocker.min.as_dvec3(), blocker.max.as_dvec3());
    let distance = |t: f64| {
        let p = p_world.lerp(source, t);
        p.distance(p.clamp(low, high))
    };
    // The distance to what is convex has one minimum along a line.
    let (mut a, mut b) = (0.0, 1.0);
    for _ in 0..100 {
        let (left, right) = (a + (b - a) / 3.0, b - (b - a) / 3.0);
        if distance(left) <= distance(right) { b = right } else { a = left }
    }
    distance(0.5 * (a + b))
}

/// Pixels that are dark though nothing is in the way, and those that are lit in the middle of the shadow. A pixel whose ray
/// passes within a texel's diagonal of the outline may be either.
fn wrong(found: &Found, light: &Light, blocker: &Aabb) -> [usize; 2] {
    let view = &found.masks[0];
    let width_m = view.texel.max_element() * if view.perspective { view.far_m } else { 1.0 };
    let reach_m = width_m * 2f32.sqrt() * 1.01;
    let inner = Aabb { min: blocker.min + reach_m, max: blocker.max - reach_m };
    let [mut leaks, mut missing] = [0, 0];
    for (p_world, v) in found.seen() {
        let is_lit = light.kind == LightKind::Directional
            || {
                let way = (p_world.as_vec3() - light.position_world).normalize();
                // At its very edge rounding decides.
                !matches!(light.kind, LightKind::Spot { outer_rad, .. } if way.dot(light.direction_world) < outer_rad.cos() + 1e-4)
            };
        if p_world.y > 1e-3 || !is_lit {
            continue;
        }
        if v < 1.0 && clearance_m(light, p_world, blocker) > f64::from(reach_m) {
            leaks += 1;
        }
        if v > 0.0 && inner.min.cmplt(inner.max).all() && clearance_m(light, p_world, &inner) <= 0.0 {
            missing += 1;
        }
    }
    [leaks, missing]
}

#[test]
fn no_border_leaks_at_any_size() {
    let Some(gpu) = gpu() else { return };
    let at = Vec3::new(0.2, 1.6, -0.1);
    let scene = boxes(&[at]);
    let blocker = Aabb { min: at - 0.5, max: at + 0.5 };
    for light in kinds() {
        let scene = with_light(scene.clone(), light);
        for size in ["8", "9", "16", "17", "31", "64", "100", "256", "1000", "2048", "4096"] {
            for lookup in ["linear", "nearest"] {
                for technique in BOTH {
                    if technique != "mask" && !["8", "17", "256"].contains(&size) {
                        continue;
                    }
                    let found = found(&gpu, &scene, technique, &[("mask_size", size), ("lookup", lookup)]);
                    let wrong = wrong(&found, &light, &blocker);
                    let dark = found.seen().filter(|(p, v)| p.y < 1e-3 && *v == 0.0).count();
                    let what = format!("{technique} {:?} {size} {lookup}", light.kind);
                    assert_eq!(wrong, [0, 0], "{what}: leaks, missing");
                    assert!(dark > 60, "{what}: {dark} dark pixels");
                }
            }
        }
        // The negative control: a shadow that is wider than its blocker leaks.
        let found = found(&gpu, &scene, "mask", &[]);
        let smaller = Aabb { min: at - 0.4, max: at + 0.4 };
        assert!(wrong(&found, &light, &smaller)[0] > 20, "the test sees a leak");
    }
}

/// A light over a box, and a receiver: V where the receiver is, from a camera before it.
fn before_the_light(gpu: &Gpu, technique: &str, receiver: (Vec3, f32), eye: Vec3) -> Found {
    let (middle, up) = receiver;
    let meshes = vec![cuboid(Vec3::splat(0.5)), sheet(middle, Vec3::X * 0.9, Vec3::NEG_Z * up * 0.9, 0)];
    let placed = [(0, Mat4::from_translation(Vec3::Y * 4.0)), (1, Mat4::IDENTITY)];
    let mut scene = over_floor(vec![Material::default()], vec![], meshes, &placed);
    // Without the floor.
    scene.instances.pop();
    let light = Light { kind: LightKind::Point, ..Light::spot(Vec3::Y * 8.0, Vec3::ZERO, 0.5, 0.6) };
    scene.cameras[0].camera = Camera::look_at(eye, middle, 0.7, 0.05, 50.0);
    let scene = with_light(scene, light);
    let mut found = found(gpu, &scene, technique, &[]);
    // Only the receiver's own pixels.
    for seen in &mut found.surfaces {
        *seen =
            seen.filter(|s| (s.p_world.y - f64::from(middle.y)).abs() < 1e-3 && s.normal_world.y * up > 0.9);
    }
    found
}

/// Rows N8 and N9: the document's three regions, behind the light, and a face turned away.
#[test]
fn masks_darken_nothing_before_their_blocker_nor_behind_the_light() {
    let Some(gpu) = gpu() else { return };
    for technique in BOTH {
        let at = |y: f32, up: f32, eye: Vec3| before_the_light(&gpu, technique, (Vec3::Y * y, up), eye);
        let count = |found: &Found, is: fn(f32) -> bool| found.seen().filter(|(_, v)| is(*v)).count();
        let is_lit: fn(f32) -> bool = |v| v == 1.0;
        let is_dark: fn(f32) -> bool = |v| v == 0.0;
        let region = |found: &Found, y: f32| found.masks[0].region(Vec3::Y * y);

        let before = at(6.0, 1.0, Vec3::new(0.0, 8.0, 3.0));
        assert_eq!(region(&before, 6.0), Region::Before);
        assert!(count(&before, is_lit) > 500 && count(&before, |v| v < 1.0) == 0, "{technique}: before");

        let beyond = at(2.0, 1.0, Vec3::new(0.0, 2.6, 3.0));
        assert_eq!(region(&beyond, 2.0), Region::Beyond);
        assert!(count(&beyond, is_dark) > 100, "{technique}: beyond");
        // Rays that pass the box's upper edge hit y = 2 at 6 / 3.5 of its half.
        for (p, v) in beyond.seen() {
            let off = p.x.abs().max(p.z.abs()) - 0.5 * 6.0 / 3.5;
            assert!(off.abs() < 0.02 || v == if off < 0.0 { 0.0 } else { 1.0 }, "{technique}: {p} {v}");
        }

        // Through the height of the box: the box's own upper edge shadows what is close to it.
        let beside = at(3.7, 1.0, Vec3::new(0.0, 5.5, 3.0));
        assert_eq!(region(&beside, 3.7), Region::Beside);
        let (mut dark, mut lit) = (0, 0);
        for (p, v) in beside.seen() {
            let off = p.x.abs().max(p.z.abs()) - 0.5 * 4.3 / 3.5;
            assert!(off.abs() < 0.02 || v == if off < 0.0 { 0.0 } else { 1.0 }, "{technique}: {p} {v}");
            dark += usize::from(v == 0.0);
            lit += usize::from(v == 1.0);
        }
        assert!(dark > 20 && lit > 200, "{technique}: beside, {dark} dark and {lit} lit");

        // The division by w would mirror the box through the light.
        let behind = at(9.0, -1.0, Vec3::new(0.0, 7.5, 3.0));
        assert_eq!(region(&behind, 9.0), Region::Before);
        assert!(count(&behind, is_lit) > 500 && count(&behind, |v| v < 1.0) == 0, "{technique}: behind");

        // A face turned away gets nothing from the light, whatever a mask says.
        let away = at(2.0, -1.0, Vec3::new(0.0, 0.5, 3.0));
        let plain = before_the_light(&gpu, "unshadowed", (Vec3::Y * 2.0, -1.0), Vec3::new(0.0, 0.5, 3.0));
        assert_eq!(away.v, plain.v, "{technique}: away");
    }
}

/// Rows N7 and N11: in the overlap of two shadows V is that of one, and both forms say the same everywhere, coarse fringes and all.
#[test]
fn several_blockers_darken_once_and_both_forms_agree() {
    let Some(gpu) = gpu() else { return };
    let overlapping = boxes(&[Vec3::new(-0.3, 1.2, 0.0), Vec3::new(0.2, 2.4, 0.2), Vec3::new(0.9, 1.8, 0.5)]);
    let stacked = boxes(&[Vec3::new(0.0, 0.5, 0.0), Vec3::new(0.1, 1.5, 0.0), Vec3::new(-0.1, 2.6, 0.1)]);
    let scenes = [
        ("overlapping", overlapping),
        ("stacked", stacked),
        ("torus", builtin("torus")),
        ("columns", builtin("columns")),
        ("contact", builtin("contact")),
    ];
    for (name, scene) in scenes {
        let lights = [
            scene.lights[0].light,
            sun_of(&scene),
            Light { kind: LightKind::Point, ..scene.lights[0].light },
        ];
        for light in lights {
            let scene = with_light(scene.clone(), light);
            for size in ["12", "64", "512"] {
                let [single, subtractive] =
                    BOTH.map(|technique| found(&gpu, &scene, technique, &[("mask_size", size)]));
                let off = most_off(&single.v, &subtractive.v);
                let fringe = single.v.iter().filter(|v| **v > 0.0 && **v < 1.0).count();
                println!("{name} {:?} {size}: off by {off:.4}, {fringe} pixels of fringes", light.kind);
                assert!(off <= 2.0 * EIGHT_BITS + 1e-6, "{name} {:?} {size}: {off}", light.kind);
                assert!(single.v.iter().chain(&subtractive.v).all(|v| (0.0..=1.0).contains(v)));
                assert!(fringe > 0, "{name} {size}: a fringe must be seen");
            }
        }
    }
}

/// The darkest mask counts, not the sum, and not the product: in the fringe of one inside of the fringe of another, too.
#[test]
fn the_darkest_of_several_masks_counts() {
    let Some(gpu) = gpu() else { return };
    let at = [Vec3::new(-0.3, 1.2, 0.0), Vec3::new(0.2, 2.4, 0.2)];
    let coarse = [("mask_size", "12")];
    for technique in BOTH {
        let all = found(&gpu, &boxes(&at), technique, &coarse);
        let alone = |keeps: usize| {
            let mut scene = boxes(&at);
            scene.instances[1 - keeps].roles.blocker = false;
            found(&gpu, &scene, technique, &coarse)
        };
        let (first, second) = (alone(0), alone(1));
        let mut both = 0;
        for i in 0..all.v.len() {
            let (a, b) = (first.v[i], second.v[i]);
            let off = (all.v[i] - a.min(b)).abs();
            assert!(off <= 2.0 * EIGHT_BITS, "{technique}: {} of {a} and {b}", all.v[i]);
            both += usize::from(a > 0.0 && a < 1.0 && b > 0.0 && b < 1.0);
        }
        assert!(both > 5, "{technique}: {both} pixels lie in two fringes");
    }
}

/// Row N10: each light has V of its own, whoever else shines.
#[test]
fn several_lights_keep_their_masks_apart() {
    let Some(gpu) = gpu() else { return };
    let mut scene = builtin("contact");
    let first = scene.lights[0].light;
    let others = [
        Light { kind: LightKind::Point, position_world: Vec3::new(2.5, 3.0, 1.0), ..first },
        sun_of(&scene),
        Light::spot(Vec3::new(-3.0, 4.0, 2.0), Vec3::ZERO, 0.5, 0.7),
        Light::spot(Vec3::new(0.5, 5.0, -2.0), Vec3::ZERO, 0.5, 0.7),
    ];
    let one = scene.lights[0].clone();
    scene.lights.extend(others.map(|light| umbrage_scene::SceneLight { light, ..one.clone() }));
    // Written out one by one, and in a loop.
    for lights in [3, 5] {
        scene.lights.truncate(lights.max(scene.lights.len().min(5)));
        let mut some = scene.clone();
        some.lights.truncate(lights);
        for technique in BOTH {
            for shown_light in 0..lights {
                let options = RenderOptions { shown_light, ..RenderOptions::new(settings(technique, &[])) };
                let among = found_with(&gpu, &some, options);
                let alone = with_light(some.clone(), some.lights[shown_light].light);
                let alone = found(&gpu, &alone, technique, &[]);
                assert_eq!(among.v, alone.v, "{technique}: light {shown_light} of {lights}");
                assert!(alone.v.contains(&0.0), "{technique}: light {shown_light} throws a shadow");
            }
        }
    }
}

/// Holes of a blocker are holes of its mask; holes of a receiver show what lies behind them as it is lit there.
#[test]
fn cut_out_blockers_and_receivers_have_their_holes() {
    let Some(gpu) = gpu() else { return };
    let holed = cut_out(AlphaMode::Mask { cutoff: 0.5 });
    let dark = |found: &Found| found.seen().filter(|(p, v)| p.y < 1e-3 && *v < 0.5).count();
    let linear = found(&gpu, &holed, "linear", &[("map_size", "2048")]);
    for technique in BOTH {
        let masked = found(&gpu, &holed, technique, &[]);
        let solid = found(&gpu, &cut_out(AlphaMode::Opaque), technique, &[]);
        let off = masked.v.iter().zip(&linear.v).filter(|(a, b)| (*a - *b).abs() > 0.5).count();
        let dark = [dark(&linear), dark(&masked), dark(&solid)];
        println!("{technique}: {off} off; dark in the map, with holes, without: {dark:?}");
        assert!(masked.warnings.is_empty(), "{:?}", masked.warnings);
        assert!(off < 20 && dark[1] + 40 < dark[2] && dark[1] > 100, "{technique}: {off} {dark:?}");
    }
    // A box above throws its shadow on the sheet and through its holes.
    let mut under = holed;
    under.meshes.push(umbrage_scene::Mesh { material: 1, ..cuboid(Vec3::splat(0.4)) });
    under.instances.push(umbrage_scene::Instance {
        mesh: under.meshes.len() - 1,
        world_from_object: Mat4::from_translation(Vec3::new(-0.5, 2.2, 0.3)),
        object: 2,
        ..umbrage_scene::Instance::default()
    });
    let [single, subtractive] = BOTH.map(|technique| found(&gpu, &under, technique, &[]));
    let off = single.v.iter().zip(&subtractive.v).filter(|(a, b)| (*a - *b).abs() > 2.5 * EIGHT_BITS).count();
    assert_eq!(off, 0, "holes of a receiver are drawn once more as if they were solid");
}

/// A face that is not drawn from behind hides nothing, and takes no light away.
#[test]
fn what_is_not_drawn_from_behind_darkens_nothing() {
    let Some(gpu) = gpu() else { return };
    // A sheet that faces down, above the floor; camera and light are above it and look through its back.
    let roof = sheet(Vec3::new(0.0, 1.2, 0.0), Vec3::X * 3.0, Vec3::Z * 3.0, 0);
    let meshes = vec![roof, cuboid(Vec3::splat(0.3))];
    let placed = [(0, Mat4::IDENTITY), (1, Mat4::from_translation(Vec3::Y * 2.2))];
    let mut scene = over_floor(vec![Material::default()], vec![], meshes, &placed);
    // Only the box throws a shadow.
    for (number, placed) in scene.instances.iter_mut().enumerate() {
        placed.roles.blocker = number == 1;
    }
    let [single, subtractive] = BOTH.map(|technique| found(&gpu, &scene, technique, &[]));
    let dark = single.seen().filter(|(p, v)| p.y < 1e-3 && *v == 0.0).count();
    assert!(dark > 20 && single.masks.len() == 1, "{dark}");
    assert!(most_off(&single.v, &subtractive.v) < 2.5 * EIGHT_BITS);
}

/// Masks are looked up only in the pixels that their shadows may be in: from wherever the eye looks none is cut off.
#[test]
fn shadows_are_whole_from_everywhere() {
    let Some(gpu) = gpu() else { return };
    let scene = builtin("columns");
    let spot = scene.lights[0].light;
    for (eye, target) in [
        (Vec3::new(-7.5, 1.7, 1.4), Vec3::new(5.0, 1.2, 1.4)),
        (Vec3::new(0.0, 0.6, 0.2), Vec3::new(3.0, 0.0, -2.0)),
        (Vec3::new(9.0, 0.4, -4.0), Vec3::new(0.0, 0.3, 2.0)),
        (Vec3::new(0.5, 14.0, 0.3), Vec3::new(0.0, 0.0, 0.0)),
        (Vec3::new(-2.0, 3.0, 8.0), Vec3::new(4.0, 0.0, -9.0)),
    ] {
        for light in [spot, sun_of(&scene), Light { kind: LightKind::Point, ..spot }] {
            let mut scene = with_light(scene.clone(), light);
            scene.cameras[0].camera = Camera::look_at(eye, target, 1.0, 0.1, 60.0);
            let volume = found(&gpu, &scene, "volume", &[]);
            for technique in BOTH {
                let masked = found(&gpu, &scene, technique, &[("mask_size", "1024"), ("outline", "full")]);
                let floor = masked.surfaces.iter().zip(masked.v.iter().zip(&volume.v));
                let floor: Vec<_> = floor.filter(|(s, _)| s.is_some_and(|s| s.p_world.y < 1e-3)).collect();
                let off = floor.iter().filter(|(_, (a, b))| (*a - *b).abs() > 0.6).count();
                let dark = floor.iter().filter(|(_, (_, b))| **b < 0.5).count();
                println!(
                    "{technique} {:?} from {eye}: {off} off, {dark} dark of {}",
                    light.kind,
                    floor.len()
                );
                assert!(
                    dark > 20 && off * 25 < dark.max(100),
                    "{technique} {:?} {eye}: {off} of {dark}",
                    light.kind
                );
            }
        }
    }
}

/// Row N4: of a closed blocker one side is drawn, which has the outline of all of it.
#[test]
fn one_side_of_a_closed_blocker_covers_what_all_of_it_does() {
    let Some(gpu) = gpu() else { return };
    for name in ["torus", "columns", "contact"] {
        let scene = builtin(name);
        let spot = scene.lights[0].light;
        for light in [spot, sun_of(&scene), Light { kind: LightKind::Point, ..spot }] {
            let scene = with_light(scene.clone(), light);
            let shot = |pairs: &[(&str, &str)]| {
                let options = RenderOptions {
                    size: UVec2::splat(SIDE),
                    view: View::Visibility,
                    ..RenderOptions::new(settings("mask", pairs))
                };
                let mut renderer =
                    Renderer::new(&gpu, &scene, &scene.cameras[0].camera, options).expect("a renderer");
                let report = renderer.frame(Measure::Frame).expect("a frame");
                let masks = report.passes.iter().filter(|pass| pass.name.starts_with("mask "));
                (renderer.visibility().expect("V"), masks.map(|pass| pass.work.triangles).sum::<u64>())
            };
            // So little that next to nothing is left out.
            let (side, few) = shot(&[("outline_texel", "0.001")]);
            let (all, many) = shot(&[("outline", "full")]);
            let off = side.iter().zip(&all).filter(|(a, b)| (*a - *b).abs() > 2.0 * EIGHT_BITS).count();
            println!("{name} {:?}: {few} triangles of {many}, {off} pixels off", light.kind);
            assert!(off <= 2 && few * 3 < many * 2, "{name} {:?}: {few} of {many}, {off}", light.kind);
        }
    }
}

/// A function that moves vertices moves blockers, their masks, and receivers wherever they are drawn.
#[test]
fn deformed_blockers_and_receivers_agree_with_a_map() {
    let Some(gpu) = gpu() else { return };
    let sway = "fn umbrage_deform(p_world: vec3f, p_object: vec3f, time_s: f32) -> vec3f {
    return p_world + vec3f(0.2 * p_world.y * sin(p_world.z + time_s), 0.0, 0.0);
}";
    let shot = |technique: &str, pairs: &[(&str, &str)], time_s| {
        let options = RenderOptions {
            deform: Some(sway.into()),
            deform_reach_m: 0.8,
            time_s,
            ..RenderOptions::new(settings(technique, pairs))
        };
        found_with(&gpu, &boxes(&[Vec3::new(0.2, 1.6, -0.1), Vec3::new(-1.2, 1.0, 0.6)]), options)
    };
    let map = shot("linear", &[("map_size", "2048")], 1.5);
    let floor = |found: &Found| {
        found.surfaces.iter().map(|s| s.is_some_and(|s| s.p_world.y < 1e-3)).collect::<Vec<_>>()
    };
    for technique in BOTH {
        let masked = shot(technique, &[("mask_size", "2048")], 1.5);
        let off = |other: &Found| {
            let pixels = floor(&masked).into_iter().zip(floor(other)).zip(masked.v.iter().zip(&other.v));
            pixels.filter(|((a, b), (v, w))| *a && *b && (*v - *w).abs() > 0.5).count()
        };
        let (agrees, control) = (off(&map), off(&shot("linear", &[], 0.0)));
        println!("{technique}: {agrees} off, {control} at another moment");
        assert!(agrees < 25 && control > 60, "{technique}: {agrees} {control}");
        assert!(masked.warnings.is_empty(), "{technique}: {:?}", masked.warnings);
    }
    let [single, subtractive] = BOTH.map(|technique| shot(technique, &[], 1.5));
    assert!(most_off(&single.v, &subtractive.v) < 2.5 * EIGHT_BITS, "both forms");
}
