//! `umbrage passes`: the plan of a technique.

use crate::args::PassesArgs;
use crate::fault::{Fault, say};
use crate::{json, setup};
use serde_json::json;
use umbrage_render::umbrage::core::plan::{Cull, Draws, Keeps, Pass, StencilUse, Target, plan};

/// Prints the passes in the order in which they run.
///
/// # Errors
/// [`Fault::WrongUse`] for a setting that does not exist.
pub fn run(args: &PassesArgs) -> Result<(), Fault> {
    let settings = setup::settings(&args.technique, &args.set, None)?;
    let passes = plan(&settings);
    if args.json {
        let passes: Vec<_> = passes.iter().map(describe).collect();
        let id = settings.technique.id;
        return json::print(&json!({ "technique": id, "params": json::params(&settings), "passes": passes }));
    }
    let texts: Vec<String> = passes.iter().map(Pass::to_string).collect();
    say(&texts.join("\n\n"))
}

fn describe(pass: &Pass) -> serde_json::Value {
    let target = match &pass.target {
        Target::Map { storage, size_texel } => {
            json!({ "kind": "map", "storage": storage.row().id, "size_texel": size_texel })
        }
        Target::TranslucentMap { storage, size_texel } => {
            json!({ "kind": "translucent-map", "storage": storage.row().id, "size_texel": size_texel })
        }
        Target::Colors { size_texel } => json!({ "kind": "colors", "size_texel": size_texel }),
        Target::Layer { size_texel } => {
            json!({ "kind": "layer", "storage": "depth32f", "size_texel": size_texel })
        }
        Target::Depth => json!({ "kind": "depth" }),
        Target::Faces => json!({ "kind": "faces" }),
        Target::Stencil => json!({ "kind": "stencil" }),
        Target::Mask { size_texel } => json!({ "kind": "mask", "size_texel": size_texel }),
        Target::Visibility => json!({ "kind": "visibility" }),
        Target::Picture => json!({ "kind": "picture" }),
    };
    json!({
        "name": pass.name,
        "per_light": pass.per_light,
        "target": target,
        "clear_depth": json::decimal(pass.clear_depth),
        "color": pass.color,
        "cull": match pass.cull {
            Cull::BackOfClosed => "back-of-closed",
            Cull::FrontOfClosed => "front-of-closed",
            Cull::Front => "front",
            Cull::Back => "back",
            Cull::Nothing => "nothing",
            Cull::ByMaterial => "by-material",
        },
        "keeps": match pass.keeps {
            Keeps::Nearest => "nearest",
            Keeps::Behind => "behind",
            Keeps::Midpoint => "midpoint",
        },
        "stencil": match pass.stencil {
            StencilUse::Unused => "unused",
            StencilUse::CountsBoth => "counts-both",
            StencilUse::CountsBack => "counts-back",
            StencilUse::CountsFront => "counts-front",
            StencilUse::IsZero => "is-zero",
            StencilUse::DarkensOnce => "darkens-once",
        },
        "polygon_offset": { "constant": pass.offset.constant, "slope": json::decimal(pass.offset.slope) },
        "draws": match pass.draws {
            Draws::Casters => "casters",
            Draws::Translucent => "translucent",
            Draws::Surfaces => "surfaces",
            Draws::Depths => "depths",
            Draws::Edges => "edges",
            Draws::Volumes => "volumes",
            Draws::Screen => "screen",
            Draws::Outlines => "outlines",
            Draws::Receivers => "receivers",
        },
    })
}
