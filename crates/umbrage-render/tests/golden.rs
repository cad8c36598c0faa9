//! Goldens of visibility, each with a picture that must not pass for it.

mod common;

use common::compare::{check, check_differs, differences};
use common::scenes::{builtin, checker, cut_out, over_floor, panes, sheet, sun_of, with_light};
use common::{gpu, settings, shoot, shoot_with};
use glam::{Mat4, Vec3};
use umbrage_render::umbrage::core::technique::{Bias, Combination, Filter, Projection, Storage};
use umbrage_render::umbrage::core::wgsl::assemble;
use umbrage_render::umbrage::core::{Camera, Light, LightKind, LightShape};
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

/// From where a man would stand at the colonnade's end, so that the warps are strong.
fn standing() -> Scene {
    let mut scene = builtin("columns");
    let (eye, target) = (Vec3::new(-7.5, 1.7, 1.4), Vec3::new(5.0, 1.7, 1.4));
    scene.cameras[0].camera = Camera::look_at(eye, target, 0.9, 0.1, 80.0);
    scene
}

#[test]
fn projection_fitted() {
    visibility("projection-fitted", &standing(), "linear", &[("map_size", "512")]);
}

#[test]
fn projection_adaptive() {
    let pairs = [("projection", "adaptive"), ("map_size", "512")];
    visibility("projection-adaptive", &standing(), "linear", &pairs);
}

#[test]
fn projection_perspective() {
    let pairs = [("projection", "perspective"), ("map_size", "512")];
    visibility("projection-perspective", &standing(), "linear", &pairs);
}

#[test]
fn projection_lispsm() {
    let sun = sun_of(&standing());
    let pairs = [("projection", "lispsm"), ("map_size", "512")];
    visibility("projection-lispsm", &with_light(standing(), sun), "linear", &pairs);
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
    visibility("bias-slope", &builtin("contact"), "linear", &[("bias", "slope"), ("map_size", "256")]);
}

/// The map of `bias_none_shows_acne`, with nothing to set and no acne.
#[test]
fn bias_auto() {
    visibility("bias-auto", &builtin("contact"), "linear", &[("map_size", "128")]);
}

#[test]
fn bias_normal() {
    visibility("bias-normal", &builtin("contact"), "linear", &[("bias", "normal"), ("map_size", "256")]);
}

/// Floor and wall are both lit where they meet, and darken each other: the receiver's plane alone is not enough.
#[test]
fn bias_receiver_plane() {
    let Some(gpu) = gpu() else { return };
    let shot = |bias| {
        let settings = settings("linear", &[("bias", bias), ("map_size", "128")]);
        shoot(&gpu, &builtin("contact"), settings, View::Visibility, 128)
    };
    check_differs("bias-receiver-plane", &shot("auto"), "the automatic bias");
    check("bias-receiver-plane", &shot("receiver-plane"));
}

#[test]
fn pcf() {
    visibility("pcf", &builtin("torus"), "pcf", &[("map_size", "128")]);
}

#[test]
fn kernel() {
    visibility("kernel", &builtin("torus"), "kernel", &[("map_size", "128"), ("width", "7")]);
}

#[test]
fn a_kernel_of_one_s_own() {
    let scene = builtin("torus");
    let Some(gpu) = gpu() else { return };
    let shot = |kernel: Option<&str>| {
        let settings = settings("kernel", &[("map_size", "128"), ("width", "7")]);
        let kernel = kernel.map(std::sync::Arc::from);
        let view = View::Visibility;
        shoot_with(&gpu, &scene, 96, RenderOptions { kernel, view, ..RenderOptions::new(settings) })
    };
    check_differs("own-kernel", &shot(None), "the bell");
    // Two streaks across each other.
    let own = "fn umbrage_kernel(view: UmbrageView, right: vec4f, down: vec4f) -> vec4f {
    return max(vec4f(1.0) - abs(right), vec4f(0.0)) + max(vec4f(1.0) - abs(down), vec4f(0.0));
}";
    check("own-kernel", &shot(Some(own)));
}

#[test]
fn multi_view() {
    let scene = builtin("torus");
    let ball = LightShape::Sphere { radius_m: 0.35 };
    let light = Light { shape: ball, ..scene.lights[0].light };
    visibility("multi-view", &with_light(scene, light), "multi-view", &[("map_size", "128")]);
}

#[test]
fn r32f() {
    visibility("r32f", &builtin("columns"), "linear", &[("storage", "r32f"), ("map_size", "512")]);
}

/// 256 steps of distance are too few, even for a bias that knows of them: shadows begin late.
#[test]
fn packed1() {
    visibility("packed1", &builtin("columns"), "linear", &[("storage", "packed1"), ("map_size", "512")]);
}

#[test]
fn packed2() {
    visibility("packed2", &builtin("columns"), "linear", &[("storage", "packed2"), ("map_size", "512")]);
}

#[test]
fn packed3() {
    visibility("packed3", &builtin("columns"), "packed", &[("map_size", "512")]);
}

#[test]
fn point_light() {
    let scene = builtin("torus");
    let place = Vec3::new(0.0, 2.5, 1.5);
    let point = Light { kind: LightKind::Point, position_world: place, ..scene.lights[0].light };
    visibility("point", &with_light(scene, point), "pcf", &[("map_size", "256")]);
}

/// A user's own function sways the scene; map and picture move alike.
#[test]
fn deformed_casters() {
    let scene = builtin("columns");
    let Some(gpu) = gpu() else { return };
    let shot = |time_s: f32| {
        let sway = "fn umbrage_deform(p_world: vec3f, p_object: vec3f, time_s: f32) -> vec3f {
    return p_world + vec3f(0.2 * p_world.y * sin(p_world.z + time_s), 0.0, 0.0);
}";
        let deform = Some(std::sync::Arc::from(sway));
        let (view, deform_reach_m) = (View::Visibility, 1.2);
        let options = RenderOptions {
            deform,
            deform_reach_m,
            time_s,
            view,
            ..RenderOptions::new(settings("linear", &[]))
        };
        shoot_with(&gpu, &scene, 128, options)
    };
    check_differs("deformed", &shot(0.0), "another moment");
    check("deformed", &shot(1.5));
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

/// Alpha of a surface is not alpha of the picture, whether it mixes, cuts or means nothing.
#[test]
fn pictures_are_opaque() {
    let Some(gpu) = gpu() else { return };
    for scene in [cut_out(AlphaMode::Opaque), cut_out(AlphaMode::Mask { cutoff: 0.5 }), panes()] {
        for samples in [1, 4] {
            let options = RenderOptions { samples, ..RenderOptions::new(settings("linear", &[])) };
            let shot = shoot_with(&gpu, &scene, SIDE, options);
            assert!(shot.rgba.chunks_exact(4).all(|pixel| pixel[3] == 255), "{samples} samples");
        }
    }
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

/// Colours, legend and histogram of a view; half the map, which has half the texels, must not pass for it.
fn density(name: &str, scene: &Scene, view: View, side: u32) {
    let Some(gpu) = gpu() else { return };
    let shot = |size| shoot(&gpu, scene, settings("linear", &[("map_size", size)]), view, side);
    check_differs(name, &shot("256"), "half the map");
    check(name, &shot("512"));
}

#[test]
fn density_from_the_eye() {
    density("density", &standing(), View::Density, 104);
}

#[test]
fn density_from_the_light() {
    density("density-light", &standing(), View::DensityLight, 144);
}

/// A picture that is large enough for the legend, of planes that are less and less of a receiver.
#[test]
fn density_s_legend() {
    density("density-legend", &builtin("tilt"), View::Density, 176);
}

/// Masks and volumes: V, beside which neither the scene without shadows nor that of another choice may pass.
fn of_family(
    name: &str,
    scene: &Scene,
    technique: &str,
    pairs: &[(&str, &str)],
    other: (&str, &[(&str, &str)]),
) {
    let Some(gpu) = gpu() else { return };
    let shot = |technique, pairs| shoot(&gpu, scene, settings(technique, pairs), View::Visibility, 128);
    check_differs(name, &shot("unshadowed", &[]), "the scene without shadows");
    check_differs(name, &shot(other.0, other.1), other.0);
    check(name, &shot(technique, pairs));
}

/// Objects that stand on and beside others: each throws its shadow, and none on itself.
#[test]
fn mask() {
    let coarse: (&str, &[(&str, &str)]) = ("mask", &[("mask_size", "16")]);
    of_family("mask", &builtin("contact"), "mask", &[("mask_size", "256")], coarse);
}

#[test]
fn mask_subtractive() {
    let pairs: &[(&str, &str)] = &[("mask_size", "64"), ("lookup", "nearest")];
    let coarse: (&str, &[(&str, &str)]) = ("mask-subtractive", &[("mask_size", "16")]);
    of_family("mask-subtractive", &builtin("columns"), "mask-subtractive", pairs, coarse);
}

#[test]
fn volume() {
    of_family("volume", &builtin("torus"), "volume", &[], ("linear", &[("map_size", "64")]));
}

#[test]
fn volume_soft() {
    of_family("volume-soft", &builtin("torus"), "volume-soft", &[], ("volume", &[]));
}

/// Faces of volumes without end; those of short ones must not pass for them.
fn faces_of_volumes(name: &str, scene: &str, side: u32) {
    let Some(gpu) = gpu() else { return };
    let shot = |extrude_m| {
        let settings = settings("volume", &[("counting", "depth-pass"), ("extrude_m", extrude_m)]);
        shoot(&gpu, &builtin(scene), settings, View::Volumes, side)
    };
    check_differs(name, &shot("0.2"), "faces of short volumes");
    check(name, &shot("0"));
}

#[test]
fn faces_of_volumes_over_the_scene() {
    faces_of_volumes("volumes-view", "torus", 128);
}

#[test]
fn faces_of_volumes_and_their_legend() {
    faces_of_volumes("volumes-view-legend", "tilt", 176);
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
    Projection::ALL.iter().for_each(|p| golden(format!("projection-{}", p.row().id)));
    for filter in Filter::ALL {
        golden(filter.row().id.to_owned());
    }
    for combination in Combination::all() {
        let text = assemble(&combination.modules()).expect("modules of a combination");
        let function = format!("fn {}(", combination.filter_function());
        assert!(text.contains(&function), "no module of {combination:?} has {function}");
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
