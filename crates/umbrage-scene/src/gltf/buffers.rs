//! Buffers and buffer views: from references to slices of bytes that are known to be there.

use super::document::{Document, label};
use super::{draco, meshopt, uri};
use crate::SceneError;
use gltf::json;
use std::borrow::Cow;
use std::path::Path;

/// Reads every buffer. A buffer without bytes of its own is `None` when a compression extension stands in for it.
pub(super) fn read<'a>(
    path: &Path,
    root: &json::Root,
    bin: Option<&'a [u8]>,
) -> Result<Vec<Option<Cow<'a, [u8]>>>, SceneError> {
    let mut buffers = Vec::with_capacity(root.buffers.len());
    for (i, buffer) in root.buffers.iter().enumerate() {
        let place = label("buffer", i, buffer.name.as_ref());
        let length = buffer.byte_length.0;
        let bytes: Option<Cow<'a, [u8]>> = match (&buffer.uri, bin) {
            (Some(name), _) => Some(uri::read(path, name, length).map(Cow::Owned).map_err(|reason| {
                SceneError::malformed(path, super::document::one_line(&format!("{place}: {reason}")))
            })?),
            (None, Some(bin)) if i == 0 => Some(Cow::Borrowed(bin)),
            (None, _) => None,
        };
        if let Some(bytes) = &bytes
            && (bytes.len() as u64) < length
        {
            let source = buffer.uri.as_deref().map_or("the GLB's binary chunk".into(), uri::shown);
            let have = bytes.len();
            let what = format!("{place}: {length} bytes are announced, {source} has {have}; copy it again");
            return Err(SceneError::malformed(path, super::document::one_line(&what)));
        }
        buffers.push(bytes);
    }
    Ok(buffers)
}

impl Document<'_> {
    /// The bytes of a buffer view, decompressed where they were compressed.
    pub(super) fn view(&self, index: usize) -> Result<&[u8], String> {
        if let Some(bytes) = self.decompressed_views.get(&index) {
            return Ok(bytes);
        }
        let view =
            self.root.buffer_views.get(index).ok_or_else(|| format!("bufferView {index} does not exist"))?;
        let offset = view.byte_offset.map_or(0, |offset| offset.0);
        self.slice(view.buffer.value(), offset, view.byte_length.0)
            .map_err(|e| format!("bufferView {index}: {e}"))
    }

    /// Bytes of a buffer.
    pub(super) fn slice(&self, buffer: usize, offset: u64, length: u64) -> Result<&[u8], String> {
        let Some(bytes) = self.buffers.get(buffer) else {
            return Err(format!("buffer {buffer} does not exist"));
        };
        let Some(bytes) = bytes else {
            return Err(format!(
                "buffer {buffer} has no data: no URI, and no binary chunk that belongs to it; export the file again"
            ));
        };
        let end = offset.checked_add(length).and_then(|end| usize::try_from(end).ok());
        end.and_then(|end| bytes.get(usize::try_from(offset).ok()?..end)).ok_or_else(|| {
            let have = bytes.len();
            format!("{length} bytes from {offset} on do not lie in buffer {buffer}, which has {have}; export it again")
        })
    }
}

/// A field of an extension's JSON that is a whole number.
pub(super) fn whole(object: &serde_json::Value, field: &str) -> Option<u64> {
    object.get(field)?.as_u64()
}

/// The JSON of the compression of a buffer view, if it has any.
pub(super) fn compression(view: &json::buffer::View) -> Option<&serde_json::Value> {
    let others = &view.extensions.as_ref()?.others;
    meshopt::NAMES.iter().find_map(|name| others.get(*name))
}

/// The JSON of the compression of a primitive, if it has any.
pub(super) fn primitive_compression(primitive: &json::mesh::Primitive) -> Option<&serde_json::Value> {
    primitive.extensions.as_ref()?.others.get(draco::NAME)
}
