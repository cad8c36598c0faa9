//! Row N12, and what masks promise beside maps: as right as `linear` of the same resolution beyond the blocker, for half of its
//! triangles; what adapting brings; and what each of the three geometries costs.

mod common;

use common::{builtin, gpu, settings};
use glam::{DVec3, Mat4, UVec2, Vec3};
use std::ops::ControlFlow;
use umbrage_measure::{Cost, ViewTruth};
use umbrage_render::umbrage::core::fit::{MaskView, Region};
use umbrage_render::umbrage::core::technique::Settings;
use umbrage_render::umbrage::core::{Aabb, Camera, Light, LightKind};
use umbrage_render::{Gpu, Measure, RenderOptions, Renderer, View};
use umbrage_scene::{Instance, Material, Mesh, Scene, SceneCamera, SceneLight};
use umbrage_truth::{Quality, Rays};

const SIZE: UVec2 = UVec2::new(320, 200);
/// Texels along a side of mask and map alike.
const TEXELS: &str = "512";

/// A blocker of about two metres in the air over a ground that only receives, lit aslant.
fn over_ground(mut scene: Scene, keep: &dyn Fn(&Mesh) -> bool, kind: LightKind) -> Scene {
    scene.instances.retain(|placed| keep(&scene.meshes[placed.mesh]));
    let boxes = scene.instances.iter().map(|i| scene.meshes[i.mesh].bounds.transformed(&i.world_from_object));
    let whole = boxes.fold(Aabb::EMPTY, |all, one| all.union(&one));
    let scale = 1.0 / whole.radius();
    let lift = Mat4::from_translation(Vec3::Y * 1.8)
        * Mat4::from_scale(Vec3::splat(scale))
        * Mat4::from_translation(-whole.center());
    for placed in &mut scene.instances {
        placed.world_from_object = lift * placed.world_from_object;
        placed.object = 0;
    }
    let ground = Aabb { min: Vec3::new(-5.0, 0.0, -5.0), max: Vec3::new(5.0, 0.0, 5.0) };
    scene.materials.push(Material::default());
    let corner = |x: f32, z: f32| Vec3::new(5.0 * x, 0.0, 5.0 * z);
    scene.meshes.push(Mesh {
        name: "ground".into(),
        positions: vec![corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0), corner(-1.0, -1.0)],
        normals: vec![Vec3::Y; 4],
        indices: vec![0, 1, 2, 0, 2, 3],
        material: scene.materials.len() - 1,
        bounds: ground,
        ..Mesh::default()
    });
    scene.instances.push(Instance { mesh: scene.meshes.len() - 1, object: 1, ..Instance::default() });
    let camera = Camera::look_at(Vec3::new(0.0, 6.5, 5.0), Vec3::new(0.4, 0.0, -0.4), 0.9, 0.1, 60.0);
    scene.cameras = vec![SceneCamera { name: String::new(), camera }];
    let spot = Light::spot(Vec3::new(-2.0, 8.0, 2.5), Vec3::Y, 0.5, 0.6);
    let light = if kind == LightKind::Directional { Light { kind, ..spot } } else { spot };
    scene.lights = vec![SceneLight { name: String::new(), light, cookie: None }];
    scene
}

/// The blockers: some are files that are not a part of this repository.
fn blockers() -> Vec<(String, Scene)> {
    let named = |name: &str, scene: Scene, keep: &dyn Fn(&Mesh) -> bool| {
        [("spot", LightKind::Spot { inner_rad: 0.0, outer_rad: 0.6 }), ("sun", LightKind::Directional)]
            .map(|(light, kind)| (format!("{name}, {light}"), over_ground(scene.clone(), keep, kind)))
    };
    let mut all = Vec::new();
    all.extend(named("torus", builtin("torus"), &|mesh| mesh.name == "torus"));
    let mut knots = builtin("knots");
    let knot =
        knots.instances.iter().position(|i| knots.meshes[i.mesh].name.contains("knot")).expect("a knot");
    knots.instances = vec![knots.instances[knot].clone()];
    all.extend(named("knot", knots, &|_| true));
    for (name, path) in [("suzanne", "suzanne/Suzanne.gltf"), ("fox", "fox/Fox.glb")] {
        let shared =
            std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/scenes").join(path);
        match umbrage_scene::load(&shared.to_string_lossy()) {
            Ok(scene) => all.extend(named(name, scene, &|_| true)),
            Err(error) => eprintln!("SKIPPED: {error}"),
        }
    }
    all
}

struct Judge<'a> {
    gpu: &'a Gpu,
    scene: &'a Scene,
    truth: ViewTruth,
    /// Pixels of the ground that lie beyond all of the blocker.
    beyond: Vec<usize>,
}

struct Judged {
    rmse: f64,
    cost: Cost,
    masks: Vec<MaskView>,
}

impl<'a> Judge<'a> {
    fn new(gpu: &'a Gpu, scene: &'a Scene, rays: &Rays<'_>) -> Self {
        let options = RenderOptions { size: SIZE, ..RenderOptions::new(settings("unshadowed", &[])) };
        let camera = &scene.cameras[0].camera;
        let quality = Quality { samples: 1, seed: 0 };
        let (truth, _) = ViewTruth::new(gpu, rays, scene, camera, &options, &quality, &|_: &str, _| {
            ControlFlow::Continue(())
        })
        .expect("a truth");
        let mut judge = Self { gpu, scene, truth, beyond: Vec::new() };
        let masks = judge.renderer(&settings("mask", &[]), View::Visibility).mask_views();
        assert_eq!(masks.len(), 1, "one blocker, one light");
        let is_beyond = |p: DVec3| p.y.abs() < 1e-4 && masks[0].region(p.as_vec3()) == Region::Beyond;
        let receivers = judge.truth.judged.receivers();
        judge.beyond = (0..receivers.len())
            .filter(|i| {
                receivers[*i] && judge.truth.surfaces.seen[*i].as_ref().is_some_and(|s| is_beyond(s.p_world))
            })
            .collect();
        judge
    }

    fn renderer(&self, settings: &Settings, view: View) -> Renderer<'a> {
        let options =
            RenderOptions { size: SIZE, view, reuse: false, ..RenderOptions::new(settings.clone()) };
        Renderer::new(self.gpu, self.scene, &self.scene.cameras[0].camera, options).expect("a renderer")
    }

    fn judge(&self, technique: &str, pairs: &[(&str, &str)]) -> Judged {
        let settings = settings(technique, pairs);
        let mut shown = self.renderer(&settings, View::Visibility);
        shown.frame(Measure::Frame).expect("a frame");
        let v = shown.visibility().expect("V");
        assert!(shown.warnings().is_empty(), "{:?}", shown.warnings());
        let truth = self.truth.judged.truth();
        let squares = self.beyond.iter().map(|i| (f64::from(v[*i]) - f64::from(truth[*i].x)).powi(2));
        let rmse = (squares.sum::<f64>() / self.beyond.len() as f64).sqrt();
        let mut with = self.renderer(&settings, View::Final);
        let mut bare = self.renderer(&self::settings("unshadowed", &[]), View::Final);
        let cost = Cost::measure(&mut with, &mut bare, &settings, 1).expect("a cost");
        Judged { rmse, cost, masks: with.mask_views() }
    }

    /// Corners of the blocker, world space.
    fn points(&self) -> Vec<Vec3> {
        let of = |placed: &Instance| {
            let place = placed.world_from_object;
            self.scene.meshes[placed.mesh].positions.iter().map(move |p| place.transform_point3(*p))
        };
        self.scene.instances.iter().filter(|placed| placed.object == 0).flat_map(of).collect()
    }
}

#[test]
fn masks_are_as_right_as_maps_for_half_of_the_triangles() {
    let Some(gpu) = gpu() else { return };
    println!("{:15} {:18} {:>7} {:>9} {:>8}", "blocker", "technique", "rmse", "triangles", "texels");
    for (name, scene) in blockers() {
        let rays = Rays::new(&scene).expect("rays");
        let judge = Judge::new(&gpu, &scene, &rays);
        let dark = judge.beyond.iter().filter(|i| judge.truth.judged.truth()[**i] == Vec3::ZERO).count();
        assert!(dark > 150, "{name}: {dark} pixels beyond the blocker are dark");
        let linear = judge.judge("linear", &[("map_size", TEXELS)]);
        let show = |technique: &str, found: &Judged| {
            let cost = &found.cost;
            println!("{name:15} {technique:18} {:7.4} {:9} {:8}", found.rmse, cost.triangles, cost.texels);
        };
        show("linear", &linear);
        for technique in ["mask", "mask-subtractive"] {
            let mask = judge.judge(technique, &[("mask_size", TEXELS)]);
            show(technique, &mask);
            assert!(mask.rmse <= 1.2 * linear.rmse, "{name} {technique}: {} {}", mask.rmse, linear.rmse);
            // The second form draws receivers as well, two triangles for each mask and half of its edge.
            let drawn = if technique == "mask" { mask.cost.triangles } else { mask.cost.triangles - 4 };
            assert!(2 * drawn <= linear.cost.triangles, "{name} {technique}: {drawn}");
        }
        // The negative control: a mask that is too coarse is not as right.
        let coarse = judge.judge("mask", &[("mask_size", "16")]);
        assert!(coarse.rmse > 1.2 * linear.rmse, "{name}: 16 texels are told from 512");
    }
}

#[test]
fn adapting_puts_more_texels_on_the_blocker_and_each_geometry_has_its_price() {
    let Some(gpu) = gpu() else { return };
    println!("{:15} {:42} {:>7} {:>8} {:>9}", "blocker", "choices", "rmse", "texels", "triangles");
    for (name, scene) in blockers() {
        let rays = Rays::new(&scene).expect("rays");
        let judge = Judge::new(&gpu, &scene, &rays);
        let points = judge.points();
        let of = |ratios: &str, fit_to: &str, outline: &str| {
            let pairs = [("mask_size", "256"), ("ratios", ratios), ("fit_to", fit_to), ("outline", outline)];
            let found = judge.judge("mask", &pairs);
            let texels = found.masks[0].texels_on(points.iter().copied());
            let choices = format!("ratios={ratios} fit_to={fit_to} outline={outline}");
            println!("{name:15} {choices:42} {:7.4} {texels:8.0} {:9}", found.rmse, found.cost.triangles);
            (found.rmse, texels, found.cost.triangles)
        };
        let adaptive = of("adaptive", "hull", "reduced");
        let symmetric = of("symmetric", "hull", "reduced");
        let fixed = of("fixed", "hull", "reduced");
        let boxed = of("adaptive", "box", "reduced");
        let full = of("adaptive", "hull", "full");
        assert!(
            adaptive.1 >= symmetric.1 && symmetric.1 > fixed.1 && adaptive.1 >= boxed.1,
            "{name}: texels"
        );
        assert!(fixed.0 > adaptive.0, "{name}: fewer texels, more error");
        assert!(2 * adaptive.2 <= full.2, "{name}: triangles of the outline");
        // A fit to a box, a reduced outline: none is worse than a map of that resolution.
        let linear = judge.judge("linear", &[("map_size", "256")]).rmse;
        assert!(adaptive.0.max(symmetric.0).max(boxed.0) <= 1.2 * linear, "{name}: linear has {linear}");
    }
}
