//! Shadow volumes against ray-traced truth: what differs lies at a geometric edge, wherever eye and light are.

mod common;

/// The scenes of the renderer's own tests.
#[path = "../../umbrage-render/tests/common/scenes.rs"]
#[allow(dead_code, reason = "its other scenes are for goldens")]
mod scenes;

use common::{builtin, gpu, settings};
use glam::{DVec3, UVec2, Vec3};
use scenes::{sheet, sun_of, with_light};
use std::path::Path;
use std::time::Instant;
use umbrage_render::umbrage::core::technique::Settings;
use umbrage_render::umbrage::core::{Camera, Light, LightKind, Projection};
use umbrage_render::{Gpu, Measure, RenderOptions, Renderer, View};
use umbrage_scene::{AlphaMode, Instance, Material, Scene, SceneCamera};
use umbrage_truth::{Emitter, Place, Quality, Rays, Seen, Surfaces, Visibility, silent};

const SIZE: UVec2 = UVec2::new(240, 135);
/// Share of the judged pixels that may differ.
const MOST: f64 = 1e-3;
/// Planes of two pixels are one when each lies so near to the other's, pixels.
const SAME_PLANE_PX: f64 = 0.05;

/// What a picture has to do with the truth.
#[derive(Clone, Copy, Debug, Default)]
struct Found {
    /// Pixels that face the light, lie in its reach, and show what rays saw.
    judged: usize,
    /// Of them in shadow, by truth.
    dark: usize,
    /// Of them answered the other way.
    differ: usize,
    /// Of these, dark ones that should be lit and lit ones that should be dark, farther than one pixel from any edge.
    acne: usize,
    leak: usize,
    /// How far the farthest of all that differ is from an edge, pixels.
    worst_px: u32,
    /// V that is neither 0 nor 1.
    neither: usize,
}

impl Found {
    fn check(&self, what: &str) {
        println!("{what}: {self:?}");
        assert!(self.judged > 400, "{what}: nothing to judge: {self:?}");
        assert!((self.differ as f64) <= MOST * self.judged as f64, "{what}: {self:?}");
        assert!(self.acne + self.leak + self.neither == 0 && self.worst_px <= 1, "{what}: {self:?}");
    }
}

/// The truth of a light in a picture.
struct Truth {
    surfaces: Surfaces,
    visibility: Visibility,
}

impl Truth {
    fn new(rays: &Rays<'_>, camera: &Camera, light: &Light) -> Self {
        let surfaces = Surfaces::new(rays, camera, SIZE, &silent).expect("surfaces");
        let visibility =
            Visibility::new(rays, &surfaces, light, &Quality::default(), &silent).expect("truth");
        Self { surfaces, visibility }
    }

    /// Is one a pixel at an edge: of a shadow, of a surface, or a crease?
    fn is_edge(&self, a: usize, b: usize) -> bool {
        let is_crease = match (&self.surfaces.seen[a], &self.surfaces.seen[b]) {
            (None, None) => false,
            (Some(a), Some(b)) => a.slot != b.slot && !(self.is_on_plane(a, b) && self.is_on_plane(b, a)),
            _ => true,
        };
        is_crease || self.visibility.v[a] != self.visibility.v[b]
    }

    fn is_on_plane(&self, of: &Seen, other: &Seen) -> bool {
        let off_m = (other.p_world - of.p_world).dot(of.normal_world.as_dvec3()).abs();
        off_m <= SAME_PLANE_PX * self.surfaces.pixel_m(of)
    }

    /// How far the nearest edge is, pixels, `most` where there is none nearer.
    fn edge_px(&self, pixel: usize, most: u32) -> u32 {
        let size = SIZE.as_ivec2();
        let at = glam::IVec2::new(pixel as i32 % size.x, pixel as i32 / size.x);
        let index = |p: glam::IVec2| {
            (p.cmpge(glam::IVec2::ZERO).all() && p.cmplt(size).all()).then(|| (p.y * size.x + p.x) as usize)
        };
        let around = |r: i32| (-r..=r).flat_map(move |y| (-r..=r).map(move |x| glam::IVec2::new(x, y)));
        // An edge lies between two pixels of the square around this one.
        let has_edge = |r: u32| {
            let inside = |p: glam::IVec2| (p - at).abs().max_element() <= r as i32;
            around(r as i32).filter_map(|d| index(at + d).map(|i| (at + d, i))).any(|(p, i)| {
                let next = [p + glam::IVec2::X, p + glam::IVec2::Y, p + glam::IVec2::ONE];
                next.into_iter()
                    .filter(|next| inside(*next))
                    .any(|next| index(next).is_some_and(|j| self.is_edge(i, j)))
            })
        };
        (1..most).find(|r| has_edge(*r)).unwrap_or(most)
    }
}

/// V of a technique's first light.
fn answer(gpu: &Gpu, scene: &Scene, camera: &Camera, with: Settings) -> (Vec<f32>, Vec<bool>, Vec<String>) {
    let options = RenderOptions { size: SIZE, view: View::Visibility, ..RenderOptions::new(with) };
    let mut renderer = Renderer::new(gpu, scene, camera, options).expect("a renderer");
    renderer.frame(Measure::Frame).expect("a frame");
    let emitter = Emitter::new(&scene.lights[0].light);
    // The picture is dark where the shading's normal faces away, whatever V is.
    let faces = renderer.surfaces().expect("surfaces").into_iter().map(|drawn| {
        drawn.is_some_and(|s| s.shading_normal_world.as_dvec3().dot(emitter.center(s.p_world).way) > 0.0)
    });
    let warnings = renderer.warnings().to_vec();
    (renderer.visibility().expect("V"), faces.collect(), warnings)
}

/// Pixels in which rasteriser and rays saw the same.
fn same(gpu: &Gpu, scene: &Scene, camera: &Camera, surfaces: &Surfaces) -> Vec<bool> {
    let options =
        RenderOptions { size: SIZE, view: View::Visibility, ..RenderOptions::new(settings("unshadowed", &[])) };
    let mut renderer = Renderer::new(gpu, scene, camera, options).expect("a renderer");
    renderer.frame(Measure::Frame).expect("a frame");
    let drawn = renderer.surfaces().expect("surfaces");
    let same = surfaces.seen.iter().zip(drawn).map(|(seen, drawn)| match (seen, drawn) {
        (Some(seen), Some(drawn)) => {
            let offset: DVec3 = drawn.p_world - seen.p_world;
            offset.dot(seen.normal_world.as_dvec3()).abs() <= SAME_PLANE_PX * surfaces.pixel_m(seen)
                && offset.length() < 1e3 * surfaces.pixel_m(seen)
        }
        (None, None) => true,
        _ => false,
    });
    same.collect()
}

/// One scene with its hierarchy, under one light at a time.
struct Subject<'a> {
    gpu: &'a Gpu,
    rays: Rays<'a>,
    scene: &'a Scene,
}

impl<'a> Subject<'a> {
    fn new(gpu: &'a Gpu, scene: &'a Scene) -> Self {
        Self { gpu, rays: Rays::new(scene).expect("rays"), scene }
    }

    fn judge(&self, camera: &Camera, light: Light, with: &Settings) -> Found {
        self.judge_with(camera, light, std::slice::from_ref(with)).remove(0)
    }

    fn judge_with(&self, camera: &Camera, light: Light, with: &[Settings]) -> Vec<Found> {
        let scene = with_light(self.scene.clone(), light);
        let truth = Truth::new(&self.rays, camera, &light);
        let same = same(self.gpu, &scene, camera, &truth.surfaces);
        with.iter().map(|with| self.found(&truth, &same, &scene, camera, with)).collect()
    }

    fn found(&self, truth: &Truth, same: &[bool], scene: &Scene, camera: &Camera, with: &Settings) -> Found {
        let (v, faces, _) = answer(self.gpu, scene, camera, with.clone());
        let mut found = Found::default();
        for pixel in 0..v.len() {
            if truth.visibility.place[pixel] != Place::Receiver || !faces[pixel] || !same[pixel] {
                continue;
            }
            let expected = truth.visibility.v[pixel].x;
            found.judged += 1;
            found.dark += usize::from(expected < 0.5);
            found.neither += usize::from(v[pixel] != 0.0 && v[pixel] != 1.0);
            if (v[pixel] - expected).abs() <= 0.5 {
                continue;
            }
            let edge_px = truth.edge_px(pixel, 16);
            found.differ += 1;
            found.worst_px = found.worst_px.max(edge_px);
            found.acne += usize::from(edge_px > 1 && expected > 0.5);
            found.leak += usize::from(edge_px > 1 && expected <= 0.5);
        }
        found
    }
}

fn kinds(spot: Light) -> [Light; 3] {
    [
        spot,
        Light { kind: LightKind::Point, ..spot },
        Light { kind: LightKind::Directional, intensity: 3.0, near_m: None, far_m: None, range_m: None, ..spot },
    ]
}

#[test]
fn built_in_scenes_are_right_to_the_pixel() {
    let Some(gpu) = gpu() else { return };
    for name in ["torus", "columns", "contact", "tilt", "knots"] {
        let start = Instant::now();
        let scene = builtin(name);
        let subject = Subject::new(&gpu, &scene);
        let camera = scene.cameras[0].camera;
        for light in kinds(scene.lights[0].light) {
            subject
                .judge(&camera, light, &settings("volume", &[]))
                .check(&format!("{name} {}", light.kind.id()));
        }
        println!("{name} took {:?}", start.elapsed());
    }
}

/// A model on a ground of its own, with an eye and a light that see all of it.
fn on_ground(mut scene: Scene) -> Scene {
    let bounds = scene.bounds();
    let (middle, size) = (bounds.center(), bounds.size().max_element());
    let ground = Vec3::new(middle.x, bounds.min.y - 0.002 * size, middle.z);
    scene.materials.push(Material::default());
    scene.meshes.push(sheet(ground, Vec3::X * 3.0 * size, Vec3::NEG_Z * 3.0 * size, scene.materials.len() - 1));
    let (mesh, world_from_object) = (scene.meshes.len() - 1, glam::Mat4::IDENTITY);
    scene.instances.push(Instance { name: "ground".into(), mesh, world_from_object });
    let eye = middle + size * Vec3::new(0.9, 0.8, 1.2);
    let camera = Camera::look_at(eye, middle - 0.15 * size * Vec3::Y, 0.8, 0.02 * size, 30.0 * size);
    scene.cameras = vec![SceneCamera { name: String::new(), camera }];
    let place = middle + size * Vec3::new(-0.8, 1.6, 0.5);
    with_light(scene, Light::spot(place, ground, 0.7, 0.8))
}

/// Below `shared/scenes`; true: solid in every part that is seen, so nothing is excused.
const MODELS: &[&str] = &[
    "classic-obj/teapot.obj",
    "classic-obj/spot/spot_triangulated.obj",
    "classic-obj/cornell_box.obj",
    "suzanne/Suzanne.gltf",
    "fox/Fox.glb",
    "zdm2/zdm2.glb",
    "negative-scale-test/NegativeScaleTest.glb",
    "metal-rough-spheres-no-textures/MetalRoughSpheresNoTextures.glb",
    "kenney-city-builder/building-small-c.glb",
    "kenney-city-builder/grass-trees-tall.glb",
    "kenney-city-builder/road-straight-lightposts.glb",
    "kenney-city-builder/pavement-fountain.glb",
    "loader-features/SimpleInstancing/SimpleInstancing.glb",
    "loader-features/BoxAnimated/BoxAnimated.glb",
    "loader-features/RiggedFigure/RiggedFigure.glb",
    "loader-features/OrientationTest/OrientationTest.glb",
    "loader-features/SimpleSkin/SimpleSkin.gltf",
    "morph-stress-test/MorphStressTest.glb",
    "recursive-skeletons/RecursiveSkeletons.glb",
    "thin-casters/fence/fence.obj",
    "thin-casters/pedestrianRailing1/pedestrianRailing1.obj",
    "thin-casters/radiator3/radiator3.obj",
    "thin-casters/spiralStaircase/spiralStaircase.obj",
    "thin-casters/tableFan/tableFan.obj",
    "thin-casters/tennisRacket/tennisRacket.obj",
    "thin-casters/umbrella/umbrella.obj",
    "scopia-trees/pine/pine.obj",
    "scopia-trees/japaneseMaple/japaneseMaple.obj",
    "scopia-trees/hedge/hedge.obj",
    "scopia-trees/palm/palm.obj",
    "flight-helmet/FlightHelmet.gltf",
    "lights-punctual-lamp/LightsPunctualLamp.gltf",
    "toy-car/ToyCar.gltf",
    "sheen-cloth/SheenCloth.gltf",
    "mannequiny/mannequiny.glb",
    "dutch-ship/dutch_ship_medium_1k.gltf",
    "kaykit-medieval-hexagon/buildings/blue/building_castle_blue.gltf",
    "kaykit-medieval-hexagon/decoration/nature/trees_A_large.gltf",
    "required-extensions/truck-town-webp/town_model.gltf",
];

#[test]
fn models_are_right_to_the_pixel() {
    let Some(gpu) = gpu() else { return };
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/scenes");
    if !folder.is_dir() {
        eprintln!("SKIPPED: {} is not there, so no model was judged", folder.display());
        return;
    }
    for name in MODELS {
        let start = Instant::now();
        let scene = match umbrage_scene::load(&folder.join(name).to_string_lossy()) {
            Ok(scene) => on_ground(scene),
            Err(e) => { println!("{name} {e}"); continue }
        };
        let loaded = start.elapsed();
        let masked = scene.materials.iter().filter(|m| m.alpha != AlphaMode::Opaque).count();
        let subject = Subject::new(&gpu, &scene);
        let camera = scene.cameras[0].camera;
        for light in kinds(scene.lights[0].light) {
            let f = subject.judge(&camera, light, &settings("volume", &[]));
            println!("ROW {name} {} {f:?} masked {masked}", light.kind.id());
        }
        println!("{name} loaded {loaded:?} took {:?}", start.elapsed());
    }
}
