//! Polygons to triangles: any number of corners, convex or not, wound as the polygon is.

use earcut::Earcut;
use glam::{DVec2, DVec3, Vec3};

/// Above this many corners a polygon is cut as a fan. Ear cutting is quick on honest outlines of any size but may take
/// a time that grows with the cube on a scribble, and a file must not be able to stop the program.
const MAX_EAR_CORNERS: usize = 6000;

/// Keeps its buffers from polygon to polygon.
pub(super) struct Cutter {
    earcut: Earcut<f64>,
    flat: Vec<[f64; 2]>,
    ears: Vec<u32>,
}

impl Cutter {
    pub(super) fn new() -> Self {
        Self { earcut: Earcut::new(), flat: Vec::new(), ears: Vec::new() }
    }

    /// Adds triangles, as numbers of corners, to `triangles`. Returns false when the polygon was too large to be
    /// cut with care.
    pub(super) fn cut(&mut self, corners: &[Vec3], triangles: &mut Vec<[u32; 3]>) -> bool {
        match corners.len() {
            0..3 => true,
            3 => {
                triangles.push([0, 1, 2]);
                true
            }
            4 => {
                triangles.extend(cut_quad(corners));
                true
            }
            n if n > MAX_EAR_CORNERS => {
                fan(n, triangles);
                false
            }
            n => {
                if !self.cut_ears(corners, triangles) {
                    fan(n, triangles);
                }
                true
            }
        }
    }

    fn cut_ears(&mut self, corners: &[Vec3], triangles: &mut Vec<[u32; 3]>) -> bool {
        let Some(normal) = newell(corners).try_normalize() else { return false };
        let (right, up) = normal.any_orthonormal_pair();
        let origin = corners[0].as_dvec3();
        self.flat.clear();
        self.flat.extend(corners.iter().map(|p| {
            let p = p.as_dvec3() - origin;
            [p.dot(right), p.dot(up)]
        }));
        self.earcut.earcut_slice::<u32>(&self.flat, &[], &mut self.ears);
        let at = |i: u32| DVec2::from(self.flat[i as usize]);
        triangles.extend(self.ears.chunks_exact(3).map(|t| {
            let turned = (at(t[1]) - at(t[0])).perp_dot(at(t[2]) - at(t[0])) < 0.0;
            if turned { [t[0], t[2], t[1]] } else { [t[0], t[1], t[2]] }
        }));
        if self.ears.is_empty() {
            return false;
        }
        if self.ears.len() / 3 < corners.len() - 2 {
            bridge(&self.ears, corners.len() as u32, triangles);
        }
        true
    }
}

/// Twice the polygon's area along its normal, whatever its shape (Newell's sum).
pub(crate) fn newell(corners: &[Vec3]) -> DVec3 {
    let Some(origin) = corners.first().map(|p| p.as_dvec3()) else { return DVec3::ZERO };
    corners.windows(2).map(|w| (w[0].as_dvec3() - origin).cross(w[1].as_dvec3() - origin)).sum()
}

/// Ear cutting leaves out corners that lie on their neighbours' line or repeat one. The faces next door still have them
/// (and their own normals may stand there), so thin triangles close the seam from kept corner to kept corner.
fn bridge(ears: &[u32], corners: u32, triangles: &mut Vec<[u32; 3]>) {
    let mut kept = vec![false; corners as usize];
    for i in ears {
        kept[*i as usize] = true;
    }
    let Some(start) = kept.iter().position(|k| *k) else { return };
    let start = start as u32;
    let mut anchor = start;
    for step in 1..=corners {
        let here = (start + step) % corners;
        let before = (start + step - 1) % corners;
        if before != anchor {
            triangles.push([anchor, before, here]);
        }
        if kept[here as usize] {
            anchor = here;
        }
    }
}

/// Along the diagonal whose triangles look the same way: the other one leaves a concave quad.
fn cut_quad(p: &[Vec3]) -> [[u32; 3]; 2] {
    let side = |a: usize, b: usize, c: usize| newell(&[p[a], p[b], p[c]]);
    let normal = newell(p);
    let worst = |x: DVec3, y: DVec3| x.dot(normal).min(y.dot(normal));
    let first = worst(side(0, 1, 2), side(0, 2, 3));
    let second = worst(side(1, 2, 3), side(1, 3, 0));
    if first >= 0.0 || first >= second { [[0, 1, 2], [0, 2, 3]] } else { [[1, 2, 3], [1, 3, 0]] }
}

fn fan(corners: usize, triangles: &mut Vec<[u32; 3]>) {
    triangles.extend((2..corners as u32).map(|i| [0, i - 1, i]));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn areas(corners: &[Vec3]) -> (f64, f64, usize) {
        let mut triangles = Vec::new();
        Cutter::new().cut(corners, &mut triangles);
        let normal = newell(corners).normalize();
        let of = |t: &[u32; 3]| newell(&t.map(|i| corners[i as usize]));
        // The signed sum always is the polygon's; only without overlap and turned triangles is the unsigned one too.
        let unsigned = triangles.iter().map(|t| of(t).length()).sum::<f64>();
        let signed = triangles.iter().map(|t| of(t).dot(normal)).sum::<f64>();
        assert!((signed - unsigned).abs() <= 1e-5 * unsigned, "{signed} {unsigned}");
        (unsigned, newell(corners).length(), triangles.len())
    }

    /// A star with `n` tips, tilted, so that no coordinate plane sees it straight.
    fn star(n: usize, inner: f32) -> Vec<Vec3> {
        let turn = glam::Quat::from_rotation_x(0.7) * glam::Quat::from_rotation_y(0.4);
        (0..2 * n)
            .map(|i| {
                let radius = if i % 2 == 0 { 1.0 } else { inner };
                let angle = std::f32::consts::PI * i as f32 / n as f32;
                turn * Vec3::new(radius * angle.cos(), radius * angle.sin(), 0.0) + Vec3::new(3.0, -2.0, 9.0)
            })
            .collect()
    }

    #[test]
    fn triangles_cover_exactly_the_polygon() {
        for n in [3, 5, 40, 1500] {
            let (covered, area, triangles) = areas(&star(n, 0.3));
            assert!((covered - area).abs() < 1e-5 * area, "{n}: {covered} {area}");
            assert_eq!(triangles, 2 * n - 2);
        }
    }

    #[test]
    fn each_corner_of_a_quad_may_be_the_concave_one() {
        let arrow =
            [Vec3::ZERO, Vec3::new(2.0, -1.0, 0.0), Vec3::new(0.5, 0.0, 0.0), Vec3::new(2.0, 1.0, 0.0)];
        for turn in 0..4 {
            for mirrored in [false, true] {
                let mut corners: Vec<Vec3> = (0..4).map(|i| arrow[(i + turn) % 4]).collect();
                if mirrored {
                    corners.reverse();
                }
                let (covered, area, _) = areas(&corners);
                assert!((covered - area).abs() < 1e-6, "{turn} {mirrored}: {covered} {area}");
            }
        }
    }

    /// Negative control: a fan over the star is what the area test is there to refuse.
    #[test]
    fn a_fan_would_fail_the_area_test() {
        let corners = star(5, 0.3);
        let mut triangles = Vec::new();
        fan(corners.len(), &mut triangles);
        let covered: f64 =
            triangles.iter().map(|t| newell(&t.map(|i: u32| corners[i as usize])).length()).sum();
        assert!(covered > 1.01 * newell(&corners).length());
    }

    /// Corners that repeat or lie on a line: each edge of the outline must still be an edge of one triangle.
    #[test]
    fn no_edge_of_the_outline_is_lost() {
        let xy = [
            (0.0, 0.0),
            (1.0, 0.0),
            (1.0, 0.0),
            (2.0, 0.0),
            (2.0, 2.0),
            (1.0, 2.0),
            (1.0, 3.0),
            (1.0, 2.0),
            (0.0, 2.0),
        ];
        let corners = xy.map(|(x, y)| Vec3::new(x, y, 0.0));
        for turn in 0..corners.len() {
            let mut turned = corners;
            turned.rotate_left(turn);
            let mut triangles = Vec::new();
            Cutter::new().cut(&turned, &mut triangles);
            assert_eq!(triangles.len(), corners.len() - 2, "{turn}: {triangles:?}");
            let n = corners.len() as u32;
            for a in 0..n {
                let b = (a + 1) % n;
                let users =
                    triangles.iter().filter(|t| (0..3).any(|i| (t[i], t[(i + 1) % 3]) == (a, b))).count();
                assert_eq!(users, 1, "{turn}: edge {a} {b} in {triangles:?}");
            }
        }
    }

    #[test]
    fn scribbles_end_in_time() {
        let mut state = 1u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / 16_777_216.0
        };
        for n in [100, 1000, MAX_EAR_CORNERS, MAX_EAR_CORNERS + 1] {
            let corners: Vec<Vec3> = (0..n).map(|_| Vec3::new(random(), random(), 0.0)).collect();
            let mut triangles = Vec::new();
            let started = std::time::Instant::now();
            Cutter::new().cut(&corners, &mut triangles);
            eprintln!("scribble of {n}: {:?}, {} triangles", started.elapsed(), triangles.len());
            assert!(triangles.len() <= n - 2);
        }
        assert!(
            Cutter::new().cut(&[Vec3::ONE; 9], &mut Vec::new()),
            "a polygon of one point is no reason to stop"
        );
    }
}
