//! Which adapter is used, and why.

use crate::RenderError;
use std::sync::{Arc, Mutex};

/// A device to draw with.
#[derive(Debug)]
pub struct Gpu {
    /// What made it.
    pub adapter: wgpu::Adapter,
    /// Name, kind, driver.
    pub info: wgpu::AdapterInfo,
    /// The device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    /// The first error that no scope caught.
    errors: Arc<Mutex<Option<String>>>,
}

/// What to install where there is no adapter.
pub const INSTALL_HINT: &str = "install a Vulkan driver: on Debian or Ubuntu `apt-get install mesa-vulkan-drivers` \
     (a software one that runs anywhere), elsewhere your graphics card's own";

fn instance() -> wgpu::Instance {
    // Validation layers cost time and are for whoever debugs wgpu itself.
    wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends: wgpu::Backends::from_env().unwrap_or(wgpu::Backends::PRIMARY),
        flags: wgpu::InstanceFlags::empty().with_env(),
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    })
}

/// All adapters of this machine, best first: discrete, integrated, virtual, software.
pub fn adapters() -> Vec<wgpu::Adapter> {
    let mut adapters = pollster::block_on(instance().enumerate_adapters(wgpu::Backends::all()));
    adapters.sort_by_key(|adapter| match adapter.get_info().device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Cpu => 3,
        wgpu::DeviceType::Other => 4,
    });
    adapters
}

/// Features that are used where an adapter has them, and only to measure.
const MEASURING: wgpu::Features =
    wgpu::Features::TIMESTAMP_QUERY.union(wgpu::Features::PIPELINE_STATISTICS_QUERY);
/// Used where the adapter has it; casters that a map's near plane would cut then still throw their whole shadow.
const UNCLIPPED: wgpu::Features = wgpu::Features::DEPTH_CLIP_CONTROL;

/// Used where the adapter has it: stencil volumes then count over the most precise depth.
const STENCIL: wgpu::Features = wgpu::Features::DEPTH32FLOAT_STENCIL8;

/// Optional features that `UMBRAGE_WITHOUT` can take away, by the names that it knows them by.
const DENIABLE: [(&str, wgpu::Features); 2] =
    [("depth-clip-control", UNCLIPPED), ("depth32f-stencil8", STENCIL)];

/// What the environment says is lacking.
fn denied() -> Vec<String> {
    let denied = std::env::var("UMBRAGE_WITHOUT").unwrap_or_default();
    denied.split(',').map(|id| id.trim().to_owned()).collect()
}

/// One line; out of memory with the way out of it.
fn described(error: &wgpu::Error) -> String {
    match error {
        wgpu::Error::OutOfMemory { .. } => {
            "its memory is full; choose a smaller picture (--size) or smaller maps (--set map_size=...)"
                .to_owned()
        }
        _ => error.to_string().split_whitespace().collect::<Vec<_>>().join(" "),
    }
}

impl Gpu {
    /// The best adapter, or the first whose name contains `name` (letters' case aside), and a device of it with the
    /// default limits of WebGPU, raised only where a picture or map may be larger.
    ///
    /// # Errors
    /// [`RenderError::NoAdapter`] says what there is, or what to install; [`RenderError::NoDevice`].
    pub fn new(name: Option<&str>) -> Result<Self, RenderError> {
        let denied = denied();
        let is_denied = |(id, _): &&(&str, wgpu::Features)| denied.iter().any(|other| other == id);
        let without =
            DENIABLE.iter().filter(is_denied).fold(wgpu::Features::empty(), |all, (_, one)| all | *one);
        Self::without(name, without)
    }

    /// The same, as if the adapter lacked some optional features: to see what another would be given.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn without(name: Option<&str>, without: wgpu::Features) -> Result<Self, RenderError> {
        let adapters = adapters();
        let wanted = name.map(str::to_lowercase);
        let found = adapters.iter().find(|adapter| {
            wanted.as_ref().is_none_or(|wanted| adapter.get_info().name.to_lowercase().contains(wanted))
        });
        let Some(adapter) = found.cloned() else {
            let names: Vec<_> = adapters.iter().map(|a| format!("`{}`", a.get_info().name)).collect();
            return Err(RenderError::NoAdapter(match name {
                Some(name) if !names.is_empty() => {
                    format!("no graphics adapter's name contains `{name}`; there is {}", names.join(", "))
                }
                _ => format!("no graphics adapter was found; {INSTALL_HINT}"),
            }));
        };
        let info = adapter.get_info();
        let most = adapter.limits();
        let limits = wgpu::Limits {
            max_texture_dimension_2d: most.max_texture_dimension_2d,
            max_buffer_size: most.max_buffer_size,
            max_texture_array_layers: most.max_texture_array_layers,
            ..wgpu::Limits::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("umbrage"),
            required_features: adapter.features() & (MEASURING | UNCLIPPED | STENCIL).difference(without),
            required_limits: limits,
            ..Default::default()
        }))
        .map_err(|e| RenderError::NoDevice {
            adapter: info.name.clone(),
            reason: e.to_string().replace('\n', " "),
        })?;
        let errors = Arc::new(Mutex::new(None));
        let sink = Arc::clone(&errors);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            if let Ok(mut first) = sink.lock() {
                first.get_or_insert_with(|| described(&error));
            }
        }));
        Ok(Self { adapter, info, device, queue, errors })
    }

    /// What the adapter allows for a texture format. `UMBRAGE_WITHOUT=depth16,depth24` pretends that formats are
    /// lacking, and with `depth-clip-control` and `depth32f-stencil8` features, to see what another adapter would be given.
    pub fn usages_of(&self, format: wgpu::TextureFormat) -> wgpu::TextureUsages {
        let is_denied = denied().iter().any(|id| {
            umbrage::core::technique::Storage::find(id).and_then(umbrage::format::format_of) == Some(format)
        });
        if is_denied {
            return wgpu::TextureUsages::empty();
        }
        self.adapter.get_texture_format_features(format).allowed_usages
    }

    /// The first error that the device reported since the last call.
    ///
    /// # Errors
    /// [`RenderError::Gpu`] with the device's words.
    pub fn check(&self) -> Result<(), RenderError> {
        match self.errors.lock().ok().and_then(|mut first| first.take()) {
            Some(error) => Err(RenderError::Gpu(error)),
            None => Ok(()),
        }
    }

    /// Can passes be timed on the GPU?
    pub fn has_timestamps(&self) -> bool {
        self.device.features().contains(wgpu::Features::TIMESTAMP_QUERY)
    }

    /// Can the work of passes be counted on the GPU?
    pub fn has_statistics(&self) -> bool {
        self.device.features().contains(wgpu::Features::PIPELINE_STATISTICS_QUERY)
    }
}
