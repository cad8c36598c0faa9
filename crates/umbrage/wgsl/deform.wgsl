// Casters that nobody deforms. A renderer's own function of this name moves vertices, for maps and pictures alike.
fn umbrage_deform(p_world: vec3f, p_object: vec3f, time_s: f32) -> vec3f {
    return p_world;
}
