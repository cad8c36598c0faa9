//! A technique as a list of passes: what is drawn where, over which clear, in which state.
//!
//! The passes that make shadows are recorded from this list, so what `umbrage passes` prints is what happens. How
//! surfaces are lit is the renderer's own affair: the reference renderer draws them into a G-buffer first.

mod text;

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

/// The planned passes that draw a map's casters: the one that draws the map, and the one that peels a layer off before it, where
/// the map needs one. Nothing for techniques without maps.
pub fn caster_passes(settings: &Settings) -> (Option<Pass>, Option<Pass>) {
    let passes = plan(settings).into_iter().filter(|pass| pass.draws == Draws::Casters);
    let (peels, maps): (Vec<_>, Vec<_>) =
        passes.partition(|pass| matches!(pass.target, Target::Layer { .. }));
    (maps.into_iter().next(), peels.into_iter().next())
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

#[cfg(test)]
mod tests;
