// Draws the faces of shadow volumes, which nobody sees: the stencil counts them.

@group(0) @binding(0) var<uniform> caster: VolumeCaster;
@group(0) @binding(1) var<uniform> clip_from_world: mat4x4f;
// Three numbers a vertex.
@group(1) @binding(0) var<storage, read> positions: array<f32>;

// Depth must be that of the lit surfaces to the last bit, so a place is transformed as they are: by rows, then by the matrix.
struct Drawn {
    @builtin(position) @invariant position: vec4f,
}

fn drawn(p_object: vec3f, is_far: bool) -> Drawn {
    let p = vec4f(p_object, 1.0);
    let p_world = vec3f(dot(caster.row_x, p), dot(caster.row_y, p), dot(caster.row_z, p));
    let end = umbrage_extrude(p_world, caster.light_world, caster.inset_m, caster.extrude_m, caster.far_plane, is_far);
    return Drawn(clip_from_world * end);
}

// Faces that `silhouettes.wgsl` wrote.
@vertex
fn vs_quads(@builtin(vertex_index) index: u32) -> Drawn {
    let at = 3u * (index >> 1u);
    return drawn(vec3f(positions[at], positions[at + 1u], positions[at + 2u]), (index & 1u) == 1u);
}

// Split edges: what faces away moves away.
@vertex
fn vs_split(@builtin(vertex_index) index: u32, @location(0) p_object: vec3f, @location(1) plane: vec4f) -> Drawn {
    let is_back = index >= caster.first_back;
    let turned = select(plane, -plane, is_back);
    let faces = umbrage_faces_light(turned, caster.light_object) != is_back;
    return drawn(p_object, faces == (caster.reversed == 1u));
}

// Covers the picture.
@vertex
fn vs_screen(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.5, 1.0);
}

// Where the stencil counted nothing the light is seen.
@fragment
fn fs_lit() -> @location(0) vec4f {
    return vec4f(1.0);
}
