//! One primitive, read: attributes in object space and a list of triangles.

use super::document::Document;
use super::extensions::declared;
use glam::{Vec2, Vec3, Vec4};
use gltf::json::accessor::ComponentType::{self, F32, I8, I16, U8, U16};
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked;

/// A primitive as the file has it, except that its topology is a list of triangles.
#[derive(Default)]
pub(super) struct Geometry {
    pub(super) positions: Vec<Vec3>,
    pub(super) normals: Option<Vec<Vec3>>,
    pub(super) tangents: Option<Vec<Vec4>>,
    pub(super) uvs: [Vec<Vec2>; 2],
    pub(super) colors: Vec<[u8; 4]>,
    /// For each set of four: joints and weights of each vertex.
    pub(super) bones: Vec<Bones>,
    /// Three for each triangle, each below the number of positions.
    pub(super) indices: Vec<u32>,
}

/// Four joints and their weights for each vertex.
pub(super) struct Bones {
    pub(super) joints: Vec<[u32; 4]>,
    pub(super) weights: Vec<[f32; 4]>,
}

/// Reads a primitive; `None` where there are no triangles to draw, with the reason among the warnings.
pub(super) fn read(
    document: &Document<'_>,
    primitive: &Primitive,
    place: &str,
    warnings: &mut Vec<String>,
) -> Result<Option<Geometry>, String> {
    let mode = match primitive.mode {
        Checked::Valid(mode @ (Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)) => mode,
        Checked::Valid(mode) => {
            warnings.push(format!("{place} is made of {mode:?}, which cast no shadow; it is left out"));
            return Ok(None);
        }
        Checked::Invalid => return Err(format!("{place}: its mode is none of glTF 2.0")),
    };
    let reader = Reader { document, primitive, place };
    let Some(positions) = reader.floats::<3>(Semantic::Positions)? else {
        warnings.push(format!("{place} has no positions; it is left out"));
        return Ok(None);
    };
    let count = positions.len();
    let mut geometry =
        Geometry { positions: positions.into_iter().map(Vec3::from).collect(), ..Default::default() };
    geometry.indices = reader.triangles(mode, count, warnings)?;
    geometry.normals =
        reader.floats::<3>(Semantic::Normals)?.map(|all| all.into_iter().map(Vec3::from).collect());
    geometry.tangents =
        reader.floats::<4>(Semantic::Tangents)?.map(|all| all.into_iter().map(Vec4::from).collect());
    for (set, uvs) in geometry.uvs.iter_mut().enumerate() {
        let read = reader.floats::<2>(Semantic::TexCoords(set as u32))?;
        *uvs = read.into_iter().flatten().map(Vec2::from).collect();
    }
    geometry.colors = reader.colors()?;
    geometry.bones = reader.bones()?;
    let counts = [geometry.normals.as_ref().map(Vec::len), geometry.tangents.as_ref().map(Vec::len)];
    let lists = geometry.uvs.iter().map(Vec::len).chain([geometry.colors.len()]).filter(|n| *n > 0);
    let bones = geometry.bones.iter().flat_map(|b| [b.joints.len(), b.weights.len()]);
    if let Some(odd) = counts.into_iter().flatten().chain(lists).chain(bones).find(|n| *n != count) {
        return Err(format!(
            "{place}: one attribute has {odd} elements and POSITION {count}; export it again"
        ));
    }
    Ok(Some(geometry))
}

struct Reader<'a> {
    document: &'a Document<'a>,
    primitive: &'a Primitive,
    place: &'a str,
}

impl Reader<'_> {
    fn find(&self, semantic: Semantic) -> Option<usize> {
        self.primitive.attributes.get(&Checked::Valid(semantic)).map(|accessor| accessor.value())
    }

    fn floats<const N: usize>(&self, semantic: Semantic) -> Result<Option<Vec<[f32; N]>>, String> {
        let Some(accessor) = self.find(semantic.clone()) else { return Ok(None) };
        let at = |e| format!("{}, {}: {e}", self.place, semantic.to_string());
        self.document.expect_format(accessor, &semantic).map_err(at)?;
        self.document.floats::<N>(accessor).map(Some).map_err(at)
    }

    /// COLOR_0 is linear in glTF, so its bytes need no conversion but the rounding.
    fn colors(&self) -> Result<Vec<[u8; 4]>, String> {
        let semantic = Semantic::Colors(0);
        let Some(accessor) = self.find(semantic.clone()) else { return Ok(Vec::new()) };
        let byte = |v: f32| (v.clamp(0.0, 1.0) * 255.0).round() as u8;
        let width = self.document.format(accessor)?.width;
        if width == 3 {
            let read = self.floats::<3>(semantic)?.unwrap_or_default();
            return Ok(read.into_iter().map(|[r, g, b]| [byte(r), byte(g), byte(b), 255]).collect());
        }
        let read = self.floats::<4>(semantic)?.unwrap_or_default();
        Ok(read.into_iter().map(|color| color.map(byte)).collect())
    }

    fn bones(&self) -> Result<Vec<Bones>, String> {
        let mut sets = Vec::new();
        for set in 0.. {
            let (joints, weights) = (self.find(Semantic::Joints(set)), self.find(Semantic::Weights(set)));
            let (joints, weights) = match (joints, weights) {
                (Some(joints), Some(weights)) => (joints, weights),
                (None, None) => break,
                _ => {
                    return Err(format!("{}: JOINTS_{set} and WEIGHTS_{set} must come together", self.place));
                }
            };
            let at = |e| format!("{}, joints and weights {set}: {e}", self.place);
            self.document.expect_format(weights, &Semantic::Weights(set)).map_err(at)?;
            sets.push(Bones {
                joints: self.document.wholes::<4>(joints).map_err(at)?,
                weights: self.document.floats::<4>(weights).map_err(at)?,
            });
        }
        Ok(sets)
    }

    fn triangles(&self, mode: Mode, count: usize, warnings: &mut Vec<String>) -> Result<Vec<u32>, String> {
        let corners: Vec<u32> = match self.primitive.indices {
            Some(accessor) => {
                let read = self.document.wholes::<1>(accessor.value());
                let read = read.map_err(|e| format!("{}, indices: {e}", self.place))?;
                read.into_iter().map(|[index]| index).collect()
            }
            None => {
                self.document.charge(count, 4)?;
                let count = u32::try_from(count).map_err(|_| format!("{}: too many vertices", self.place))?;
                (0..count).collect()
            }
        };
        if let Some((at, index)) = corners.iter().enumerate().find(|(_, index)| **index as usize >= count) {
            let place = self.place;
            return Err(format!(
                "{place}: index {at} is {index}, but there are {count} vertices; export it again"
            ));
        }
        if mode == Mode::Triangles && !corners.len().is_multiple_of(3) {
            let over = corners.len() % 3;
            warnings.push(format!("{}: {over} indices are left over from whole triangles", self.place));
        }
        if mode != Mode::Triangles {
            self.document.charge(corners.len(), 12)?;
        }
        Ok(list(mode, corners))
    }
}

/// A list of whole triangles from a list, strip or fan, all wound alike.
fn list(mode: Mode, mut corners: Vec<u32>) -> Vec<u32> {
    match mode {
        Mode::TriangleStrip => corners
            .windows(3)
            .enumerate()
            .flat_map(|(i, w)| if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[0], w[2], w[1]] })
            .collect(),
        Mode::TriangleFan => {
            let rest = corners.get(1..).unwrap_or_default();
            rest.windows(2).flat_map(|w| [corners[0], w[0], w[1]]).collect()
        }
        _ => {
            corners.truncate(corners.len() / 3 * 3);
            corners
        }
    }
}

impl Document<'_> {
    /// Is an attribute made of what glTF allows it to be, with or without quantization?
    pub(super) fn expect_format(&self, accessor: usize, semantic: &Semantic) -> Result<(), String> {
        let format = self.format(accessor)?;
        let (component, normalized) = (format.component, format.normalized);
        let core = match semantic {
            Semantic::Positions | Semantic::Normals | Semantic::Tangents => component == F32,
            _ => component == F32 || (normalized && matches!(component, U8 | U16)),
        };
        let small = matches!(component, I8 | U8 | I16 | U16);
        let quantized = match semantic {
            Semantic::Positions | Semantic::TexCoords(_) => small,
            Semantic::Normals | Semantic::Tangents => normalized && matches!(component, I8 | I16),
            _ => false,
        };
        if core || (quantized && declared(&self.root, "KHR_mesh_quantization")) {
            return Ok(());
        }
        let hint = if quantized { " without KHR_mesh_quantization" } else { "" };
        Err(format!(
            "accessor {accessor} is {}, which is not allowed here{hint}; export it again",
            format.name()
        ))
    }

    /// Is a morph target's difference made of what glTF allows it to be?
    pub(super) fn expect_delta(&self, accessor: usize) -> Result<(), String> {
        let format = self.format(accessor)?;
        let quantized =
            declared(&self.root, "KHR_mesh_quantization") && format.component != ComponentType::U32;
        if format.component == F32 || quantized {
            return Ok(());
        }
        Err(format!("accessor {accessor} is {}, which is not allowed here; export it again", format.name()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_and_fans_keep_their_winding() {
        assert_eq!(list(Mode::TriangleStrip, vec![0, 1, 2, 3, 4]), [0, 1, 2, 1, 3, 2, 2, 3, 4]);
        assert_eq!(list(Mode::TriangleFan, vec![9, 1, 2, 3]), [9, 1, 2, 9, 2, 3]);
        assert_eq!(list(Mode::Triangles, vec![0, 1, 2, 3]), [0, 1, 2]);
        for mode in [Mode::Triangles, Mode::TriangleStrip, Mode::TriangleFan] {
            assert!(list(mode, vec![]).is_empty());
            assert!(list(mode, vec![0, 1]).is_empty());
        }
    }
}
