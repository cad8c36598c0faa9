//! The caller's depth: can it be counted over, or read?

use super::ShadowsError;
use super::foreign::is_foreign_depth;

/// Checks a depth of `size_px` pixels; one that is read has to be readable, too.
pub(super) fn check(
    device: &wgpu::Device,
    view: &wgpu::TextureView,
    size_px: [u32; 2],
    is_read: bool,
) -> Result<(), ShadowsError> {
    let texture = view.texture();
    let refuse = |reason: &str| Err(ShadowsError::Buffer { what: "depth", reason: reason.to_owned() });
    if !texture.format().has_depth_aspect() {
        return refuse("its format has no depth; pass the depth that surfaces were drawn with");
    }
    let (has_width, has_height) = (texture.width(), texture.height());
    if [has_width, has_height] != size_px {
        let [width, height] = size_px;
        return Err(ShadowsError::DepthSize { has_width, has_height, width, height });
    }
    if texture.sample_count() != 1 {
        return refuse("it has several samples a pixel; draw a depth with one beside it");
    }
    if is_read && !texture.usage().contains(wgpu::TextureUsages::TEXTURE_BINDING) {
        return refuse("it is read, and was made without TEXTURE_BINDING; add that to its usage");
    }
    // Of a view nobody tells which layer it shows.
    if is_read && (texture.depth_or_array_layers() != 1 || texture.mip_level_count() != 1) {
        return refuse("its texture has several layers or mip levels; pass a texture of one");
    }
    if is_foreign_depth(device, view, texture.format()) {
        return Err(ShadowsError::ForeignDevice { what: "depth" });
    }
    Ok(())
}

/// The same depth, to be read: without its stencil.
pub(super) fn readable(view: &wgpu::TextureView) -> wgpu::TextureView {
    view.texture().create_view(&wgpu::TextureViewDescriptor {
        aspect: wgpu::TextureAspect::DepthOnly,
        ..Default::default()
    })
}
