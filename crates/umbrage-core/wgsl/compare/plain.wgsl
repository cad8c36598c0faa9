// Texels compared with the receiver's own depth. Any bias stands in the map or in the lookup.

// `right` and `down`: from the receiver to each texel's centre, texels.
fn umbrage_compare(view: UmbrageView, at: UmbrageTexel, stored: vec4f, right: vec4f, down: vec4f) -> UmbrageTaps {
    let behind = (at.depth - stored) * UMBRAGE_AWAY;
    return UmbrageTaps(select(vec4f(0.0), vec4f(1.0), behind <= vec4f(0.0)), vec4f(1.0), behind / at.unit);
}

// Does a wide filter become narrow where blocker and receiver are close?
const UMBRAGE_NARROWS = false;

// Which of the texels count in a wide filter: all.
fn umbrage_counts(view: UmbrageView, taps: UmbrageTaps, right: vec4f, down: vec4f, blocker: f32) -> vec4f {
    return vec4f(1.0);
}
