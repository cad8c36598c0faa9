// Blades of grass out of nothing but a place, a height and a lean each: no mesh says where their corners are.

struct Blade {
    // Root, and height in metres.
    @location(0) root: vec4f,
    // How far the tip leans, and which way the blade is broad.
    @location(1) lean: vec4f,
}

// One of three corners, world space.
fn blade_corner(blade: Blade, corner: u32) -> vec3f {
    let broad = 0.03 * vec3f(blade.lean.w, 0.0, sqrt(max(1.0 - blade.lean.w * blade.lean.w, 0.0)));
    let tip = vec3f(blade.lean.x, blade.root.w, blade.lean.z);
    return blade.root.xyz + select(select(broad, -broad, corner == 1u), tip, corner == 2u);
}
