// One sun, surfaces without gloss. The library's text stands before this; the lines that use it are marked.

struct Frame {
    clip_from_world: mat4x4f,
    map_from_world: mat4x4f,
    to_sun: vec4f,
    shadow: UmbrageView, // shadow
}

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var map: texture_depth_2d_array; // shadow
@group(0) @binding(2) var point: sampler; // shadow

struct Surface {
    @builtin(position) position: vec4f,
    @location(0) p_world: vec3f,
    @location(1) normal: vec3f,
    @location(2) color: vec3f,
}

// The map's pass: depth is all that it draws.
@vertex
fn vs_map(@location(0) p_world: vec3f) -> @builtin(position) vec4f {
    return frame.map_from_world * vec4f(p_world, 1.0);
}

@vertex
fn vs_forward(@location(0) p_world: vec3f, @location(1) normal: vec4f, @location(2) color: vec4f) -> Surface {
    return Surface(frame.clip_from_world * vec4f(p_world, 1.0), p_world, normal.xyz, color.rgb);
}

@fragment
fn fs_forward(s: Surface) -> @location(0) vec4f {
    // The triangle's own normal: the smooth one would tell the lookup of a slope that the map does not have.
    let at = umbrage_locate(frame.shadow, s.p_world, cross(dpdx(s.p_world), dpdy(s.p_world))); // shadow
    let v = select(1.0, umbrage_filter_kernel(map, point, frame.shadow, at), at.inside); // shadow
    let sun = max(dot(normalize(s.normal), frame.to_sun.xyz), 0.0);
    return vec4f(s.color * (0.2 + 0.8 * v * sun), 1.0);
}
