// Draws translucent casters: what they let through of the light, or where the nearest of them is. Comes after `caster.wgsl`.

struct Pane {
    @builtin(position) position: vec4f,
    @location(0) uv: vec2f,
    // What the texture is multiplied by, linear.
    @location(1) color: vec4f,
}

@vertex
fn vs_pane(@location(0) p_object: vec3f, instance: Instance, @location(4) uv: vec2f, @location(5) color: vec4f) -> Pane {
    return Pane(clip_position(p_object, instance), uv, color);
}

// What goes through. Where that is all, to the last step of the map, there is no caster.
fn through(in: Pane) -> vec3f {
    let base = in.color * textureSample(base_color, base_sampler, in.uv);
    let share = umbrage_light_through(base.rgb, base.a);
    if all(share >= vec3f(254.5 / 255.0)) {
        discard;
    }
    return share;
}

// The blend state multiplies what is there by it.
@fragment
fn fs_pane(in: Pane) -> @location(0) vec4f {
    return vec4f(through(in), 1.0);
}

@fragment
fn fs_pane_depth(in: Pane) {
    _ = through(in);
}

@fragment
fn fs_pane_distance(in: Pane) -> @location(0) vec4f {
    let slope = vec2f(dpdx(in.position.z), dpdy(in.position.z));
    _ = through(in);
    return umbrage_caster_color(in.position.z, slope);
}
