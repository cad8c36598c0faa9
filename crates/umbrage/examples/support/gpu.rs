//! A device with default limits and no optional feature.

use super::Result;
use std::sync::{Arc, Mutex};

/// A device to draw with.
pub struct Gpu {
    pub adapter_name: String,
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    /// What wgpu had to say against what we did.
    errors: Arc<Mutex<Vec<String>>>,
}

/// An instance without validation layers, which are for whoever debugs wgpu itself.
pub fn instance() -> wgpu::Instance {
    wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends: wgpu::Backends::PRIMARY,
        flags: wgpu::InstanceFlags::empty(),
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    })
}

impl Gpu {
    /// The first adapter whose name contains `name`, or the one that wgpu prefers.
    pub fn open(name: Option<&str>) -> Result<Self> {
        let instance = instance();
        let Some(name) = name else { return Self::for_surface(&instance, None).map(|(gpu, _)| gpu) };
        let adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::PRIMARY));
        let found = adapters.into_iter().find(|adapter| adapter.get_info().name.contains(name));
        Self::of(&found.ok_or(format!("no graphics adapter's name contains `{name}`; install its driver"))?)
    }

    /// One that can show pictures on a surface.
    pub fn for_surface(
        instance: &wgpu::Instance,
        surface: Option<&wgpu::Surface<'_>>,
    ) -> Result<(Self, wgpu::Adapter)> {
        let wanted = wgpu::RequestAdapterOptions { compatible_surface: surface, ..Default::default() };
        let adapter = pollster::block_on(instance.request_adapter(&wanted)).map_err(|e| {
            format!("no graphics adapter: {e}; install a driver (Debian: mesa-vulkan-drivers)")
        })?;
        Ok((Self::of(&adapter)?, adapter))
    }

    fn of(adapter: &wgpu::Adapter) -> Result<Self> {
        let (device, queue) = pollster::block_on(adapter.request_device(&Default::default()))?;
        let errors = Arc::new(Mutex::new(Vec::new()));
        let into = errors.clone();
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            // One line, like all errors.
            let line = error.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
            if let Ok(mut errors) = into.lock() {
                errors.push(line);
            }
        }));
        Ok(Self { adapter_name: adapter.get_info().name, device, queue, errors })
    }

    /// Was everything fine since the last call?
    pub fn check(&self) -> Result<()> {
        let mut errors = self.errors.lock().map_err(|_| "a thread of wgpu's panicked; start again")?;
        errors.drain(..).next().map_or(Ok(()), |first| Err(format!("wgpu: {first}").into()))
    }

    /// A buffer that holds these values.
    pub fn buffer<T: bytemuck::NoUninit>(&self, values: &[T], usage: wgpu::BufferUsages) -> wgpu::Buffer {
        use wgpu::util::DeviceExt;
        let contents = bytemuck::cast_slice(values);
        self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
    }

    /// A texture that can be drawn to.
    pub fn texture(
        &self,
        size_px: [u32; 2],
        format: wgpu::TextureFormat,
        usage: wgpu::TextureUsages,
    ) -> wgpu::Texture {
        self.device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: size_px[0], height: size_px[1], depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: usage | wgpu::TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        })
    }
}
