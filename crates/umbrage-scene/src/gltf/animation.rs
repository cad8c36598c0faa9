//! Animations: which one plays, and the document as it is at a moment of it.
//!
//! A moment is written into the document's nodes, over their rest pose; all that follows (node tree, skins, morph
//! targets, lights, cameras) reads nodes and need not know. Only the animation that plays is looked at, so that nothing in
//! the others stops a file from being shown.

use super::document::{Document, label};
use super::extensions;
use super::sampler::{Interpolation, Keys};
use crate::{Playing, Pose};
use gltf::json::accessor::ComponentType::{F32, I8, I16, U8, U16};
use gltf::json::scene::UnitQuaternion;

/// The part of a document that the parser is too strict with: it wants a node in every channel, which extensions and
/// the specification itself allow to be left out.
#[derive(serde::Deserialize)]
struct Library {
    #[serde(default)]
    animations: Vec<serde_json::Value>,
}

#[derive(serde::Deserialize)]
struct Animation {
    channels: Vec<Channel>,
    samplers: Vec<Sampler>,
}

#[derive(serde::Deserialize)]
struct Channel {
    sampler: usize,
    target: Target,
}

#[derive(serde::Deserialize)]
struct Target {
    node: Option<usize>,
    path: String,
}

#[derive(serde::Deserialize)]
struct Sampler {
    input: usize,
    interpolation: Option<String>,
    output: usize,
}

/// What of a node moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Property {
    Translation,
    Rotation,
    Scale,
    Weights,
}

impl Property {
    fn of(path: &str) -> Option<Self> {
        match path {
            "translation" => Some(Self::Translation),
            "rotation" => Some(Self::Rotation),
            "scale" => Some(Self::Scale),
            "weights" => Some(Self::Weights),
            _ => None,
        }
    }
}

/// The animations of a file, unread but for their names.
pub(super) struct Animations(Vec<serde_json::Value>);

impl Animations {
    /// Finds them in a document's text.
    pub(super) fn of(text: &[u8]) -> Result<Self, String> {
        let library: Library =
            serde_json::from_slice(text).map_err(|e| format!("its animations: {e}; {WAY_OUT}"))?;
        Ok(Self(library.animations))
    }

    fn name(&self, number: usize) -> Option<String> {
        self.0.get(number)?.get("name")?.as_str().map(str::to_owned)
    }

    fn label(&self, number: usize) -> String {
        label("animation", number, self.name(number).as_ref())
    }

    /// The number of the one that is asked for, or of the first; `None` where there is none at all.
    pub(super) fn choose(&self, asked: Option<&str>) -> Result<Option<usize>, String> {
        if self.0.is_empty() {
            return Ok(None);
        }
        let Some(asked) = asked else { return Ok(Some(0)) };
        let by_name = (0..self.0.len()).find(|number| self.name(*number).as_deref() == Some(asked));
        let by_number = || asked.parse().ok().filter(|number| *number < self.0.len());
        by_name.or_else(by_number).map(Some).ok_or_else(|| self.unknown(asked))
    }

    fn unknown(&self, asked: &str) -> String {
        const LISTED: usize = 20;
        let asked: String = asked.chars().take(60).collect();
        let known: Vec<String> = (0..self.0.len().min(LISTED))
            .map(|number| self.label(number).trim_start_matches("animation ").to_owned())
            .collect();
        let more = if self.0.len() > LISTED { ", ..." } else { "" };
        format!("there is no animation \"{asked}\"; there are {}{more}", known.join(", "))
    }

    /// Writes the moment of an animation into the nodes.
    pub(super) fn play(
        &self,
        document: &mut Document<'_>,
        number: usize,
        pose: &Pose,
        warnings: &mut Vec<String>,
    ) -> Result<Playing, String> {
        let at = |e: String| format!("{}: {e}; {WAY_OUT}", self.label(number));
        let animation = self.0.get(number).map(<Animation as serde::Deserialize>::deserialize);
        let animation = match animation {
            Some(Ok(animation)) => animation,
            Some(Err(e)) => return Err(at(e.to_string())),
            None => return Err(at("it does not exist".into())),
        };
        let tracks = tracks(document, &animation, &self.label(number), warnings).map_err(at)?;
        let length_s = tracks.iter().map(|track| track.keys.end_s()).fold(0.0, f32::max);
        let time_s = moment(pose.time_s, length_s);
        for track in &tracks {
            let value = track.keys.at(time_s);
            if !value.iter().all(|x| x.is_finite()) {
                return Err(at(format!("{}: its value at {time_s} s is not finite", track.place)));
            }
            track.write(document, value);
        }
        Ok(Playing { number, name: self.name(number).unwrap_or_default(), length_s, time_s: time_s as f32 })
    }
}

const WAY_OUT: &str = "export the file again, or load it without a time";

/// Time within an animation: from 0 to its length as asked for, beyond that it starts again.
fn moment(asked_s: f32, length_s: f32) -> f64 {
    let (asked_s, length_s) = (f64::from(asked_s), f64::from(length_s));
    if (0.0..=length_s).contains(&asked_s) {
        asked_s
    } else if length_s > 0.0 {
        asked_s.rem_euclid(length_s)
    } else {
        0.0
    }
}

/// A property of a node, and its keys.
struct Track {
    /// For messages.
    place: String,
    node: usize,
    property: Property,
    keys: Keys,
}

impl Track {
    /// `value` has the width that the keys were read with.
    fn write(&self, document: &mut Document<'_>, value: Vec<f32>) {
        let node = &mut document.root.nodes[self.node];
        match (self.property, value.as_slice()) {
            (Property::Translation, &[x, y, z]) => node.translation = Some([x, y, z]),
            (Property::Rotation, &[x, y, z, w]) => node.rotation = Some(UnitQuaternion([x, y, z, w])),
            (Property::Scale, &[x, y, z]) => node.scale = Some([x, y, z]),
            _ => node.weights = Some(value),
        }
    }
}

/// Reads the channels. Those that move what Umbrage does not know are left out with a warning.
fn tracks(
    document: &Document<'_>,
    animation: &Animation,
    animation_label: &str,
    warnings: &mut Vec<String>,
) -> Result<Vec<Track>, String> {
    let mut tracks = Vec::new();
    let mut seen = std::collections::HashSet::new();
    for (number, channel) in animation.channels.iter().enumerate() {
        let path = channel.target.path.as_str();
        let Some(property) = Property::of(path) else {
            warnings.push(match path {
                "pointer" => extensions::meaning("KHR_animation_pointer"),
                _ => {
                    let path: String = path.chars().take(60).collect();
                    format!(
                        "{animation_label}, channel {number} moves \"{path}\", which is unknown; it rests"
                    )
                }
            });
            continue;
        };
        // The specification: a channel without a node is one of an extension, and to be passed over.
        let Some(node) = channel.target.node else { continue };
        let known = (node < document.root.nodes.len()).then(|| document.node_label(node));
        let node_label = known.clone().unwrap_or_else(|| format!("node {node}"));
        let place = format!("channel {number} ({path} of {node_label})");
        let at = |e: String| format!("{place}: {e}");
        if known.is_none() {
            let have = document.root.nodes.len();
            return Err(at(format!("that node does not exist, the file has {have}")));
        }
        if property != Property::Weights && document.root.nodes[node].matrix.is_some() {
            return Err(at("that node has a matrix, which cannot be animated".into()));
        }
        if !seen.insert((node, property)) {
            warnings
                .push(format!("{animation_label} moves the {path} of {node_label} twice; the last holds"));
        }
        let sampler = animation.samplers.get(channel.sampler).ok_or_else(|| {
            at(format!("sampler {} does not exist, there are {}", channel.sampler, animation.samplers.len()))
        })?;
        let keys = keys(document, sampler, property, node).map_err(at)?;
        tracks.push(Track { place, node, property, keys });
    }
    Ok(tracks)
}

fn keys(document: &Document<'_>, sampler: &Sampler, property: Property, node: usize) -> Result<Keys, String> {
    let interpolation = match &sampler.interpolation {
        None => Interpolation::Linear,
        Some(name) => Interpolation::of(name).ok_or_else(|| {
            let name: String = name.chars().take(60).collect();
            format!("its interpolation \"{name}\" is none of LINEAR, STEP and CUBICSPLINE")
        })?,
    };
    let format = document.format(sampler.input).map_err(|e| format!("times: {e}"))?;
    if format.component != F32 {
        return Err(format!("times: accessor {} is {}, not floats", sampler.input, format.name()));
    }
    let times = document.floats::<1>(sampler.input).map_err(|e| format!("times: {e}"))?.into_flattened();
    let in_values = |e: String| format!("values: {e}");
    let format = document.format(sampler.output).map_err(in_values)?;
    let whole = format.normalized && matches!(format.component, I8 | U8 | I16 | U16);
    if format.component != F32 && !(whole && matches!(property, Property::Rotation | Property::Weights)) {
        return Err(in_values(format!(
            "accessor {} is {}, which is not allowed here",
            sampler.output,
            format.name()
        )));
    }
    let (values, width) = match property {
        Property::Translation | Property::Scale => {
            (document.floats::<3>(sampler.output).map_err(in_values)?.into_flattened(), 3)
        }
        Property::Rotation => (document.floats::<4>(sampler.output).map_err(in_values)?.into_flattened(), 4),
        Property::Weights => {
            let targets = targets(document, node);
            if targets == 0 {
                return Err("that node has no mesh with morph targets".into());
            }
            (document.floats::<1>(sampler.output).map_err(in_values)?.into_flattened(), targets)
        }
    };
    Keys::new(times, values, width, interpolation, property == Property::Rotation)
}

/// Morph targets of a node's mesh; every primitive of a mesh has the same number.
fn targets(document: &Document<'_>, node: usize) -> usize {
    let mesh = document.root.nodes[node].mesh.map(|mesh| &document.root.meshes[mesh.value()]);
    let counts = mesh.iter().flat_map(|mesh| &mesh.primitives).flat_map(|p| &p.targets).map(Vec::len);
    counts.max().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_starts_again_after_the_end_and_before_the_beginning() {
        for (asked, length, found) in [
            (0.5, 2.0, 0.5),
            (2.0, 2.0, 2.0),
            (2.5, 2.0, 0.5),
            (-0.5, 2.0, 1.5),
            (7.0, 0.0, 0.0),
            (0.0, 0.0, 0.0),
        ] {
            assert_eq!(moment(asked, length), found, "{asked} of {length}");
        }
    }

    #[test]
    fn animations_are_found_by_name_before_number() {
        let text = br#"{"animations":[{"name":"Walk"},{},{"name":"0"}]}"#;
        let all = Animations::of(text).unwrap();
        for (asked, found) in [(None, 0), (Some("Walk"), 0), (Some("1"), 1), (Some("0"), 2)] {
            assert_eq!(all.choose(asked), Ok(Some(found)), "{asked:?}");
        }
        let message = all.choose(Some("3")).unwrap_err();
        assert_eq!(message, "there is no animation \"3\"; there are 0 \"Walk\", 1, 2 \"0\"");
        let none = Animations::of(b"{}").unwrap();
        assert_eq!((none.choose(None), none.choose(Some("Run"))), (Ok(None), Ok(None)));
        assert!(Animations::of(br#"{"animations":7}"#).is_err());
    }
}
