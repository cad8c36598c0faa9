//! The choices of a stencil shadow volume.

use super::choices::{BJORKE, Choice, EMPTY, choices};
use super::params::{EXTRUDE, FALLBACK_MAP_SIZE, INSET, LIKE_DEPTH, SOFT_M, SOFT_PX};
use super::{Method, Param, Source, Table};

const HEIDMANN: Source = Source { paper: "Heidmann, Real Shadows Real Time, Iris Universe 18", year: 1991 };
pub(super) const EVERITT_KILGARD: Source = Source {
    paper: "Everitt and Kilgard, Practical and Robust Stenciled Shadow Volumes for Hardware-Accelerated Rendering",
    year: 2002,
};
const BRENNAN: Source =
    Source { paper: "Brennan, Shadow Volume Extrusion using a Vertex Shader", year: 2002 };
const KIM: Source = Source {
    paper: "Kim, Kim and Chang, A Shadow Volume Algorithm for Opaque and Transparent Nonmanifold Casters",
    year: 2008,
};

choices! {
    /// How the sides of a volume are found.
    Silhouette {
        /// By a compute pass.
        Compute = Choice {
            id: "compute",
            label: "Compute pass",
            summary: "a compute pass looks at every edge and writes quads of silhouette edges only; kept until light or caster moves",
            source: Some(KIM),
            params: &[INSET, EXTRUDE, FALLBACK_MAP_SIZE],
            ..EMPTY
        };
        /// By the vertex shader, over split edges.
        Vertex = Choice {
            id: "vertex",
            label: "Vertex shader",
            summary: "every edge carries two ghost triangles, and the vertex shader moves all that faces away: four triangles for one",
            source: Some(BRENNAN),
            params: &[INSET, EXTRUDE, FALLBACK_MAP_SIZE],
            ..EMPTY
        };
    }
}

choices! {
    /// Which faces of a volume are counted.
    Counting {
        /// By caster.
        Auto = Choice {
            id: "auto",
            label: "Automatic",
            summary: "depth-pass for casters whose shadow the eye cannot be in, depth-fail for the others",
            source: Some(EVERITT_KILGARD),
            ..EMPTY
        };
        /// What lies behind the surface.
        DepthFail = Choice {
            id: "depth-fail",
            label: "Depth-fail",
            summary: "faces behind the visible surface, with caps at both ends: right wherever the eye is",
            source: Some(EVERITT_KILGARD),
            ..EMPTY
        };
        /// What lies before the surface.
        DepthPass = Choice {
            id: "depth-pass",
            label: "Depth-pass",
            summary: "faces before the visible surface, without caps: cheaper, and wrong where the eye is in a shadow",
            source: Some(HEIDMANN),
            ..EMPTY
        };
    }
}

choices! {
    /// In how many draws the stencil counts.
    Stencil {
        /// One.
        TwoSided = Choice {
            id: "two-sided",
            label: "Two-sided",
            summary: "one draw counts front faces one way and back faces the other",
            source: Some(EVERITT_KILGARD),
            ..EMPTY
        };
        /// Two.
        TwoPass = Choice {
            id: "two-pass",
            label: "Two passes",
            summary: "back faces are drawn first, then front faces: the classic form, the same picture",
            source: Some(HEIDMANN),
            ..EMPTY
        };
    }
}

choices! {
    /// What is done to the hard mask.
    Soften {
        /// Nothing.
        None = Choice { id: "none", label: "None", summary: "nothing: one bit a pixel, exact to the pixel", ..EMPTY };
        /// A blur.
        Blur = Choice {
            id: "blur",
            label: "Depth-aware blur",
            summary: "the mask is blurred along rows, then columns, across like depths only: soft, of one width, not physical",
            source: Some(BJORKE),
            modules: &["like_depth"],
            params: &[SOFT_PX, SOFT_M, LIKE_DEPTH],
        };
    }
}

/// The four choices of a stencil shadow volume. All go together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Volume {
    /// How its sides are found.
    pub silhouette: Silhouette,
    /// Which of its faces are counted.
    pub counting: Counting,
    /// In how many draws.
    pub stencil: Stencil,
    /// What is done to the mask.
    pub soften: Soften,
}

impl Volume {
    /// What is used when nothing is said.
    pub const DEFAULT: Self = Self {
        silhouette: Silhouette::Compute,
        counting: Counting::Auto,
        stencil: Stencil::TwoSided,
        soften: Soften::None,
    };

    /// Every combination.
    pub fn all() -> impl Iterator<Item = Self> {
        Silhouette::ALL.iter().flat_map(|&silhouette| {
            Counting::ALL.iter().flat_map(move |&counting| {
                Stencil::ALL.iter().flat_map(move |&stencil| {
                    Soften::ALL.iter().map(move |&soften| Self { silhouette, counting, stencil, soften })
                })
            })
        })
    }

    /// The tables of the four choices.
    pub(super) fn tables() -> Vec<Table> {
        vec![
            Table::new("silhouette", Silhouette::ALL.iter().map(|c| c.row())),
            Table::new("counting", Counting::ALL.iter().map(|c| c.row())),
            Table::new("stencil", Stencil::ALL.iter().map(|c| c.row())),
            Table::new("soften", Soften::ALL.iter().map(|c| c.row())),
        ]
    }

    /// The rows of the four choices, in the order of their tables.
    pub fn rows(&self) -> [&'static Choice; 4] {
        [self.silhouette.row(), self.counting.row(), self.stencil.row(), self.soften.row()]
    }

    /// Makes another choice; `None` where there is none of that name.
    pub(super) fn choose(mut self, key: &str, id: &str) -> Option<Method> {
        match key {
            "silhouette" => self.silhouette = Silhouette::find(id)?,
            "counting" => self.counting = Counting::find(id)?,
            "stencil" => self.stencil = Stencil::find(id)?,
            _ => self.soften = Soften::find(id)?,
        }
        Some(Method::Volume(self))
    }

    /// Its parameters.
    pub fn params(&self) -> impl Iterator<Item = &'static Param> {
        self.rows().into_iter().flat_map(|row| row.params)
    }
}
