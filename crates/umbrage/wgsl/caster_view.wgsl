// What whoever draws into a light's map has to know of its view. Group 0 holds it; all names begin with `umbrage_`, so that it
// can stand before a shader of one's own (`umbrage::caster::caster_view_wgsl`).

struct UmbrageCasterView {
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
@group(0) @binding(0) var<uniform> umbrage_caster: UmbrageCasterView;

// Of a colour target: channels of 8 bits that hold the distance, or 0: one float holds it.
override UMBRAGE_CHANNELS: u32 = 0u;

// The distance along the light's axis that a stored depth stands for, as a share of the way from near to far.
fn umbrage_share_of_depth(depth: f32) -> f32 {
    let cone = umbrage_caster.near_m * (1.0 - depth) / (umbrage_caster.near_m + depth * (umbrage_caster.far_m - umbrage_caster.near_m));
    return select(1.0 - depth, cone, umbrage_caster.perspective != 0u);
}

// What a colour target holds for a depth of which `slope` is the change to the next texel: `@builtin(position).z`, and its `dpdx` and
// `dpdy`.
fn umbrage_caster_color(depth: f32, slope: vec2f) -> vec4f {
    let steepest = max(abs(slope.x), abs(slope.y));
    let pushed = clamp(depth + UMBRAGE_CASTER_AWAY * (umbrage_caster.offset_slope * steepest + umbrage_caster.offset_depth), 0.0, 1.0);
    let share = umbrage_share_of_depth(pushed);
    if UMBRAGE_CHANNELS == 0u {
        return vec4f(share, 0.0, 0.0, 1.0);
    }
    // A whole number of so many digits to the base of 256. The first digits are taken off one by one, so that no number
    // is larger than a float holds exactly.
    let steps = select(select(16777215.0, 65535.0, UMBRAGE_CHANNELS == 2u), 255.0, UMBRAGE_CHANNELS == 1u);
    let number = floor(share * steps + 0.5);
    let low = number - 256.0 * floor(number / 256.0);
    let middle = floor(number / 256.0) - 256.0 * floor(number / 65536.0);
    let high = floor(number / 65536.0);
    let digits = select(select(vec3f(high, middle, low), vec3f(middle, low, 0.0), UMBRAGE_CHANNELS == 2u), vec3f(low, 0.0, 0.0), UMBRAGE_CHANNELS == 1u);
    return vec4f(digits / 255.0, 1.0);
}
