//! A blur of V on the screen that stops where surfaces end: mask, depth and colour stay apart, and only the mask is blurred
//! (Bjorke 2005, "Shadowing Strategies for HLSL and FX Composer", soft stencil shadows).

use glam::{IVec2, Mat4, Vec4};
use umbrage_core::DepthConvention;
use umbrage_core::wgsl::assemble;

/// How V is blurred.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Softness {
    /// How wide an edge becomes on the screen, 0 to 64 pixels. Counts where `width_m` is 0.
    pub width_px: f32,
    /// How wide it becomes on the surface, metres; 0: `width_px` counts.
    pub width_m: f32,
    /// How far two pixels' surfaces may be apart, as a share of the distance from the eye.
    pub like: f32,
}

/// Mirrors `Soften` of `wgsl/soften.wgsl`; see there for what each field means.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
struct GpuSoften {
    rows: Vec4,
    step: IVec2,
    width_px: f32,
    width_m: f32,
    px_per_m: f32,
    like: f32,
    nothing: f32,
    pad: f32,
}

/// What blurs V of one size, light by light, each in its own way.
#[derive(Debug)]
pub struct Softener {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    between: wgpu::TextureView,
    format: wgpu::TextureFormat,
    size_px: [u32; 2],
    depth: DepthConvention,
}

/// A light's V, ready to be blurred in place.
#[derive(Debug)]
pub struct SoftenedV {
    /// For rows, then for columns.
    uniforms: [wgpu::Buffer; 2],
    groups: [wgpu::BindGroup; 2],
}

fn shader() -> String {
    let library = assemble(&["like_depth"]).unwrap_or_else(|e| format!("// {e}\n"));
    [&library, include_str!("../wgsl/soften.wgsl")].join("\n")
}

/// What is blurred along rows, and not along columns yet.
fn between(
    device: &wgpu::Device,
    format: wgpu::TextureFormat,
    [width_px, height_px]: [u32; 2],
) -> wgpu::TextureView {
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("half blurred visibility"),
        size: wgpu::Extent3d { width: width_px, height: height_px, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    texture.create_view(&Default::default())
}

impl Softener {
    /// For V of `format` and so many pixels. `depth` is the way in which the depth of the surfaces runs, cleared to
    /// [`DepthConvention::clear`] where nothing is. Memory: one more layer of V.
    pub fn new(
        device: &wgpu::Device,
        format: wgpu::TextureFormat,
        size_px: [u32; 2],
        depth: DepthConvention,
    ) -> Self {
        let texture = |binding, sample_type| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty: wgpu::BindingType::Texture {
                sample_type,
                view_dimension: wgpu::TextureViewDimension::D2,
                multisampled: false,
            },
            count: None,
        };
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("umbrage soften"),
            entries: &[
                wgpu::BindGroupLayoutEntry {
                    binding: 0,
                    visibility: wgpu::ShaderStages::FRAGMENT,
                    ty: wgpu::BindingType::Buffer {
                        ty: wgpu::BufferBindingType::Uniform,
                        has_dynamic_offset: false,
                        min_binding_size: std::num::NonZeroU64::new(size_of::<GpuSoften>() as u64),
                    },
                    count: None,
                },
                texture(1, wgpu::TextureSampleType::Float { filterable: false }),
                texture(2, wgpu::TextureSampleType::Depth),
            ],
        });
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("umbrage soften"),
            source: wgpu::ShaderSource::Wgsl(shader().into()),
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("umbrage soften"),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("umbrage soften"),
            layout: Some(&pipeline_layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vs_screen"),
                compilation_options: Default::default(),
                buffers: &[],
            },
            primitive: Default::default(),
            depth_stencil: None,
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("fs_soften"),
                compilation_options: Default::default(),
                targets: &[Some(format.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        Self { pipeline, layout, between: between(device, format, size_px), format, size_px, depth }
    }

    /// Makes room for V of another size; nothing where it is the same. What [`Self::of`] made for the old size cannot be used any
    /// more.
    pub fn resize(&mut self, device: &wgpu::Device, size_px: [u32; 2]) {
        if self.size_px != size_px {
            self.between = between(device, self.format, size_px);
            self.size_px = size_px;
        }
    }

    /// A light's V, and the depth of the surfaces that it is V of: the depth aspect alone.
    pub fn of(&self, device: &wgpu::Device, v: &wgpu::TextureView, depth: &wgpu::TextureView) -> SoftenedV {
        let uniform = |label| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: size_of::<GpuSoften>() as u64,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let group = |uniform: &wgpu::Buffer, source| {
            device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("umbrage soften"),
                layout: &self.layout,
                entries: &[
                    wgpu::BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() },
                    wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(source) },
                    wgpu::BindGroupEntry { binding: 2, resource: wgpu::BindingResource::TextureView(depth) },
                ],
            })
        };
        let uniforms = [uniform("soften rows"), uniform("soften columns")];
        SoftenedV { groups: [group(&uniforms[0], v), group(&uniforms[1], &self.between)], uniforms }
    }

    /// Says how a light's V is blurred, and from where it is seen: from the next submission on.
    pub fn write(&self, queue: &wgpu::Queue, v: &SoftenedV, softness: &Softness, clip_from_view: &Mat4) {
        let (z, w) = (clip_from_view.row(2), clip_from_view.row(3));
        for (uniform, step) in v.uniforms.iter().zip([IVec2::X, IVec2::Y]) {
            let made = GpuSoften {
                rows: Vec4::new(z.z, z.w, w.z, w.w),
                step,
                width_px: softness.width_px,
                width_m: softness.width_m,
                px_per_m: 0.5 * self.size_px[1] as f32 * clip_from_view.y_axis.y.abs(),
                like: softness.like,
                nothing: self.depth.clear(),
                pad: 0.0,
            };
            queue.write_buffer(uniform, 0, bytemuck::bytes_of(&made));
        }
    }

    /// Memory, bytes.
    pub fn memory_bytes(&self) -> u64 {
        let [width_px, height_px] = self.size_px.map(u64::from);
        width_px * height_px * u64::from(self.format.block_copy_size(None).unwrap_or(1))
    }
}

/// Records one of the two passes that blur a light's V in place: along rows, then along columns. `draw` calls [`soften`].
pub fn record_soften(
    encoder: &mut wgpu::CommandEncoder,
    softener: &Softener,
    v: &wgpu::TextureView,
    columns: bool,
    timestamps: Option<wgpu::RenderPassTimestampWrites<'_>>,
    draw: impl FnOnce(&mut wgpu::RenderPass<'_>),
) {
    let mut recorded = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(if columns { "blur-columns" } else { "blur-rows" }),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: if columns { v } else { &softener.between },
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                store: wgpu::StoreOp::Store,
            },
        })],
        depth_stencil_attachment: None,
        timestamp_writes: timestamps,
        occlusion_query_set: None,
        multiview_mask: None,
    });
    draw(&mut recorded);
}

/// Blurs along rows or columns.
pub fn soften(recorded: &mut wgpu::RenderPass<'_>, softener: &Softener, v: &SoftenedV, columns: bool) {
    recorded.set_pipeline(&softener.pipeline);
    recorded.set_bind_group(0, &v.groups[usize::from(columns)], &[]);
    recorded.draw(0..3, 0..1);
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::mem::offset_of;

    #[test]
    fn the_shader_validates_and_the_mirror_has_its_offsets() {
        let text = shader();
        let module =
            naga::front::wgsl::parse_str(&text).unwrap_or_else(|e| panic!("{}", e.emit_to_string(&text)));
        naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::empty())
            .validate(&module)
            .unwrap_or_else(|e| panic!("{}", e.emit_to_string(&text)));
        let found = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some("Soften"));
        let naga::TypeInner::Struct { members, span } = &found.expect("the struct").1.inner else { panic!() };
        let shader: Vec<_> =
            members.iter().map(|m| (m.name.as_deref().unwrap_or(""), m.offset as usize)).collect();
        let mirror = vec![
            ("rows", offset_of!(GpuSoften, rows)),
            ("step", offset_of!(GpuSoften, step)),
            ("width_px", offset_of!(GpuSoften, width_px)),
            ("width_m", offset_of!(GpuSoften, width_m)),
            ("px_per_m", offset_of!(GpuSoften, px_per_m)),
            ("like", offset_of!(GpuSoften, like)),
            ("nothing", offset_of!(GpuSoften, nothing)),
            ("pad", offset_of!(GpuSoften, pad)),
        ];
        assert_eq!(shader, mirror);
        assert_eq!(*span as usize, size_of::<GpuSoften>());
    }
}
