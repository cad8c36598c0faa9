// `umbrage_filter_nearest` with coloured light: 1 lit, 0 shadow, for red, green and blue. `translucent` holds the nearest
// translucent casters, `colors` what all of them let through.
fn umbrage_filter_colored_nearest(
    map: UmbrageMap, translucent: UmbrageMap, colors: UmbrageColorMap, point: sampler, view: UmbrageView, at: UmbrageTexel,
) -> vec3f {
    let place = at.uv / view.texel_uv - 0.5;
    let corner = floor(place);
    let past = place - corner;
    let right = vec4f(0.0, 1.0, 1.0, 0.0) - past.x;
    let down = vec4f(1.0, 1.0, 0.0, 0.0) - past.y;
    let taps = umbrage_compare(view, at, umbrage_gather(map, point, view, corner), right, down);
    let tinted = umbrage_compare(view, at, umbrage_gather(translucent, point, view, corner), right, down);
    let passed = umbrage_tinted(taps, tinted, umbrage_gather_colors(colors, point, view, corner));
    let upper = select(vec4f(0.0, 0.0, 0.0, 1.0), vec4f(0.0, 0.0, 1.0, 0.0), past.x >= 0.5);
    let lower = select(vec4f(1.0, 0.0, 0.0, 0.0), vec4f(0.0, 1.0, 0.0, 0.0), past.x >= 0.5);
    return select(upper, lower, past.y >= 0.5) * passed;
}
