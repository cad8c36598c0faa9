// Which of a point light's six tiles looks along a direction.

// Right, left, up, down, back, front: +X, -X, +Y, -Y, +Z, -Z as 0..5, in the order of `umbrage_core::fit`. `from_light` is
// the way from the light to the surface, of any length. Each tile is drawn wider than its face by the filter's reach, so a
// filter never leaves its tile.
fn umbrage_face(from_light: vec3f) -> u32 {
    let size = abs(from_light);
    let x = size.x >= size.y && size.x >= size.z;
    let y = !x && size.y >= size.z;
    let along = select(select(from_light.z, from_light.y, y), from_light.x, x);
    return select(select(4u, 2u, y), 0u, x) + select(0u, 1u, along < 0.0);
}
