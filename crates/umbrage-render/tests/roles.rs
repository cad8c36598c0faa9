//! Row N1: who throws shadows and who receives them, in every family.

mod common;

use common::found::{Found, boxes, found, kinds};
use common::scenes::with_light;
use common::{gpu, settings};
use glam::{UVec2, Vec3};
use umbrage_render::{Measure, RenderOptions, Renderer};
use umbrage_scene::Scene;

/// Row N1, for every family: what does not throw shadows throws none, and what does not receive has none.
#[test]
fn roles_hold_in_every_family() {
    let Some(gpu) = gpu() else { return };
    let scene = boxes(&[Vec3::new(0.2, 1.6, -0.1)]);
    let on_floor =
        |found: &Found| found.seen().filter(|(p, _)| p.y < 1e-3).map(|(_, v)| v).collect::<Vec<_>>();
    for light in kinds() {
        let scene = with_light(scene.clone(), light);
        let plain = on_floor(&found(&gpu, &scene, "unshadowed", &[]));
        for technique in ["hard", "linear", "pcf", "volume", "volume-soft", "mask", "mask-subtractive"] {
            let dark = |scene: &Scene| {
                let v = on_floor(&found(&gpu, scene, technique, &[]));
                v.iter().zip(&plain).filter(|(v, plain)| v < plain).count()
            };
            let [mut no_blocker, mut no_receiver] = [scene.clone(), scene.clone()];
            no_blocker.instances[0].roles.blocker = false;
            no_receiver.instances[1].roles.receiver = false;
            let what = format!("{technique} {:?}", light.kind);
            assert!(dark(&scene) > 60, "{what}: there is a shadow");
            assert_eq!(dark(&no_blocker), 0, "{what}: a box that throws no shadow");
            assert_eq!(dark(&no_receiver), 0, "{what}: a floor that receives none");
            // Lit as it is drawn, with four samples a pixel.
            let picture = |scene: &Scene, technique: &str| {
                let options = RenderOptions {
                    size: UVec2::splat(48),
                    samples: 4,
                    ..RenderOptions::new(settings(technique, &[]))
                };
                let mut renderer =
                    Renderer::new(&gpu, scene, &scene.cameras[0].camera, options).expect("a renderer");
                renderer.frame(Measure::Frame).expect("a frame");
                renderer.picture().expect("a picture")
            };
            let lit = |scene: &Scene| {
                let pictures = [picture(scene, technique), picture(scene, "unshadowed")];
                pictures[0].iter().zip(&pictures[1]).filter(|(a, b)| a.abs_diff(**b) > 1).count()
            };
            let mut neither = no_receiver.clone();
            neither.instances[0].roles.receiver = false;
            assert!(lit(&scene) > 60, "{what}: four samples show a shadow");
            assert_eq!(lit(&neither), 0, "{what}: nothing receives, with four samples");
        }
    }
}
