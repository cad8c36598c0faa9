//! Casters that the caller draws itself, into maps of every storage, beside those of registered meshes.

use crate::common::*;
use glam::{Mat4, Vec3};
use umbrage::caster::caster_view_wgsl;
use umbrage::core::Aabb;
use umbrage::shadows::{OwnDraw, OwnTarget};
use umbrage::{CasterHandle, Shadows, ShadowsOptions};
use wgpu::util::DeviceExt;

/// The caller's own way to draw a box: corners that are computed, no buffer of positions.
struct Own {
    boxes: Vec<(CasterHandle, wgpu::BindGroup)>,
    layout: wgpu::PipelineLayout,
    made: Vec<(OwnTarget, wgpu::RenderPipeline)>,
    calls: usize,
}

const OWN: &str = "
@group(1) @binding(0) var<uniform> world_from_box: mat4x4f;

@vertex
fn vs(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    var corners = array<u32, 36>(
        0u, 2u, 3u, 0u, 3u, 1u, 4u, 5u, 7u, 4u, 7u, 6u, 0u, 1u, 5u, 0u, 5u, 4u,
        2u, 6u, 7u, 2u, 7u, 3u, 0u, 4u, 6u, 0u, 6u, 2u, 1u, 3u, 7u, 1u, 7u, 5u);
    let bits = corners[i];
    let p = vec3f(f32(bits & 1u), f32((bits >> 1u) & 1u), f32(bits >> 2u)) * 2.0 - 1.0;
    return umbrage_caster.clip_from_world * (world_from_box * vec4f(p, 1.0));
}

@fragment
fn fs(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return umbrage_caster_color(position.z, vec2f(dpdx(position.z), dpdy(position.z)));
}
";

impl Own {
    fn new(gpu: &Gpu, shadows: &mut Shadows, boxes: &[(Vec3, Vec3)]) -> Self {
        let own = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: None,
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::VERTEX,
                ty: wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Uniform,
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
                count: None,
            }],
        });
        let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &[Some(shadows.own_draw_layout()), Some(&own)],
            immediate_size: 0,
        });
        let add = |(at, half): &(Vec3, Vec3)| {
            let matrix: Mat4 = placed(*at, *half);
            let uniform = gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: None,
                contents: bytemuck::bytes_of(&matrix),
                usage: wgpu::BufferUsages::UNIFORM,
            });
            let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: None,
                layout: &own,
                entries: &[wgpu::BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() }],
            });
            let bounds = Aabb { min: *at - *half, max: *at + *half };
            (shadows.add_own_caster(bounds).expect("a caster"), group)
        };
        Self { boxes: boxes.iter().map(add).collect(), layout, made: Vec::new(), calls: 0 }
    }

    fn draw(&mut self, gpu: &Gpu, asked: &OwnDraw<'_>, pass: &mut wgpu::RenderPass<'_>) {
        self.calls += 1;
        let made = self.made.iter().position(|(target, _)| *target == asked.target).unwrap_or_else(|| {
            let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: None,
                source: wgpu::ShaderSource::Wgsl((caster_view_wgsl() + OWN).into()),
            });
            let constants = [("UMBRAGE_CHANNELS", asked.target.channels)];
            let pipeline = gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: None,
                layout: Some(&self.layout),
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: None,
                    compilation_options: Default::default(),
                    buffers: &[],
                },
                primitive: Default::default(),
                depth_stencil: Some(asked.target.depth_stencil.clone()),
                multisample: Default::default(),
                fragment: asked.target.color.is_some().then(|| wgpu::FragmentState {
                    module: &module,
                    entry_point: None,
                    compilation_options: wgpu::PipelineCompilationOptions {
                        constants: &constants,
                        ..Default::default()
                    },
                    targets: std::slice::from_ref(&asked.target.color),
                }),
                multiview_mask: None,
                cache: None,
            });
            self.made.push((asked.target.clone(), pipeline));
            self.made.len() - 1
        });
        pass.set_pipeline(&self.made[made].1);
        for handle in asked.casters {
            let (_, group) = self.boxes.iter().find(|(own, _)| own == handle).expect("one of ours");
            pass.set_bind_group(1, group, &[]);
            pass.draw(0..36, 0..1);
        }
    }
}

#[test]
fn own_casters_stand_in_every_map_beside_others() {
    let Some(gpu) = gpu() else { return };
    let boxes = boxes(12, 11);
    let points = points(60);
    for technique in ["linear", "kernel", "packed", "midpoint", "colored", "volume", "mask"] {
        let options = ShadowsOptions::with([technique]).and_then(|o| o.map_size(512)).expect("options");
        let mut shadows = Shadows::new(&gpu.device, &gpu.queue, options).expect("shadows");
        let probe = Probe::new(&gpu, &shadows);
        let mesh = add_cube(&gpu, &mut shadows);
        shadows.add_receiver(ground()).expect("ground");
        let (ours, theirs) = boxes.split_at(6);
        let casters = shadows.add_casters(mesh, ours.iter().map(|(at, half)| placed(*at, *half)));
        assert_eq!(casters.expect("casters").len(), 6);
        let mut own = Own::new(&gpu, &mut shadows, theirs);
        let light = shadows.add_light(sun()).expect("a light");
        let depth_format = wgpu::TextureFormat::Depth24PlusStencil8;
        let (depth, points) = (Depth::new(&gpu, depth_format, &boxes), seen_points(&points, &boxes));
        for turn in 0..3 {
            shadows.prepare(&frame()).expect("prepared");
            let target = shadows.own_target(light).expect("a light").expect("maps");
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            let drawn = |asked: &OwnDraw<'_>, pass: &mut wgpu::RenderPass<'_>| {
                assert_eq!((asked.light, &asked.target), (light, &target));
                own.draw(&gpu, asked, pass);
            };
            shadows.record_with(&mut encoder, drawn).expect("recorded");
            depth.record(&mut encoder);
            if technique == "volume" {
                // Without a format of its own the depth that is counted over is the best of the device.
                let view = Depth::new(&gpu, umbrage::volume::choose_count_format(&gpu.device), &boxes);
                view.record(&mut encoder);
                shadows.record_screen(&mut encoder, &view.view).expect("recorded");
            }
            let seen = probe.ask(&gpu, encoder, &shadows, 0, &points);
            let (sure, wrong) = judge(&seen, &points, &sun(), &boxes, 0.2);
            assert!(sure > 1000 && wrong <= sure / 100, "{technique}, turn {turn}: {wrong} of {sure}");
            // One of them is another now, in the same place.
            let (handle, (at, half)) = (own.boxes[0].0, theirs[0]);
            if turn == 1 {
                let bounds = Aabb { min: at - half, max: at + half };
                shadows.move_own_caster(handle, bounds).expect("moved");
            }
        }
        assert!(own.calls == 2 || own.calls == 3, "drawn at first and after the move: {}", own.calls);
    }
}
