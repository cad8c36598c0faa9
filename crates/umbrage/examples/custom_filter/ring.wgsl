// The kernel of a ring light, such as photographers hang around their lens: the weights lie on a ring as wide as the filter, so a
// thin post throws a double shadow.
fn umbrage_kernel(view: UmbrageView, right: vec4f, down: vec4f) -> vec4f {
    let radius_texel = 0.5 * view.width_texel - 1.0;
    let away_texel = sqrt(right * right + down * down);
    // Slides over the texels without steps: each weighs less towards both rims.
    return clamp(vec4f(2.0) - abs(away_texel - radius_texel), vec4f(0.0), vec4f(1.0));
}
