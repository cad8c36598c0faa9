//! Maps of one format and size, of all lights: a texture whose layers are given out and taken back.

use super::variants::PoolKind;
use crate::{ShadowError, ShadowMaps, TranslucentMaps};

/// Layers of one texture.
#[derive(Debug)]
pub(super) struct Pool {
    pub kind: PoolKind,
    maps: ShadowMaps,
    translucent: Option<TranslucentMaps>,
    free: Vec<u32>,
    /// Layers that were ever given out.
    given: u32,
}

fn make(
    device: &wgpu::Device,
    kind: &PoolKind,
    size_texel: u32,
    layers: u32,
) -> Result<(ShadowMaps, Option<TranslucentMaps>), ShadowError> {
    let maps = ShadowMaps::new(device, &kind.format, size_texel, layers)?;
    if !kind.colored {
        return Ok((maps, None));
    }
    let translucent = TranslucentMaps::new(device, &kind.format, size_texel, layers)?;
    Ok((maps.keeping_scratch(), Some(translucent)))
}

impl Pool {
    /// Without any map but one of a texel, which is bound until there are others.
    pub fn new(device: &wgpu::Device, kind: PoolKind) -> Result<Self, ShadowError> {
        let (maps, translucent) = make(device, &kind, 1, 1)?;
        Ok(Self { kind, maps, translucent, free: Vec::new(), given: 0 })
    }

    /// A layer that nobody has.
    pub fn take(&mut self) -> u32 {
        self.free.pop().unwrap_or_else(|| {
            self.given += 1;
            self.given - 1
        })
    }

    /// Takes a layer back.
    pub fn give_back(&mut self, layer: u32) {
        self.free.push(layer);
    }

    fn has(&self) -> u32 {
        if self.maps.size_texel() == self.kind.size_texel { self.maps.layer_count() as u32 } else { 0 }
    }

    /// Maps for all layers that were given out; true when they are new and hold nothing.
    pub fn make_room(&mut self, device: &wgpu::Device) -> Result<bool, ShadowError> {
        let has = self.has();
        if self.given <= has || self.given == 0 {
            return Ok(false);
        }
        // The first maps are as many as there are views; later ones come with some to spare.
        let most = device.limits().max_texture_array_layers;
        let layers =
            if has == 0 { self.given } else { self.given.max(has + has / 2).min(most.max(self.given)) };
        (self.maps, self.translucent) = make(device, &self.kind, self.kind.size_texel, layers)?;
        Ok(true)
    }

    pub fn maps(&self) -> &ShadowMaps {
        &self.maps
    }

    pub fn translucent(&self) -> Option<&TranslucentMaps> {
        self.translucent.as_ref()
    }

    /// Memory, bytes.
    pub fn memory_bytes(&self) -> u64 {
        self.maps.memory_bytes() + self.translucent.as_ref().map_or(0, TranslucentMaps::memory_bytes)
    }
}
