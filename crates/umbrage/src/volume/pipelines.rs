//! The pipelines of volumes.

use super::light::GpuVolumeCaster;
use super::mesh::SPLIT_VERTICES;
use super::{Counted, Faces, Winding};
use crate::caster::unclipped;
use std::collections::HashMap;
use std::num::NonZeroU64;
use umbrage_core::DepthConvention;
use umbrage_core::technique::volume::Silhouette;
use umbrage_core::wgsl::assemble;

/// Depth formats with a stencil, best first.
pub const COUNT_FORMATS: [wgpu::TextureFormat; 2] =
    [wgpu::TextureFormat::Depth32FloatStencil8, wgpu::TextureFormat::Depth24PlusStencil8];

/// The best of [`COUNT_FORMATS`] that a device has; every device has the second.
pub fn choose_count_format(device: &wgpu::Device) -> wgpu::TextureFormat {
    let best = device.features().contains(wgpu::Features::DEPTH32FLOAT_STENCIL8);
    COUNT_FORMATS[usize::from(!best)]
}

/// The text of the shader that draws volumes.
pub(crate) fn volume_shader() -> String {
    let library = assemble(&["extrude"]).unwrap_or_else(|e| format!("// {e}\n"));
    [&library, include_str!("../../wgsl/volume_caster.wgsl"), include_str!("../../wgsl/volume.wgsl")]
        .join("\n")
}

/// The text of the shader that finds their faces.
pub(crate) fn silhouette_shader() -> String {
    let library = assemble(&["extrude"]).unwrap_or_else(|e| format!("// {e}\n"));
    [&library, include_str!("../../wgsl/volume_caster.wgsl"), include_str!("../../wgsl/silhouettes.wgsl")]
        .join("\n")
}

/// Everything that draws volumes.
#[derive(Debug)]
pub struct VolumePipelines {
    /// How faces are found.
    pub silhouette: Silhouette,
    depth: DepthConvention,
    pub(super) silhouettes: Option<wgpu::ComputePipeline>,
    counts: HashMap<(Counted, Faces, Winding), wgpu::RenderPipeline>,
    pub(super) visibility: wgpu::RenderPipeline,
    pub(super) silhouette_layout: wgpu::BindGroupLayout,
    pub(super) edge_layout: wgpu::BindGroupLayout,
    pub(super) draw_layout: wgpu::BindGroupLayout,
    pub(super) position_layout: wgpu::BindGroupLayout,
    shader: wgpu::ShaderModule,
    layout: wgpu::PipelineLayout,
}

fn buffer(ty: wgpu::BufferBindingType, has_dynamic_offset: bool, bytes: usize) -> wgpu::BindingType {
    wgpu::BindingType::Buffer { ty, has_dynamic_offset, min_binding_size: NonZeroU64::new(bytes as u64) }
}

fn group(
    device: &wgpu::Device,
    label: &str,
    visibility: wgpu::ShaderStages,
    types: &[wgpu::BindingType],
) -> wgpu::BindGroupLayout {
    let entries: Vec<_> = (0u32..)
        .zip(types)
        .map(|(binding, ty)| wgpu::BindGroupLayoutEntry { binding, visibility, ty: *ty, count: None })
        .collect();
    device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
}

/// What a face does to the stencil.
fn face(counted: Counted, up: bool) -> wgpu::StencilFaceState {
    use wgpu::StencilOperation::{DecrementWrap, IncrementWrap, Keep};
    let op = if up { IncrementWrap } else { DecrementWrap };
    let (depth_fail_op, pass_op) = match counted {
        Counted::Behind => (op, Keep),
        Counted::Before => (Keep, op),
    };
    wgpu::StencilFaceState { compare: wgpu::CompareFunction::Always, fail_op: Keep, depth_fail_op, pass_op }
}

/// Moves faces away from the eye by what the depths of a lid and of its surface may differ in where they are drawn in another
/// order, turned or clipped: some steps of the format, and where a plane is steep the rounding of its slope over a wide picture.
/// No edge of a shadow moves by more than a thirty-second of a pixel.
fn behind(depth: DepthConvention) -> wgpu::DepthBiasState {
    let away = depth.away();
    wgpu::DepthBiasState { constant: 8 * away as i32, slope_scale: 0.0, clamp: 0.0 }
}

impl VolumePipelines {
    /// Makes pipelines over a depth of `format`, one of [`COUNT_FORMATS`], that write V to targets of `v_format`. `depth` is the way
    /// in which the caller's depth buffer runs, and its projection with it; [`DepthConvention::OpenGl`] is read as
    /// [`DepthConvention::ZeroToOne`], because wgpu cuts at 0.
    pub fn new(
        device: &wgpu::Device,
        silhouette: Silhouette,
        format: wgpu::TextureFormat,
        v_format: wgpu::TextureFormat,
        depth: DepthConvention,
    ) -> Self {
        use wgpu::BufferBindingType::{Storage, Uniform};
        use wgpu::ShaderStages;
        let caster = buffer(Uniform, true, size_of::<GpuVolumeCaster>());
        let read = buffer(Storage { read_only: true }, false, 4);
        let write = buffer(Storage { read_only: false }, false, 4);
        let wide = buffer(Storage { read_only: true }, false, 16);
        let silhouette_layout = group(device, "silhouettes", ShaderStages::COMPUTE, &[caster, write, write]);
        let edge_layout = group(device, "volume edges", ShaderStages::COMPUTE, &[wide, wide, wide]);
        let draw_layout =
            group(device, "volumes", ShaderStages::VERTEX, &[caster, buffer(Uniform, false, 64)]);
        let position_layout = group(device, "volume positions", ShaderStages::VERTEX, &[read]);
        let module = |label, text: String| {
            device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(label),
                source: wgpu::ShaderSource::Wgsl(text.into()),
            })
        };
        let pipeline_layout = |label, groups: &[Option<&wgpu::BindGroupLayout>]| {
            device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(label),
                bind_group_layouts: groups,
                immediate_size: 0,
            })
        };
        let silhouettes = (silhouette == Silhouette::Compute).then(|| {
            device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some("silhouettes"),
                layout: Some(&pipeline_layout(
                    "silhouettes",
                    &[Some(&silhouette_layout), Some(&edge_layout)],
                )),
                module: &module("silhouettes", silhouette_shader()),
                entry_point: Some("silhouettes"),
                compilation_options: Default::default(),
                cache: None,
            })
        });
        let shader = module("volumes", volume_shader());
        let layout = pipeline_layout("volumes", &[Some(&draw_layout), Some(&position_layout)]);
        let mut made = Self {
            silhouette,
            depth,
            silhouettes,
            counts: HashMap::new(),
            visibility: visibility(device, &shader, &pipeline_layout("visibility", &[]), format, v_format),
            silhouette_layout,
            edge_layout,
            draw_layout,
            position_layout,
            shader,
            layout,
        };
        for counted in [Counted::Behind, Counted::Before] {
            for faces in [Faces::Both, Faces::Front, Faces::Back] {
                for winding in [Winding::AsIs, Winding::Turned] {
                    let pipeline = made.make_counts(device, format, counted, faces, winding);
                    made.counts.insert((counted, faces, winding), pipeline);
                }
            }
        }
        made
    }

    /// Which way the depth runs that is counted over.
    pub fn depth(&self) -> DepthConvention {
        self.depth
    }

    /// Does a compute pass find faces?
    pub(super) fn finds_faces(&self) -> bool {
        self.silhouettes.is_some()
    }

    pub(super) fn counts(&self, counted: Counted, faces: Faces, winding: Winding) -> &wgpu::RenderPipeline {
        &self.counts[&(counted, faces, winding)]
    }

    fn make_counts(
        &self,
        device: &wgpu::Device,
        format: wgpu::TextureFormat,
        counted: Counted,
        faces: Faces,
        winding: Winding,
    ) -> wgpu::RenderPipeline {
        let front = face(counted, counted.front_counts_up());
        let back = face(counted, !counted.front_counts_up());
        // What lies before the near plane is behind no surface, so that counting behind needs nothing cut. Counting before begins at
        // the near plane: between it and the eye there may be a caster's lid that nobody sees, and the eye may be in a shadow.
        let whole = counted == Counted::Behind && unclipped(device);
        self.make_clipped(
            device,
            winding,
            !whole,
            match faces {
                Faces::Both => None,
                Faces::Front => Some(wgpu::Face::Back),
                Faces::Back => Some(wgpu::Face::Front),
            },
            wgpu::DepthStencilState {
                format,
                depth_write_enabled: Some(false),
                // Both ways to count have one test, and differ in what they do with its outcome.
                depth_compare: Some(Counted::Before.depth_compare(self.depth)),
                stencil: wgpu::StencilState { front, back, read_mask: 0xff, write_mask: 0xff },
                bias: behind(self.depth),
            },
            None,
        )
    }

    /// A pipeline that draws volumes in another state, for whoever wants to see them.
    pub fn make(
        &self,
        device: &wgpu::Device,
        winding: Winding,
        cull_mode: Option<wgpu::Face>,
        depth_stencil: wgpu::DepthStencilState,
        fragment: Option<wgpu::FragmentState<'_>>,
    ) -> wgpu::RenderPipeline {
        self.make_clipped(device, winding, !unclipped(device), cull_mode, depth_stencil, fragment)
    }

    fn make_clipped(
        &self,
        device: &wgpu::Device,
        winding: Winding,
        clipped: bool,
        cull_mode: Option<wgpu::Face>,
        depth_stencil: wgpu::DepthStencilState,
        fragment: Option<wgpu::FragmentState<'_>>,
    ) -> wgpu::RenderPipeline {
        let split = [Some(SPLIT_VERTICES)];
        let is_split = self.silhouette == Silhouette::Vertex;
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("volumes"),
            layout: Some(&self.layout),
            vertex: wgpu::VertexState {
                module: &self.shader,
                entry_point: Some(if is_split { "vs_split" } else { "vs_quads" }),
                compilation_options: Default::default(),
                buffers: if is_split { &split } else { &[] },
            },
            primitive: wgpu::PrimitiveState {
                front_face: match winding {
                    Winding::AsIs => wgpu::FrontFace::Ccw,
                    Winding::Turned => wgpu::FrontFace::Cw,
                },
                cull_mode,
                unclipped_depth: !clipped,
                ..Default::default()
            },
            depth_stencil: Some(depth_stencil),
            multisample: Default::default(),
            fragment,
            multiview_mask: None,
            cache: None,
        })
    }
}

fn visibility(
    device: &wgpu::Device,
    shader: &wgpu::ShaderModule,
    layout: &wgpu::PipelineLayout,
    format: wgpu::TextureFormat,
    v_format: wgpu::TextureFormat,
) -> wgpu::RenderPipeline {
    let uncounted = wgpu::StencilFaceState { compare: wgpu::CompareFunction::Equal, ..Default::default() };
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("visibility"),
        layout: Some(layout),
        vertex: wgpu::VertexState {
            module: shader,
            entry_point: Some("vs_screen"),
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: Default::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format,
            depth_write_enabled: Some(false),
            depth_compare: Some(wgpu::CompareFunction::Always),
            stencil: wgpu::StencilState { front: uncounted, back: uncounted, read_mask: 0xff, write_mask: 0 },
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: shader,
            entry_point: Some("fs_lit"),
            compilation_options: Default::default(),
            targets: &[Some(v_format.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::mem::offset_of;

    fn validated(text: &str) -> naga::Module {
        let module =
            naga::front::wgsl::parse_str(text).unwrap_or_else(|e| panic!("{}", e.emit_to_string(text)));
        naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::empty())
            .validate(&module)
            .unwrap_or_else(|e| panic!("{}", e.emit_to_string(text)));
        module
    }

    #[test]
    fn shaders_validate_and_the_mirror_has_their_offsets() {
        for text in [volume_shader(), silhouette_shader()] {
            let module = validated(&text);
            let found = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some("VolumeCaster"));
            let naga::TypeInner::Struct { members, span } = &found.expect("the struct").1.inner else {
                panic!("no struct");
            };
            let shader: Vec<_> =
                members.iter().map(|m| (m.name.as_deref().unwrap_or(""), m.offset as usize)).collect();
            let mirror = vec![
                ("row_x", offset_of!(GpuVolumeCaster, rows)),
                ("row_y", offset_of!(GpuVolumeCaster, rows) + 16),
                ("row_z", offset_of!(GpuVolumeCaster, rows) + 32),
                ("light_object", offset_of!(GpuVolumeCaster, light_object)),
                ("light_world", offset_of!(GpuVolumeCaster, light_world)),
                ("far_plane", offset_of!(GpuVolumeCaster, far_plane)),
                ("inset_m", offset_of!(GpuVolumeCaster, inset_m)),
                ("extrude_m", offset_of!(GpuVolumeCaster, extrude_m)),
                ("triangles", offset_of!(GpuVolumeCaster, triangles)),
                ("edges", offset_of!(GpuVolumeCaster, edges)),
                ("first_index", offset_of!(GpuVolumeCaster, first_index)),
                ("first_count", offset_of!(GpuVolumeCaster, first_count)),
                ("flags", offset_of!(GpuVolumeCaster, flags)),
                ("reversed", offset_of!(GpuVolumeCaster, reversed)),
                ("first_back", offset_of!(GpuVolumeCaster, first_back)),
                ("pad_x", offset_of!(GpuVolumeCaster, pad)),
                ("pad_y", offset_of!(GpuVolumeCaster, pad) + 4),
                ("pad_z", offset_of!(GpuVolumeCaster, pad) + 8),
            ];
            assert_eq!(shader, mirror);
            assert_eq!(*span as usize, size_of::<GpuVolumeCaster>());
        }
    }
}
