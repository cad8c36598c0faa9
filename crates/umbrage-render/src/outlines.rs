//! The three geometries of a blocker: what its view is fitted to, what its outline is drawn with, and the mesh that is shown.

use crate::draw_list::MaskPart;
use crate::maps::Growing;
use crate::masks::has_holes;
use glam::Vec3;
use std::ops::Range;
use umbrage::core::Light;
use umbrage::core::fit::MaskView;
use umbrage::core::technique::Settings;
use umbrage::core::technique::mask::{FitTo, Mask, Outline};
use umbrage_scene::{Mesh, Scene};

/// One mesh's.
#[derive(Debug)]
struct OfMesh {
    mesh: Mesh,
    /// Corners of its hull, object space; found when first asked for.
    hull: Option<Vec<Vec3>>,
    /// May it be drawn with fewer triangles?
    may_be_reduced: bool,
    /// Outlines, and where each stands in the buffer. Level n is off by 2^n metres in object space at most; `WHOLE` by nothing.
    drawn: Vec<(i32, Range<u32>)>,
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
            drawn: Vec::new(),
        };
        Self {
            meshes: scene.meshes.iter().map(of_mesh).collect(),
            indices: Vec::new(),
            buffer: Growing::new(device, "outlines", wgpu::BufferUsages::INDEX, 0),
            written: 0,
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
        of_mesh.drawn.clear();
    }

    /// The points that hold all of an object.
    pub fn fit_points_world(&mut self, parts: &[MaskPart], fit_to: FitTo) -> Vec<Vec3> {
        let mut points = Vec::new();
        for part in parts {
            let of_mesh = &mut self.meshes[part.mesh];
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

    /// The indices that draw a part's outline into a mask: off by less than a fraction of a texel, where it may be reduced.
    pub fn indices(&mut self, part: &MaskPart, view: &MaskView, light: &Light) -> Range<u32> {
        let of_mesh = &mut self.meshes[part.mesh];
        let place = light.position_world.clamp(part.bounds_world.min, part.bounds_world.max);
        let nearest = place.distance(light.position_world).max(view.near_m);
        let texel_m = view.texel.min_element() * if view.perspective { nearest } else { 1.0 };
        let (x, y, z) = {
            let m = part.world_from_object;
            (m.x_axis.truncate().length(), m.y_axis.truncate().length(), m.z_axis.truncate().length())
        };
        let most_m =
            if of_mesh.may_be_reduced { self.texels * texel_m / x.max(y).max(z).max(1e-30) } else { 0.0 };
        // By powers of two, so that blockers of one mesh share outlines, and a light that moves finds them again.
        let level = if most_m > 0.0 { most_m.log2().floor() as i32 } else { WHOLE };
        if let Some((_, range)) = of_mesh.drawn.iter().find(|(other, _)| *other == level) {
            return range.clone();
        }
        let found = if level == WHOLE {
            of_mesh.mesh.indices.clone()
        } else {
            of_mesh.mesh.outline(2f32.powi(level)).indices
        };
        let first = self.indices.len() as u32;
        self.indices.extend(found);
        let range = first..self.indices.len() as u32;
        of_mesh.drawn.push((level, range.clone()));
        range
    }

    /// Forgets outlines of meshes that have another shape by now, when there are many.
    pub fn tidy(&mut self) {
        let whole: usize = self.meshes.iter().map(|of| of.mesh.indices.len()).sum();
        if self.indices.len() > 8 * whole {
            self.indices.clear();
            self.written = 0;
            self.meshes.iter_mut().for_each(|of| of.drawn.clear());
        }
    }

    /// Hands new indices to the GPU.
    pub fn write(&mut self, device: &wgpu::Device, queue: &wgpu::Queue) {
        if self.written != self.indices.len() {
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
