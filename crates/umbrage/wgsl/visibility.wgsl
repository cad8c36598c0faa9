// V of one light for every pixel of a depth, for renderers that light later and want nothing of it in their shaders. The library and
// the bindings of group 1 stand before this.

struct Seen {
    world_from_clip: mat4x4f,
    // Depth where nothing is.
    clear_depth: f32,
    pad_0: f32,
    pad_1: f32,
    pad_2: f32,
}

@group(0) @binding(0) var<uniform> seen: Seen;
@group(0) @binding(1) var depth: texture_depth_2d;

struct Screen {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) light: u32,
}

// The light's number is that of the instance.
@vertex
fn vs_screen(@builtin(vertex_index) corner: u32, @builtin(instance_index) light: u32) -> Screen {
    let at = vec2f(f32(corner & 1u), f32(corner >> 1u)) * 4.0 - 1.0;
    return Screen(vec4f(at, 0.0, 1.0), light);
}

fn p_world_at(at: vec2i, size: vec2i) -> vec4f {
    let inside = clamp(at, vec2i(0), size - 1);
    let d = textureLoad(depth, inside, 0);
    let ndc = (vec2f(inside) + 0.5) / vec2f(size) * vec2f(2.0, -2.0) + vec2f(-1.0, 1.0);
    let p = seen.world_from_clip * vec4f(ndc, d, 1.0);
    return vec4f(p.xyz / p.w, d);
}

// From a pixel to its neighbour on the same surface: of two the one whose depth goes on more evenly.
fn step_along(here: vec4f, way: vec2i, at: vec2i, size: vec2i) -> vec3f {
    let after = p_world_at(at + way, size);
    let before = p_world_at(at - way, size);
    let is_after = abs(after.w - here.w) < abs(before.w - here.w);
    let step = select(here.xyz - before.xyz, after.xyz - here.xyz, is_after);
    // At the picture's border there is one neighbour only.
    let at_end = any(at + way >= size);
    let at_start = any(at - way < vec2i(0));
    return select(select(step, after.xyz - here.xyz, at_start), here.xyz - before.xyz, at_end);
}

@fragment
fn fs_visibility(in: Screen) -> @location(0) vec4f {
    let size = vec2i(textureDimensions(depth));
    let at = vec2i(in.position.xy);
    let here = p_world_at(at, size);
    if here.w == seen.clear_depth {
        return vec4f(1.0);
    }
    let across = step_along(here, vec2i(1, 0), at, size);
    let down = step_along(here, vec2i(0, 1), at, size);
    // Rows run down, so that this looks towards the eye.
    let normal = cross(down, across);
    return vec4f(umbrage_visibility_rgb(in.light, here.xyz, normal, in.position.xy), 1.0);
}
