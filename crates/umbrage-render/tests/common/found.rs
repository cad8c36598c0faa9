//! V of a small picture, with where each pixel is.

use super::scenes::{cuboid, over_floor};
use super::settings;
use glam::{DVec3, Mat4, UVec2, Vec3};
use umbrage_render::umbrage::core::fit::MaskView;
use umbrage_render::umbrage::core::{Light, LightKind};
use umbrage_render::{DrawnSurface, Gpu, Measure, RenderOptions, Renderer, View};
use umbrage_scene::{Material, Scene};

/// Pixels along a side.
pub const SIDE: u32 = 96;

/// What a renderer found out.
pub struct Found {
    pub v: Vec<f32>,
    pub surfaces: Vec<Option<DrawnSurface>>,
    pub masks: Vec<MaskView>,
    pub warnings: Vec<String>,
}

impl Found {
    /// V of what is seen, with where it is.
    pub fn seen(&self) -> impl Iterator<Item = (DVec3, f32)> {
        self.surfaces.iter().zip(&self.v).filter_map(|(seen, v)| Some((seen.as_ref()?.p_world, *v)))
    }
}

pub fn found_with(gpu: &Gpu, scene: &Scene, options: RenderOptions) -> Found {
    let options = RenderOptions { size: UVec2::splat(SIDE), view: View::Visibility, ..options };
    let mut renderer = Renderer::new(gpu, scene, &scene.cameras[0].camera, options).expect("a renderer");
    renderer.frame(Measure::Frame).expect("a frame");
    Found {
        v: renderer.visibility().expect("V"),
        surfaces: renderer.surfaces().expect("surfaces"),
        masks: renderer.mask_views(),
        warnings: renderer.warnings().to_vec(),
    }
}

pub fn found(gpu: &Gpu, scene: &Scene, technique: &str, pairs: &[(&str, &str)]) -> Found {
    found_with(gpu, scene, RenderOptions::new(settings(technique, pairs)))
}

/// Boxes of one metre at these places over the floor; the floor is the last object.
pub fn boxes(at: &[Vec3]) -> Scene {
    let meshes = at.iter().map(|_| cuboid(Vec3::splat(0.5))).collect();
    let placed: Vec<_> = at.iter().enumerate().map(|(i, at)| (i, Mat4::from_translation(*at))).collect();
    over_floor(vec![Material::default()], vec![], meshes, &placed)
}

pub fn kinds() -> [Light; 3] {
    let spot = Light::spot(Vec3::new(-1.2, 6.0, 1.0), Vec3::ZERO, 0.6, 0.7);
    [
        spot,
        Light { kind: LightKind::Point, ..spot },
        Light { kind: LightKind::Directional, near_m: None, far_m: None, ..spot },
    ]
}
