//! The choices of a projective mask.

use super::choices::{Choice, EMPTY, choices};
use super::params::{FALLBACK_MAP_SIZE, MASK_SIZE, OUTLINE_TEXEL};
use super::{Method, Param, Source, Table};

pub(super) const NAGY: Source = Source { paper: "Nagy, Real-Time Shadows on Complex Objects", year: 2000 };

choices! {
    /// Where the light looks.
    Aim {
        /// At the middle of the vertices.
        Mean = Choice {
            id: "mean",
            label: "Mean direction",
            summary: "at the mean of the directions to the blocker's vertices",
            source: Some(NAGY),
            params: &[MASK_SIZE, FALLBACK_MAP_SIZE],
            ..EMPTY
        };
        /// At the middle of the box.
        Box = Choice {
            id: "box",
            label: "Box",
            summary: "at the middle of the blocker's bounding box",
            source: Some(NAGY),
            params: &[MASK_SIZE, FALLBACK_MAP_SIZE],
            ..EMPTY
        };
    }
}

choices! {
    /// How wide the light looks.
    Ratios {
        /// As the blocker needs.
        Adaptive = Choice {
            id: "adaptive",
            label: "Adaptive",
            summary: "from the blocker's first to its last point along each axis, so that its outline always fills the mask",
            source: Some(NAGY),
            ..EMPTY
        };
        /// As the blocker needs, the same to both sides.
        Symmetric = Choice {
            id: "symmetric",
            label: "Symmetric",
            summary: "as far to both sides of the axis as the blocker reaches to one, the published form of adapting",
            source: Some(NAGY),
            ..EMPTY
        };
        /// Always the same.
        Fixed = Choice {
            id: "fixed",
            label: "Fixed",
            summary: "always as wide as the light itself, to show what adapting brings",
            source: Some(NAGY),
            ..EMPTY
        };
    }
}

choices! {
    /// What the view is fitted to.
    FitTo {
        /// The convex hull.
        Hull = Choice {
            id: "hull",
            label: "Hull",
            summary: "the corners of the blocker's convex hull: as tight as all its vertices",
            source: Some(NAGY),
            ..EMPTY
        };
        /// The box.
        Box = Choice {
            id: "box",
            label: "Box",
            summary: "the eight corners of the blocker's bounding box: cheapest, and looser",
            source: Some(NAGY),
            ..EMPTY
        };
    }
}

choices! {
    /// What is drawn into the mask.
    Outline {
        /// Fewer triangles.
        Reduced = Choice {
            id: "reduced",
            label: "Reduced",
            summary: "a mesh with fewer triangles whose outline stays within a few texels, and of a closed one the side with fewer",
            source: Some(NAGY),
            params: &[OUTLINE_TEXEL],
            ..EMPTY
        };
        /// All triangles.
        Full = Choice { id: "full", label: "Full", summary: "every triangle of the blocker", ..EMPTY };
    }
}

choices! {
    /// How the mask is looked up.
    Lookup {
        /// Blended.
        Linear = Choice { id: "linear", label: "Linear", summary: "four texels, blended by the hardware", ..EMPTY };
        /// One texel.
        Nearest = Choice { id: "nearest", label: "Nearest", summary: "the texel that holds the receiver", ..EMPTY };
    }
}

choices! {
    /// How receivers are drawn.
    Receivers {
        /// All masks at once.
        SinglePass = Choice {
            id: "single-pass",
            label: "Single pass",
            summary: "all masks of a light are looked up while the receiver is lit; the darkest counts",
            modules: &["mask"],
            source: Some(NAGY),
            ..EMPTY
        };
        /// A pass for each mask.
        Subtractive = Choice {
            id: "subtractive",
            label: "Subtractive",
            summary: "receivers are drawn once more for each mask, which takes light away; the stencil lets each pixel darken once",
            modules: &["mask"],
            source: Some(NAGY),
            ..EMPTY
        };
    }
}

/// The six choices of a projective mask. All go together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Mask {
    /// Where the light looks.
    pub aim: Aim,
    /// How wide it looks.
    pub ratios: Ratios,
    /// What its view is fitted to.
    pub fit_to: FitTo,
    /// What is drawn into the mask.
    pub outline: Outline,
    /// How the mask is looked up.
    pub lookup: Lookup,
    /// How receivers are drawn.
    pub receivers: Receivers,
}

impl Mask {
    /// What is used when nothing is said.
    pub const DEFAULT: Self = Self {
        aim: Aim::Mean,
        ratios: Ratios::Adaptive,
        fit_to: FitTo::Hull,
        outline: Outline::Reduced,
        lookup: Lookup::Linear,
        receivers: Receivers::SinglePass,
    };

    /// The tables of the six choices.
    pub(super) fn tables() -> Vec<Table> {
        vec![
            Table::new("aim", Aim::ALL.iter().map(|c| c.row())),
            Table::new("ratios", Ratios::ALL.iter().map(|c| c.row())),
            Table::new("fit_to", FitTo::ALL.iter().map(|c| c.row())),
            Table::new("outline", Outline::ALL.iter().map(|c| c.row())),
            Table::new("lookup", Lookup::ALL.iter().map(|c| c.row())),
            Table::new("receivers", Receivers::ALL.iter().map(|c| c.row())),
        ]
    }

    /// The rows of the six choices, in the order of their tables.
    pub fn rows(&self) -> [&'static Choice; 6] {
        [
            self.aim.row(),
            self.ratios.row(),
            self.fit_to.row(),
            self.outline.row(),
            self.lookup.row(),
            self.receivers.row(),
        ]
    }

    /// Makes another choice; `None` where there is none of that name.
    pub(super) fn choose(mut self, key: &str, id: &str) -> Option<Method> {
        match key {
            "aim" => self.aim = Aim::find(id)?,
            "ratios" => self.ratios = Ratios::find(id)?,
            "fit_to" => self.fit_to = FitTo::find(id)?,
            "outline" => self.outline = Outline::find(id)?,
            "lookup" => self.lookup = Lookup::find(id)?,
            _ => self.receivers = Receivers::find(id)?,
        }
        Some(Method::Mask(self))
    }

    /// Its parameters.
    pub fn params(&self) -> impl Iterator<Item = &'static Param> {
        self.rows().into_iter().flat_map(|row| row.params)
    }
}
