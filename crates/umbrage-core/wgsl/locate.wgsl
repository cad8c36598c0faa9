// Where in a map a point is, and how deep.

struct UmbrageTexel {
    // Place in the map, 0..1, rows down.
    uv: vec2f,
    // What the map would store for this point, clamped to 0..1: beyond near and far it counts as on them.
    depth: f32,
    // In front of the light and inside the map. Behind the light the division shows a phantom, the point mirrored
    // through the light (Everitt, Rege and Cebenoyan 2001, "Advantages and Limitations"): never lit by this view.
    inside: bool,
}

fn umbrage_locate(view: UmbrageView, p_world: vec3f) -> UmbrageTexel {
    let p = view.texture_from_world * vec4f(p_world, 1.0);
    let divided = p.xyz / max(p.w, 1e-30);
    let inside = p.w > 0.0 && all(divided.xy >= vec2f(0.0)) && all(divided.xy <= vec2f(1.0));
    return UmbrageTexel(divided.xy, clamp(divided.z, 0.0, 1.0), inside);
}
