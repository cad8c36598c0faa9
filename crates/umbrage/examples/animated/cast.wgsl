// Blades as a light's map sees them. Umbrage's text for casters and `blades.wgsl` stand before this.

@vertex
fn vs(@builtin(vertex_index) corner: u32, blade: Blade) -> @builtin(position) vec4f {
    return umbrage_caster.clip_from_world * vec4f(blade_corner(blade, corner), 1.0);
}

// Where a map keeps distance in colours.
@fragment
fn fs_color(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return umbrage_caster_color(position.z, vec2f(dpdx(position.z), dpdy(position.z)));
}
