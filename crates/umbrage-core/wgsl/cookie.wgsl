// A slide in front of a light (Bjorke 2005, "Shadowing Strategies for HLSL and FX Composer": the slide projector).

// The colour that the slide lets through towards `p_world`; black outside of it and behind the light.
// `texture_from_world` is a lookup matrix whose frustum the slide fills.
fn umbrage_cookie(
    slide: texture_2d_array<f32>, linear: sampler, layer: u32, texture_from_world: mat4x4f, p_world: vec3f,
) -> vec3f {
    let p = texture_from_world * vec4f(p_world, 1.0);
    let uv = p.xy / max(p.w, 1e-30);
    let inside = p.w > 0.0 && all(uv >= vec2f(0.0)) && all(uv <= vec2f(1.0));
    return select(vec3f(0.0), textureSampleLevel(slide, linear, uv, layer, 0.0).rgb, inside);
}
