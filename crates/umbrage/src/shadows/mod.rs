//! Shadows in somebody else's renderer: lights and casters by handle, any technique for each light, one bind group.
//!
//! Once: make a [`Shadows`] with your device, name your meshes' buffers ([`CasterMesh`]), add casters and lights. Put
//! [`Shadows::wgsl`] before your shader and [`Shadows::bind_group_layout`] into its pipeline. Each frame: say what moved, call
//! [`Shadows::prepare`], then [`Shadows::record`] with your encoder, and bind [`Shadows::bind_group`] where you light. In the shader,
//! `umbrage_visibility(light, p_world, normal, pixel)` is how much of a light a surface sees.
//!
//! Nothing here submits or waits. Where nothing moved, nothing is drawn, written or allocated.

mod casters;
mod casting;
mod depth;
mod error;
mod foreign;
mod frame;
mod handles;
mod lighting;
mod lights;
mod masks;
mod meshes;
mod options;
mod own;
mod pool;
mod prepare;
mod record;
mod scene;
mod screen;
mod table;
mod variants;
mod views;
mod visibility;
mod wgsl;

pub use error::ShadowsError;
pub use frame::Frame;
pub use handles::{CasterHandle, LightHandle, MeshHandle, ReceiverHandle};
pub use meshes::{CasterMesh, CutOut, Translucent};
pub use options::ShadowsOptions;
pub use own::{OwnDraw, OwnTarget};
pub use prepare::{Prepared, ShadowsWarning};
pub use record::Recorded;

use crate::CasterPipelines;
use crate::caster::{GpuCasterView, GpuInstance};
use crate::growing::Growing;
use crate::maps::{comparison_sampler, point_sampler};
use casters::Casters;
use casting::Casting;
use handles::Store;
use lights::Lit;
use masks::Masks;
use meshes::Mesh;
use pool::Pool;
use screen::Screen;
use std::hash::{BuildHasher, Hasher};
use std::num::NonZeroU64;
use table::{GpuLit, Table};
use umbrage_core::Aabb;
use variants::Declared;
use visibility::Visibility;

/// The shadows of a scene: see the [module](self).
#[derive(Debug)]
pub struct Shadows {
    device: wgpu::Device,
    queue: wgpu::Queue,
    options: ShadowsOptions,
    declared: Declared,
    meshes: Store<Mesh>,
    casters: Casters,
    lights: Store<Lit>,
    pools: Vec<Pool>,
    castings: Vec<Casting>,
    table: Table,
    layout: wgpu::BindGroupLayout,
    group: wgpu::BindGroup,
    group_is_stale: bool,
    comparison: wgpu::Sampler,
    point: wgpu::Sampler,
    cut_out_layout: wgpu::BindGroupLayout,
    view_layout: wgpu::BindGroupLayout,
    matrices: wgpu::Buffer,
    view_group: wgpu::BindGroup,
    moving_placed: Growing,
    /// Memory that frames use again.
    scratch: Scratch,
    /// V on the screen, where a technique finds it there.
    screen: Option<Screen>,
    masks: Option<Masks>,
    visibility: Option<Visibility>,
    /// Box around all that there is.
    scene_world: Aabb,
    frame: Option<Frame>,
    /// Lights were added, removed or changed.
    lights_changed: bool,
    /// Since the last change that recording must not miss.
    is_prepared: bool,
    warnings: Vec<ShadowsWarning>,
}

#[derive(Debug, Default)]
struct Scratch {
    boxes: Vec<Aabb>,
    placed: Vec<GpuInstance>,
    moving_placed: Vec<GpuInstance>,
    seen: Vec<(usize, u64)>,
    table: Vec<GpuLit>,
}

impl Shadows {
    /// Shadows for what `device` draws, handed over by `queue`, which must be its own. Makes no map yet.
    ///
    /// Cost: shader text; pipelines and maps are made when a light first needs them.
    ///
    /// # Errors
    /// [`ShadowsError::Option`], [`ShadowsError::Limit`] or [`ShadowsError::Shadow`] when options or device cannot be used,
    /// [`ShadowsError::Kernel`] when the kernel's text has no `umbrage_kernel`.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        options: ShadowsOptions,
    ) -> Result<Self, ShadowsError> {
        options.check(device)?;
        if let Some(reason) = options.kernel.as_deref().and_then(|text| kernel_error(device, text)) {
            return Err(ShadowsError::Kernel { reason });
        }
        let declared = Declared::new(device, &options)?;
        check_limits(device, &declared)?;
        let pools = declared.pools.iter().map(|kind| Pool::new(device, kind.clone()));
        let pools: Vec<Pool> = pools.collect::<Result<_, _>>()?;
        let table = Table::new(device, options.most_lights, options.most_views);
        let (comparison, point) = (comparison_sampler(device), point_sampler(device));
        let layout = wgsl::layout(device, &declared);
        let screen = declared.screen.then(|| Screen::new(device, options.depth_stencil));
        let cut_out_layout = CasterPipelines::cut_out_layout(device);
        let masks = declared.mask_settings.as_ref();
        let masks = masks.map(|settings| Masks::new(device, settings, &cut_out_layout)).transpose()?;
        let resources = wgsl::Resources {
            table: &table,
            pools: &pools,
            comparison: &comparison,
            point: &point,
            screen: screen.as_ref().map(|screen| screen.v.array()),
            masks: masks.as_ref().map(|masks| masks.blockers.bindings()),
        };
        let group = wgsl::group(device, &layout, &declared, &resources);
        let view_layout = crate::caster::view_layout(device);
        let matrices = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("umbrage caster views"),
            size: u64::from(options.most_views * GpuCasterView::STRIDE),
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let view_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("umbrage caster view"),
            layout: &view_layout,
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                    buffer: &matrices,
                    offset: 0,
                    size: NonZeroU64::new(size_of::<GpuCasterView>() as u64),
                }),
            }],
        });
        // Told apart from others by chance: 1 in 4 billion pairs are not.
        let of = std::hash::RandomState::new().build_hasher().finish() as u32;
        Ok(Self {
            meshes: Store::new("mesh", of),
            casters: Casters::new(of),
            lights: Store::new("light", of),
            cut_out_layout,
            moving_placed: Growing::new(device, "umbrage moving casters", wgpu::BufferUsages::VERTEX, 0),
            device: device.clone(),
            queue: queue.clone(),
            options,
            declared,
            pools,
            castings: Vec::new(),
            table,
            layout,
            group,
            group_is_stale: false,
            comparison,
            point,
            view_layout,
            matrices,
            view_group,
            scratch: Scratch::default(),
            screen,
            masks,
            visibility: None,
            scene_world: Aabb::EMPTY,
            frame: None,
            lights_changed: true,
            is_prepared: false,
            warnings: Vec::new(),
        })
    }

    /// The layout of the one bind group, for the pipelines of whoever lights. The same as long as this lives.
    pub fn bind_group_layout(&self) -> &wgpu::BindGroupLayout {
        &self.layout
    }

    /// The bind group of all lights. Valid from the start; ask for it each frame after [`Shadows::prepare`], which may have made
    /// another one.
    pub fn bind_group(&self) -> &wgpu::BindGroup {
        &self.group
    }

    /// WGSL for whoever lights, to stand before their shader: the declarations of bind group number `group`, and
    /// `fn umbrage_visibility(light: u32, p_world: vec3f, normal: vec3f, pixel: vec2f) -> f32`, with
    /// `umbrage_visibility_rgb` for light that is coloured. All of its names begin with `umbrage_` or `Umbrage`. It stays the same.
    pub fn wgsl(&self, group: u32) -> String {
        wgsl::text(group, &self.declared, &self.options)
    }

    /// What did not go as one may expect, of the last [`Shadows::prepare`].
    pub fn warnings(&self) -> &[ShadowsWarning] {
        &self.warnings
    }

    /// Memory of maps and of what is kept to draw them, bytes.
    pub fn memory_bytes(&self) -> u64 {
        let kept = |lit: &Lit| -> u64 {
            let kept = lit.views.iter().filter_map(|view| view.kept.as_ref());
            kept.map(|kept| 4 * u64::from(kept.texture.width()) * u64::from(kept.texture.height())).sum()
        };
        let kept: u64 = self.lights.iter().map(|(_, lit)| kept(lit)).sum();
        let peels = self.castings.iter().filter_map(|casting| casting.peel.as_ref());
        let peeled: u64 = peels.map(|(_, peel)| peel.memory_bytes()).sum();
        let screen = self.screen.as_ref().map_or(0, Screen::memory_bytes);
        let masks = self.masks.as_ref().map_or(0, Masks::memory_bytes);
        let visibility = self.visibility.as_ref().map_or(0, Visibility::memory_bytes);
        self.pools.iter().map(Pool::memory_bytes).sum::<u64>() + kept + peeled + screen + masks + visibility
    }
}

/// What is wrong with a user's kernel. Its own lines come first, so that a line number is that of its text.
fn kernel_error(device: &wgpu::Device, text: &str) -> Option<String> {
    let view = umbrage_core::wgsl::assemble(&["view"]).unwrap_or_default();
    let call =
        "fn umbrage_check(view: UmbrageView, x: vec4f) -> vec4f { return umbrage_kernel(view, x, x); }";
    foreign::wgsl_error(device, format!("{text}\n{call}\n{view}"))
}

/// Does one stage of the device have room for what is bound?
fn check_limits(device: &wgpu::Device, declared: &Declared) -> Result<(), ShadowsError> {
    let limits = device.limits();
    let bound = wgsl::bound(declared);
    let textures = bound.iter().filter(|bound| bound.is_texture()).count() as u64;
    let has = u64::from(limits.max_sampled_textures_per_shader_stage);
    if textures > has {
        return Err(ShadowsError::Limit {
            limit: "max_sampled_textures_per_shader_stage",
            has,
            needed: textures,
            advice: "name fewer techniques of different storage or map_size in `ShadowsOptions`",
        });
    }
    Ok(())
}
