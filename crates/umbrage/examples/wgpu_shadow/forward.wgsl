// Two lamps without falloff. `Shadows::wgsl(1)` stands before this.

struct Scene {
    clip_from_world: mat4x4f,
    lamp_world: array<vec4f, 2>,
    lamp_color: array<vec4f, 2>,
}

@group(0) @binding(0) var<uniform> scene: Scene;

struct Surface {
    @builtin(position) position: vec4f,
    @location(0) p_world: vec3f,
    @location(1) normal: vec3f,
    @location(2) color: vec3f,
}

@vertex
fn vs(
    @location(0) p_object: vec4f, @location(1) normal: vec4f, @location(2) color: vec4f,
    @location(3) x: vec4f, @location(4) y: vec4f, @location(5) z: vec4f, @location(6) origin: vec4f,
) -> Surface {
    let p_world = mat4x3f(x.xyz, y.xyz, z.xyz, origin.xyz) * vec4f(p_object.xyz, 1.0);
    let n_world = mat3x3f(x.xyz, y.xyz, z.xyz) * normal.xyz;
    return Surface(scene.clip_from_world * vec4f(p_world, 1.0), p_world, n_world, color.rgb);
}

@fragment
fn fs(s: Surface) -> @location(0) vec4f {
    var light = vec3f(0.05);
    for (var i = 0u; i < 2u; i++) {
        let seen = umbrage_visibility(i, s.p_world, s.normal, s.position.xy);
        let towards = normalize(scene.lamp_world[i].xyz - s.p_world);
        light += seen * max(dot(normalize(s.normal), towards), 0.0) * scene.lamp_color[i].rgb;
    }
    return vec4f(light * s.color, 1.0);
}
