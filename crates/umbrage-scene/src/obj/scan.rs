//! A pass over the lines before `tobj` sees them.
//!
//! `tobj` is strict where OBJ files in the wild are not, takes polylines for faces, has no smoothing groups, loses track
//! when some faces have normals and others do not, and can panic on indices near the integer limits. So each line is
//! checked here (errors name it) and written again in the one form that it reads well: all vertices first, absolute
//! indices, and one `g` for each combination of material, smoothing group and attributes.

use super::lines::{Lines, finite, keyword, quoted};
use std::{collections::HashMap, fmt::Write};

/// Coordinates beyond this would overflow when squared, and no scene is that large.
const MAX_COORDINATE: f32 = 1e15;

/// More `mtllib` lines than this are no honest file's.
const MAX_LIBRARIES: usize = 256;

/// What `s` says about a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Smoothing {
    /// No `s` in the file before it, or a numbered group.
    Group(u32),
    /// `s off` or `s 0`.
    Flat,
}

/// What all faces of one run have in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Run {
    /// Index into [`Scan::materials`]; `None` before the first `usemtl`.
    pub material: Option<usize>,
    /// Which faces are smooth with each other.
    pub smoothing: Smoothing,
    /// Every corner has texture coordinates.
    pub uvs: bool,
    /// Every corner has a normal.
    pub normals: bool,
}

/// A file whose every index is in range and every position finite.
#[derive(Debug, Default)]
pub(super) struct Scan {
    /// OBJ text for `tobj`: vertices, then one group for each of `runs`, in their order.
    pub text: String,
    /// Never one without faces.
    pub runs: Vec<Run>,
    /// Names after `usemtl`, each once.
    pub materials: Vec<String>,
    /// What stands after each `mtllib`, each once.
    pub libraries: Vec<String>,
    /// The file has vertex colours, and the text therefore has one for each vertex.
    pub colors: bool,
    /// For the message when there is nothing to draw.
    pub vertices: usize,
    /// Points and lines, which have no surface.
    pub points_and_lines: usize,
    /// What was passed over.
    pub warnings: Vec<String>,
}

/// Numbers of positions, texture coordinates and normals.
type Counts = [usize; 3];

/// Reads every line once for vertices and once for faces (whose indices may point forwards).
///
/// # Errors
/// One clause that names the line.
pub(super) fn scan(bytes: &[u8]) -> Result<Scan, String> {
    let mut scan = Scan { colors: has_colors(bytes), ..Scan::default() };
    let mut bad_normals = Vec::new();
    let mut totals: Counts = [0; 3];
    for (number, line) in Lines::new(bytes) {
        let (key, rest) = keyword(&line);
        match key {
            "v" => {
                scan.vertex(number, rest)?;
                totals[0] += 1;
            }
            "vt" => {
                scan.texture_coordinate(rest);
                totals[1] += 1;
            }
            "vn" => {
                bad_normals.push(!scan.normal(rest));
                totals[2] += 1;
            }
            _ => {}
        }
    }
    scan.vertices = totals[0];
    Faces {
        scan: &mut scan,
        totals,
        bad_normals,
        seen: [0; 3],
        current: None,
        smoothing: Smoothing::Group(0),
    }
    .read(bytes)?;
    Ok(scan)
}

/// Six numbers on a `v` line are a position and a colour.
fn has_colors(bytes: &[u8]) -> bool {
    Lines::new(bytes).any(|(_, line)| {
        let (key, rest) = keyword(&line);
        key == "v" && words(rest).count() >= 6
    })
}

/// Words up to a comment.
pub(crate) fn words(rest: &str) -> impl Iterator<Item = &str> {
    rest.split_whitespace().take_while(|word| !word.starts_with('#'))
}

/// A `v` line: the position, and all its numbers with their count.
///
/// # Errors
/// One clause that names the line.
pub(crate) fn vertex(number: usize, rest: &str) -> Result<([f32; 3], [f32; 6], usize), String> {
    let wanted = "a vertex needs three finite numbers; mend or export the file again";
    let mut numbers = [0.0f32; 6];
    let mut count = 0;
    for (slot, word) in numbers.iter_mut().zip(words(rest)) {
        *slot =
            finite(word).ok_or_else(|| format!("line {number}: {} is no number; {wanted}", quoted(word)))?;
        count += 1;
    }
    if count < 3 {
        return Err(format!("line {number}: {count} numbers; {wanted}"));
    }
    // A fourth number alone is the weight of a rational curve's point, which divides.
    let weight = if count == 4 { numbers[3] } else { 1.0 };
    let position = [0, 1, 2].map(|i| numbers[i] / weight);
    if !position.iter().all(|x| x.abs() <= MAX_COORDINATE) {
        return Err(format!("line {number}: the position is beyond {MAX_COORDINATE:e}; {wanted}"));
    }
    Ok((position, numbers, count))
}

impl Scan {
    fn vertex(&mut self, number: usize, rest: &str) -> Result<(), String> {
        let (position, numbers, count) = vertex(number, rest)?;
        let [x, y, z] = position;
        // With an exponent tiny numbers stay short.
        let _ = write!(self.text, "v {x:e} {y:e} {z:e}");
        if self.colors {
            let rgb = if count == 6 { [numbers[3], numbers[4], numbers[5]] } else { [1.0; 3] };
            let _ = write!(self.text, " {:e} {:e} {:e}", rgb[0], rgb[1], rgb[2]);
        }
        self.text.push('\n');
        Ok(())
    }

    fn texture_coordinate(&mut self, rest: &str) {
        // A one-dimensional coordinate has no second number; a broken one costs the picture its place, not the shape.
        let mut numbers = words(rest).map(|word| finite(word).unwrap_or(0.0).clamp(-1e6, 1e6));
        let (u, v) = (numbers.next().unwrap_or(0.0), numbers.next().unwrap_or(0.0));
        let _ = writeln!(self.text, "vt {u:e} {v:e}");
    }

    /// Is it one? A normal that is none is computed instead.
    fn normal(&mut self, rest: &str) -> bool {
        let numbers: Vec<f32> = words(rest).take(3).filter_map(finite).collect();
        let length = numbers.iter().map(|x| f64::from(*x).powi(2)).sum::<f64>().sqrt();
        let good = numbers.len() == 3 && length > 1e-30;
        let unit = |i: usize| if good { f64::from(numbers[i]) / length } else { 0.0 };
        let _ = writeln!(self.text, "vn {:e} {:e} {:e}", unit(0) as f32, unit(1) as f32, unit(2) as f32);
        good
    }
}

/// The second pass.
struct Faces<'a> {
    scan: &'a mut Scan,
    totals: Counts,
    bad_normals: Vec<bool>,
    seen: Counts,
    current: Option<usize>,
    smoothing: Smoothing,
}

impl Faces<'_> {
    fn read(mut self, bytes: &[u8]) -> Result<(), String> {
        let mut groups: Vec<String> = Vec::new();
        let mut group_of: HashMap<Run, usize> = HashMap::new();
        let mut material_of: HashMap<String, usize> = HashMap::new();
        let (mut short, mut missing) = (Passed::default(), Passed::default());
        let mut corners = Vec::new();
        for (number, line) in Lines::new(bytes) {
            let (key, rest) = keyword(&line);
            match key {
                "v" => self.seen[0] += 1,
                "vt" => self.seen[1] += 1,
                "vn" => self.seen[2] += 1,
                "s" => self.smoothing = smoothing(rest),
                "usemtl" => {
                    self.current = (!rest.is_empty()).then(|| {
                        *material_of.entry(rest.to_owned()).or_insert_with(|| {
                            self.scan.materials.push(rest.to_owned());
                            self.scan.materials.len() - 1
                        })
                    });
                }
                "mtllib" => self.library(rest),
                "p" | "l" => self.scan.points_and_lines += 1,
                // `fo` is what the first version of the format called a face.
                "f" | "fo" => {
                    let run = self.face(number, rest, &mut corners, &mut missing)?;
                    if corners.len() < 3 {
                        short.count(number);
                        continue;
                    }
                    let group = *group_of.entry(run).or_insert_with(|| {
                        self.scan.runs.push(run);
                        groups.push(format!("g {}\n", groups.len()));
                        groups.len() - 1
                    });
                    write_face(&mut groups[group], &corners, run);
                }
                _ => {}
            }
        }
        self.scan.text.extend(groups);
        short.warn(&mut self.scan.warnings, "faces with fewer than three corners are left out");
        let what = "faces name texture coordinates or normals that do not exist and do without them";
        missing.warn(&mut self.scan.warnings, what);
        Ok(())
    }

    fn library(&mut self, rest: &str) {
        let libraries = &mut self.scan.libraries;
        if !rest.is_empty() && libraries.len() < MAX_LIBRARIES && !libraries.iter().any(|l| l == rest) {
            libraries.push(rest.to_owned());
        }
    }

    /// Reads one face's corners as absolute indices from 1.
    fn face(
        &self,
        number: usize,
        rest: &str,
        corners: &mut Vec<[usize; 3]>,
        missing: &mut Passed,
    ) -> Result<Run, String> {
        corners.clear();
        let (mut uvs, mut normals, mut lacking) = (true, true, false);
        for word in words(rest) {
            let mut corner = [0; 3];
            for (kind, text) in word.split('/').enumerate() {
                if kind > 2 || (text.is_empty() && kind == 0) {
                    return Err(format!("line {number}: the face's corner {} is not v/vt/vn", quoted(word)));
                }
                if text.is_empty() {
                    continue;
                }
                let index: i64 = text.parse().map_err(|_| {
                    format!(
                        "line {number}: the face's corner {} has no whole number for an index",
                        quoted(word)
                    )
                })?;
                match (self.resolve(index, kind), kind) {
                    (Some(found), _) => corner[kind] = found,
                    (None, 0) => return Err(self.out_of_range(number, index)),
                    (None, _) => lacking = true,
                }
            }
            if corner[2] > 0 && self.bad_normals[corner[2] - 1] {
                corner[2] = 0;
            }
            uvs &= corner[1] > 0;
            normals &= corner[2] > 0;
            corners.push(corner);
        }
        if lacking {
            missing.count(number);
        }
        Ok(Run { material: self.current, smoothing: self.smoothing, uvs, normals })
    }

    /// Negative indices count back from the line that they stand on.
    fn resolve(&self, index: i64, kind: usize) -> Option<usize> {
        let absolute = if index < 0 { index.checked_add(self.seen[kind] as i64 + 1)? } else { index };
        usize::try_from(absolute).ok().filter(|i| (1..=self.totals[kind]).contains(i))
    }

    fn out_of_range(&self, number: usize, index: i64) -> String {
        let total = self.totals[0];
        let seen = self.seen[0];
        if index < 0 {
            format!("line {number}: the face counts back to vertex {index}, but {seen} come before it")
        } else {
            format!(
                "line {number}: the face names vertex {index}; they are numbered 1 to {total} in this file"
            )
        }
    }
}

fn smoothing(rest: &str) -> Smoothing {
    match rest {
        "off" | "0" => Smoothing::Flat,
        _ => Smoothing::Group(rest.parse().unwrap_or(1)),
    }
}

fn write_face(text: &mut String, corners: &[[usize; 3]], run: Run) {
    text.push('f');
    for [v, vt, vn] in corners {
        let _ = match (run.uvs, run.normals) {
            (true, true) => write!(text, " {v}/{vt}/{vn}"),
            (true, false) => write!(text, " {v}/{vt}"),
            (false, true) => write!(text, " {v}//{vn}"),
            (false, false) => write!(text, " {v}"),
        };
    }
    text.push('\n');
}

/// Counts what is passed over, and remembers the first line of it.
#[derive(Default)]
struct Passed {
    count: usize,
    first_line: usize,
}

impl Passed {
    fn count(&mut self, number: usize) {
        if self.count == 0 {
            self.first_line = number;
        }
        self.count += 1;
    }

    fn warn(&self, warnings: &mut Vec<String>, what: &str) {
        if self.count > 0 {
            warnings.push(format!("{} {what} (the first on line {})", self.count, self.first_line));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

    #[test]
    fn every_face_ends_up_with_absolute_indices_in_a_group_of_its_kind() {
        let text = format!(
            "{SQUARE}vt 0 0\nvn 0 0 2\nf -4 -3 -2\nusemtl a\ns off\nf 1/1/1 2/1/1 3/1/1\nf 1/1 2 3/1\n"
        );
        let scan = scan(text.as_bytes()).unwrap();
        assert_eq!(scan.materials, ["a"]);
        assert!(
            scan.text.ends_with(
                "vt 0e0 0e0\nvn 0e0 0e0 1e0\ng 0\nf 1 2 3\ng 1\nf 1/1/1 2/1/1 3/1/1\ng 2\nf 1 2 3\n"
            ),
            "{}",
            scan.text
        );
        let flat = |uvs, normals| Run { material: Some(0), smoothing: Smoothing::Flat, uvs, normals };
        assert_eq!(scan.runs[1..], [flat(true, true), flat(false, false)]);
    }

    #[test]
    fn faces_may_name_vertices_that_come_later() {
        assert!(scan(format!("f 1 2 3\n{SQUARE}").as_bytes()).is_ok());
        assert!(
            scan(format!("f -1 2 3\n{SQUARE}").as_bytes()).is_err(),
            "nothing lies before the first line"
        );
    }

    #[test]
    fn errors_name_the_line() {
        for (line, word) in [
            ("f 0 1 2", "vertex 0"),
            ("f 1 2 5", "1 to 4"),
            ("f 1 2 -5", "-5"),
            ("f 1 2 9223372036854775807", "vertex 9223372036854775807"),
            ("f 1 2 -9223372036854775808", "-9223372036854775808"),
            ("f 1 2 99999999999999999999", "whole number"),
            ("f 1/1/1/1 2 3", "v/vt/vn"),
            ("f //1 2 3", "v/vt/vn"),
            ("v 1 2", "2 numbers"),
            ("v 1 nan 2", "nan"),
            ("v 1 1e39 2", "1e39"),
            ("v 1 1e20 2", "1e15"),
            ("v 1 2 3 0", "1e15"),
        ] {
            let message = scan(format!("{SQUARE}{line}\n").as_bytes()).expect_err(line);
            assert!(message.starts_with("line 5: ") && message.contains(word), "{line}: {message}");
        }
    }

    #[test]
    fn points_lines_and_short_faces_are_counted_not_drawn() {
        let scan = scan(format!("{SQUARE}p 1\nl 1 2 3 4\nf 1 2\nf\n").as_bytes()).unwrap();
        assert_eq!((scan.points_and_lines, scan.runs.len(), scan.warnings.len()), (2, 0, 1));
        assert!(scan.warnings[0].starts_with("2 faces") && scan.warnings[0].contains("line 7"));
    }
}
