//! What shadows cost the CPU: ten thousand casters under sixteen lights (31 views), none, some or all of them moving.
//!
//! `cargo bench -p umbrage --bench prepare`. Times are medians of one run; counts are exact.

#[path = "../tests/common/mod.rs"]
mod common;
#[path = "../tests/common/crowd.rs"]
mod crowd;

use allocation_counter::measure;
use common::{Gpu, frame, gpu};
use crowd::{CASTERS, Crowd, LIGHTS, crowd};
use std::time::Instant;
use umbrage::shadows::{Prepared, Recorded};

/// One frame: milliseconds of both calls, what they did, and how often they asked for memory.
struct Step {
    prepare_ms: f64,
    record_ms: f64,
    prepared: Prepared,
    recorded: Recorded,
    asked: u64,
}

fn step(gpu: &Gpu, crowd: &mut Crowd) -> Step {
    step_from(gpu, crowd, frame())
}

fn step_from(gpu: &Gpu, crowd: &mut Crowd, seen: umbrage::Frame) -> Step {
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let mut done = None;
    let asked = measure(|| {
        let start = Instant::now();
        let prepared = crowd.shadows.prepare(&seen).expect("prepared");
        let between = Instant::now();
        let recorded = crowd.shadows.record(&mut encoder).expect("recorded");
        let milliseconds = |from: Instant, to: Instant| (to - from).as_secs_f64() * 1e3;
        done =
            Some((milliseconds(start, between), milliseconds(between, Instant::now()), prepared, recorded));
    });
    // The next frame begins when this one is drawn: what is measured is the CPU's part alone.
    gpu.queue.submit([encoder.finish()]);
    gpu.device.poll(wgpu::PollType::wait_indefinitely()).expect("polled");
    let (prepare_ms, record_ms, prepared, recorded) = done.expect("it was measured");
    Step { prepare_ms, record_ms, prepared, recorded, asked: asked.count_total }
}

fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers[numbers.len() / 2]
}

fn print(name: &str, steps: &[Step]) {
    let Some(last) = steps.last() else { return };
    let of = |pick: fn(&Step) -> f64| median(steps.iter().map(pick).collect());
    println!(
        "{name:<24}{:>12.4}{:>12.4}{:>8}{:>8}{:>8}{:>8}{:>11}{:>11}{:>8}",
        of(|s| s.prepare_ms),
        of(|s| s.record_ms),
        last.prepared.moved,
        last.recorded.maps,
        last.recorded.copied,
        last.recorded.draws,
        last.recorded.triangles,
        last.prepared.written_bytes,
        last.asked,
    );
}

fn main() {
    let Some(gpu) = gpu() else { return };
    let mut crowd = crowd(&gpu, 128);
    println!("{CASTERS} casters, {LIGHTS} lights, medians; maps of 128x128 texels, so that drawing is short");
    println!(
        "{:<24}{:>12}{:>12}{:>8}{:>8}{:>8}{:>8}{:>11}{:>11}{:>8}",
        "", "prepare ms", "record ms", "moved", "maps", "copied", "draws", "triangles", "bytes", "allocs"
    );
    print("first frame", &[step(&gpu, &mut crowd)]);
    let still: Vec<Step> = (0..1000).map(|_| step(&gpu, &mut crowd)).collect();
    assert!(still.iter().all(|s| s.asked == 0 && s.recorded == Recorded::default()), "nothing moved");
    print("nothing moves", &still);
    let walks = |i: u32| {
        let mut seen = frame();
        seen.view_from_world.w_axis.x += 0.01 * i as f32;
        seen
    };
    let eye: Vec<Step> = (0..1000).map(|i| step_from(&gpu, &mut crowd, walks(i))).collect();
    assert!(eye.iter().all(|s| s.asked == 0 && s.recorded == Recorded::default()), "only the eye moved");
    print("only the eye moves", &eye);
    let mut turn = 0;
    for (name, which) in [("a spot is carried", 5), ("a lamp is carried", 4), ("the sun turns", 0)] {
        let mut steps = Vec::new();
        for _ in 0..40 {
            crowd.carry(which, turn);
            steps.push(step(&gpu, &mut crowd));
            turn += 1;
        }
        print(name, &steps);
    }
    for (name, count) in [("0.1 % move", 10), ("1 % move", 100), ("10 % move", 1000), ("all move", CASTERS)] {
        let mut steps = Vec::new();
        for _ in 0..60 {
            crowd.walk(count, turn);
            steps.push(step(&gpu, &mut crowd));
            turn += 1;
        }
        // The first frames tell what moves from what stands still.
        print(name, &steps[20..]);
    }
}
