// Faces of volumes, added up: all of them in the first channel, and in the second those that the stencil counts, up or down.

// Are faces seen from outside counted up, and the others down?
override FRONT_COUNTS_UP: bool = true;

@fragment
fn fs_faces() -> @location(0) vec4f {
    return vec4f(1.0, 0.0, 0.0, 0.0);
}

@fragment
fn fs_count(@builtin(front_facing) front: bool) -> @location(0) vec4f {
    return vec4f(0.0, select(-1.0, 1.0, front == FRONT_COUNTS_UP), 0.0, 0.0);
}
