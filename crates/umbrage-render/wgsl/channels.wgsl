// The channels of a map that is a colour target, as they are stored.

@fragment
fn fs_channels(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let here = map_pixel(position);
    let texel = vec2u(clamp(here.corner, vec2f(0.0), vec2f(textureDimensions(maps)) - 1.0));
    let stored = textureLoad(maps, texel, here.view.layer, 0);
    return select(BESIDE_THE_MAP, vec4f(stored.rgb, 1.0), here.inside);
}
