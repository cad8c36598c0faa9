//! What matters of a light's image: where in it the surfaces lie that an eye sees.
//!
//! A light's image plane has one place `q` for each of its rays: `(x, y) / along` for light from a place, `(x, y)` for
//! parallel light, both in the light's own space. A caster has the same `q` as what it shadows, so the part of the image
//! plane that seen receivers cover is all that a map must hold, wherever its casters are.

use super::convex::{Convex, hull};
use super::directional::ROUNDING;
use super::{Eye, Fallback, FitOptions};
use crate::bounds::Aabb;
use crate::camera::Projection;
use crate::light::{Light, LightKind};
use glam::{DMat2, DMat3, DVec2, DVec3, Vec3};

/// The light's own space in double precision.
#[derive(Clone, Copy, Debug)]
pub(super) struct Space {
    /// Turns world axes to the light's, which looks along its -Z.
    pub light_from_world: DMat3,
    /// The light's place; for parallel light the middle of everything.
    pub origin_world: DVec3,
    /// Tangent of a cone's half angle; `None` for parallel light.
    pub tan_outer: Option<f64>,
}

impl Space {
    pub fn point(&self, p_world: Vec3) -> DVec3 {
        self.light_from_world * (p_world.as_dvec3() - self.origin_world)
    }

    /// Place on the image plane.
    pub fn image(&self, p: DVec3) -> DVec2 {
        let q = DVec2::new(p.x, p.y);
        if self.tan_outer.is_some() { q / -p.z } else { q }
    }

    /// How far a step of a metre from `p` goes on the image plane.
    fn step(&self, p: DVec3, way: DVec3) -> DVec2 {
        if self.tan_outer.is_none() {
            return DVec2::new(way.x, way.y);
        }
        // Moving away moves the place as well, in proportion to how far off centre it is.
        let across = way - p * (way.z / p.z);
        DVec2::new(across.x, across.y) / -p.z
    }

    fn corners(&self, bounds: &Aabb) -> [DVec3; 8] {
        bounds.corners().map(|corner| self.point(corner))
    }
}

/// The eye in the light's space.
#[derive(Clone, Copy, Debug)]
pub(super) struct EyeInLight {
    pub position: DVec3,
    pub right: DVec3,
    pub up: DVec3,
    pub forward: DVec3,
    /// Tangents of the half angles; half of width and height of a parallel eye.
    pub half: DVec2,
    pub parallel: bool,
}

impl EyeInLight {
    /// Distance of a point from the eye along its axis, metres.
    pub fn depth(&self, p: DVec3) -> f64 {
        (p - self.position).dot(self.forward)
    }

    /// How far a step of a metre from `p` goes in the picture; in pixels up to a factor.
    fn step(&self, p: DVec3, way: DVec3) -> DVec2 {
        let along = DVec2::new(way.dot(self.right), way.dot(self.up));
        if self.parallel {
            return along;
        }
        let (off, depth) = (p - self.position, self.depth(p));
        let place = DVec2::new(off.dot(self.right), off.dot(self.up)) / depth;
        (along - place * way.dot(self.forward)) / depth
    }
}

/// A corner of what the eye sees and the light reaches.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    /// In the light's space.
    pub p: DVec3,
    /// On the image plane.
    pub q: DVec2,
    /// How large a pixel is there on the image plane, up to a factor that is the same everywhere.
    pub px: f64,
}

/// A pixel on a surface that eye and light may both see.
#[derive(Clone, Copy, Debug)]
pub(super) struct Probe {
    /// On the image plane.
    pub q: DVec2,
    /// What steps of a pixel are on the image plane, up to a factor that is the same everywhere.
    pub image_from_px: DMat2,
}

impl Probe {
    /// As if the surface faced so that the pixel is round on the image plane.
    fn round(point: &Point) -> Self {
        Self { q: point.q, image_from_px: DMat2::IDENTITY * point.px }
    }

    fn is_usable(&self) -> bool {
        self.q.is_finite() && self.image_from_px.is_finite()
    }
}

/// All that the fits that follow the eye start from.
#[derive(Clone, Debug)]
pub(super) struct Seen {
    pub space: Space,
    pub eye: EyeInLight,
    pub points: Vec<Point>,
    /// Pixels that a map's density is judged by.
    pub probes: Vec<Probe>,
    /// Around all points, on the image plane, counter-clockwise.
    pub hull: Vec<DVec2>,
    /// Middle of the box around the hull.
    pub middle: DVec2,
    /// From where to where casters and receivers lie, metres along the light's axis (from `origin_world`).
    pub along: (f64, f64),
    /// Half of the width that the image has when it holds everything that the light reaches.
    pub whole_half: f64,
    /// No window is less than this wide, from its middle to its edge: single precision would not carry it.
    pub least_half: f64,
}

/// Depth of the cone's tip that is left out, as a share of its reach. Nothing that near has a place on the image plane.
pub(super) const TIP: f64 = 1e-6;
/// The round cone's planes: so many touch it, so the pyramid that they make holds it.
const SIDES: usize = 12;
/// The least width of a window as a share of the light's whole image.
const LEAST_SHARE: f64 = 1.0 / 512.0;
/// Cells along a side of the grid that picks probes.
const CELLS: f64 = 12.0;
/// Surfaces that face the light by less than this cosine are not judged: in every map they have next to no texels.
const FACING: f64 = 0.1;

/// Corners that are one where a box is flat along x, y or z.
const FLAT: [(usize, usize); 3] = [(0, 1), (0, 2), (0, 4)];

/// The least singular value.
pub(super) fn least_stretch(m: DMat2) -> f64 {
    let (a, b) = (m.x_axis, m.y_axis);
    let mean = 0.5 * (a.length_squared() + b.length_squared());
    let half = 0.5 * (a.length_squared() - b.length_squared());
    let most = (mean + half.hypot(a.dot(b))).sqrt();
    if most > 0.0 { m.determinant().abs() / most } else { 0.0 }
}

impl Seen {
    /// # Errors
    /// Why the eye does not help.
    pub fn new(light: &Light, bounds: &[Aabb], eye: &Eye, options: &FitOptions) -> Result<Self, Fallback> {
        let usable = eye.camera.check().is_ok() && eye.aspect.is_finite() && eye.aspect > 0.0;
        if !usable {
            return Err(Fallback::NoEye);
        }
        let space = space_of(light, bounds);
        let (eye, mut body) = eye_in(&space, eye);
        let (reach, whole_half) = reach_of(light, &space, bounds);
        if let Some(tan) = space.tan_outer {
            for side in 0..SIDES {
                let (sin, cos) = (std::f64::consts::TAU * side as f64 / SIDES as f64).sin_cos();
                body.cut(DVec3::new(-cos, -sin, -tan).extend(0.0));
            }
            body.cut(DVec3::NEG_Z.extend(-TIP * reach));
            body.cut(DVec3::Z.extend(reach));
        }
        if body.is_empty() {
            return Err(Fallback::NothingSeen);
        }
        let boxes = bounds.iter().filter(|b| !b.is_empty());
        let corners: Vec<_> = boxes.map(|b| space.corners(b)).collect();
        let point = |p: DVec3| point_of(&space, &eye, p);
        let points: Vec<Point> = corners.iter().flat_map(|c| body.common(*c)).map(point).collect();
        let points: Vec<Point> = points.into_iter().filter(|p| p.q.is_finite() && p.px.is_finite()).collect();
        if points.is_empty() {
            return Err(Fallback::NothingSeen);
        }
        let hull = hull(&points.iter().map(|p| p.q).collect::<Vec<_>>());
        let (least, most) = extent(&hull);
        let mut seen = Self {
            probes: Vec::new(),
            middle: 0.5 * (least + most),
            space,
            eye,
            points,
            hull,
            along: (0.0, 0.0),
            whole_half,
            least_half: whole_half * LEAST_SHARE,
        };
        seen.probes = seen.pick(&body, &corners);
        let rounding = rounding_of(bounds);
        seen.along = seen.range(light, &corners, rounding, options);
        let on_image = if seen.space.tan_outer.is_some() { rounding / seen.along.1 } else { rounding };
        seen.least_half = seen.least_half.max(on_image);
        let usable = seen.along.0.is_finite() && seen.along.1.is_finite() && seen.along.0 < seen.along.1;
        if usable { Ok(seen) } else { Err(Fallback::NothingSeen) }
    }

    /// Pixels on flat boxes, as they lie there. What is inside of other boxes may face otherwise than their sides, so a
    /// pixel there is taken to be round on the image plane; sides that eye and light do not both see do not count. In each cell of a grid over the image plane the finest of both is kept.
    fn pick(&self, body: &Convex, corners: &[[DVec3; 8]]) -> Vec<Probe> {
        let (least, most) = extent(&self.hull);
        let size = (most - least).max(DVec2::splat(f64::MIN_POSITIVE));
        let mut cells = vec![None::<(f64, Probe)>; 2 * (CELLS * CELLS) as usize];
        let mut put = |flat: bool, probe: Probe| {
            let cell = ((probe.q - least) / size * CELLS).floor();
            let cell = cell.clamp(DVec2::ZERO, DVec2::splat(CELLS - 1.0));
            let fineness = least_stretch(probe.image_from_px);
            let slot = &mut cells[2 * (cell.y * CELLS + cell.x) as usize + usize::from(flat)];
            if slot.is_none_or(|(other, _)| fineness < other) {
                *slot = Some((fineness, probe));
            }
        };
        for corners in corners {
            let is_flat = FLAT.iter().any(|(a, b)| corners[*a] == corners[*b]);
            for (normal, face) in body.faces_of(*corners) {
                let middle = face.iter().sum::<DVec3>() / face.len() as f64;
                for p in face.iter().copied().chain([middle]) {
                    if let Some(probe) = self.probe(p, normal, is_flat) {
                        put(is_flat, probe);
                    }
                }
            }
        }
        let picked: Vec<Probe> = cells.into_iter().flatten().map(|(_, probe)| probe).collect();
        if picked.is_empty() {
            return self.points.iter().map(Probe::round).filter(Probe::is_usable).collect();
        }
        picked
    }

    fn to_eye(&self, p: DVec3) -> DVec3 {
        let way = if self.eye.parallel { -self.eye.forward } else { self.eye.position - p };
        way.normalize_or_zero()
    }

    fn to_light(&self, p: DVec3) -> DVec3 {
        if self.space.tan_outer.is_some() { (-p).normalize_or_zero() } else { DVec3::Z }
    }

    /// A pixel on a sheet, or on what a side of a box stands for; `None` unless it faces both eye and light.
    fn probe(&self, p: DVec3, normal: DVec3, is_flat: bool) -> Option<Probe> {
        let toward_eye = self.to_eye(p).dot(normal);
        let side = if is_flat && toward_eye < 0.0 { -1.0 } else { 1.0 };
        let normal = normal * side;
        if self.to_light(p).dot(normal) < FACING || (toward_eye <= 0.0 && !is_flat) {
            return None;
        }
        let probe = if is_flat {
            let (u, v) = normal.any_orthonormal_pair();
            let pixels = DMat2::from_cols(self.eye.step(p, u), self.eye.step(p, v));
            let image = DMat2::from_cols(self.space.step(p, u), self.space.step(p, v));
            let image_from_px =
                if pixels.determinant() == 0.0 { return None } else { image * pixels.inverse() };
            Probe { q: self.space.image(p), image_from_px }
        } else {
            Probe::round(&point_of(&self.space, &self.eye, p))
        };
        probe.is_usable().then_some(probe)
    }

    /// Near and far: from the first caster that lies on a ray to what is seen, to the last that is seen.
    fn range(
        &self,
        light: &Light,
        corners: &[[DVec3; 8]],
        rounding: f64,
        options: &FitOptions,
    ) -> (f64, f64) {
        let far = self.points.iter().map(|p| -p.p.z).fold(f64::NEG_INFINITY, f64::max);
        let highest = corners.iter().flatten().map(|p| p.z).fold(f64::NEG_INFINITY, f64::max);
        let (least, most) = extent(&self.hull);
        // What a filter may look at beyond the hull, generously.
        let room = (most - least).max_element() * 4.0 * border(options) + self.whole_half * 1e-3;
        let (least, most) = (least - room, most + room);
        let spot = self.space.tan_outer.is_some();
        let (least_near, far) = if spot {
            let far = light.far_m.map_or(far * 1.001, f64::from);
            (far * f64::from(options.least_near).clamp(TIP, 0.5), far)
        } else {
            (-highest - self.whole_half * 1e-3, far)
        };
        let at = |q: DVec2, along: f64| (if spot { q * along } else { q }).extend(-along);
        let body = Convex::from_corners(std::array::from_fn(|i| {
            let q = DVec2::new(
                if i & 1 == 0 { least.x } else { most.x },
                if i & 2 == 0 { least.y } else { most.y },
            );
            at(q, if i & 4 == 0 { least_near } else { far + self.whole_half * 1e-6 })
        }));
        let between = corners.iter().flat_map(|c| body.common(*c));
        let near = between.map(|p| -p.z).fold(far, f64::min);
        if spot {
            let near = light.near_m.map_or((near * 0.999).max(least_near), f64::from);
            return (near.min(far * 0.99), far);
        }
        let hair = (0.01 * (far - near)).max(self.whole_half * 1e-5).max(rounding);
        (near - hair, far + hair)
    }
}

fn point_of(space: &Space, eye: &EyeInLight, p: DVec3) -> Point {
    let depth = if eye.parallel { 1.0 } else { eye.depth(p).max(f64::MIN_POSITIVE) };
    let px = if space.tan_outer.is_some() { depth / -p.z } else { depth };
    Point { p, q: space.image(p), px }
}

/// The share of a map's width that is kept free on each side.
pub(super) fn border(options: &FitOptions) -> f64 {
    let share = f64::from(options.border_texel) / f64::from(options.size_texel.max(1));
    if share.is_finite() { share.clamp(0.0, 0.125) } else { 0.125 }
}

/// The box around points.
pub(super) fn extent(points: &[DVec2]) -> (DVec2, DVec2) {
    points.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(a, b), p| (a.min(*p), b.max(*p)))
}

fn space_of(light: &Light, bounds: &[Aabb]) -> Space {
    let light_from_world = light.world_from_light_rotation().as_dmat3().transpose();
    match light.kind {
        LightKind::Spot { outer_rad, .. } => Space {
            light_from_world,
            origin_world: light.position_world.as_dvec3(),
            tan_outer: Some(f64::from(outer_rad).tan()),
        },
        _ => {
            let whole = bounds.iter().fold(Aabb::EMPTY, |all, b| all.union(b));
            Space { light_from_world, origin_world: whole.center().as_dvec3(), tan_outer: None }
        }
    }
}

/// How far the light reaches along its axis, and half of the width of its whole image.
fn reach_of(light: &Light, space: &Space, bounds: &[Aabb]) -> (f64, f64) {
    let corners = bounds.iter().filter(|b| !b.is_empty()).flat_map(|b| space.corners(b));
    let (size, depth) = corners
        .fold((0.0f64, 0.0f64), |(size, depth), p| (size.max(p.x.abs()).max(p.y.abs()), depth.max(-p.z)));
    let asked = light.far_m.or(light.range_m).map_or(f64::INFINITY, f64::from);
    let reach = asked.min(depth * 1.001);
    let least = rounding_of(bounds);
    (reach, space.tan_outer.unwrap_or(size.max(1e-3 * depth).max(least)))
}

/// Lengths below this are lost in the rounding of places in the world, metres.
fn rounding_of(bounds: &[Aabb]) -> f64 {
    let whole = bounds.iter().fold(Aabb::EMPTY, |all, b| all.union(b));
    let farthest = whole.min.abs().max(whole.max.abs()).max_element();
    if whole.is_empty() { 0.0 } else { f64::from((ROUNDING * farthest).max(f32::MIN_POSITIVE.sqrt())) }
}

/// The eye, and the body that it sees, in the light's space.
fn eye_in(space: &Space, eye: &Eye) -> (EyeInLight, Convex) {
    let camera = &eye.camera;
    let axes = camera.view_from_world().transpose();
    let axis = |column: Vec3| space.light_from_world * column.as_dvec3();
    let (half_height, parallel) = match camera.projection {
        Projection::Perspective { fov_y_rad } => ((0.5 * f64::from(fov_y_rad)).tan(), false),
        Projection::Orthographic { half_height_m } => (f64::from(half_height_m), true),
    };
    let row = |v: glam::Vec4| axis(v.truncate());
    let found = EyeInLight {
        position: space.point(camera.position_world),
        right: row(axes.x_axis),
        up: row(axes.y_axis),
        forward: -row(axes.z_axis),
        half: DVec2::new(half_height * f64::from(eye.aspect), half_height),
        parallel,
    };
    let body = Convex::from_corners(std::array::from_fn(|i| {
        let sign = |bit: usize| if i & bit == 0 { -1.0 } else { 1.0 };
        let depth = f64::from(if i & 4 == 0 { camera.near_m } else { camera.far_m });
        // A hair wider, because the picture's matrix is rounded.
        let wide = found.half * (1.0 + 1e-5) * if parallel { 1.0 } else { depth };
        found.position
            + found.forward * depth * if i & 4 == 0 { 1.0 - 1e-5 } else { 1.0 + 1e-5 }
            + found.right * sign(1) * wide.x
            + found.up * sign(2) * wide.y
    }));
    (found, body)
}
