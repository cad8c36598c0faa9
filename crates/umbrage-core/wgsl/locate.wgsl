// Where in a map a point is, how deep, and how the depth changes along the surface around it.

struct UmbrageTexel {
    // Place in the map, 0..1, rows down.
    uv: vec2f,
    // What the map would store for this point, clamped to 0..1: beyond near and far it counts as on them.
    depth: f32,
    // In front of the light and inside the map. Behind the light the division shows a phantom, the point mirrored
    // through the light (Everitt, Rege and Cebenoyan 2001, "Advantages and Limitations"): never lit by this view.
    inside: bool,
    // The side of the surface that `normal` points to faces the light.
    faces: bool,
    // How much the stored depth changes from one texel to the next along the surface's plane, right and down.
    slope: vec2f,
    // How much it changes over a step towards the light that is as long as a texel is wide here; above 0.
    unit: f32,
    // How far `depth` may be off by rounding, the map's and the point's.
    noise: f32,
}

// `normal` is the surface's own (not bent, not interpolated) in world space, of any length. But for `faces`, its sign is of no
// matter.
fn umbrage_locate(view: UmbrageView, p_world: vec3f, normal: vec3f) -> UmbrageTexel {
    let rows = transpose(view.texture_from_world);
    let p = vec4f(p_world, 1.0);
    let w = dot(rows[3], p);
    let per_w = 1.0 / max(w, 1e-30);
    let divided = vec3f(dot(rows[0], p), dot(rows[1], p), dot(rows[2], p)) * per_w;
    let inside = w > 0.0 && all(divided.xy >= vec2f(0.0)) && all(divided.xy <= vec2f(1.0));
    // How u, v and depth change for each metre, in world space. The division is projective: a plane of the world is a
    // plane of (u, v, depth), so these tell all of it.
    let u_per_m = (rows[0].xyz - divided.x * rows[3].xyz) * per_w;
    let v_per_m = (rows[1].xyz - divided.y * rows[3].xyz) * per_w;
    let depth_per_m = (rows[2].xyz - divided.z * rows[3].xyz) * per_w;
    // Along the light's ray neither u nor v changes. It points away from the light.
    let ray = cross(u_per_m, v_per_m);
    let ray_length = max(length(ray), 1e-30);
    // A surface seen edge-on has no slope; what is this close to it is taken for steep.
    let n = normalize(normal);
    let along = dot(n, ray);
    let facing = select(-1.0, 1.0, along >= 0.0) * max(abs(along), 1e-4 * ray_length);
    let slope_uv = vec2f(dot(n, cross(depth_per_m, v_per_m)), dot(n, cross(u_per_m, depth_per_m))) / facing;
    let texel_m = view.texel_uv * inverseSqrt(ray_length);
    let along_ray = abs(dot(depth_per_m, ray)) / ray_length;
    let unit = max(along_ray * texel_m, 1e-30);
    // A point that a rasteriser made is off by some last places of its coordinates.
    let largest_m = max(abs(p_world.x), max(abs(p_world.y), abs(p_world.z)));
    let noise = view.step_depth + view.step_relative * abs(divided.z)
        + umbrage_depth_per_share(view, clamp(divided.z, 0.0, 1.0)) * view.step_share
        + length(depth_per_m) * largest_m * exp2(-21.0);
    return UmbrageTexel(
        divided.xy, clamp(divided.z, 0.0, 1.0), inside, along < 0.0, slope_uv * view.texel_uv, unit, noise,
    );
}
