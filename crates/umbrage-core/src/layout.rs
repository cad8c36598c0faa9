//! Structures as shaders see them. Every one of them mirrors a WGSL struct; a test asks naga whether it still does.

use crate::fit::ShadowView;
use bytemuck::{Pod, Zeroable};
use glam::Mat4;

/// Mirrors `UmbrageView` of `wgsl/view.wgsl`; see there for what each field means.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct GpuView {
    /// World space to texture space, with the uniform bias.
    pub texture_from_world: Mat4,
    /// Layer of the map array.
    pub layer: u32,
    /// 1 / size.
    pub texel_uv: f32,
    /// Metres, at distance 1 m or at any.
    pub texel_m: f32,
    /// 1 or 0.
    pub perspective: u32,
}

impl GpuView {
    /// The view in layer `layer` of maps of `size_texel`, with `bias_depth` of uniform bias in its lookup matrix (0
    /// for none).
    pub fn new(view: &ShadowView, layer: u32, size_texel: u32, bias_depth: f32) -> Self {
        let bias = crate::lookup::matrix_bias(bias_depth, crate::DEPTH);
        Self {
            texture_from_world: bias * view.texture_from_world(),
            layer,
            texel_uv: 1.0 / size_texel.max(1) as f32,
            texel_m: view.texel_m,
            perspective: u32::from(view.perspective),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::mem::{offset_of, size_of};

    #[test]
    fn the_mirror_has_the_offsets_of_the_shader() {
        let text = crate::wgsl::assemble(&["view"]).expect("known");
        let module = naga::front::wgsl::parse_str(&text).expect("valid");
        let (members, span) = module
            .types
            .iter()
            .find_map(|(_, ty)| match &ty.inner {
                naga::TypeInner::Struct { members, span } if ty.name.as_deref() == Some("UmbrageView") => {
                    Some((members, *span))
                }
                _ => None,
            })
            .expect("UmbrageView");
        let shader: Vec<_> =
            members.iter().map(|m| (m.name.as_deref().unwrap_or(""), m.offset as usize)).collect();
        let mirror = vec![
            ("texture_from_world", offset_of!(GpuView, texture_from_world)),
            ("layer", offset_of!(GpuView, layer)),
            ("texel_uv", offset_of!(GpuView, texel_uv)),
            ("texel_m", offset_of!(GpuView, texel_m)),
            ("perspective", offset_of!(GpuView, perspective)),
        ];
        assert_eq!(shader, mirror);
        assert_eq!(span as usize, size_of::<GpuView>());
    }
}
