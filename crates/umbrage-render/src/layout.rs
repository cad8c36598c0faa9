//! Structures as the renderer's shaders see them; see the WGSL for what each field means. A test asks naga about every
//! uniform of every assembled shader and fails for one that has no mirror here.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3, Vec4};
pub use umbrage::caster::GpuInstance;

/// How many lights a frame may have.
pub const MAX_LIGHTS: usize = 16;

/// Makes constants that Rust and the shaders share, and the list that is written into every shader.
macro_rules! shader_constants {
    ($($name:ident = $value:literal;)*) => {
        $(pub const $name: u32 = $value;)*
        /// Name and value of each.
        pub const SHADER_CONSTANTS: &[(&str, u32)] = &[$((stringify!($name), $name)),*];
    };
}

shader_constants! {
    // Kinds of a light.
    DIRECTIONAL = 0;
    POINT = 1;
    SPOT = 2;
    // Flags of a surface: answers by Lambert and Blinn; shows its base colour without light.
    BLINN = 1;
    UNLIT = 2;
    // It receives no shadow.
    EXEMPT = 4;
}

/// Mirrors `Frame` of `wgsl/frame.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct GpuFrame {
    pub clip_from_world: Mat4,
    pub world_from_clip: Mat4,
    pub eye: Vec3,
    pub eye_w: f32,
    pub ambient: Vec3,
    pub fill: f32,
    pub light_count: u32,
    pub shown_light: u32,
    pub exposure: f32,
    pub time_s: f32,
}

/// Mirrors `Light` of `wgsl/frame.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct GpuLight {
    pub slide_from_world: Mat4,
    pub position: Vec3,
    pub kind: u32,
    pub direction: Vec3,
    pub range_m: f32,
    pub color: Vec3,
    pub view: i32,
    pub cone_scale: f32,
    pub cone_offset: f32,
    pub cos_outer: f32,
    pub slide: i32,
    pub near_m: f32,
    pub far_m: f32,
    pub places: u32,
    pub masks: u32,
}

/// Mirrors `Material` of `wgsl/mesh.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct GpuMaterial {
    pub base_color: Vec4,
    pub specular: Vec3,
    pub gloss: f32,
    pub emissive: Vec3,
    pub cutoff: f32,
    pub normal_scale: f32,
    pub flags: u32,
    pub uv_sets: u32,
    pub pad: u32,
    pub uv_rows: [Vec4; 8],
}

/// What a full vertex holds beside its position.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct GpuFullVertex {
    pub normal: Vec3,
    pub uv: [f32; 4],
    pub color: [u8; 4],
    pub tangent: [f32; 4],
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shaders;
    use std::collections::BTreeMap;
    use std::mem::offset_of;
    use umbrage::core::layout::GpuView;
    use umbrage::mask::GpuMaskList;

    macro_rules! offsets {
        ($ty:ty, $($field:ident),*) => { (vec![$((stringify!($field), offset_of!($ty, $field))),*], size_of::<$ty>()) };
    }

    /// Members of a library module's first structure: core's own tests compare them with their mirrors.
    fn library(module: &str) -> Vec<(&'static str, usize)> {
        let text = umbrage::core::wgsl::assemble(&[module]).expect("known");
        let module = naga::front::wgsl::parse_str(&text).expect("valid");
        let members = module.types.iter().find_map(|(_, ty)| match &ty.inner {
            naga::TypeInner::Struct { members, .. } => Some(members.clone()),
            _ => None,
        });
        let members = members.expect("a struct");
        members.iter().map(|m| (&*m.name.clone().expect("named").leak(), m.offset as usize)).collect()
    }

    #[test]
    fn every_uniform_of_every_shader_has_a_mirror_with_its_offsets() {
        let mirrors = BTreeMap::from([
            (
                "Frame",
                offsets!(
                    GpuFrame,
                    clip_from_world,
                    world_from_clip,
                    eye,
                    eye_w,
                    ambient,
                    fill,
                    light_count,
                    shown_light,
                    exposure,
                    time_s
                ),
            ),
            (
                "Light",
                offsets!(
                    GpuLight,
                    slide_from_world,
                    position,
                    kind,
                    direction,
                    range_m,
                    color,
                    view,
                    cone_scale,
                    cone_offset,
                    cos_outer,
                    slide,
                    near_m,
                    far_m,
                    places,
                    masks
                ),
            ),
            (
                "Material",
                offsets!(
                    GpuMaterial,
                    base_color,
                    specular,
                    gloss,
                    emissive,
                    cutoff,
                    normal_scale,
                    flags,
                    uv_sets,
                    pad,
                    uv_rows
                ),
            ),
            ("UmbrageMaskList", offsets!(GpuMaskList, masks, seen)),
            ("UmbrageView", (library("view"), size_of::<GpuView>())),
        ]);
        let mut seen = std::collections::BTreeSet::new();
        for (name, text) in shaders::all() {
            let module = naga::front::wgsl::parse_str(&text)
                .unwrap_or_else(|e| panic!("{name}: {}", e.emit_to_string(&text)));
            for (_, global) in module.global_variables.iter() {
                if !matches!(global.space, naga::AddressSpace::Uniform | naga::AddressSpace::Storage { .. }) {
                    continue;
                }
                let mut ty = &module.types[global.ty];
                if let naga::TypeInner::Array { base, .. } = ty.inner {
                    ty = &module.types[base];
                }
                if matches!(ty.inner, naga::TypeInner::Matrix { .. }) {
                    continue;
                }
                let naga::TypeInner::Struct { members, span } = &ty.inner else {
                    panic!("{name}: {global:?}")
                };
                let struct_name = ty.name.as_deref().expect("a named struct");
                let (fields, size) =
                    mirrors.get(struct_name).unwrap_or_else(|| panic!("{name}: {struct_name} has no mirror"));
                let shader: Vec<_> =
                    members.iter().map(|m| (m.name.as_deref().unwrap_or(""), m.offset as usize)).collect();
                assert_eq!(&shader, fields, "{name}: {struct_name}");
                assert_eq!(*span as usize, *size, "{name}: {struct_name}");
                seen.insert(struct_name.to_owned());
            }
        }
        assert_eq!(seen.len(), mirrors.len(), "a mirror that no shader uses: {seen:?}");
    }
}
