// EXPERIMENT

// `right` and `down`: from the receiver to each texel's centre, texels.
fn umbrage_compare(view: UmbrageView, at: UmbrageTexel, stored: vec4f, right: vec4f, down: vec4f) -> UmbrageTaps {
    // Heights above the receiver, towards the light, in widths of a texel.
    let height = (at.depth - stored) * (UMBRAGE_AWAY / at.unit);
    let plane = (at.slope.x * right + at.slope.y * down) * (-UMBRAGE_AWAY / at.unit);
    let distance = sqrt(right * right + down * down);
    let noise = at.noise / at.unit;
    let steep = (abs(at.slope.x) + abs(at.slope.y)) / at.unit;
    let above_plane = height - plane > vec4f(view.constant + noise + 0.01 * steep);
    let own = height > vec4f(view.normal_texel + noise);
    let cone = height > view.normal_texel + noise + view.cone * max(distance - view.anchor, vec4f(0.0));
    let blocked = above_plane & own;
    let unsure = blocked & !cone;
    return UmbrageTaps(
        select(vec4f(1.0), vec4f(0.0), blocked),
        select(vec4f(1.0), vec4f(0.0), unsure),
        height,
    );
}

const UMBRAGE_NARROWS = true;

fn umbrage_counts(view: UmbrageView, taps: UmbrageTaps, right: vec4f, down: vec4f, blocker: f32) -> vec4f {
    let rise = mix(taps.height, vec4f(blocker), taps.lit);
    let distance = sqrt(right * right + down * down);
    return select(vec4f(0.0), vec4f(1.0), rise >= view.cone * distance);
}
