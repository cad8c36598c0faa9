// What comparing four texels with a receiver gives.

struct UmbrageTaps {
    // 1: the texel does not block the light.
    lit: vec4f,
    // 1: it may be believed without looking at others, 0: it tells nothing.
    weight: vec4f,
    // How far what it holds lies above the receiver, towards the light, in widths of a texel.
    height: vec4f,
}
