// One view of a light, as its map was drawn. Mirrors `umbrage_core::layout::GpuView`; a test compares the two.
struct UmbrageView {
    // World space to texture space: after division by w, xy is the place in the map (0..1, rows down) and z the depth
    // that the map stores. Carries the uniform bias, if there is one.
    texture_from_world: mat4x4f,
    // Which layer of the map array.
    layer: u32,
    // Width of a texel in uv: 1 / size.
    texel_uv: f32,
    // Width of a texel at distance 1 m (cone) or at any distance (parallel light), metres.
    texel_m: f32,
    // 1: texels grow with distance, 0: they do not.
    perspective: u32,
    // Where the map begins and ends along the light's axis, metres.
    near_m: f32,
    far_m: f32,
    // How far the stored depth may be off: a step of the format, a share of the depth itself, and a step of the linear
    // share of the distance where that is what is stored.
    step_depth: f32,
    step_relative: f32,
    step_share: f32,
    // Width of the filter, texels.
    width_texel: f32,
    // Margin of the receiver's plane, widths of a texel (see `compare/plane`).
    margin_texel: f32,
    // How far a receiver is moved towards the light, metres (see `bias/normal`).
    depth_m: f32,
    // Where the light is; of no use for parallel light.
    origin: vec3f,
    // 1: the map is warped towards the eye, so depth does not tell distance by near and far alone.
    warped: u32,
    // How far a receiver is moved, widths of a texel (see `bias/normal`): along its normal times the sine of normal and light,
    // along its normal at any angle, along its normal times 1 - their cosine, and towards the light.
    offset_texel: vec4f,
}

// Which way stored depth grows: 1 away from the light, -1 towards it (reversed). `umbrage_core::DEPTH` says the same, and
// a test compares them; in a renderer of your own whose depth is in a depth texture, this is the line to change. `share.wgsl`, which
// maps with distance in colours need, is written for reversed depth.
const UMBRAGE_AWAY = -1.0;
