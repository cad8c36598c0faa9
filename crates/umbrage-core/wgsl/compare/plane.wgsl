// Texels compared with the receiver's plane at each texel's centre: receiver-plane depth bias (Schuler 2005, "Eliminating
// Surface Acne with Gradient Shadow Mapping"; Isidoro 2006, "Shadow Mapping: GPU-based Tips and Techniques"), from the
// surface's own normal, not from differences between pixels.

// `right` and `down`: from the receiver to each texel's centre, texels.
fn umbrage_compare(view: UmbrageView, at: UmbrageTexel, stored: vec4f, right: vec4f, down: vec4f) -> UmbrageTaps {
    let plane = at.depth + at.slope.x * right + at.slope.y * down;
    let behind = (plane - stored) * UMBRAGE_AWAY;
    return UmbrageTaps(select(vec4f(0.0), vec4f(1.0), behind <= vec4f(at.noise + view.margin_texel * at.unit)), vec4f(1.0), behind / at.unit);
}

// Does a wide filter become narrow where blocker and receiver are close?
const UMBRAGE_NARROWS = false;

// Which of the texels count in a wide filter: all.
fn umbrage_counts(view: UmbrageView, taps: UmbrageTaps, right: vec4f, down: vec4f, blocker: f32) -> vec4f {
    return vec4f(1.0);
}
