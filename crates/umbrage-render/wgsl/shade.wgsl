// From a surface to a colour.

// Where the eye is seen from `p_world`; unit length.
fn towards_eye(p_world: vec3f) -> vec3f {
    return normalize(frame.eye - p_world * frame.eye_w);
}

// Visibility V of a light from a surface: 0 behind it and outside its cone, else what the technique says. `Seen` is a
// number, or three where light may be coloured on its way.
fn visibility(index: u32, light: Light, s: Surface, p_world: vec3f, towards_light: vec3f) -> Seen {
    let in_cone = light.kind != SPOT || dot(-towards_light, light.direction) >= light.cos_outer;
    if ANY_EXEMPT && (s.flags & EXEMPT) != 0u {
        return Seen(select(0.0, 1.0, in_cone));
    }
    return select(Seen(0.0), visible_share(index, light, p_world, s.normal, towards_light), in_cone);
}

struct Incoming {
    // Unit vector from the surface to the light.
    towards: vec3f,
    // What arrives where nothing is in the way and the surface faces the light; exposed lux, RGB.
    illuminance: vec3f,
}

fn incoming(light: Light, p_world: vec3f) -> Incoming {
    var arriving = Incoming(-light.direction, light.color);
    if ANY_PLACED && light.kind != DIRECTIONAL {
        let offset = light.position - p_world;
        let distance_m = length(offset);
        arriving.towards = offset / max(distance_m, 1e-30);
        let cone = umbrage_cone(dot(-arriving.towards, light.direction), light.cone_scale, light.cone_offset);
        arriving.illuminance *= umbrage_falloff(distance_m, light.range_m) * select(1.0, cone, light.kind == SPOT);
    }
    if ANY_SLIDE && light.slide >= 0 {
        arriving.illuminance *=
            umbrage_cookie(slides, slide_sampler, u32(light.slide), light.slide_from_world, p_world);
    }
    return arriving;
}

const PI = 3.14159265359;

// Diffuse and specular reflectance for one direction of light, each times the cosine and without visibility.
struct Answer {
    diffuse: vec3f,
    specular: vec3f,
}

// glTF 2.0, appendix B: Lambert and GGX with Smith's height-correlated masking and Schlick's Fresnel.
fn answer_metallic_roughness(s: Surface, n_dot_l: f32, l: vec3f, v: vec3f) -> Answer {
    let metallic = s.specular.x;
    let f0 = mix(vec3f(0.04), s.base_color, metallic);
    let alpha = max(s.gloss * s.gloss, 1e-3);
    let a2 = alpha * alpha;
    let h = normalize(l + v);
    let n_dot_v = max(dot(s.shading_normal, v), 1e-4);
    let n_dot_h = saturate(dot(s.shading_normal, h));
    let v_dot_h = saturate(dot(v, h));
    let d = n_dot_h * n_dot_h * (a2 - 1.0) + 1.0;
    let ggx = a2 / (PI * d * d);
    let smith = 0.5 / (n_dot_l * sqrt(n_dot_v * n_dot_v * (1.0 - a2) + a2) + n_dot_v * sqrt(n_dot_l * n_dot_l * (1.0 - a2) + a2));
    let m = 1.0 - v_dot_h;
    let m2 = m * m;
    let fresnel = f0 + (1.0 - f0) * (m2 * m2 * m);
    let diffuse = (1.0 - fresnel) * (1.0 - metallic) * s.base_color / PI;
    return Answer(diffuse * n_dot_l, fresnel * (ggx * smith * n_dot_l));
}

// Lambert and Blinn (Blinn 1977); the same 1 / pi as above, so that both answer alike to the same light.
fn answer_blinn(s: Surface, n_dot_l: f32, l: vec3f, v: vec3f) -> Answer {
    let n_dot_h = saturate(dot(s.shading_normal, normalize(l + v)));
    let highlight = pow(n_dot_h, exp2(s.gloss * 16.0));
    return Answer(s.base_color * (n_dot_l / PI), s.specular * (highlight * n_dot_l / PI));
}

// What one light adds to a surface.
fn lit_by(index: u32, light: Light, s: Surface, p_world: vec3f, v: vec3f) -> vec3f {
    let arriving = incoming(light, p_world);
    let n_dot_l = dot(s.shading_normal, arriving.towards);
    if n_dot_l <= 0.0 {
        return vec3f(0.0);
    }
    var answer: Answer;
    if ANY_METALLIC_ROUGHNESS {
        answer = answer_metallic_roughness(s, n_dot_l, arriving.towards, v);
    }
    if ANY_BLINN {
        let blinn = answer_blinn(s, n_dot_l, arriving.towards, v);
        if !ANY_METALLIC_ROUGHNESS || (s.flags & BLINN) != 0u {
            answer = blinn;
        }
    }
    let seen = visibility(index, light, s, p_world, arriving.towards);
    return arriving.illuminance * (answer.diffuse * mix(Seen(frame.fill), Seen(1.0), seen) + answer.specular * seen);
}

// Colour of a surface under all lights, exposed, not clamped.
fn shade(s: Surface, p_world: vec3f) -> vec3f {
    // Ambient light: metals give it back in their own colour, everything else in its base colour.
    let color = frame.ambient * s.base_color + lit_by_all(s, p_world, towards_eye(p_world));
    return select(color, s.base_color, (s.flags & UNLIT) != 0u);
}
