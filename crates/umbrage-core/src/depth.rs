//! Which way depth runs, decided once.

/// What the depth axis of clip space means after division by w.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DepthConvention {
    /// OpenGL: -1 at the near plane, 1 at the far plane. Stored depth is mapped to 0..1 by the viewport.
    OpenGl,
    /// WebGPU, Direct3D, Metal and Vulkan: 0 at the near plane, 1 at the far plane.
    ZeroToOne,
    /// 1 at the near plane, 0 at the far plane. With a float map the precision is then nearly even in
    /// relative distance (Reed 2015, "Depth Precision Visualized").
    Reversed,
}

/// The convention of every map and picture that Umbrage draws: pass, sampler and shader all take it from here.
pub const DEPTH: DepthConvention = DepthConvention::Reversed;

impl DepthConvention {
    /// All three, for tests and tables.
    pub const ALL: [Self; 3] = [Self::OpenGl, Self::ZeroToOne, Self::Reversed];

    /// Depth in normalised device coordinates of the near plane.
    pub const fn ndc_near(self) -> f32 {
        match self {
            Self::OpenGl => -1.0,
            Self::ZeroToOne => 0.0,
            Self::Reversed => 1.0,
        }
    }

    /// Depth in normalised device coordinates of the far plane.
    pub const fn ndc_far(self) -> f32 {
        match self {
            Self::OpenGl | Self::ZeroToOne => 1.0,
            Self::Reversed => 0.0,
        }
    }

    /// What an empty map holds: the stored depth of the far plane.
    pub const fn clear(self) -> f32 {
        match self {
            Self::OpenGl | Self::ZeroToOne => 1.0,
            Self::Reversed => 0.0,
        }
    }

    /// Is the near plane stored as the greatest value?
    pub const fn is_reversed(self) -> bool {
        matches!(self, Self::Reversed)
    }

    /// The sign that moves a stored depth away from the light: 1, or -1 when depth runs backwards.
    pub const fn away(self) -> f32 {
        if self.is_reversed() { -1.0 } else { 1.0 }
    }

    /// Is a receiver at stored depth `receiver` lit when the map holds `caster`?
    pub fn is_lit(self, receiver: f32, caster: f32) -> bool {
        if self.is_reversed() { receiver >= caster } else { receiver <= caster }
    }
}
