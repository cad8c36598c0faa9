//! The surfaces of a picture, read back from the G-buffer.

use crate::threaded::locked;
use crate::{RenderError, Renderer, readback};
use glam::{DVec3, DVec4, Vec2, Vec3};
use umbrage::core::DEPTH;

/// The surface that was drawn in a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawnSurface {
    /// Metres.
    pub p_world: DVec3,
    /// As it is shaded: interpolated, bent by the normal map. Unit length.
    pub shading_normal_world: Vec3,
    /// The triangle's own, on the viewer's side. Unit length.
    pub normal_world: Vec3,
}

/// The inverse of `pack_normal` in `wgsl/surface.wgsl`.
fn unpack_normal(packed: u32) -> Vec3 {
    let part = |bits: u32| (f32::from(bits as u16 as i16) / 32767.0).max(-1.0);
    let p = Vec2::new(part(packed), part(packed >> 16));
    let z = 1.0 - p.x.abs() - p.y.abs();
    let folded = Vec2::splat((-z).max(0.0));
    (p - folded * p.signum()).extend(z).normalize_or_zero()
}

impl Renderer<'_> {
    /// What the map of a view holds after a frame: its texels' bytes as the format has them, rows from the top.
    ///
    /// # Errors
    /// [`RenderError::View`] when there is no such map, or when its format cannot be copied (24-bit depth);
    /// [`RenderError::Gpu`] when the device is lost.
    pub fn map_bytes(&self, view: usize) -> Result<Vec<u8>, RenderError> {
        let set = locked(&self.sets[0]);
        let Some(maps) = set.maps().filter(|_| view < self.views().len()) else {
            return Err(RenderError::View(format!("there is no map {view}")));
        };
        if maps.texture().format() == wgpu::TextureFormat::Depth24Plus {
            return Err(RenderError::View("24-bit depth cannot be copied; set storage=depth32f".into()));
        }
        readback::layer(self.gpu, maps.texture(), view as u32)
    }

    /// The surface in each pixel after a frame, rows from the top; `None` where nothing is. Surfaces that are mixed by alpha
    /// are not among them.
    ///
    /// # Errors
    /// [`RenderError::View`] when the picture is lit as it is drawn, which needs no surfaces, or when its depth cannot be copied
    /// (24 bits, with a stencil, on devices without `DEPTH32FLOAT_STENCIL8`); [`RenderError::Gpu`] when the device is lost.
    pub fn surfaces(&self) -> Result<Vec<Option<DrawnSurface>>, RenderError> {
        let Some([gbuffer, depth]) = &self.targets.surfaces else {
            return Err(RenderError::View("this picture is lit as it is drawn and keeps no surfaces".into()));
        };
        if depth.format() == wgpu::TextureFormat::Depth24PlusStencil8 {
            let message = "24-bit depth cannot be copied, and this device has no other with a stencil; use another technique";
            return Err(RenderError::View(message.into()));
        }
        let (packed, depth) = (readback::texture(self.gpu, gbuffer)?, readback::texture(self.gpu, depth)?);
        let world_from_clip = self.clip_from_world.as_dmat4().inverse();
        let size = self.options.size;
        let word = |bytes: &[u8]| u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
        let surface = |(i, (packed, depth)): (usize, (&[u8], &[u8]))| {
            let depth = f32::from_bits(word(depth));
            let (x, y) = (i as u32 % size.x, i as u32 / size.x);
            let clip = DVec4::new(
                (f64::from(x) + 0.5) / f64::from(size.x) * 2.0 - 1.0,
                1.0 - (f64::from(y) + 0.5) / f64::from(size.y) * 2.0,
                f64::from(depth),
                1.0,
            );
            let p = world_from_clip * clip;
            (depth != DEPTH.clear()).then(|| DrawnSurface {
                p_world: p.truncate() / p.w,
                shading_normal_world: unpack_normal(word(packed)),
                normal_world: unpack_normal(word(&packed[12..])),
            })
        };
        Ok(packed.chunks_exact(16).zip(depth.chunks_exact(4)).enumerate().map(surface).collect())
    }
}
