// Four comparisons that the hardware blends by how near each texel's centre is (Reeves, Salesin and Cook 1987). All four are
// compared with the same depth, so the bias must not depend on the texel. `compare` must be a linear comparison sampler: the
// hardware then compares first and blends afterwards.
fn umbrage_filter_linear_hardware(
    map: texture_depth_2d_array, compare: sampler_comparison, view: UmbrageView, at: UmbrageTexel,
) -> f32 {
    return textureSampleCompareLevel(map, compare, at.uv, view.layer, at.depth);
}
