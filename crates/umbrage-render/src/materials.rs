//! Materials on the GPU: numbers, textures, and the pipeline variant that each needs.

use crate::layout::{BLINN, GpuMaterial, UNLIT};
use crate::textures::{Encoding, Textures};
use glam::{Vec3, Vec4};
use std::num::NonZeroU64;
use umbrage_scene::{AlphaMode, Material, Reflectance, Scene, TextureRef};
use wgpu::util::DeviceExt;

/// Which variant of the mesh pipelines draws a material.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Variant {
    /// Drawn after all others, mixed by alpha.
    pub blend: bool,
    /// Reads full vertices.
    pub full: bool,
    /// Back faces are drawn too.
    pub double_sided: bool,
    /// The instance's transform turns the winding.
    pub mirrored: bool,
    /// Texels may be missing.
    pub cut_out: bool,
    /// Receives no shadow; the instance's.
    pub exempt: bool,
    /// Base colour, metallic-roughness, normal, emissive.
    pub textures: [bool; 4],
}

/// A material ready to draw.
#[derive(Debug)]
pub struct MaterialEntry {
    /// Group 1 of the mesh pipelines.
    pub bind_group: wgpu::BindGroup,
    /// Group 1 of the cut-out caster pipeline, when it may have holes.
    pub caster: Option<wgpu::BindGroup>,
    /// Its variant; `full` and `mirrored` are the instance's.
    pub variant: Variant,
}

fn textures_of(material: &Material, all_blinn: bool) -> [Option<TextureRef>; 4] {
    [
        material.base_color_texture,
        material.metallic_roughness_texture.filter(|_| !all_blinn),
        material.normal_texture,
        material.emissive_texture,
    ]
}

const ENCODINGS: [Encoding; 4] = [Encoding::Color, Encoding::Data, Encoding::Data, Encoding::Color];

/// `log2(shininess) / 16`: eight bits hold exponents from 1 to 65536 evenly to the eye.
fn gloss_of(shininess: f32) -> f32 {
    (shininess.max(1.0).log2() / 16.0).min(1.0)
}

fn gpu_material(material: &Material, all_blinn: bool) -> GpuMaterial {
    let base = material.base_color.truncate();
    let mut flags = if material.unlit { UNLIT } else { 0 };
    let mut base_color = material.base_color;
    let (specular, gloss) = match material.reflectance {
        Reflectance::MetallicRoughness { metallic, roughness } if all_blinn => {
            // Where a texture says which parts are metal, the factors say nothing: plain matte.
            let textured = material.metallic_roughness_texture.is_some();
            let (metallic, roughness) = if textured { (0.0, 0.7) } else { (metallic, roughness) };
            // Blinn's exponent that is as wide as GGX of that roughness (Karis 2013), and the peak that keeps its energy.
            let alpha = (roughness * roughness).max(0.02);
            let shininess = (2.0 / (alpha * alpha) - 2.0).max(1.0);
            let specular = Vec3::splat(0.04).lerp(base, metallic) * ((shininess + 8.0) / 8.0);
            flags |= BLINN;
            base_color = (base * (1.0 - 0.7 * metallic)).extend(base_color.w);
            (specular.min(Vec3::ONE), gloss_of(shininess))
        }
        Reflectance::MetallicRoughness { metallic, roughness } => (Vec3::new(metallic, 0.0, 0.0), roughness),
        Reflectance::Blinn { specular, shininess, .. } => {
            flags |= BLINN;
            (specular, gloss_of(shininess))
        }
    };
    let (mut uv_sets, mut uv_rows) = (0, [Vec4::ZERO; 8]);
    for (slot, texture) in textures_of(material, all_blinn).into_iter().enumerate() {
        let uv = texture.map(|t| t.uv_from_texcoord).unwrap_or_default();
        uv_rows[2 * slot] = Vec4::new(uv.matrix2.x_axis.x, uv.matrix2.y_axis.x, uv.translation.x, 0.0);
        uv_rows[2 * slot + 1] = Vec4::new(uv.matrix2.x_axis.y, uv.matrix2.y_axis.y, uv.translation.y, 0.0);
        uv_sets |= texture.map_or(0, |t| t.uv_set.min(1)) << (2 * slot);
    }
    GpuMaterial {
        base_color,
        specular,
        gloss,
        emissive: material.emissive,
        cutoff: if let AlphaMode::Mask { cutoff } = material.alpha { cutoff } else { 0.0 },
        normal_scale: material.normal_scale,
        flags,
        uv_sets,
        pad: 0,
        uv_rows,
    }
}

/// Group 1 of the mesh pipelines.
pub fn layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let mut entries = vec![wgpu::BindGroupLayoutEntry {
        binding: 0,
        visibility: wgpu::ShaderStages::FRAGMENT,
        ty: wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset: false,
            min_binding_size: NonZeroU64::new(size_of::<GpuMaterial>() as u64),
        },
        count: None,
    }];
    for slot in 0..4 {
        let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty,
            count: None,
        };
        entries.push(entry(
            1 + 2 * slot,
            wgpu::BindingType::Texture {
                sample_type: wgpu::TextureSampleType::Float { filterable: true },
                view_dimension: wgpu::TextureViewDimension::D2,
                multisampled: false,
            },
        ));
        entries.push(entry(2 + 2 * slot, wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering)));
    }
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("material"),
        entries: &entries,
    })
}

/// Makes every material of a scene ready to draw, on request with every one answering as Lambert and Blinn.
pub fn make(
    device: &wgpu::Device,
    scene: &Scene,
    all_blinn: bool,
    textures: &Textures,
    layout: &wgpu::BindGroupLayout,
    caster_layout: &wgpu::BindGroupLayout,
) -> Vec<MaterialEntry> {
    let entry = |material: &Material| {
        let uniform = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some(&material.name),
            contents: bytemuck::bytes_of(&gpu_material(material, all_blinn)),
            usage: wgpu::BufferUsages::UNIFORM,
        });
        let bound = textures_of(material, all_blinn);
        let views: Vec<_> =
            bound.iter().zip(ENCODINGS).map(|(t, encoding)| textures.get(*t, encoding)).collect();
        let mut entries = vec![wgpu::BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() }];
        for (slot, (view, sampler)) in (0..).zip(&views) {
            entries.push(wgpu::BindGroupEntry {
                binding: 1 + 2 * slot,
                resource: wgpu::BindingResource::TextureView(view),
            });
            entries.push(wgpu::BindGroupEntry {
                binding: 2 + 2 * slot,
                resource: wgpu::BindingResource::Sampler(sampler),
            });
        }
        let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(&material.name),
            layout,
            entries: &entries,
        });
        let caster = crate::geometry::caster_cutoff(material).map(|_| {
            device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some(&material.name),
                layout: caster_layout,
                entries: &[
                    wgpu::BindGroupEntry {
                        binding: 0,
                        resource: wgpu::BindingResource::TextureView(views[0].0),
                    },
                    wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(views[0].1) },
                ],
            })
        });
        MaterialEntry {
            bind_group,
            caster,
            variant: Variant {
                blend: material.alpha == AlphaMode::Blend,
                full: false,
                double_sided: material.double_sided,
                mirrored: false,
                cut_out: matches!(material.alpha, AlphaMode::Mask { .. }),
                exempt: false,
                textures: bound.map(|t| t.is_some()),
            },
        }
    };
    scene.materials.iter().map(entry).collect()
}
