//! OBJ files whose edges are split: every face has vertices of its own with the face's normal, and ghosts lie between.

use super::outline::{Normals, Outline};
use super::records::{Record, Records, absolute, line_end, tail};
use crate::obj::words;
use crate::{SceneError, obj, ordinary};
use std::io::Write;
use std::path::Path;
use umbrage_core::edges::{Pairs, Side};

/// The group that ghosts are in.
const GHOSTS: &str = "umbrage_ghosts";

/// A file that is split, not yet written.
#[derive(Clone, Debug)]
pub struct SplitObj {
    /// The whole file.
    pub bytes: Vec<u8>,
    /// What was found and made.
    pub counts: SplitCounts,
    /// What may cast wrong shadows, one clause each, for the user's eye.
    pub warnings: Vec<String>,
}

/// What an OBJ file had, and what it has more now.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SplitCounts {
    /// Vertices in the file; all stay where indices find them.
    pub vertices: usize,
    /// Faces in the file whose edges are split.
    pub faces: usize,
    /// Vertices added: one for each corner of each face, and the far corners of open edges' ghosts.
    pub added_vertices: usize,
    /// Normals added: one for each direction.
    pub added_normals: usize,
    /// Reversed copies added to open parts.
    pub back_faces: usize,
    /// Ghost quads added.
    pub ghosts: usize,
    /// Different edges of faces.
    pub edges: usize,
    /// Uses of edges that nothing runs against. Faces are closed where there are none.
    pub open: usize,
    /// Edges of more than two faces.
    pub shared_by_more: usize,
    /// Faces with fewer than three different corners; they stay as they are.
    pub degenerate: usize,
    /// Faces with the corners and the winding of an earlier one; they are split as others.
    pub duplicated: usize,
    /// Parts: faces that share an edge are of one part.
    pub parts: usize,
    /// Parts with an open edge.
    pub open_parts: usize,
    /// Records other than faces whose references count from the start now, because they counted backwards.
    pub renumbered: usize,
}

/// Rewrites an OBJ file for shadow volumes by vertex shader: move each vertex whose normal faces away from the light, and what
/// comes out is the volume.
///
/// Each face keeps its corners but gets vertices of its own, with the face's normal (of polygons that are not flat, the mean
/// one). Between two faces that meet, by place and not by index, lies a ghost: a quad without area. Ghosts are at the end,
/// in the group `umbrage_ghosts`. All other records stay as they are, byte for byte and in order. Vertices and normals keep
/// their indices; those after the first face move before it, so that added ones can follow them and still come before
/// all who use them. References that count backwards past that place count from the start instead.
///
/// At an open edge the ghost goes to a copy of the edge with the reversed normal, which nothing continues. With
/// `back_faces` faces of open parts are followed by their reverse, which continues it: such parts cast from both sides.
///
/// Cost: a few passes over the file, in memory; about six times the file's size is written.
///
/// # Errors
/// As [`load`](crate::load); [`SceneError::UnknownFormat`] for endings other than `.obj`, and
/// [`SceneError::Unsupported`] for a file that is split already.
pub fn split_obj(path: &Path, back_faces: bool) -> Result<SplitObj, SceneError> {
    ordinary(path)?;
    if !path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("obj")) {
        let reason = "only .obj files can be split; other meshes are split in memory as they are loaded";
        return Err(SceneError::UnknownFormat { path: path.to_owned(), reason: reason.into() });
    }
    let bytes = std::fs::read(path).map_err(|e| SceneError::read(path, &e))?;
    obj::check(path, &bytes)?;
    let is_ghosts = |record: Record<'_>| {
        let (key, rest) = record.parts();
        key == "g" && words(rest).any(|word| word == GHOSTS)
    };
    if Records::new(&bytes).any(is_ghosts) {
        let what = format!("its edges are split already (group {GHOSTS}); split the file it was made from");
        return Err(SceneError::Unsupported { path: path.to_owned(), what });
    }
    let outline = Outline::read(&bytes).map_err(|what| SceneError::malformed(path, what))?;
    if outline.faces.is_empty() {
        let what = "all faces have fewer than three different corners; check the export".into();
        return Err(SceneError::NoTriangles { path: path.to_owned(), what });
    }
    Ok(Splitter::new(&bytes, &outline, back_faces).split())
}

/// A corner of a face to be written: vertex and normal, from 0 among the added ones.
type Corner = (u32, usize);

struct Splitter<'a> {
    bytes: &'a [u8],
    line_end: &'static [u8],
    outline: &'a Outline,
    pairs: Pairs,
    normals: Normals,
    /// For each face the numbers of its normal and of the reverse.
    normal_of: Vec<[usize; 2]>,
    /// For each added vertex the one that it copies. The first are the corners of faces, in order.
    copies: Vec<u32>,
    /// For each face its reverse's first vertex, where it has one.
    back_of: Vec<Option<u32>>,
    ghosts: Vec<[Corner; 4]>,
    out: Vec<u8>,
    counts: SplitCounts,
}

impl<'a> Splitter<'a> {
    fn new(bytes: &'a [u8], outline: &'a Outline, back_faces: bool) -> Self {
        let pairs = outline.pairs();
        let mut normals = Normals::default();
        let mut copies = outline.corners.clone();
        let (mut normal_of, mut back_of) = (Vec::new(), Vec::new());
        for (face, corners) in (0u32..).zip(&outline.faces) {
            let normal = outline.normal(face);
            let open = pairs.open[pairs.part_of[face as usize] as usize];
            normal_of.push([normals.number(normal), if open { normals.number(-normal) } else { 0 }]);
            let back = (back_faces && open).then_some(copies.len() as u32);
            if back.is_some() {
                copies.extend_from_slice(&outline.corners[corners.start as usize..corners.end as usize]);
            }
            back_of.push(back);
        }
        let counts = SplitCounts {
            vertices: outline.totals[0],
            faces: outline.faces.len(),
            back_faces: back_of.iter().flatten().count(),
            edges: pairs.distinct,
            open: pairs.pairs.iter().filter(|pair| pair.right.is_none()).count(),
            shared_by_more: pairs.shared_by_more,
            degenerate: outline.records.iter().filter(|face| face.is_none()).count(),
            duplicated: outline.duplicated,
            parts: pairs.open.len(),
            open_parts: pairs.open.iter().filter(|open| **open).count(),
            ..SplitCounts::default()
        };
        let out = Vec::with_capacity(4 * bytes.len());
        let (line_end, ghosts) = (line_end(bytes), Vec::new());
        Self { bytes, line_end, outline, pairs, normals, normal_of, copies, back_of, ghosts, out, counts }
    }

    fn split(mut self) -> SplitObj {
        self.find_ghosts();
        self.counts.ghosts = self.ghosts.len();
        self.counts.added_vertices = self.copies.len();
        self.counts.added_normals = self.normals.all.len();
        self.write_records();
        self.finish_line();
        self.out.extend_from_slice(format!("g {GHOSTS}").as_bytes());
        self.out.extend_from_slice(self.line_end);
        for ghost in std::mem::take(&mut self.ghosts) {
            self.out.push(b'f');
            ghost.into_iter().for_each(|corner| self.write_corner(corner, ""));
            self.out.extend_from_slice(self.line_end);
        }
        SplitObj { bytes: self.out, counts: self.counts, warnings: warnings(&self.counts) }
    }

    fn find_ghosts(&mut self) {
        for pair in std::mem::take(&mut self.pairs.pairs) {
            let left @ [a, b] = self.front(pair.left);
            match pair.right {
                Some(right) => {
                    let [b_right, a_right] = self.front(right);
                    self.ghosts.push([a, a_right, b_right, b]);
                    // The reverse of the right face runs as the left one does.
                    let reverse = (self.back(right), self.back(pair.left));
                    if let (Some([b_right, a_right]), Some([a_left, b_left])) = reverse {
                        self.ghosts.push([a_right, a_left, b_left, b_right]);
                    }
                }
                None => {
                    let [a_back, b_back] = self.back(pair.left).unwrap_or_else(|| {
                        let reversed = self.normal_of[pair.left.face as usize][1];
                        left.map(|(corner, _)| {
                            self.copies.push(self.copies[corner as usize]);
                            (self.copies.len() as u32 - 1, reversed)
                        })
                    });
                    self.ghosts.push([a, a_back, b_back, b]);
                }
            }
        }
    }

    /// The corners at the beginning and the end of a side.
    fn front(&self, side: Side) -> [Corner; 2] {
        let normal = self.normal_of[side.face as usize][0];
        [side.id, self.outline.next(side.face, side.id)].map(|corner| (corner, normal))
    }

    /// The same two corners of the face's reverse.
    fn back(&self, side: Side) -> Option<[Corner; 2]> {
        let back = self.back_of[side.face as usize]?;
        let (start, normal) =
            (self.outline.faces[side.face as usize].start, self.normal_of[side.face as usize][1]);
        Some(self.front(side).map(|(corner, _)| (back + corner - start, normal)))
    }

    fn write_records(&mut self) {
        let bytes = self.bytes;
        self.out.extend_from_slice(&bytes[..Records::start(bytes)]);
        let (mut seen, mut faces, mut inserted, mut named) = ([0; 3], 0, false, false);
        for record in Records::new(bytes) {
            let (key, rest) = record.parts();
            match key {
                "v" | "vn" if inserted => {}
                "f" | "fo" if self.outline.records[faces].is_some() => {
                    let face = self.outline.records[faces].unwrap_or_default();
                    if !inserted {
                        self.insert_vertices(record.number, named);
                        inserted = true;
                    }
                    self.write_face(&record, key, rest, face);
                }
                _ => match absolute(&record, seen).filter(|_| inserted) {
                    Some(renumbered) => {
                        self.out.extend_from_slice(&renumbered);
                        self.counts.renumbered += 1;
                    }
                    None => self.out.extend_from_slice(record.raw),
                },
            }
            match key {
                "v" => seen[0] += 1,
                "vt" => seen[1] += 1,
                "vn" => seen[2] += 1,
                "f" | "fo" => faces += 1,
                "g" | "o" => named = true,
                _ => {}
            }
        }
    }

    /// Those of the file that come after line `number`, then those that are added. `named`: has a group or an object begun?
    fn insert_vertices(&mut self, number: usize, named: bool) {
        for record in Records::new(self.bytes).filter(|record| record.number > number) {
            if matches!(record.parts().0, "v" | "vn") {
                self.out.extend_from_slice(record.raw);
                self.finish_line();
            }
        }
        for vertex in &self.copies {
            self.out.push(b'v');
            self.out.extend_from_slice(self.outline.vertex_text(*vertex).as_bytes());
            self.out.extend_from_slice(self.line_end);
        }
        for normal in &self.normals.all {
            // Memory takes all that is written to it.
            let _ = write!(self.out, "vn {} {} {}", normal.x, normal.y, normal.z);
            self.out.extend_from_slice(self.line_end);
        }
        // Faces before any group are in the group `default`; some readers put them into the first that is named.
        if !named {
            self.out.extend_from_slice(b"g default");
            self.out.extend_from_slice(self.line_end);
        }
    }

    /// The face with its own vertices, and its reverse after it where it has one.
    fn write_face(&mut self, record: &Record<'_>, key: &str, rest: &str, face: u32) {
        let corners = self.outline.faces[face as usize].clone();
        let [front, reversed] = self.normal_of[face as usize];
        let uvs: Vec<&str> = words(rest).map(|word| word.split('/').nth(1).unwrap_or("")).collect();
        self.out.extend_from_slice(key.as_bytes());
        for (corner, uv) in corners.clone().zip(&uvs) {
            self.write_corner((corner, front), uv);
        }
        self.out.extend_from_slice(tail(record.raw));
        if let Some(back) = self.back_of[face as usize] {
            self.finish_line();
            self.out.extend_from_slice(key.as_bytes());
            for (corner, uv) in (back..back + corners.len() as u32).zip(&uvs).rev() {
                self.write_corner((corner, reversed), uv);
            }
            self.out.extend_from_slice(self.line_end);
        }
    }

    fn write_corner(&mut self, (vertex, normal): Corner, uv: &str) {
        let [vertices, _, normals] = self.outline.totals;
        let (vertex, normal) = (vertices + vertex as usize + 1, normals + normal + 1);
        let _ = write!(self.out, " {vertex}/{uv}/{normal}");
    }

    /// Ends the last line, if the file does not. A backslash there, which promised one more, gets an empty one.
    fn finish_line(&mut self) {
        let ended = matches!(self.out.last(), None | Some(b'\n' | b'\r'));
        let continued = self.out.trim_ascii_end().ends_with(b"\\");
        for _ in 0..u8::from(!ended) + u8::from(continued) {
            self.out.extend_from_slice(self.line_end);
        }
    }
}

fn warnings(counts: &SplitCounts) -> Vec<String> {
    let SplitCounts { open, open_parts, shared_by_more, degenerate, duplicated, back_faces, .. } = *counts;
    let mut warnings = Vec::new();
    let mut warn = |count: usize, what: &str| {
        if count > 0 {
            warnings.push(format!("{count} {what}"));
        }
    };
    if back_faces == 0 {
        let what = format!(
            "open edges in {open_parts} parts: their shadow volumes are not closed; close the surface, or add its back \
             by --back-faces"
        );
        warn(open, &what);
    }
    warn(shared_by_more, "edges have more than two faces: faces are paired by their direction");
    warn(degenerate, "faces have fewer than three different corners and stay as they are");
    warn(duplicated, "faces are there twice; delete one of each");
    warnings
}
