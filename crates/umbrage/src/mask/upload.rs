//! What the GPU knows of masks beside their texels: views, instances, and the list that shaders look up.

use super::blockers::BlockerMask;
use super::lookup::{GpuMaskList, owner_in_list};
use crate::caster::GpuCasterView;
use glam::{UVec2, Vec4};
use std::mem::offset_of;
use std::num::NonZeroU64;
use umbrage_core::layout_mask::GpuMask;
use umbrage_core::masks::Rect;

/// Buffers, and what is written to them, kept for its memory.
#[derive(Debug)]
pub(super) struct Upload {
    matrices: wgpu::Buffer,
    /// Group 0 of the passes that draw masks.
    pub view_group: wgpu::BindGroup,
    /// Of all parts of all masks.
    pub instances: wgpu::Buffer,
    /// A [`GpuMaskList`].
    pub list: wgpu::Buffer,
    /// What each mask is drawn with.
    pub views: Vec<GpuCasterView>,
    masks: Vec<GpuMask>,
    seen: Vec<[u32; 4]>,
    bytes: Vec<u8>,
    rows: Vec<[Vec4; 3]>,
}

fn buffer(device: &wgpu::Device, label: &str, usage: wgpu::BufferUsages, size: u64) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// A uniform for each mask, and the group that picks one by a dynamic offset.
fn views(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    masks: u32,
) -> (wgpu::Buffer, wgpu::BindGroup) {
    let size = u64::from(masks) * u64::from(GpuCasterView::STRIDE);
    let matrices = buffer(device, "umbrage mask views", wgpu::BufferUsages::UNIFORM, size);
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("umbrage mask views"),
        layout,
        entries: &[wgpu::BindGroupEntry {
            binding: 0,
            resource: wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer: &matrices,
                offset: 0,
                size: NonZeroU64::new(size_of::<GpuCasterView>() as u64),
            }),
        }],
    });
    (matrices, group)
}

impl Upload {
    /// Room for so many masks.
    pub fn new(device: &wgpu::Device, layout: &wgpu::BindGroupLayout, masks: u32) -> Self {
        let (matrices, view_group) = views(device, layout, masks);
        let list = size_of::<GpuMaskList>() as u64;
        Self {
            matrices,
            view_group,
            instances: buffer(device, "umbrage blockers", wgpu::BufferUsages::VERTEX, 48),
            list: buffer(device, "umbrage mask list", wgpu::BufferUsages::UNIFORM, list),
            views: Vec::new(),
            masks: Vec::new(),
            seen: Vec::new(),
            bytes: Vec::new(),
            rows: Vec::new(),
        }
    }

    /// Room for more.
    pub fn grow(&mut self, device: &wgpu::Device, layout: &wgpu::BindGroupLayout, masks: u32) {
        (self.matrices, self.view_group) = views(device, layout, masks);
    }

    /// Views and parts of all masks, in the order of their numbers.
    pub fn write_masks<'a>(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        masks: impl Iterator<Item = BlockerMask<'a>>,
        time_s: f32,
    ) {
        self.views.clear();
        self.masks.clear();
        self.bytes.clear();
        self.rows.clear();
        for mask in masks {
            let view = GpuCasterView::of_mask(mask.view.clip_from_world(), time_s);
            self.bytes.extend_from_slice(bytemuck::bytes_of(&view));
            self.bytes.resize((mask.number + 1) * GpuCasterView::STRIDE as usize, 0);
            self.views.push(view);
            self.masks.push(GpuMask::new(mask.view, mask.number as u32, Some(mask.object)));
            self.rows.extend(mask.parts.iter().map(|part| {
                let world = &part.world_from_object;
                [world.row(0), world.row(1), world.row(2)]
            }));
        }
        let instances: &[u8] = bytemuck::cast_slice(&self.rows);
        if instances.len() as u64 > self.instances.size() {
            let size = instances.len().next_power_of_two() as u64;
            self.instances = buffer(device, "umbrage blockers", wgpu::BufferUsages::VERTEX, size);
        }
        if !self.views.is_empty() {
            queue.write_buffer(&self.instances, 0, instances);
            queue.write_buffer(&self.matrices, 0, &self.bytes);
            queue.write_buffer(&self.list, 0, bytemuck::cast_slice(&self.masks));
        }
    }

    /// The pixels that each may darken, in the same order.
    pub fn write_pixels<'a>(&mut self, queue: &wgpu::Queue, masks: impl Iterator<Item = BlockerMask<'a>>) {
        self.seen.clear();
        self.seen.extend(masks.map(|mask| {
            let rect = mask.on_screen.unwrap_or(Rect { min: UVec2::ZERO, max: UVec2::ZERO });
            let corner = |at: UVec2| at.x | (at.y << 16);
            [corner(rect.min), corner(rect.max), owner_in_list(mask.object), 0]
        }));
        if !self.seen.is_empty() {
            let at = offset_of!(GpuMaskList, seen) as u64;
            queue.write_buffer(&self.list, at, bytemuck::cast_slice(&self.seen));
        }
    }

    /// Memory, bytes.
    pub fn memory_bytes(&self) -> u64 {
        self.list.size() + self.matrices.size() + self.instances.size()
    }
}
