//! What moves, comes and goes: maps hold what they should, and no more is drawn than has to be.

use crate::common::*;
use glam::Vec3;
use umbrage::core::Light;
use umbrage::{CasterHandle, LightHandle, MeshHandle, Shadows, ShadowsOptions};

struct World {
    shadows: Shadows,
    probe: Probe,
    mesh: MeshHandle,
    lights: Vec<(Light, LightHandle)>,
    boxes: Vec<(Vec3, Vec3)>,
    casters: Vec<CasterHandle>,
}

fn world(gpu: &Gpu, techniques: &[&str], boxes: Vec<(Vec3, Vec3)>, still_frames: u32) -> World {
    let options = ShadowsOptions::with(techniques.iter().copied()).and_then(|o| o.map_size(256));
    let mut options = options.expect("options");
    options.still_frames = still_frames;
    let mut shadows = Shadows::new(&gpu.device, &gpu.queue, options).expect("shadows");
    let mesh = add_cube(gpu, &mut shadows);
    shadows.add_receiver(ground()).expect("ground");
    let casters =
        boxes.iter().map(|(at, half)| shadows.add_caster(mesh, placed(*at, *half)).expect("a caster"));
    let casters = casters.collect();
    let lights = [sun(), spot(), lamp()].map(|light| (light, shadows.add_light(light).expect("a light")));
    World { probe: Probe::new(gpu, &shadows), shadows, mesh, lights: lights.to_vec(), boxes, casters }
}

impl World {
    fn place(&mut self, which: usize, middle: Vec3) {
        self.boxes[which].0 = middle;
        let half = self.boxes[which].1;
        self.shadows.move_caster(self.casters[which], placed(middle, half)).expect("moved");
    }

    /// The share of sure points that are wrong, over all lights.
    fn wrong(&mut self, gpu: &Gpu, points: &[Vec3]) -> f64 {
        let (mut all, mut bad) = (0, 0);
        for (light, handle) in self.lights.clone() {
            let number = self.shadows.light_index(handle).expect("a number");
            let seen = self.probe.shoot(gpu, &mut self.shadows, number, points);
            let (sure, wrong) = judge(&seen, points, &light, &self.boxes, 0.25);
            (all, bad) = (all + sure, bad + wrong);
        }
        bad as f64 / all as f64
    }
}

fn step(gpu: &Gpu, shadows: &mut Shadows) -> (umbrage::shadows::Prepared, umbrage::shadows::Recorded) {
    let prepared = shadows.prepare(&frame()).expect("prepared");
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let recorded = shadows.record(&mut encoder).expect("recorded");
    gpu.queue.submit([encoder.finish()]);
    (prepared, recorded)
}

/// Casters that wander, come, go, stand still for a while, with lights that move now and then: after any of it V is that of rays.
#[test]
fn whatever_happens_maps_hold_what_is_there() {
    let Some(gpu) = gpu() else { return };
    let points = points(40);
    for techniques in [&["linear"][..], &["midpoint"], &["packed"], &["second-depth"]] {
        let mut world = world(&gpu, techniques, boxes(14, 3), 4);
        let mut state = 9u32;
        let mut random = move || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1u32 << 24) as f32
        };
        for turn in 0..24 {
            let share = random();
            if share < 0.6 {
                for _ in 0..3 {
                    let which = (random() * world.boxes.len() as f32) as usize;
                    let (at, half) = world.boxes[which];
                    let to = at + Vec3::new(random() - 0.5, 0.0, random() - 0.5);
                    let most = Vec3::new(4.4, 9.0, 4.4) - Vec3::new(half.x, 0.0, half.z);
                    world.place(which, to.clamp(-most, most).with_y(at.y));
                }
            } else if share < 0.75 {
                let (at, half) = boxes(1, 100 + turn)[0];
                let added = world.shadows.add_caster(world.mesh, placed(at, half)).expect("a caster");
                world.casters.push(added);
                world.boxes.push((at, half));
            } else if share < 0.9 {
                let which = (random() * world.boxes.len() as f32) as usize;
                world.shadows.remove_caster(world.casters.swap_remove(which)).expect("removed");
                world.boxes.swap_remove(which);
            } else {
                let aside = Vec3::new(random() - 0.5, 0.0, random() - 0.5);
                let (light, handle) = &mut world.lights[2];
                light.position_world += aside;
                world.shadows.set_light(*handle, *light).expect("a light");
            }
            let still = if turn % 5 == 0 { 9 } else { 1 };
            for _ in 0..still {
                step(&gpu, &mut world.shadows);
            }
            let wrong = world.wrong(&gpu, &points);
            assert!(wrong < 0.01, "{techniques:?}: {wrong} after turn {turn}");
        }
        // The same pictures would not do if nothing had moved.
        let (at, half) = world.boxes[0];
        world.boxes[0].0 = Vec3::new(-at.x, at.y, -at.z) + half;
        assert!(world.wrong(&gpu, &points) > 0.002, "rays see where a box is");
    }
}

/// A number that is given to another caster in the same frame does not make it the same caster.
#[test]
fn whoever_takes_a_place_is_drawn() {
    let Some(gpu) = gpu() else { return };
    let points = points(40);
    let mut world = world(&gpu, &["linear"], boxes(6, 3), 64);
    step(&gpu, &mut world.shadows);
    for turn in 0..3 {
        let (at, half) = boxes(1, 50 + turn)[0];
        let added = world.shadows.add_caster(world.mesh, placed(at, half)).expect("a caster");
        world.casters.push(added);
        world.boxes.push((at, half));
        let wrong = world.wrong(&gpu, &points);
        assert!(wrong < 0.01, "{wrong} with caster {turn}");
        world.shadows.remove_caster(world.casters.pop().expect("it")).expect("removed");
        world.boxes.pop();
    }
}

/// Nothing moved: nothing is fitted, drawn or written. One moved: only views that see it, over a copy of what stands still.
#[test]
fn work_is_that_of_what_moved() {
    let Some(gpu) = gpu() else { return };
    let mut world = world(&gpu, &["linear"], boxes(300, 4), 8);
    let (prepared, recorded) = step(&gpu, &mut world.shadows);
    assert_eq!((prepared.views, prepared.stale_views, recorded.maps), (8, 8, 8));
    let (prepared, recorded) = step(&gpu, &mut world.shadows);
    assert_eq!((prepared.stale_views, prepared.fitted, prepared.written_bytes), (0, 0, 0));
    assert_eq!(recorded, Default::default());

    // The first move draws the views whole, without what moves; from then on they are copied.
    let mut moved = Vec::new();
    for turn in 0..6 {
        let (at, _) = world.boxes[7];
        world.place(7, at + Vec3::X * 0.01);
        let (prepared, recorded) = step(&gpu, &mut world.shadows);
        assert_eq!(prepared.moved, 1);
        assert!(prepared.stale_views >= 2 && prepared.stale_views < 8, "{prepared:?}");
        if turn > 0 {
            assert_eq!((recorded.copied, recorded.draws), (recorded.maps, recorded.maps), "{recorded:?}");
            assert!(recorded.triangles <= 12 * recorded.maps);
        }
        moved.push(recorded);
    }
    assert!(moved[0].triangles > 100 * moved[1].triangles, "{moved:?}");
    // Standing still again costs nothing, also in the frame in which it is noticed.
    for _ in 0..20 {
        assert_eq!(step(&gpu, &mut world.shadows).1, Default::default());
    }
    assert!(world.wrong(&gpu, &points(40)) < 0.01);
}
