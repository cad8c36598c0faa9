// Draws casters into a light's map: depth only.

// World to clip space of the light's view. A dynamic offset picks the view.
@group(0) @binding(0) var<uniform> clip_from_world: mat4x4f;

// Only for casters that are cut out.
@group(1) @binding(0) var base_color: texture_2d<f32>;
@group(1) @binding(1) var base_sampler: sampler;

struct Instance {
    // Rows of the affine world_from_object.
    @location(1) row_x: vec4f,
    @location(2) row_y: vec4f,
    @location(3) row_z: vec4f,
}

fn clip_position(p_object: vec3f, instance: Instance) -> vec4f {
    let p = vec4f(p_object, 1.0);
    let p_world = vec3f(dot(instance.row_x, p), dot(instance.row_y, p), dot(instance.row_z, p));
    return clip_from_world * vec4f(p_world, 1.0);
}

@vertex
fn vs_solid(@location(0) p_object: vec3f, instance: Instance) -> @builtin(position) vec4f {
    return clip_position(p_object, instance);
}

struct CutOut {
    @builtin(position) position: vec4f,
    // Texture coordinates, and what the texture's alpha is multiplied by so that 1 is the cutoff.
    @location(0) uv_alpha: vec3f,
}

@vertex
fn vs_cut_out(@location(0) p_object: vec3f, instance: Instance, @location(4) uv_alpha: vec3f) -> CutOut {
    return CutOut(clip_position(p_object, instance), uv_alpha);
}

@fragment
fn fs_cut_out(in: CutOut) {
    if textureSample(base_color, base_sampler, in.uv_alpha.xy).a * in.uv_alpha.z < 1.0 {
        discard;
    }
}
