// Distance from the light as a share of the way from near (0) to far (1), and the depth that a depth buffer would hold. Of maps
// that are warped towards the eye, the share is depth turned round: it tells order, not distance.

// Stored depth (reversed: near 1, far 0) of a share.
fn umbrage_depth_from_share(view: UmbrageView, share: f32) -> f32 {
    let cone = view.near_m * (1.0 - share) / (view.near_m + share * (view.far_m - view.near_m));
    return select(1.0 - share, cone, view.perspective != 0u && view.warped == 0u);
}

// The inverse.
fn umbrage_share_from_depth(view: UmbrageView, depth: f32) -> f32 {
    let cone = view.near_m * (1.0 - depth) / (view.near_m + depth * (view.far_m - view.near_m));
    return select(1.0 - depth, cone, view.perspective != 0u && view.warped == 0u);
}

// How much the stored depth changes for a change of the share, at a depth; above 0.
fn umbrage_depth_per_share(view: UmbrageView, depth: f32) -> f32 {
    let away_m = view.near_m + umbrage_share_from_depth(view, depth) * (view.far_m - view.near_m);
    let cone = view.near_m * view.far_m / (away_m * away_m);
    return select(1.0, cone, view.perspective != 0u && view.warped == 0u);
}
