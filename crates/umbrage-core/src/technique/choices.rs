//! The five choices of a depth map, each a table: how it is stored, projected, biased and filtered, and what translucent
//! casters do to light.

use super::{Param, ParamDefault, Source};

/// One row of a table of choices.
#[derive(Clone, Copy, Debug)]
pub struct Choice {
    /// Name on the command line.
    pub id: &'static str,
    /// Name for people.
    pub label: &'static str,
    /// What it is, in one sentence.
    pub summary: &'static str,
    /// Where it was published.
    pub source: Option<Source>,
    /// WGSL modules that it needs, see [`crate::wgsl`].
    pub modules: &'static [&'static str],
    /// Its parameters.
    pub params: &'static [Param],
}

/// Makes an enum of choices whose rows stand beside their names, so that neither can be without the other.
macro_rules! choices {
    ($(#[$doc:meta])* $name:ident { $($(#[$variant_doc:meta])* $variant:ident = $row:expr;)* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum $name { $($(#[$variant_doc])* $variant),* }

        impl $name {
            /// Every choice, in the order of the table.
            pub const ALL: &'static [Self] = &[$(Self::$variant),*];

            /// Its row.
            pub fn row(self) -> &'static Choice {
                match self { $(Self::$variant => { const ROW: Choice = $row; &ROW })* }
            }

            /// The choice of that name.
            pub fn find(id: &str) -> Option<Self> {
                Self::ALL.iter().copied().find(|choice| choice.row().id == id)
            }
        }
    };
}

const EMPTY: Choice = Choice { id: "", label: "", summary: "", source: None, modules: &[], params: &[] };

const INTEL: Source =
    Source { paper: "Intel, Real-Time Shadow Maps on Mainstream Graphics Hardware", year: 2007 };
const BJORKE: Source = Source { paper: "Bjorke, Shadowing Strategies for HLSL and FX Composer", year: 2005 };
const EVERITT: Source = Source { paper: "Everitt, Rege and Cebenoyan, Hardware Shadow Mapping", year: 2001 };
pub(super) const WOO: Source =
    Source { paper: "Woo, The Shadow Depth Map Revisited, Graphics Gems III", year: 1992 };
pub(super) const WANG_MOLNAR: Source =
    Source { paper: "Wang and Molnar, Second-Depth Shadow Mapping", year: 1994 };

choices! {
    /// How depth is kept.
    Storage {
        /// The most precise depth format that the adapter can draw to and compare with.
        Auto = Choice {
            id: "auto",
            label: "Automatic",
            summary: "the most precise depth format that the adapter can draw to and compare with",
            params: &[MAP_SIZE],
            ..EMPTY
        };
        /// 16-bit normalised.
        Depth16 = Choice {
            id: "depth16",
            label: "16-bit",
            summary: "16-bit normalised depth: half the memory, needs the largest constant bias",
            params: &[MAP_SIZE],
            source: Some(EVERITT),
            ..EMPTY
        };
        /// 24-bit normalised or better.
        Depth24 = Choice {
            id: "depth24",
            label: "24-bit",
            summary: "24-bit normalised depth, or better: WebGPU lets the adapter use 32-bit float instead",
            params: &[MAP_SIZE],
            source: Some(EVERITT),
            ..EMPTY
        };
        /// 32-bit float.
        Depth32Float = Choice {
            id: "depth32f",
            label: "32-bit float",
            summary: "32-bit float depth, reversed: even relative precision over the whole range",
            params: &[MAP_SIZE],
            ..EMPTY
        };
        /// Distance in a float colour target.
        R32Float = Choice {
            id: "r32f",
            label: "Float distance",
            summary: "distance from the light in a 32-bit float colour target, compared in the shader",
            params: &[MAP_SIZE],
            source: Some(INTEL),
            ..EMPTY
        };
        /// Distance in one 8-bit channel.
        Packed1 = Choice {
            id: "packed1",
            label: "8-bit packed",
            summary: "distance in one 8-bit channel of a colour target: 256 steps, to show that they are too few",
            params: &[MAP_SIZE],
            source: Some(INTEL),
            ..EMPTY
        };
        /// Distance in two 8-bit channels.
        Packed2 = Choice {
            id: "packed2",
            label: "16-bit packed",
            summary: "distance in two 8-bit channels of a colour target",
            params: &[MAP_SIZE],
            source: Some(INTEL),
            ..EMPTY
        };
        /// Distance in three 8-bit channels.
        Packed3 = Choice {
            id: "packed3",
            label: "24-bit packed",
            summary: "distance in three 8-bit channels of a colour target: any hardware has it",
            params: &[MAP_SIZE],
            source: Some(INTEL),
            ..EMPTY
        };
    }
}

choices! {
    /// How the light's view is laid around the scene.
    Projection {
        /// The cone or box of the light, near and far fitted to what is in it.
        Fitted = Choice {
            id: "fitted",
            label: "Fitted",
            summary: "the light's cone (or box), with near and far fitted to what is in it",
            ..EMPTY
        };
        /// The part of that which the eye sees.
        Adaptive = Choice {
            id: "adaptive",
            label: "Adaptive",
            summary: "only what the eye sees of the light's cone (or box), each axis for itself; follows the eye",
            modules: &["locate"],
            source: Some(Source { paper: "Nagy, Real-Time Shadows on Complex Objects", year: 2000 }),
            ..EMPTY
        };
        /// Warped as the eye's own perspective.
        Perspective = Choice {
            id: "perspective",
            label: "Perspective",
            summary: "a map in the space behind the eye's perspective, so that near things get more texels",
            modules: &["locate"],
            source: Some(Source { paper: "Stamminger and Drettakis, Perspective Shadow Maps", year: 2002 }),
            ..EMPTY
        };
        /// Warped by a perspective across the light.
        LightSpacePerspective = Choice {
            id: "lispsm",
            label: "Light-space perspective",
            summary: "a perspective across the light whose strength evens out near and far errors",
            modules: &["locate"],
            source: Some(Source {
                paper: "Wimmer, Scherzer and Purgathofer, Light Space Perspective Shadow Maps",
                year: 2004,
            }),
            ..EMPTY
        };
    }
}

choices! {
    /// What keeps a lit surface from shadowing itself.
    Bias {
        /// Nothing to set.
        Auto = Choice {
            id: "auto",
            label: "Automatic",
            summary: "nothing to set: a texel blocks only where receiver's plane, caster's plane and a cone around the ray agree",
            ..EMPTY
        };
        /// Nothing.
        None = Choice {
            id: "none",
            label: "None",
            summary: "no bias: every lit surface shadows itself in part, to show why a bias is needed",
            ..EMPTY
        };
        /// A constant polygon offset.
        Constant = Choice {
            id: "constant",
            label: "Constant",
            summary: "a constant polygon offset in the map's smallest steps: answers rounding, not slope",
            source: Some(EVERITT),
            params: &[CONSTANT],
            ..EMPTY
        };
        /// A polygon offset in proportion to slope, and a constant.
        Slope = Choice {
            id: "slope",
            label: "Slope-scaled",
            summary: "polygon offset in proportion to the depth slope of each triangle, and a constant",
            source: Some(EVERITT),
            params: &[SLOPE_FACTOR, CONSTANT],
            ..EMPTY
        };
        /// A uniform bias in the lookup matrix.
        Matrix = Choice {
            id: "matrix",
            label: "Lookup matrix",
            summary: "a uniform bias in the lookup matrix, for hardware without polygon offset",
            source: Some(EVERITT),
            params: &[MATRIX_BIAS],
            ..EMPTY
        };
        /// The receiver moved along its normal.
        Normal = Choice {
            id: "normal",
            label: "Normal offset",
            summary: "the receiver is moved along its normal and towards the light before it is looked up, as most engines do",
            source: Some(Source { paper: "Holbert, Saying Goodbye to Shadow Acne", year: 2011 }),
            params: &[
                NORMAL_OFFSET,
                NORMAL_ALWAYS,
                NORMAL_TILT,
                DEPTH_TEXEL,
                DEPTH_M,
                DEPTH_SHARE,
                POLYGON_SLOPE,
                CONSTANT,
            ],
            ..EMPTY
        };
        /// The receiver's plane.
        ReceiverPlane = Choice {
            id: "receiver-plane",
            label: "Receiver plane",
            summary: "each texel is compared with the receiver's plane at the texel's centre",
            source: Some(Source { paper: "Schuler, Eliminating Surface Acne with Gradient Shadow Mapping", year: 2005 }),
            params: &[PLANE_MARGIN],
            ..EMPTY
        };
        /// Halfway between the nearest and the second-nearest surface.
        Midpoint = Choice {
            id: "midpoint",
            label: "Midpoint",
            summary: "the map holds the middle between nearest and second-nearest surface, by two passes of depth peeling",
            source: Some(WOO),
            ..EMPTY
        };
        /// Back faces only.
        SecondDepth = Choice {
            id: "second-depth",
            label: "Second depth",
            summary: "the map holds back faces only; casters that are not closed are drawn whole, and reported",
            source: Some(WANG_MOLNAR),
            ..EMPTY
        };
    }
}

choices! {
    /// How texels become visibility.
    Filter {
        /// The one texel that holds the receiver.
        Nearest = Choice {
            id: "nearest",
            label: "Nearest",
            summary: "one comparison with the texel that holds the receiver",
            ..EMPTY
        };
        /// Four comparisons, blended.
        Linear = Choice {
            id: "linear",
            label: "Linear (2x2)",
            summary: "four comparisons around the receiver, blended; by the hardware where all four have one depth",
            source: Some(Source {
                paper: "Reeves, Salesin and Cook, Rendering Antialiased Shadows with Depth Maps",
                year: 1987,
            }),
            ..EMPTY
        };
        /// All comparisons in a box.
        Pcf = Choice {
            id: "pcf",
            label: "PCF",
            summary: "comparisons with all texels of a box, blended: soft edges of one width",
            source: Some(Source {
                paper: "Reeves, Salesin and Cook, Rendering Antialiased Shadows with Depth Maps",
                year: 1987,
            }),
            params: &[WIDTH],
            ..EMPTY
        };
        /// A kernel of the user's own.
        Kernel = Choice {
            id: "kernel",
            label: "Own kernel",
            summary: "comparisons with all texels that a kernel reaches, blended by its weights: a bell, or your own WGSL",
            source: Some(BJORKE),
            params: &[WIDTH],
            ..EMPTY
        };
        /// Maps from many places of an area light.
        MultiView = Choice {
            id: "multi-view",
            label: "Multiple views",
            summary: "maps from many places of an area light, blended: umbra and penumbra in their true widths",
            source: Some(BJORKE),
            params: &[VIEWS],
            ..EMPTY
        };
    }
}

choices! {
    /// What translucent casters do to light: those whose material is mixed by alpha.
    Translucent {
        /// All or nothing, by the texel.
        Cut = Choice {
            id: "cut",
            label: "Cut",
            summary: "a translucent caster blocks all light where its alpha is a half or more, and none elsewhere",
            ..EMPTY
        };
        /// They colour it.
        Colored = Choice {
            id: "colored",
            label: "Coloured",
            summary: "translucent casters dim and tint the light: a map of colours beside that of depths, multiplied up",
            source: Some(BJORKE),
            modules: &["through", "colored"],
            ..EMPTY
        };
    }
}

impl Filter {
    /// Is its width a parameter?
    pub fn has_width(self) -> bool {
        self.row().params.iter().any(|param| param.name == WIDTH.name)
    }
}

/// How far a stored depth may be from what was drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Steps {
    /// In stored depth.
    pub depth: f32,
    /// As a share of the stored depth.
    pub relative: f32,
    /// As a share of the distance from near to far.
    pub share: f32,
}

impl Storage {
    /// Bytes of a texel; for `auto`, those of its first choice. The depth that a colour map is drawn with is not counted.
    pub fn bytes_per_texel(self) -> u32 {
        match self {
            Self::Depth16 => 2,
            Self::Auto | Self::Depth24 | Self::Depth32Float => 4,
            Self::R32Float | Self::Packed1 | Self::Packed2 | Self::Packed3 => 4,
        }
    }

    /// How far a stored depth may be from what was drawn: rounding of the format, and of the rasteriser before it.
    pub fn steps(self) -> Steps {
        let float = Steps { relative: 2f32.powi(-22), ..Steps::default() };
        match self {
            Self::Depth16 => Steps { depth: 2f32.powi(-16), ..float },
            Self::Depth24 => Steps { depth: 2f32.powi(-24), ..float },
            Self::Auto | Self::Depth32Float => float,
            Self::R32Float => Steps { share: 2f32.powi(-24), ..float },
            Self::Packed1 => Steps { share: 2f32.powi(-8), ..float },
            Self::Packed2 => Steps { share: 2f32.powi(-16), ..float },
            Self::Packed3 => Steps { share: 2f32.powi(-23), ..float },
        }
    }

    /// Is it a colour target that holds distance, not a depth texture?
    pub fn is_color(self) -> bool {
        self.steps().share > 0.0
    }

    /// The nearest that a near plane should come to the light, as a share of the far plane's distance, so that the
    /// depth step at the far plane stays below a thousandth of its distance.
    pub fn least_near(self) -> f32 {
        match self {
            Self::Depth16 => 0.02,
            Self::Depth24 => 1e-3,
            _ => 1e-4,
        }
    }
}

const MAP_SIZE: Param = Param {
    name: "map_size",
    label: "Map size",
    unit: "texel",
    min: 1.0,
    max: 16384.0,
    step: 1.0,
    default: ParamDefault::Fixed(2048.0),
    help: "width and height of the map",
    cost: "memory and drawing grow with its square",
};

const SLOPE_FACTOR: Param = Param {
    name: "slope_factor",
    label: "Slope factor",
    unit: "depth slope",
    min: 0.0,
    max: 32.0,
    step: 0.1,
    default: ParamDefault::Derived {
        rule: "twice the filter's reach: 1 for nearest, 2 for linear, width + 1 for wider ones",
        // A texel that counts lies at most `reach` away along both axes, so a plane's depth there differs by at most
        // reach * (|dz/dx| + |dz/dy|), and the hardware's slope is the larger of the two.
        value: |reach_texel| 2.0 * reach_texel,
    },
    help: "how many times a triangle's depth slope, for each texel, the map is pushed away from the light",
    cost: "none; too much detaches the shadow from a caster on a steep receiver",
};

const CONSTANT: Param = Param {
    name: "constant",
    label: "Constant",
    unit: "depth step",
    min: 0.0,
    max: 1_000_000.0,
    step: 1.0,
    default: ParamDefault::Fixed(4.0),
    help: "how many of the format's smallest steps the map is pushed away from the light",
    cost: "none; too much detaches the shadow from its caster",
};

const PLANE_MARGIN: Param = Param {
    name: "plane_margin",
    label: "Margin",
    unit: "texel",
    min: 0.0,
    max: 100.0,
    step: 0.01,
    default: ParamDefault::Fixed(0.0),
    help: "how far a texel must lie before the receiver's plane to block it, in widths of a texel",
    cost: "none",
};
const NORMAL_OFFSET: Param = Param {
    name: "normal_offset",
    label: "Normal offset",
    unit: "texel",
    min: 0.0,
    max: 64.0,
    step: 0.1,
    default: ParamDefault::Fixed(1.0),
    help: "how far a receiver is moved along its normal times the sine of normal and light, in widths of a texel",
    cost: "none; too much moves shadows off their casters",
};

/// Zero unless set, as most of a formula that belongs to some engine is.
const NO_OFFSET: Param = Param {
    name: "",
    label: "",
    unit: "texel",
    min: 0.0,
    max: 64.0,
    step: 0.1,
    default: ParamDefault::Fixed(0.0),
    help: "",
    cost: "none; too much moves shadows off their casters",
};

const NORMAL_ALWAYS: Param = Param {
    name: "normal_always",
    label: "Normal offset at any angle",
    help: "how far a receiver is moved along its normal whatever the light's angle, in widths of a texel",
    ..NO_OFFSET
};

const NORMAL_TILT: Param = Param {
    name: "normal_tilt",
    label: "Normal offset by tilt",
    help: "how far a receiver is moved along its normal times 1 - cosine of normal and light, in widths of a texel",
    ..NO_OFFSET
};

const DEPTH_TEXEL: Param = Param {
    name: "depth_texel",
    label: "Depth offset",
    help: "how far a receiver is moved towards the light, in widths of a texel",
    ..NO_OFFSET
};

const DEPTH_M: Param = Param {
    name: "depth_m",
    label: "Depth offset in metres",
    unit: "m",
    max: 1000.0,
    step: 0.001,
    help: "how far a receiver is moved towards the light whatever the scene's scale",
    ..NO_OFFSET
};

const DEPTH_SHARE: Param = Param {
    name: "depth_share",
    label: "Depth offset by distance",
    unit: "distance",
    max: 0.5,
    step: 0.001,
    help: "how far a receiver is moved towards the light, as a share of its distance along the light's axis; not under parallel light",
    ..NO_OFFSET
};

const POLYGON_SLOPE: Param = Param {
    name: "polygon_slope",
    label: "Polygon slope",
    unit: "depth slope",
    max: 32.0,
    help: "how many times a triangle's depth slope, for each texel, the map is pushed away from the light besides",
    ..NO_OFFSET
};

const WIDTH: Param = Param {
    name: "width",
    label: "Width",
    unit: "texel",
    min: 1.0,
    max: 17.0,
    step: 1.0,
    default: ParamDefault::Fixed(5.0),
    help: "how wide the filter is",
    cost: "lookups grow with its square: ((width + 1) / 2)^2 gathers",
};

const VIEWS: Param = Param {
    name: "views",
    label: "Views",
    unit: "",
    min: 1.0,
    max: 1024.0,
    step: 1.0,
    default: ParamDefault::Fixed(16.0),
    help: "from how many places of an area light maps are drawn; a light without area has one",
    cost: "memory, drawing and lookups grow with it",
};

const MATRIX_BIAS: Param = Param {
    name: "matrix_bias",
    label: "Matrix bias",
    unit: "depth range",
    min: 0.0,
    max: 0.5,
    step: 0.0005,
    default: ParamDefault::Fixed(0.005),
    help: "how far every receiver is moved towards the light, as a share of the map's whole depth",
    cost: "none; light leaks wherever it is more than a caster's distance from its receiver",
};

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

    fn filter_module(&self) -> &'static str {
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
