// A projective mask: the outline of one blocker, seen from one light, laid over whatever lies behind it.

// One light and one blocker. Mirrors `umbrage_core::layout_mask::GpuMask`; a test compares the two.
struct UmbrageMask {
    // World space to texture space: after division by w, xy is the place in the mask (0..1, rows down).
    texture_from_world: mat4x4f,
    // The dot product with (p_world, 1) is how far a point lies along the mask's axis, metres; below 0 behind the light.
    depth_from_world: vec4f,
    // Where the blocker begins and ends along the axis, metres.
    near_m: f32,
    far_m: f32,
    // Which layer of the mask array.
    layer: u32,
    // Number of the object that the mask is of; 0xffffffff where receivers are not to be told apart. An object's own mask must
    // not be laid over it: the caller compares.
    owner: u32,
    // Width and height of a texel: tangents, or metres for parallel light.
    texel: vec2f,
    // Width of a texel in uv: 1 / size.
    texel_uv: f32,
    // 1: rays come from a place, 0: they are parallel.
    perspective: u32,
}

// Where a point is along the axis. 0: before the blocker or behind the light; 1: between its nearest and its farthest point,
// where parts of the outline may lie behind it; 2: beyond all of it, where the mask is exact.
fn umbrage_mask_region(mask: UmbrageMask, p_world: vec3f) -> u32 {
    let depth_m = dot(mask.depth_from_world, vec4f(p_world, 1.0));
    return select(0u, 1u, depth_m >= mask.near_m) + select(0u, 1u, depth_m > mask.far_m);
}

// How much of the light the blocker takes from a surface at `p_world`: 1 all, 0 nothing. `masks` holds 1 where a blocker covers;
// a linear sampler smooths the edge over a texel, a nearest one shows texels. `normal` is the surface's and `towards_light`
// the way to the light, of any length, both in world space: a surface that faces away is lit by nothing, and gets 0.
//
// Outside of the mask the place is clamped to its outermost texels, which are empty, whatever the sampler's address mode is.
fn umbrage_mask_coverage(
    masks: texture_2d_array<f32>,
    mask_sampler: sampler,
    mask: UmbrageMask,
    p_world: vec3f,
    normal: vec3f,
    towards_light: vec3f,
) -> f32 {
    let p = mask.texture_from_world * vec4f(p_world, 1.0);
    // Behind the light the division would show a phantom, the outline mirrored through the light: the region says 0 there.
    let shows = p.w > 0.0 && umbrage_mask_region(mask, p_world) > 0u && dot(normal, towards_light) > 0.0;
    // Half a texel in: there no address mode reaches across to the other side.
    let edge = 0.5 * mask.texel_uv;
    let uv = clamp(p.xy / max(p.w, 1e-30), vec2f(edge), vec2f(1.0 - edge));
    let covered = textureSampleLevel(masks, mask_sampler, uv, mask.layer, 0.0).r;
    return select(0.0, covered, shows);
}
