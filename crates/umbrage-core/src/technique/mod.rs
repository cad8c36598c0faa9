//! The one table of techniques: command, listing, documentation, tests, benches and uniforms all come from it.
//!
//! A technique is a family with choices, each a table of its own: five for maps ([`choices`]), four for volumes ([`volume`]), six for
//! masks ([`mask`]). A [`Technique`] names a combination; [`Settings`] is one with its parameters.

pub mod choices;
mod combination;
pub mod mask;
mod method;
mod params;
mod settings;
pub mod volume;

pub use choices::{Bias, Choice, Filter, Projection, Steps, Storage, Translucent};
pub use combination::Combination;
use mask::Mask;
pub use method::{Family, Method, Table};
pub use settings::{SettingError, Settings};
use volume::Volume;

/// Where an idea was published.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Source {
    /// Authors and title.
    pub paper: &'static str,
    /// Year of publication.
    pub year: u16,
}

/// A number that a user may turn.
#[derive(Clone, Copy, Debug)]
pub struct Param {
    /// Key on the command line and in files.
    pub name: &'static str,
    /// What a workbench writes beside its slider.
    pub label: &'static str,
    /// Unit, or empty for a bare number.
    pub unit: &'static str,
    /// Smallest value.
    pub min: f32,
    /// Largest value.
    pub max: f32,
    /// Sensible step of a slider; 1 when only whole numbers make sense.
    pub step: f32,
    /// Value when nothing is said.
    pub default: ParamDefault,
    /// What it does, in one sentence.
    pub help: &'static str,
    /// What it costs, in one clause.
    pub cost: &'static str,
}

/// The value of a parameter that nobody set.
#[derive(Clone, Copy, Debug)]
pub enum ParamDefault {
    /// Always the same.
    Fixed(f32),
    /// Follows from the rest of the combination.
    Derived {
        /// How, in words.
        rule: &'static str,
        /// How, in numbers: from the filter's reach, texels.
        value: fn(f32) -> f32,
    },
}

/// A named way to make shadows.
#[derive(Clone, Copy, Debug)]
pub struct Technique {
    /// Name on the command line.
    pub id: &'static str,
    /// Name for people.
    pub label: &'static str,
    /// What it is and what it is for, in one sentence.
    pub summary: &'static str,
    /// Where it was published.
    pub source: Option<Source>,
    /// What makes the visibility, with its choices.
    pub method: Method,
}

/// The technique that is used when none is named.
pub const DEFAULT: &str = "linear";

/// The technique without shadows.
pub const NO_SHADOW: &str = "unshadowed";

const STAMMINGER: Source = Source { paper: "Stamminger and Drettakis, Perspective Shadow Maps", year: 2002 };
const WIMMER: Source =
    Source { paper: "Wimmer, Scherzer and Purgathofer, Light Space Perspective Shadow Maps", year: 2004 };
const BJORKE: Source = Source { paper: "Bjorke, Shadowing Strategies for HLSL and FX Composer", year: 2005 };
const INTEL: Source =
    Source { paper: "Intel, Real-Time Shadow Maps on Mainstream Graphics Hardware", year: 2007 };
const WILLIAMS: Source = Source { paper: "Williams, Casting Curved Shadows on Curved Surfaces", year: 1978 };
const REEVES: Source =
    Source { paper: "Reeves, Salesin and Cook, Rendering Antialiased Shadows with Depth Maps", year: 1987 };
const EVERITT: Source = Source { paper: "Everitt, Rege and Cebenoyan, Hardware Shadow Mapping", year: 2001 };

const LINEAR: Combination = Combination {
    storage: Storage::Auto,
    projection: Projection::Fitted,
    bias: Bias::Auto,
    filter: Filter::Linear,
    translucent: Translucent::Cut,
};

/// All techniques, in the order in which they are best explained.
pub const TECHNIQUES: &[Technique] = &[
    Technique {
        id: "unshadowed",
        label: "Unshadowed",
        summary: "light without shadow: what a shadow costs is measured against it",
        source: None,
        method: Method::None,
    },
    Technique {
        id: "hard",
        label: "Hard shadow map",
        summary: "one comparison with the nearest texel: the plainest map, with stairs at its edges",
        source: Some(WILLIAMS),
        method: Method::Map(Combination { filter: Filter::Nearest, ..LINEAR }),
    },
    Technique {
        id: "linear",
        label: "Linear shadow map",
        summary: "2x2 comparisons, blended: the stairs of `hard` become a ramp a texel wide",
        source: Some(REEVES),
        method: Method::Map(LINEAR),
    },
    Technique {
        id: "pcf",
        label: "Percentage-closer filtering",
        summary: "all comparisons of a box, blended: soft edges of one width, which narrow where caster and receiver touch",
        source: Some(REEVES),
        method: Method::Map(Combination { filter: Filter::Pcf, ..LINEAR }),
    },
    Technique {
        id: "kernel",
        label: "Own kernel",
        summary: "a float map, and comparisons blended by the weights of any kernel: a bell, or your own WGSL function",
        source: Some(BJORKE),
        method: Method::Map(Combination { storage: Storage::R32Float, filter: Filter::Kernel, ..LINEAR }),
    },
    Technique {
        id: "packed",
        label: "Packed distance",
        summary: "distance in three 8-bit channels, for hardware without depth or float textures to sample",
        source: Some(INTEL),
        method: Method::Map(Combination { storage: Storage::Packed3, ..LINEAR }),
    },
    Technique {
        id: "perspective",
        label: "Perspective shadow map",
        summary: "the map is warped as the eye's picture is, so that near surfaces get more texels; redrawn when the eye moves",
        source: Some(STAMMINGER),
        method: Method::Map(Combination { projection: Projection::Perspective, ..LINEAR }),
    },
    Technique {
        id: "lispsm",
        label: "Light-space perspective map",
        summary: "the warp is laid across the light instead of along the eye: gentler, and good from more directions",
        source: Some(WIMMER),
        method: Method::Map(Combination { projection: Projection::LightSpacePerspective, ..LINEAR }),
    },
    Technique {
        id: "multi-view",
        label: "Multiple views",
        summary: "an area light from many places, blended: converges to the true soft shadow as views are added",
        source: Some(BJORKE),
        method: Method::Map(Combination { filter: Filter::MultiView, ..LINEAR }),
    },
    Technique {
        id: "colored",
        label: "Coloured light",
        summary: "glass dims and tints the light that goes through it, by texture and alpha: V is a colour",
        source: Some(BJORKE),
        method: Method::Map(Combination { translucent: Translucent::Colored, ..LINEAR }),
    },
    Technique {
        id: "matrix-bias",
        label: "Biased lookup matrix",
        summary: "the bias stands in the lookup matrix, for hardware without polygon offset: uniform, so it leaks",
        source: Some(EVERITT),
        method: Method::Map(Combination { bias: Bias::Matrix, ..LINEAR }),
    },
    Technique {
        id: "midpoint",
        label: "Midpoint map",
        summary: "the middle between the two nearest surfaces in place of a bias: no number to set, twice the drawing",
        source: Some(choices::WOO),
        method: Method::Map(Combination { bias: Bias::Midpoint, ..LINEAR }),
    },
    Technique {
        id: "second-depth",
        label: "Second-depth map",
        summary: "back faces of closed casters in place of a bias: no number to set, no cost; open casters shadow themselves",
        source: Some(choices::WANG_MOLNAR),
        method: Method::Map(Combination { bias: Bias::SecondDepth, ..LINEAR }),
    },
    Technique {
        id: "volume",
        label: "Shadow volume",
        summary: "the darkened space as polygons that the stencil counts: exact to the pixel, no map, no bias; pays by the pixels it covers",
        source: Some(volume::EVERITT_KILGARD),
        method: Method::Volume(Volume::DEFAULT),
    },
    Technique {
        id: "volume-soft",
        label: "Soft shadow volume",
        summary: "the same, blurred on the screen across like depths: soft edges of one width, not physical",
        source: Some(BJORKE),
        method: Method::Volume(Volume { soften: volume::Soften::Blur, ..Volume::DEFAULT }),
    },
    Technique {
        id: "mask",
        label: "Projective mask",
        summary: "each blocker's outline, filling a mask of its own, laid over other objects beyond it; no bias, no shadow on itself",
        source: Some(mask::NAGY),
        method: Method::Mask(Mask::DEFAULT),
    },
    Technique {
        id: "mask-subtractive",
        label: "Subtractive mask",
        summary: "the same in the classic form: receivers are drawn once more for each mask, and the stencil lets them darken once",
        source: Some(mask::NAGY),
        method: Method::Mask(Mask { receivers: mask::Receivers::Subtractive, ..Mask::DEFAULT }),
    },
];

/// The technique of that name.
///
/// # Errors
/// [`SettingError::UnknownTechnique`] suggests the nearest name.
pub fn find(id: &str) -> Result<&'static Technique, SettingError> {
    TECHNIQUES.iter().find(|t| t.id == id).ok_or_else(|| SettingError::UnknownTechnique {
        id: id.to_owned(),
        suggestion: settings::suggest(id, TECHNIQUES.iter().map(|t| t.id)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_unique_and_the_default_exists() {
        for (i, technique) in TECHNIQUES.iter().enumerate() {
            assert!(TECHNIQUES[..i].iter().all(|other| other.id != technique.id), "{}", technique.id);
            assert!(!technique.label.is_empty() && !technique.summary.is_empty(), "{}", technique.id);
        }
        assert_eq!(find(DEFAULT).map(|t| t.id), Ok(DEFAULT));
    }

    #[test]
    fn every_parameter_is_described_and_its_default_is_in_range() {
        let mut seen = 0;
        let maps = Combination::all().map(Method::Map);
        let others = Volume::all().map(Method::Volume).chain([Method::Mask(Mask::DEFAULT)]);
        for method in maps.chain(others) {
            for param in method.params() {
                let reach_texel = method.combination().map_or(0.0, |c| c.reach_texel(5.0));
                let value = match param.default {
                    ParamDefault::Fixed(value) => value,
                    ParamDefault::Derived { value, .. } => value(reach_texel),
                };
                assert!((param.min..=param.max).contains(&value), "{}: {value}", param.name);
                assert!(
                    param.step > 0.0 && !param.help.is_empty() && !param.cost.is_empty(),
                    "{}",
                    param.name
                );
                seen += 1;
            }
        }
        assert!(seen > 0);
    }
}
