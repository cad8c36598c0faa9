//! Projective masks: a texture for each light and blocker, drawn in one colour, and the passes that take it away from receivers.
//! Where to look is [`umbrage_core::fit::fit_mask`]; how to look one up inline is the WGSL module `mask`, and how to look up all
//! of a light [`masks_wgsl`].
//!
//! [`BlockerMasks`] keeps those of any number of lights, and knows which have to be drawn anew.

mod blockers;
mod error;
mod light;
mod lookup;
mod maps;
mod pipelines;
mod subtract;
mod subtraction;
mod upload;

pub use blockers::{BlockerMask, BlockerMasks};
pub use error::MasksError;
pub use light::{Blocker, MaskPart, MaskWarning, Receiver, fit_to_boxes};
pub use lookup::{GpuMaskList, mask_range, masks_wgsl};
pub use maps::{MASK_FORMAT, MaskMaps, mask_sampler};
pub use pipelines::{MaskPipelines, record_mask_pass};
pub use subtract::{GpuReceiving, Shadowed, SubtractDepth, SubtractPipelines, record_subtract};
pub use subtraction::Subtraction;

use std::num::NonZeroU64;

fn uniform(
    binding: u32,
    dynamic: bool,
    bytes: usize,
    visibility: wgpu::ShaderStages,
) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility,
        ty: wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset: dynamic,
            min_binding_size: NonZeroU64::new(bytes as u64),
        },
        count: None,
    }
}

fn module(device: &wgpu::Device, label: &str, text: String) -> wgpu::ShaderModule {
    device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(label),
        source: wgpu::ShaderSource::Wgsl(text.into()),
    })
}

#[cfg(test)]
mod tests {
    use super::pipelines::mask_shader;
    use super::subtract::receiver_shader;
    use super::*;
    use std::mem::offset_of;

    #[test]
    fn shaders_validate_and_the_mirror_has_their_offsets() {
        for text in [mask_shader(crate::caster::NO_DEFORM), receiver_shader(crate::caster::NO_DEFORM)] {
            let module =
                naga::front::wgsl::parse_str(&text).unwrap_or_else(|e| panic!("{}", e.emit_to_string(&text)));
            naga::valid::Validator::new(
                naga::valid::ValidationFlags::all(),
                naga::valid::Capabilities::empty(),
            )
            .validate(&module)
            .unwrap_or_else(|e| panic!("{}", e.emit_to_string(&text)));
            let Some((_, ty)) = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some("Receiving"))
            else {
                continue;
            };
            let naga::TypeInner::Struct { members, span } = &ty.inner else { panic!("no struct") };
            let shader: Vec<_> = members[..4].iter().map(|m| m.offset as usize).collect();
            let mirror = [
                offset_of!(GpuReceiving, clip_from_world),
                offset_of!(GpuReceiving, eye),
                offset_of!(GpuReceiving, light),
                offset_of!(GpuReceiving, time_s),
            ];
            assert_eq!((shader.as_slice(), *span as usize), (&mirror[..], size_of::<GpuReceiving>()));
        }
        assert!(receiver_shader(crate::caster::NO_DEFORM).contains("struct Receiving"));
    }
}
