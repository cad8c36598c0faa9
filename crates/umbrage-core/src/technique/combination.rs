//! The choices of a map together: which go together, which WGSL they are made of, how far and how often they look.

use super::Param;
use super::choices::{Bias, Choice, Filter, Projection, Storage, Translucent};

/// The five choices of a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Combination {
    /// How depth is kept.
    pub storage: Storage,
    /// How the view is laid around the scene.
    pub projection: Projection,
    /// What keeps a lit surface from shadowing itself.
    pub bias: Bias,
    /// How texels become visibility.
    pub filter: Filter,
    /// What translucent casters do to light.
    pub translucent: Translucent,
}

impl Combination {
    /// Every combination there is, valid or not.
    pub fn all() -> impl Iterator<Item = Self> {
        Storage::ALL.iter().flat_map(|&storage| {
            Projection::ALL.iter().flat_map(move |&projection| {
                Bias::ALL.iter().flat_map(move |&bias| {
                    Filter::ALL.iter().flat_map(move |&filter| {
                        Translucent::ALL.iter().map(move |&translucent| Self {
                            storage,
                            projection,
                            bias,
                            filter,
                            translucent,
                        })
                    })
                })
            })
        })
    }

    /// Why the five do not go together; `None` when they do.
    pub fn objection(&self) -> Option<&'static str> {
        let warped = matches!(self.projection, Projection::Perspective | Projection::LightSpacePerspective);
        if warped && self.storage.is_color() {
            return Some(
                "colour storages hold distance along the light's axis, and a warped map's planes are planes of depth only",
            );
        }
        if self.colors_light() && matches!(self.bias, Bias::Midpoint | Bias::SecondDepth) {
            return Some(
                "colours end at the first opaque surface, which midpoint and second-depth maps do not hold",
            );
        }
        if self.filter == Filter::MultiView && self.projection != Projection::Fitted {
            return Some(
                "each place of an area light would follow the eye in its own way; multiple views are fitted",
            );
        }
        None
    }

    /// The rows of the five choices.
    pub fn rows(&self) -> [&'static Choice; 5] {
        [
            self.storage.row(),
            self.projection.row(),
            self.bias.row(),
            self.filter.row(),
            self.translucent.row(),
        ]
    }

    /// Is V a colour: three numbers, not one?
    pub fn colors_light(&self) -> bool {
        self.translucent == Translucent::Colored
    }

    /// The parameters of the five choices.
    pub fn params(&self) -> impl Iterator<Item = &'static Param> {
        self.rows().into_iter().flat_map(|row| row.params)
    }

    /// Is the comparison left to the hardware's comparison sampler? It has one depth for all texels, and depth textures only.
    pub fn compares_in_hardware(&self) -> bool {
        self.filter == Filter::Linear
            && !self.storage.is_color()
            && !self.colors_light()
            && self.compare_module() == "compare/plain"
    }

    fn compare_module(&self) -> &'static str {
        match self.bias {
            Bias::Auto => "compare/auto",
            Bias::ReceiverPlane => "compare/plane",
            _ => "compare/plain",
        }
    }

    /// The WGSL module that filters.
    pub fn filter_module(&self) -> &'static str {
        match self.filter {
            Filter::Nearest | Filter::MultiView if self.colors_light() => "filter/colored_nearest",
            Filter::Linear if self.colors_light() => "filter/colored_linear",
            Filter::Pcf | Filter::Kernel if self.colors_light() => "filter/colored_kernel",
            Filter::Nearest | Filter::MultiView => "filter/nearest",
            Filter::Linear if self.compares_in_hardware() => "filter/linear_hardware",
            Filter::Linear => "filter/linear",
            Filter::Pcf | Filter::Kernel => "filter/kernel",
        }
    }

    /// The WGSL function that filters: `umbrage_filter_...`, with the map, a sampler, the view and the texel as arguments; where
    /// light is coloured, the map of translucent casters and that of colours come after the map.
    pub fn filter_function(&self) -> String {
        self.filter_module().replacen("filter/", "umbrage_filter_", 1)
    }

    /// How far from the receiver, along either axis of the map, the centre of a texel may lie that counts, texels.
    /// `width_texel` is the filter's width, where it has one.
    pub fn reach_texel(&self, width_texel: f32) -> f32 {
        match self.filter {
            Filter::Nearest => 0.5,
            Filter::Linear | Filter::MultiView => 1.0,
            Filter::Pcf | Filter::Kernel => 0.5 * (width_texel + 1.0),
        }
    }

    /// Lookups of the map for each lit pixel: a gather counts once.
    pub fn taps(&self, width_texel: f32) -> u32 {
        let quads = (0.5 * (width_texel + 1.0)).ceil() as u32;
        let lookups = match self.filter {
            Filter::Nearest | Filter::Linear | Filter::MultiView => 1,
            Filter::Pcf | Filter::Kernel => quads * quads,
        };
        let channels = match self.storage {
            Storage::Packed2 => 2,
            Storage::Packed3 => 3,
            _ => 1,
        };
        // Coloured: a second map, and red, green and blue.
        lookups * if self.colors_light() { 2 * channels + 3 } else { channels }
    }

    /// The WGSL modules of the five choices.
    pub fn modules(&self) -> Vec<&'static str> {
        let map = match self.storage {
            Storage::Auto | Storage::Depth16 | Storage::Depth24 | Storage::Depth32Float => "map/depth",
            Storage::R32Float => "map/distance",
            Storage::Packed1 => "map/packed1",
            Storage::Packed2 => "map/packed2",
            Storage::Packed3 => "map/packed3",
        };
        let mut modules = vec!["locate", map, self.compare_module(), self.filter_module()];
        modules.extend((self.filter == Filter::Pcf).then_some("kernel/box"));
        modules.extend((self.bias == Bias::Normal).then_some("bias/normal"));
        modules
    }
}
