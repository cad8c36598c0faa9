// Percentage-closer filtering with any kernel (Reeves, Salesin and Cook 1987): every texel that the kernel reaches is compared
// on its own, four with each gather, and the comparisons are blended by the kernel's weights. A box makes it the usual PCF.
fn umbrage_filter_kernel(map: UmbrageMap, point: sampler, view: UmbrageView, at: UmbrageTexel) -> f32 {
    let place = at.uv / view.texel_uv - 0.5;
    var lit = 0.0;
    var weight = 0.0;
    var blocker = 1e30;
    if UMBRAGE_NARROWS {
        // The four nearest count by themselves, and say how high above the receiver its blocker is.
        let corner = floor(place);
        let right = vec4f(0.0, 1.0, 1.0, 0.0) + (corner.x - place.x);
        let down = vec4f(1.0, 1.0, 0.0, 0.0) + (corner.y - place.y);
        let taps = umbrage_compare(view, at, umbrage_gather(map, point, view, corner), right, down);
        let weights = taps.weight * (1.0 - abs(right)) * (1.0 - abs(down));
        lit = dot(weights, taps.lit);
        weight = dot(weights, vec4f(1.0));
        let blocked = weights * (1.0 - taps.lit);
        let all_blocked = dot(blocked, vec4f(1.0));
        blocker = select(1e30, dot(blocked, taps.height) / max(all_blocked, 1e-30), all_blocked > 0.0);
    }
    let first = floor(place - 0.5 * (view.width_texel - 1.0));
    let quads = i32(ceil(0.5 * (view.width_texel + 1.0)));
    for (var y = 0; y < quads; y++) {
        for (var x = 0; x < quads; x++) {
            let corner = first + 2.0 * vec2f(f32(x), f32(y));
            let to_corner = corner - place;
            let right = vec4f(0.0, 1.0, 1.0, 0.0) + to_corner.x;
            let down = vec4f(1.0, 1.0, 0.0, 0.0) + to_corner.y;
            let taps = umbrage_compare(view, at, umbrage_gather(map, point, view, corner), right, down);
            let weights = umbrage_counts(view, taps, right, down, blocker) * umbrage_kernel(view, right, down);
            lit += dot(weights, taps.lit);
            weight += dot(weights, vec4f(1.0));
        }
    }
    return lit / max(weight, 1e-30);
}
