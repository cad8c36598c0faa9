// Sways what stands on the ground, more the higher it is: for `umbrage render --deform examples/wgsl/sway.wgsl --deform-reach 0.6`.
fn umbrage_deform(p_world: vec3f, p_object: vec3f, time_s: f32) -> vec3f {
    let phase = 1.7 * time_s + 0.8 * p_world.x + 0.5 * p_world.z;
    let lean = 0.05 * p_world.y * p_world.y;
    return p_world + vec3f(lean * sin(phase), 0.0, lean * cos(phase));
}
