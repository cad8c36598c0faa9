// Runs the user's function once for each vertex of an instance.

struct Told {
    // Rows of the affine world_from_object.
    row_x: vec4f,
    row_y: vec4f,
    row_z: vec4f,
    // Seconds in x.
    time: vec4f,
}

@group(0) @binding(0) var<uniform> told: Told;
@group(0) @binding(1) var<storage, read_write> vertices: array<vec4f>;

@compute @workgroup_size(64)
fn move_vertices(@builtin(global_invocation_id) id: vec3u) {
    let i = id.x + id.y * 1024u * 64u;
    if i >= arrayLength(&vertices) {
        return;
    }
    let p = vec4f(vertices[i].xyz, 1.0);
    let p_world = vec3f(dot(told.row_x, p), dot(told.row_y, p), dot(told.row_z, p));
    vertices[i] = vec4f(umbrage_deform(p_world, p.xyz, told.time.x), 1.0);
}
