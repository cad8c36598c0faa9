// Light that translucent casters colour on its way (after Bjorke 2005, "Shadowing Strategies for HLSL and FX Composer").
//
// Beside the map of what blocks light stand two more of the same size: the product of all that translucent casters before it let
// through, and the depth of the nearest of them. What lies behind the nearest is coloured, what lies before it is not. Since colours
// end at the map's own surface, they are right for every surface that stands in the map. A translucent surface between two
// others is coloured by all three.

alias UmbrageColorMap = texture_2d_array<f32>;

// The colours of the four texels around a corner of the grid, in the order of `umbrage_gather`; a column each for red, green and blue.
fn umbrage_gather_colors(colors: UmbrageColorMap, point: sampler, view: UmbrageView, corner: vec2f) -> mat3x4f {
    let uv = (corner + 1.0) * view.texel_uv;
    return mat3x4f(
        textureGather(0, colors, point, uv, view.layer),
        textureGather(1, colors, point, uv, view.layer),
        textureGather(2, colors, point, uv, view.layer),
    );
}

// What arrives through each of the four: `taps` says which are blocked, `tinted` which have a translucent caster before the receiver.
fn umbrage_tinted(taps: UmbrageTaps, tinted: UmbrageTaps, colors: mat3x4f) -> mat3x4f {
    return mat3x4f(
        taps.lit * mix(colors[0], vec4f(1.0), tinted.lit),
        taps.lit * mix(colors[1], vec4f(1.0), tinted.lit),
        taps.lit * mix(colors[2], vec4f(1.0), tinted.lit),
    );
}
