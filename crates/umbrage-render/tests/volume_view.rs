//! Row F7: the view `volumes` counts the faces of shadow volumes as the stencil does, and tells where that wraps.

mod common;

use common::scenes::{builtin, over_floor, sheet, sun_of, with_light};
use common::{gpu, settings};
use glam::{DVec2, DVec3, Mat4, UVec2, Vec3};
use umbrage_render::umbrage::core::{Aabb, DEPTH, Light, LightKind};
use umbrage_render::{
    DrawnSurface, Gpu, Measure, Overdraw, OverdrawStatistics, RenderOptions, Renderer, Under, View,
};
use umbrage_scene::{Material, Mesh, Scene};

const PICTURE: UVec2 = UVec2::new(160, 120);

/// A closed box around the origin, half a metre to each side.
fn cube() -> Mesh {
    let mut cube = Mesh::default();
    let axes = [Vec3::X, Vec3::Y, Vec3::Z];
    for axis in 0..3 {
        for out in [axes[axis], -axes[axis]] {
            let right = axes[(axis + 1) % 3];
            let side = sheet(0.5 * out, 0.5 * right, 0.5 * out.cross(right), 0);
            let first = cube.positions.len() as u32;
            cube.indices.extend(side.indices.iter().map(|index| first + index));
            cube.positions.extend(&side.positions);
            cube.normals.extend(&side.normals);
            cube.uvs.extend(&side.uvs);
        }
    }
    cube.bounds = Aabb::from_points(cube.positions.iter().copied());
    cube
}

/// Boxes of these widths around one place over a floor, under the sun.
fn boxes(widths_m: impl Iterator<Item = f32>) -> Scene {
    let at = |width_m: f32| Mat4::from_translation(MIDDLE) * Mat4::from_scale(Vec3::splat(width_m));
    let placed: Vec<_> = widths_m.map(|width_m| (0, at(width_m))).collect();
    let scene = over_floor(vec![Material::default()], vec![], vec![cube()], &placed);
    let sun = Light {
        kind: LightKind::Directional,
        direction_world: Vec3::new(0.4, -1.0, -0.3).normalize(),
        ..sun_of(&scene)
    };
    with_light(scene, sun)
}

/// Where the boxes are.
const MIDDLE: Vec3 = Vec3::new(-0.4, 1.6, 0.3);

/// Nested casters, each a little larger than the one before.
fn nested(count: u32) -> Scene {
    boxes((0..count).map(|i| 1.0 + 0.2 * i as f32 / count as f32))
}

struct Seen {
    overdraw: Vec<Overdraw>,
    statistics: OverdrawStatistics,
    surfaces: Vec<Option<DrawnSurface>>,
    warnings: Vec<String>,
    rgba: Vec<u8>,
}

fn seen(gpu: &Gpu, scene: &Scene, set: &[(&str, &str)]) -> Seen {
    let options =
        RenderOptions { view: View::Volumes, size: PICTURE, ..RenderOptions::new(settings("volume", set)) };
    let mut renderer = Renderer::new(gpu, scene, &scene.cameras[0].camera, options).expect("a renderer");
    for _ in 0..2 {
        // Twice: warnings are of the last frame, not of all.
        renderer.frame(Measure::Frame).expect("a frame");
    }
    Seen {
        overdraw: renderer.overdraw().expect("overdraw"),
        statistics: renderer.overdraw_statistics().expect("statistics"),
        surfaces: renderer.surfaces().expect("surfaces"),
        warnings: renderer.warnings().to_vec(),
        rgba: renderer.picture().expect("a picture"),
    }
}

fn v(gpu: &Gpu, scene: &Scene, set: &[(&str, &str)]) -> Vec<f32> {
    let options = RenderOptions {
        view: View::Visibility,
        size: PICTURE,
        ..RenderOptions::new(settings("volume", set))
    };
    let mut renderer = Renderer::new(gpu, scene, &scene.cameras[0].camera, options).expect("a renderer");
    renderer.frame(Measure::Frame).expect("a frame");
    renderer.visibility().expect("V")
}

/// The shadow volume of a box in the sun: all places from which a way against the light meets it.
struct Volume {
    middle: DVec3,
    half_m: f64,
    down: DVec3,
}

impl Volume {
    /// Is a place in it?
    fn holds(&self, p: DVec3) -> bool {
        self.meets(p, -self.down, |_| true).is_some()
    }

    /// Where a ray that begins at `from` goes through the box, if it does in front of there: two sides as axis and sign.
    fn meets(
        &self,
        from: DVec3,
        along: DVec3,
        keep: impl Fn((usize, f64)) -> bool,
    ) -> Option<Vec<(usize, f64)>> {
        let (mut enter, mut leave) = ((f64::MIN, (0, 0.0)), (f64::MAX, (0, 0.0)));
        for axis in 0..3 {
            let (from, along) = (from[axis] - self.middle[axis], along[axis]);
            let (near, far) = (
                (-self.half_m * along.signum() - from) / along,
                (self.half_m * along.signum() - from) / along,
            );
            if near > enter.0 {
                enter = (near, (axis, -along.signum()));
            }
            if far < leave.0 {
                leave = (far, (axis, along.signum()));
            }
        }
        let through = enter.0 < leave.0 && leave.0 > 0.0;
        through.then(|| [enter.1, leave.1].into_iter().filter(|side| keep(*side)).collect())
    }

    /// How many lit sides of the box a ray goes through.
    fn lit_sides(&self, from: DVec3, along: DVec3) -> usize {
        self.meets(from, along, |(axis, sign)| sign * self.down[axis] < 0.0).map_or(0, |sides| sides.len())
    }

    /// Does a ray go through it? Some place of the ray less some way along the light is in the box: what is left of a large
    /// rectangle of both numbers between six lines.
    fn is_met(&self, from: DVec3, along: DVec3) -> bool {
        let mut left = vec![DVec2::ZERO, DVec2::new(1e4, 0.0), DVec2::new(1e4, 1e4), DVec2::new(0.0, 1e4)];
        for axis in 0..3 {
            for sign in [-1.0, 1.0] {
                let inside = |q: DVec2| {
                    let p = from[axis] + q.x * along[axis] - q.y * self.down[axis] - self.middle[axis];
                    self.half_m - sign * p
                };
                let mut next = Vec::new();
                for (i, a) in left.iter().enumerate() {
                    let b = left[(i + 1) % left.len()];
                    let (of_a, of_b) = (inside(*a), inside(b));
                    if of_a >= 0.0 {
                        next.push(*a);
                    }
                    if (of_a >= 0.0) != (of_b >= 0.0) {
                        next.push(*a + (b - *a) * (of_a / (of_a - of_b)));
                    }
                }
                left = next;
                if left.is_empty() {
                    return false;
                }
            }
        }
        true
    }
}

/// Each pixel's ray: from the eye, along.
fn rays(scene: &Scene) -> Vec<(DVec3, DVec3)> {
    let camera = &scene.cameras[0].camera;
    let aspect = PICTURE.x as f32 / PICTURE.y as f32;
    let clip_from_world = camera.clip_from_view(aspect, DEPTH) * camera.view_from_world();
    let world_from_clip = clip_from_world.as_dmat4().inverse();
    let ray = |i: u32| {
        let at = DVec2::new(f64::from(i % PICTURE.x) + 0.5, f64::from(i / PICTURE.x) + 0.5);
        let ndc = at / PICTURE.as_dvec2() * DVec2::new(2.0, -2.0) + DVec2::new(-1.0, 1.0);
        let eye = camera.position_world.as_dvec3();
        (eye, world_from_clip.project_point3(ndc.extend(f64::from(DEPTH.ndc_near()))) - eye)
    };
    (0..PICTURE.element_product()).map(ray).collect()
}

/// A volume without end is convex: a ray from outside goes through two of its faces, or none. Lids are the lit sides of the box; they
/// are drawn only where what is behind is counted.
#[test]
fn faces_over_a_box_are_those_of_the_closed_form() {
    let Some(gpu) = gpu() else { return };
    let scene = boxes([1.0].into_iter());
    let volume = |more_m: f64| Volume {
        middle: MIDDLE.as_dvec3(),
        half_m: 0.5 + more_m,
        down: scene.lights[0].light.direction_world.as_dvec3(),
    };
    let (middle, inner, outer) = (volume(0.0), volume(-1e-4), volume(1e-4));
    let rays = rays(&scene);
    for (counting, lids) in [("depth-fail", true), ("depth-pass", false)] {
        // So far away that nothing is seen of it: left alone, a volume ends behind the floor.
        let found = seen(&gpu, &scene, &[("counting", counting), ("extrude_m", "1000")]);
        let (mut sure, mut by_faces, mut by_count) = (0, [0; 3], [0; 2]);
        for ((overdraw, (eye, along)), surface) in found.overdraw.iter().zip(&rays).zip(&found.surfaces) {
            let faces = |volume: &Volume| {
                let lit = if lids { 0 } else { volume.lit_sides(*eye, *along) };
                2 * usize::from(volume.is_met(*eye, *along)) - lit.min(2)
            };
            let count = |volume: &Volume| surface.is_some_and(|s| volume.holds(s.p_world));
            let [expected, least, most] = [&middle, &inner, &outer].map(faces);
            let [is_in, is_well_in, is_nearly_in] = [&middle, &inner, &outer].map(count);
            assert_eq!(overdraw.under == Under::Nothing, surface.is_none());
            // At an edge rounding decides,
            if least == expected && most == expected {
                assert_eq!(overdraw.faces as usize, expected, "{counting}: from {eye} along {along}");
                by_faces[expected] += 1;
                sure += 1;
            }
            // and on the box itself, where its volume ends.
            if surface.is_some() && is_well_in == is_nearly_in {
                assert_eq!(overdraw.count, i32::from(is_in), "{counting}: {surface:?}");
                by_count[usize::from(is_in)] += 1;
            }
        }
        println!("{counting}: {sure} sure pixels, {by_faces:?} of 0, 1, 2 faces, {by_count:?} lit and dark");
        assert!(sure > 18_000 && by_faces[2] > 1000 && by_count[1] > 200, "{by_faces:?} {by_count:?}");
        assert_eq!(by_faces[1] > 300, !lids, "only lids that are left out leave one face: {by_faces:?}");
        let sum: u64 = found.overdraw.iter().map(|o| u64::from(o.faces)).sum();
        assert_eq!(found.statistics.fragments, sum);
        assert_eq!((found.statistics.picture.most, found.statistics.deepest_count), (2, 1));
        assert!(found.warnings.is_empty(), "{:?}", found.warnings);
    }
}

#[test]
fn nested_casters_are_as_deep_as_they_are_many() {
    let Some(gpu) = gpu() else { return };
    for count in [1, 2, 7, 40] {
        for counting in ["auto", "depth-fail"] {
            let found = seen(&gpu, &nested(count), &[("counting", counting)]);
            assert_eq!(found.statistics.deepest_count, count as i32, "{counting}");
            assert_eq!(found.statistics.picture.most, 2 * count, "{counting}");
        }
    }
}

/// Where 256 volumes lie around a place its stencil is at 0, and V is 1: that is found, and told. One less, and all is well.
#[test]
fn a_stencil_that_wraps_is_told() {
    let Some(gpu) = gpu() else { return };
    let counts = |count: u32, counting| {
        let set = [("counting", counting)];
        let (scene, found) = (nested(count), seen(&gpu, &nested(count), &set));
        let v = v(&gpu, &scene, &set);
        // The stencil and these counts say the same of every pixel.
        for (overdraw, v) in found.overdraw.iter().zip(&v) {
            let lit = overdraw.under == Under::Nothing || overdraw.is_lit();
            assert_eq!(*v, f32::from(u8::from(lit)), "{overdraw:?}");
        }
        let deep = found.overdraw.iter().filter(|o| o.count == count as i32 && o.under == Under::Receiver);
        let wrongly_lit = found
            .overdraw
            .iter()
            .zip(&v)
            .filter(|(o, v)| o.count > 0 && **v == 1.0 && o.under != Under::Nothing);
        (deep.count(), wrongly_lit.count(), found)
    };
    let marked = |found: &Seen| found.rgba.chunks_exact(4).filter(|p| p[1] == 255 && p[0] < 100).count();
    for counting in ["depth-pass", "depth-fail"] {
        let (deep, wrong, found) = counts(255, counting);
        assert!(deep > 200, "{deep}");
        assert_eq!((wrong, found.statistics.wrongly_lit_pixels, found.statistics.deepest_count), (0, 0, 255));
        assert!(found.warnings.is_empty() && marked(&found) == 0, "{:?}", found.warnings);
        let (deep, wrong, found) = counts(256, counting);
        println!("{counting}: {deep} pixels in 256 volumes");
        assert!(deep > 200, "{deep}");
        assert_eq!((wrong, found.statistics.wrongly_lit_pixels), (deep, deep), "the control");
        assert_eq!(found.statistics.deepest_count, 256);
        let [warning] = found.warnings.as_slice() else { panic!("{:?}", found.warnings) };
        for part in [&format!("light 0: {deep} pixels"), "wraps at 256", "`linear`"] {
            assert!(warning.contains(part), "{part} is not in {warning}");
        }
        // The legend hides some.
        assert!((deep / 3..=deep).contains(&marked(&found)), "{} of {deep} are marked", marked(&found));
    }
}

/// Past what the target holds, the view says so in place of numbers.
#[test]
fn more_faces_than_can_be_told_are_told_as_such() {
    let Some(gpu) = gpu() else { return };
    let found = seen(&gpu, &nested(1100), &[("extrude_m", "1000")]);
    assert_eq!(found.statistics.picture.most, 2048);
    assert!(found.statistics.unsure_pixels > 200);
    let warned = found.warnings.iter().any(|w| w.contains("2048 faces of volumes or more"));
    assert!(warned, "{:?}", found.warnings);
}

/// Ghosts that were not pulled apart have no area: with all lids both ways to find faces have the same ones. Depth-pass leaves lids
/// out only where a compute pass finds them.
#[test]
fn both_silhouettes_have_the_same_counts() {
    let Some(gpu) = gpu() else { return };
    for name in ["torus", "columns"] {
        let spot = builtin(name);
        let mirrored = {
            let mut scene = spot.clone();
            let turn = Mat4::from_scale(Vec3::new(1.0, 1.0, -1.0));
            scene.instances.iter_mut().for_each(|i| i.world_from_object = turn * i.world_from_object);
            with_light(scene, sun_of(&spot))
        };
        for (kind, scene) in
            [("spot", &spot), ("sun", &with_light(spot.clone(), sun_of(&spot))), ("mirrored", &mirrored)]
        {
            for counting in ["depth-fail", "depth-pass", "auto"] {
                let of = |silhouette| {
                    seen(&gpu, scene, &[("silhouette", silhouette), ("counting", counting)]).overdraw
                };
                let (compute, vertex) = (of("compute"), of("vertex"));
                // Where nothing is seen nothing is counted, and lids that are left out are missing.
                let differs = |a: &Overdraw, b: &Overdraw| a.count != b.count && a.under != Under::Nothing;
                let counts = compute.iter().zip(&vertex).filter(|(a, b)| differs(a, b)).count();
                let fewer = compute.iter().zip(&vertex).filter(|(a, b)| a.faces > b.faces).count();
                let more = compute.iter().zip(&vertex).filter(|(a, b)| a.faces < b.faces).count();
                println!(
                    "{name}, {kind}, {counting}: {counts} other counts, {fewer} fewer, {more} more faces"
                );
                // Where a side crosses a surface its rounded depth decides, and ghosts are cut along the other diagonal.
                assert!(counts <= 2 && fewer <= 2, "{name}, {kind}, {counting}: {counts} and {fewer} pixels");
                assert!(
                    more <= 2 || counting != "depth-fail",
                    "{name}, {kind}: {more} pixels have more faces"
                );
            }
        }
    }
}

/// The picture's counts are those of the stencil in scenes with many casters, too.
#[test]
fn counts_are_those_that_v_comes_from() {
    let Some(gpu) = gpu() else { return };
    for name in ["torus", "columns", "contact"] {
        for counting in ["auto", "depth-fail"] {
            let (scene, set) = (builtin(name), [("counting", counting)]);
            let (found, v) = (seen(&gpu, &scene, &set), v(&gpu, &scene, &set));
            let other = |(o, v): &(&Overdraw, &f32)| o.under == Under::Receiver && o.is_lit() != (**v == 1.0);
            let others = found.overdraw.iter().zip(&v).filter(other).count();
            assert_eq!(others, 0, "{name}, {counting}");
            let (lit, shadow) =
                (found.statistics.lit.expect("lit"), found.statistics.shadow.expect("shadow"));
            assert!(lit.pixels > 500 && shadow.pixels > 100, "{name}: {lit:?}, {shadow:?}");
            assert!(found.statistics.deepest_count > 0 && found.statistics.wrongly_lit_pixels == 0, "{name}");
        }
    }
}

#[test]
fn the_view_needs_volumes_and_only_it_holds_them() {
    let Some(gpu) = gpu() else { return };
    let scene = builtin("torus");
    let new = |technique, view| {
        let options =
            RenderOptions { view, size: UVec2::splat(32), ..RenderOptions::new(settings(technique, &[])) };
        Renderer::new(&gpu, &scene, &scene.cameras[0].camera, options)
    };
    let refused = new("linear", View::Volumes).expect_err("maps have no volumes").to_string();
    assert!(refused.contains("`linear`") && refused.contains("use the technique `volume`"), "{refused}");
    let other = new("volume", View::Visibility).expect("a renderer");
    assert!(other.overdraw().expect_err("V").to_string().contains("`volumes`"));
}
