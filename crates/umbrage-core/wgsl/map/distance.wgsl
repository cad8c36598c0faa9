// A map that is a float texture with the distance from the light, as a share of the way from near to far.

alias UmbrageMap = texture_2d_array<f32>;

// The depths of the four texels around a corner of the grid, `corner` being the upper left one, in the order of
// `textureGather`: lower left, lower right, upper right, upper left. `point` must be a nearest sampler that clamps.
fn umbrage_gather(map: UmbrageMap, point: sampler, view: UmbrageView, corner: vec2f) -> vec4f {
    let share = textureGather(0, map, point, (corner + 1.0) * view.texel_uv, view.layer);
    return vec4f(
        umbrage_depth_from_share(view, share.x), umbrage_depth_from_share(view, share.y),
        umbrage_depth_from_share(view, share.z), umbrage_depth_from_share(view, share.w),
    );
}
