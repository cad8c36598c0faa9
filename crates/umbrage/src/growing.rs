//! A buffer that grows.

/// A buffer that grows to what is written to it, and never shrinks.
#[derive(Debug)]
pub struct Growing {
    /// The buffer as it is now.
    pub buffer: wgpu::Buffer,
    label: &'static str,
}

impl Growing {
    /// Room for `bytes` bytes at first, 64 at least: an empty buffer cannot be bound.
    pub fn new(device: &wgpu::Device, label: &'static str, usage: wgpu::BufferUsages, bytes: usize) -> Self {
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: bytes.max(64).next_multiple_of(16) as u64,
            usage: usage | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        Self { buffer, label }
    }

    /// Writes from its start on; true when it is another buffer now. Bytes in multiples of 4.
    pub fn write(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, bytes: &[u8]) -> bool {
        let grows = bytes.len() as u64 > self.buffer.size();
        if grows {
            let size = bytes.len().next_power_of_two();
            *self = Self::new(device, self.label, self.buffer.usage(), size);
        }
        if !bytes.is_empty() {
            queue.write_buffer(&self.buffer, 0, bytes);
        }
        grows
    }
}
