//! What a picture should be.

use glam::{UVec2, Vec3};
use std::sync::Arc;
use umbrage::core::technique::Settings;

/// What the picture shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum View {
    /// The lit, shadowed scene.
    Final,
    /// V of one light: white lit, black shadow.
    Visibility,
    /// The lit, shadowed scene from the light's eye.
    Light,
    /// The light's map: near black, far white.
    Depth,
    /// Each surface's distance from the light: near black, far white.
    Distance,
    /// The map projected on the scene.
    Projected,
    /// The channels of a map that is a colour target.
    Channels,
    /// Texels of the light's map in a pixel, over the dimmed scene, with a legend and a histogram.
    Density,
    /// The same numbers in each texel of the map.
    DensityLight,
    /// Faces of the light's shadow volumes in a pixel, over the dimmed scene, with a legend and a histogram.
    Volumes,
}

impl View {
    /// All views.
    pub const ALL: [Self; 10] = [
        Self::Final,
        Self::Visibility,
        Self::Light,
        Self::Depth,
        Self::Distance,
        Self::Projected,
        Self::Channels,
        Self::Density,
        Self::DensityLight,
        Self::Volumes,
    ];

    /// Name on the command line.
    pub fn id(self) -> &'static str {
        match self {
            Self::Final => "final",
            Self::Visibility => "visibility",
            Self::Light => "light",
            Self::Depth => "depth",
            Self::Distance => "distance",
            Self::Projected => "projected",
            Self::Channels => "channels",
            Self::Density => "density",
            Self::DensityLight => "density-light",
            Self::Volumes => "volumes",
        }
    }

    /// What it shows, in one clause.
    pub fn summary(self) -> &'static str {
        match self {
            Self::Final => "the lit, shadowed scene",
            Self::Visibility => "how much of the light each surface sees: white lit, black shadow",
            Self::Light => "the scene from the light's eye",
            Self::Depth => "the light's map: near black, far white",
            Self::Distance => "each surface's distance from the light: near black, far white",
            Self::Projected => "the light's map projected on the scene",
            Self::Channels => "the channels of a map that is a colour target (storage r32f or packed)",
            Self::Density => "shadow-map texels per pixel: blue too few, red to spare; with a histogram",
            Self::DensityLight => {
                "the same from the light's eye, in its map; grey where the eye does not look"
            }
            Self::Volumes => {
                "faces of shadow volumes per pixel, which is what counting costs, and the deepest count"
            }
        }
    }

    /// Does it show what the map holds?
    pub fn shows_map(self) -> bool {
        matches!(self, Self::Depth | Self::Projected | Self::Channels | Self::DensityLight)
    }

    /// Does it hold texels per pixel?
    pub fn is_density(self) -> bool {
        matches!(self, Self::Density | Self::DensityLight)
    }

    /// Does it need the map itself, and so a light that has one?
    pub fn needs_map(self) -> bool {
        !matches!(self, Self::Final | Self::Visibility | Self::Volumes)
    }
}

/// Everything about a picture but its scene, camera and lights.
#[derive(Clone, Debug)]
pub struct RenderOptions {
    /// Pixels.
    pub size: UVec2,
    /// Technique and parameters, the same for every light.
    pub settings: Settings,
    /// What the picture shows.
    pub view: View,
    /// Which light the debug views show.
    pub shown_light: usize,
    /// Samples a pixel: 1 or what the adapter does (4 everywhere).
    pub samples: u32,
    /// Every material as ambient, Lambert and Blinn, as the documents shade.
    pub all_blinn: bool,
    /// Light that comes from everywhere, as a share of the brightest light. 0..1, default 0.08.
    pub ambient: f32,
    /// Share of the diffuse light that stays in shadow, so that shadows do not look flat. 0..1, default 0.1.
    pub fill: f32,
    /// Factor from radiance to picture. `None`: from the lights.
    pub exposure: Option<f32>,
    /// Linear RGB where nothing is drawn.
    pub background: Vec3,
    /// Draw every caster into the maps, also those that can be shown to shadow nothing. Costs time and changes no
    /// picture but those of the maps themselves, which always have them all. Default false.
    pub all_casters: bool,
    /// Draw a map again only when its light, its view or a caster in its view has moved. Changes no picture; a frame then
    /// costs what moved, not what there is, so whoever measures what maps cost sets false. Default true.
    pub reuse: bool,
    /// Busy work on the CPU before each map that is drawn, milliseconds: stands for an application's own culling and
    /// skinning when threads are measured. 0 or more, default 0.
    pub map_load_ms: f32,
    /// A WGSL function that moves vertices, in maps and pictures alike: `fn umbrage_deform(p_world: vec3f, p_object: vec3f,
    /// time_s: f32) -> vec3f`. Default none.
    pub deform: Option<Arc<str>>,
    /// How far it may move them, metres: boxes grow by it. Default 0.
    pub deform_reach_m: f32,
    /// What it is told of time until [`crate::Renderer::set_time`] says otherwise, seconds. Default 0.
    pub time_s: f32,
    /// Weights of the filter `kernel` as a WGSL function: `fn umbrage_kernel(view: UmbrageView, right: vec4f, down: vec4f) ->
    /// vec4f`, of four texels whose centres lie so far from the receiver. Default none: a bell.
    pub kernel: Option<Arc<str>>,
    /// V that was found elsewhere (by rays, say), in place of any technique's. Default none.
    pub given: Option<Arc<GivenVisibility>>,
}

/// V of each light for each pixel, rows from the top; red, green and blue apart, because light may be coloured on its way.
///
/// Surfaces that are mixed by alpha over a pixel take the V of what is behind them: there is one a pixel.
#[derive(Clone, Debug, Default)]
pub struct GivenVisibility {
    /// One list for each light, as many as the scene has and a picture can have.
    pub of_light: Vec<Vec<Vec3>>,
}

impl RenderOptions {
    /// Is V a colour: three numbers for each pixel, not one?
    pub fn colors_light(&self) -> bool {
        self.given.is_some() || self.settings.combination().is_some_and(|c| c.colors_light())
    }

    /// A 1280x720 picture with these settings.
    pub fn new(settings: Settings) -> Self {
        Self {
            size: UVec2::new(1280, 720),
            settings,
            view: View::Final,
            shown_light: 0,
            samples: 1,
            all_blinn: false,
            ambient: 0.08,
            fill: 0.1,
            exposure: None,
            background: Vec3::new(0.05, 0.06, 0.08),
            all_casters: false,
            reuse: true,
            map_load_ms: 0.0,
            deform: None,
            deform_reach_m: 0.0,
            time_s: 0.0,
            kernel: None,
            given: None,
        }
    }
}
