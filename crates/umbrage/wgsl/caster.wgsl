// Draws casters into a light's map: depth only, or distance into a colour target.

struct CasterView {
    // World to clip space of the light's view.
    clip_from_world: mat4x4f,
    // Where the map begins and ends, metres from the light.
    near_m: f32,
    far_m: f32,
    // 1: texels grow with distance.
    perspective: u32,
    // Bias of colour targets, which polygon offset does not reach: times the depth slope, and a constant.
    offset_slope: f32,
    offset_depth: f32,
    // What deforming casters know of time.
    time_s: f32,
    pad_0: f32,
    pad_1: f32,
}

// A dynamic offset picks the view.
@group(0) @binding(0) var<uniform> view: CasterView;

// Only for casters that are cut out.
@group(1) @binding(0) var base_color: texture_2d<f32>;
@group(1) @binding(1) var base_sampler: sampler;

// Of a colour target: channels of 8 bits that hold the distance, or 0: one float holds it.
override CHANNELS: u32 = 0u;

struct Instance {
    // Rows of the affine world_from_object.
    @location(1) row_x: vec4f,
    @location(2) row_y: vec4f,
    @location(3) row_z: vec4f,
}

fn clip_position(p_object: vec3f, instance: Instance) -> vec4f {
    let p = vec4f(p_object, 1.0);
    let p_world = vec3f(dot(instance.row_x, p), dot(instance.row_y, p), dot(instance.row_z, p));
    return view.clip_from_world * vec4f(umbrage_deform(p_world, p_object, view.time_s), 1.0);
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

// The distance along the light's axis that a stored depth stands for, as a share of the way from near to far.
fn share_of_depth(depth: f32) -> f32 {
    let cone = view.near_m * (1.0 - depth) / (view.near_m + depth * (view.far_m - view.near_m));
    return select(1.0 - depth, cone, view.perspective != 0u);
}

// What a colour target holds for a depth of which `slope` is the change to the next texel.
fn color(depth: f32, slope: vec2f) -> vec4f {
    let steepest = max(abs(slope.x), abs(slope.y));
    let pushed = clamp(depth + AWAY * (view.offset_slope * steepest + view.offset_depth), 0.0, 1.0);
    let share = share_of_depth(pushed);
    if CHANNELS == 0u {
        return vec4f(share, 0.0, 0.0, 1.0);
    }
    // A whole number of so many digits to the base of 256. The first digits are taken off one by one, so that no number
    // is larger than a float holds exactly.
    let steps = select(select(16777215.0, 65535.0, CHANNELS == 2u), 255.0, CHANNELS == 1u);
    let number = floor(share * steps + 0.5);
    let low = number - 256.0 * floor(number / 256.0);
    let middle = floor(number / 256.0) - 256.0 * floor(number / 65536.0);
    let high = floor(number / 65536.0);
    let digits = select(select(vec3f(high, middle, low), vec3f(middle, low, 0.0), CHANNELS == 2u), vec3f(low, 0.0, 0.0), CHANNELS == 1u);
    return vec4f(digits / 255.0, 1.0);
}

@fragment
fn fs_cut_out(in: CutOut) {
    cut_out(in.uv_alpha);
}

@fragment
fn fs_solid_color(in: Solid) -> @location(0) vec4f {
    return color(in.position.z, vec2f(dpdx(in.position.z), dpdy(in.position.z)));
}

@fragment
fn fs_cut_out_color(in: CutOut) -> @location(0) vec4f {
    let slope = vec2f(dpdx(in.position.z), dpdy(in.position.z));
    cut_out(in.uv_alpha);
    return color(in.position.z, slope);
}
