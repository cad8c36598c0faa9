// What every pass of the reference renderer knows: the frame, its lights, their maps and slides.

struct Frame {
    clip_from_world: mat4x4f,
    world_from_clip: mat4x4f,
    // Where the eye is, or (0, 0, 0) and the direction to it for a parallel camera, see `eye_w`.
    eye: vec3f,
    // 1: `eye` is a place, 0: it is the direction towards the eye.
    eye_w: f32,
    // Light that comes from everywhere, exposed.
    ambient: vec3f,
    // Share of the diffuse light that stays in shadow, 0..1.
    fill: f32,
    light_count: u32,
    // The light that the debug views show.
    shown_light: u32,
    exposure: f32,
    // What deforming surfaces know of time.
    time_s: f32,
}

struct Light {
    // Lookup matrix of the slide: the whole cone, whatever the map's projection is.
    slide_from_world: mat4x4f,
    position: vec3f,
    // DIRECTIONAL, POINT or SPOT.
    kind: u32,
    direction: vec3f,
    // Metres, 0: endless.
    range_m: f32,
    // Linear RGB times intensity times exposure.
    color: vec3f,
    // Index of its first view in `views`, or -1: no map.
    view: i32,
    cone_scale: f32,
    cone_offset: f32,
    cos_outer: f32,
    // Layer of the slides, or -1: none.
    slide: i32,
    near_m: f32,
    far_m: f32,
    // Places on the light from which it is seen, each with one view or, of a point light, six.
    places: u32,
    // Its masks: how many, times 65536, and the first.
    masks: u32,
}

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> lights: array<Light, MAX_LIGHTS>;
// VIEWS_HERE
@group(0) @binding(3) var maps: UmbrageMap;
@group(0) @binding(4) var map_compare: sampler_comparison;
@group(0) @binding(5) var slides: texture_2d_array<f32>;
@group(0) @binding(6) var slide_sampler: sampler;
// V that was found elsewhere or on the screen, a layer a light; read only by shaders that are made for it.
@group(0) @binding(7) var given_v: texture_2d_array<f32>;
@group(0) @binding(8) var map_point: sampler;
// The nearest translucent casters, and what all of them let through; read only where light is coloured.
@group(0) @binding(9) var translucent_maps: UmbrageMap;
@group(0) @binding(10) var light_colors: texture_2d_array<f32>;

// The pixel that is shaded.
var<private> at_pixel: vec2u;
