// Receivers drawn once more for one mask, over V: each takes away what the blocker covers.

struct Receiving {
    clip_from_world: mat4x4f,
    // Place and 1, or the direction towards it and 0.
    eye: vec4f,
    light: vec4f,
    // What deforming receivers know of time.
    time_s: f32,
    pad_0: f32,
    pad_1: f32,
    pad_2: f32,
}

@group(0) @binding(0) var<uniform> receiving: Receiving;
// A dynamic offset picks the mask.
@group(0) @binding(1) var<uniform> mask: UmbrageMask;
@group(0) @binding(2) var masks: texture_2d_array<f32>;
@group(0) @binding(3) var mask_sampler: sampler;

struct Instance {
    @location(1) row_x: vec4f,
    @location(2) row_y: vec4f,
    @location(3) row_z: vec4f,
}

struct Received {
    // The same bits as where the surfaces were drawn, if that was done by the same arithmetic.
    @builtin(position) @invariant position: vec4f,
    @location(0) p_world: vec3f,
}

@vertex
fn vs_receiver(@location(0) p_object: vec3f, i: Instance) -> Received {
    let p = vec4f(p_object, 1.0);
    let at_rest = vec3f(dot(i.row_x, p), dot(i.row_y, p), dot(i.row_z, p));
    let p_world = umbrage_deform(at_rest, p_object, receiving.time_s);
    return Received(receiving.clip_from_world * vec4f(p_world, 1.0), p_world);
}

// How much the blocker covers here. Neighbouring pixels of a triangle span its plane; its normal is on the eye's side.
fn coverage(p_world: vec3f) -> f32 {
    let across = cross(dpdx(p_world), dpdy(p_world));
    let to_eye = receiving.eye.xyz - p_world * receiving.eye.w;
    let normal = select(-across, across, dot(across, to_eye) >= 0.0);
    let towards = receiving.light.xyz - p_world * receiving.light.w;
    return umbrage_mask_coverage(masks, mask_sampler, mask, p_world, normal, towards);
}

// A texel of eight bits may be off by half a step.
const WHOLE = 0.998;

// All of the light: what is dark is marked in the stencil, and nothing darkens it again.
@fragment
fn fs_core(in: Received) -> @location(0) vec4f {
    let covered = coverage(in.p_world);
    if covered < WHOLE {
        discard;
    }
    return vec4f(1.0);
}

// A part of it, where the edge of a mask is smooth: the darkest of several counts.
@fragment
fn fs_fringe(in: Received) -> @location(0) vec4f {
    let covered = coverage(in.p_world);
    if covered <= 0.0 {
        discard;
    }
    return vec4f(1.0 - covered);
}

// Over depth of other arithmetic: 1 where depth grows towards the eye, else -1.
override TOWARDS_EYE: f32 = 1.0;
// Some steps of a depth that counts in whole steps; 0 for floats.
override STEPS: f32 = 0.0;

struct Nearer {
    @builtin(frag_depth) depth: f32,
    @location(0) color: vec4f,
}

// The depth of a receiver, moved towards the eye by what another order of operations may have moved the surface there: sixteen
// roundings of its place and the eye's, which grow with their distance from the origin, some of the depth itself, and a sixteenth
// of what its plane's depth changes by from pixel to pixel. A place that is off by a metre is off in depth, z / w, by |row_z - depth
// row_w| / w at most.
fn nearer(position: vec4f, p_world: vec3f) -> f32 {
    let m = receiving.clip_from_world;
    let row_z = vec3f(m[0].z, m[1].z, m[2].z);
    let row_w = vec3f(m[0].w, m[1].w, m[2].w);
    let eye_m = select(abs(m[3].z) / max(length(row_z), 1e-30), length(receiving.eye.xyz), receiving.eye.w > 0.0);
    let off_m = 0x1p-20 * (length(p_world) + eye_m);
    // The position's w is 1 / w here.
    let off = off_m * length(row_z - position.z * row_w) * position.w;
    let steps = 0x1p-20 * position.z + STEPS;
    return saturate(position.z + TOWARDS_EYE * (off + steps + fwidth(position.z) / 16.0));
}

@fragment
fn fs_core_nearer(in: Received) -> Nearer {
    let covered = coverage(in.p_world);
    let depth = nearer(in.position, in.p_world);
    if covered < WHOLE {
        discard;
    }
    return Nearer(depth, vec4f(1.0));
}

@fragment
fn fs_fringe_nearer(in: Received) -> Nearer {
    let covered = coverage(in.p_world);
    let depth = nearer(in.position, in.p_world);
    if covered <= 0.0 {
        discard;
    }
    return Nearer(depth, vec4f(1.0 - covered));
}
