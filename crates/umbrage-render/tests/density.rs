//! Row H9: the texels per pixel that the GPU paints are those of the closed form, and the light's eye sees the same numbers.

mod common;

use common::scenes::{builtin, sun_of, with_light};
use common::{gpu, settings};
use glam::{IVec2, UVec2, Vec3};
use umbrage_render::umbrage::core::density::{Density, Raster, texels_per_pixel};
use umbrage_render::umbrage::core::fit::ShadowView;
use umbrage_render::umbrage::core::lookup::{locate, texel_at};
use umbrage_render::umbrage::core::technique::Settings;
use umbrage_render::umbrage::core::{Camera, DEPTH, Light, LightKind};
use umbrage_render::{DrawnSurface, EDGE_ON_COS, Gpu, Measure, RenderOptions, Renderer, View};
use umbrage_scene::Scene;

const PICTURE: UVec2 = UVec2::new(160, 90);
const MAP_TEXEL: u32 = 512;
/// How far single precision may be off, of the greatest stretch there is in a pixel.
const TOLERANCE: f64 = 1e-4;

fn frame<'a>(gpu: &'a Gpu, scene: &Scene, settings: &Settings, view: View, size: UVec2) -> Renderer<'a> {
    let options = RenderOptions { view, size, ..RenderOptions::new(settings.clone()) };
    let mut renderer = Renderer::new(gpu, scene, &scene.cameras[0].camera, options).expect("a renderer");
    renderer.frame(Measure::Frame).expect("a frame");
    renderer
}

fn standing() -> Scene {
    let mut scene = builtin("columns");
    let (eye, target) = (Vec3::new(-7.5, 1.7, 1.4), Vec3::new(5.0, 1.7, 1.4));
    scene.cameras[0].camera = Camera::look_at(eye, target, 0.9, 0.1, 80.0);
    scene
}

fn point_of(scene: &Scene) -> Light {
    Light {
        kind: LightKind::Point,
        position_world: Vec3::new(-2.0, 2.4, 2.0),
        near_m: None,
        far_m: None,
        ..scene.lights[0].light
    }
}

/// Of a point light, the tile that looks at a place.
fn view_of<'v>(views: &'v [ShadowView], light: &Light, p_world: Vec3) -> &'v ShadowView {
    let way = (p_world - light.position_world).to_array();
    let axis = (0..3).rev().max_by(|a, b| way[*a].abs().total_cmp(&way[*b].abs())).expect("three");
    if views.len() == 1 { &views[0] } else { &views[2 * axis + usize::from(way[axis] < 0.0)] }
}

/// By how much a surface is a receiver: above 0 it is, below 0 it is none, near 0 rounding decides.
fn receives(light: &Light, view: &ShadowView, surface: &DrawnSurface) -> f32 {
    let p_world = surface.p_world.as_vec3();
    let towards = match light.kind {
        LightKind::Directional => -light.direction_world,
        _ => (light.position_world - p_world).normalize(),
    };
    let cone = match light.kind {
        LightKind::Spot { outer_rad, .. } => (-towards).dot(light.direction_world) - outer_rad.cos(),
        _ => 1.0,
    };
    let at = locate(&view.texture_from_world(), p_world);
    let map = 0.5 - (at.uv - 0.5).abs().max_element();
    let faces = surface.normal_world.dot(towards) - EDGE_ON_COS;
    [cone, if at.inside { map } else { map.min(-1.0) }, faces, surface.shading_normal_world.dot(towards)]
        .into_iter()
        .fold(f32::INFINITY, f32::min)
}

/// Farthest of the GPU's numbers from the formula's, as a share of the greatest.
fn off(gpu: Density, formula: Density) -> f64 {
    let apart = |a: f64, b: f64| (a - b).abs();
    let most = apart(gpu.mean, formula.mean).max(apart(gpu.least, formula.least));
    most.max(apart(gpu.most, formula.most)) / formula.most
}

/// Compares every pixel; returns the greatest difference.
fn compare(name: &str, scene: &Scene, projection: &str) -> f64 {
    let Some(gpu) = gpu() else { return 0.0 };
    let size = MAP_TEXEL.to_string();
    let settings = settings("linear", &[("projection", projection), ("map_size", &size)]);
    let renderer = frame(&gpu, scene, &settings, View::Density, PICTURE);
    let (light, camera) = (&scene.lights[0].light, &scene.cameras[0].camera);
    let aspect = PICTURE.x as f32 / PICTURE.y as f32;
    let picture = Raster::new(camera.clip_from_view(aspect, DEPTH) * camera.view_from_world(), PICTURE);
    let (found, surfaces) = (renderer.density().expect("density"), renderer.surfaces().expect("surfaces"));
    let (mut count, mut worst) = (0, 0f64);
    for (i, (found, surface)) in found.iter().zip(&surfaces).enumerate() {
        let Some(surface) = surface else {
            assert!(found.is_none(), "{name}: pixel {i} shows nothing, and has {found:?}");
            continue;
        };
        let view = view_of(renderer.views(), light, surface.p_world.as_vec3());
        let receives = receives(light, view, surface);
        if receives.abs() > 1e-4 {
            assert_eq!(found.is_some(), receives > 0.0, "{name}: pixel {i}, {receives}: {surface:?}");
        }
        if let Some(found) = found {
            let normal = surface.normal_world.as_dvec3().normalize();
            let formula = texels_per_pixel(&view.raster(MAP_TEXEL), &picture, surface.p_world, normal);
            let off = off(*found, formula);
            assert!(off < TOLERANCE, "{name}: pixel {i} has {found:?}, not {formula:?}");
            (count, worst) = (count + 1, worst.max(off));
        }
    }
    println!("{name}, {projection}: {count} pixels, off by {worst:.1e} at most");
    assert!(count > 1500, "{name}: {count} receivers");
    let told = renderer.density_statistics().expect("statistics").expect("receivers");
    assert_eq!(told.pixels, count);
    assert!((told.histogram.iter().map(|octave| octave.share).sum::<f64>() - 1.0).abs() < 1e-9);
    worst
}

#[test]
fn the_gpu_paints_what_the_formula_says() {
    let scene = standing();
    let sun = with_light(scene.clone(), sun_of(&scene));
    let point = with_light(scene.clone(), point_of(&scene));
    for (name, scene) in [("spot", &scene), ("sun", &sun)] {
        for projection in ["fitted", "adaptive", "perspective", "lispsm"] {
            compare(name, scene, projection);
        }
    }
    compare("point", &point, "fitted");
}

/// What the eye sees in full light is in the light's map too: at its texel, with the same number. On a round column a coarse
/// texel shows another normal than the pixel does, so not all of them can agree.
#[test]
fn the_light_sees_the_same_numbers() {
    let scene = builtin("columns");
    let sun = with_light(scene.clone(), sun_of(&scene));
    let Some(gpu) = gpu() else { return };
    // As large as the map: a pixel a texel.
    let size = UVec2::splat(256);
    for (name, scene, projection) in [
        ("spot", &scene, "fitted"),
        ("spot", &scene, "lispsm"),
        ("sun", &sun, "fitted"),
        ("sun", &sun, "lispsm"),
    ] {
        let settings = settings("linear", &[("map_size", "256"), ("projection", projection)]);
        let eye = frame(&gpu, scene, &settings, View::Density, size);
        let light = frame(&gpu, scene, &settings, View::DensityLight, size);
        let v = frame(&gpu, scene, &settings, View::Visibility, size).visibility().expect("V");
        let (from_eye, surfaces) = (eye.density().expect("density"), eye.surfaces().expect("surfaces"));
        let from_light = light.density().expect("density");
        let texture_from_world = light.views()[0].texture_from_world();
        let (mut lit, mut found, mut alike) = (0, 0, 0);
        let mut hit = vec![false; from_light.len()];
        for ((density, surface), v) in from_eye.iter().zip(&surfaces).zip(&v) {
            let (Some(density), Some(surface)) = (density, surface) else { continue };
            let at = texel_at(locate(&texture_from_world, surface.p_world.as_vec3()).uv, size);
            hit[(at.y * size.x + at.x) as usize] = true;
            if *v < 1.0 {
                continue;
            }
            lit += 1;
            if let Some(other) = from_light[(at.y * size.x + at.x) as usize] {
                found += 1;
                alike += usize::from((other.mean / density.mean).ln().abs() < 0.15);
            }
        }
        // And what the eye does not see is not there: near each texel there is one that a pixel of the eye falls into, at most
        // as far as the texels along a pixel.
        let stray = |(i, density): (usize, &Option<Density>)| {
            let Some(density) = density else { return false };
            let reach = density.most.ceil() as i32 + 1;
            let at = IVec2::new(i as i32 % size.x as i32, i as i32 / size.x as i32);
            let near = |(dx, dy)| {
                let other = at + IVec2::new(dx, dy);
                let inside = other.min_element() >= 0 && other.max_element() < size.x as i32;
                inside && hit[(other.y * size.x as i32 + other.x) as usize]
            };
            !(-reach..=reach).flat_map(|dx| (-reach..=reach).map(move |dy| (dx, dy))).any(near)
        };
        let shown = from_light.iter().flatten().count();
        let strays = from_light.iter().enumerate().filter(|texel| stray(*texel)).count();
        println!(
            "{name}, {projection}: {lit} lit pixels, {found} in the map, {alike} alike; {shown} texels, {strays} stray"
        );
        assert!(lit > 5000 && 100 * found > 96 * lit && 100 * alike > 90 * found, "{name}, {projection}");
        assert!(
            shown > 2000 && 500 * strays < shown,
            "{name}, {projection}: {strays} of {shown} texels are unseen"
        );
    }
}

/// All six tiles of a point light, and a picture that is no map's.
#[test]
fn a_point_light_shows_its_tiles() {
    let scene = standing();
    let point = with_light(scene.clone(), point_of(&scene));
    let Some(gpu) = gpu() else { return };
    let settings = settings("linear", &[("map_size", "128")]);
    let renderer = frame(&gpu, &point, &settings, View::DensityLight, UVec2::new(192, 128));
    let found = renderer.density().expect("density");
    let tiles: std::collections::HashSet<usize> = (0..found.len())
        .filter(|i| found[*i].is_some())
        .map(|i| i % 192 / 64 + 3 * (i / (192 * 64)))
        .collect();
    assert!(tiles.len() >= 3, "{tiles:?}");
    let other = frame(&gpu, &point, &settings, View::Visibility, UVec2::new(64, 64));
    assert!(other.density().expect_err("V").to_string().contains("density"));
}
