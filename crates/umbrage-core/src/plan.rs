//! A technique as a list of passes: what is drawn where, over which clear, in which state.
//!
//! The passes that make shadows are recorded from this list, so what `umbrage passes` prints is what happens. How
//! surfaces are lit is the renderer's own affair: the reference renderer draws them into a G-buffer first.

use crate::DEPTH;
use crate::technique::{Bias, Family, Settings, Storage};

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
    /// The caller's picture and its depth.
    Picture,
}

/// What is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Draws {
    /// All that blocks light, positions only (and texture coordinates where the surface is cut out).
    Casters,
    /// All that is seen, with material and light; visibility is looked up inline.
    Surfaces,
}

/// Which faces are left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cull {
    /// Back faces of casters that are closed and wholly in front of the light: what they block, their front faces
    /// block too. All faces of all others, because a surface blocks light whichever way it faces.
    BackOfClosed,
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
        offset: PolygonOffset::default(),
        draws: Draws::Surfaces,
    };
    match (settings.technique.family, settings.combination) {
        (Family::Map, Some(combination)) => {
            let map = Pass {
                name: "shadow-map",
                per_light: true,
                target: Target::Map { storage: combination.storage, size_texel: settings.map_size_texel() },
                clear_depth: DEPTH.clear(),
                color: false,
                cull: Cull::BackOfClosed,
                offset: polygon_offset(settings, combination.bias),
                draws: Draws::Casters,
            };
            vec![map, lighting]
        }
        _ => vec![lighting],
    }
}

/// The uniform bias that goes into the lookup matrix, depth range; 0 when the bias is none of its kind.
pub fn lookup_bias_depth(settings: &Settings) -> f32 {
    settings.value("matrix_bias").unwrap_or(0.0)
}

fn polygon_offset(settings: &Settings, bias: Bias) -> PolygonOffset {
    match bias {
        Bias::None | Bias::Matrix | Bias::ReceiverPlane => PolygonOffset::default(),
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
            Target::Map { storage, size_texel } => {
                let format = if storage == Storage::Auto {
                    "of the adapter's best depth format"
                } else {
                    storage.row().id
                };
                format!("{size_texel}x{size_texel} {format}, the light's layer")
            }
            Target::Picture => "the picture and its depth".to_owned(),
        };
        let compare = if DEPTH.is_reversed() { "greater-equal" } else { "less-equal" };
        let cull = match self.cull {
            Cull::BackOfClosed => "back faces of closed casters culled",
            Cull::ByMaterial => "back faces culled unless double sided",
        };
        let draws = match self.draws {
            Draws::Casters => "casters, positions only; cut-out casters with their texture",
            Draws::Surfaces => {
                "surfaces with material and light, visibility looked up inline (the reference renderer: over a G-buffer)"
            }
        };
        let color = if self.color { "colour and depth" } else { "depth only" };
        writeln!(f, "{}{}", self.name, if self.per_light { " (one for each shadowed light)" } else { "" })?;
        writeln!(f, "  target  {target}")?;
        writeln!(f, "  clear   depth {}", self.clear_depth)?;
        write!(f, "  state   {color}, depth {compare}, {cull}")?;
        if self.offset != PolygonOffset::default() {
            write!(f, ", polygon offset slope {} constant {}", self.offset.slope, self.offset.constant)?;
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
            assert_eq!(passes.len() > 1, technique.family == Family::Map, "{}", technique.id);
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
