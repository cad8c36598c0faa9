//! The hierarchy and its packets against every triangle tried one by one.

mod common;

use common::brute;
use common::{builtin, truth};
use glam::UVec2;
use umbrage_core::{Light, LightKind};
use umbrage_truth::Place;

const SIDE: u32 = 96;

#[test]
fn every_ray_finds_what_trying_all_triangles_finds() {
    for name in ["torus", "columns", "contact", "tilt"] {
        let scene = builtin(name);
        let spot = scene.lights[0].light;
        let placed = Light { near_m: None, far_m: None, ..spot };
        let sun = Light { kind: LightKind::Directional, intensity: 3.0, ..placed };
        let point = Light { kind: LightKind::Point, ..placed };
        for light in [spot, sun, point] {
            let slow = brute::truth(&scene, &light, SIDE);
            let (_, fast) = truth(&scene, &scene.cameras[0].camera, &light, UVec2::splat(SIDE), 1);
            let mut differ = 0;
            let (mut lit, mut dark) = (0, 0);
            for (i, slow) in slow.iter().enumerate() {
                // The brute force says nothing of cones but that V is 0 there.
                let fast = match fast.place[i] {
                    Place::Nothing | Place::Away | Place::Exempt => None,
                    Place::Unreached => Some(false),
                    Place::Receiver => Some(fast.v[i].x == 1.0),
                };
                let slow = if fast == Some(false) && slow.is_none() { Some(false) } else { *slow };
                differ += u32::from(fast != slow);
                lit += u32::from(fast == Some(true));
                dark += u32::from(fast == Some(false));
            }
            println!("{name} {}: {lit} lit, {dark} dark, {differ} differ", light.kind.id());
            // Rays that graze an edge within the two's different offsets may fall on either side.
            assert!(differ <= 2, "{name} {}: {differ} differ", light.kind.id());
            assert!(lit > 500 && (name == "tilt" || dark > 200), "{name}: {lit} {dark}");
        }
    }
}
