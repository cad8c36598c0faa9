//! The parameters of the choices: unit, range, default, what each does and costs.

use super::{Param, ParamDefault};

pub(super) const MAP_SIZE: Param = Param {
    name: "map_size",
    label: "Map size",
    unit: "texel",
    min: 1.0,
    max: 16384.0,
    step: 1.0,
    default: ParamDefault::Fixed(2048.0),
    help: "width and height of the map",
    cost: "memory and drawing grow with its square",
};

pub(super) const SLOPE_FACTOR: Param = Param {
    name: "slope_factor",
    label: "Slope factor",
    unit: "depth slope",
    min: 0.0,
    max: 32.0,
    step: 0.1,
    default: ParamDefault::Derived {
        rule: "twice the filter's reach: 1 for nearest, 2 for linear, width + 1 for wider ones",
        // A texel that counts lies at most `reach` away along both axes, so a plane's depth there differs by at most
        // reach * (|dz/dx| + |dz/dy|), and the hardware's slope is the larger of the two.
        value: |reach_texel| 2.0 * reach_texel,
    },
    help: "how many times a triangle's depth slope, for each texel, the map is pushed away from the light",
    cost: "none; too much detaches the shadow from a caster on a steep receiver",
};

pub(super) const CONSTANT: Param = Param {
    name: "constant",
    label: "Constant",
    unit: "depth step",
    min: 0.0,
    max: 1_000_000.0,
    step: 1.0,
    default: ParamDefault::Fixed(4.0),
    help: "how many of the format's smallest steps the map is pushed away from the light",
    cost: "none; too much detaches the shadow from its caster",
};

pub(super) const PLANE_MARGIN: Param = Param {
    name: "plane_margin",
    label: "Margin",
    unit: "texel",
    min: 0.0,
    max: 100.0,
    step: 0.01,
    default: ParamDefault::Fixed(0.0),
    help: "how far a texel must lie before the receiver's plane to block it, in widths of a texel",
    cost: "none",
};
pub(super) const NORMAL_OFFSET: Param = Param {
    name: "normal_offset",
    label: "Normal offset",
    unit: "texel",
    min: 0.0,
    max: 64.0,
    step: 0.1,
    default: ParamDefault::Fixed(1.0),
    help: "how far a receiver is moved along its normal times the sine of normal and light, in widths of a texel",
    cost: "none; too much moves shadows off their casters",
};

/// Zero unless set, as most of a formula that belongs to some engine is.
pub(super) const NO_OFFSET: Param = Param {
    name: "",
    label: "",
    unit: "texel",
    min: 0.0,
    max: 64.0,
    step: 0.1,
    default: ParamDefault::Fixed(0.0),
    help: "",
    cost: "none; too much moves shadows off their casters",
};

pub(super) const NORMAL_ALWAYS: Param = Param {
    name: "normal_always",
    label: "Normal offset at any angle",
    help: "how far a receiver is moved along its normal whatever the light's angle, in widths of a texel",
    ..NO_OFFSET
};

pub(super) const NORMAL_TILT: Param = Param {
    name: "normal_tilt",
    label: "Normal offset by tilt",
    help: "how far a receiver is moved along its normal times 1 - cosine of normal and light, in widths of a texel",
    ..NO_OFFSET
};

pub(super) const DEPTH_TEXEL: Param = Param {
    name: "depth_texel",
    label: "Depth offset",
    help: "how far a receiver is moved towards the light, in widths of a texel",
    ..NO_OFFSET
};

pub(super) const DEPTH_M: Param = Param {
    name: "depth_m",
    label: "Depth offset in metres",
    unit: "m",
    max: 1000.0,
    step: 0.001,
    help: "how far a receiver is moved towards the light whatever the scene's scale",
    ..NO_OFFSET
};

pub(super) const DEPTH_SHARE: Param = Param {
    name: "depth_share",
    label: "Depth offset by distance",
    unit: "distance",
    max: 0.5,
    step: 0.001,
    help: "how far a receiver is moved towards the light, as a share of its distance along the light's axis; not under parallel light",
    ..NO_OFFSET
};

pub(super) const POLYGON_SLOPE: Param = Param {
    name: "polygon_slope",
    label: "Polygon slope",
    unit: "depth slope",
    max: 32.0,
    help: "how many times a triangle's depth slope, for each texel, the map is pushed away from the light besides",
    ..NO_OFFSET
};

pub(super) const WIDTH: Param = Param {
    name: "width",
    label: "Width",
    unit: "texel",
    min: 1.0,
    max: 17.0,
    step: 1.0,
    default: ParamDefault::Fixed(5.0),
    help: "how wide the filter is",
    cost: "lookups grow with its square: ((width + 1) / 2)^2 gathers",
};

pub(super) const VIEWS: Param = Param {
    name: "views",
    label: "Views",
    unit: "",
    min: 1.0,
    max: 1024.0,
    step: 1.0,
    default: ParamDefault::Fixed(16.0),
    help: "from how many places of an area light maps are drawn; a light without area has one",
    cost: "memory, drawing and lookups grow with it",
};

pub(super) const MATRIX_BIAS: Param = Param {
    name: "matrix_bias",
    label: "Matrix bias",
    unit: "depth range",
    min: 0.0,
    max: 0.5,
    step: 0.0005,
    default: ParamDefault::Fixed(0.005),
    help: "how far every receiver is moved towards the light, as a share of the map's whole depth",
    cost: "none; light leaks wherever it is more than a caster's distance from its receiver",
};

pub(super) const FALLBACK_MAP_SIZE: Param = Param {
    help: "width and height of the map of casters that this family cannot draw (cut out, deformed); without any there is none",
    ..MAP_SIZE
};

pub(super) const INSET: Param = Param {
    name: "inset_m",
    label: "Inset",
    unit: "m",
    min: 0.0,
    max: 1e6,
    step: 0.001,
    default: ParamDefault::Fixed(0.0),
    help: "how far behind the lit surface, along the light, a volume begins; needed where caps and surfaces differ in depth",
    cost: "none; shadows begin so much later",
};

pub(super) const EXTRUDE: Param = Param {
    name: "extrude_m",
    label: "Extrusion",
    unit: "m",
    min: 0.0,
    max: 1e9,
    step: 0.1,
    default: ParamDefault::Fixed(0.0),
    help: "how far a volume reaches beyond its caster; 0: as far as there is anything that the light reaches",
    cost: "fewer pixels are counted; what lies beyond stays lit, and where the caster is wide, some of what lies before",
};

pub(super) const SOFT_PX: Param = Param {
    name: "soft_px",
    label: "Softness",
    unit: "px",
    min: 0.0,
    max: 64.0,
    step: 0.5,
    default: ParamDefault::Fixed(6.0),
    help: "how wide an edge becomes on the screen; counts where soft_m is 0",
    cost: "two passes over the picture, lookups in proportion to it",
};

pub(super) const SOFT_M: Param = Param {
    name: "soft_m",
    label: "Softness",
    unit: "m",
    min: 0.0,
    max: 1e6,
    step: 0.01,
    default: ParamDefault::Fixed(0.0),
    help: "how wide an edge becomes on the surface, at any distance from the eye (at most 64 px); 0: soft_px counts",
    cost: "as soft_px",
};

pub(super) const LIKE_DEPTH: Param = Param {
    name: "like_depth",
    label: "Like depth",
    unit: "share of distance",
    min: 0.0,
    max: 1.0,
    step: 0.001,
    default: ParamDefault::Fixed(0.01),
    help: "how far two pixels' surfaces may be apart to be blurred together, as a share of the distance from the eye",
    cost: "none; more lets edges between objects blur",
};

pub(super) const MASK_SIZE: Param = Param {
    name: "mask_size",
    label: "Mask size",
    unit: "texel",
    min: 8.0,
    max: 4096.0,
    step: 1.0,
    default: ParamDefault::Fixed(512.0),
    help: "width and height of each blocker's mask",
    cost: "memory and drawing grow with its square, for each blocker and light",
};

pub(super) const OUTLINE_TEXEL: Param = Param {
    name: "outline_texel",
    label: "Outline error",
    unit: "texel",
    min: 0.0,
    max: 16.0,
    step: 0.05,
    default: ParamDefault::Fixed(2.0),
    help: "how far the reduced outline may be from the true one, in texels of the mask",
    cost: "none; more leaves fewer triangles to draw",
};
