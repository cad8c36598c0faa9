//! What is measured: the automatic bias, the classic ones, and the defaults of engines.

use super::Kind;

/// Of what kind a candidate is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// Nothing to set.
    Auto,
    /// From the papers.
    Classic,
    /// What an engine does when nobody turns anything.
    Engine,
}

/// One row of the table.
pub struct Candidate {
    pub name: &'static str,
    pub group: Group,
    /// As `umbrage compare --techniques` takes it, under a spot light.
    spot: &'static str,
    /// Under a point light, where that differs.
    point: Option<&'static str>,
    /// The bias without which it cannot be measured, where a version of Umbrage may lack it.
    pub needs: Option<&'static str>,
}

impl Candidate {
    /// Is it an engine that draws back faces into its maps?
    pub fn is_engine_of_backs(&self) -> bool {
        self.group == Group::Engine && self.needs == Some("second-depth")
    }

    pub fn spec(&self, kind: Kind) -> &'static str {
        if kind == Kind::Point { self.point.unwrap_or(self.spot) } else { self.spot }
    }
}

const fn auto(name: &'static str, spot: &'static str) -> Candidate {
    Candidate { name, group: Group::Auto, spot, point: None, needs: None }
}

const fn classic(name: &'static str, spot: &'static str) -> Candidate {
    Candidate { name, group: Group::Classic, spot, point: None, needs: None }
}

const fn engine(name: &'static str, spot: &'static str, point: Option<&'static str>) -> Candidate {
    Candidate { name, group: Group::Engine, spot, point, needs: None }
}

pub const CANDIDATES: &[Candidate] = &[
    auto("auto, linear", "linear:bias=auto"),
    auto("auto, pcf 3", "pcf:bias=auto:width=3"),
    auto("auto, pcf 5", "pcf:bias=auto:width=5"),
    auto("auto, pcf 9", "pcf:bias=auto:width=9"),
    auto("auto, pcf 17", "pcf:bias=auto:width=17"),
    auto("auto, kernel 5", "kernel:bias=auto:width=5"),
    auto("auto, linear, 16 bits", "linear:bias=auto:storage=depth16"),
    auto("auto, pcf 9, 16 bits", "pcf:bias=auto:width=9:storage=depth16"),
    classic("none, linear", "linear:bias=none"),
    classic("slope, linear", "linear:bias=slope"),
    classic("slope, pcf 5", "pcf:bias=slope:width=5"),
    classic("constant, linear", "linear:bias=constant"),
    classic("matrix, linear", "linear:bias=matrix"),
    classic("normal, linear", "linear:bias=normal"),
    classic("receiver plane, linear", "linear:bias=receiver-plane"),
    classic("receiver plane, pcf 5", "pcf:bias=receiver-plane:width=5"),
    Candidate { needs: Some("midpoint"), ..classic("midpoint, linear", "linear:bias=midpoint") },
    Candidate { needs: Some("second-depth"), ..classic("second depth, linear", "linear:bias=second-depth") },
    Candidate {
        needs: Some("second-depth"),
        ..engine("three.js (back faces), pcf 3", "pcf:bias=second-depth:width=3", None)
    },
    engine("Babylon.js, hard", "hard:bias=normal:normal_offset=0:constant=0:depth_share=0.00005", None),
    engine(
        "Bevy, pcf 5",
        "pcf:width=5:bias=normal:normal_offset=0:constant=0:normal_always=2.546:depth_m=0.02",
        Some("pcf:width=5:bias=normal:normal_offset=0:constant=0:normal_always=0.849:depth_m=0.08"),
    ),
    engine(
        "Filament, pcf 3",
        "pcf:width=3:bias=normal:normal_offset=1:constant=1:polygon_slope=2:depth_m=0.001",
        None,
    ),
    engine(
        "Godot 4, pcf 3",
        "pcf:width=3:bias=normal:normal_offset=0:constant=0:normal_tilt=5:depth_share=0.012",
        Some("pcf:width=3:bias=normal:normal_offset=0:constant=0:normal_tilt=5:depth_m=0.1"),
    ),
    engine("Unity built-in, pcf 5", "pcf:width=5:bias=normal:normal_offset=0:constant=0:depth_m=0.05", None),
    engine(
        "Unity URP, pcf 5",
        "pcf:width=5:bias=normal:normal_offset=0:constant=1:polygon_slope=2.5:normal_tilt=2.5:depth_texel=2.5",
        Some("pcf:width=5:bias=normal:normal_offset=0:constant=1:polygon_slope=2.5:depth_texel=2.5"),
    ),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_their_own_and_specs_hold_no_comma() {
        for (i, candidate) in CANDIDATES.iter().enumerate() {
            assert!(CANDIDATES[..i].iter().all(|other| other.name != candidate.name), "{}", candidate.name);
            for kind in Kind::ALL {
                let spec = candidate.spec(kind);
                assert!(!spec.contains(',') && spec.contains("bias="), "{}: {spec}", candidate.name);
                if let Some(id) = candidate.needs {
                    assert!(spec.contains(&format!("bias={id}")), "{}: {spec}", candidate.name);
                }
            }
        }
    }
}
