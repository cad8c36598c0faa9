//! The lookups that the shader holds: one for each way to make and to read a map, and the pool of maps that it reads.

use super::{ShadowsError, ShadowsOptions};
use crate::{ChosenFormat, choose_format};
use umbrage_core::technique::mask::Receivers;
use umbrage_core::technique::{Combination, Method, Projection, Settings};

/// One lookup.
#[derive(Clone, Debug)]
pub(super) struct Lookup {
    /// How maps are made and read; its projection counts for nothing.
    pub combination: Combination,
    pub pool: usize,
}

/// Which maps share a texture.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PoolKind {
    pub format: ChosenFormat,
    pub size_texel: u32,
    /// Are there maps of translucent casters, and of the colours that they make, beside?
    pub colored: bool,
}

/// All that the shader can do.
#[derive(Clone, Debug, Default)]
pub(super) struct Declared {
    pub lookups: Vec<Lookup>,
    pub pools: Vec<PoolKind>,
    /// Is V of some lights found on the screen?
    pub screen: bool,
    /// Are volumes counted for it?
    pub volumes: bool,
    /// Are masks looked up?
    pub masks: bool,
    /// Are there masks at all?
    pub mask_settings: Option<Settings>,
    /// For messages.
    names: Vec<String>,
}

/// What the adapter must allow; every device of WebGPU guarantees it for the formats that it lists.
fn usages(device: &wgpu::Device, format: wgpu::TextureFormat) -> wgpu::TextureUsages {
    format.guaranteed_format_features(device.features()).allowed_usages
}

fn normalised(combination: &Combination, format: &ChosenFormat) -> Combination {
    Combination { projection: Projection::Fitted, storage: format.storage, ..*combination }
}

/// A technique with the choices that differ from its row of the table.
fn described(settings: &Settings) -> String {
    let own = settings.technique.method.rows();
    let differs = |((key, row), (_, usual)): (
        &(&str, &umbrage_core::technique::Choice),
        &(&str, &umbrage_core::technique::Choice),
    )| { (row.id != usual.id).then(|| format!("{key}={}", row.id)) };
    let mut parts: Vec<String> = settings.method.rows().iter().zip(&own).filter_map(differs).collect();
    parts.extend(settings.set_value("map_size").map(|size| format!("map_size={size}")));
    let id = settings.technique.id;
    if parts.is_empty() { id.to_owned() } else { format!("{id} ({})", parts.join(", ")) }
}

impl Declared {
    /// What the shader needs for these options.
    pub fn new(device: &wgpu::Device, options: &ShadowsOptions) -> Result<Self, ShadowsError> {
        let mut made = Self::default();
        for settings in &options.techniques {
            made.names.push(described(settings));
            match settings.method {
                Method::None => {}
                Method::Map(_) => made.add(device, settings)?,
                Method::Volume(_) => (made.screen, made.volumes) = (true, true),
                Method::Mask(mask) => {
                    made.screen |= mask.receivers == Receivers::Subtractive;
                    made.masks |= mask.receivers != Receivers::Subtractive;
                    made.mask_settings.get_or_insert_with(|| settings.clone());
                }
            }
            // Casters that the family cannot draw.
            if let Some(fallback) = settings.fallback() {
                made.add(device, &fallback)?;
            }
        }
        Ok(made)
    }

    fn add(&mut self, device: &wgpu::Device, settings: &Settings) -> Result<(), ShadowsError> {
        let Some(combination) = settings.combination() else { return Ok(()) };
        let format = choose_format(combination.storage, |format| usages(device, format))?;
        let limits = device.limits();
        let size_texel = settings.map_size_texel();
        if size_texel > limits.max_texture_dimension_2d {
            return Err(crate::ShadowError::TooLarge {
                size_texel,
                layers: 1,
                limit: limits.max_texture_dimension_2d,
                layer_limit: limits.max_texture_array_layers,
            }
            .into());
        }
        if self.find(settings).is_some() {
            return Ok(());
        }
        let combination = normalised(&combination, &format);
        let kind = PoolKind { format, size_texel, colored: combination.colors_light() };
        let same = |pool: &PoolKind| {
            (pool.format.format, pool.size_texel, pool.colored)
                == (kind.format.format, size_texel, kind.colored)
        };
        let pool = self.pools.iter().position(same).unwrap_or_else(|| {
            self.pools.push(kind);
            self.pools.len() - 1
        });
        self.lookups.push(Lookup { combination, pool });
        Ok(())
    }

    /// The lookup of a technique with maps.
    fn find(&self, settings: &Settings) -> Option<usize> {
        let combination = settings.combination()?;
        self.lookups.iter().position(|lookup| {
            let pool = &self.pools[lookup.pool];
            let storage_fits = match combination.storage {
                umbrage_core::technique::Storage::Auto => true,
                storage => storage == lookup.combination.storage,
            };
            let asked = Combination { storage: lookup.combination.storage, ..combination };
            storage_fits
                && normalised(&asked, &pool.format).eq(&lookup.combination)
                && pool.size_texel == settings.map_size_texel()
        })
    }

    /// The settings as a light gets them, whose map has the size of a declared one where none was set; with the lookup of its maps,
    /// or of the maps that take over.
    pub fn settle(&self, settings: &Settings) -> Result<(Settings, Option<usize>), ShadowsError> {
        let refuse = || ShadowsError::Undeclared {
            asked: described(settings),
            declared: self.names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", "),
        };
        match settings.method {
            Method::None => Ok((settings.clone(), None)),
            Method::Map(_) => {
                if let Some(lookup) = self.find(settings) {
                    return Ok((settings.clone(), Some(lookup)));
                }
                let sizes = self.pools.iter().map(|pool| pool.size_texel);
                let mut resized = sizes
                    .filter(|_| settings.set_value("map_size").is_none())
                    .filter_map(|size| settings.clone().with_value("map_size", size as f32).ok());
                let found = resized.find_map(|settings| Some((self.find(&settings)?, settings)));
                found.map(|(lookup, settings)| (settings, Some(lookup))).ok_or_else(refuse)
            }
            Method::Volume(_) if !self.volumes => Err(refuse()),
            Method::Mask(mask) => {
                let has = if mask.receivers == Receivers::Subtractive { self.screen } else { self.masks };
                let same_size = self
                    .mask_settings
                    .as_ref()
                    .is_some_and(|declared| declared.value("mask_size") == settings.value("mask_size"));
                if has && same_size { self.settle_fallback(settings) } else { Err(refuse()) }
            }
            Method::Volume(_) => self.settle_fallback(settings),
        }
    }

    /// The lookup of maps that take over, of the first size that there is.
    fn settle_fallback(&self, settings: &Settings) -> Result<(Settings, Option<usize>), ShadowsError> {
        let Some(fallback) = settings.fallback() else { return Ok((settings.clone(), None)) };
        let (fallback, lookup) = self.settle(&fallback)?;
        let settings = settings.clone().with_value("map_size", fallback.map_size_texel() as f32)?;
        Ok((settings, lookup))
    }
}
