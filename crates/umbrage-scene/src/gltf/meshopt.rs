//! `EXT_meshopt_compression` and its successor `KHR_meshopt_compression`: buffer views, decoded.

use super::buffers::{compression, whole};
use super::document::Document;

/// The extension's names; the later one adds a filter and a codec version, both of which the decoder knows.
pub(super) const NAMES: &[&str] = &["EXT_meshopt_compression", "KHR_meshopt_compression"];

/// Decodes every compressed buffer view.
pub(super) fn decompress(document: &mut Document<'_>) -> Result<(), String> {
    for index in 0..document.root.buffer_views.len() {
        let Some(how) = compression(&document.root.buffer_views[index]) else { continue };
        let bytes = decode(document, how).map_err(|e| format!("bufferView {index}: meshopt: {e}"))?;
        document.decompressed_views.insert(index, bytes);
    }
    Ok(())
}

fn decode(document: &Document<'_>, how: &serde_json::Value) -> Result<Vec<u8>, String> {
    let need =
        |field: &str| whole(how, field).ok_or_else(|| format!("`{field}` is missing or no whole number"));
    let buffer = usize::try_from(need("buffer")?).map_err(|e| e.to_string())?;
    let source = document.slice(buffer, whole(how, "byteOffset").unwrap_or(0), need("byteLength")?)?;
    let (stride, count) = (need("byteStride")?, need("count")?);
    let count = usize::try_from(count).map_err(|e| e.to_string())?;
    // The decoder's own conditions: outside them it stops the program.
    let text = |field: &str| how.get(field).and_then(serde_json::Value::as_str);
    let mode = text("mode").unwrap_or_default();
    let fits = match mode {
        "ATTRIBUTES" => (4..=256).contains(&stride) && stride % 4 == 0,
        "TRIANGLES" => matches!(stride, 2 | 4) && count % 3 == 0,
        "INDICES" => matches!(stride, 2 | 4),
        _ => return Err(format!("mode \"{mode}\" is unknown")),
    };
    if !fits {
        return Err(format!("{mode} with {count} elements, {stride} bytes apart, is not allowed"));
    }
    let stride = stride as usize;
    document.charge(count, stride)?;
    let broken = |e: meshopt::Error| format!("the data is damaged ({e}); copy or export the file again");
    let mut bytes = match (mode, stride) {
        ("ATTRIBUTES", _) => vertices(source, count, stride).map_err(broken)?,
        ("TRIANGLES", 2) => le16(&meshopt::decode_index_buffer(source, count).map_err(broken)?),
        ("TRIANGLES", _) => le32(&meshopt::decode_index_buffer(source, count).map_err(broken)?),
        (_, 2) => le16(&meshopt::decode_index_sequence(source, count).map_err(broken)?),
        _ => le32(&meshopt::decode_index_sequence(source, count).map_err(broken)?),
    };
    filter(&mut bytes, text("filter").unwrap_or("NONE"), mode, stride)?;
    Ok(bytes)
}

fn le16(values: &[u16]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

fn le32(values: &[u32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

/// A vertex of `N` bytes. The decoder learns the stride from its type, which arrays above 32 bytes have no default for.
#[derive(Clone, Copy)]
struct Block<const N: usize>([u8; N]);

impl<const N: usize> Default for Block<N> {
    fn default() -> Self {
        Self([0; N])
    }
}

fn blocks<const N: usize>(source: &[u8], count: usize) -> meshopt::Result<Vec<u8>> {
    let blocks: Vec<Block<N>> = meshopt::decode_vertex_buffer(source, count)?;
    Ok(blocks.iter().flat_map(|block| block.0).collect())
}

fn vertices(source: &[u8], count: usize, stride: usize) -> meshopt::Result<Vec<u8>> {
    /// One call for each stride that the extension allows.
    macro_rules! by_stride {
        ($($n:literal)*) => {
            match stride {
                $($n => blocks::<$n>(source, count),)*
                _ => blocks::<256>(source, count),
            }
        };
    }
    by_stride!(4 8 12 16 20 24 28 32 36 40 44 48 52 56 60 64 68 72 76 80 84 88 92 96 100 104 108 112 116 120 124 128
        132 136 140 144 148 152 156 160 164 168 172 176 180 184 188 192 196 200 204 208 212 216 220 224 228 232 236
        240 244 248 252)
}

fn filter(bytes: &mut [u8], filter: &str, mode: &str, stride: usize) -> Result<(), String> {
    match (filter, stride) {
        ("NONE", _) => {}
        (_, _) if mode != "ATTRIBUTES" => return Err(format!("filter {filter} on {mode} is not allowed")),
        ("OCTAHEDRAL", 4) => {
            in_place(bytes, i8::from_le_bytes, i8::to_le_bytes, meshopt::decode_filter_oct::<i8>)
        }
        ("OCTAHEDRAL", 8) => {
            in_place(bytes, i16::from_le_bytes, i16::to_le_bytes, meshopt::decode_filter_oct::<i16>)
        }
        ("QUATERNION", 8) => {
            in_place(bytes, i16::from_le_bytes, i16::to_le_bytes, meshopt::decode_filter_quat)
        }
        // Each component is decoded by itself, so any stride is a list of single ones.
        ("EXPONENTIAL", _) => {
            in_place(bytes, u32::from_le_bytes, u32::to_le_bytes, meshopt::decode_filter_exp::<1>);
        }
        ("COLOR", 4) => {
            in_place(bytes, u8::from_le_bytes, u8::to_le_bytes, meshopt::decode_filter_color::<u8>)
        }
        ("COLOR", 8) => {
            in_place(bytes, u16::from_le_bytes, u16::to_le_bytes, meshopt::decode_filter_color::<u16>)
        }
        _ => return Err(format!("filter \"{filter}\" on elements of {stride} bytes is unknown")),
    }
    Ok(())
}

/// Runs a filter over bytes by way of the numbers that it works on: `N` numbers of `S` bytes each.
fn in_place<T: Copy, const S: usize, const N: usize>(
    bytes: &mut [u8],
    from: fn([u8; S]) -> T,
    to: fn(T) -> [u8; S],
    run: fn(&mut [[T; N]]),
) {
    let number = |b: &[u8], i: usize| from(std::array::from_fn(|k| b[i * S + k]));
    let mut elements: Vec<[T; N]> =
        bytes.chunks_exact(S * N).map(|b| std::array::from_fn(|i| number(b, i))).collect();
    run(&mut elements);
    for (place, number) in bytes.chunks_exact_mut(S).zip(elements.iter().flatten()) {
        place.copy_from_slice(&to(*number));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vertices_of_every_allowed_stride_come_back() {
        fn round<const N: usize>() {
            let sent: Vec<Block<N>> =
                (0..40_u8).map(|i| Block(std::array::from_fn(|k| i.wrapping_mul(k as u8)))).collect();
            let coded = meshopt::encode_vertex_buffer(&sent).unwrap();
            let expected: Vec<u8> = sent.iter().flat_map(|b| b.0).collect();
            assert_eq!(vertices(&coded, 40, N).unwrap(), expected, "{N}");
        }
        round::<4>();
        round::<12>();
        round::<100>();
        round::<252>();
        round::<256>();
    }

    #[test]
    fn filters_give_what_they_were_given() {
        let unit = [[0.6_f32, 0.0, 0.8, 0.0], [0.0, -1.0, 0.0, 1.0]];
        let mut bytes: Vec<u8> = meshopt::encode_filter_oct::<i16>(&unit, 16)
            .iter()
            .flatten()
            .flat_map(|v| v.to_le_bytes())
            .collect();
        filter(&mut bytes, "OCTAHEDRAL", "ATTRIBUTES", 8).unwrap();
        let x = i16::from_le_bytes([bytes[0], bytes[1]]);
        assert!((f32::from(x) / 32767.0 - 0.6).abs() < 1e-3, "{x}");
        let mut exponential = (1_u32 << 24 | 5).to_le_bytes().to_vec();
        filter(&mut exponential, "EXPONENTIAL", "ATTRIBUTES", 4).unwrap();
        assert_eq!(f32::from_le_bytes(exponential.try_into().unwrap()), 10.0, "5 * 2^1");
        assert!(filter(&mut [0; 12], "OCTAHEDRAL", "ATTRIBUTES", 12).is_err());
        assert!(filter(&mut [0; 4], "EXPONENTIAL", "INDICES", 4).is_err());
    }
}
