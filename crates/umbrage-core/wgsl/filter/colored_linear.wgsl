// `umbrage_filter_linear` with coloured light. Blocked or not, and coloured or not, is settled for each texel before they are
// blended: an opaque frame around a pane then has no bright seam. `translucent` holds the nearest translucent casters, `colors`
// what all of them let through.
fn umbrage_filter_colored_linear(
    map: UmbrageMap, translucent: UmbrageMap, colors: UmbrageColorMap, point: sampler, view: UmbrageView, at: UmbrageTexel,
) -> vec3f {
    let place = at.uv / view.texel_uv - 0.5;
    let corner = floor(place);
    let right = vec4f(0.0, 1.0, 1.0, 0.0) + (corner.x - place.x);
    let down = vec4f(1.0, 1.0, 0.0, 0.0) + (corner.y - place.y);
    let taps = umbrage_compare(view, at, umbrage_gather(map, point, view, corner), right, down);
    let tinted = umbrage_compare(view, at, umbrage_gather(translucent, point, view, corner), right, down);
    let weight = taps.weight * tinted.weight * (1.0 - abs(right)) * (1.0 - abs(down));
    return weight * umbrage_tinted(taps, tinted, umbrage_gather_colors(colors, point, view, corner))
        / dot(weight, vec4f(1.0));
}
