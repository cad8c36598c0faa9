// One end of a shadow volume. `light` is the light's place and 1, or the direction towards it and 0.

// Does the front of a triangle face the light? `plane` and `light` are in one space; what is edge-on does not.
fn umbrage_faces_light(plane: vec4f, light: vec4f) -> bool {
    return dot(plane, light) > 0.0;
}

// Where a caster's point begins to darken, or where that ends: homogeneous, world space. `inset_m` is how far behind the
// surface the volume begins; `extrude_m` how long it is. Where that is 0 it ends on `far_plane`, which all of the light's rays
// through the caster meet behind it; and where that is 0 too, nowhere: w is then 0, and the end is a direction.
fn umbrage_extrude(
    p_world: vec3f, light_world: vec4f, inset_m: f32, extrude_m: f32, far_plane: vec4f, is_far: bool,
) -> vec4f {
    let away = p_world * light_world.w - light_world.xyz;
    if is_far && extrude_m <= 0.0 {
        let speed = dot(far_plane.xyz, away);
        let before = dot(far_plane, vec4f(p_world, 1.0));
        return select(vec4f(away, 0.0), vec4f(p_world * speed - away * before, speed), any(far_plane.xyz != vec3f(0.0)));
    }
    let moved_m = inset_m + select(0.0, extrude_m, is_far);
    if moved_m <= 0.0 {
        return vec4f(p_world, 1.0);
    }
    return vec4f(p_world + away * (moved_m * inverseSqrt(max(dot(away, away), 1e-38))), 1.0);
}
