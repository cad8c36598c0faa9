#![allow(missing_docs, clippy::unwrap_used)]
use umbrage_render::umbrage::core::technique::Settings;
use umbrage_render::*;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let scene = umbrage_scene::load(&a[1]).unwrap();
    let gpu = Gpu::new(None).unwrap();
    println!("{:?} ts {} st {}", gpu.info.name, gpu.has_timestamps(), gpu.has_statistics());
    let mut scene = scene;
    umbrage_scene::add_defaults(&mut scene);
    let camera = scene.cameras[0].camera;
    let mk = |t: &str, v: View, st: bool| {
        let mut o = RenderOptions::new(Settings::new(t, []).unwrap());
        o.view = v;
        o.statistics = st;
        Renderer::new(&gpu, &scene, &camera, o).unwrap()
    };
    let t = std::time::Instant::now();
    let r = mk("linear", View::Final, false);
    println!("setup {:?}", t.elapsed());
    for w in r.warnings() {
        println!("{w}");
    }
    let t = std::time::Instant::now();
    println!("first {:.1}", r.frame().unwrap().frame_ms);
    let o = r.options().size;
    picture::write_png(std::path::Path::new("/tmp/final.png"), o.x, o.y, &r.picture().unwrap()).unwrap();
    println!("pic {:?}", t.elapsed());
    let u = mk("unshadowed", View::Final, false);
    u.frame().unwrap();
    let cpu = || {
        let s = std::fs::read_to_string("/proc/self/stat").unwrap();
        let v: Vec<&str> = s.rsplit(')').next().unwrap().split_whitespace().collect();
        (v[11].parse::<f64>().unwrap(), v[12].parse::<f64>().unwrap())
    };
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
    for round in 0..2 {
        for (name, r) in [("un", &u), ("li", &r)] {
            let c = cpu();
            let t0 = threads();
            let mut ms = vec![];
            let mut per = vec![0.0; 4];
            for _ in 0..n {
                let f = r.frame().unwrap();
                ms.push(f.frame_ms);
                for (i, p) in f.passes.iter().enumerate() {
                    per[i] += p.gpu_ms.unwrap_or(0.0) / n as f64;
                }
            }
            let t1 = threads();
            let d = cpu();
            ms.sort_by(|a, b| a.total_cmp(b));
            println!(
                "{round} {name} wall min {:.1} med {:.1} | cpu user {:.1} sys {:.1} ms/frame | passes {per:.1?} {:?}",
                ms[0],
                ms[n / 2],
                (d.0 - c.0) * 10.0 / n as f64,
                (d.1 - c.1) * 10.0 / n as f64,
                t0.iter()
                    .zip(&t1)
                    .map(|(a, b)| format!("{} {:.0}", a.0, (b.1 - a.1) / n as f64))
                    .collect::<Vec<_>>()
            );
        }
    }
    if std::env::args().nth(2).is_some() {
        return;
    }
    let s = mk("linear", View::Final, true);
    for p in s.frame().unwrap().passes {
        println!("{p:?}");
    }
    for v in View::ALL {
        let r = mk("linear", v, false);
        r.frame().unwrap();
        picture::write_png(
            std::path::Path::new(&format!("/tmp/{}.png", v.id())),
            o.x,
            o.y,
            &r.picture().unwrap(),
        )
        .unwrap();
    }
}
