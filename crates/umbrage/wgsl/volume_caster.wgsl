// One caster of one light, and from where it is seen. Mirrors `GpuVolumeCaster`.
struct VolumeCaster {
    // Rows of the affine world_from_object.
    row_x: vec4f,
    row_y: vec4f,
    row_z: vec4f,
    // The light's place and 1, or the direction towards it and 0: in the caster's space and in the world's.
    light_object: vec4f,
    light_world: vec4f,
    // Where the volume ends, see `umbrage_extrude`; 0: nowhere.
    far_plane: vec4f,
    // How far behind the surface the volume begins, metres.
    inset_m: f32,
    // How long it is, metres; 0: the plane says.
    extrude_m: f32,
    triangles: u32,
    edges: u32,
    // Where its indices begin in those of the light, and where its counts begin.
    first_index: u32,
    first_count: u32,
    // BOTH_SIDES, NEAR_CAPS, FAR_CAPS, ENDS_IN_A_POINT.
    flags: u32,
    // 1: the mesh's reverse is drawn, see `SplitMesh`.
    reversed: u32,
    // Split edges: from this vertex on they stand for the back of a triangle.
    first_back: u32,
    pad_x: u32,
    pad_y: u32,
    pad_z: u32,
}

const BOTH_SIDES = 1u;
const NEAR_CAPS = 2u;
const FAR_CAPS = 4u;
const ENDS_IN_A_POINT = 8u;
