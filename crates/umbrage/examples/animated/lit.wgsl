// Blades as the eye sees them. `blades.wgsl` and `support/forward.wgsl` stand before this.

@vertex
fn vs_blade(@builtin(vertex_index) corner: u32, blade: Blade) -> Surface {
    let p_world = blade_corner(blade, corner);
    return Surface(globals.clip_from_world * vec4f(p_world, 1.0), p_world, vec3f(0.0, 1.0, 0.0), vec3f(0.22, 0.42, 0.14));
}

@fragment
fn fs_blade(s: Surface) -> @location(0) vec4f {
    // As if it were the ground that is lit, on both sides: grass is thin, and light comes through.
    return lit(s, s.normal);
}
