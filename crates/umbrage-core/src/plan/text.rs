//! A plan for people.

use super::{Cull, Draws, Keeps, Pass, PolygonOffset, StencilUse, Target};
use crate::DEPTH;
use crate::technique::Storage;
use std::fmt;

impl fmt::Display for Pass {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}{}", self.name, if self.per_light { times(self) } else { "" })?;
        writeln!(f, "  target  {}", target(self))?;
        writeln!(f, "  clear   {}", clear(self))?;
        write!(f, "  state   {}", state(self))?;
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
        write!(f, "\n  draws   {}", draws(self.draws))
    }
}

/// How often a pass is drawn.
fn times(pass: &Pass) -> &'static str {
    match pass.target {
        Target::Map { .. } | Target::Layer { .. } | Target::TranslucentMap { .. } | Target::Colors { .. } => {
            " (one for each view of a shadowed light)"
        }
        Target::Mask { .. } => " (one for each blocker of a shadowed light)",
        _ => " (one for each shadowed light)",
    }
}

fn target(pass: &Pass) -> String {
    match pass.target {
        Target::Map { storage, size_texel } | Target::TranslucentMap { storage, size_texel } => {
            let auto = "of the adapter's best depth format";
            let format = if storage == Storage::Auto { auto } else { storage.row().id };
            let of = if pass.draws == Draws::Translucent { " of the translucent casters' array" } else { "" };
            format!("{size_texel}x{size_texel} {format}, the light's layer{of}")
        }
        Target::Colors { size_texel } => format!("{size_texel}x{size_texel} rgba8unorm, the light's layer"),
        Target::Layer { size_texel } => {
            format!("{size_texel}x{size_texel} {}, read by the next pass", Storage::Depth32Float.row().id)
        }
        Target::Depth => "the picture's depth".to_owned(),
        Target::Faces => {
            "indices and draw arguments of the light's volumes; kept until light or caster moves".to_owned()
        }
        Target::Mask { size_texel } => format!(
            "{size_texel}x{size_texel} r8unorm, a layer for each blocker; kept until light or blocker moves"
        ),
        Target::Stencil => "the stencil of the picture's depth".to_owned(),
        Target::Visibility => "V on the screen, r8unorm, the light's layer".to_owned(),
        Target::Picture => "the picture and its depth".to_owned(),
    }
}

fn clear(pass: &Pass) -> String {
    let text = match (&pass.target, pass.stencil) {
        (Target::Faces, _) => "counts 0",
        (Target::Stencil, StencilUse::CountsFront) => "nothing",
        (Target::Stencil, _) => "stencil 0",
        (Target::Visibility, StencilUse::IsZero) => "V 0",
        (Target::Visibility, StencilUse::DarkensOnce) => "V 1, stencil 0",
        (Target::Visibility, _) => "nothing",
        (Target::Mask { .. }, _) => "0",
        (Target::Colors { .. }, _) => "white",
        _ => return format!("depth {}", pass.clear_depth),
    };
    text.to_owned()
}

fn state(pass: &Pass) -> String {
    let compare = if DEPTH.is_reversed() { "greater-equal" } else { "less-equal" };
    let nearer = if DEPTH.is_reversed() { "greater" } else { "less" };
    let cull = cull(pass.cull);
    match (&pass.target, pass.stencil) {
        (Target::Faces, _) => "none".to_owned(),
        (Target::Stencil, stencil) => {
            let counts = match stencil {
                StencilUse::CountsBack => "back faces behind the surface up, or before it down",
                StencilUse::CountsFront => "front faces behind the surface down, or before it up",
                _ => "back faces behind the surface up and front faces down, or before it down and up",
            };
            format!("stencil only, wrapping: {counts}; depth {nearer}, {cull}")
        }
        (Target::Visibility, StencilUse::IsZero) => "writes 1 where the stencil is 0".to_owned(),
        (Target::Visibility, StencilUse::DarkensOnce) => format!(
            "cores subtracted, marked in the stencil and drawn once; then the darkest of the fringes; depth {compare}"
        ),
        (Target::Visibility, _) => "weighted mean across like depths".to_owned(),
        (Target::Mask { .. }, _) => format!("one flat colour; no depth, light or clipping; {cull}"),
        (target, _) => {
            let color = match (pass.color, target) {
                (true, Target::Colors { .. }) => "colours multiplied, depth of the light's map read only",
                (true, _) => "colour and depth",
                (false, _) => "depth only",
            };
            format!("{color}, depth {compare}, {cull}")
        }
    }
}

fn cull(cull: Cull) -> &'static str {
    match cull {
        Cull::BackOfClosed => "back faces of closed casters culled",
        Cull::FrontOfClosed => "front faces of closed casters culled",
        Cull::Front => "front faces culled",
        Cull::Back => "back faces culled",
        Cull::Nothing => "no faces culled",
        Cull::ByMaterial => "back faces culled unless double sided",
    }
}

fn draws(draws: Draws) -> &'static str {
    match draws {
        Draws::Casters => "casters, positions only; cut-out casters with their texture",
        Draws::Translucent => "translucent casters with base colour, texture and alpha",
        Draws::Depths => "surfaces, depth only (the reference renderer: its G-buffer)",
        Draws::Edges => {
            "nothing: a compute pass writes two triangles for each silhouette edge, and lids where they count"
        }
        Draws::Volumes => "sides of volumes, and their lids for casters that are counted behind the surface",
        Draws::Screen => "one triangle over the picture",
        Draws::Outlines => {
            "each blocker's outline, with fewer triangles as far as that changes no more than `outline_texel`"
        }
        Draws::Receivers => "objects beyond each blocker, once for each mask",
        Draws::Surfaces => {
            "surfaces with material and light; visibility looked up inline, or in V on the screen where a pass wrote it (the reference renderer: over a G-buffer)"
        }
    }
}
