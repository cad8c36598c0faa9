// Passes that cover the screen: light on the G-buffer, and what the documents show beside it.

@group(1) @binding(0) var gbuffer: texture_2d<u32>;
@group(1) @binding(1) var depth: texture_depth_2d;

// One triangle over the whole picture, at the depth of nothing.
@vertex
fn vs_screen(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, DEPTH_CLEAR, 1.0);
}

struct Pixel {
    surface: Surface,
    p_world: vec3f,
}

fn pixel(position: vec4f) -> Pixel {
    let at = vec2u(position.xy);
    let stored = textureLoad(depth, at, 0);
    let uv = position.xy / vec2f(textureDimensions(depth));
    let p = frame.world_from_clip * vec4f(uv.x * 2.0 - 1.0, 1.0 - uv.y * 2.0, stored, 1.0);
    return Pixel(unpack_surface(textureLoad(gbuffer, at, 0)), p.xyz / p.w);
}

@fragment
fn fs_final(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let here = pixel(position);
    at_pixel = vec2u(position.xy);
    return vec4f(shade(here.surface, here.p_world), 1.0);
}

// V of the shown light; 0 on surfaces that face away from it. Where nothing is it stays 1.
@fragment
fn fs_visibility(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let here = pixel(position);
    at_pixel = vec2u(position.xy);
    let index = frame.shown_light;
    let light = lights[index];
    let arriving = incoming(light, here.p_world);
    let facing = dot(here.surface.shading_normal, arriving.towards) > 0.0;
    let seen = visibility(index, light, views[max(light.view, 0)], here.p_world, arriving.towards);
    return vec4f(vec3f(select(Seen(0.0), seen, facing)), 1.0);
}

// Distance from near (0) to far (1) along the light's axis.
fn share_of_depth(light: Light, along_m: f32) -> f32 {
    return saturate((along_m - light.near_m) / max(light.far_m - light.near_m, 1e-30));
}

// From what the map stores (reversed) to metres along the light's axis.
fn along_m(light: Light, stored: f32, perspective: bool) -> f32 {
    let parallel = light.far_m - stored * (light.far_m - light.near_m);
    let cone = light.near_m * light.far_m / max(light.near_m + stored * (light.far_m - light.near_m), 1e-30);
    return select(parallel, cone, perspective);
}

// Each surface's own distance from the light.
@fragment
fn fs_distance(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let here = pixel(position);
    let light = lights[frame.shown_light];
    let view = views[max(light.view, 0)];
    let at = umbrage_locate(view, here.p_world);
    let share = share_of_depth(light, along_m(light, at.depth, view.perspective != 0u));
    return vec4f(vec3f(select(1.0, share, at.inside)), 1.0);
}

// The map projected on the scene: what the light saw on the way to each surface.
@fragment
fn fs_projected(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let here = pixel(position);
    let light = lights[frame.shown_light];
    let view = views[max(light.view, 0)];
    let at = umbrage_locate(view, here.p_world);
    let texel = vec2u(saturate(at.uv) * vec2f(textureDimensions(maps)));
    let stored = textureLoad(maps, min(texel, textureDimensions(maps) - 1u), view.layer, 0);
    let share = share_of_depth(light, along_m(light, stored, view.perspective != 0u));
    return vec4f(vec3f(select(1.0, share, at.inside)), 1.0);
}

// The map itself, letter-boxed.
@fragment
fn fs_depth(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let light = lights[frame.shown_light];
    let view = views[max(light.view, 0)];
    let size = vec2f(textureDimensions(depth));
    let side = min(size.x, size.y);
    let uv = (position.xy - 0.5 * (size - side)) / side;
    if any(uv < vec2f(0.0)) || any(uv >= vec2f(1.0)) {
        return vec4f(0.02, 0.02, 0.025, 1.0);
    }
    let stored = textureLoad(maps, vec2u(uv * vec2f(textureDimensions(maps))), view.layer, 0);
    return vec4f(vec3f(share_of_depth(light, along_m(light, stored, view.perspective != 0u))), 1.0);
}
