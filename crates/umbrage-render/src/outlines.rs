//! The three geometries of a blocker: what its view is fitted to, what its outline is drawn with, and the mesh that is shown.

use crate::maps::Growing;
use crate::maskable::has_holes;
use glam::{DVec4, Vec3};
use std::ops::Range;
use umbrage::core::fit::MaskView;
use umbrage::core::technique::Settings;
use umbrage::core::technique::mask::{FitTo, Mask, Outline};
use umbrage::core::{Aabb, Light};
use umbrage::mask::MaskPart;
use umbrage_scene::{Mesh, Scene, is_closed};

/// One mesh's.
#[derive(Debug)]
struct OfMesh {
    mesh: Mesh,
    /// Corners of its hull, object space; found when first asked for.
    hull: Option<Vec<Vec3>>,
    /// May it be drawn with fewer triangles?
    may_be_reduced: bool,
    /// Is one side of it enough? Found when first asked for.
    closed: Option<bool>,
    /// Outlines, and where each stands in the buffer. Level n is off by 2^(n/4) metres in object space at most; `WHOLE` by nothing.
    drawn: Vec<(i32, Range<u32>)>,
    /// One side of outlines: their level, where the light is in object space, and where each stands in the buffer.
    sides: Vec<(i32, DVec4, Range<u32>)>,
}

/// The level of a mesh as it is.
const WHOLE: i32 = i32::MIN;

/// Those of all meshes.
#[derive(Debug)]
pub struct Outlines {
    meshes: Vec<OfMesh>,
    indices: Vec<u32>,
    buffer: Growing,
    written: usize,
    /// How many indices the world needed when all were forgotten last.
    needed: usize,
    /// How far an outline may be off, texels.
    texels: f32,
    /// Vertices move by this further, so that hulls do not hold them; metres.
    reach_m: f32,
}

impl Outlines {
    /// Nothing is computed yet. Meshes that a function moves (by so many metres at most) are fitted by boxes and drawn whole.
    pub fn new(
        device: &wgpu::Device,
        scene: &Scene,
        settings: &Settings,
        choices: &Mask,
        deform_reach_m: Option<f32>,
    ) -> Self {
        let is_reduced = choices.outline == Outline::Reduced && deform_reach_m.is_none();
        let of_mesh = |mesh: &Mesh| OfMesh {
            may_be_reduced: is_reduced && !has_holes(scene, mesh),
            // Colours and texture coordinates are of no use here.
            mesh: Mesh {
                positions: mesh.positions.clone(),
                indices: mesh.indices.clone(),
                bounds: mesh.bounds,
                ..Mesh::default()
            },
            hull: None,
            closed: None,
            drawn: Vec::new(),
            sides: Vec::new(),
        };
        Self {
            meshes: scene.meshes.iter().map(of_mesh).collect(),
            indices: Vec::new(),
            buffer: Growing::new(device, "outlines", wgpu::BufferUsages::INDEX, 0),
            written: 0,
            needed: 0,
            texels: settings.value("outline_texel").unwrap_or(0.0),
            reach_m: deform_reach_m.unwrap_or(0.0),
        }
    }

    /// Gives a mesh another shape.
    pub fn reshape(&mut self, index: usize, mesh: &Mesh) {
        let of_mesh = &mut self.meshes[index];
        of_mesh.mesh.positions.clone_from(&mesh.positions);
        of_mesh.mesh.bounds = mesh.bounds;
        of_mesh.hull = None;
        of_mesh.closed = None;
        of_mesh.drawn.clear();
        of_mesh.sides.clear();
    }

    /// The points that hold all of an object.
    pub fn fit_points_world(&mut self, parts: &[MaskPart], fit_to: FitTo) -> Vec<Vec3> {
        let mut points = Vec::new();
        for part in parts {
            let of_mesh = &mut self.meshes[part.mesh as usize];
            if fit_to == FitTo::Box || self.reach_m > 0.0 {
                let bounds = of_mesh.mesh.bounds;
                let corners = bounds.corners().map(|p| part.world_from_object.transform_point3(p));
                points.extend(corners.iter().flat_map(|p| [*p - self.reach_m, *p + self.reach_m]));
                continue;
            }
            let hull = of_mesh.hull.get_or_insert_with(|| of_mesh.mesh.fit_points());
            points.extend(hull.iter().map(|p| part.world_from_object.transform_point3(*p)));
        }
        points
    }

    /// Box around an object as it is where nothing moves its vertices.
    pub fn rest_box_world(&self, parts: &[MaskPart]) -> Aabb {
        parts.iter().fold(Aabb::EMPTY, |all, part| {
            all.union(&self.meshes[part.mesh as usize].mesh.bounds.transformed(&part.world_from_object))
        })
    }

    /// The indices that draw a part's outline into a mask: off by as many texels as may be, where it may be reduced.
    pub fn indices(&mut self, part: &MaskPart, view: &MaskView, light: &Light) -> Range<u32> {
        let of_mesh = &mut self.meshes[part.mesh as usize];
        let place = light.position_world.clamp(part.bounds_world.min, part.bounds_world.max);
        let nearest = place.distance(light.position_world).max(view.near_m);
        let texel_m = view.texel.min_element() * if view.perspective { nearest } else { 1.0 };
        let (x, y, z) = {
            let m = part.world_from_object;
            (m.x_axis.truncate().length(), m.y_axis.truncate().length(), m.z_axis.truncate().length())
        };
        let most_m =
            if of_mesh.may_be_reduced { self.texels * texel_m / x.max(y).max(z).max(1e-30) } else { 0.0 };
        // In steps, so that blockers of one mesh share outlines, and a light that moves finds them again; in small ones, because
        // triangles grow as what they may be off by shrinks.
        let level = if most_m > 0.0 { (4.0 * most_m.log2()).floor() as i32 } else { WHOLE };
        let whole = self.outline(part.mesh as usize, level);
        if level == WHOLE { whole } else { self.side(part, level, whole, view) }
    }

    /// All of an outline.
    fn outline(&mut self, mesh: usize, level: i32) -> Range<u32> {
        let of_mesh = &mut self.meshes[mesh];
        if let Some((_, range)) = of_mesh.drawn.iter().find(|(other, _)| *other == level) {
            return range.clone();
        }
        let found = if level == WHOLE {
            of_mesh.mesh.indices.clone()
        } else {
            of_mesh.mesh.outline((0.25 * level as f32).exp2()).indices
        };
        let first = self.indices.len() as u32;
        self.indices.extend(found);
        let range = first..self.indices.len() as u32;
        of_mesh.drawn.push((level, range.clone()));
        range
    }

    /// What of an outline covers as much as all of it. A ray enters a closed surface as often as it leaves it, so its lit side
    /// and its dark side have one outline: the side of fewer triangles is enough. The light is outside, or there is no mask.
    fn side(&mut self, part: &MaskPart, level: i32, whole: Range<u32>, view: &MaskView) -> Range<u32> {
        let of_mesh = &mut self.meshes[part.mesh as usize];
        let object_from_world = part.world_from_object.as_dmat4().inverse();
        let light = object_from_world * view.light_point_world().as_dvec4();
        let closed = *of_mesh.closed.get_or_insert_with(|| is_closed(&of_mesh.mesh));
        if !closed || !light.is_finite() {
            return whole;
        }
        let is_known = |side: &&(i32, DVec4, Range<u32>)| side.0 == level && side.1 == light;
        if let Some((.., range)) = of_mesh.sides.iter().find(is_known) {
            return range.clone();
        }
        let mut sides = [Vec::new(), Vec::new()];
        for triangle in self.indices[whole.start as usize..whole.end as usize].chunks_exact(3) {
            let [a, b, c] = [0, 1, 2].map(|i| of_mesh.mesh.positions[triangle[i] as usize].as_dvec3());
            let (across, way) = ((b - a).cross(c - a), light.truncate() - a * light.w);
            let facing = across.dot(way);
            // Edge-on, rounding decides: it counts to both.
            let hair = 1e-6 * across.length() * way.length();
            for (side, is_on) in sides.iter_mut().zip([facing >= -hair, facing <= hair]) {
                if is_on {
                    side.extend_from_slice(triangle);
                }
            }
        }
        let [lit, dark] = sides;
        let first = self.indices.len() as u32;
        self.indices.extend(if lit.len() <= dark.len() { lit } else { dark });
        let range = first..self.indices.len() as u32;
        of_mesh.sides.push((level, light, range.clone()));
        range
    }

    /// Forgets outlines of meshes that have another shape by now, and sides that no light sees any more, when there are many.
    pub fn tidy(&mut self) {
        let whole: usize = self.meshes.iter().map(|of| of.mesh.indices.len()).sum();
        if self.indices.len() > 8 * whole.max(self.needed) {
            self.indices.clear();
            (self.written, self.needed) = (0, 0);
            for of_mesh in &mut self.meshes {
                of_mesh.drawn.clear();
                of_mesh.sides.clear();
            }
        }
    }

    /// Hands new indices to the GPU.
    pub fn write(&mut self, device: &wgpu::Device, queue: &wgpu::Queue) {
        if self.written != self.indices.len() {
            self.needed = if self.needed == 0 { self.indices.len() } else { self.needed };
            self.buffer.write(device, queue, bytemuck::cast_slice(&self.indices));
            self.written = self.indices.len();
        }
    }

    /// Indices of all outlines.
    pub fn buffer(&self) -> &wgpu::Buffer {
        &self.buffer.buffer
    }

    /// Memory, bytes.
    pub fn memory_bytes(&self) -> u64 {
        self.buffer.buffer.size()
    }
}
