// Which pixels are on one surface: blurs along rows and columns stop where that ends.

// Distance from the eye along its axis, metres, of a stored depth. `rows` are the third and fourth row of `clip_from_view`,
// their z and w: a perspective's or a parallel eye's.
fn umbrage_eye_depth(rows: vec4f, stored: f32) -> f32 {
    // stored = (rows.x * z + rows.y) / (rows.z * z + rows.w), and the eye looks along -z.
    return -(rows.y - stored * rows.w) / (stored * rows.z - rows.x);
}

// Planes are linear in stored depth over the screen, so a neighbour's depth can be foretold from the slope here: of both
// sides' differences that which is less, because a surface may end on one of them.
fn umbrage_depth_slope(before: f32, here: f32, after: f32) -> f32 {
    let down = here - before;
    let up = after - here;
    return select(up, down, abs(down) < abs(up));
}

// Are two depths of one surface? `like` is how far they may be apart as a share of the distance.
fn umbrage_is_like_depth(rows: vec4f, foretold: f32, found: f32, like: f32) -> bool {
    let a_m = umbrage_eye_depth(rows, foretold);
    let b_m = umbrage_eye_depth(rows, found);
    return abs(a_m - b_m) <= like * abs(a_m);
}
