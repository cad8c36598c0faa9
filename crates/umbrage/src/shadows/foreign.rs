//! Was a resource made by the same device? `wgpu` tells it only by refusing to use it, so it is used where a refusal is heard.

use std::pin::pin;
use std::task::{Context, Poll, Waker};

/// Did `use_it` raise a validation error? On the web errors come later than this call ends: no is then the answer, and the
/// browser's own message says what is wrong.
fn is_refused(device: &wgpu::Device, use_it: impl FnOnce()) -> bool {
    let scope = device.push_error_scope(wgpu::ErrorFilter::Validation);
    use_it();
    let popped = pin!(scope.pop());
    matches!(popped.poll(&mut Context::from_waker(Waker::noop())), Poll::Ready(Some(_)))
}

/// Is a vertex or index buffer of another device?
pub(super) fn is_foreign_buffer(device: &wgpu::Device, buffer: &wgpu::Buffer, is_index: bool) -> bool {
    is_refused(device, || {
        let mut bundle = device.create_render_bundle_encoder(&wgpu::RenderBundleEncoderDescriptor {
            label: Some("umbrage whose buffer"),
            color_formats: &[Some(wgpu::TextureFormat::Rgba8Unorm)],
            depth_stencil: None,
            sample_count: 1,
            multiview: None,
        });
        if is_index {
            bundle.set_index_buffer(buffer.slice(..), wgpu::IndexFormat::Uint16);
        } else {
            bundle.set_vertex_buffer(0, buffer.slice(..));
        }
        bundle.finish(&wgpu::RenderBundleDescriptor { label: Some("umbrage whose buffer") });
    })
}

/// Is a texture with a depth of another device?
pub(super) fn is_foreign_depth(
    device: &wgpu::Device,
    view: &wgpu::TextureView,
    format: wgpu::TextureFormat,
) -> bool {
    is_refused(device, || {
        let mut encoder = device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("umbrage whose depth") });
        drop(encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("umbrage whose depth"),
            depth_stencil_attachment: Some(
                wgpu::RenderPassDepthStencilAttachment {
                    view,
                    depth_ops: None,
                    stencil_ops: format.has_stencil_aspect().then_some(wgpu::Operations {
                        load: wgpu::LoadOp::Load,
                        store: wgpu::StoreOp::Store,
                    }),
                },
            ),
            ..Default::default()
        }));
        encoder.finish();
    })
}
