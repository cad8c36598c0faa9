//! Ten thousand casters under sixteen lights.

#![allow(dead_code, reason = "test and bench each use a part of it")]

use crate::common::*;
use glam::Vec3;
use umbrage::core::{Aabb, Light};
use umbrage::{CasterHandle, LightHandle, Shadows, ShadowsOptions};

pub const CASTERS: usize = 10_000;
pub const LIGHTS: usize = 16;

pub struct Crowd {
    pub shadows: Shadows,
    pub casters: Vec<(CasterHandle, Vec3)>,
    pub lights: Vec<(LightHandle, Light)>,
}

/// A field of small boxes, 100 by 100 metres, under one sun and fifteen spots and lamps.
pub fn crowd(gpu: &Gpu, map_size_texel: u32) -> Crowd {
    let options = ShadowsOptions::default().map_size(map_size_texel).expect("a size");
    let mut shadows = Shadows::new(&gpu.device, &gpu.queue, options).expect("shadows");
    let mesh = add_cube(gpu, &mut shadows);
    let field = Aabb { min: Vec3::new(-50.0, 0.0, -50.0), max: Vec3::new(50.0, 0.0, 50.0) };
    shadows.add_receiver(field).expect("ground");
    let at = |i: usize| Vec3::new((i % 100) as f32 - 49.5, 0.3, (i / 100) as f32 - 49.5);
    let casters = (0..CASTERS)
        .map(|i| {
            (shadows.add_caster(mesh, placed(at(i), Vec3::new(0.2, 0.3, 0.2))).expect("a caster"), at(i))
        })
        .collect();
    let mut lights = Vec::new();
    for i in 0..LIGHTS {
        let over = Vec3::new(25.0 * (i % 4) as f32 - 37.5, 8.0, 25.0 * (i / 4) as f32 - 37.5);
        let light = match i {
            0 => sun(),
            _ if i % 4 == 0 => Light { position_world: over, range_m: Some(20.0), ..lamp() },
            _ => Light { range_m: Some(30.0), ..Light::spot(over, over.with_y(0.0), 0.7, 0.9) },
        };
        lights.push((shadows.add_light(light).expect("a light"), light));
    }
    Crowd { shadows, casters, lights }
}

impl Crowd {
    /// Carries a light a little aside: 0 is the sun, 4, 8 and 12 are lamps, all others spots.
    pub fn carry(&mut self, which: usize, turn: u32) {
        let (handle, light) = self.lights[which];
        let aside = Vec3::X * 0.1 * (turn as f32 * 0.7).sin();
        let turned = Light {
            position_world: light.position_world + aside,
            direction_world: (light.direction_world + 0.1 * aside).normalize(),
            ..light
        };
        self.shadows.set_light(handle, turned).expect("carried");
    }

    /// Lets the first `count` of every hundredth caster, and so on, walk a little.
    pub fn walk(&mut self, count: usize, turn: u32) {
        let step = CASTERS / count;
        for i in (0..count).map(|i| i * step) {
            let (handle, home) = self.casters[i];
            let aside = 0.1 * (turn as f32 * 0.7 + i as f32).sin();
            let to = placed(home + Vec3::X * aside, Vec3::new(0.2, 0.3, 0.2));
            self.shadows.move_caster(handle, to).expect("moved");
        }
    }
}
