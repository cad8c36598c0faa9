//! The five choices of a depth map, each a table: how it is stored, projected, biased and filtered, and what translucent
//! casters do to light. Other families have theirs in [`super::volume`] and [`super::mask`].

use super::params::{
    CONSTANT, DEPTH_M, DEPTH_SHARE, DEPTH_TEXEL, MAP_SIZE, MATRIX_BIAS, NORMAL_ALWAYS, NORMAL_OFFSET,
    NORMAL_TILT, PLANE_MARGIN, POLYGON_SLOPE, SLOPE_FACTOR, VIEWS, WIDTH,
};
use super::{Param, Source};

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

pub(super) use choices;

pub(super) const EMPTY: Choice =
    Choice { id: "", label: "", summary: "", source: None, modules: &[], params: &[] };

const INTEL: Source =
    Source { paper: "Intel, Real-Time Shadow Maps on Mainstream Graphics Hardware", year: 2007 };
pub(super) const BJORKE: Source =
    Source { paper: "Bjorke, Shadowing Strategies for HLSL and FX Composer", year: 2005 };
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
