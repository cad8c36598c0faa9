// A bell of `width_texel`: a quadratic B-spline in each direction, near a Gaussian, and 0 at its edge.

// Weights of texels whose centres lie so far from the receiver, right and down, in texels.
fn umbrage_kernel(view: UmbrageView, right: vec4f, down: vec4f) -> vec4f {
    let scale = 3.0 / (view.width_texel + 1.0);
    return umbrage_bell(right * scale) * umbrage_bell(down * scale);
}

fn umbrage_bell(x: vec4f) -> vec4f {
    let far = max(vec4f(1.5) - abs(x), vec4f(0.0));
    let near = max(vec4f(0.5) - abs(x), vec4f(0.0));
    return 0.5 * far * far - 1.5 * near * near;
}
