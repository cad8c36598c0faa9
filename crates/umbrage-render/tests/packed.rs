//! Distance in 8-bit channels: how near it comes to the distance in a float, texel by texel. The bytes are decoded here, by hand.

mod common;

use common::scenes::builtin;
use common::{gpu, settings};
use umbrage_render::{Gpu, Measure, RenderOptions, Renderer, View};

/// The first map of a scene, bytes of its texels.
fn map(gpu: &Gpu, scene: &str, storage: &str) -> Vec<u8> {
    let scene = builtin(scene);
    // No bias, so that nothing but the storage differs.
    let settings = settings("linear", &[("storage", storage), ("bias", "none"), ("map_size", "256")]);
    let options = RenderOptions {
        size: glam::UVec2::splat(16),
        view: View::Visibility,
        ..RenderOptions::new(settings)
    };
    let mut renderer = Renderer::new(gpu, &scene, &scene.cameras[0].camera, options).expect("a renderer");
    renderer.frame(Measure::Frame).expect("a frame");
    renderer.map_bytes(0).expect("a map")
}

#[test]
fn each_channel_adds_eight_bits() {
    let Some(gpu) = gpu() else { return };
    for scene in ["columns", "torus"] {
        let float: Vec<f64> = map(&gpu, scene, "r32f")
            .chunks_exact(4)
            .map(|b| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]])))
            .collect();
        let drawn = float.iter().filter(|share| **share < 1.0).count();
        assert!(drawn > 1000, "{scene}: {drawn} texels hold a caster");
        for (storage, channels) in [("packed1", 1usize), ("packed2", 2), ("packed3", 3)] {
            let decoded = map(&gpu, scene, storage);
            let decoded = decoded.chunks_exact(4).map(|texel| {
                let number =
                    texel[..channels].iter().fold(0u32, |number, digit| number * 256 + u32::from(*digit));
                f64::from(number) / (256f64.powi(channels as i32) - 1.0)
            });
            let worst = decoded.zip(&float).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            println!("{scene} {storage}: at most {worst:.3e} off, 2^{:.2}", worst.log2());
            // Half a step of rounding; with three channels a float's own rounding comes on top.
            let allowed =
                if channels == 3 { 2f64.powi(-22) } else { 0.51 / (256f64.powi(channels as i32) - 1.0) };
            assert!(worst <= allowed, "{scene} {storage}: {worst} is more than {allowed}");
            assert!(
                channels == 3 || worst > 0.2 * allowed,
                "{scene} {storage}: {worst} is too good to be true"
            );
        }
    }
}
