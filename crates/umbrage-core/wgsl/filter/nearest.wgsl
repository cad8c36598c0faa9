// One comparison: 1 lit, 0 shadow, stairs in between (Williams 1978). `compare` must be a nearest comparison sampler.
fn umbrage_filter_nearest(
    map: texture_depth_2d_array, compare: sampler_comparison, view: UmbrageView, at: UmbrageTexel,
) -> f32 {
    return textureSampleCompareLevel(map, compare, at.uv, view.layer, at.depth);
}
