//! V that is found on the screen, a layer for each light: what volumes and subtractive masks leave behind.

use glam::UVec2;
use umbrage::layers::Layers;

/// Its format: V is a bit, or what a blur makes of it.
pub const SCREEN_V: wgpu::TextureFormat = wgpu::TextureFormat::R8Unorm;

/// V of each light for each pixel; one layer at least.
pub(crate) fn screen_v(device: &wgpu::Device, size: UVec2, lights: usize) -> Layers {
    Layers::new(device, "visibility", size.to_array(), lights.max(1) as u32, SCREEN_V)
}
