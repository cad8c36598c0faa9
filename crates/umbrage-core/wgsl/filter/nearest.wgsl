// One comparison with the texel that holds the receiver: 1 lit, 0 shadow, stairs in between (Williams 1978).
fn umbrage_filter_nearest(map: UmbrageMap, point: sampler, view: UmbrageView, at: UmbrageTexel) -> f32 {
    let place = at.uv / view.texel_uv - 0.5;
    let corner = floor(place);
    let past = place - corner;
    let stored = umbrage_gather(map, point, view, corner);
    let taps = umbrage_compare(view, at, stored, vec4f(0.0, 1.0, 1.0, 0.0) - past.x, vec4f(1.0, 1.0, 0.0, 0.0) - past.y);
    let upper = select(taps.lit.w, taps.lit.z, past.x >= 0.5);
    let lower = select(taps.lit.x, taps.lit.y, past.x >= 0.5);
    return select(upper, lower, past.y >= 0.5);
}
