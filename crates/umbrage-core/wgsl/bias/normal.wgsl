// A receiver moved along its normal before it is looked up (Holbert 2011, "Saying Goodbye to Shadow Acne"): by `normal_texel`
// widths of a texel where the surface is edge-on to the light, by nothing where it faces it. `towards` is the unit vector to
// the light, `normal` a unit vector.
fn umbrage_offset_by_normal(view: UmbrageView, p_world: vec3f, normal: vec3f, towards: vec3f) -> vec3f {
    let along = dot(transpose(view.texture_from_world)[3], vec4f(p_world, 1.0));
    let texel_m = view.texel_m * select(1.0, along, view.perspective != 0u);
    let cosine = saturate(dot(normal, towards));
    return p_world + normal * (view.normal_texel * texel_m * sqrt(1.0 - cosine * cosine));
}
