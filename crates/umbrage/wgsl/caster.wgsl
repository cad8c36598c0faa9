// Draws casters into a light's map: depth only, or distance into a colour target. Follows `caster_view.wgsl`.

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
    return umbrage_caster.clip_from_world * vec4f(umbrage_deform(p_world, p_object, umbrage_caster.time_s), 1.0);
}

struct Solid {
    // The same bits in every pass that draws the same caster: see `peel.wgsl`.
    @invariant @builtin(position) position: vec4f,
}

@vertex
fn vs_solid(@location(0) p_object: vec3f, instance: Instance) -> Solid {
    return Solid(clip_position(p_object, instance));
}

struct CutOut {
    @invariant @builtin(position) position: vec4f,
    // Texture coordinates, and what the texture's alpha is multiplied by so that 1 is the cutoff.
    @location(0) uv_alpha: vec3f,
}

@vertex
fn vs_cut_out(@location(0) p_object: vec3f, instance: Instance, @location(4) uv_alpha: vec3f) -> CutOut {
    return CutOut(clip_position(p_object, instance), uv_alpha);
}

fn cut_out(uv_alpha: vec3f) {
    // A texel of eight bits is off by half a step: what is exactly at the cutoff must not be speckled.
    if textureSample(base_color, base_sampler, uv_alpha.xy).a * uv_alpha.z < 0.998 {
        discard;
    }
}

@fragment
fn fs_cut_out(in: CutOut) {
    cut_out(in.uv_alpha);
}

@fragment
fn fs_solid_color(in: Solid) -> @location(0) vec4f {
    return umbrage_caster_color(in.position.z, vec2f(dpdx(in.position.z), dpdy(in.position.z)));
}

@fragment
fn fs_cut_out_color(in: CutOut) -> @location(0) vec4f {
    let slope = vec2f(dpdx(in.position.z), dpdy(in.position.z));
    cut_out(in.uv_alpha);
    return umbrage_caster_color(in.position.z, slope);
}
