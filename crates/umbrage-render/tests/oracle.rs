//! Shadow maps against rays in double precision.

mod common;

use common::raycast::{Errors, errors, truth};
use common::scenes::{builtin, sun_of, with_light};
use common::{gpu, settings, shoot};
use umbrage_render::View;
use umbrage_scene::Scene;

const SIDE: u32 = 160;
/// A map this fine has texels below a pixel in these pictures, so that only the edge itself may be wrong.
const MAP: (&str, &str) = ("map_size", "2048");

fn measured(
    scene: &Scene,
    technique: &str,
    pairs: &[(&str, &str)],
    truth: &[Option<bool>],
) -> Option<Errors> {
    let gpu = gpu()?;
    let shot = shoot(&gpu, scene, settings(technique, pairs), View::Visibility, SIDE);
    Some(errors(truth, &shot.v, SIDE, 2))
}

#[test]
fn away_from_edges_the_map_is_right() {
    for name in ["torus", "columns", "contact", "tilt"] {
        for parallel in [false, true] {
            let mut scene = builtin(name);
            if parallel {
                let sun = sun_of(&scene);
                scene = with_light(scene, sun);
            }
            let truth = truth(&scene, &scene.lights[0].light, SIDE);
            for technique in ["hard", "linear"] {
                let Some(found) = measured(&scene, technique, &[MAP], &truth) else { return };
                println!("{name} {technique} parallel {parallel}: {found:?}");
                assert!(found.sure > 800, "{name}: the oracle must have something to say: {found:?}");
                // A coarse curved mesh keeps a pixel at its terminator, where the neighbouring facet is steeper than the
                // receiver's own; on flat ones there is none.
                let most = if matches!(name, "contact" | "torus" | "columns") { found.sure / 400 } else { 0 };
                assert!(found.acne <= most, "{name} {technique} parallel {parallel}: {found:?}");
                assert!(found.leak * 200 <= found.sure, "{name} {technique} parallel {parallel}: {found:?}");
            }
            let Some(none) = measured(&scene, "unshadowed", &[], &truth) else { return };
            assert!(
                name == "tilt" || none.leak > 20,
                "{name}: without shadows the oracle must object: {none:?}"
            );
        }
    }
}

/// Row H4: a uniform bias must be as large as the steepest receiver needs, and leaks everywhere else.
#[test]
fn a_uniform_bias_leaks_more_than_a_slope_scaled_one() {
    let scene = builtin("contact");
    let truth = truth(&scene, &scene.lights[0].light, SIDE);
    let small = ("map_size", "256");
    let Some(slope) = measured(&scene, "linear", &[small], &truth) else { return };
    let least = (0..12).map(|i| 1e-4 * f64::from(1 << i)).find_map(|bias| {
        let value = format!("{bias}");
        let found = measured(&scene, "matrix-bias", &[small, ("matrix_bias", &value)], &truth)?;
        println!("matrix bias {bias:.4}: {found:?}");
        (found.acne <= slope.acne).then_some((bias, found))
    });
    let (bias, uniform) = least.expect("some uniform bias is large enough");
    println!("slope-scaled: {slope:?}; the least uniform bias without more acne, {bias}: {uniform:?}");
    assert!(uniform.leak > 2 * slope.leak.max(1), "uniform {uniform:?}, slope-scaled {slope:?}");
}
