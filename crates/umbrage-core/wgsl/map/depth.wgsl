// A map that is a depth texture.

alias UmbrageMap = texture_depth_2d_array;

// The four texels around a corner of the grid, `corner` being the upper left one, in the order of `textureGather`: lower
// left, lower right, upper right, upper left. Beyond the border its own texels go on. `point` must be a nearest sampler
// that clamps.
fn umbrage_gather(map: UmbrageMap, point: sampler, view: UmbrageView, corner: vec2f) -> vec4f {
    return textureGather(map, point, (corner + 1.0) * view.texel_uv, view.layer);
}
