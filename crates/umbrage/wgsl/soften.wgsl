// Blurs V along rows or columns of the screen, across pixels of one surface only.

struct Soften {
    // z and w of the third, then of the fourth row of clip_from_view.
    rows: vec4f,
    // (1, 0) or (0, 1).
    step: vec2i,
    // How wide an edge becomes, pixels; counts where `width_m` is 0.
    width_px: f32,
    // The same on the surface, metres.
    width_m: f32,
    // Pixels that a metre takes where clip space's w is 1.
    px_per_m: f32,
    // See `umbrage_is_like_depth`.
    like: f32,
    // Depth where nothing is.
    nothing: f32,
    pad: f32,
}

const MOST_PX = 64.0;

@group(0) @binding(0) var<uniform> soften: Soften;
@group(0) @binding(1) var source: texture_2d<f32>;
@group(0) @binding(2) var depth: texture_depth_2d;

@vertex
fn vs_screen(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.5, 1.0);
}

@fragment
fn fs_soften(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let at = vec2i(position.xy);
    let last = vec2i(textureDimensions(depth)) - 1;
    let here = textureLoad(depth, at, 0);
    let v = textureLoad(source, at, 0).r;
    if here == soften.nothing {
        return vec4f(v);
    }
    let w = -soften.rows.z * umbrage_eye_depth(soften.rows, here) + soften.rows.w;
    let width_px = select(soften.width_px, soften.width_m * soften.px_per_m / w, soften.width_m > 0.0);
    let radius = 0.5 * min(width_px, MOST_PX);
    let before = textureLoad(depth, clamp(at - soften.step, vec2i(0), last), 0);
    let after = textureLoad(depth, clamp(at + soften.step, vec2i(0), last), 0);
    let slope = umbrage_depth_slope(before, here, after);
    // A tent: an edge becomes a smooth ramp as wide as the tent.
    var sum = v;
    var weights = 1.0;
    for (var i = 1; f32(i) < radius; i++) {
        let weight = 1.0 - f32(i) / radius;
        for (var side = -1; side <= 1; side += 2) {
            let there = at + side * i * soften.step;
            if any(there < vec2i(0)) || any(there > last) {
                continue;
            }
            let found = textureLoad(depth, there, 0);
            let foretold = here + f32(side * i) * slope;
            if found != soften.nothing && umbrage_is_like_depth(soften.rows, foretold, found, soften.like) {
                sum += weight * textureLoad(source, there, 0).r;
                weights += weight;
            }
        }
    }
    return vec4f(sum / weights);
}
