//! The renderer's own pipelines.

use crate::layout::{GpuFrame, GpuFullVertex, GpuLight, MAX_LIGHTS};
use crate::materials::Variant;
use crate::options::View;
use crate::shaders::{self, MOST_UNIFORM_VIEWS, ShaderNeeds};
use std::collections::HashMap;
use std::num::NonZeroU64;
use umbrage::CasterStreams;
use umbrage::core::layout::GpuView;
use umbrage::mask::GpuMaskList;

/// The G-buffer: one texel a pixel, see `wgsl/surface.wgsl`.
pub const GBUFFER: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Uint;
/// Each pixel's object, where masks have to know it.
pub const OBJECT: wgpu::TextureFormat = wgpu::TextureFormat::R32Uint;
/// The picture's depth, where nothing is counted over it.
pub const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// The picture.
pub const COLOR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;
/// Views that are numbers, not colour.
pub const GREY: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
/// Texels per pixel, unrounded: see `wgsl/density.wgsl`.
pub const DENSITY: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;
/// Faces of volumes, added up: see `overdraw.rs`. Every device adds to it, and it counts to 2048 exactly.
pub const OVERDRAW: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
/// V, unrounded.
pub const VISIBILITY: wgpu::TextureFormat = wgpu::TextureFormat::R32Float;
/// V where it is a colour, unrounded.
pub const VISIBILITY_RGB: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

/// The format that a view is drawn in; `colors_light`: V is a colour.
pub fn format_of(view: View, colors_light: bool) -> wgpu::TextureFormat {
    match view {
        View::Final | View::Light => COLOR,
        View::Visibility if colors_light => VISIBILITY_RGB,
        View::Visibility => VISIBILITY,
        View::Density | View::DensityLight => DENSITY,
        View::Volumes => OVERDRAW,
        View::Depth | View::Distance | View::Projected | View::Channels => GREY,
    }
}

/// Layouts of the bind groups.
#[derive(Debug)]
pub struct Layouts {
    /// Group 0: frame, lights, views, maps, slides, maps of translucent casters and of colours.
    pub frame: wgpu::BindGroupLayout,
    /// Group 1 of mesh pipelines.
    pub material: wgpu::BindGroupLayout,
    /// Group 1 of screen pipelines: G-buffer and depth.
    pub gbuffer: wgpu::BindGroupLayout,
    /// Are maps colour targets?
    pub color_maps: bool,
    /// Is each pixel's object kept?
    pub objects: bool,
}

fn uniform(bytes: usize) -> wgpu::BindingType {
    wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: NonZeroU64::new(bytes as u64),
    }
}

fn texture(
    sample_type: wgpu::TextureSampleType,
    view_dimension: wgpu::TextureViewDimension,
) -> wgpu::BindingType {
    wgpu::BindingType::Texture { sample_type, view_dimension, multisampled: false }
}

impl Layouts {
    /// Makes the layouts, for maps that are colour targets or depth textures, and so many views; with `objects` masks are looked up,
    /// and each pixel's object is kept.
    pub fn new(device: &wgpu::Device, color_maps: bool, views: usize, objects: bool) -> Self {
        let group = |label, visibility, types: &[wgpu::BindingType]| {
            let entries: Vec<_> = (0u32..)
                .zip(types)
                .map(|(binding, ty)| wgpu::BindGroupLayoutEntry { binding, visibility, ty: *ty, count: None })
                .collect();
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some(label),
                entries: &entries,
            })
        };
        use wgpu::{SamplerBindingType, ShaderStages, TextureSampleType, TextureViewDimension};
        let kept = if color_maps {
            TextureSampleType::Float { filterable: false }
        } else {
            TextureSampleType::Depth
        };
        let maps = texture(kept, TextureViewDimension::D2Array);
        let masks = [
            uniform(size_of::<GpuMaskList>()),
            texture(TextureSampleType::Float { filterable: true }, TextureViewDimension::D2Array),
            wgpu::BindingType::Sampler(SamplerBindingType::Filtering),
        ];
        let masks = if objects { &masks[..] } else { &[] };
        Self {
            color_maps,
            objects,
            frame: group(
                "frame",
                ShaderStages::VERTEX_FRAGMENT,
                &[
                    uniform(size_of::<GpuFrame>()),
                    uniform(size_of::<GpuLight>() * MAX_LIGHTS),
                    if views <= MOST_UNIFORM_VIEWS {
                        uniform(size_of::<GpuView>() * views.max(1))
                    } else {
                        wgpu::BindingType::Buffer {
                            ty: wgpu::BufferBindingType::Storage { read_only: true },
                            has_dynamic_offset: false,
                            min_binding_size: NonZeroU64::new(size_of::<GpuView>() as u64),
                        }
                    },
                    maps,
                    wgpu::BindingType::Sampler(SamplerBindingType::Comparison),
                    texture(TextureSampleType::Float { filterable: true }, TextureViewDimension::D2Array),
                    wgpu::BindingType::Sampler(SamplerBindingType::Filtering),
                    texture(TextureSampleType::Float { filterable: false }, TextureViewDimension::D2Array),
                    wgpu::BindingType::Sampler(SamplerBindingType::NonFiltering),
                    maps,
                    texture(TextureSampleType::Float { filterable: false }, TextureViewDimension::D2Array),
                ]
                .iter()
                .chain(masks)
                .copied()
                .collect::<Vec<_>>(),
            ),
            material: crate::materials::layout(device),
            gbuffer: group(
                "gbuffer",
                ShaderStages::FRAGMENT,
                &[
                    texture(TextureSampleType::Uint, TextureViewDimension::D2),
                    texture(TextureSampleType::Depth, TextureViewDimension::D2),
                    texture(TextureSampleType::Uint, TextureViewDimension::D2),
                ][..if objects { 3 } else { 2 }],
            ),
        }
    }
}

/// Where mesh pipelines draw to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MeshTarget {
    /// Surfaces into the G-buffer, lit afterwards.
    Gbuffer,
    /// Lit at once.
    Forward {
        /// Samples a pixel.
        samples: u32,
    },
}

/// Mesh pipelines by variant, made when first asked for.
#[derive(Debug)]
pub struct MeshPipelines {
    depth: wgpu::TextureFormat,
    objects: bool,
    shader: wgpu::ShaderModule,
    layout: wgpu::PipelineLayout,
    made: HashMap<(MeshTarget, Variant), wgpu::RenderPipeline>,
}

const NORMALS: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: 12,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &wgpu::vertex_attr_array![4 => Float32x3],
};
const OBJECTS: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: 4,
    step_mode: wgpu::VertexStepMode::Instance,
    attributes: &wgpu::vertex_attr_array![8 => Uint32],
};
const FULL: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: size_of::<GpuFullVertex>() as u64,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &wgpu::vertex_attr_array![4 => Float32x3, 5 => Float32x4, 6 => Unorm8x4, 7 => Float32x4],
};

impl MeshPipelines {
    /// Compiles the shader, for targets with that depth.
    pub fn new(
        device: &wgpu::Device,
        layouts: &Layouts,
        needs: &ShaderNeeds,
        depth: wgpu::TextureFormat,
    ) -> Self {
        let shader = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("mesh"),
            source: wgpu::ShaderSource::Wgsl(shaders::mesh(needs).into()),
        });
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("mesh"),
            bind_group_layouts: &[Some(&layouts.frame), Some(&layouts.material)],
            immediate_size: 0,
        });
        Self { depth, objects: layouts.objects, shader, layout, made: HashMap::new() }
    }

    /// Makes the pipelines of these variants, so that a frame finds them.
    pub fn prepare(
        &mut self,
        device: &wgpu::Device,
        target: MeshTarget,
        variants: impl Iterator<Item = Variant>,
    ) {
        for variant in variants {
            if !self.made.contains_key(&(target, variant)) {
                let pipeline = self.make(device, target, variant);
                self.made.insert((target, variant), pipeline);
            }
        }
    }

    /// The pipeline of a prepared variant.
    pub fn get(&self, target: MeshTarget, variant: Variant) -> Option<&wgpu::RenderPipeline> {
        self.made.get(&(target, variant))
    }

    fn make(&self, device: &wgpu::Device, target: MeshTarget, variant: Variant) -> wgpu::RenderPipeline {
        let constants: Vec<(&str, f64)> = [
            ("HAS_BASE_TEXTURE", variant.textures[0]),
            ("HAS_METALLIC_ROUGHNESS_TEXTURE", variant.textures[1]),
            ("HAS_NORMAL_TEXTURE", variant.textures[2]),
            ("HAS_EMISSIVE_TEXTURE", variant.textures[3]),
            ("IS_CUT_OUT", variant.cut_out),
            ("IS_DOUBLE_SIDED", variant.double_sided),
            ("IS_EXEMPT", variant.exempt),
        ]
        .map(|(name, on)| (name, f64::from(u8::from(on))))
        .to_vec();
        let compilation_options =
            wgpu::PipelineCompilationOptions { constants: &constants, ..Default::default() };
        // Alpha mixes and cuts out; the picture itself is opaque, as it was cleared.
        let write_mask = match target {
            MeshTarget::Gbuffer => wgpu::ColorWrites::ALL,
            MeshTarget::Forward { .. } => wgpu::ColorWrites::COLOR,
        };
        let (entry_point, format, samples) = match (target, variant.full) {
            (MeshTarget::Gbuffer, false) => ("fs_gbuffer_plain", GBUFFER, 1),
            (MeshTarget::Gbuffer, true) => ("fs_gbuffer_full", GBUFFER, 1),
            (MeshTarget::Forward { samples }, false) => ("fs_forward_plain", COLOR, samples),
            (MeshTarget::Forward { samples }, true) => ("fs_forward_full", COLOR, samples),
        };
        let buffers = [
            Some(CasterStreams::POSITIONS),
            Some(CasterStreams::INSTANCES),
            Some(if variant.full { FULL } else { NORMALS }),
            Some(OBJECTS),
        ];
        let targets = [
            Some(wgpu::ColorTargetState {
                format,
                blend: variant.blend.then_some(wgpu::BlendState::ALPHA_BLENDING),
                write_mask,
            }),
            Some(OBJECT.into()),
        ];
        let targets =
            if self.objects && target == MeshTarget::Gbuffer { &targets[..] } else { &targets[..1] };
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(entry_point),
            layout: Some(&self.layout),
            vertex: wgpu::VertexState {
                module: &self.shader,
                entry_point: Some(if variant.full { "vs_full" } else { "vs_plain" }),
                compilation_options: compilation_options.clone(),
                buffers: if self.objects { &buffers } else { &buffers[..3] },
            },
            primitive: wgpu::PrimitiveState {
                front_face: if variant.mirrored { wgpu::FrontFace::Cw } else { wgpu::FrontFace::Ccw },
                cull_mode: (!variant.double_sided).then_some(wgpu::Face::Back),
                ..Default::default()
            },
            depth_stencil: Some(wgpu::DepthStencilState {
                format: self.depth,
                depth_write_enabled: Some(!variant.blend),
                depth_compare: Some(umbrage::caster::depth_compare()),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: wgpu::MultisampleState { count: samples, ..Default::default() },
            fragment: Some(wgpu::FragmentState {
                module: &self.shader,
                entry_point: Some(entry_point),
                compilation_options,
                targets,
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

/// The pipeline that makes a view from the G-buffer.
pub fn screen_pipeline(
    device: &wgpu::Device,
    layouts: &Layouts,
    needs: &ShaderNeeds,
    view: View,
    depth: wgpu::TextureFormat,
) -> wgpu::RenderPipeline {
    let shader = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("screen"),
        source: wgpu::ShaderSource::Wgsl(shaders::screen(needs).into()),
    });
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("screen"),
        bind_group_layouts: &[Some(&layouts.frame), Some(&layouts.gbuffer)],
        immediate_size: 0,
    });
    let entry_point = match view {
        View::Final | View::Light => "fs_final",
        View::Visibility => "fs_visibility",
        View::Depth => "fs_depth",
        View::Distance => "fs_distance",
        View::Projected => "fs_projected",
        View::Channels => "fs_channels",
        View::Density => "fs_density",
        View::DensityLight => "fs_density_light",
        View::Volumes => "fs_volumes",
    };
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(entry_point),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &shader,
            entry_point: Some("vs_screen"),
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: Default::default(),
        // The triangle lies where nothing is, so only pixels that show a surface run the shader; the map itself
        // covers all.
        depth_stencil: Some(wgpu::DepthStencilState {
            format: depth,
            depth_write_enabled: Some(false),
            depth_compare: Some(match view {
                View::Depth | View::Channels | View::DensityLight => wgpu::CompareFunction::Always,
                _ => wgpu::CompareFunction::NotEqual,
            }),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &shader,
            entry_point: Some(entry_point),
            compilation_options: Default::default(),
            targets: &[Some(format_of(view, needs.colors_light()).into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}
