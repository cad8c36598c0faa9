// Four comparisons, blended by how near each texel's centre is (Reeves, Salesin and Cook 1987).
fn umbrage_filter_linear(map: UmbrageMap, point: sampler, view: UmbrageView, at: UmbrageTexel) -> f32 {
    let place = at.uv / view.texel_uv - 0.5;
    let corner = floor(place);
    let past = place - corner;
    let stored = umbrage_gather(map, point, view, corner);
    let right = vec4f(0.0, 1.0, 1.0, 0.0) - past.x;
    let down = vec4f(1.0, 1.0, 0.0, 0.0) - past.y;
    let taps = umbrage_compare(view, at, stored, right, down);
    let weight = taps.weight * (1.0 - abs(right)) * (1.0 - abs(down));
    return dot(weight, taps.lit) / dot(weight, vec4f(1.0));
}
