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
    // The light's place and 1, or the direction towards it and 0.
    light_world: vec4f,
    // Box around the blocker, world space; w is nothing.
    box_min: vec4f,
    box_max: vec4f,
}

// Where a point is along the axis. 0: before the blocker or behind the light; 1: between its nearest and its farthest point,
// where parts of the outline may lie behind it; 2: beyond all of it, where the mask is exact.
fn umbrage_mask_region(mask: UmbrageMask, p_world: vec3f) -> u32 {
    let depth_m = dot(mask.depth_from_world, vec4f(p_world, 1.0));
    return select(0u, 1u, depth_m >= mask.near_m) + select(0u, 1u, depth_m > mask.far_m);
}

// Does the ray of light to a point meet the blocker's box before the point? What stands on a blocker, or beside it, is then not
// darkened by it, though a part of the blocker is nearer to the light. A point that the box just touches counts as before it.
fn umbrage_mask_box_is_before(mask: UmbrageMask, p_world: vec3f) -> bool {
    let way = mask.light_world.xyz - p_world * mask.light_world.w;
    let tiny = vec3f(1e-30);
    let per_way = 1.0 / select(max(way, tiny), min(way, -tiny), way < vec3f(0.0));
    let a = (mask.box_min.xyz - p_world) * per_way;
    let b = (mask.box_max.xyz - p_world) * per_way;
    // From the point towards the light: the ray leaves the box last where it came in.
    let leaves = min(min(max(a.x, b.x), max(a.y, b.y)), max(a.z, b.z));
    let size = mask.box_max.xyz - mask.box_min.xyz;
    let margin_m = 1e-3 * max(size.x, max(size.y, size.z));
    return leaves * length(way) > margin_m;
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
    let uv = p.xy / max(p.w, 1e-30);
    // Behind the light the division would show a phantom, the outline mirrored through the light. Outside of the mask its border
    // goes on, which is empty: most masks end here for most surfaces.
    if p.w <= 0.0 || any(abs(uv - 0.5) > vec2f(0.5)) || dot(normal, towards_light) <= 0.0 {
        return 0.0;
    }
    if umbrage_mask_region(mask, p_world) == 0u || !umbrage_mask_box_is_before(mask, p_world) {
        return 0.0;
    }
    // Half a texel in: there no address mode reaches across to the other side.
    let edge = 0.5 * mask.texel_uv;
    return textureSampleLevel(masks, mask_sampler, clamp(uv, vec2f(edge), vec2f(1.0 - edge)), mask.layer, 0.0).r;
}
