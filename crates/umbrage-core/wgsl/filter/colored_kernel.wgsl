// `umbrage_filter_kernel` with coloured light: see there for what narrows it. Opaque and translucent casters narrow it each for
// themselves, and a texel counts where both let it.
fn umbrage_filter_colored_kernel(
    map: UmbrageMap, translucent: UmbrageMap, colors: UmbrageColorMap, point: sampler, view: UmbrageView, at: UmbrageTexel,
) -> vec3f {
    let place = at.uv / view.texel_uv - 0.5;
    var passed = vec3f(0.0);
    var weight = 0.0;
    var blocker = 1e30;
    var tinter = 1e30;
    if UMBRAGE_NARROWS {
        let corner = floor(place);
        let right = vec4f(0.0, 1.0, 1.0, 0.0) + (corner.x - place.x);
        let down = vec4f(1.0, 1.0, 0.0, 0.0) + (corner.y - place.y);
        let taps = umbrage_compare(view, at, umbrage_gather(map, point, view, corner), right, down);
        let tinted = umbrage_compare(view, at, umbrage_gather(translucent, point, view, corner), right, down);
        let weights = taps.weight * tinted.weight * (1.0 - abs(right)) * (1.0 - abs(down));
        passed = weights * umbrage_tinted(taps, tinted, umbrage_gather_colors(colors, point, view, corner));
        weight = dot(weights, vec4f(1.0));
        let blocked = weights * (1.0 - taps.lit);
        let all_blocked = dot(blocked, vec4f(1.0));
        blocker = select(1e30, dot(blocked, taps.height) / max(all_blocked, 1e-30), all_blocked > 0.0);
        let colored = weights * (1.0 - tinted.lit);
        let all_colored = dot(colored, vec4f(1.0));
        tinter = select(1e30, dot(colored, tinted.height) / max(all_colored, 1e-30), all_colored > 0.0);
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
            let tinted = umbrage_compare(view, at, umbrage_gather(translucent, point, view, corner), right, down);
            let weights = umbrage_counts(view, taps, right, down, blocker)
                * umbrage_counts(view, tinted, right, down, tinter) * umbrage_kernel(view, right, down);
            passed += weights * umbrage_tinted(taps, tinted, umbrage_gather_colors(colors, point, view, corner));
            weight += dot(weights, vec4f(1.0));
        }
    }
    return passed / max(weight, 1e-30);
}
