// Light without shadow, as KHR_lights_punctual defines it.

// Inverse-square falloff, 1 / m^2, that fades to nothing at `range_m`; a range of 0 means that it never does.
fn umbrage_falloff(distance_m: f32, range_m: f32) -> f32 {
    let share = distance_m / max(range_m, 1e-30);
    let fade = select(1.0, clamp(1.0 - share * share * share * share, 0.0, 1.0), range_m > 0.0);
    return fade / max(distance_m * distance_m, 1e-30);
}

// 1 inside the inner cone, 0 outside the outer one. `cos_angle` is the cosine between the light's direction and the way
// from the light to the surface. The caller precomputes `scale = 1 / max(1e-3, cos_inner - cos_outer)` and
// `offset = -cos_outer * scale`.
fn umbrage_cone(cos_angle: f32, scale: f32, offset: f32) -> f32 {
    let share = clamp(cos_angle * scale + offset, 0.0, 1.0);
    return share * share;
}
