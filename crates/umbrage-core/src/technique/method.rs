//! What makes the visibility, with its choices: one of the families.

use super::choices::{Choice, Storage};
use super::combination::Combination;
use super::mask::Mask;
use super::volume::Volume;
use super::{Bias, Filter, Param, Projection, Translucent};

/// What kind of thing makes the visibility.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// No shadow at all: V is 1 wherever the light shines.
    None,
    /// Depth seen from the light, compared.
    Map,
    /// The space that a caster darkens, as polygons that the stencil counts.
    Volume,
    /// The outline of a blocker, projected on what lies beyond.
    Mask,
}

impl Family {
    /// All that have choices.
    pub const WITH_CHOICES: [Self; 3] = [Self::Map, Self::Volume, Self::Mask];

    /// One word.
    pub fn id(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Map => "map",
            Self::Volume => "volume",
            Self::Mask => "mask",
        }
    }

    /// Its tables of choices, in the order of [`Method::rows`].
    pub fn tables(self) -> Vec<Table> {
        match self {
            Self::None => Vec::new(),
            Self::Map => vec![
                Table::new("storage", Storage::ALL.iter().map(|c| c.row())),
                Table::new("projection", Projection::ALL.iter().map(|c| c.row())),
                Table::new("bias", Bias::ALL.iter().map(|c| c.row())),
                Table::new("filter", Filter::ALL.iter().map(|c| c.row())),
                Table::new("translucent", Translucent::ALL.iter().map(|c| c.row())),
            ],
            Self::Volume => Volume::tables(),
            Self::Mask => Mask::tables(),
        }
    }
}

/// One table of choices.
#[derive(Clone, Debug)]
pub struct Table {
    /// The key that chooses from it.
    pub key: &'static str,
    /// Its rows.
    pub rows: Vec<&'static Choice>,
}

impl Table {
    pub(super) fn new(key: &'static str, rows: impl Iterator<Item = &'static Choice>) -> Self {
        Self { key, rows: rows.collect() }
    }
}

/// A family with its choices made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Method {
    /// See [`Family::None`].
    None,
    /// See [`Family::Map`].
    Map(Combination),
    /// See [`Family::Volume`].
    Volume(Volume),
    /// See [`Family::Mask`].
    Mask(Mask),
}

impl Method {
    /// Its family.
    pub fn family(&self) -> Family {
        match self {
            Self::None => Family::None,
            Self::Map(_) => Family::Map,
            Self::Volume(_) => Family::Volume,
            Self::Mask(_) => Family::Mask,
        }
    }

    /// The rows that were chosen, each with its table's key.
    pub fn rows(&self) -> Vec<(&'static str, &'static Choice)> {
        let rows = match self {
            Self::None => Vec::new(),
            Self::Map(combination) => combination.rows().to_vec(),
            Self::Volume(volume) => volume.rows().to_vec(),
            Self::Mask(mask) => mask.rows().to_vec(),
        };
        self.family().tables().iter().map(|table| table.key).zip(rows).collect()
    }

    /// The parameters of its choices.
    pub fn params(&self) -> Vec<&'static Param> {
        self.rows().into_iter().flat_map(|(_, row)| row.params).collect()
    }

    /// The parameter of its choices that has this name. Nothing is put on the heap: settings are asked in every frame.
    pub(super) fn param(&self, name: &str) -> Option<&'static Param> {
        let is_it = |param: &&'static Param| param.name == name;
        match self {
            Self::None => None,
            Self::Map(combination) => combination.params().find(is_it),
            Self::Volume(volume) => volume.params().find(is_it),
            Self::Mask(mask) => mask.params().find(is_it),
        }
    }

    /// The map's choices, where it is a map.
    pub fn combination(&self) -> Option<Combination> {
        if let Self::Map(combination) = self { Some(*combination) } else { None }
    }

    /// Another choice of the table `key`, which is one of its own; `None` where it has no row `id`.
    pub(super) fn choose(self, key: &str, id: &str) -> Option<Self> {
        match self {
            Self::None => None,
            Self::Map(mut combination) => {
                match key {
                    "storage" => combination.storage = Storage::find(id)?,
                    "projection" => combination.projection = Projection::find(id)?,
                    "bias" => combination.bias = Bias::find(id)?,
                    "filter" => combination.filter = Filter::find(id)?,
                    _ => combination.translucent = Translucent::find(id)?,
                }
                Some(Self::Map(combination))
            }
            Self::Volume(volume) => volume.choose(key, id),
            Self::Mask(mask) => mask.choose(key, id),
        }
    }
}
