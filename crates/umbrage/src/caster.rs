//! The pass that draws casters into a map.

use crate::format::SCRATCH_DEPTH;
use crate::{ChosenFormat, ShadowMaps};
use glam::{Mat4, Vec4};
use std::num::NonZeroU64;
use umbrage_core::DEPTH;
use umbrage_core::fit::ShadowView;
use umbrage_core::plan::{Cull, Keeps, Pass};
use umbrage_core::technique::Storage;

/// The vertex buffers that caster pipelines read.
///
/// Slot 0: positions, as [`CasterVertices`] says. Slot 1, per instance: the three rows of `world_from_object`,
/// `3 x Float32x4`, 48 bytes. Slot 2, only for cut-out casters: texture coordinates and alpha factor, `Float32x3`.
#[derive(Clone, Copy, Debug)]
pub struct CasterStreams;

const INSTANCES: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: 48,
    step_mode: wgpu::VertexStepMode::Instance,
    attributes: &wgpu::vertex_attr_array![1 => Float32x4, 2 => Float32x4, 3 => Float32x4],
};
const UV_ALPHA: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: 12,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &wgpu::vertex_attr_array![4 => Float32x3],
};

/// Rows of an affine `world_from_object`, as vertex shaders read an instance: 48 bytes.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct GpuInstance {
    /// The first three rows.
    pub rows: [Vec4; 3],
}

impl GpuInstance {
    /// The rows of `world_from_object`.
    pub fn new(world_from_object: &Mat4) -> Self {
        Self { rows: [world_from_object.row(0), world_from_object.row(1), world_from_object.row(2)] }
    }
}

impl CasterStreams {
    /// Slot 0 of positions that have a buffer of their own: the default of [`CasterVertices`].
    pub const POSITIONS: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
        array_stride: 12,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &wgpu::vertex_attr_array![0 => Float32x3],
    };
    /// Slot 1.
    pub const INSTANCES: wgpu::VertexBufferLayout<'static> = INSTANCES;
    /// Slot 2 of cut-out casters.
    pub const UV_ALPHA: wgpu::VertexBufferLayout<'static> = UV_ALPHA;
}

/// How the vertices of casters come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct CasterVertices<'a> {
    /// Bytes from one position to the next in slot 0: 12 where positions have a buffer of their own, more where they stand among
    /// other attributes. A multiple of 4.
    pub stride: u64,
    /// Of a position: any that a shader reads as three floats or more. Default: `Float32x3`.
    pub format: wgpu::VertexFormat,
    /// Moves vertices: [`NO_DEFORM`] or a user's own (see [`caster_shader`]).
    pub deform: &'a str,
}

impl Default for CasterVertices<'_> {
    /// Positions alone, which nobody deforms.
    fn default() -> Self {
        Self { stride: 12, format: wgpu::VertexFormat::Float32x3, deform: NO_DEFORM }
    }
}

impl<'a> CasterVertices<'a> {
    /// The default, with a user's own deformation.
    pub fn deformed(deform: &'a str) -> Self {
        Self { deform, ..Self::default() }
    }

    /// The attribute of slot 0.
    pub(crate) fn attribute(&self) -> [wgpu::VertexAttribute; 1] {
        [wgpu::VertexAttribute { format: self.format, offset: 0, shader_location: 0 }]
    }

    /// Slot 0.
    pub(crate) fn positions<'b>(
        &self,
        attribute: &'b [wgpu::VertexAttribute; 1],
    ) -> wgpu::VertexBufferLayout<'b> {
        wgpu::VertexBufferLayout {
            array_stride: self.stride,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: attribute,
        }
    }
}

/// The comparison that keeps what is nearest, for depth tests and comparison samplers alike.
pub fn depth_compare() -> wgpu::CompareFunction {
    if DEPTH.is_reversed() { wgpu::CompareFunction::GreaterEqual } else { wgpu::CompareFunction::LessEqual }
}

/// Can maps be drawn without a near plane that cuts? What lies before it is then flattened onto it, and its shadow is whole. Needs
/// the optional feature `DEPTH_CLIP_CONTROL`; without it, casters nearer to the light than the near plane are cut off.
pub fn unclipped(device: &wgpu::Device) -> bool {
    device.features().contains(wgpu::Features::DEPTH_CLIP_CONTROL)
}

/// Mirrors `UmbrageCasterView` of `wgsl/caster_view.wgsl`; see there for what each field means. Group 0 of caster pipelines holds one for each
/// view, [`GpuCasterView::STRIDE`] bytes apart.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct GpuCasterView {
    /// World to clip space.
    pub clip_from_world: Mat4,
    /// Metres.
    pub near_m: f32,
    /// Metres.
    pub far_m: f32,
    /// 1 or 0.
    pub perspective: u32,
    /// Texels.
    pub offset_slope: f32,
    /// Stored depth.
    pub offset_depth: f32,
    /// Seconds.
    pub time_s: f32,
    /// Nothing.
    pub pad: [f32; 2],
}

impl GpuCasterView {
    /// Bytes from one view to the next: every device allows dynamic offsets of this many.
    pub const STRIDE: u32 = 256;

    /// What a planned pass draws a view with.
    pub fn new(view: &ShadowView, pass: &Pass, time_s: f32) -> Self {
        Self {
            clip_from_world: view.clip_from_world(),
            near_m: view.near_m,
            far_m: view.far_m,
            perspective: u32::from(view.perspective),
            offset_slope: pass.offset.slope.abs(),
            // Polygon offset counts in steps of the format; those of a 24-bit format stand for a float's.
            offset_depth: pass.offset.constant.unsigned_abs() as f32 * 2f32.powi(-24),
            time_s,
            pad: [0.0; 2],
        }
    }
}

/// Casters that nobody deforms.
pub const NO_DEFORM: &str = include_str!("../wgsl/deform.wgsl");

/// WGSL to stand before a shader of one's own that draws into maps: group 0 with a [`GpuCasterView`] (`umbrage_caster`), and
/// `fn umbrage_caster_color(depth: f32, slope: vec2f) -> vec4f` for maps that keep distance in colours.
pub fn caster_view_wgsl() -> String {
    let away = format!("const UMBRAGE_CASTER_AWAY = {:?};\n", DEPTH.away());
    [&away, include_str!("../wgsl/caster_view.wgsl")].join("\n")
}

/// The text of the caster shader, with a user's `fn umbrage_deform(p_world: vec3f, p_object: vec3f, time_s: f32) -> vec3f`.
pub fn caster_shader(deform: &str) -> String {
    [deform, &caster_view_wgsl(), include_str!("../wgsl/caster.wgsl")].join("\n")
}

/// Channels of 8 bits that a colour target keeps distance in; 0: one float keeps it.
pub(crate) fn channels(storage: Storage) -> f64 {
    match storage {
        Storage::Packed1 => 1.0,
        Storage::Packed2 => 2.0,
        Storage::Packed3 => 3.0,
        _ => 0.0,
    }
}

/// The polygon offset of a planned pass; colour targets take theirs in the shader.
pub(crate) fn depth_bias(storage: Storage, pass: &Pass) -> wgpu::DepthBiasState {
    if storage.is_color() {
        return wgpu::DepthBiasState::default();
    }
    wgpu::DepthBiasState { constant: pass.offset.constant, slope_scale: pass.offset.slope, clamp: 0.0 }
}

/// The same, and what draws behind a layer that was drawn before: see [`crate::peel`].
pub fn peel_shader(deform: &str) -> String {
    // All pipelines of the pass then begin with the same two groups: what is bound stays bound from one to the next.
    let caster = include_str!("../wgsl/caster.wgsl").replace("@group(1)", "@group(2)");
    [deform, &caster_view_wgsl(), &caster, include_str!("../wgsl/peel.wgsl")].join("\n")
}

/// The fragment shader of a pass, for solid casters or cut-out ones, depth or colour. `None`: depth is all that is drawn.
fn fragment_entry(keeps: Keeps, cut_out: bool, is_color: bool) -> Option<&'static str> {
    match (keeps, cut_out, is_color) {
        (Keeps::Nearest, false, false) => None,
        (Keeps::Nearest, true, false) => Some("fs_cut_out"),
        (Keeps::Nearest, false, true) => Some("fs_solid_color"),
        (Keeps::Nearest, true, true) => Some("fs_cut_out_color"),
        (Keeps::Behind, false, _) => Some("fs_behind"),
        (Keeps::Behind, true, _) => Some("fs_behind_cut_out"),
        (Keeps::Midpoint, false, false) => Some("fs_midpoint"),
        (Keeps::Midpoint, true, false) => Some("fs_midpoint_cut_out"),
        (Keeps::Midpoint, false, true) => Some("fs_midpoint_color"),
        (Keeps::Midpoint, true, true) => Some("fs_midpoint_cut_out_color"),
    }
}

/// Pipelines that draw casters, and the layouts that they take.
#[derive(Debug)]
pub struct CasterPipelines {
    /// Casters of which all faces are drawn.
    pub open: wgpu::RenderPipeline,
    /// Casters of which the pass leaves out one side, as its [`Cull`] says.
    pub closed: wgpu::RenderPipeline,
    /// The same, placed by a mirroring transform, which turns their winding.
    pub closed_mirrored: wgpu::RenderPipeline,
    /// Casters whose texture cuts holes.
    pub cut_out: wgpu::RenderPipeline,
    /// The group of [`Self::cut_out_layout`]: 1, or 2 where the pass keeps what lies behind a layer.
    pub cut_out_group: u32,
    /// Group 0: a [`GpuCasterView`], a uniform buffer with a dynamic offset.
    pub view_layout: wgpu::BindGroupLayout,
}

impl CasterPipelines {
    /// Group [`Self::cut_out_group`] of cut-out casters: base colour texture, its sampler.
    pub fn cut_out_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
        device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("umbrage cut-out caster"),
            entries: &[
                wgpu::BindGroupLayoutEntry {
                    binding: 0,
                    visibility: wgpu::ShaderStages::FRAGMENT,
                    ty: wgpu::BindingType::Texture {
                        sample_type: wgpu::TextureSampleType::Float { filterable: true },
                        view_dimension: wgpu::TextureViewDimension::D2,
                        multisampled: false,
                    },
                    count: None,
                },
                wgpu::BindGroupLayoutEntry {
                    binding: 1,
                    visibility: wgpu::ShaderStages::FRAGMENT,
                    ty: wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
                    count: None,
                },
            ],
        })
    }

    /// Makes the pipelines of a planned pass for maps of `format`. Those of passes that keep what lies behind a layer take it in
    /// group 1: [`crate::Peel::behind`]. `cut_out_layout` is [`Self::cut_out_layout`].
    pub fn new(
        device: &wgpu::Device,
        format: &ChosenFormat,
        pass: &Pass,
        cut_out_layout: &wgpu::BindGroupLayout,
        vertices: &CasterVertices<'_>,
    ) -> Self {
        let deform = vertices.deform;
        let attribute = vertices.attribute();
        let is_behind = pass.keeps != Keeps::Nearest;
        let shader = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("umbrage caster"),
            source: wgpu::ShaderSource::Wgsl(
                if is_behind { peel_shader(deform) } else { caster_shader(deform) }.into(),
            ),
        });
        let view_layout = view_layout(device);
        let layer_layout = is_behind.then(|| crate::peel::layer_layout(device));
        let is_color = format.storage.is_color();
        let constants = [("UMBRAGE_CHANNELS", channels(format.storage))];
        let color_target = [Some(wgpu::ColorTargetState::from(format.format))];
        let bias = depth_bias(format.storage, pass);
        let pipeline = |label, groups: &[Option<&wgpu::BindGroupLayout>], cut_out: bool, cull_mode| {
            let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(label),
                bind_group_layouts: groups,
                immediate_size: 0,
            });
            let buffers = [Some(vertices.positions(&attribute)), Some(INSTANCES), Some(UV_ALPHA)];
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(label),
                layout: Some(&layout),
                vertex: wgpu::VertexState {
                    module: &shader,
                    entry_point: Some(if cut_out { "vs_cut_out" } else { "vs_solid" }),
                    compilation_options: Default::default(),
                    buffers: if cut_out { &buffers } else { &buffers[..2] },
                },
                primitive: wgpu::PrimitiveState {
                    cull_mode,
                    unclipped_depth: unclipped(device),
                    ..Default::default()
                },
                depth_stencil: Some(wgpu::DepthStencilState {
                    format: if is_color { SCRATCH_DEPTH } else { format.format },
                    depth_write_enabled: Some(true),
                    depth_compare: Some(depth_compare()),
                    stencil: Default::default(),
                    bias,
                }),
                multisample: Default::default(),
                fragment: fragment_entry(pass.keeps, cut_out, is_color).map(|entry| wgpu::FragmentState {
                    module: &shader,
                    entry_point: Some(entry),
                    compilation_options: wgpu::PipelineCompilationOptions {
                        constants: if is_color { &constants } else { &[] },
                        ..Default::default()
                    },
                    targets: if is_color { &color_target } else { &[] },
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        let mut groups = vec![Some(&view_layout)];
        groups.extend(layer_layout.as_ref().map(Some));
        let cut_out_group = groups.len() as u32;
        groups.push(Some(cut_out_layout));
        let (solid, cut_out) = (&groups[..groups.len() - 1], &groups[..]);
        let (closed, mirrored) = match pass.cull {
            Cull::BackOfClosed => (Some(wgpu::Face::Back), Some(wgpu::Face::Front)),
            Cull::FrontOfClosed => (Some(wgpu::Face::Front), Some(wgpu::Face::Back)),
            Cull::Front | Cull::Back | Cull::Nothing | Cull::ByMaterial => (None, None),
        };
        Self {
            open: pipeline("umbrage open caster", solid, false, None),
            closed: pipeline("umbrage closed caster", solid, false, closed),
            closed_mirrored: pipeline("umbrage mirrored caster", solid, false, mirrored),
            cut_out: pipeline("umbrage cut-out caster", cut_out, true, None),
            cut_out_group,
            view_layout,
        }
    }
}

/// Group 0: one [`GpuCasterView`].
pub(crate) fn view_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("umbrage caster view"),
        entries: &[wgpu::BindGroupLayoutEntry {
            binding: 0,
            visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Uniform,
                has_dynamic_offset: true,
                min_binding_size: NonZeroU64::new(size_of::<GpuCasterView>() as u64),
            },
            count: None,
        }],
    })
}

/// Records the pass that draws one layer of the maps: clears it, then lets `draw` draw the casters.
pub fn record_caster_pass<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    maps: &ShadowMaps,
    layer: u32,
    pass: &Pass,
    timestamps: Option<wgpu::RenderPassTimestampWrites<'a>>,
    draw: impl FnOnce(&mut wgpu::RenderPass<'_>),
) {
    let Some(view) = maps.layer(layer) else { return };
    // Colour maps hold distance, and begin as far away as there is.
    let color = [Some(wgpu::RenderPassColorAttachment {
        view,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::WHITE), store: wgpu::StoreOp::Store },
    })];
    let (depth, store) = match maps.scratch() {
        Some(scratch) => (scratch, maps.scratch_store()),
        None => (view, wgpu::StoreOp::Store),
    };
    let mut recorded = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(pass.name),
        color_attachments: if maps.scratch().is_some() { &color } else { &[] },
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: depth,
            depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(pass.clear_depth), store }),
            stencil_ops: None,
        }),
        timestamp_writes: timestamps,
        occlusion_query_set: None,
        multiview_mask: None,
    });
    draw(&mut recorded);
}
