//! The four choices of a depth map, each a table: how it is stored, projected, biased and filtered.

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

const EVERITT: Source = Source { paper: "Everitt, Rege and Cebenoyan, Hardware Shadow Mapping", year: 2001 };

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
            modules: &["locate"],
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
            modules: &["filter/nearest"],
            ..EMPTY
        };
        /// Four comparisons, blended.
        Linear = Choice {
            id: "linear",
            label: "Linear (2x2)",
            summary: "four comparisons around the receiver, blended by the hardware",
            source: Some(Source {
                paper: "Reeves, Salesin and Cook, Rendering Antialiased Shadows with Depth Maps",
                year: 1987,
            }),
            modules: &["filter/linear"],
            ..EMPTY
        };
    }
}

impl Filter {
    /// How far from the receiver, along either axis of the map, the centre of a texel may lie that counts. Texels.
    pub fn reach_texel(self) -> f32 {
        match self {
            Self::Nearest => 0.5,
            Self::Linear => 1.0,
        }
    }

    /// Lookups of the map for each lit pixel; one that the hardware blends from four texels counts once.
    pub fn taps(self) -> u32 {
        match self {
            Self::Nearest | Self::Linear => 1,
        }
    }

    /// Does the comparison sampler blend the four nearest comparisons?
    pub fn blends_comparisons(self) -> bool {
        match self {
            Self::Nearest => false,
            Self::Linear => true,
        }
    }
}

impl Storage {
    /// Bytes of a texel; for `auto`, those of its first choice.
    pub fn bytes_per_texel(self) -> u32 {
        match self {
            Self::Depth16 => 2,
            Self::Auto | Self::Depth24 | Self::Depth32Float => 4,
        }
    }

    /// The nearest that a near plane should come to the light, as a share of the far plane's distance, so that the
    /// depth step at the far plane stays below a thousandth of its distance.
    pub fn least_near(self) -> f32 {
        match self {
            Self::Depth16 => 0.02,
            Self::Depth24 => 1e-3,
            Self::Auto | Self::Depth32Float => 1e-4,
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
        rule: "twice the filter's reach: 1 for nearest, 2 for linear",
        // A texel that counts lies at most `reach` away along both axes, so a plane's depth there differs by at most
        // reach * (|dz/dx| + |dz/dy|), and the hardware's slope is the larger of the two.
        value: |combination| 2.0 * combination.filter.reach_texel(),
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

/// The four choices of a map.
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
}

impl Combination {
    /// Every combination there is, valid or not.
    pub fn all() -> impl Iterator<Item = Self> {
        Storage::ALL.iter().flat_map(|&storage| {
            Projection::ALL.iter().flat_map(move |&projection| {
                Bias::ALL.iter().flat_map(move |&bias| {
                    Filter::ALL.iter().map(move |&filter| Self { storage, projection, bias, filter })
                })
            })
        })
    }

    /// Why the four do not go together; `None` when they do. So far all of them do.
    pub fn objection(&self) -> Option<&'static str> {
        None
    }

    /// The rows of the four choices.
    pub fn rows(&self) -> [&'static Choice; 4] {
        [self.storage.row(), self.projection.row(), self.bias.row(), self.filter.row()]
    }

    /// The parameters of the four choices.
    pub fn params(&self) -> impl Iterator<Item = &'static Param> {
        self.rows().into_iter().flat_map(|row| row.params)
    }

    /// The WGSL modules of the four choices.
    pub fn modules(&self) -> Vec<&'static str> {
        self.rows().into_iter().flat_map(|row| row.modules).copied().collect()
    }
}
