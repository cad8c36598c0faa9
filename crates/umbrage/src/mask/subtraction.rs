//! Masks taken away from V on the screen, light by light.

use super::blockers::{BlockerMask, BlockerMasks};
use super::subtract::{GpuReceiving, Shadowed, SubtractPipelines};
use glam::{Mat4, Vec4};
use umbrage_core::layout_mask::GpuMask;
use umbrage_core::technique::mask::Lookup;
use umbrage_core::volume::light_point_world;

/// What takes the masks of each light away from receivers.
#[derive(Debug)]
pub struct Subtraction {
    pipelines: SubtractPipelines,
    receiving: Vec<wgpu::Buffer>,
    /// What each of `receiving` holds.
    told: Vec<Option<GpuReceiving>>,
    list: wgpu::Buffer,
    groups: Vec<wgpu::BindGroup>,
    /// Of the masks when groups were made, and when the list was written.
    changes: u64,
    version: Option<u64>,
    bytes: Vec<u8>,
}

fn list(device: &wgpu::Device, masks: &BlockerMasks) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("umbrage masks apart"),
        size: u64::from(masks.maps().count()) * u64::from(SubtractPipelines::STRIDE),
        usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

fn groups(
    device: &wgpu::Device,
    pipelines: &SubtractPipelines,
    receiving: &[wgpu::Buffer],
    list: &wgpu::Buffer,
    masks: &BlockerMasks,
) -> Vec<wgpu::BindGroup> {
    let (_, _, sampler) = masks.bindings();
    receiving.iter().map(|of| pipelines.group(device, of, list, masks.maps(), sampler)).collect()
}

impl Subtraction {
    /// For the lights of `masks`. Memory: 256 bytes a mask, 112 a light.
    pub fn new(device: &wgpu::Device, pipelines: SubtractPipelines, masks: &BlockerMasks) -> Self {
        let receiving: Vec<_> = (0..masks.lights())
            .map(|_| {
                device.create_buffer(&wgpu::BufferDescriptor {
                    label: Some("umbrage receiving"),
                    size: size_of::<GpuReceiving>() as u64,
                    usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                    mapped_at_creation: false,
                })
            })
            .collect();
        let list = list(device, masks);
        Self {
            groups: groups(device, &pipelines, &receiving, &list, masks),
            told: vec![None; receiving.len()],
            pipelines,
            receiving,
            list,
            changes: masks.changes(),
            version: None,
            bytes: Vec::new(),
        }
    }

    /// Hands the GPU what is not as it was, after [`BlockerMasks::finish`]. `eye_world` is the eye's place and 1, or the direction
    /// towards it and 0; `time_s` what deforming receivers know of time, seconds.
    pub fn write(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        masks: &BlockerMasks,
        eye_world: Vec4,
        time_s: f32,
    ) {
        if self.changes != masks.changes() {
            self.list = list(device, masks);
            self.groups = groups(device, &self.pipelines, &self.receiving, &self.list, masks);
            (self.changes, self.version) = (masks.changes(), None);
        }
        if self.version != Some(masks.version()) {
            self.bytes.clear();
            for mask in masks.iter() {
                let made = GpuMask::new(mask.view, mask.number as u32, Some(mask.object));
                self.bytes.extend_from_slice(bytemuck::bytes_of(&made));
                self.bytes.resize((mask.number + 1) * SubtractPipelines::STRIDE as usize, 0);
            }
            if !self.bytes.is_empty() {
                queue.write_buffer(&self.list, 0, &self.bytes);
            }
            self.version = Some(masks.version());
        }
        let clip_from_world = masks.picture().map_or(Mat4::IDENTITY, |picture| picture.clip_from_world);
        for (number, (told, buffer)) in self.told.iter_mut().zip(&self.receiving).enumerate() {
            let Some(mask) = masks.get(masks.of_light(number).start).filter(|mask| mask.light == number)
            else {
                continue;
            };
            let light = light_point_world(mask.of);
            let receiving = GpuReceiving { clip_from_world, eye: eye_world, light, time_s, pad: [0.0; 3] };
            if *told != Some(receiving) {
                queue.write_buffer(buffer, 0, bytemuck::bytes_of(&receiving));
                *told = Some(receiving);
            }
        }
    }

    /// Draws what each of a light's masks takes away, first all cores, then all fringes, into the pass of
    /// [`super::record_subtract`]. Pipeline, group 0 and scissor are set: `draw(pass, mask)` sets positions as vertex buffer 0 and
    /// instances as vertex buffer 1, and draws the receivers on which the mask's shadow may fall. An object's own mask is not to
    /// be drawn over it: leave out receivers of the object `mask.object`.
    pub fn draw(
        &self,
        recorded: &mut wgpu::RenderPass<'_>,
        masks: &BlockerMasks,
        light: usize,
        mut draw: impl FnMut(&mut wgpu::RenderPass<'_>, &BlockerMask<'_>),
    ) {
        let Some(group) = self.groups.get(light) else { return };
        for shadowed in [Shadowed::Core, Shadowed::Fringe] {
            // A mask that is not blended has no fringe.
            if shadowed == Shadowed::Fringe && masks.choices().lookup == Lookup::Nearest {
                continue;
            }
            recorded.set_pipeline(self.pipelines.of(shadowed));
            for mask in masks.of_light(light).filter_map(|number| masks.get(number)) {
                let Some(seen) = mask.on_screen else { continue };
                recorded.set_scissor_rect(seen.min.x, seen.min.y, seen.size().x, seen.size().y);
                recorded.set_bind_group(0, group, &[mask.number as u32 * SubtractPipelines::STRIDE]);
                draw(recorded, &mask);
            }
        }
    }

    /// Memory, bytes.
    pub fn memory_bytes(&self) -> u64 {
        self.list.size() + self.receiving.iter().map(wgpu::Buffer::size).sum::<u64>()
    }
}

// `group` binds a mask by this many bytes at a dynamic offset.
const _: () = assert!(size_of::<GpuMask>() <= SubtractPipelines::STRIDE as usize);
