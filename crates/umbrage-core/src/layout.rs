//! Structures as shaders see them. Every one of them mirrors a WGSL struct; a test asks naga whether it still does.

use crate::fit::ShadowView;
use crate::technique::{Settings, Storage};
use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3, Vec4};

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
    /// Metres.
    pub near_m: f32,
    /// Metres.
    pub far_m: f32,
    /// Stored depth.
    pub step_depth: f32,
    /// Share of the stored depth.
    pub step_relative: f32,
    /// Share of the distance from near to far.
    pub step_share: f32,
    /// Texels.
    pub width_texel: f32,
    /// Texels.
    pub margin_texel: f32,
    /// Metres.
    pub depth_m: f32,
    /// World space.
    pub origin: Vec3,
    /// 1 or 0.
    pub warped: u32,
    /// Texels.
    pub offset_texel: Vec4,
}

impl GpuView {
    /// The view in layer `layer` of the maps that `settings` ask for. `storage` is what the maps got: never `auto`.
    pub fn new(view: &ShadowView, layer: u32, settings: &Settings, storage: Storage) -> Self {
        let bias = crate::lookup::matrix_bias(crate::plan::lookup_bias_depth(settings), crate::DEPTH);
        let steps = storage.steps();
        Self {
            texture_from_world: bias * view.texture_from_world(),
            layer,
            texel_uv: 1.0 / settings.map_size_texel().max(1) as f32,
            texel_m: view.texel_m,
            perspective: u32::from(view.perspective),
            near_m: view.near_m,
            far_m: view.far_m,
            step_depth: steps.depth,
            step_relative: steps.relative,
            step_share: steps.share,
            width_texel: settings.value("width").unwrap_or(1.0),
            margin_texel: settings.value("plane_margin").unwrap_or(0.0),
            depth_m: settings.value("depth_m").unwrap_or(0.0),
            origin: view.light_from_world.inverse().w_axis.truncate(),
            warped: u32::from(view.is_warped()),
            offset_texel: offset_texel(view, settings),
        }
    }
}

/// How far receivers are moved, see `wgsl/view.wgsl`.
fn offset_texel(view: &ShadowView, settings: &Settings) -> Vec4 {
    let value = |name| settings.value(name).unwrap_or(0.0);
    // A perspective map's texel is `texel_m` wide for each metre of distance, so a share of the distance is a number of texels.
    let by_distance = if view.perspective { value("depth_share") / view.texel_m } else { 0.0 };
    Vec4::new(
        value("normal_offset"),
        value("normal_always"),
        value("normal_tilt"),
        value("depth_texel") + by_distance,
    )
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
            ("near_m", offset_of!(GpuView, near_m)),
            ("far_m", offset_of!(GpuView, far_m)),
            ("step_depth", offset_of!(GpuView, step_depth)),
            ("step_relative", offset_of!(GpuView, step_relative)),
            ("step_share", offset_of!(GpuView, step_share)),
            ("width_texel", offset_of!(GpuView, width_texel)),
            ("margin_texel", offset_of!(GpuView, margin_texel)),
            ("depth_m", offset_of!(GpuView, depth_m)),
            ("origin", offset_of!(GpuView, origin)),
            ("warped", offset_of!(GpuView, warped)),
            ("offset_texel", offset_of!(GpuView, offset_texel)),
        ];
        assert_eq!(shader, mirror);
        assert_eq!(span as usize, size_of::<GpuView>());
    }
}
