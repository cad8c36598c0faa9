//! Ten thousand casters, sixteen lights: where nothing moves nothing is asked of heap or GPU; where some move, as much as they are.

use crate::common::{frame, gpu};
use crate::crowd::{CASTERS, Crowd, LIGHTS, crowd};
use allocation_counter::measure;
use umbrage::shadows::{Prepared, Recorded};

#[test]
fn what_stands_still_costs_nothing_and_what_moves_costs_what_it_is() {
    let Some(gpu) = gpu() else { return };
    let mut crowd = crowd(&gpu, 128);
    let step_from = |crowd: &mut Crowd, seen: &umbrage::Frame| -> (Prepared, Recorded, u64) {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let mut done = None;
        let asked = measure(|| {
            let prepared = crowd.shadows.prepare(seen).expect("prepared");
            done = Some((prepared, crowd.shadows.record(&mut encoder).expect("recorded")));
        });
        gpu.queue.submit([encoder.finish()]);
        let (prepared, recorded) = done.expect("it was measured");
        (prepared, recorded, asked.count_total)
    };
    let step = |crowd: &mut Crowd| step_from(crowd, &frame());
    let (prepared, recorded, asked) = step(&mut crowd);
    assert_eq!((prepared.lights, prepared.views), (LIGHTS as u64, 1 + 12 + 3 * 6));
    assert_eq!(recorded.maps, prepared.views);
    assert!(
        asked > 100 && recorded.triangles > 12 * CASTERS as u64,
        "the first frame draws all: {recorded:?}"
    );
    for turn in 0..100u8 {
        let mut seen = frame();
        // For the first half the eye rests; then it moves.
        seen.view_from_world.w_axis.x += f32::from(turn.saturating_sub(50));
        let (prepared, recorded, asked) = step_from(&mut crowd, &seen);
        assert_eq!(asked, 0, "memory was asked for though nothing moved");
        assert_eq!((recorded, prepared.written_bytes, prepared.fitted), (Recorded::default(), 0, 0));
    }

    // Warm up: what moves is told from what stands still, and what stands still is kept.
    for turn in 0..8 {
        crowd.walk(100, turn);
        step(&mut crowd);
    }
    let mut of = |count: usize| {
        crowd.walk(count, 100 + count as u32);
        step(&mut crowd)
    };
    let (ten, of_ten, _) = of(10);
    let (hundred, of_hundred, _) = of(100);
    assert_eq!((ten.moved, hundred.moved, hundred.fitted), (10, 100, 0), "rooms hold");
    // The hundred are in the lists of all views that see any of them; no one else is.
    assert!(of_hundred.triangles <= 12 * 100 * hundred.views, "{of_hundred:?}");
    assert!(hundred.written_bytes <= 48 * 100 * hundred.views, "{hundred:?}");
    assert_eq!(of_hundred.copied, of_hundred.maps, "what stands still is copied, never drawn");
    assert!(of_ten.maps <= of_hundred.maps);
}
