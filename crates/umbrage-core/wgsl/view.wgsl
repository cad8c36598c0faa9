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
}
