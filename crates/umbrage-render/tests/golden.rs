//! Goldens of visibility, each with a picture that must not pass for it.

mod common;

use common::compare::{check, check_differs, differences};
use common::scenes::{builtin, checker, cut_out, over_floor, sheet, sun_of, with_light};
use common::{gpu, settings, shoot, shoot_with};
use glam::{Mat4, Vec3};
use umbrage_render::umbrage::core::technique::{Bias, Filter, Storage};
use umbrage_render::umbrage::core::wgsl::assemble;
use umbrage_render::umbrage::core::{Light, LightKind};
use umbrage_render::{RenderOptions, View};
use umbrage_scene::{AlphaMode, Material, Scene};

const SIDE: u32 = 256;

/// V of a technique against its golden; the same scene without shadows must not pass.
fn visibility(name: &str, scene: &Scene, technique: &str, pairs: &[(&str, &str)]) {
    let Some(gpu) = gpu() else { return };
    let unshadowed = shoot(&gpu, scene, settings("unshadowed", &[]), View::Visibility, SIDE);
    check_differs(name, &unshadowed, "the scene without shadows");
    check(name, &shoot(&gpu, scene, settings(technique, pairs), View::Visibility, SIDE));
}

#[test]
fn nearest() {
    visibility("nearest", &builtin("torus"), "hard", &[("map_size", "128")]);
}

#[test]
fn linear() {
    visibility("linear", &builtin("torus"), "linear", &[("map_size", "128")]);
}

#[test]
fn depth16() {
    visibility("depth16", &builtin("columns"), "linear", &[("storage", "depth16"), ("map_size", "512")]);
}

#[test]
fn depth24() {
    visibility("depth24", &builtin("columns"), "linear", &[("storage", "depth24"), ("map_size", "512")]);
}

#[test]
fn depth32f() {
    visibility("depth32f", &builtin("columns"), "linear", &[("storage", "depth32f"), ("map_size", "512")]);
}

#[test]
fn bias_none_shows_acne() {
    visibility("bias-none", &builtin("tilt"), "linear", &[("bias", "none"), ("map_size", "64")]);
}

#[test]
fn bias_constant() {
    visibility("bias-constant", &builtin("tilt"), "linear", &[("bias", "constant"), ("map_size", "64")]);
}

#[test]
fn bias_slope() {
    visibility("bias-slope", &builtin("contact"), "linear", &[("map_size", "256")]);
}

#[test]
fn bias_matrix() {
    visibility("bias-matrix", &builtin("tilt"), "matrix-bias", &[("map_size", "64")]);
}

/// The negative control: the same map without its way of doing without a bias.
fn unbiased(name: &str, bias: &str) {
    let pairs = |bias| [("bias", bias), ("map_size", "512")];
    visibility(name, &builtin("contact"), "linear", &pairs(bias));
    let Some(gpu) = gpu() else { return };
    let none = shoot(&gpu, &builtin("contact"), settings("linear", &pairs("none")), View::Visibility, SIDE);
    check_differs(name, &none, "no bias");
}

#[test]
fn bias_midpoint() {
    unbiased("bias-midpoint", "midpoint");
}

#[test]
fn bias_second_depth() {
    unbiased("bias-second-depth", "second-depth");
}

/// Every storage, filter and kind of light: the scene must be in shadow where it is with automatic bias, but for edges.
#[test]
fn peeled_maps_agree_with_others_for_every_storage_filter_and_light() {
    let Some(gpu) = gpu() else { return };
    let scene = builtin("columns");
    let spot = scene.lights[0].light;
    let point = Light { kind: LightKind::Point, ..spot };
    for (light, kind) in [(spot, "spot"), (sun_of(&scene), "directional"), (point, "point")] {
        let scene = with_light(scene.clone(), light);
        for bias in ["midpoint", "second-depth"] {
            for (storage, filter) in Storage::ALL
                .iter()
                .map(|s| (*s, Filter::Linear))
                .chain(Filter::ALL.iter().map(|f| (Storage::Auto, *f)))
                .filter(|(storage, _)| *storage != Storage::Packed1)
            {
                let shot = |bias| {
                    let filter = ("filter", filter.row().id);
                    let pairs = [("storage", storage.row().id), filter, ("bias", bias), ("map_size", "512")];
                    shoot(&gpu, &scene, settings("linear", &pairs), View::Visibility, 96)
                };
                let (plain, peeled) = (shot("auto"), shot(bias));
                let off = plain.v.iter().zip(&peeled.v).filter(|(a, b)| (*a - *b).abs() > 0.5).count();
                let dark = plain.v.iter().filter(|v| **v < 0.5).count();
                println!("{kind} {bias} {} {}: {off} off, {dark} dark", storage.row().id, filter.row().id);
                assert!(dark > 500 && off * 40 < 96 * 96, "{kind} {bias} {storage:?} {filter:?}: {off}");
            }
        }
    }
}

#[test]
fn directional() {
    let scene = builtin("contact");
    let sun = sun_of(&scene);
    visibility("directional", &with_light(scene, sun), "linear", &[("map_size", "512")]);
}

#[test]
fn cut_out_casters() {
    visibility("cut-out", &cut_out(AlphaMode::Mask { cutoff: 0.5 }), "linear", &[("map_size", "512")]);
    let Some(gpu) = gpu() else { return };
    let solid = shoot(&gpu, &cut_out(AlphaMode::Opaque), settings("linear", &[]), View::Visibility, SIDE);
    check_differs("cut-out", &solid, "a sheet without holes");
}

#[test]
fn cone_edge() {
    let scene = builtin("torus");
    let wide = scene.lights[0].light;
    let cone = |outer_rad| {
        let kind = LightKind::Spot { inner_rad: 0.1, outer_rad };
        with_light(scene.clone(), Light { kind, ..wide })
    };
    let Some(gpu) = gpu() else { return };
    let shot = |scene: &Scene| shoot(&gpu, scene, settings("linear", &[]), View::Visibility, SIDE);
    check_differs("cone-edge", &shot(&cone(0.24)), "a wider cone");
    check("cone-edge", &shot(&cone(0.2)));
}

/// A light between two posts that looks at one of them: the other, and the floor before it, would be lit by the phantom
/// that the division by w mirrors through the light.
#[test]
fn back_projection() {
    let post = |x: f32| sheet(Vec3::new(x, 0.8, 0.0), Vec3::NEG_Z * 0.5 * x.signum(), Vec3::Y * 0.8, 0);
    let material = Material { double_sided: true, ..Material::default() };
    let at_home = |mesh| (mesh, Mat4::IDENTITY);
    let scene = over_floor(vec![material], vec![], vec![post(-1.5), post(1.5)], &[at_home(0), at_home(1)]);
    let middle = Vec3::new(0.0, 1.2, 0.0);
    let looking = |way: f32| {
        let target = middle + Vec3::new(way, -0.4, 0.0);
        with_light(scene.clone(), Light::spot(middle, target, 0.9, 1.1))
    };
    let Some(gpu) = gpu() else { return };
    let shot = |scene: &Scene| shoot(&gpu, scene, settings("linear", &[]), View::Visibility, SIDE);
    check_differs("back-projection", &shot(&looking(-1.0)), "the light turned round");
    check("back-projection", &shot(&looking(1.0)));
}

#[test]
fn cookie() {
    let mut scene = builtin("torus");
    scene.images.push(checker(64, 255));
    let slide = scene.images.len() - 1;
    // A slide has colour: squares of two tints.
    for (i, pixel) in scene.images[slide].rgba.chunks_exact_mut(4).enumerate() {
        let (x, y) = (i % 64 / 8, i / 64 / 8);
        pixel.copy_from_slice(if (x + y) % 2 == 0 { &[255, 190, 90, 255] } else { &[30, 60, 120, 255] });
    }
    let Some(gpu) = gpu() else { return };
    let options =
        || RenderOptions { view: View::Final, ambient: 0.0, ..RenderOptions::new(settings("linear", &[])) };
    let plain = shoot_with(&gpu, &scene, 64, options());
    check_differs("cookie", &plain, "the light without its slide");
    scene.lights[0].cookie = Some(slide);
    check("cookie", &shoot_with(&gpu, &scene, 64, options()));
}

#[test]
fn fill_keeps_some_diffuse_in_shadow() {
    let scene = builtin("torus");
    let Some(gpu) = gpu() else { return };
    let shot = |fill| {
        let options = RenderOptions { fill, ambient: 0.0, ..RenderOptions::new(settings("linear", &[])) };
        shoot_with(&gpu, &scene, 96, options)
    };
    check_differs("fill", &shot(0.0), "shadows without fill");
    check("fill", &shot(0.3));
}

#[test]
fn the_documents_shading() {
    let scene = builtin("torus");
    let Some(gpu) = gpu() else { return };
    let shot = |all_blinn| {
        let options = RenderOptions { all_blinn, ..RenderOptions::new(settings("linear", &[])) };
        shoot_with(&gpu, &scene, 80, options)
    };
    check_differs("documents", &shot(false), "metallic-roughness");
    check("documents", &shot(true));
}

#[test]
fn mirrored_and_plain_closed_casters_throw_mirrored_shadows() {
    // A closed caster's back faces are culled; a mirroring transform turns them to the front.
    let torus = builtin("torus");
    let mesh = torus.meshes.iter().find(|m| m.name == "torus").expect("a torus").clone();
    let placed = Mat4::from_translation(Vec3::new(0.0, 1.2, 0.0)) * Mat4::from_scale(Vec3::splat(0.8));
    let with = |mirror: Vec3| {
        let mesh = umbrage_scene::Mesh { material: 0, ..mesh.clone() };
        let mut scene = over_floor(
            vec![Material::default()],
            vec![],
            vec![mesh],
            &[(0, Mat4::from_scale(mirror) * placed)],
        );
        // Light and camera in the plane of the mirror: the picture must be its own mirror image.
        scene.lights[0].light = Light::spot(Vec3::new(0.0, 7.0, 2.0), Vec3::ZERO, 0.5, 0.6);
        scene
    };
    let Some(gpu) = gpu() else { return };
    let shot = |mirror| shoot(&gpu, &with(mirror), settings("linear", &[]), View::Visibility, SIDE);
    let (plain, mirrored) = (shot(Vec3::ONE), shot(Vec3::new(-1.0, 1.0, 1.0)));
    let flipped: Vec<u8> = mirrored
        .rgba
        .chunks_exact(4 * SIDE as usize)
        .flat_map(|row| row.chunks_exact(4).rev().flatten().copied().collect::<Vec<_>>())
        .collect();
    let off = differences(&plain.rgba, &flipped).len();
    // Rounding may move a sample across an edge; a shadow that is missing moves thousands.
    assert!(off < 60, "{off} pixels differ");
    let shadowed = plain.v.iter().filter(|v| **v < 0.5).count();
    assert!(shadowed > 1000, "only {shadowed} pixels are in shadow");
}

/// Floors and walls that nothing lies behind are not drawn into the map; V must not know. A few
/// pixels may become lighter: those where the floor shadowed itself.
#[test]
fn leaving_out_idle_casters_changes_no_picture() {
    let Some(gpu) = gpu() else { return };
    for name in ["torus", "columns", "contact"] {
        let scene = builtin(name);
        let shot = |all_casters| {
            let settings = settings("linear", &[("map_size", "512")]);
            let view = View::Visibility;
            shoot_with(
                &gpu,
                &scene,
                SIDE,
                RenderOptions { view, all_casters, ..RenderOptions::new(settings) },
            )
        };
        let (all, needed) = (shot(true), shot(false));
        let darker = all.v.iter().zip(&needed.v).filter(|(all, needed)| *needed < *all).count();
        assert_eq!(darker, 0, "{name}: a caster less made {darker} pixels darker");
        let lighter = all.v.iter().zip(&needed.v).filter(|(all, needed)| **needed > **all + 0.05).count();
        assert!(lighter < 30, "{name}: {lighter} pixels are lit that were not");
    }
}

/// Fits, bias and formats follow the scene: a thousand times larger or a hundred times smaller, V is the same.
#[test]
fn no_scale_changes_visibility() {
    let Some(gpu) = gpu() else { return };
    for name in ["torus", "contact", "columns", "tilt"] {
        let shot = |scale: &str| {
            let scene = builtin(&format!("{name}?scale={scale}"));
            shoot(&gpu, &scene, settings("linear", &[("map_size", "512")]), View::Visibility, SIDE)
        };
        let plain = shot("1");
        for scale in ["0.01", "1000"] {
            // Rounding may move a sample across an edge.
            let off = differences(&plain.rgba, &shot(scale).rgba).len();
            assert!(off <= 12, "{name} at scale {scale}: {off} pixels differ");
        }
    }
}

/// A row of a table without a golden of its own is a choice that nobody looked at.
#[test]
fn every_choice_of_the_tables_has_a_golden_and_every_filter_its_shader() {
    let golden = |name: String| {
        let path =
            std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("goldens").join(format!("{name}.png"));
        assert!(path.is_file(), "{} is missing", path.display());
    };
    Storage::ALL.iter().filter(|s| **s != Storage::Auto).for_each(|s| golden(s.row().id.to_owned()));
    Bias::ALL.iter().for_each(|b| golden(format!("bias-{}", b.row().id)));
    for filter in Filter::ALL {
        golden(filter.row().id.to_owned());
        let text = assemble(filter.row().modules).expect("modules of a filter");
        let function = format!("fn umbrage_filter_{}(", filter.row().id);
        assert!(text.contains(&function), "no module of {} has {function}", filter.row().id);
    }
}

#[test]
fn the_comparison_sees_one_altered_pixel() {
    let plain = vec![100u8; 4 * 64];
    let mut altered = plain.clone();
    altered[40] = 103;
    assert_eq!(differences(&plain, &altered), [(10, 3)]);
    altered[40] = 102;
    assert!(differences(&plain, &altered).is_empty());
}
