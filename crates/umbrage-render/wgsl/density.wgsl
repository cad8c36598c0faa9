// Texels per pixel as numbers: square root of the number of texels in a pixel, fewest and most along one direction. The last
// channel says what is there: 0 nothing, above 0 a receiver, below 0 a surface that is none; its size is a grey, 0..1.

// Grey of what has no other.
const LEAST_GREY = 0.004;

fn no_receiver(grey: f32) -> vec4f {
    return vec4f(0.0, 0.0, 0.0, -clamp(grey, LEAST_GREY, 1.0));
}

// A receiver faces the light by more than EDGE_ON_COS and lies in its reach and in its map, in shadow or not. Its grey, and
// that of a surface that is none, are given.
fn density_of(light: Light, view: UmbrageView, s: Surface, p_world: vec3f, grey: f32, other_grey: f32) -> vec4f {
    let towards = incoming(light, p_world).towards;
    let in_cone = light.kind != SPOT || dot(-towards, light.direction) >= light.cos_outer;
    let distance_m = length(light.position - p_world);
    let in_range = light.kind == DIRECTIONAL || light.range_m == 0.0 || distance_m < light.range_m;
    let faces = dot(s.normal, towards) > EDGE_ON_COS && dot(s.shading_normal, towards) > 0.0;
    let inside = umbrage_locate(view, p_world, s.normal).inside;
    if !(in_cone && in_range && faces && inside) || (s.flags & UNLIT) != 0u {
        return no_receiver(other_grey);
    }
    let picture_px = vec2f(textureDimensions(depth));
    let map_texel = vec2f(1.0 / view.texel_uv);
    let found =
        umbrage_density(view.texture_from_world, map_texel, frame.clip_from_world, picture_px, p_world, s.normal);
    return vec4f(found.mean, found.least, found.most, clamp(grey, LEAST_GREY, 1.0));
}

// From the eye.
@fragment
fn fs_density(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let here = pixel(position);
    at_pixel = vec2u(position.xy);
    let light = lights[frame.shown_light];
    let view = shown_view(light, here.p_world);
    return density_of(light, view, here.surface, here.p_world, lit_grey(here), lamp_grey(here));
}

// The place in the world that a map shows at `uv` and depth: where three planes meet.
fn place_in_world(view: UmbrageView, uv: vec2f, stored: f32) -> vec3f {
    let rows = transpose(view.texture_from_world);
    let a = rows[0] - uv.x * rows[3];
    let b = rows[1] - uv.y * rows[3];
    let c = rows[2] - stored * rows[3];
    let bc = cross(b.xyz, c.xyz);
    return -(a.w * bc + b.w * cross(c.xyz, a.xyz) + c.w * cross(a.xyz, b.xyz)) / dot(a.xyz, bc);
}

fn place_in_picture(ndc: vec3f) -> vec3f {
    let p = frame.world_from_clip * vec4f(ndc, 1.0);
    return p.xyz / p.w;
}

struct SeenByEye {
    surface: Surface,
    seen: bool,
}

// What the eye sees at a place, if it sees that place: the surface of a pixel next to it whose plane goes through it. The
// place may be off by `off_m`, and a curved surface leaves its plane by less than a pixel's width.
fn seen_by_eye(p_world: vec3f, off_m: f32) -> SeenByEye {
    var nearest: SeenByEye;
    let clip = frame.clip_from_world * vec4f(p_world, 1.0);
    let ndc = clip.xyz / max(clip.w, 1e-30);
    let size = vec2f(textureDimensions(depth));
    let at_px = vec2f(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y) * size;
    if clip.w <= 0.0 || any(at_px < vec2f(0.0)) || any(at_px >= size) {
        return nearest;
    }
    let pixel_m = length(place_in_picture(ndc + vec3f(2.0 / size.x, 0.0, 0.0)) - place_in_picture(ndc));
    var least_m = 0.5 * pixel_m + off_m;
    for (var i = 0u; i < 4u; i++) {
        let center = floor(at_px - 0.5) + vec2f(f32(i & 1u), f32(i >> 1u)) + 0.5;
        let position = vec4f(clamp(center, vec2f(0.5), size - 0.5), 0.0, 1.0);
        let here = pixel(position);
        let apart_m = abs(dot(p_world - here.p_world, here.surface.normal));
        if textureLoad(depth, vec2u(position.xy), 0) != DEPTH_CLEAR && apart_m <= least_m {
            nearest = SeenByEye(here.surface, true);
            least_m = apart_m;
        }
    }
    return nearest;
}

// From the light: the same numbers in each texel of its map. What the eye does not see is grey, the farther the darker.
@fragment
fn fs_density_light(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let here = map_pixel(position);
    if !here.inside {
        return vec4f(0.0);
    }
    let stored = umbrage_gather(maps, map_point, here.view, here.corner).w;
    if stored == DEPTH_CLEAR {
        return no_receiver(0.0);
    }
    let uv = (here.corner + 0.5) * here.view.texel_uv;
    let p_world = place_in_world(here.view, uv, stored);
    let off_depth = umbrage_locate(here.view, p_world, vec3f(0.0, 1.0, 0.0)).noise;
    let off_m = length(place_in_world(here.view, uv, stored + off_depth) - p_world);
    let at_eye = seen_by_eye(p_world, off_m);
    let other_grey = 0.9 - 0.7 * share_of_depth(here.view, stored);
    if !at_eye.seen {
        return no_receiver(other_grey);
    }
    let light = lights[frame.shown_light];
    let facing = dot(at_eye.surface.shading_normal, incoming(light, p_world).towards);
    return density_of(light, here.view, at_eye.surface, p_world, 0.3 + 0.7 * saturate(facing), other_grey);
}
