//! Typed elements out of bytes. Every offset, stride and count is checked before a byte is touched.

use super::document::{Document, label};
use gltf::json::accessor::{Accessor, ComponentType, sparse::Sparse};
use gltf::json::validation::Checked;

/// A sparse accessor without data below it may announce any count; more zeros than this are refused.
const ZEROS_MAX: usize = 1 << 24;

/// What an accessor's elements are made of.
#[derive(Clone, Copy)]
pub(super) struct Format {
    pub(super) component: ComponentType,
    /// Components of an element.
    pub(super) width: usize,
    pub(super) normalized: bool,
}

impl Format {
    /// Bytes of an element.
    fn size(self) -> usize {
        self.component.size() * self.width
    }

    /// As the specification writes it.
    pub(super) fn name(self) -> String {
        let normalized = if self.normalized { " normalized" } else { "" };
        format!("{} x {:?}{normalized}", self.width, self.component)
    }
}

/// Elements at equal distances; the last one ends within `bytes`.
struct Strided<'a> {
    bytes: &'a [u8],
    stride: usize,
    size: usize,
}

impl<'a> Strided<'a> {
    /// `count` elements of `size` bytes, or why they are not there.
    fn new(bytes: &'a [u8], offset: u64, stride: usize, size: usize, count: usize) -> Result<Self, String> {
        let outside = || {
            let have = bytes.len();
            format!(
                "{count} elements of {size} bytes, {stride} apart, from byte {offset} on, do not lie in {have} bytes"
            )
        };
        let offset = usize::try_from(offset).map_err(|_| outside())?;
        let end = match count.checked_sub(1) {
            None => Some(offset),
            Some(gaps) => {
                gaps.checked_mul(stride).and_then(|n| n.checked_add(size)).and_then(|n| n.checked_add(offset))
            }
        };
        let bytes = end.and_then(|end| bytes.get(offset..end)).ok_or_else(outside)?;
        Ok(Self { bytes, stride, size })
    }

    fn get(&self, index: usize) -> &'a [u8] {
        let start = index * self.stride;
        &self.bytes[start..start + self.size]
    }
}

impl Document<'_> {
    fn accessor(&self, index: usize) -> Result<&Accessor, String> {
        self.root.accessors.get(index).ok_or_else(|| format!("accessor {index} does not exist"))
    }

    /// What an accessor's elements are made of.
    pub(super) fn format(&self, index: usize) -> Result<Format, String> {
        let accessor = self.accessor(index)?;
        let (Checked::Valid(component), Checked::Valid(kind)) = (accessor.component_type, accessor.type_)
        else {
            return Err(format!("accessor {index}: its type or componentType is none of glTF 2.0"));
        };
        let (component, width) = (component.0, kind.multiplicity());
        // `normalized` says nothing about floats.
        let normalized = accessor.normalized && component != F32;
        Ok(Format { component, width, normalized })
    }

    /// Number of elements.
    pub(super) fn count(&self, index: usize) -> Result<usize, String> {
        if let Some(bytes) = self.decompressed_accessors.get(&index) {
            return Ok(bytes.len() / self.format(index)?.size());
        }
        usize::try_from(self.accessor(index)?.count.0)
            .map_err(|_| format!("accessor {index}: its count is too large"))
    }

    /// Every element, made by `read` from its bytes.
    fn collect<T: Copy>(&self, index: usize, read: impl Fn(&[u8]) -> T) -> Result<Vec<T>, String> {
        let accessor = self.accessor(index)?;
        let at = |reason: String| format!("{}: {reason}", label("accessor", index, accessor.name.as_ref()));
        let size = self.format(index)?.size();
        let count = self.count(index)?;
        let mut elements = match (self.decompressed_accessors.get(&index), accessor.buffer_view) {
            (Some(bytes), _) => {
                self.charge(count, size_of::<T>())?;
                bytes.chunks_exact(size).map(read_ref(&read)).collect()
            }
            (None, Some(view)) => {
                let stride = match self.root.buffer_views[view.value()].byte_stride {
                    None => size,
                    Some(stride) if stride.0 >= size => stride.0,
                    Some(stride) => {
                        return Err(at(format!(
                            "byteStride {} is less than an element's {size} bytes",
                            stride.0
                        )));
                    }
                };
                let offset = accessor.byte_offset.map_or(0, |offset| offset.0);
                let bytes = self.view(view.value()).map_err(&at)?;
                let source = Strided::new(bytes, offset, stride, size, count).map_err(&at)?;
                self.charge(count, size_of::<T>())?;
                (0..count).map(|i| read(source.get(i))).collect::<Vec<T>>()
            }
            (None, None) => {
                if count > ZEROS_MAX {
                    return Err(at(format!(
                        "{count} elements are announced without data; export the file again"
                    )));
                }
                self.charge(count, size_of::<T>())?;
                vec![read(&vec![0; size]); count]
            }
        };
        if let Some(sparse) = &accessor.sparse {
            self.overlay(sparse, size, &mut elements, &read).map_err(at)?;
        }
        Ok(elements)
    }

    /// Puts a sparse accessor's values in their places.
    fn overlay<T>(
        &self,
        sparse: &Sparse,
        size: usize,
        elements: &mut [T],
        read: impl Fn(&[u8]) -> T,
    ) -> Result<(), String> {
        let count =
            usize::try_from(sparse.count.0).map_err(|_| "its sparse count is too large".to_owned())?;
        let Checked::Valid(component) = sparse.indices.component_type else {
            return Err("its sparse indices have no type of glTF 2.0".into());
        };
        let width = component.0.size();
        let places = self.view(sparse.indices.buffer_view.value())?;
        let places = Strided::new(places, sparse.indices.byte_offset.0, width, width, count)
            .map_err(|e| format!("sparse indices: {e}"))?;
        let values = self.view(sparse.values.buffer_view.value())?;
        let values = Strided::new(values, sparse.values.byte_offset.0, size, size, count)
            .map_err(|e| format!("sparse values: {e}"))?;
        let have = elements.len();
        for i in 0..count {
            let place = unsigned(places.get(i)) as usize;
            let element = elements
                .get_mut(place)
                .ok_or_else(|| format!("sparse index {i} is {place}, but there are {have} elements"))?;
            *element = read(values.get(i));
        }
        Ok(())
    }

    /// Elements of `N` components as floats; normalized integers become 0..1 or -1..1, others keep their value.
    pub(super) fn floats<const N: usize>(&self, index: usize) -> Result<Vec<[f32; N]>, String> {
        let format = self.format(index)?;
        self.expect_width::<N>(index, format)?;
        if format.component == F32 {
            return self.collect(index, |bytes| std::array::from_fn(|i| f32_at(bytes, i)));
        }
        let size = format.component.size();
        let component = component_reader(format);
        self.collect(index, |bytes| std::array::from_fn(|i| component(&bytes[i * size..(i + 1) * size])))
    }

    /// Elements of `N` components as whole numbers; floats, signed and normalized ones are refused.
    pub(super) fn wholes<const N: usize>(&self, index: usize) -> Result<Vec<[u32; N]>, String> {
        let format = self.format(index)?;
        self.expect_width::<N>(index, format)?;
        let (U8 | U16 | U32, false) = (format.component, format.normalized) else {
            return Err(format!("accessor {index} is {}; unsigned whole numbers are needed", format.name()));
        };
        let size = format.component.size();
        self.collect(index, |bytes| std::array::from_fn(|i| unsigned(&bytes[i * size..(i + 1) * size])))
    }

    fn expect_width<const N: usize>(&self, index: usize, format: Format) -> Result<(), String> {
        if format.width == N {
            return Ok(());
        }
        Err(format!("accessor {index} has {} components for each element; {N} are needed", format.width))
    }
}

use ComponentType::{F32, I8, I16, U8, U16, U32};

fn read_ref<T>(read: &impl Fn(&[u8]) -> T) -> impl Fn(&[u8]) -> T {
    move |bytes| read(bytes)
}

fn f32_at(bytes: &[u8], i: usize) -> f32 {
    f32::from_le_bytes([bytes[4 * i], bytes[4 * i + 1], bytes[4 * i + 2], bytes[4 * i + 3]])
}

/// One, two or four bytes, least significant first.
fn unsigned(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |value, byte| value << 8 | u32::from(*byte))
}

/// The specification's equations for normalized integers (section 3.11).
fn component_reader(format: Format) -> fn(&[u8]) -> f32 {
    match (format.component, format.normalized) {
        (U8, true) => |b| f32::from(b[0]) / 255.0,
        (I8, true) => |b| (f32::from(b[0] as i8) / 127.0).max(-1.0),
        (U16, true) => |b| unsigned(b) as f32 / 65535.0,
        (I16, true) => |b| (f32::from(unsigned(b) as u16 as i16) / 32767.0).max(-1.0),
        (U32, true) => |b| (f64::from(unsigned(b)) / f64::from(u32::MAX)) as f32,
        (I8, false) => |b| f32::from(b[0] as i8),
        (I16, false) => |b| f32::from(unsigned(b) as u16 as i16),
        (U8 | U16 | U32, false) => |b| unsigned(b) as f32,
        (F32, _) => |b| f32_at(b, 0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_must_lie_within_their_bytes() {
        let bytes = [0_u8; 20];
        assert!(Strided::new(&bytes, 0, 8, 4, 3).is_ok(), "the last gap need not be there");
        assert!(Strided::new(&bytes, 1, 8, 4, 3).is_err());
        assert!(Strided::new(&bytes, 20, 8, 4, 0).is_ok());
        assert!(Strided::new(&bytes, 21, 8, 4, 0).is_err());
        assert!(Strided::new(&bytes, u64::MAX, 8, 4, 1).is_err());
        assert!(Strided::new(&bytes, 0, usize::MAX, 4, 3).is_err());
        assert!(Strided::new(&bytes, 0, 8, 4, usize::MAX).is_err());
    }

    #[test]
    fn integers_become_floats_by_the_specification() {
        let read = |component, normalized, bytes: &[u8]| {
            component_reader(Format { component, width: 1, normalized })(bytes)
        };
        assert_eq!(read(U8, true, &[255]), 1.0);
        assert_eq!(read(I8, true, &[0x80]), -1.0);
        assert_eq!(read(I8, true, &[127]), 1.0);
        assert_eq!(read(I16, true, &[0x00, 0x80]), -1.0);
        assert_eq!(read(U16, true, &[0xFF, 0xFF]), 1.0);
        assert_eq!(read(I16, false, &[0xFE, 0xFF]), -2.0);
        assert_eq!(read(U16, false, &[1, 2]), 513.0);
    }
}
