// Passes that cover the screen: light on the G-buffer, and what the documents show beside it.

@group(1) @binding(0) var gbuffer: texture_2d<u32>;
@group(1) @binding(1) var depth: texture_depth_2d;
// OBJECT_BINDING

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
    // OBJECT_READ
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
    let seen = visibility(index, light, here.surface, here.p_world, arriving.towards);
    return vec4f(vec3f(select(Seen(0.0), seen, facing)), 1.0);
}

// A surface's grey, 0..1: as it is lit, so that shadows are seen; or as if the eye held a lamp. `at_pixel` is set before.
fn lit_grey(here: Pixel) -> f32 {
    return sqrt(dot(max(shade(here.surface, here.p_world), vec3f(0.0)), vec3f(0.21, 0.72, 0.07)));
}

fn lamp_grey(here: Pixel) -> f32 {
    return 0.8 * saturate(dot(here.surface.shading_normal, towards_eye(here.p_world)));
}

// What lies under the faces of volumes, which are added to the first two channels: in the third 1 for a receiver, which
// faces the light and lies in its reach, in shadow or not, and 2 for another surface; in the fourth its grey.
@fragment
fn fs_volumes(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let here = pixel(position);
    at_pixel = vec2u(position.xy);
    let arriving = incoming(lights[frame.shown_light], here.p_world);
    let facing = min(dot(here.surface.normal, arriving.towards), dot(here.surface.shading_normal, arriving.towards));
    let receives = facing > 0.0 && any(arriving.illuminance > vec3f(0.0)) && (here.surface.flags & UNLIT) == 0u;
    let ground = select(vec2f(2.0, lamp_grey(here)), vec2f(1.0, min(lit_grey(here), 1.0)), receives);
    return vec4f(0.0, 0.0, ground);
}

// The view of the shown light in which a point lies: of the light's first place.
fn shown_view(light: Light, p_world: vec3f) -> UmbrageView {
    let first = u32(max(light.view, 0));
    if light.kind == POINT {
        return views[first + umbrage_face(p_world - views[first].origin)];
    }
    return views[first];
}

// Distance from near (0) to far (1) along the axis of the view.
fn share_of_depth(view: UmbrageView, stored: f32) -> f32 {
    return saturate(umbrage_share_from_depth(view, stored));
}

// Each surface's own distance from the light.
@fragment
fn fs_distance(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let here = pixel(position);
    let light = lights[frame.shown_light];
    let view = shown_view(light, here.p_world);
    let at = umbrage_locate(view, here.p_world, here.surface.normal);
    return vec4f(vec3f(select(1.0, share_of_depth(view, at.depth), at.inside)), 1.0);
}

// The map projected on the scene: what the light saw on the way to each surface.
@fragment
fn fs_projected(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let here = pixel(position);
    let light = lights[frame.shown_light];
    let view = shown_view(light, here.p_world);
    let at = umbrage_locate(view, here.p_world, here.surface.normal);
    let stored = umbrage_gather(maps, map_point, view, floor(at.uv / view.texel_uv)).w;
    return vec4f(vec3f(select(1.0, share_of_depth(view, stored), at.inside)), 1.0);
}

struct MapPixel {
    view: UmbrageView,
    // The texel, as `umbrage_gather` takes it.
    corner: vec2f,
    inside: bool,
}

// The shown light's map, letter-boxed; the six tiles of a point light in two rows.
fn map_pixel(position: vec4f) -> MapPixel {
    let light = lights[frame.shown_light];
    let size = vec2f(textureDimensions(depth));
    let tiles = select(vec2f(1.0), vec2f(3.0, 2.0), light.kind == POINT);
    let side = min(size.x / tiles.x, size.y / tiles.y);
    let place = (position.xy - 0.5 * (size - side * tiles)) / side;
    let inside = all(place >= vec2f(0.0)) && all(place < tiles);
    let tile = vec2u(clamp(floor(place), vec2f(0.0), tiles - 1.0));
    // Right and left, up and down, back and front stand above each other.
    let view = views[u32(max(light.view, 0)) + tile.x * 2u + tile.y];
    return MapPixel(view, floor(fract(place) / view.texel_uv), inside);
}

const BESIDE_THE_MAP = vec4f(0.02, 0.02, 0.025, 1.0);

// The map itself.
@fragment
fn fs_depth(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let here = map_pixel(position);
    let stored = umbrage_gather(maps, map_point, here.view, here.corner).w;
    return select(BESIDE_THE_MAP, vec4f(vec3f(share_of_depth(here.view, stored)), 1.0), here.inside);
}
