//! The page from what was measured.

use super::candidates::{CANDIDATES, Group};
use super::{BUILT_IN, Kind, MODEL_SIZE, Measured, PICTURE, SCALES, SIZE_OF_OTHERS, SIZES, Score};
use crate::machine;
use std::fmt::Write;

const HEAD: &str = include_str!("head.md");
const TAIL: &str = include_str!("tail.md");

/// The worst of a set of scores.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Worst {
    acne: f64,
    leak: f64,
    gap_texel: Option<f64>,
}

fn worst<'a>(scores: impl Iterator<Item = &'a Score>) -> Option<Worst> {
    scores.fold(None, |worst: Option<Worst>, score| {
        let so_far = worst.unwrap_or(Worst { acne: 0.0, leak: 0.0, gap_texel: None });
        Some(Worst {
            acne: so_far.acne.max(score.acne),
            leak: so_far.leak.max(score.leak),
            gap_texel: [so_far.gap_texel, score.gap_texel].into_iter().flatten().reduce(f64::max),
        })
    })
}

/// Nothing above 0 reads as 0.
fn percent(share: f64) -> String {
    match share * 100.0 {
        0.0 => "0".to_owned(),
        x if x < 0.0005 => "<0.001".to_owned(),
        x if x < 1.0 => format!("{x:.3}"),
        x => format!("{x:.1}"),
    }
}

fn cells(worst: Option<Worst>) -> String {
    worst.map_or_else(
        || "- | - | -".to_owned(),
        |w| {
            let gap = match w.gap_texel {
                None => "-".to_owned(),
                Some(0.0) => "0".to_owned(),
                Some(gap) => format!("{gap:.2}"),
            };
            format!("{} | {} | {gap}", percent(w.acne), percent(w.leak))
        },
    )
}

/// The page.
pub fn page(measured: &Measured) -> String {
    let mut page = HEAD.to_owned();
    summary(&mut page, measured);
    of_auto(&mut page, measured);
    how(&mut page, measured);
    page += TAIL;
    page
}

fn summary(page: &mut String, measured: &Measured) {
    // Writing to a string cannot fail.
    let _ = writeln!(
        page,
        "\n## The worst of every bias\n\nOf each group the worst acne and leak (% of sure receivers) and the worst gap (texels), over \
         all scenes, lights and map sizes in it. 0 means none at all.\n\n\
         | bias, filter | built-in, scale 1: acne | leak | gap | all scales: acne | leak | gap | real models: acne | leak | gap |\n\
         |---|--:|--:|--:|--:|--:|--:|--:|--:|--:|"
    );
    for group in [Group::Auto, Group::Classic, Group::Engine] {
        for (i, candidate) in CANDIDATES.iter().enumerate().filter(|(_, c)| c.group == group) {
            let of = |keep: fn(&Score) -> bool| {
                cells(worst(measured.scores.iter().filter(|s| s.candidate == i && keep(s))))
            };
            let name = candidate.name;
            if measured.missing.contains(&name) {
                let _ = writeln!(page, "| {name} | not available | | | | | | | | |");
                continue;
            }
            let built_in = of(|s| s.scale == Some("1"));
            let scales = of(|s| s.scale.is_some());
            let models = of(|s| s.scale.is_none());
            let _ = writeln!(page, "| {name} | {built_in} | {scales} | {models} |");
        }
    }
    let _ = writeln!(
        page,
        "\n\"16 bits\" is `storage=depth16`. Engines stand with the filter that is usual there, as near as ours come to it. The \
         row of three.js leaves out scenes with casters that are not closed: there our map holds both sides, and theirs the back \
         alone, so that a plane blocks nothing. \"Worst\" holds for the coarsest map too: one of 256 texels forgives few \
         formulas."
    );
}

fn of_auto(page: &mut String, measured: &Measured) {
    let _ = writeln!(
        page,
        "\n## `auto`, scene by scene\n\nThe worst over all filters, map sizes and both storages.\n\n\
         | scene | light | acne % | leak % | gap, texels |\n|---|---|--:|--:|--:|"
    );
    let is_auto = |s: &&Score| CANDIDATES[s.candidate].group == Group::Auto;
    let mut scenes: Vec<(&str, Option<&str>)> = Vec::new();
    for score in &measured.scores {
        if !scenes.contains(&(score.scene, score.scale)) {
            scenes.push((score.scene, score.scale));
        }
    }
    for (scene, scale) in scenes {
        let is_there = |kind: &Kind| {
            measured.scores.iter().any(|s| s.scene == scene && s.scale == scale && s.kind == *kind)
        };
        for kind in Kind::ALL.into_iter().filter(is_there) {
            let here = |s: &&Score| s.scene == scene && s.scale == scale && s.kind == kind;
            let found = cells(worst(measured.scores.iter().filter(is_auto).filter(here)));
            let name = match scale {
                Some(scale) => format!("builtin:{scene}?scale={scale}"),
                None => scene.to_owned(),
            };
            let _ = writeln!(page, "| `{name}` | {} | {found} |", kind.name());
        }
    }
}

fn how(page: &mut String, measured: &Measured) {
    let of_machine = |key: &str| measured.machine[key].as_str().unwrap_or("unknown").to_owned();
    let _ = writeln!(
        page,
        "\n## How it was measured\n\n```sh\ncargo xtask bias\n```\n\n{} rows in {:.0} minutes on {}, adapter `{}`, driver {}, at the \
         commit of {}. Built-in scenes: {}, at scales {}, maps of {} texels (at scales other than 1, all but `auto` with {SIZE_OF_OTHERS} only). Real models: maps \
         of {MODEL_SIZE}, on a ground, a spot light. \
         Pictures of {PICTURE} pixels from each scene's first camera. Spot lights: the built-in scenes' own, and a cone of 30 \
         degrees for models; point lights stand where the command's default light does. Each row is one technique of \
         `umbrage compare --json`, and what acne, leak, gap and sure receivers are stands in [guide.md](guide.md). A gap in \
         texels is its length along the surface over the width of a map's texel there, across the light.",
        measured.scores.len(),
        measured.minutes,
        machine::processor(),
        of_machine("adapter"),
        of_machine("driver"),
        measured.date,
        BUILT_IN.join(", "),
        SCALES.join(", "),
        SIZES.map(|size| size.to_string()).join(", "),
    );
    for name in &measured.skipped {
        let _ = writeln!(page, "\n**SKIPPED:** `{name}`, because it was not there.");
    }
    for warning in &measured.warnings {
        let _ = writeln!(page, "\nA warning of the command: {warning}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn measured(scores: Vec<Score>, missing: Vec<&'static str>) -> Measured {
        Measured {
            scores,
            machine: json!({"adapter": "a", "driver": "d"}),
            skipped: vec!["fox/Fox.glb".into()],
            missing,
            warnings: Vec::new(),
            minutes: 2.0,
            date: "2000-01-01".into(),
        }
    }

    #[test]
    fn the_worst_of_each_group_stands_in_its_column() {
        let score = |scale, acne, gap_texel| Score {
            candidate: 0,
            scene: "torus",
            scale,
            kind: Kind::Spot,
            acne,
            leak: 1e-9,
            gap_texel,
        };
        let scores = vec![
            score(Some("1"), 0.0, Some(0.5)),
            score(Some("100"), 0.02, Some(0.25)),
            score(None, 0.0, None),
            score(None, 0.0001, None),
        ];
        let text = page(&measured(scores, vec!["midpoint, linear"]));
        let name = CANDIDATES[0].name;
        let line = format!("| {name} | 0 | <0.001 | 0.50 | 2.0 | <0.001 | 0.50 | 0.010 | <0.001 | - |");
        assert!(text.contains(&line), "{line}\n{text}");
        assert!(text.contains("| midpoint, linear | not available |"));
        assert!(text.contains("**SKIPPED:** `fox/Fox.glb`"));
        assert!(text.contains("| `builtin:torus?scale=100` | spot | 2.0 | <0.001 | 0.25 |"));
    }

    #[test]
    fn what_was_not_measured_is_no_zero() {
        assert_eq!(cells(worst(std::iter::empty())), "- | - | -");
    }
}
