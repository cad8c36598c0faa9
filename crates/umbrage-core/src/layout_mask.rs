//! A mask as shaders see it. It mirrors a WGSL struct; a test asks naga whether it still does.

use crate::fit::MaskView;
use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec2, Vec4};

/// Mirrors `UmbrageMask` of `wgsl/mask.wgsl`; see there for what each field means. 160 bytes, so that uniform buffers may hold
/// arrays of it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct GpuMask {
    /// World space to the mask's uv and w.
    pub texture_from_world: Mat4,
    /// World space to metres along the axis.
    pub depth_from_world: Vec4,
    /// Metres.
    pub near_m: f32,
    /// Metres.
    pub far_m: f32,
    /// Layer of the mask array.
    pub layer: u32,
    /// Number of the blocker's object, or [`GpuMask::NO_OWNER`].
    pub owner: u32,
    /// Tangents, or metres for parallel light.
    pub texel: Vec2,
    /// 1 / size.
    pub texel_uv: f32,
    /// 1 or 0.
    pub perspective: u32,
    /// The light's place and 1, or the direction towards it and 0.
    pub light_world: Vec4,
    /// Corner of the blocker's box, and nothing.
    pub box_min: Vec4,
    /// The other corner, and nothing.
    pub box_max: Vec4,
}

impl GpuMask {
    /// The owner of a mask that darkens every receiver.
    pub const NO_OWNER: u32 = u32::MAX;

    /// The mask in layer `layer`, whose blocker is the object `owner`: a receiver of the same number is not to be darkened by
    /// it, because a mask cannot tell which parts of an object lie behind others.
    pub fn new(view: &MaskView, layer: u32, owner: Option<u32>) -> Self {
        Self {
            texture_from_world: view.texture_from_world(),
            depth_from_world: view.depth_from_world(),
            near_m: view.near_m,
            far_m: view.far_m,
            layer,
            owner: owner.unwrap_or(Self::NO_OWNER),
            texel: view.texel,
            texel_uv: 1.0 / view.size_texel as f32,
            perspective: u32::from(view.perspective),
            light_world: view.light_point_world(),
            box_min: view.bounds_world.min.extend(0.0),
            box_max: view.bounds_world.max.extend(0.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::mem::{offset_of, size_of};

    #[test]
    fn the_mirror_has_the_offsets_of_the_shader() {
        let text = crate::wgsl::assemble(&["mask"]).expect("known");
        let module = naga::front::wgsl::parse_str(&text).expect("valid");
        let (members, span) = module
            .types
            .iter()
            .find_map(|(_, ty)| match &ty.inner {
                naga::TypeInner::Struct { members, span } if ty.name.as_deref() == Some("UmbrageMask") => {
                    Some((members, *span))
                }
                _ => None,
            })
            .expect("UmbrageMask");
        let shader: Vec<_> =
            members.iter().map(|m| (m.name.as_deref().unwrap_or(""), m.offset as usize)).collect();
        let mirror = vec![
            ("texture_from_world", offset_of!(GpuMask, texture_from_world)),
            ("depth_from_world", offset_of!(GpuMask, depth_from_world)),
            ("near_m", offset_of!(GpuMask, near_m)),
            ("far_m", offset_of!(GpuMask, far_m)),
            ("layer", offset_of!(GpuMask, layer)),
            ("owner", offset_of!(GpuMask, owner)),
            ("texel", offset_of!(GpuMask, texel)),
            ("texel_uv", offset_of!(GpuMask, texel_uv)),
            ("perspective", offset_of!(GpuMask, perspective)),
            ("light_world", offset_of!(GpuMask, light_world)),
            ("box_min", offset_of!(GpuMask, box_min)),
            ("box_max", offset_of!(GpuMask, box_max)),
        ];
        assert_eq!(shader, mirror);
        assert_eq!(span as usize, size_of::<GpuMask>());
        assert!(size_of::<GpuMask>().is_multiple_of(16), "the stride of an array in a uniform buffer");
    }
}
