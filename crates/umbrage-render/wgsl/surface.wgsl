// A visible surface, and how it fits into one texel of the G-buffer.

struct Surface {
    // World space, interpolated and bent by the normal map. Unit length, towards the viewer's side.
    shading_normal: vec3f,
    // The triangle's own, on the same side. Unit length.
    normal: vec3f,
    // Linear.
    base_color: vec3f,
    // Blinn: colour of the highlight. Else: metallic in x.
    specular: vec3f,
    // Blinn: log2(shininess) / 16. Else: perceptual roughness.
    gloss: f32,
    // BLINN, UNLIT.
    flags: u32,
}

// Octahedral unit vector (Cigolle and others 2014, "A Survey of Efficient Representations for Independent Unit Vectors").
fn pack_normal(n: vec3f) -> u32 {
    let p = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
    let folded = (1.0 - abs(p.yx)) * select(vec2f(-1.0), vec2f(1.0), p >= vec2f(0.0));
    return pack2x16snorm(select(folded, p, n.z >= 0.0));
}

fn unpack_normal(packed: u32) -> vec3f {
    let p = unpack2x16snorm(packed);
    let z = 1.0 - abs(p.x) - abs(p.y);
    let t = max(-z, 0.0);
    return normalize(vec3f(p + select(vec2f(t), vec2f(-t), p >= vec2f(0.0)), z));
}

// Base colour is kept as its square root: 8 bits then suffice for the eye.
fn pack_surface(s: Surface) -> vec4u {
    let flags = f32(s.flags) / 255.0;
    return vec4u(
        pack_normal(s.shading_normal),
        pack4x8unorm(vec4f(sqrt(s.base_color), flags)),
        pack4x8unorm(vec4f(s.specular, s.gloss)),
        pack_normal(s.normal),
    );
}

fn unpack_surface(texel: vec4u) -> Surface {
    let base = unpack4x8unorm(texel.y);
    let answer = unpack4x8unorm(texel.z);
    return Surface(
        unpack_normal(texel.x),
        unpack_normal(texel.w),
        base.rgb * base.rgb,
        answer.rgb,
        answer.a,
        u32(base.a * 255.0 + 0.5),
    );
}
