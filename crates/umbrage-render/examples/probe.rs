#![allow(missing_docs, clippy::unwrap_used)]
use umbrage_render::umbrage::core::technique::Settings;
use umbrage_render::*;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let gpu = Gpu::new(None).unwrap();
    let mut scene = umbrage_scene::load(&a[1]).unwrap();
    umbrage_scene::add_defaults(&mut scene);
    let camera = scene.cameras[0].camera;
    let mk = |t: &str, v: View| {
        let mut o = RenderOptions::new(Settings::new(t, []).unwrap());
        o.view = v;
        Renderer::new(&gpu, &scene, &camera, o).unwrap()
    };
    let r = mk("linear", View::Final);
    r.frame(Measure::Frame).unwrap();
    let u = mk("unshadowed", View::Final);
    u.frame(Measure::Frame).unwrap();
    let threads = || {
        let mut v: Vec<(String, f64)> = std::fs::read_dir("/proc/self/task")
            .unwrap()
            .flatten()
            .map(|e| {
                let s = std::fs::read_to_string(e.path().join("schedstat")).unwrap();
                let n = std::fs::read_to_string(e.path().join("comm")).unwrap().trim().to_owned();
                (n, s.split_whitespace().next().unwrap().parse::<f64>().unwrap() * 1e-6)
            })
            .collect();
        v.sort_by(|a, b| a.0.cmp(&b.0));
        v
    };
    let n = 12;
    for m in [Measure::Frame, Measure::Passes] {
        for round in 0..2 {
            for (name, r) in [("un", &u), ("li", &r)] {
                let t0 = threads();
                let mut ms = vec![];
                let mut per = vec![0.0; 4];
                for _ in 0..n {
                    let f = r.frame(m).unwrap();
                    ms.push(f.frame_ms);
                    for (i, p) in f.passes.iter().enumerate() {
                        per[i] += p.gpu_ms.unwrap_or(0.0) / n as f64;
                    }
                }
                let t1 = threads();
                ms.sort_by(|a, b| a.total_cmp(b));
                println!(
                    "{round} {name} wall min {:.1} med {:.1} passes {per:.1?} {:?}",
                    ms[0],
                    ms[n / 2],
                    t0.iter()
                        .zip(&t1)
                        .map(|(a, b)| format!("{} {:.0}", a.0, (b.1 - a.1) / n as f64))
                        .filter(|s| !s.ends_with(" 0"))
                        .collect::<Vec<_>>()
                );
            }
        }
    }
    for p in r.frame(Measure::Counts).unwrap().passes {
        println!("{p:?}");
    }
}
