//! A technique as a list of passes: what is drawn where, over which clear, in which state.
//!
//! The passes that make shadows are recorded from this list, so what `umbrage passes` prints is what happens. How
//! surfaces are lit is the renderer's own affair: the reference renderer draws them into a G-buffer first.

use crate::DEPTH;
use crate::technique::mask::Receivers;
use crate::technique::volume::{Silhouette, Soften, Stencil, Volume};
use crate::technique::{Bias, Method, Settings, Storage};

/// Where a pass draws.
#[derive(Clone, Debug, PartialEq)]
pub enum Target {
    /// The light's layer of the map array.
    Map {
        /// How depth is kept.
        storage: Storage,
        /// Width and height, texels.
        size_texel: u32,
    },
    /// A 32-bit float depth texture that the next pass reads; one for all lights, who take turns.
    Layer {
        /// Width and height, texels.
        size_texel: u32,
    },
    /// The light's layer of a second map array of the same kind, which holds translucent casters only.
    TranslucentMap {
        /// How depth is kept.
        storage: Storage,
        /// Width and height, texels.
        size_texel: u32,
    },
    /// The light's layer of the array of colours; the depth of its map is tested and left as it is. Each caster multiplies
    /// what is there by the share of light that it lets through.
    Colors {
        /// Width and height, texels.
        size_texel: u32,
    },
    /// The caller's depth, which later passes count over.
    Depth,
    /// Indices and draw arguments of a light's volumes, in buffers.
    Faces,
    /// The stencil of the caller's depth.
    Stencil,
    /// One layer of the masks for each blocker.
    Mask {
        /// Width and height, texels.
        size_texel: u32,
    },
    /// The light's layer of V on the screen.
    Visibility,
    /// The caller's picture and its depth.
    Picture,
}

/// What a pass does with the stencil.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StencilUse {
    /// Nothing.
    #[default]
    Unused,
    /// Counts both kinds of faces in one draw, each its own way. The first pass of a light begins with 0.
    CountsBoth,
    /// Counts faces seen from inside: up where they lie behind the surface (depth-fail), down where they lie before it
    /// (depth-pass). The first pass of a light begins with 0.
    CountsBack,
    /// Counts faces seen from outside, the other way.
    CountsFront,
    /// Draws only where nothing was counted.
    IsZero,
    /// Draws only where nothing is marked, and marks what becomes wholly dark. The pass begins with 0.
    DarkensOnce,
}

/// What is kept of all surfaces that lie behind each other in a texel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Keeps {
    /// The nearest.
    Nearest,
    /// The nearest of those strictly behind the layer drawn before: depth peeling (Everitt 2001, "Interactive
    /// Order-Independent Transparency").
    Behind,
    /// The place halfway between the layer drawn before and the nearest surface strictly behind it (Woo 1992). Nothing where
    /// nothing lies behind.
    Midpoint,
}

/// What is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Draws {
    /// All that blocks light, positions only (and texture coordinates where the surface is cut out).
    Casters,
    /// What blocks light in part: surfaces mixed by alpha, where the technique lets them colour the light. Its casters are then
    /// without them.
    Translucent,
    /// All that is seen, with material and light; visibility is looked up inline.
    Surfaces,
    /// All that is seen, depth only.
    Depths,
    /// Nothing: a compute pass looks at every edge of every caster.
    Edges,
    /// The sides of volumes, and their lids where faces are counted behind the surface.
    Volumes,
    /// One triangle over the picture.
    Screen,
    /// The outline of each blocker, in one colour.
    Outlines,
    /// What may lie in the shadow of each mask, once for each.
    Receivers,
}

/// Which faces are left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cull {
    /// Back faces of casters that are closed and wholly in front of the light: what they block, their front faces
    /// block too. All faces of all others, because a surface blocks light whichever way it faces.
    BackOfClosed,
    /// Front faces of casters that are closed: who enters a solid must leave it. All faces of all others.
    FrontOfClosed,
    /// Faces seen from outside.
    Front,
    /// Faces seen from inside.
    Back,
    /// None: light passes both sides of a bottle, and what lies behind others are also casters that shadow nothing.
    Nothing,
    /// As each material says.
    ByMaterial,
}

/// Polygon offset as the rasteriser takes it. Signs are those of the depth convention: negative moves away from the
/// light where depth is reversed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PolygonOffset {
    /// In the format's smallest steps.
    pub constant: i32,
    /// Times the depth slope of the triangle.
    pub slope: f32,
}

/// One pass.
#[derive(Clone, Debug, PartialEq)]
pub struct Pass {
    /// Name, as in timings and captures.
    pub name: &'static str,
    /// One for each shadowed light, or one in all.
    pub per_light: bool,
    /// Where it draws.
    pub target: Target,
    /// Depth that it begins with.
    pub clear_depth: f32,
    /// Does it write colour?
    pub color: bool,
    /// Which faces are left out.
    pub cull: Cull,
    /// What is kept where surfaces lie behind each other.
    pub keeps: Keeps,
    /// What is done with the stencil.
    pub stencil: StencilUse,
    /// Polygon offset.
    pub offset: PolygonOffset,
    /// What is drawn.
    pub draws: Draws,
}

/// The passes of a technique, in order.
pub fn plan(settings: &Settings) -> Vec<Pass> {
    let lighting = Pass {
        name: "lighting",
        per_light: false,
        target: Target::Picture,
        clear_depth: DEPTH.clear(),
        color: true,
        cull: Cull::ByMaterial,
        keeps: Keeps::Nearest,
        stencil: StencilUse::Unused,
        offset: PolygonOffset::default(),
        draws: Draws::Surfaces,
    };
    match settings.method {
        Method::Map(combination) => {
            let map = Pass {
                name: "shadow-map",
                per_light: true,
                target: Target::Map { storage: combination.storage, size_texel: settings.map_size_texel() },
                clear_depth: DEPTH.clear(),
                color: false,
                cull: match combination.bias {
                    Bias::Midpoint => Cull::Nothing,
                    Bias::SecondDepth => Cull::FrontOfClosed,
                    _ => Cull::BackOfClosed,
                },
                keeps: if combination.bias == Bias::Midpoint { Keeps::Midpoint } else { Keeps::Nearest },
                stencil: StencilUse::Unused,
                offset: polygon_offset(settings, combination.bias),
                draws: Draws::Casters,
            };
            if combination.bias == Bias::Midpoint {
                return vec![peel_pass(settings.map_size_texel(), 0), map, lighting];
            }
            if !combination.colors_light() {
                return vec![map, lighting];
            }
            let size_texel = settings.map_size_texel();
            let colors = Pass {
                name: "light-colors",
                target: Target::Colors { size_texel },
                color: true,
                cull: Cull::Nothing,
                draws: Draws::Translucent,
                ..map.clone()
            };
            let nearest = Pass {
                name: "translucent-map",
                target: Target::TranslucentMap { storage: combination.storage, size_texel },
                color: false,
                ..colors.clone()
            };
            vec![map, colors, nearest, lighting]
        }
        Method::Volume(volume) => {
            let mut passes = volume_passes(&volume, &lighting);
            passes.push(lighting);
            passes
        }
        Method::Mask(mask) => {
            let outline = Pass {
                name: "mask",
                per_light: true,
                target: Target::Mask { size_texel: settings.value("mask_size").unwrap_or(0.0) as u32 },
                cull: Cull::Nothing,
                draws: Draws::Outlines,
                ..lighting.clone()
            };
            let subtract = Pass {
                name: "subtract",
                target: Target::Visibility,
                stencil: StencilUse::DarkensOnce,
                draws: Draws::Receivers,
                ..outline.clone()
            };
            let mut passes = vec![outline];
            if mask.receivers == Receivers::Subtractive {
                let depth = Pass {
                    name: "layZ",
                    target: Target::Depth,
                    color: false,
                    draws: Draws::Depths,
                    ..lighting.clone()
                };
                passes.extend([depth, subtract]);
            }
            passes.push(lighting);
            passes
        }
        Method::None => vec![lighting],
    }
}

/// The passes of a volume before surfaces are lit. Depth is drawn by whoever lights them: all else is counted over it.
fn volume_passes(volume: &Volume, lighting: &Pass) -> Vec<Pass> {
    let depth =
        Pass { name: "layZ", target: Target::Depth, color: false, draws: Draws::Depths, ..lighting.clone() };
    let find = Pass {
        name: "silhouettes",
        per_light: true,
        target: Target::Faces,
        cull: Cull::Nothing,
        draws: Draws::Edges,
        ..depth.clone()
    };
    let count = |name, cull, stencil| Pass {
        name,
        cull,
        stencil,
        target: Target::Stencil,
        draws: Draws::Volumes,
        ..find.clone()
    };
    let mask = Pass {
        name: "mask",
        target: Target::Visibility,
        color: true,
        stencil: StencilUse::IsZero,
        draws: Draws::Screen,
        ..find.clone()
    };
    let blur = |name| Pass { name, stencil: StencilUse::Unused, ..mask.clone() };
    let mut passes = vec![depth];
    passes.extend((volume.silhouette == Silhouette::Compute).then(|| find.clone()));
    passes.extend(match volume.stencil {
        Stencil::TwoSided => vec![count("back+front", Cull::Nothing, StencilUse::CountsBoth)],
        Stencil::TwoPass => vec![
            count("back", Cull::Front, StencilUse::CountsBack),
            count("front", Cull::Back, StencilUse::CountsFront),
        ],
    });
    passes.push(mask.clone());
    if volume.soften == Soften::Blur {
        passes.extend([blur("blur-rows"), blur("blur-columns")]);
    }
    passes
}

/// The pass that draws one layer of a depth peel, 0 being the nearest.
pub fn peel_pass(size_texel: u32, layer: u32) -> Pass {
    Pass {
        name: "peel",
        per_light: true,
        target: Target::Layer { size_texel },
        clear_depth: DEPTH.clear(),
        color: false,
        cull: Cull::Nothing,
        keeps: if layer == 0 { Keeps::Nearest } else { Keeps::Behind },
        stencil: StencilUse::Unused,
        offset: PolygonOffset::default(),
        draws: Draws::Casters,
    }
}

/// The uniform bias that goes into the lookup matrix, depth range; 0 when the bias is none of its kind.
pub fn lookup_bias_depth(settings: &Settings) -> f32 {
    settings.value("matrix_bias").unwrap_or(0.0)
}

fn polygon_offset(settings: &Settings, bias: Bias) -> PolygonOffset {
    match bias {
        Bias::None | Bias::Matrix | Bias::ReceiverPlane | Bias::Midpoint | Bias::SecondDepth => {
            PolygonOffset::default()
        }
        // Every caster is carried on by 3/4 of a texel along both axes (`UMBRAGE_NEAR`), and the rasteriser's slope is the larger
        // of the two.
        Bias::Auto => PolygonOffset { constant: 0, slope: DEPTH.away() * 1.5 },
        Bias::Constant | Bias::Slope | Bias::Normal => {
            let value = |name| settings.value(name);
            PolygonOffset {
                constant: (DEPTH.away() * value("constant").unwrap_or(0.0)) as i32,
                slope: DEPTH.away() * value("slope_factor").or(value("polygon_slope")).unwrap_or(0.0),
            }
        }
    }
}

impl std::fmt::Display for Pass {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let target = match self.target {
            Target::Map { storage, size_texel } | Target::TranslucentMap { storage, size_texel } => {
                let format = if storage == Storage::Auto {
                    "of the adapter's best depth format"
                } else {
                    storage.row().id
                };
                let of =
                    if self.draws == Draws::Translucent { " of the translucent casters' array" } else { "" };
                format!("{size_texel}x{size_texel} {format}, the light's layer{of}")
            }
            Target::Colors { size_texel } => {
                format!("{size_texel}x{size_texel} rgba8unorm, the light's layer")
            }
            Target::Layer { size_texel } => {
                format!("{size_texel}x{size_texel} {}, read by the next pass", Storage::Depth32Float.row().id)
            }
            Target::Depth => "the picture's depth".to_owned(),
            Target::Faces => {
                "indices and draw arguments of the light's volumes; kept until light or caster moves"
                    .to_owned()
            }
            Target::Mask { size_texel } => format!(
                "{size_texel}x{size_texel} r8unorm, a layer for each blocker; kept until light or blocker moves"
            ),
            Target::Stencil => "the stencil of the picture's depth".to_owned(),
            Target::Visibility => "V on the screen, r8unorm, the light's layer".to_owned(),
            Target::Picture => "the picture and its depth".to_owned(),
        };
        let compare = if DEPTH.is_reversed() { "greater-equal" } else { "less-equal" };
        let cull = match self.cull {
            Cull::BackOfClosed => "back faces of closed casters culled",
            Cull::FrontOfClosed => "front faces of closed casters culled",
            Cull::Front => "front faces culled",
            Cull::Back => "back faces culled",
            Cull::Nothing => "no faces culled",
            Cull::ByMaterial => "back faces culled unless double sided",
        };
        let draws = match self.draws {
            Draws::Casters => "casters, positions only; cut-out casters with their texture",
            Draws::Translucent => "translucent casters with base colour, texture and alpha",
            Draws::Depths => "surfaces, depth only (the reference renderer: its G-buffer)",
            Draws::Edges => {
                "nothing: a compute pass writes two triangles for each silhouette edge, and lids where they count"
            }
            Draws::Volumes => {
                "sides of volumes, and their lids for casters that are counted behind the surface"
            }
            Draws::Screen => "one triangle over the picture",
            Draws::Outlines => {
                "each blocker's outline, with fewer triangles as far as that changes no more than `outline_texel`"
            }
            Draws::Receivers => "objects beyond each blocker, once for each mask",
            Draws::Surfaces => {
                "surfaces with material and light, visibility looked up inline (the reference renderer: over a G-buffer)"
            }
        };
        writeln!(f, "{}{}", self.name, if self.per_light { " (one for each shadowed light)" } else { "" })?;
        writeln!(f, "  target  {target}")?;
        match (&self.target, self.stencil) {
            (Target::Faces, _) => writeln!(f, "  clear   counts 0")?,
            (Target::Stencil, StencilUse::CountsFront) => writeln!(f, "  clear   nothing")?,
            (Target::Stencil, _) => writeln!(f, "  clear   stencil 0")?,
            (Target::Visibility, StencilUse::IsZero) => writeln!(f, "  clear   V 0")?,
            (Target::Visibility, StencilUse::DarkensOnce) => writeln!(f, "  clear   V 1, stencil 0")?,
            (Target::Mask { .. }, _) => writeln!(f, "  clear   0")?,
            (Target::Visibility, _) => writeln!(f, "  clear   nothing")?,
            (Target::Colors { .. }, _) => writeln!(f, "  clear   white")?,
            _ => writeln!(f, "  clear   depth {}", self.clear_depth)?,
        }
        let nearer = if DEPTH.is_reversed() { "greater" } else { "less" };
        match (&self.target, self.stencil) {
            (Target::Faces, _) => write!(f, "  state   none")?,
            (Target::Stencil, stencil) => {
                let counts = match stencil {
                    StencilUse::CountsBack => "back faces behind the surface up, or before it down",
                    StencilUse::CountsFront => "front faces behind the surface down, or before it up",
                    _ => "back faces behind the surface up and front faces down, or before it down and up",
                };
                write!(f, "  state   stencil only, wrapping: {counts}; depth {nearer}, {cull}")?;
            }
            (Target::Visibility, StencilUse::IsZero) => {
                write!(f, "  state   writes 1 where the stencil is 0")?;
            }
            (Target::Visibility, StencilUse::DarkensOnce) => {
                write!(
                    f,
                    "  state   cores subtracted, marked in the stencil and drawn once; then the darkest of the fringes; depth {compare}"
                )?;
            }
            (Target::Mask { .. }, _) => {
                write!(f, "  state   one flat colour; no depth, light or clipping; {cull}")?;
            }
            (Target::Visibility, _) => write!(f, "  state   weighted mean across like depths")?,
            _ => {
                let color = match self.color {
                    true if matches!(self.target, Target::Colors { .. }) => {
                        "colours multiplied, depth of the light's map read only"
                    }
                    true => "colour and depth",
                    false => "depth only",
                };
                write!(f, "  state   {color}, depth {compare}, {cull}")?;
            }
        }
        if self.offset != PolygonOffset::default() {
            write!(f, ", polygon offset slope {} constant {}", self.offset.slope, self.offset.constant)?;
        }
        match self.keeps {
            Keeps::Nearest => {}
            Keeps::Behind => write!(f, "\n  keeps   the nearest surface behind the layer before")?,
            Keeps::Midpoint => {
                write!(
                    f,
                    "\n  keeps   the middle between the layer before and the nearest surface behind it"
                )?;
            }
        }
        write!(f, "\n  draws   {draws}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::technique::TECHNIQUES;

    #[test]
    fn every_technique_ends_in_light_and_maps_come_first() {
        for technique in TECHNIQUES {
            let settings = Settings::new(technique.id, []).expect("from the table");
            let passes = plan(&settings);
            assert_eq!(passes.last().map(|p| p.draws), Some(Draws::Surfaces), "{}", technique.id);
            assert_eq!(passes.len() > 1, technique.method != Method::None, "{}", technique.id);
        }
    }

    #[test]
    fn a_volume_lays_depth_counts_and_lights() {
        let names = |id, pairs: &[(&str, &str)]| -> Vec<&'static str> {
            let settings = Settings::new(id, pairs.iter().copied()).expect("valid");
            plan(&settings).iter().map(|pass| pass.name).collect()
        };
        assert_eq!(names("volume", &[]), ["layZ", "silhouettes", "back+front", "mask", "lighting"]);
        let classic = [("stencil", "two-pass"), ("silhouette", "vertex")];
        assert_eq!(names("volume", &classic), ["layZ", "back", "front", "mask", "lighting"]);
        let soft = ["layZ", "silhouettes", "back+front", "mask", "blur-rows", "blur-columns", "lighting"];
        assert_eq!(names("volume-soft", &[]), soft);
        let text: Vec<_> =
            plan(&Settings::new("volume", classic).expect("valid")).iter().map(Pass::to_string).collect();
        assert!(text[1].contains("stencil 0") && text[1].contains("front faces culled"), "{}", text[1]);
        assert!(text[2].contains("clear   nothing") && text[2].contains("back faces culled"), "{}", text[2]);
    }

    #[test]
    fn coloured_light_takes_two_passes_more_and_says_so() {
        let passes = plan(&Settings::new("colored", []).expect("valid"));
        let draws: Vec<_> = passes.iter().map(|p| p.draws).collect();
        assert_eq!(draws, [Draws::Casters, Draws::Translucent, Draws::Translucent, Draws::Surfaces]);
        // What is tested against the map must be drawn with its offset.
        assert!(passes[..3].iter().all(|p| p.offset == passes[0].offset && p.per_light));
        let text = passes[1].to_string();
        assert!(
            text.contains("rgba8unorm") && text.contains("multiplied") && text.contains("clear   white"),
            "{text}"
        );
        let cut = Settings::new("colored", [("translucent", "cut")]).expect("valid");
        assert_eq!(plan(&cut), plan(&Settings::new("linear", []).expect("valid")));
    }

    #[test]
    fn a_midpoint_map_is_peeled_first_and_a_second_depth_map_culls_fronts() {
        let midpoint = plan(&Settings::new("midpoint", []).expect("valid"));
        let kept: Vec<_> = midpoint.iter().map(|pass| (pass.keeps, pass.cull)).collect();
        let none = Cull::Nothing;
        assert_eq!(
            kept,
            [(Keeps::Nearest, none), (Keeps::Midpoint, none), (Keeps::Nearest, Cull::ByMaterial)]
        );
        let second = plan(&Settings::new("second-depth", []).expect("valid"));
        assert_eq!((second.len(), second[0].cull), (2, Cull::FrontOfClosed));
        for pass in [&midpoint[0], &midpoint[1], &second[0]] {
            assert_eq!(pass.offset, PolygonOffset::default(), "no numbers at all");
        }
    }

    #[test]
    fn only_polygon_offset_biases_offset_polygons() {
        let offset = |bias| plan(&Settings::new("linear", [("bias", bias)]).expect("valid"))[0].offset;
        assert_eq!(offset("none"), PolygonOffset::default());
        assert_eq!(offset("matrix"), PolygonOffset::default());
        assert_eq!(offset("constant"), PolygonOffset { constant: -4, slope: 0.0 });
        assert_eq!(offset("slope"), PolygonOffset { constant: -4, slope: -2.0 });
        assert_eq!(offset("normal"), PolygonOffset { constant: -4, slope: 0.0 });
        let sloped = Settings::new("linear", [("bias", "normal"), ("polygon_slope", "2.5")]).expect("valid");
        assert_eq!(plan(&sloped)[0].offset, PolygonOffset { constant: -4, slope: -2.5 });
    }
}
