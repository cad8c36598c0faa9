// What a translucent surface lets through of the light.

// Of opacity 0 all of it, of opacity 1 nothing; in between light is dimmed by the opacity and tinted towards the surface's
// colour as far as it is opaque. `color` is linear; both are of the place that the ray hits: texture and vertex colour count.
fn umbrage_light_through(color: vec3f, alpha: f32) -> vec3f {
    let a = saturate(alpha);
    return (1.0 - a) * mix(vec3f(1.0), saturate(color), a);
}
