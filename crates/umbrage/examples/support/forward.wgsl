// Any number of lights, surfaces without gloss. `Shadows::wgsl(1)` stands before this.

struct Lamp {
    // Where it is, and its range in metres; towards a sun, and 0.
    place: vec4f,
    // Where it shines to, and the cosine of its cone's outer angle.
    beam: vec4f,
    // What arrives a metre away, or of a sun, and the cosine of the inner angle.
    color: vec4f,
    // Number of its shadow.
    number: vec4u,
}

struct Globals {
    clip_from_world: mat4x4f,
    ambient: vec3f,
    count: u32,
    lamps: array<Lamp, 64>,
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
    // Scales differ along axes, so normals need the inverse transpose: its columns are cross products of ours.
    let normal = mat3x3f(cross(c.y.xyz, c.z.xyz), cross(c.z.xyz, c.x.xyz), cross(c.x.xyz, c.y.xyz)) * c.normal;
    return Surface(globals.clip_from_world * vec4f(p_world, 1.0), p_world, normal, c.color.rgb);
}

// What a lamp throws at a surface that it sees.
fn arrives(lamp: Lamp, to_lamp: vec3f, normal: vec3f) -> vec3f {
    let towards = normalize(to_lamp);
    let facing = max(dot(normal, towards), 0.0);
    if lamp.place.w == 0.0 {
        return lamp.color.rgb * facing;
    }
    let cone = smoothstep(lamp.beam.w, lamp.color.w, dot(-towards, lamp.beam.xyz));
    let far = length(to_lamp) / lamp.place.w;
    let fades = clamp(1.0 - far * far * far * far, 0.0, 1.0);
    return lamp.color.rgb * facing * cone * fades / dot(to_lamp, to_lamp);
}

@fragment
fn fs(s: Surface, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    return lit(s, select(-1.0, 1.0, front) * normalize(s.normal));
}

fn lit(s: Surface, normal: vec3f) -> vec4f {
    // The triangle's own normal: maps know nothing of smooth ones.
    let face = cross(dpdy(s.p_world), dpdx(s.p_world));
    var sum = globals.ambient;
    for (var i = 0u; i < globals.count; i++) {
        let lamp = globals.lamps[i];
        let to_lamp = lamp.place.xyz - s.p_world * select(0.0, 1.0, lamp.place.w > 0.0);
        let light = arrives(lamp, to_lamp, normal);
        // Most lamps do not reach most surfaces: then nothing has to be looked up.
        if any(light > vec3f(0.0)) {
            sum += light * umbrage_visibility(lamp.number.x, s.p_world, face, s.position.xy);
        }
    }
    return vec4f(s.color * sum, 1.0);
}
