// A box of `width_texel`, which slides over the texels without steps.

// Weights of texels whose centres lie so far from the receiver, right and down, in texels.
fn umbrage_kernel(view: UmbrageView, right: vec4f, down: vec4f) -> vec4f {
    let edge = vec4f(0.5 * view.width_texel + 0.5);
    return clamp(edge - abs(right), vec4f(0.0), vec4f(1.0)) * clamp(edge - abs(down), vec4f(0.0), vec4f(1.0));
}
