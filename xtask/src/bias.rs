//! `cargo xtask bias`: measures the automatic bias beside the classic ones and the defaults of engines, and writes
//! `docs/bias.md`.

mod candidates;
mod page;

use crate::bench::SCENES;
use crate::process::{self, Done, Fault, failed};
use crate::setup::{self, Need};
use candidates::{CANDIDATES, Candidate, Group};
use serde_json::Value;
use std::collections::HashSet;
use std::time::Instant;

const BUILT_IN: [&str; 4] = ["tilt", "contact", "torus", "columns"];
const SCALES: [&str; 4] = ["0.01", "1", "100", "1000"];
const SIZES: [u32; 3] = [256, 1024, 4096];
/// Maps of the built-in scenes at other scales than 1, for all but `auto`: they are to be seen to depend on scale.
const SIZE_OF_OTHERS: u32 = 1024;
/// Of the real models' maps.
const MODEL_SIZE: u32 = 2048;
/// How the command's warning begins where casters are not closed.
const OPEN_CASTERS: &str = "closed-mesh check";
const PICTURE: &str = "640x360";

/// Real models, below [`SCENES`]. Those without a ground of their own get one.
const MODELS: [&str; 20] = [
    "alpha-blend-mode-test/AlphaBlendModeTest.glb",
    "classic-obj/cornell_box.obj",
    "classic-obj/spot/spot_triangulated.obj",
    "classic-obj/teapot.obj",
    "dutch-ship/dutch_ship_medium_1k.gltf",
    "flight-helmet/FlightHelmet.gltf",
    "fox/Fox.glb",
    "glass-vase-flowers/GlassVaseFlowers.glb",
    "kaykit-medieval-hexagon/village.gltf",
    "knots/knots.glb",
    "loader-features/OrientationTest/OrientationTest.glb",
    "mannequiny/mannequiny.glb",
    "metal-rough-spheres-no-textures/MetalRoughSpheresNoTextures.glb",
    "negative-scale-test/NegativeScaleTest.glb",
    "scopia-trees/palm/palm.obj",
    "sheen-cloth/SheenCloth.gltf",
    "suzanne/Suzanne.gltf",
    "thin-casters/fence/fence.obj",
    "toy-car/ToyCar.gltf",
    "transmission-test/TransmissionTest.glb",
];

/// The kinds of light. Biases of engines are not the same under both.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Spot,
    Point,
}

impl Kind {
    const ALL: [Self; 2] = [Self::Spot, Self::Point];

    fn name(self) -> &'static str {
        match self {
            Self::Spot => "spot",
            Self::Point => "point",
        }
    }
}

/// What one scene, light and map size gave a candidate.
#[derive(Clone, Debug)]
struct Score {
    candidate: usize,
    /// The built-in scene, or the model's file.
    scene: &'static str,
    /// `None` of real models.
    scale: Option<&'static str>,
    kind: Kind,
    acne: f64,
    leak: f64,
    /// `None` where nothing touches.
    gap_texel: Option<f64>,
}

/// All that was measured.
struct Measured {
    scores: Vec<Score>,
    machine: Value,
    skipped: Vec<String>,
    missing: Vec<&'static str>,
    warnings: Vec<String>,
    minutes: f64,
    date: String,
}

/// One call of `umbrage compare`.
struct Call {
    scene: &'static str,
    scale: Option<&'static str>,
    kind: Kind,
    sizes: &'static [u32],
}

impl Call {
    fn asks(&self, candidate: &Candidate, size: u32) -> bool {
        let at_scale = self.scale.is_some_and(|scale| scale != "1");
        !at_scale || candidate.group == Group::Auto || size == SIZE_OF_OTHERS
    }

    fn words(&self, specs: &[(usize, u32, String)]) -> Vec<String> {
        let scene = match self.scale {
            Some(scale) => format!("builtin:{}?scale={scale}", self.scene),
            None => format!("{SCENES}/{}", self.scene),
        };
        let specs: Vec<_> = specs.iter().map(|(_, size, spec)| format!("{spec}:map_size={size}")).collect();
        let mut words = vec!["compare".to_owned(), scene, "--json".into(), "--size".into(), PICTURE.into()];
        words.extend(["--frames".into(), "1".into(), "--techniques".into(), specs.join(",")]);
        match (self.kind, self.scale) {
            (Kind::Point, _) => words.extend(["--light".into(), "kind=point".into()]),
            // A model may have many lights, or none.
            (Kind::Spot, None) => words.extend(["--light".into(), "kind=spot,outer=30".into()]),
            (Kind::Spot, Some(_)) => {}
        }
        if self.scale.is_none() {
            words.push("--ground".into());
        }
        words
    }
}

/// `cargo xtask bias`
pub fn run(_: &[String]) -> Done {
    setup::before_build(Need::Goldens)?;
    process::build_umbrage("debug")?;
    let start = Instant::now();
    let machine = parsed(&["doctor".into(), "--json".into()])?;
    let known = biases()?;
    let is_there = |candidate: &Candidate| candidate.needs.is_none_or(|id| known.contains(id));
    let missing: Vec<&str> = CANDIDATES.iter().filter(|c| !is_there(c)).map(|c| c.name).collect();
    for name in &missing {
        eprintln!("NOT AVAILABLE: {name}, because `umbrage techniques` does not list the bias that it needs");
    }
    let mut measured = Measured {
        scores: Vec::new(),
        machine,
        skipped: Vec::new(),
        missing,
        warnings: Vec::new(),
        minutes: 0.0,
        date: commit_date()?,
    };
    let calls = calls(&mut measured.skipped);
    for (i, call) in calls.iter().enumerate() {
        eprint!("{}/{} ", i + 1, calls.len());
        measure(call, &is_there, &mut measured)?;
    }
    measured.minutes = start.elapsed().as_secs_f64() / 60.0;
    process::write(&process::root().join("docs/bias.md"), page::page(&measured))?;
    for name in &measured.skipped {
        println!("SKIPPED: {name}. It does not lie in {SCENES}.");
    }
    println!(
        "The page is written in {:.1} minutes: docs/bias.md. Read what changed before you commit it.",
        measured.minutes
    );
    Ok(())
}

/// Every built-in scene under every kind of light, real ones under a spot light; the models that lack go to `skipped`.
fn calls(skipped: &mut Vec<String>) -> Vec<Call> {
    let mut calls = Vec::new();
    for scene in BUILT_IN {
        for scale in SCALES {
            calls.extend(Kind::ALL.map(|kind| Call { scene, scale: Some(scale), kind, sizes: &SIZES }));
        }
    }
    for scene in MODELS {
        if process::root().join(SCENES).join(scene).is_file() {
            calls.push(Call { scene, scale: None, kind: Kind::Spot, sizes: &[MODEL_SIZE] });
        } else {
            skipped.push(scene.to_owned());
        }
    }
    calls
}

fn measure(call: &Call, is_there: &dyn Fn(&Candidate) -> bool, measured: &mut Measured) -> Done {
    let mut specs = Vec::new();
    for size in call.sizes {
        let there = CANDIDATES.iter().enumerate().filter(|(_, c)| is_there(c) && call.asks(c, *size));
        specs.extend(there.map(|(i, candidate)| (i, *size, candidate.spec(call.kind).to_owned())));
    }
    let report = parsed(&call.words(&specs))?;
    let rows = report["results"].as_array().map_or(&[][..], Vec::as_slice);
    if rows.len() != specs.len() {
        return Err(failed(format!("`umbrage compare` gave {} rows for {}", rows.len(), specs.len())));
    }
    let warnings: Vec<&str> =
        report["warnings"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
    let is_open = warnings.iter().any(|warning| warning.starts_with(OPEN_CASTERS));
    for ((candidate, ..), row) in specs.into_iter().zip(rows) {
        // Where our map holds both sides of an open caster, the engine's holds its back alone.
        if is_open && CANDIDATES[candidate].is_engine_of_backs() {
            continue;
        }
        let number = |key: &str| {
            row[key].as_f64().ok_or_else(|| failed(format!("`umbrage compare --json` has no {key}")))
        };
        measured.scores.push(Score {
            candidate,
            scene: call.scene,
            scale: call.scale,
            kind: call.kind,
            acne: number("acne")?,
            leak: number("leak")?,
            gap_texel: row["gap_texel"].as_f64(),
        });
    }
    for warning in warnings.into_iter().filter(|warning| !warning.starts_with(OPEN_CASTERS)) {
        if !measured.warnings.iter().any(|known| known == warning) {
            measured.warnings.push(warning.to_owned());
        }
    }
    Ok(())
}

/// The ids of the biases that this Umbrage has.
fn biases() -> Result<HashSet<String>, Fault> {
    let table = parsed(&["techniques".into(), "--json".into()])?;
    let rows = table["choices"]["bias"].as_array().into_iter().flatten();
    let ids: HashSet<String> = rows.filter_map(|row| Some(row["id"].as_str()?.to_owned())).collect();
    if ids.is_empty() { Err(failed("`umbrage techniques --json` lists no bias")) } else { Ok(ids) }
}

fn parsed(words: &[String]) -> Result<Value, Fault> {
    let mut command = process::umbrage("debug", words);
    let typed: String = process::typed(&command).chars().take(100).collect();
    eprintln!("$ {typed}");
    let text = process::stdout(&mut command)?;
    serde_json::from_str(&text).map_err(|e| failed(format!("`{typed}` printed no JSON: {e}")))
}

/// Of the last commit: what was measured is as old as that, and a page must not change by being written on another day.
fn commit_date() -> Result<String, Fault> {
    let mut git = std::process::Command::new("git");
    git.args(["show", "--no-patch", "--format=%cs"]).current_dir(process::root());
    Ok(process::stdout(&mut git)?.trim().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_name_every_candidate_at_every_size() {
        let call = Call { scene: "torus", scale: Some("100"), kind: Kind::Point, sizes: &SIZES };
        let words = call.words(&[(0, 256, "linear:bias=auto".into()), (1, 1024, "hard".into())]).join(" ");
        assert!(words.starts_with("compare builtin:torus?scale=100 --json"), "{words}");
        assert!(
            words.contains("linear:bias=auto:map_size=256,hard:map_size=1024 --light kind=point"),
            "{words}"
        );
        assert!(!words.contains("--ground"));
    }
}
