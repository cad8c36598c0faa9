// A receiver moved along its normal before it is looked up (Holbert 2011, "Saying Goodbye to Shadow Acne"), and towards the
// light. Engines differ in how the way along the normal follows the angle between normal and light: by its sine, by 1 - its
// cosine, or not at all; and in whether the way towards the light is in metres or in widths of a texel (docs/bias.md). `towards`
// is the unit vector to the light, `normal` a unit vector.
fn umbrage_offset_by_normal(view: UmbrageView, p_world: vec3f, normal: vec3f, towards: vec3f) -> vec3f {
    let along = dot(transpose(view.texture_from_world)[3], vec4f(p_world, 1.0));
    let texel_m = view.texel_m * select(1.0, along, view.perspective != 0u);
    let cosine = saturate(dot(normal, towards));
    let laws = vec3f(sqrt(1.0 - cosine * cosine), 1.0, 1.0 - cosine);
    let normal_m = dot(view.offset_texel.xyz, laws) * texel_m;
    let towards_m = view.offset_texel.w * texel_m + view.depth_m;
    return p_world + normal * normal_m + towards * towards_m;
}
