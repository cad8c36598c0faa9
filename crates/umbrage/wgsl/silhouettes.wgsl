// Writes the faces of a shadow volume: two triangles for each silhouette edge, and lids where they are asked for. Index 2 i is
// the mesh's vertex i where it is, 2 i + 1 the same far away.

@group(0) @binding(0) var<uniform> caster: VolumeCaster;
// Draw arguments (index count, instances, first index, base vertex, first instance), then silhouette edges and lids: eight
// numbers a caster.
@group(0) @binding(1) var<storage, read_write> counts: array<atomic<u32>>;
@group(0) @binding(2) var<storage, read_write> indices: array<u32>;
// Corners a, b, c, and 1 where both sides cast.
@group(1) @binding(0) var<storage, read> triangles: array<vec4u>;
@group(1) @binding(1) var<storage, read> planes: array<vec4f>;
// Ends a, b, the triangle that runs from a to b, and the one that runs back or NOTHING.
@group(1) @binding(2) var<storage, read> edges: array<vec4u>;

const NOTHING = 0xffffffffu;

var<workgroup> wanted: atomic<u32>;
var<workgroup> sides: atomic<u32>;
var<workgroup> start: u32;

fn faces(triangle: u32) -> i32 {
    return select(0, 1, umbrage_faces_light(planes[triangle], caster.light_object));
}

// How often an edge is part of the outline, and, below 0, that it runs from b to a.
fn multiplicity(edge: vec4u) -> i32 {
    let left = faces(edge.z);
    if edge.w == NOTHING {
        return 2 * left - 1;
    }
    let twice = (caster.flags & BOTH_SIDES) != 0u || triangles[edge.z].w != 0u;
    return (left - faces(edge.w)) * select(1, 2, twice);
}

@compute @workgroup_size(64)
fn silhouettes(
    @builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let lids = (caster.flags & (NEAR_CAPS | FAR_CAPS)) != 0u;
    let item = id.y * groups.x * 64u + id.x;
    let is_edge = item < caster.edges;
    let triangle = item - caster.edges;
    let is_triangle = !is_edge && lids && triangle < caster.triangles;

    // 1. What this item becomes.
    var quads = 0u;
    var a = 0u;
    var b = 0u;
    var c = 0u;
    var count = 0u;
    var runs_back = false;
    let of_quad = select(6u, 3u, (caster.flags & ENDS_IN_A_POINT) != 0u);
    if is_edge {
        let edge = edges[item];
        let times = multiplicity(edge);
        quads = u32(abs(times));
        runs_back = times < 0;
        a = select(edge.y, edge.x, times > 0);
        b = select(edge.x, edge.y, times > 0);
        count = quads * of_quad;
    } else if is_triangle {
        let corners = triangles[triangle];
        let twice = (caster.flags & BOTH_SIDES) != 0u || corners.w != 0u;
        let front = faces(triangle) == 1;
        if front || twice {
            // Turned by its first two corners, so that a rasteriser which turns triangles the same way finds the same depths.
            a = select(corners.y, corners.x, front);
            b = select(corners.x, corners.y, front);
            c = corners.z;
            count = select(0u, 3u, (caster.flags & NEAR_CAPS) != 0u) + select(0u, 3u, (caster.flags & FAR_CAPS) != 0u);
        }
    }

    // 2. Room for all of the group at once.
    var at = 0u;
    if count > 0u {
        at = atomicAdd(&wanted, count);
    }
    if quads > 0u {
        atomicAdd(&sides, quads);
    }
    workgroupBarrier();
    if local == 0u {
        let all = atomicLoad(&wanted);
        if all > 0u {
            start = atomicAdd(&counts[caster.first_count], all);
            atomicAdd(&counts[caster.first_count + 5u], atomicLoad(&sides));
        }
    }
    workgroupBarrier();
    at += caster.first_index + start;

    // 3. The faces, counter-clockwise seen from outside. They begin at the corner that `split.rs` begins at, and so get the same depths:
    // at `a` where the edge runs as it is, far from `b` where it runs back; what is there twice is once cut along the other diagonal.
    for (var i = 0u; i < quads; i++) {
        let near = vec2u(2u * a, 2u * b);
        let far = near + 1u;
        var first = vec3u(near.x, far.x, far.y);
        var second = vec3u(near.x, far.y, near.y);
        if runs_back {
            first = vec3u(far.y, near.x, far.x);
            second = vec3u(far.y, near.y, near.x);
        }
        if i == 1u {
            first = select(vec3u(near.x, far.x, near.y), vec3u(far.x, near.y, near.x), runs_back);
            second = select(vec3u(near.y, far.x, far.y), vec3u(far.y, near.y, far.x), runs_back);
        }
        // Parallel light without end: both far ends are one place, and a triangle is all.
        if of_quad == 3u {
            first = select(vec3u(near.x, far.x, near.y), vec3u(far.y, near.y, near.x), runs_back);
        }
        indices[at] = first.x;
        indices[at + 1u] = first.y;
        indices[at + 2u] = first.z;
        if of_quad == 6u {
            indices[at + 3u] = second.x;
            indices[at + 4u] = second.y;
            indices[at + 5u] = second.z;
        }
        at += of_quad;
    }
    if is_triangle && count > 0u {
        atomicAdd(&counts[caster.first_count + 6u], 1u);
        if (caster.flags & NEAR_CAPS) != 0u {
            indices[at] = 2u * a;
            indices[at + 1u] = 2u * b;
            indices[at + 2u] = 2u * c;
            at += 3u;
        }
        if (caster.flags & FAR_CAPS) != 0u {
            indices[at] = 2u * b + 1u;
            indices[at + 1u] = 2u * a + 1u;
            indices[at + 2u] = 2u * c + 1u;
        }
    }
}
