// Texels per pixel: how finely a map samples what a picture shows. The formula of `umbrage_core::density`, in f32.

struct UmbrageDensity {
    // Square root of the number of texels in a pixel.
    mean: f32,
    // Texels along the direction of a pixel in which there are fewest. Below 1 a texel's edges can be seen.
    least: f32,
    // Texels along the direction in which there are most.
    most: f32,
}

// How far a step of a metre along `way_world` from `p_world` goes in the xy of a projection, after the division.
fn umbrage_density_step(here_from_world: mat4x4f, p_world: vec3f, way_world: vec3f) -> vec2f {
    let p = here_from_world * vec4f(p_world, 1.0);
    let d = here_from_world * vec4f(way_world, 0.0);
    // The derivative of x / w.
    return (d.xy - p.xy * (d.w / p.w)) / p.w;
}

// The greatest singular value of the matrix with columns `a` and `b`.
fn umbrage_density_stretch(a: vec2f, b: vec2f) -> f32 {
    let mean = 0.5 * (dot(a, a) + dot(b, b));
    let half_difference = 0.5 * (dot(a, a) - dot(b, b));
    return sqrt(mean + length(vec2f(half_difference, dot(a, b))));
}

// On a surface with `normal_world` (unit length; its sign does not count) at `p_world`. `texture_from_world` is the map's
// lookup matrix (`UmbrageView.texture_from_world`), `map_size_texel` its size; `clip_from_world` is the eye's, and
// `picture_size_px` the picture's. Edge-on to the light `least` is 0; edge-on to the eye all are 1e30.
fn umbrage_density(
    texture_from_world: mat4x4f,
    map_size_texel: vec2f,
    clip_from_world: mat4x4f,
    picture_size_px: vec2f,
    p_world: vec3f,
    normal_world: vec3f,
) -> UmbrageDensity {
    // Any two unit vectors of the plane at right angles will do: the axis that is farthest from the normal gives them.
    let axis = select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), abs(normal_world.x) > 0.7);
    let right = normalize(cross(axis, normal_world));
    let up = cross(normal_world, right);
    let texel_right = umbrage_density_step(texture_from_world, p_world, right) * map_size_texel;
    let texel_up = umbrage_density_step(texture_from_world, p_world, up) * map_size_texel;
    // Clip space is two units wide.
    let px_right = umbrage_density_step(clip_from_world, p_world, right) * 0.5 * picture_size_px;
    let px_up = umbrage_density_step(clip_from_world, p_world, up) * 0.5 * picture_size_px;
    // B * inverse(A), A with the pixels as columns and B with the texels.
    let area_px = px_right.x * px_up.y - px_up.x * px_right.y;
    if !(abs(area_px) > 1e-30) {
        return UmbrageDensity(1e30, 1e30, 1e30);
    }
    let along_x = (texel_right * px_up.y - texel_up * px_right.y) / area_px;
    let along_y = (texel_up * px_right.x - texel_right * px_up.x) / area_px;
    let most = umbrage_density_stretch(along_x, along_y);
    let texels = abs(along_x.x * along_y.y - along_y.x * along_x.y);
    return UmbrageDensity(sqrt(texels), texels / max(most, 1e-30), most);
}
