// Vertices of the scene to surfaces. Variants by `override`, so that a plain mesh pays for no texture.

override HAS_BASE_TEXTURE = false;
override HAS_METALLIC_ROUGHNESS_TEXTURE = false;
override HAS_NORMAL_TEXTURE = false;
override HAS_EMISSIVE_TEXTURE = false;
override IS_CUT_OUT = false;
override IS_DOUBLE_SIDED = false;
// It receives no shadow.
override IS_EXEMPT = false;

struct Material {
    base_color: vec4f,
    // Blinn: colour of the highlight. Else: metallic in x.
    specular: vec3f,
    // Blinn: log2(shininess) / 16. Else: perceptual roughness.
    gloss: f32,
    emissive: vec3f,
    cutoff: f32,
    normal_scale: f32,
    flags: u32,
    // Two bits a texture, which set of coordinates: base, metallic-roughness, normal, emissive.
    uv_sets: u32,
    pad: u32,
    // uv = (dot(x, (uv, 1)), dot(y, (uv, 1))): two rows a texture.
    uv_rows: array<vec4f, 8>,
}

@group(1) @binding(0) var<uniform> material: Material;
@group(1) @binding(1) var base_texture: texture_2d<f32>;
@group(1) @binding(2) var base_sampler: sampler;
@group(1) @binding(3) var metallic_roughness_texture: texture_2d<f32>;
@group(1) @binding(4) var metallic_roughness_sampler: sampler;
@group(1) @binding(5) var normal_texture: texture_2d<f32>;
@group(1) @binding(6) var normal_sampler: sampler;
@group(1) @binding(7) var emissive_texture: texture_2d<f32>;
@group(1) @binding(8) var emissive_sampler: sampler;

struct Instance {
    // Rows of the affine world_from_object.
    @location(1) row_x: vec4f,
    @location(2) row_y: vec4f,
    @location(3) row_z: vec4f,
    // OBJECT_ATTRIBUTE
}

fn world_position(p_object: vec3f, i: Instance) -> vec3f {
    let p = vec4f(p_object, 1.0);
    let p_world = vec3f(dot(i.row_x, p), dot(i.row_y, p), dot(i.row_z, p));
    return umbrage_deform(p_world, p_object, frame.time_s);
}

fn world_direction(d: vec3f, i: Instance) -> vec3f {
    return vec3f(dot(i.row_x.xyz, d), dot(i.row_y.xyz, d), dot(i.row_z.xyz, d));
}

// Normals go by the cofactors of the matrix: the inverse transpose up to a factor, right for any scale and for mirrors.
fn world_normal(n: vec3f, i: Instance) -> vec3f {
    let x = i.row_x.xyz;
    let y = i.row_y.xyz;
    let z = i.row_z.xyz;
    let mirrored = sign(dot(x, cross(y, z)));
    return mirrored * vec3f(dot(cross(y, z), n), dot(cross(z, x), n), dot(cross(x, y), n));
}

struct PlainVertex {
    // The same bits in every pass that draws the same surface: volumes and masks are laid over its depth.
    @builtin(position) @invariant position: vec4f,
    @location(0) p_world: vec3f,
    @location(1) normal: vec3f,
    // OBJECT_VARYING
}

@vertex
fn vs_plain(@location(0) p_object: vec3f, i: Instance, @location(4) normal: vec3f) -> PlainVertex {
    var out: PlainVertex;
    out.p_world = world_position(p_object, i);
    out.position = frame.clip_from_world * vec4f(out.p_world, 1.0);
    out.normal = world_normal(normal, i);
    // OBJECT_OUT
    return out;
}

struct FullVertex {
    @builtin(position) @invariant position: vec4f,
    @location(0) p_world: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv: vec4f,
    @location(3) color: vec4f,
    @location(4) tangent: vec4f,
    // OBJECT_VARYING
}

@vertex
fn vs_full(
    @location(0) p_object: vec3f, i: Instance, @location(4) normal: vec3f,
    @location(5) uv: vec4f, @location(6) color: vec4f, @location(7) tangent: vec4f,
) -> FullVertex {
    var out: FullVertex;
    out.p_world = world_position(p_object, i);
    out.position = frame.clip_from_world * vec4f(out.p_world, 1.0);
    out.normal = world_normal(normal, i);
    out.uv = uv;
    out.color = color;
    out.tangent = vec4f(world_direction(tangent.xyz, i), tangent.w);
    // OBJECT_OUT
    return out;
}

fn texture_uv(slot: u32, uv: vec4f) -> vec2f {
    let chosen = select(uv.xy, uv.zw, ((material.uv_sets >> (2u * slot)) & 3u) == 1u);
    let p = vec3f(chosen, 1.0);
    return vec2f(dot(material.uv_rows[2u * slot].xyz, p), dot(material.uv_rows[2u * slot + 1u].xyz, p));
}

// What is solid of a surface, and what it sends out itself.
struct Fragment {
    surface: Surface,
    emissive: vec3f,
    alpha: f32,
}

// `front` is what the rasteriser says; a surface that may be seen from behind turns its normals to the viewer.
fn plain_surface(p_world: vec3f, normal: vec3f, front: bool) -> Fragment {
    var s: Surface;
    let turn = select(1.0, -1.0, IS_DOUBLE_SIDED && !front);
    s.shading_normal = normalize(normal) * turn;
    // Neighbouring pixels of a triangle span its plane. A triangle too thin for that has the shading's normal.
    let across = cross(dpdx(p_world), dpdy(p_world));
    let length2 = dot(across, across);
    s.normal = select(s.shading_normal, across * inverseSqrt(max(length2, 1e-38)), length2 > 1e-38);
    s.normal *= select(-1.0, 1.0, dot(s.normal, s.shading_normal) >= 0.0);
    s.flags = material.flags | select(0u, EXEMPT, IS_EXEMPT);
    s.base_color = material.base_color.rgb;
    s.specular = material.specular;
    s.gloss = material.gloss;
    return Fragment(s, material.emissive, material.base_color.a);
}

fn full_surface(in: FullVertex, front: bool) -> Fragment {
    var f = plain_surface(in.p_world, in.normal, front);
    f.surface.base_color *= in.color.rgb;
    f.alpha *= in.color.a;
    if HAS_BASE_TEXTURE {
        let texel = textureSample(base_texture, base_sampler, texture_uv(0u, in.uv));
        f.surface.base_color *= texel.rgb;
        f.alpha *= texel.a;
    }
    if HAS_METALLIC_ROUGHNESS_TEXTURE {
        let texel = textureSample(metallic_roughness_texture, metallic_roughness_sampler, texture_uv(1u, in.uv));
        f.surface.gloss *= texel.g;
        f.surface.specular.x *= texel.b;
    }
    if HAS_NORMAL_TEXTURE {
        let texel = textureSample(normal_texture, normal_sampler, texture_uv(2u, in.uv)).xyz * 2.0 - 1.0;
        let turn = select(1.0, -1.0, IS_DOUBLE_SIDED && !front);
        let n = f.surface.shading_normal;
        // MikkTSpace: the interpolated frame is used as it is, not made orthogonal.
        let t = in.tangent.xyz * turn;
        let b = cross(n, t) * in.tangent.w;
        let bent = texel.x * material.normal_scale * t + texel.y * material.normal_scale * b + texel.z * n;
        let length2 = dot(bent, bent);
        if length2 > 1e-12 && dot(t, t) > 1e-12 {
            f.surface.shading_normal = bent * inverseSqrt(length2);
        }
    }
    if HAS_EMISSIVE_TEXTURE {
        f.emissive *= textureSample(emissive_texture, emissive_sampler, texture_uv(3u, in.uv)).rgb;
    }
    return f;
}

fn cut_out(alpha: f32) {
    if IS_CUT_OUT && alpha < material.cutoff {
        discard;
    }
}

struct Gbuffer {
    @location(0) surface: vec4u,
    // OBJECT_TARGET
}

@fragment
fn fs_gbuffer_plain(in: PlainVertex, @builtin(front_facing) front: bool) -> Gbuffer {
    var out: Gbuffer;
    out.surface = pack_surface(plain_surface(in.p_world, in.normal, front).surface);
    // OBJECT_KEPT
    return out;
}

@fragment
fn fs_gbuffer_full(in: FullVertex, @builtin(front_facing) front: bool) -> Gbuffer {
    let f = full_surface(in, front);
    cut_out(f.alpha);
    var out: Gbuffer;
    out.surface = pack_surface(f.surface);
    // OBJECT_KEPT
    return out;
}

@fragment
fn fs_forward_plain(in: PlainVertex, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    let f = plain_surface(in.p_world, in.normal, front);
    at_pixel = vec2u(in.position.xy);
    // OBJECT_AT
    return vec4f(shade(f.surface, in.p_world) + f.emissive * frame.exposure, f.alpha);
}

@fragment
fn fs_forward_full(in: FullVertex, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    let f = full_surface(in, front);
    cut_out(f.alpha);
    at_pixel = vec2u(in.position.xy);
    // OBJECT_AT
    return vec4f(shade(f.surface, in.p_world) + f.emissive * frame.exposure, f.alpha);
}
