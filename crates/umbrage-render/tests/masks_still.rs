//! Masks that nothing changes cost nothing: no memory of the heap, no write, no pass.

mod common;

use allocation_counter::measure;
use common::gpu;
use glam::{Mat4, UVec2, Vec3};
use umbrage_render::Gpu;
use umbrage_render::umbrage::CasterPipelines;
use umbrage_render::umbrage::caster::CasterVertices;
use umbrage_render::umbrage::core::masks::Picture;
use umbrage_render::umbrage::core::technique::Settings;
use umbrage_render::umbrage::core::{Aabb, Camera, DepthConvention, Light, LightKind};
use umbrage_render::umbrage::mask::{Blocker, BlockerMasks, MaskPart, MasksError, Receiver};

/// How often memory was asked for while something ran.
fn asked(run: impl FnOnce()) -> u64 {
    measure(run).count_total
}

/// Boxes of two parts under three lights.
struct World {
    settings: Settings,
    lights: Vec<Light>,
    parts: Vec<[MaskPart; 2]>,
    picture: Picture,
    receivers: Vec<Receiver>,
    time_s: f32,
}

fn seen_from(at: Vec3) -> Picture {
    let camera = Camera::look_at(at, Vec3::ZERO, 0.9, 0.1, 60.0);
    let depth = DepthConvention::ZeroToOne;
    let clip_from_world = camera.clip_from_view(1.0, depth) * camera.view_from_world();
    Picture { clip_from_world, depth, size: UVec2::splat(96) }
}

fn part(at: Vec3) -> MaskPart {
    let bounds_world = Aabb { min: at - 0.2, max: at + 0.2 };
    MaskPart { mesh: 0, version: 0, world_from_object: Mat4::from_translation(at), bounds_world }
}

impl World {
    fn new() -> Self {
        let parts: Vec<[MaskPart; 2]> = (0..6)
            .map(|i| Vec3::new(i as f32 - 3.0, 1.0, (i % 3) as f32 - 1.0))
            .map(|at| [part(at), part(at + Vec3::Y * 0.3)])
            .collect();
        let floor = Aabb { min: Vec3::new(-6.0, -0.1, -6.0), max: Vec3::new(6.0, 0.0, 6.0) };
        let spot = Light::spot(Vec3::new(-1.0, 6.0, 1.0), Vec3::ZERO, 0.6, 0.7);
        let sun = Light { kind: LightKind::Directional, near_m: None, far_m: None, ..spot };
        Self {
            settings: Settings::new("mask", [("mask_size", "32")]).expect("settings"),
            lights: vec![spot, Light { kind: LightKind::Point, ..spot }, sun],
            parts,
            picture: seen_from(Vec3::new(3.0, 6.0, 8.0)),
            receivers: vec![Receiver { object: 99, bounds_world: floor }],
            time_s: 0.0,
        }
    }

    /// One frame; how many passes it recorded.
    fn frame(&self, gpu: &Gpu, masks: &mut BlockerMasks, encoder: &mut wgpu::CommandEncoder) -> usize {
        masks.begin(&self.picture, self.time_s, self.receivers.iter().copied());
        let whole = Aabb { min: Vec3::splat(-6.0), max: Vec3::splat(6.0) };
        for (number, light) in self.lights.iter().enumerate() {
            let blockers = (0u32..).zip(&self.parts).map(|(object, parts)| Blocker { object, parts });
            masks.tell(number, light, &self.settings, &whole, blockers).expect("told");
        }
        masks.finish(&gpu.device, &gpu.queue).expect("room");
        masks.record(encoder, false, |_| None, |_, _, _| {})
    }
}

fn masks(gpu: &Gpu, world: &World) -> BlockerMasks {
    let cut_out = CasterPipelines::cut_out_layout(&gpu.device);
    let vertices = CasterVertices::default();
    BlockerMasks::new(&gpu.device, &world.settings, 3, 1, &cut_out, &vertices).expect("masks")
}

#[test]
fn only_what_changed_is_done_again() {
    let Some(gpu) = gpu() else { return };
    let mut world = World::new();
    let mut masks = masks(&gpu, &world);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let mut frame = |world: &World, masks: &mut BlockerMasks| {
        let mut passes = 0;
        let asked = asked(|| passes = world.frame(&gpu, masks, &mut encoder));
        (passes, asked)
    };
    let (passes, first) = frame(&world, &mut masks);
    assert_eq!((passes, masks.count()), (18, 18));
    assert!(first > 0, "the heap is counted");
    assert_eq!(frame(&world, &mut masks), (0, 0), "nothing changed");
    // The eye: other pixels, the same masks.
    let rects = |masks: &BlockerMasks| masks.iter().map(|mask| mask.on_screen).collect::<Vec<_>>();
    let before = rects(&masks);
    world.picture = seen_from(Vec3::new(-2.0, 7.0, 9.0));
    assert_eq!(frame(&world, &mut masks).0, 0, "the eye moved");
    assert_ne!(rects(&masks), before);
    assert_eq!(frame(&world, &mut masks), (0, 0));
    // A blocker, in all three lights; a light, with all blockers; a mesh's version; time.
    world.parts[2][1] = part(Vec3::new(-1.0, 1.8, 1.0));
    assert_eq!(frame(&world, &mut masks).0, 3, "a blocker moved");
    world.lights[1].position_world.x += 0.5;
    assert_eq!(frame(&world, &mut masks).0, 6, "a light moved");
    world.parts[0][0].version += 1;
    assert_eq!(frame(&world, &mut masks).0, 3, "a mesh has another shape");
    world.time_s = 1.0;
    assert_eq!(frame(&world, &mut masks).0, 18, "time passes");
    assert_eq!(frame(&world, &mut masks), (0, 0));
    // A receiver that no shadow reaches changes nothing but the search for pixels.
    world.receivers[0].bounds_world.min.y -= 1.0;
    assert_eq!(frame(&world, &mut masks).0, 0);
    assert_eq!(frame(&world, &mut masks), (0, 0));
    // Fewer blockers, and as many again: those behind them are numbered anew, and drawn where they were not.
    let removed = world.parts.pop().expect("a blocker");
    assert!(frame(&world, &mut masks).0 > 0 && masks.count() == 15);
    world.parts.push(removed);
    assert!(frame(&world, &mut masks).0 > 0 && masks.count() == 18);
    assert_eq!(frame(&world, &mut masks), (0, 0));
    // A light that is not told has no masks, and has them again, in the places of now, when it is.
    let last = world.lights.pop().expect("a light");
    frame(&world, &mut masks);
    assert_eq!((masks.count(), masks.of_light(2).len()), (12, 0));
    world.picture = seen_from(Vec3::new(3.0, 6.0, 8.0));
    frame(&world, &mut masks);
    world.lights.push(last);
    frame(&world, &mut masks);
    let again = rects(&masks);
    let mut fresh = self::masks(&gpu, &world);
    frame(&world, &mut fresh);
    assert_eq!(again, rects(&fresh));
}

#[test]
fn what_one_texture_cannot_hold_is_refused_with_a_reason() {
    let Some(gpu) = gpu() else { return };
    let world = World::new();
    let mut masks = masks(&gpu, &world);
    let cut_out = CasterPipelines::cut_out_layout(&gpu.device);
    let other = |pairs: &[(&'static str, &'static str)], id| {
        Settings::new(id, pairs.iter().copied()).expect("settings")
    };
    let mut told = |light, settings: &Settings| {
        let whole = Aabb { min: Vec3::ZERO, max: Vec3::ONE };
        masks.begin(&world.picture, 0.0, []);
        masks.tell(light, &world.lights[0], settings, &whole, []).map(<[_]>::len)
    };
    assert_eq!(told(0, &world.settings), Ok(0));
    let refused = [
        (told(0, &other(&[], "mask")), "same mask_size"),
        (told(0, &other(&[("mask_size", "32"), ("lookup", "nearest")], "mask")), "same lookup"),
        (told(0, &other(&[], "linear")), "use `mask`"),
        (told(3, &world.settings), "no light 3"),
    ];
    for (refused, reason) in refused {
        let said = refused.expect_err(reason).to_string();
        assert!(said.contains(reason), "{said}");
    }
    let vertices = CasterVertices::default();
    let made = BlockerMasks::new(&gpu.device, &world.settings, 257, 1, &cut_out, &vertices);
    assert!(matches!(made, Err(MasksError::TooManyLights { lights: 257 })));
}
