//! Rays per second of Umbrage, and the same rays in a file for another tracer: `cargo run --release -p umbrage-truth
//! --example rays -- SCENE [FILE]`. `bench/embree/run` uses it.
//!
//! 320x180 pixels, one disc-shaped light of an eighth of the scene's size, 64 rays from each receiver: the rays of the truth
//! itself, in its order.

use glam::UVec2;
use rayon::prelude::*;
use std::error::Error;
use std::io::{BufWriter, Write};
use std::time::Instant;
use umbrage_core::LightShape;
use umbrage_truth::{Emitter, Quality, Ray, Rays, Samples, Surfaces, silent};

const PER_PIXEL: usize = 64;
const PACKET: usize = umbrage_truth::LANES;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let spec = arguments.next().ok_or("name a scene")?;
    let mut scene = umbrage_scene::load(&spec)?;
    umbrage_scene::add_defaults(&mut scene);
    let mut light = scene.lights[0].light;
    if matches!(light.kind, umbrage_core::LightKind::Directional) {
        light.shape = LightShape::Sun { angle_rad: 0.1 };
    } else {
        light.shape = LightShape::Disc { radius_m: scene.bounds().radius() / 8.0 };
    }

    let start = Instant::now();
    let rays = Rays::new(&scene)?;
    let build_s = start.elapsed().as_secs_f64();
    let seen = Surfaces::new(&rays, &scene.cameras[0].camera, UVec2::new(320, 180), &silent)?;
    let emitter = Emitter::new(&light);
    let samples = Samples::new(&Quality { samples: PER_PIXEL as u32, seed: 0 });
    let mut shadow = Vec::new();
    for (i, seen) in seen.seen.iter().enumerate() {
        let Some(seen) = seen else { continue };
        if !emitter.shines_on(seen.p_world) {
            continue;
        }
        let normal = seen.normal_world.as_dvec3();
        let origin_world = seen.p_world + normal * rays.offset_m();
        for square in samples.of_pixel(i as u32) {
            let to = emitter.sample(origin_world, square);
            if to.way.dot(normal) > 0.0 {
                shadow.push(Ray {
                    origin_world,
                    way: to.way,
                    from_m: 0.0,
                    to_m: to.distance_m - rays.offset_m(),
                });
            }
        }
    }
    let trace = || -> Vec<bool> {
        // A row's worth of packets is one task, as in the truth itself.
        let mut blocked = vec![false; shadow.len()];
        let tasks = blocked.par_chunks_mut(512 * PACKET).zip(shadow.par_chunks(512 * PACKET));
        tasks.for_each_init(Default::default, |stack, (blocked, task)| {
            for (blocked, packet) in blocked.chunks_mut(PACKET).zip(task.chunks(PACKET)) {
                let light = rays.light_through(packet, stack);
                blocked.iter_mut().zip(light).for_each(|(blocked, light)| *blocked = light.x == 0.0);
            }
        });
        blocked
    };
    let mut blocked = Vec::new();
    let mut best_s = f64::INFINITY;
    for _ in 0..4 {
        let start = Instant::now();
        blocked = trace();
        best_s = best_s.min(start.elapsed().as_secs_f64());
    }
    println!(
        "{{\"scene\":\"{spec}\",\"triangles\":{},\"rays\":{},\"threads\":{},\"build_s\":{build_s:.3},\
         \"bytes_per_triangle\":{:.1},\"mrays_per_s\":{:.3},\"blocked\":{}}}",
        rays.triangle_count(),
        shadow.len(),
        rayon::current_num_threads(),
        rays.memory_bytes() as f64 / rays.triangle_count().max(1) as f64,
        shadow.len() as f64 / best_s * 1e-6,
        blocked.iter().filter(|b| **b).count()
    );
    if let Some(path) = arguments.next() {
        let mut file = BufWriter::new(std::fs::File::create(path)?);
        dump(&mut file, &scene, &shadow, &blocked)?;
        file.flush()?;
    }
    Ok(())
}

/// The file that `bench/embree/occluded.cpp` reads.
fn dump(
    file: &mut impl Write,
    scene: &umbrage_scene::Scene,
    rays: &[Ray],
    blocked: &[bool],
) -> std::io::Result<()> {
    file.write_all(b"UMBRAYS1")?;
    file.write_all(&scene.triangles().to_le_bytes())?;
    file.write_all(&(rays.len() as u64).to_le_bytes())?;
    let mut numbers = |numbers: &[f32]| numbers.iter().try_for_each(|x| file.write_all(&x.to_le_bytes()));
    for instance in &scene.instances {
        let mesh = &scene.meshes[instance.mesh];
        for index in &mesh.indices {
            let p = instance.world_from_object.transform_point3(mesh.positions[*index as usize]);
            numbers(&p.to_array())?;
        }
    }
    for ray in rays {
        numbers(&ray.origin_world.as_vec3().to_array())?;
        numbers(&ray.way.as_vec3().to_array())?;
        numbers(&[ray.to_m as f32])?;
    }
    file.write_all(&blocked.iter().map(|b| u8::from(*b)).collect::<Vec<_>>())
}
