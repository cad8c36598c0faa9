// One sun, surfaces without gloss. The lines that are there for the shadow are marked.

struct Globals {
    clip_from_world: mat4x4f,
    to_sun: vec4f,
}

@group(0) @binding(0) var<uniform> globals: Globals;

struct Corner {
    @location(0) p_object: vec3f,
    @location(1) normal: vec3f,
    @location(2) x: vec4f,
    @location(3) y: vec4f,
    @location(4) z: vec4f,
    @location(5) origin: vec4f,
    @location(6) color: vec4f,
}

struct Surface {
    @builtin(position) position: vec4f,
    @location(0) p_world: vec3f,
    @location(1) normal: vec3f,
    @location(2) color: vec3f,
}

@vertex
fn vs(c: Corner) -> Surface {
    let world_from_object = mat4x4f(c.x, c.y, c.z, c.origin);
    let p_world = (world_from_object * vec4f(c.p_object, 1.0)).xyz;
    let normal = (world_from_object * vec4f(c.normal, 0.0)).xyz;
    return Surface(globals.clip_from_world * vec4f(p_world, 1.0), p_world, normal, c.color.rgb);
}

@fragment
fn fs(s: Surface) -> @location(0) vec4f {
    var light = max(dot(normalize(s.normal), globals.to_sun.xyz), 0.0);
    let face = cross(dpdy(s.p_world), dpdx(s.p_world)); // shadow
    light *= umbrage_visibility(0u, s.p_world, face, s.position.xy); // shadow
    return vec4f(s.color * (0.15 + 0.9 * light), 1.0);
}
