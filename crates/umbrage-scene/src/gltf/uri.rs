//! Where a file's companions lie: data URIs, and names relative to the file.

use base64::Engine as _;
use std::borrow::Cow;
use std::io::Read as _;
use std::path::{Path, PathBuf};

/// Reads what a URI names. `limit` is the most bytes that are wanted; a longer file is cut there.
///
/// # Errors
/// What is wrong and what to do, without the place.
pub(super) fn read(beside: &Path, uri: &str, limit: u64) -> Result<Vec<u8>, String> {
    if let Some(data) = strip_scheme(uri, "data:") {
        return data_uri(data);
    }
    let file = resolve(beside, uri)?;
    let name = file.display();
    let metadata = std::fs::metadata(&file).map_err(|e| match e.kind() {
        std::io::ErrorKind::NotFound => format!("cannot read {name}: there is no such file; put it there"),
        _ => format!("cannot read {name}: {e}"),
    })?;
    // A device or a pipe may never end or never answer.
    if !metadata.is_file() {
        return Err(format!("cannot read {name}: it is not a file"));
    }
    let mut bytes = Vec::new();
    let handle = std::fs::File::open(&file).map_err(|e| format!("cannot read {name}: {e}"))?;
    handle.take(limit).read_to_end(&mut bytes).map_err(|e| format!("cannot read {name}: {e}"))?;
    Ok(bytes)
}

/// For messages: a data URI by its length, any other as it stands.
pub(super) fn shown(uri: &str) -> Cow<'_, str> {
    match strip_scheme(uri, "data:") {
        Some(data) => format!("data URI of {} characters", data.len()).into(),
        None => percent_encoding::percent_decode_str(uri).decode_utf8_lossy(),
    }
}

fn strip_scheme<'a>(uri: &'a str, scheme: &str) -> Option<&'a str> {
    let head = uri.get(..scheme.len())?;
    head.eq_ignore_ascii_case(scheme).then(|| &uri[scheme.len()..])
}

fn data_uri(data: &str) -> Result<Vec<u8>, String> {
    let Some((kind, body)) = data.split_once(',') else {
        return Err("its data URI has no comma; export the file again".into());
    };
    if !kind.to_ascii_lowercase().ends_with(";base64") {
        return Ok(percent_encoding::percent_decode_str(body).collect());
    }
    let body: Cow<'_, [u8]> = percent_encoding::percent_decode_str(body).into();
    base64::engine::GeneralPurpose::new(
        &base64::alphabet::STANDARD,
        base64::engine::GeneralPurposeConfig::new()
            .with_decode_padding_mode(base64::engine::DecodePaddingMode::Indifferent),
    )
    .decode(body)
    .map_err(|e| format!("its data URI is not Base64: {e}; export the file again"))
}

/// The file that a relative URI names. Percent signs that encode nothing stay: many exporters do not encode.
fn resolve(beside: &Path, uri: &str) -> Result<PathBuf, String> {
    let folder = beside.parent().unwrap_or(Path::new(""));
    let decoded = percent_encoding::percent_decode_str(uri).decode_utf8_lossy();
    if uri.is_empty() || decoded.contains('\0') {
        return Err("its name is empty or holds a zero byte; correct the URI".into());
    }
    let has_scheme = uri.split_once(':').is_some_and(|(scheme, _)| {
        !scheme.is_empty() && scheme.chars().all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c))
    });
    if has_scheme || decoded.starts_with(['/', '\\']) {
        return Err(format!("\"{uri}\" is not relative to the file; put the companion beside it"));
    }
    let mut candidates = [decoded.as_ref(), uri].map(|name| folder.join(name)).to_vec();
    // Windows exporters write backslashes, which elsewhere are ordinary characters of a name.
    candidates.push(folder.join(decoded.replace('\\', "/")));
    let first = candidates[0].clone();
    Ok(candidates.into_iter().find(|path| path.exists()).unwrap_or(first))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn data_uris_of_either_kind() {
        let here = Path::new("x.gltf");
        assert_eq!(read(here, "data:application/octet-stream;base64,AQID", 9).unwrap(), [1, 2, 3]);
        assert_eq!(read(here, "DATA:;base64,AQI", 9).unwrap(), [1, 2], "missing padding is let through");
        assert_eq!(read(here, "data:,a%20b", 9).unwrap(), b"a b");
        assert!(read(here, "data:;base64,A*", 9).unwrap_err().contains("Base64"));
        assert!(read(here, "data:;base64", 9).unwrap_err().contains("comma"));
    }

    #[test]
    fn only_files_beside_the_document() {
        let here = Path::new("folder/x.gltf");
        for uri in ["http://example.org/a.bin", "/etc/passwd", "%2Fetc/passwd", "file:///a", "C:\\a.bin", ""]
        {
            assert!(read(here, uri, 9).is_err(), "{uri}");
        }
        assert!(read(here, "no%20such.bin", 9).unwrap_err().contains("no such.bin"));
        assert_eq!(resolve(here, "a%20b.bin").unwrap(), Path::new("folder/a b.bin"));
    }

    #[cfg(unix)]
    #[test]
    fn a_device_is_not_a_file() {
        let here = Path::new("/dev/x.gltf");
        assert!(read(here, "zero", 9).unwrap_err().contains("not a file"));
    }
}
