// Blades as a light's map sees them. `blades.wgsl` stands before this.

// The start of `CasterView` of Umbrage's `wgsl/caster.wgsl`: all that is needed here.
struct CasterView {
    clip_from_world: mat4x4f,
}

@group(0) @binding(0) var<uniform> view: CasterView;

@vertex
fn vs(@builtin(vertex_index) corner: u32, blade: Blade) -> @builtin(position) vec4f {
    return view.clip_from_world * vec4f(blade_corner(blade, corner), 1.0);
}
