//! `cargo xtask guide`: measures the techniques on the built-in scenes and writes `docs/guide.md`.

use crate::machine;
use crate::process::{self, Done, Fault, failed};
use crate::setup::{self, Need};
use serde_json::Value;
use std::fmt::Write;

/// The built-in scenes, as `umbrage compare builtin:NAME` takes them.
const SCENES: [&str; 5] = ["torus", "columns", "tilt", "contact", "knots"];
/// The scenes on which every technique is measured.
const IN_FULL: [&str; 2] = ["torus", "contact"];

const HEAD: &str = "# Guide: how wrong is a shadow, and what does it cost?

`umbrage compare SCENE` draws your scene with every technique, traces rays through the same pixels, and writes a page that
shows each technique beside the truth, where it is wrong, and what it costs. This page was written by `cargo xtask guide`
from the same measurement of the built-in scenes. How the truth is found, and how it is itself tested, is in
[truth.md](truth.md).

## What is measured

V is visibility: 1 lit, 0 in shadow. V* is the truth: the share of the light that a pixel's surface sees. Receivers are pixels
whose surface faces the light and lies in its cone. All shares are of receivers.

| measure | what it is |
|---|---|
| false shadow | mean of max(0, V* - V): dark where the truth is lit |
| false light | mean of max(0, V - V*): lit where the truth is dark |
| rmse | root of the mean square of V - V* |
| edge, band | mean of \\|V - V*\\| in the edge band, and the band's share: receivers so close to a change of V* that the technique cannot resolve it (two pixels, or its filter's radius and a texel more, as long as they are on the screen there) |
| acne | share of all other receivers that are lit in truth and darker than 0.95 |
| leak | share of all other receivers that are in full shadow in truth and brighter than 0.05 |
| gap | the farthest that a shadow begins from where its caster touches the receiver |
| penumbra | width of soft edges over the width that similar triangles give: 1 is right, 0 is a hard edge. Lights with a shape only |
| flicker | mean change of V between frames of a camera's path where V* does not change. `--path` only |
| FLIP | perceptual difference of the final picture from the same picture with V*, 0 to 1 (Andersson and others 2020) |
| cost | median of frame with shadow minus frame without, neighbours in time |

Each light is measured alone. Pixels in which rays and rasteriser saw different surfaces are left out and counted. Where the
shading's normal faces away from the light no light arrives whatever V is, so these pixels are no receivers either. A change of
V* may lie within reach and still between no two pixels: behind what stands in front, or narrower than a pixel. Before a pixel is
called acne or a leak, rays look at the light's own view around it, as far as the technique reaches; with a silhouette there, or
for a dark pixel light on its own plane, it counts to the edge band (`hidden_pixels` in `--json`). A crease between two lit surfaces
is none: there the error stands.
";

/// A measure of a row, as a cell.
struct Column {
    head: &'static str,
    cell: fn(&Value) -> String,
}

const COLUMNS: [Column; 10] = [
    Column { head: "false shadow %", cell: |row| percent(&row["false_shadow"]) },
    Column { head: "false light %", cell: |row| percent(&row["false_light"]) },
    Column { head: "rmse", cell: |row| fixed(&row["rmse"], 4) },
    Column { head: "acne %", cell: |row| percent(&row["acne"]) },
    Column { head: "leak %", cell: |row| percent(&row["leak"]) },
    Column {
        head: "edge (band %)",
        cell: |row| format!("{} ({})", fixed(&row["edge"], 4), percent(&row["band"])),
    },
    Column { head: "gap mm", cell: |row| millimetres(&row["gap_m"]) },
    Column { head: "FLIP", cell: |row| fixed(&row["flip"], 4) },
    Column { head: "cost ms", cell: |row| fixed(&row["cost_ms"], 1) },
    Column { head: "memory MiB", cell: |row| mebibytes(&row["memory_bytes"]) },
];

fn percent(share: &Value) -> String {
    match share.as_f64().unwrap_or(f64::NAN) * 100.0 {
        0.0 => "0".to_owned(),
        x if x < 0.0005 => "<0.001".to_owned(),
        x if x < 1.0 => format!("{x:.3}"),
        x => format!("{x:.2}"),
    }
}

fn fixed(x: &Value, digits: usize) -> String {
    x.as_f64().map_or_else(|| "-".to_owned(), |x| format!("{x:.digits$}"))
}

fn millimetres(x: &Value) -> String {
    x.as_f64().map_or_else(|| "-".to_owned(), |x| format!("{:.1}", x * 1e3))
}

fn mebibytes(x: &Value) -> String {
    x.as_f64().map_or_else(|| "-".to_owned(), |x| format!("{:.0}", x / 1_048_576.0))
}

/// `cargo xtask guide`
pub fn run(_: &[String]) -> Done {
    setup::before_build(Need::Draw)?;
    process::build_umbrage("release")?;
    let machine = parsed(["doctor", "--json"].map(str::to_owned).to_vec())?;
    let mut measured = Vec::new();
    for scene in SCENES {
        let words = ["compare".to_owned(), format!("builtin:{scene}"), "--json".to_owned()].to_vec();
        measured.push((scene, parsed(words)?));
    }
    let text = page(&measured, &machine)?;
    process::write(&process::root().join("docs/guide.md"), text)?;
    println!("The guide is written: docs/guide.md. Read what changed before you commit it.");
    println!("The pages of docs/guide/ quote it: `cargo xtask pages` brings them up to date.");
    Ok(())
}

fn parsed(words: Vec<String>) -> Result<Value, Fault> {
    let mut command = process::umbrage("release", words);
    eprintln!("$ {}", process::typed(&command));
    let text = process::stdout(&mut command)?;
    serde_json::from_str(&text).map_err(|e| failed(format!("it printed no JSON: {e}")))
}

/// The page from what `umbrage compare --json` said of each scene.
fn page(measured: &[(&str, Value)], machine: &Value) -> Result<String, Fault> {
    let mut page = HEAD.to_owned();
    let of_machine = |key: &str| machine[key].as_str().unwrap_or("unknown").to_owned();
    // Writing to a string cannot fail.
    let _ = writeln!(
        page,
        "\n## `linear` on every built-in scene\n\nMaps of 2048x2048 texels, pictures of 1280x720 pixels, the scene's own \
         spot light. Measured on {}, adapter `{}`, driver {}: times say how well the work is kept small on a software \
         rasteriser.\n",
        machine::processor(),
        of_machine("adapter"),
        of_machine("driver")
    );
    let rows = |scene: &Value, id: &str| -> Result<Value, Fault> {
        let all = scene["results"].as_array();
        let found = all.and_then(|all| all.iter().find(|row| row["technique"] == id));
        found.cloned().ok_or_else(|| failed(format!("`umbrage compare --json` has no row for {id}")))
    };
    head_of(&mut page, "scene");
    for (name, scene) in measured {
        row(&mut page, &format!("`builtin:{name}`"), &rows(scene, "linear")?);
    }
    let excluded: u64 = measured.iter().filter_map(|(_, s)| s["truth"]["excluded_pixels"].as_u64()).sum();
    let _ = writeln!(page, "\n{excluded} pixels of all {} pictures were left out.", measured.len());
    for (name, scene) in measured.iter().filter(|(name, _)| IN_FULL.contains(name)) {
        let _ = writeln!(page, "\n## Every technique on `builtin:{name}`\n");
        head_of(&mut page, "technique");
        for result in scene["results"].as_array().into_iter().flatten() {
            row(&mut page, &format!("`{}`", result["technique"].as_str().unwrap_or("?")), result);
        }
        let _ = writeln!(page, "\n```sh\numbrage compare builtin:{name}\n```");
    }
    Ok(page)
}

fn head_of(page: &mut String, first: &str) {
    let heads: Vec<_> = COLUMNS.iter().map(|column| column.head).collect();
    let _ = writeln!(page, "| {first} | {} |\n|---|{}", heads.join(" | "), "--:|".repeat(COLUMNS.len()));
}

fn row(page: &mut String, name: &str, result: &Value) {
    let cells: Vec<_> = COLUMNS.iter().map(|column| (column.cell)(result)).collect();
    let _ = writeln!(page, "| {name} | {} |", cells.join(" | "));
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn every_scene_has_its_row_and_nothing_above_0_reads_as_0() {
        let result = |technique: &str| {
            json!({"technique": technique, "false_shadow": 1e-9, "false_light": 0.0, "rmse": 0.012, "acne": 0.0002,
                   "leak": 0.031, "edge": 0.03, "band": 0.05, "gap_m": null, "flip": 0.001, "cost_ms": 9.96,
                   "memory_bytes": 16_777_216})
        };
        let scene = json!({"results": [result("hard"), result("linear")], "truth": {"excluded_pixels": 2}});
        let measured: Vec<_> = SCENES.iter().map(|name| (*name, scene.clone())).collect();
        let text = page(&measured, &json!({"adapter": "a", "driver": "d"})).expect("a page");
        for name in SCENES {
            let line =
                format!("| `builtin:{name}` | <0.001 | 0 | 0.0120 | 0.020 | 3.10 | 0.0300 (5.00) | - |");
            assert!(text.contains(&line), "{line}\n{text}");
        }
        assert!(text.contains("10 pixels of all 5") && text.contains("| `hard` |"));
        assert!(page(&[("torus", json!({"results": []}))], &json!({})).is_err());
    }
}
