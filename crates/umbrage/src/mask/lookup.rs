//! How a shader looks up all masks of a light.

use std::ops::Range;
use umbrage_core::layout_mask::GpuMask;
use umbrage_core::masks::MOST_MASKS;

/// Mirrors `UmbrageMaskList` of [`masks_wgsl`]: all masks of a picture, 45,056 bytes.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct GpuMaskList {
    /// The masks, light by light.
    pub masks: [GpuMask; MOST_MASKS],
    /// The first pixel that each may darken and the one past the last (x, and y in the upper 16 bits), and its owner.
    pub seen: [[u32; 4]; MOST_MASKS],
}

/// The masks of a light in one number, as `umbrage_masks_coverage` takes it: the first, and in the upper 16 bits how many.
pub fn mask_range(masks: &Range<usize>) -> u32 {
    masks.start as u32 | ((masks.len() as u32) << 16)
}

/// The text that binds list, masks and sampler ([`super::BlockerMasks::bindings`], in that order) as `bindings` of `group`, and
/// defines the function that looks all masks of a light up. The text of the library's module `mask` stands before it
/// ([`umbrage_core::wgsl::assemble`]).
///
/// `umbrage_masks_coverage(range, at_pixel, at_object, p_world, normal, towards_light)` is how much of the light is taken, 0
/// nothing, 1 all: that of the mask that takes most. `range` is [`mask_range`]'s number; `at_object` the object that is shaded, or
/// 0xffffffff where the shader does not know ([`GpuMask::NO_OWNER`]): then an object's own mask may darken it, where it reaches
/// behind its nearest point. Its cost grows with the masks in whose rectangles on the screen the pixel lies.
///
/// Masks are looked up in a loop: written out one by one, five of them crash Mesa 22.3.6's software rasteriser.
pub fn masks_wgsl(group: u32, bindings: [u32; 3]) -> String {
    let [list, masks, sampler] = bindings;
    format!(
        "struct UmbrageMaskList {{
    masks: array<UmbrageMask, {MOST_MASKS}>,
    // The first pixel that each may darken and the one past the last, 16 bits a number, and the object that it is of.
    seen: array<vec4u, {MOST_MASKS}>,
}}

@group({group}) @binding({list}) var<uniform> umbrage_mask_list: UmbrageMaskList;
@group({group}) @binding({masks}) var umbrage_masks: texture_2d_array<f32>;
@group({group}) @binding({sampler}) var umbrage_mask_sampler: sampler;

fn umbrage_masks_coverage(
    range: u32,
    at_pixel: vec2u,
    at_object: u32,
    p_world: vec3f,
    normal: vec3f,
    towards_light: vec3f,
) -> f32 {{
    var covered = 0.0;
    let end = (range & 0xffffu) + (range >> 16u);
    for (var first = range & 0xffffu; first < end; first += 32u) {{
        // Most masks are far from most pixels. Those that are not are noted first and looked up together: neighbours then
        // take as many turns as the one of them that lies in most.
        var near = 0u;
        for (var i = first; i < min(end, first + 32u); i++) {{
            let seen = umbrage_mask_list.seen[i];
            let inside = at_pixel.x >= (seen.x & 0xffffu) && at_pixel.y >= (seen.x >> 16u)
                && at_pixel.x < (seen.y & 0xffffu) && at_pixel.y < (seen.y >> 16u);
            // What a mask shows of its own object may lie behind it.
            near |= select(0u, 1u << (i - first), inside && seen.z != at_object);
        }}
        while near != 0u {{
            let i = first + firstTrailingBit(near);
            near &= near - 1u;
            covered = max(covered, umbrage_mask_coverage(
                umbrage_masks, umbrage_mask_sampler, umbrage_mask_list.masks[i], p_world, normal, towards_light));
        }}
    }}
    return covered;
}}
"
    )
}

/// What the list says of an owner: never the number that shaders have for an object that they do not know.
pub(super) fn owner_in_list(owner: u32) -> u32 {
    if owner == GpuMask::NO_OWNER { GpuMask::NO_OWNER - 1 } else { owner }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::mem::offset_of;

    #[test]
    fn the_text_validates_with_any_bindings_and_the_mirror_has_its_offsets() {
        for (group, bindings) in [(0, [11, 12, 13]), (2, [5, 0, 7])] {
            let library = umbrage_core::wgsl::assemble(&["mask"]).expect("known");
            let text = library + &masks_wgsl(group, bindings);
            let module = naga::front::wgsl::parse_str(&text).expect("valid");
            naga::valid::Validator::new(
                naga::valid::ValidationFlags::all(),
                naga::valid::Capabilities::empty(),
            )
            .validate(&module)
            .expect("valid");
            let mut bound: Vec<_> = module
                .global_variables
                .iter()
                .filter_map(|(_, v)| v.binding.as_ref().map(|b| (b.group, b.binding)))
                .collect();
            let mut wanted = bindings.map(|binding| (group, binding));
            bound.sort_unstable();
            wanted.sort_unstable();
            assert_eq!(bound, wanted);
            let (_, ty) = module
                .types
                .iter()
                .find(|(_, ty)| ty.name.as_deref() == Some("UmbrageMaskList"))
                .expect("it");
            let naga::TypeInner::Struct { members, span } = &ty.inner else { panic!("no struct") };
            let shader: Vec<_> = members.iter().map(|m| m.offset as usize).collect();
            assert_eq!(shader, [offset_of!(GpuMaskList, masks), offset_of!(GpuMaskList, seen)]);
            assert_eq!(*span as usize, size_of::<GpuMaskList>());
        }
    }

    #[test]
    fn a_mask_without_owner_darkens_who_does_not_know_what_it_is() {
        assert_ne!(owner_in_list(GpuMask::NO_OWNER), GpuMask::NO_OWNER);
        assert_eq!(owner_in_list(7), 7);
        assert_eq!(mask_range(&(3..5)), 0x2_0003);
    }
}
