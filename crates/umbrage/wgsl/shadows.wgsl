// What a shader asks of a light's shadow. Group, bindings and the lookup of each technique stand before and after this text:
// `Shadows::wgsl` joins them.

struct UmbrageLight {
    // The light's place and 1, or the direction towards it and 0.
    point: vec4f,
    // 1 and the number of the lookup of its maps; 0: it has none.
    lookup: u32,
    // First of its views, how many places it is seen from, and how many views each place has (6: a tile for each face).
    first_view: u32,
    places: u32,
    tiles: u32,
    // First of its masks; in the upper half, how many.
    masks: u32,
    // 1 and its layer of V on the screen; 0: none was found there.
    screen: u32,
    // 1: what lies outside of its map is lit.
    lit_outside: u32,
    pad: u32,
}

// The number of a caster that is not known.
const UMBRAGE_NOBODY = 0xffffffffu;

// The way to a light, of any length.
fn umbrage_towards(light: UmbrageLight, p_world: vec3f) -> vec3f {
    return light.point.xyz - p_world * light.point.w;
}
