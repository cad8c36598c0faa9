//! Coloured light through translucent casters: its golden, what it must not change, and what it costs.

mod common;

use common::compare::{check, check_differs, differences};
use common::scenes::{builtin, over_floor, panes, sheet, sun_of, with_light};
use common::{Shot, gpu, settings, shoot, shoot_with};
use glam::{Mat4, Vec3, Vec4};
use umbrage_render::umbrage::core::{DEPTH, Light, LightKind};
use umbrage_render::{Measure, RenderOptions, Renderer, View};
use umbrage_scene::{AlphaMode, Material, Scene};

const SIDE: u32 = 256;

/// Light through panes of glass. The same panes cut by their alpha must not pass for it, and neither must a light whose colours are
/// not multiplied.
#[test]
fn colored_light() {
    let Some(gpu) = gpu() else { return };
    let shot = |scene: &Scene, technique, pairs: &[(&str, &str)]| {
        let size = ("map_size", "512");
        let pairs: Vec<_> = pairs.iter().copied().chain([size]).collect();
        shoot(&gpu, scene, settings(technique, &pairs), View::Visibility, SIDE)
    };
    let scene = panes();
    check_differs("colored", &shot(&scene, "colored", &[("translucent", "cut")]), "panes cut by their alpha");
    let mut one = panes();
    one.instances.remove(0);
    check_differs("colored", &shot(&one, "colored", &[]), "a pane less");
    let colored = shot(&scene, "colored", &[]);
    // Any storage, filter and bias gives the same but for edges.
    for pairs in [
        [("storage", "r32f"), ("filter", "linear")],
        [("storage", "packed3"), ("filter", "linear")],
        [("storage", "depth16"), ("bias", "receiver-plane")],
        [("filter", "nearest"), ("bias", "slope")],
        [("filter", "pcf"), ("bias", "auto")],
        [("filter", "kernel"), ("storage", "r32f")],
    ] {
        let off = differences(&colored.rgba, &shot(&scene, "colored", &pairs).rgba).len();
        println!("{pairs:?}: {off} pixels differ");
        assert!(off * 10 < colored.v.len(), "{pairs:?}: {off} pixels differ");
    }
    check("colored", &colored);
}

/// Where no translucent caster stands before or beside a surface, V is what it is without colours: to the last bit.
#[test]
fn colours_change_nothing_where_there_is_no_glass() {
    let Some(gpu) = gpu() else { return };
    for pairs in [[("map_size", "512"), ("storage", "auto")], [("map_size", "512"), ("storage", "packed3")]] {
        for filter in ["nearest", "linear", "pcf", "kernel"] {
            let shot = |translucent| {
                let pairs: Vec<_> =
                    pairs.into_iter().chain([("filter", filter), ("translucent", translucent)]).collect();
                shoot(&gpu, &builtin("columns"), settings("linear", &pairs), View::Visibility, SIDE)
            };
            let (cut, colored) = (shot("cut"), shot("colored"));
            let worst = cut.v.iter().zip(&colored.v).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            assert!(worst < 1e-6, "{filter} {pairs:?}: {worst}");
        }
    }
}

/// Panes that lean, each under the last, over a black floor: what is bright in the picture is a pane.
fn leaning_panes(colors: &[[f32; 4]]) -> Scene {
    let material = |color: &[f32; 4]| Material {
        alpha: AlphaMode::Blend,
        double_sided: true,
        base_color: Vec4::from(*color),
        ..Material::default()
    };
    let right = Vec3::new(1.0, 0.3, 0.1) * 1.2;
    let pane = |i| sheet(Vec3::new(0.0, 2.4 - 0.7 * i as f32, 0.0), right, Vec3::new(0.0, 0.5, -1.0), i);
    let meshes: Vec<_> = (0..colors.len()).map(pane).collect();
    let placed: Vec<_> = (0..meshes.len()).map(|mesh| (mesh, Mat4::IDENTITY)).collect();
    let mut scene = over_floor(colors.iter().map(material).collect(), vec![], meshes, &placed);
    let black = scene.materials.len() - 1;
    scene.materials[black].base_color = Vec4::new(0.0, 0.0, 0.0, 1.0);
    scene.materials[black].reflectance =
        umbrage_scene::Reflectance::Blinn { specular: Vec3::ZERO, shininess: 1.0, ambient: Vec3::ZERO };
    scene
}

/// A pane does not colour its own light, however it leans and however coarse the map is.
#[test]
fn a_pane_does_not_colour_itself() {
    let Some(gpu) = gpu() else { return };
    let shot = |technique, pairs: &[(&str, &str)]| {
        let options =
            RenderOptions { ambient: 0.0, fill: 0.0, ..RenderOptions::new(settings(technique, pairs)) };
        shoot_with(&gpu, &leaning_panes(&[[0.9, 0.5, 0.3, 0.9]]), SIDE, options)
    };
    let bare = shot("unshadowed", &[]);
    let lit = bare.rgba.chunks_exact(4).filter(|p| p[0] > 120).count();
    assert!(lit > 2000, "the pane is lit in {lit} pixels only");
    let coarse = ("map_size", "64");
    let darker = |shot: &Shot| {
        let pairs = bare.rgba.chunks_exact(4).zip(shot.rgba.chunks_exact(4));
        pairs.filter(|(bare, now)| bare[0] > 120 && now[0] + 6 < bare[0]).count()
    };
    for filter in ["nearest", "linear", "pcf"] {
        let found = darker(&shot("colored", &[coarse, ("filter", filter)]));
        assert_eq!(found, 0, "{filter}: {found} of {lit} pixels are darker than without shadow");
    }
    // The control: without a bias it does.
    assert!(darker(&shot("colored", &[coarse, ("bias", "none")])) > lit / 20);
}

/// The limit of one map of colours: what is opaque is right wherever it stands, but a pane that stands behind another is coloured by
/// itself too, and would be by any behind it.
#[test]
fn a_pane_behind_a_pane_is_coloured_by_both() {
    let Some(gpu) = gpu() else { return };
    let glass = |r: f32, g: f32| Material {
        alpha: AlphaMode::Blend,
        double_sided: true,
        base_color: Vec4::new(r, g, g, 0.5),
        ..Material::default()
    };
    // In the light's way one before the other; in the camera's beside each other.
    let flat = |p: Vec3, material| sheet(p, Vec3::X * 0.5, Vec3::NEG_Z * 0.5, material);
    let meshes = vec![flat(Vec3::new(-0.6, 2.8, 0.6), 0), flat(Vec3::new(0.0, 1.0, 0.0), 1)];
    let placed = [(0, Mat4::IDENTITY), (1, Mat4::IDENTITY)];
    let mut scene = over_floor(vec![glass(1.0, 0.2), glass(1.0, 1.0)], vec![], meshes, &placed);
    let floor = scene.materials.len() - 1;
    let middle = |scene: &Scene, technique| {
        let options =
            RenderOptions { ambient: 0.0, fill: 0.0, ..RenderOptions::new(settings(technique, &[])) };
        let shot = shoot_with(&gpu, scene, SIDE, options);
        let camera = &scene.cameras[0].camera;
        let clip = camera.clip_from_view(1.0, DEPTH)
            * camera.view_from_world()
            * Vec3::new(0.0, 1.0, 0.0).extend(1.0);
        let side = SIDE as f32;
        let (x, y) = ((clip.x / clip.w * 0.5 + 0.5) * side, (0.5 - clip.y / clip.w * 0.5) * side);
        let at = 4 * (y as usize * SIDE as usize + x as usize);
        let linear = |level: u8| ((f32::from(level) / 255.0 + 0.055) / 1.055).powf(2.4);
        [0, 1].map(|c| linear(shot.rgba[at + c]))
    };
    let share = |scene: &Scene| {
        let (bare, colored) = (middle(scene, "unshadowed"), middle(scene, "colored"));
        [0, 1].map(|c| colored[c] / bare[c])
    };
    // Of the pane alone: the floor is black. Truth: (0.5, 0.3), what the red pane lets through; half of it by the lower pane itself.
    scene.materials[floor].base_color = Vec4::new(0.0, 0.0, 0.0, 1.0);
    scene.materials[floor].reflectance =
        umbrage_scene::Reflectance::Blinn { specular: Vec3::ZERO, shininess: 1.0, ambient: Vec3::ZERO };
    let [red, green] = share(&scene);
    println!("of a pane behind a pane: {red:.3} {green:.3}, in truth 0.5 0.3");
    assert!((red - 0.25).abs() < 0.02 && (green - 0.15).abs() < 0.02, "{red} {green}");
    // Were it opaque, it would be right.
    scene.materials[1].alpha = AlphaMode::Opaque;
    let [red, green] = share(&scene);
    assert!((red - 0.5).abs() < 0.02 && (green - 0.3).abs() < 0.02, "{red} {green}");
}

/// Memory and passes are counted: a map of colours and one of the nearest translucent casters for each view.
#[test]
fn what_coloured_light_costs_is_counted() {
    let Some(gpu) = gpu() else { return };
    let scene = panes();
    let sun = sun_of(&scene);
    let point = Light { kind: LightKind::Point, ..scene.lights[0].light };
    for (light, views) in [(scene.lights[0].light, 1), (sun, 1), (point, 6)] {
        let scene = with_light(scene.clone(), light);
        let texels = 64 * 64;
        for (storage, bytes) in [("depth16", 2 + 4 + 2), ("r32f", 4 + 4 + 4)] {
            let settings = settings("colored", &[("map_size", "64"), ("storage", storage)]);
            let options = RenderOptions { size: glam::UVec2::splat(32), ..RenderOptions::new(settings) };
            let mut renderer =
                Renderer::new(&gpu, &scene, &scene.cameras[0].camera, options).expect("a renderer");
            // Both maps of distance are drawn with a depth of their own.
            let scratch = if storage == "r32f" { 2 * 4 * texels } else { 0 };
            assert_eq!(renderer.shadow_memory_bytes(), views * bytes * texels + scratch, "{storage} {views}");
            let report = renderer.frame(Measure::Frame).expect("a frame");
            let of =
                |name: &str| report.passes.iter().filter(|p| p.name.starts_with(name)).collect::<Vec<_>>();
            for name in ["shadow-map", "light-colors", "translucent-map"] {
                assert_eq!(of(name).len() as u64, views, "{name}");
            }
            let draws = |name| of(name).iter().map(|p| p.work.draws).sum::<u64>();
            assert!(draws("light-colors") >= 4 && draws("light-colors") == draws("translucent-map"));
            // The panes are not among what blocks light.
            assert!((1..=2 * views).contains(&draws("shadow-map")), "{}", draws("shadow-map"));
        }
    }
}
