//! What an OBJ file's faces are made of, and which meet.

use super::records::Records;
use crate::obj::{newell, vertex, words};
use glam::Vec3;
use std::collections::{HashMap, HashSet};
use std::fmt::Write;
use std::ops::Range;
use umbrage_core::edges::{Pairs, Side, pair, weld};

/// Each corner may become four vertices, and those are counted in 32 bits.
const MAX_CORNERS: usize = (u32::MAX / 8) as usize;

/// Longer than any honest vertex is written: it is repeated for each corner.
const MAX_VERTEX_BYTES: usize = 160;

/// All about vertices and faces.
#[derive(Default)]
pub(super) struct Outline {
    /// Positions, texture coordinates and normals in the file.
    pub totals: [usize; 3],
    /// `v` lines after the first word, one after the other; ends of each.
    vertices: (String, Vec<usize>),
    positions: Vec<Vec3>,
    /// For each `f` record its face, or `None` where it has fewer than three different corners.
    pub records: Vec<Option<u32>>,
    /// Corners of each face, as indices into `corners`.
    pub faces: Vec<Range<u32>>,
    /// For each corner its vertex, from 0.
    pub corners: Vec<u32>,
    /// Faces with the corners and the winding of an earlier one.
    pub duplicated: usize,
}

impl Outline {
    /// Reads a file that the loader takes.
    ///
    /// # Errors
    /// One clause: too many corners, or something that the loader should not have taken.
    pub(super) fn read(bytes: &[u8]) -> Result<Self, String> {
        let mut outline = Self::default();
        for record in Records::new(bytes) {
            let (key, rest) = record.parts();
            match key {
                "v" => outline.vertex(record.number, rest)?,
                "vt" => outline.totals[1] += 1,
                "vn" => outline.totals[2] += 1,
                _ => {}
            }
        }
        let welded = weld(&outline.positions);
        let (mut seen, mut known) = (0, HashSet::new());
        for record in Records::new(bytes) {
            match record.parts() {
                ("v", _) => seen += 1,
                ("f" | "fo", rest) => {
                    let lost = || format!("line {}: the face cannot be read; export it again", record.number);
                    outline.face(rest, seen, &welded, &mut known).ok_or_else(lost)?;
                    if outline.corners.len() > MAX_CORNERS {
                        return Err(format!("more than {MAX_CORNERS} corners of faces; split the file"));
                    }
                }
                _ => {}
            }
        }
        // From here on only places count.
        Ok(outline)
    }

    fn vertex(&mut self, number: usize, rest: &str) -> Result<(), String> {
        let (position, numbers, count) = vertex(number, rest)?;
        self.positions.push(Vec3::from(position));
        let (text, ends) = &mut self.vertices;
        let start = text.len();
        for word in words(rest).take(7) {
            text.push(' ');
            text.push_str(word);
        }
        if text.len() - start > MAX_VERTEX_BYTES {
            text.truncate(start);
            for number in &numbers[..count] {
                let _ = write!(text, " {number:e}");
            }
        }
        ends.push(text.len());
        self.totals[0] += 1;
        Ok(())
    }

    fn face(&mut self, rest: &str, seen: usize, welded: &[u32], known: &mut HashSet<Vec<u32>>) -> Option<()> {
        let start = self.corners.len();
        for word in words(rest) {
            let index: i64 = word.split('/').next()?.parse().ok()?;
            let from_one = if index < 0 { index.checked_add(seen as i64 + 1)? } else { index };
            let vertex = u32::try_from(from_one.checked_sub(1)?).ok()?;
            self.corners.push((vertex as usize).lt(&welded.len()).then_some(vertex)?);
        }
        let mut places: Vec<u32> = self.corners[start..].iter().map(|v| welded[*v as usize]).collect();
        let mut different = places.clone();
        different.sort_unstable();
        different.dedup();
        if different.len() < 3 {
            self.corners.truncate(start);
            self.records.push(None);
            return Some(());
        }
        let least = (0..places.len()).min_by_key(|i| places[*i])?;
        places.rotate_left(least);
        self.duplicated += usize::from(!known.insert(places));
        self.records.push(Some(self.faces.len() as u32));
        self.faces.push(start as u32..self.corners.len() as u32);
        Some(())
    }

    /// Which faces meet. A side's number is that of the corner where it begins.
    pub(super) fn pairs(&self) -> Pairs {
        let welded = weld(&self.positions);
        let mut sides = Vec::with_capacity(self.corners.len());
        for (face, corners) in (0u32..).zip(&self.faces) {
            for id in corners.clone() {
                let place = |corner: u32| welded[self.corners[corner as usize] as usize];
                let (from, to) = (place(id), place(self.next(face, id)));
                if from != to {
                    sides.push(Side { from, to, id, face });
                }
            }
        }
        pair(sides, self.faces.len())
    }

    /// The corner after one, around the face.
    pub(super) fn next(&self, face: u32, corner: u32) -> u32 {
        let corners = &self.faces[face as usize];
        if corner + 1 < corners.end { corner + 1 } else { corners.start }
    }

    /// What stands after `v` for a vertex, with a space before it: position, weight, colour.
    pub(super) fn vertex_text(&self, vertex: u32) -> &str {
        let (text, ends) = &self.vertices;
        let at = vertex as usize;
        &text[at.checked_sub(1).map_or(0, |before| ends[before])..ends[at]]
    }

    /// The face's normal. A face without area gets one that is as good as any: it shadows nothing, but its corners have to
    /// move together.
    pub(super) fn normal(&self, face: u32) -> Vec3 {
        let corners = self.faces[face as usize].clone();
        let places: Vec<Vec3> = corners.map(|i| self.positions[self.corners[i as usize] as usize]).collect();
        if let Some(normal) = newell(&places).try_normalize() {
            return normal.as_vec3();
        }
        let edges = places.windows(2).map(|w| (w[1].as_dvec3() - w[0].as_dvec3()).normalize_or_zero());
        let edge = edges.max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()));
        edge.and_then(|e| e.try_normalize()).map_or(Vec3::Y, |e| e.any_orthonormal_vector().as_vec3())
    }
}

/// Normals, each written once.
#[derive(Default)]
pub(super) struct Normals {
    number_of: HashMap<[u32; 3], usize>,
    /// In the order of their numbers.
    pub all: Vec<Vec3>,
}

impl Normals {
    /// The number of a normal, from 0.
    pub(super) fn number(&mut self, normal: Vec3) -> usize {
        // Written plainly, tiny numbers are long. Adding zero makes -0 and 0 the same.
        let plain = normal.to_array().map(|x| if x.abs() < 1e-9 { 0.0 } else { x + 0.0 });
        *self.number_of.entry(plain.map(f32::to_bits)).or_insert_with(|| {
            self.all.push(Vec3::from(plain));
            self.all.len() - 1
        })
    }
}
