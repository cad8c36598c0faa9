//! What the shader knows of lights and views, in two uniform buffers.

use bytemuck::{Pod, Zeroable};
use glam::Vec4;
use umbrage_core::layout::GpuView;

/// Mirrors `UmbrageLight` of `wgsl/shadows.wgsl`; see there for what each field means.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(super) struct GpuLit {
    pub point: Vec4,
    /// 1 and the number of the lookup; 0: there are no maps.
    pub lookup: u32,
    pub first_view: u32,
    pub places: u32,
    /// 6 for point lights.
    pub tiles: u32,
    /// First mask, and in the upper half how many.
    pub masks: u32,
    /// 1 and its layer of V on the screen; 0: none.
    pub screen: u32,
    /// 1 where what lies outside of its map is lit.
    pub lit_outside: u32,
    pub pad: u32,
}

/// The two buffers.
#[derive(Debug)]
pub(super) struct Table {
    pub lights: wgpu::Buffer,
    pub views: wgpu::Buffer,
    written: Vec<GpuLit>,
}

impl Table {
    pub fn new(device: &wgpu::Device, most_lights: u32, most_views: u32) -> Self {
        let uniform = |label, size: usize| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: size as u64,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        Self {
            lights: uniform("umbrage lights", size_of::<GpuLit>() * most_lights as usize),
            views: uniform("umbrage views", size_of::<GpuView>() * most_views as usize),
            written: Vec::new(),
        }
    }

    /// Writes the lights that are not as they were; the bytes.
    pub fn write_lights(&mut self, queue: &wgpu::Queue, lights: &[GpuLit]) -> u64 {
        if self.written == lights {
            return 0;
        }
        self.written.clear();
        self.written.extend_from_slice(lights);
        let bytes: &[u8] = bytemuck::cast_slice(lights);
        if !bytes.is_empty() {
            queue.write_buffer(&self.lights, 0, bytes);
        }
        bytes.len() as u64
    }

    /// Writes one view.
    pub fn write_view(&self, queue: &wgpu::Queue, number: u32, view: &GpuView) -> u64 {
        let size = size_of::<GpuView>() as u64;
        queue.write_buffer(&self.views, u64::from(number) * size, bytemuck::bytes_of(view));
        size
    }
}
