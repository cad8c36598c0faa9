//! A blocker's geometry for the three things that masks do with it: points to fit the view to, triangles to draw the outline
//! with, and the mesh itself to be seen.

use crate::{Mesh, hull, is_closed};
use glam::Vec3;
use meshopt::{SimplifyOptions, VertexDataAdapter};
use std::collections::HashMap;

/// Triangles that have nearly the outline of a mesh, seen from anywhere.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// Three for each triangle, into the mesh's own positions; turned as its triangles are.
    pub indices: Vec<u32>,
    /// How far the surface was moved, metres in object space, as the simplifier estimates it. 0 where it was not.
    pub error_m: f32,
}

impl Mesh {
    /// The points that a mask is fitted to: the corners of the mesh's convex hull, which holds all of its triangles from any
    /// place. Object space. Where there is no hull, as of a flat mesh, all of its positions.
    ///
    /// Cost: about a second at most (7 ms for 12,000 positions, half a second for 67,000): once for each mesh that does not bend.
    pub fn fit_points(&self) -> Vec<Vec3> {
        hull::hull_points(self.indices.iter().filter_map(|i| self.positions.get(*i as usize).copied()))
    }

    /// Triangles to draw the mesh's outline with: detail below `error_m` (metres in object space, above 0) is gone, wherever it
    /// is, and contours stay. For a mask, take what a texel measures at the blocker; half of it changes few texels.
    ///
    /// All corners are positions of the mesh, so what holds those holds the outline. A closed mesh stays closed. The mesh's own
    /// triangles come back where nothing can be gained, and where `error_m` is no length. Cut-outs and what is mixed by alpha
    /// have contours inside of triangles: draw those as they are.
    ///
    /// Cost: about a microsecond a triangle; once for each mesh.
    ///
    /// The length is the simplifier's estimate. At half a texel no texel farther than 2 from the contour differed on closed test
    /// meshes; at two texels some do.
    pub fn outline(&self, error_m: f32) -> Outline {
        self.reduced(error_m).unwrap_or_else(|| Outline { indices: self.indices.clone(), error_m: 0.0 })
    }

    fn reduced(&self, error_m: f32) -> Option<Outline> {
        if !(error_m.is_finite() && error_m > 0.0) {
            return None;
        }
        // Vertices that differ by normal or texture only are one corner here. `sources` leads back to the mesh.
        let mut first_at: HashMap<[u32; 3], u32> = HashMap::with_capacity(self.positions.len());
        let (mut sources, mut places, mut welded) =
            (Vec::new(), Vec::new(), Vec::with_capacity(self.indices.len()));
        for triangle in self.indices.chunks_exact(3) {
            let mut corners = [0; 3];
            for (corner, &i) in corners.iter_mut().zip(triangle) {
                let p = *self.positions.get(i as usize).filter(|p| p.is_finite())? + 0.0;
                *corner = *first_at.entry(p.to_array().map(f32::to_bits)).or_insert_with(|| {
                    sources.push(i);
                    places.push(p.to_array());
                    sources.len() as u32 - 1
                });
            }
            if corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0] {
                welded.extend(corners);
            }
        }
        let bytes: Vec<u8> = places.iter().flatten().flat_map(|x| x.to_ne_bytes()).collect();
        let adapter = VertexDataAdapter::new(&bytes, size_of::<[f32; 3]>(), 0).ok()?;
        let options = SimplifyOptions::ErrorAbsolute | SimplifyOptions::Prune;
        let mut found_m = 0.0;
        let kept = meshopt::simplify(&welded, &adapter, 0, error_m, options, Some(&mut found_m));
        if kept.is_empty() || kept.len() >= self.indices.len() {
            return None;
        }
        let indices: Vec<u32> = kept.iter().map(|i| sources[*i as usize]).collect();
        let made =
            Mesh { indices, positions: self.positions.clone(), bounds: self.bounds, ..Mesh::default() };
        if is_closed(self) && !is_closed(&made) {
            return None;
        }
        Some(Outline { indices: made.indices, error_m: found_m })
    }
}
