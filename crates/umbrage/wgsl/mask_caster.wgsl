// The flat colour of a blocker: whatever it covers is dark.

@fragment
fn fs_mask() -> @location(0) vec4f {
    return vec4f(1.0);
}

@fragment
fn fs_mask_cut_out(in: CutOut) -> @location(0) vec4f {
    cut_out(in.uv_alpha);
    return vec4f(1.0);
}
