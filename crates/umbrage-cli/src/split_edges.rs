//! `umbrage split-edges`: an OBJ file with ghosts between its faces.

use crate::args::SplitEdgesArgs;
use crate::fault::{Fault, say, tell};
use crate::render::check_file;
use crate::{json, text};
use serde::Serialize;
use std::path::Path;
use umbrage_render::picture::write_whole;
use umbrage_scene::{SplitCounts, split_obj};

/// What `--json` prints.
#[derive(Serialize)]
struct Report {
    input: String,
    output: String,
    bytes: usize,
    vertices: usize,
    faces: usize,
    added_vertices: usize,
    added_normals: usize,
    back_faces: usize,
    ghosts: usize,
    edges: usize,
    open_edges: usize,
    edges_of_more_than_two_faces: usize,
    degenerate_faces: usize,
    duplicated_faces: usize,
    parts: usize,
    open_parts: usize,
    renumbered_records: usize,
    warnings: Vec<String>,
}

/// Splits, writes, counts.
///
/// # Errors
/// Wrong use before anything is read; failures as they come. Nothing is left behind.
pub fn run(args: &SplitEdgesArgs) -> Result<(), Fault> {
    check_file(&args.output, "obj", "what is written is Wavefront OBJ")?;
    if same(&args.input, &args.output) {
        return Err(Fault::WrongUse(format!(
            "--output: {} is the input; name another file, so that the model is kept",
            args.output.display()
        )));
    }
    let split = split_obj(&args.input, args.back_faces)?;
    write_whole(&args.output, &split.bytes).map_err(|e| {
        let path = args.output.display();
        Fault::Failed(format!("cannot write {path}: {e}; make room, or name a place that you may write to"))
    })?;
    if !args.quiet {
        split.warnings.iter().for_each(|warning| tell("warning", warning));
    }
    if args.json {
        let c = split.counts;
        return json::print(&Report {
            input: args.input.display().to_string(),
            output: args.output.display().to_string(),
            bytes: split.bytes.len(),
            vertices: c.vertices,
            faces: c.faces,
            added_vertices: c.added_vertices,
            added_normals: c.added_normals,
            back_faces: c.back_faces,
            ghosts: c.ghosts,
            edges: c.edges,
            open_edges: c.open,
            edges_of_more_than_two_faces: c.shared_by_more,
            degenerate_faces: c.degenerate,
            duplicated_faces: c.duplicated,
            parts: c.parts,
            open_parts: c.open_parts,
            renumbered_records: c.renumbered,
            warnings: split.warnings,
        });
    }
    if args.quiet { Ok(()) } else { say(&summary(args, &split.counts, split.bytes.len())) }
}

/// Do both paths lead to one file?
fn same(a: &Path, b: &Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

fn summary(args: &SplitEdgesArgs, counts: &SplitCounts, bytes: usize) -> String {
    let row = |what: &str, number: usize| vec![what.to_owned(), text::count(number as u64)];
    let rows = [
        row("vertices", counts.vertices),
        row("faces", counts.faces),
        row("vertices added", counts.added_vertices),
        row("normals added", counts.added_normals),
        row("back faces added", counts.back_faces),
        row("ghosts added", counts.ghosts),
        row("edges", counts.edges),
        row("open edges", counts.open),
        row("edges of more than two faces", counts.shared_by_more),
        row("degenerate faces", counts.degenerate),
        row("faces that are there twice", counts.duplicated),
        row("parts", counts.parts),
        row("open parts", counts.open_parts),
        row("records renumbered", counts.renumbered),
    ];
    let (input, output) = (args.input.display(), args.output.display());
    format!(
        "{}{input} with split edges written to {output}, {}\n",
        text::table(&rows),
        text::bytes(bytes as u64)
    )
}
