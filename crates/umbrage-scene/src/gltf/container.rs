//! From bytes to a parsed document: GLB chunks, the glTF version, JSON.

use gltf::json;

const MAGIC: &[u8; 4] = b"glTF";
const CHUNK_JSON: u32 = 0x4E4F_534A;
const CHUNK_BIN: u32 = 0x004E_4942;
const BOM: &[u8] = b"\xEF\xBB\xBF";

/// What is asked of a file before its full parse, so that a glTF 1.0 file is named as such and not by the first
/// field that has changed since.
#[derive(serde::Deserialize)]
struct Probe {
    asset: Option<ProbeAsset>,
}

#[derive(serde::Deserialize)]
struct ProbeAsset {
    version: Option<serde_json::Value>,
    #[serde(rename = "minVersion")]
    min_version: Option<serde_json::Value>,
}

/// What a file holds.
#[derive(Debug)]
pub(super) struct Container<'a> {
    /// The parsed document. What it says of animations may be missing; the text has it.
    pub(super) root: json::Root,
    /// The document's JSON.
    pub(super) text: &'a [u8],
    /// The binary chunk of a GLB.
    pub(super) bin: Option<&'a [u8]>,
}

/// Takes a file apart. Text and binary are told apart by content, not by ending.
pub(super) fn open(bytes: &[u8]) -> Result<Container<'_>, String> {
    if bytes.is_empty() {
        return Err("the file is empty; export it again".into());
    }
    if bytes.starts_with(MAGIC) {
        let (text, bin) = chunks(bytes)?;
        let text = text.strip_prefix(BOM).unwrap_or(text);
        return Ok(Container { root: parse(text, "the JSON chunk: ")?, text, bin });
    }
    // A byte order mark is against the specification, yet harmless and common among hand-edited files.
    let text = bytes.strip_prefix(BOM).unwrap_or(bytes);
    match text.iter().find(|byte| !byte.is_ascii_whitespace()) {
        Some(b'{') => Ok(Container { root: parse(text, "")?, text, bin: None }),
        _ => Err("neither glTF (JSON text) nor GLB (it would start with \"glTF\"); check the file".into()),
    }
}

/// Splits a GLB. Only a JSON chunk followed by at most one BIN chunk is right; chunks of other kinds may follow.
fn chunks(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), String> {
    let (Some(version), Some(length)) = (u32_at(bytes, 4), u32_at(bytes, 8)) else {
        return Err(truncated(bytes.len(), 12));
    };
    if version != 2 {
        return Err(format!("GLB version {version}; only version 2 is known: convert the file to glTF 2.0"));
    }
    let length = length as usize;
    let Some(body) = bytes.get(..length) else { return Err(truncated(bytes.len(), length)) };
    let mut at = 12;
    let mut json = None;
    let mut bin = None;
    for number in 0.. {
        if at >= body.len() {
            break;
        }
        let (Some(size), Some(kind)) = (u32_at(body, at), u32_at(body, at + 4)) else {
            return Err(truncated(body.len(), at + 8));
        };
        if size % 4 != 0 {
            return Err(format!(
                "GLB chunk {number} is {size} bytes long, not a multiple of 4; export it again"
            ));
        }
        let end = (at + 8).saturating_add(size as usize);
        let Some(data) = body.get(at + 8..end) else { return Err(truncated(body.len(), end)) };
        match (number, kind) {
            (0, CHUNK_JSON) => json = Some(data),
            (0, _) => return Err("the first GLB chunk is not JSON; export the file again".into()),
            (1, CHUNK_BIN) => bin = Some(data),
            (_, CHUNK_JSON | CHUNK_BIN) => {
                return Err(format!("GLB chunk {number} is a second JSON or a misplaced BIN chunk"));
            }
            _ => {}
        }
        at = end;
    }
    match json {
        Some(text) => Ok((text, bin)),
        None => Err("the GLB holds no JSON chunk; export it again".into()),
    }
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    let four = bytes.get(at..at.checked_add(4)?)?;
    Some(u32::from_le_bytes(four.try_into().ok()?))
}

fn truncated(have: usize, need: usize) -> String {
    format!("the GLB is cut off: {need} bytes are announced and {have} are there; copy or export it again")
}

fn parse(text: &[u8], place: &str) -> Result<json::Root, String> {
    if text.iter().all(|byte| byte.is_ascii_whitespace() || *byte == 0) {
        return Err(format!("{place}there is no JSON in it; export the file again"));
    }
    let broken = |e: serde_json::Error| format!("{place}{e}; correct or export the file again");
    let probe: Probe = serde_json::from_slice(text).map_err(broken)?;
    let Some(asset) = probe.asset else {
        return Err(format!("{place}`asset` with the glTF version is missing; this is no glTF file"));
    };
    for (field, value) in [("version", &asset.version), ("minVersion", &asset.min_version)] {
        version_is_known(field, value.as_ref()).map_err(|e| format!("{place}{e}"))?;
    }
    serde_json::from_slice(text).or_else(|e| without_animations(text).ok_or_else(|| broken(e)))
}

/// Nothing in an animation that does not play may stop a file from being shown, and the parser is stricter with them
/// than the specification is (`KHR_animation_pointer` aims at no node). The one that plays is read by
/// [`super::animation`].
fn without_animations(text: &[u8]) -> Option<json::Root> {
    let mut document: serde_json::Value = serde_json::from_slice(text).ok()?;
    document.as_object_mut()?.remove("animations")?;
    serde_json::from_value(document).ok()
}

/// Any 2.x is readable by the specification's own rule; a `minVersion` above 2.0 is not.
fn version_is_known(field: &str, value: Option<&serde_json::Value>) -> Result<(), String> {
    let value = match (field, value) {
        ("minVersion", None) => return Ok(()),
        (_, None) => return Err("`asset.version` is missing; this is no glTF file".into()),
        (_, Some(value)) => value,
    };
    let known = value.as_str().and_then(|text| text.split_once('.')).is_some_and(|(major, minor)| {
        major == "2" && minor.parse::<u32>().is_ok_and(|minor| field == "version" || minor == 0)
    });
    if known {
        return Ok(());
    }
    Err(format!("`asset.{field}` is {value}; only glTF 2.0 is known: convert the file to it"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn glb(chunks: &[(u32, &[u8])]) -> Vec<u8> {
        let mut body = Vec::new();
        for (kind, data) in chunks {
            body.extend((data.len() as u32).to_le_bytes());
            body.extend(kind.to_le_bytes());
            body.extend(*data);
        }
        let mut file = b"glTF\x02\0\0\0".to_vec();
        file.extend((body.len() as u32 + 12).to_le_bytes());
        file.extend(body);
        file
    }

    const TEXT: &[u8] = br#"{"asset":{"version":"2.0"}}     "#;

    #[test]
    fn a_glb_gives_its_chunks() {
        let file = glb(&[(CHUNK_JSON, TEXT), (CHUNK_BIN, b"abcd"), (7, b"more")]);
        let Container { root, text, bin } = open(&file).unwrap();
        assert_eq!((root.asset.version.as_str(), text), ("2.0", TEXT));
        assert_eq!(bin, Some(&b"abcd"[..]));
    }

    #[test]
    fn every_broken_container_is_named() {
        let good = glb(&[(CHUNK_JSON, TEXT), (CHUNK_BIN, b"abcd")]);
        let mut version_one = good.clone();
        version_one[4] = 1;
        let cases: Vec<(Vec<u8>, &str)> = vec![
            (vec![], "empty"),
            (b"glTF".to_vec(), "cut off"),
            (good[..good.len() - 1].to_vec(), "cut off"),
            (version_one, "version 1"),
            (glb(&[(CHUNK_BIN, b"abcd")]), "first GLB chunk"),
            (glb(&[(CHUNK_JSON, TEXT), (CHUNK_JSON, TEXT)]), "second JSON"),
            (glb(&[(CHUNK_JSON, &TEXT[..27])]), "multiple of 4"),
            (glb(&[(CHUNK_JSON, b"    ")]), "no JSON"),
            (b"PK\x03\x04".to_vec(), "neither"),
            (b"{\n  \"asset\": }".to_vec(), "line 2 column 12"),
            (b"{}".to_vec(), "`asset`"),
            (br#"{"asset":{"version":"1.0"},"buffers":{}}"#.to_vec(), "\"1.0\""),
            (br#"{"asset":{"version":"2.1","minVersion":"2.1"}}"#.to_vec(), "minVersion"),
        ];
        for (bytes, word) in cases {
            let message = open(&bytes).map(|_| ()).expect_err(word);
            assert!(message.contains(word), "{word}: {message}");
        }
    }

    #[test]
    fn animations_stop_no_file() {
        let pointer =
            br#"{"asset":{"version":"2.0"},"animations":[{"channels":[{"target":{"path":"pointer"}}]}]}"#;
        assert!(open(pointer).is_ok());
        let other = br#"{"asset":{"version":"2.0"},"animations":[],"meshes":[{}]}"#;
        assert!(open(other).unwrap_err().contains("primitives"), "the first error is the one that is told");
    }

    #[test]
    fn a_byte_order_mark_and_a_later_minor_version_are_let_through() {
        let mut text = BOM.to_vec();
        text.extend(br#"{"asset":{"version":"2.1"}}"#);
        assert!(open(&text).is_ok());
    }
}
