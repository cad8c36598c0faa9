// Follows `caster.wgsl`, whose group 1 becomes 2: casters behind a layer that was drawn before.

// That layer, of the same view and size.
@group(1) @binding(0) var nearer: texture_depth_2d;

// Keeps only what is strictly behind the layer. Both draws must come to the same bits for the same surface, so positions are
// @invariant and the layer is a 32-bit float: equal then means the layer itself, and no margin is needed. Where the layer is empty
// it holds the far plane, and nothing is behind that.
fn peel(position: vec4f) -> f32 {
    let before = textureLoad(nearer, vec2i(position.xy), 0);
    if select(position.z <= before, position.z >= before, UMBRAGE_CASTER_AWAY < 0.0) {
        discard;
    }
    return before;
}

// Halfway between the layer and a surface behind it. The middle of the two distances from the light (for one texel, those along
// the ray and along the axis are in proportion), not of the stored depths: stored depth goes as 1 / distance, so its middle is
// within twice the first distance even where the second is a mile away, and lies closer to what it must not shadow. Clamped,
// because rounding must not carry it past either. It grows with the second depth, so the depth test on it keeps the nearest.
fn midpoint(position: vec4f) -> f32 {
    let before = peel(position);
    let share = 0.5 * (umbrage_share_of_depth(before) + umbrage_share_of_depth(position.z));
    let cone = umbrage_caster.near_m * (1.0 - share) / (umbrage_caster.near_m + share * (umbrage_caster.far_m - umbrage_caster.near_m));
    let middle = select(1.0 - share, cone, umbrage_caster.perspective != 0u);
    return clamp(middle, min(before, position.z), max(before, position.z));
}

@fragment
fn fs_behind(in: Solid) {
    _ = peel(in.position);
}

@fragment
fn fs_behind_cut_out(in: CutOut) {
    cut_out(in.uv_alpha);
    _ = peel(in.position);
}

@fragment
fn fs_midpoint(in: Solid) -> @builtin(frag_depth) f32 {
    return midpoint(in.position);
}

@fragment
fn fs_midpoint_cut_out(in: CutOut) -> @builtin(frag_depth) f32 {
    cut_out(in.uv_alpha);
    return midpoint(in.position);
}

@fragment
fn fs_midpoint_color(in: Solid) -> @location(0) vec4f {
    return umbrage_caster_color(midpoint(in.position), vec2f(0.0));
}

@fragment
fn fs_midpoint_cut_out_color(in: CutOut) -> @location(0) vec4f {
    cut_out(in.uv_alpha);
    return umbrage_caster_color(midpoint(in.position), vec2f(0.0));
}
