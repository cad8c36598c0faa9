// A map of 8-bit channels with the distance from the light in red and green, as a share of the way from near to far: a whole
// number of 2 digits to the base of 256.

alias UmbrageMap = texture_2d_array<f32>;

// The depths of the four texels around a corner of the grid, `corner` being the upper left one, in the order of
// `textureGather`: lower left, lower right, upper right, upper left. `point` must be a nearest sampler that clamps.
fn umbrage_gather(map: UmbrageMap, point: sampler, view: UmbrageView, corner: vec2f) -> vec4f {
    let uv = (corner + 1.0) * view.texel_uv;
    let c0 = round(textureGather(0, map, point, uv, view.layer) * 255.0);
    let c1 = round(textureGather(1, map, point, uv, view.layer) * 255.0);
    let share = (c0 * 256.0 + c1) / 65535.0;
    return vec4f(
        umbrage_depth_from_share(view, share.x), umbrage_depth_from_share(view, share.y),
        umbrage_depth_from_share(view, share.z), umbrage_depth_from_share(view, share.w),
    );
}
