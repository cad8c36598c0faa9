//! Was a resource made by the same device? `wgpu` tells it only by refusing to use it, so it is used where a refusal is heard.

use std::pin::pin;
use std::task::{Context, Poll, Waker};

/// What is wrong with WGSL, one line; `None` where nothing is, or the answer comes later.
pub(super) fn wgsl_error(device: &wgpu::Device, text: String) -> Option<String> {
    let scope = device.push_error_scope(wgpu::ErrorFilter::Validation);
    // Only what is said of it counts.
    let _ = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("umbrage checks"),
        source: wgpu::ShaderSource::Wgsl(text.into()),
    });
    let popped = pin!(scope.pop());
    let Poll::Ready(Some(error)) = popped.poll(&mut Context::from_waker(Waker::noop())) else { return None };
    Some(error.to_string().split_whitespace().collect::<Vec<_>>().join(" "))
}

/// Did `use_it` raise a validation error? On the web errors come later than this call ends: no is then the answer, and the
/// browser's own message says what is wrong.
fn is_refused(device: &wgpu::Device, use_it: impl FnOnce()) -> bool {
    let scope = device.push_error_scope(wgpu::ErrorFilter::Validation);
    use_it();
    let popped = pin!(scope.pop());
    matches!(popped.poll(&mut Context::from_waker(Waker::noop())), Poll::Ready(Some(_)))
}

/// Is a vertex or index buffer of another device? Of devices of one `wgpu::Instance`: what belongs to another instance cannot be told
/// from one's own.
pub(super) fn is_foreign_buffer(device: &wgpu::Device, buffer: &wgpu::Buffer, is_index: bool) -> bool {
    is_refused(device, || {
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("umbrage whose buffer"),
            size: wgpu::Extent3d { width: 1, height: 1, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::R8Unorm,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        });
        let mut encoder = device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("umbrage whose buffer"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &texture.create_view(&Default::default()),
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations::default(),
            })],
            ..Default::default()
        });
        if is_index {
            pass.set_index_buffer(buffer.slice(..), wgpu::IndexFormat::Uint16);
        } else {
            pass.set_vertex_buffer(0, buffer.slice(..));
        }
        drop(pass);
        encoder.finish();
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
