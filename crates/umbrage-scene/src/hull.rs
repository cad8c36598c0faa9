//! The convex hull of points, for fits that need no more of an object than how far it reaches.
//!
//! Quickhull (Barber, Dobkin and Huhdanpaa 1996, "The Quickhull Algorithm for Convex Hulls"). The crates that have one bring a
//! second version of glam with them or panic on flat input; what is needed here is short, because it may give up.

use glam::{DVec3, Vec3};
use std::collections::HashMap;

/// Points are moved by up to this share of their box first, so that no four lie on a plane and no three on a line, as they do
/// in most made things: what single precision leaves open anyhow. In double precision the hull of those is exact.
const MOVED: f64 = 1e-7;
/// What lies closer to a face counts as on it, in lengths of the box's edges.
const ON_FACE: f64 = 1e-13;
/// Points may stick out of the finished hull by this at most, in the same lengths.
const MOST_OUT: f64 = 1e-9;
/// No more points times faces are checked, about a second's work. Where there are more, nearly all points are corners anyhow.
const MOST_CHECKS: usize = 400_000_000;

/// Points whose convex hull holds all of `points`, to a millionth of their box: the corners of their own hull where that can
/// be found, else all of them, each once. What is not finite is passed over.
///
/// Cost: points times the logarithm of their number; a check of all points against all faces comes after that.
pub(crate) fn hull_points(points: impl Iterator<Item = Vec3>) -> Vec<Vec3> {
    // Adding zero makes -0 and 0 the same bits.
    let mut unique: Vec<[u32; 3]> =
        points.filter(|p| p.is_finite()).map(|p| (p + 0.0).to_array().map(f32::to_bits)).collect();
    unique.sort_unstable();
    unique.dedup();
    let unique: Vec<Vec3> = unique.into_iter().map(|bits| Vec3::from(bits.map(f32::from_bits))).collect();
    let (low, high) =
        unique.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(l, h), p| (l.min(*p), h.max(*p)));
    let (low, size) = (low.as_dvec3(), high.as_dvec3() - low.as_dvec3());
    if unique.len() < 5 || size.min_element() <= 0.0 {
        return unique;
    }
    // A hull stays one under any affine map. In the unit cube all axes have the same rounding.
    let placed = |(i, p): (usize, &Vec3)| (p.as_dvec3() - low) / size + MOVED * aside(i);
    let placed: Vec<DVec3> = unique.iter().enumerate().map(placed).collect();
    match Hull::new(&placed).filter(|hull| hull.holds(&placed)) {
        Some(hull) => hull.corners().into_iter().map(|i| unique[i]).collect(),
        None => unique,
    }
}

/// -1 to 1 along each axis, another for each number. No sequence with a lattice of its own will do: grids would keep their lines.
fn aside(number: usize) -> DVec3 {
    let mut state = number as u64;
    let mut next = || {
        // SplitMix64 (Steele, Lea and Flood 2014, "Fast Splittable Pseudorandom Number Generators").
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    DVec3::new(next(), next(), next())
}

/// A triangle of the hull, counter-clockwise seen from outside.
struct Face {
    corners: [usize; 3],
    /// The face across the edge that begins at each corner.
    across: [usize; 3],
    /// Unit length, outwards.
    normal: DVec3,
    offset: f64,
    /// Points over it that are not yet in the hull.
    above: Vec<usize>,
    alive: bool,
}

struct Hull<'a> {
    points: &'a [DVec3],
    faces: Vec<Face>,
}

impl<'a> Hull<'a> {
    /// `None` for points on a plane, and where rounding tangles the faces.
    fn new(points: &'a [DVec3]) -> Option<Self> {
        let mut hull = Self { points, faces: Vec::new() };
        let [a, b, c, d] = first_four(points)?;
        for (corners, across) in
            [([a, b, c], [1, 2, 3]), ([b, a, d], [0, 3, 2]), ([c, b, d], [0, 1, 3]), ([a, c, d], [0, 2, 1])]
        {
            hull.add(corners, across)?;
        }
        let all: Vec<usize> = (0..points.len()).collect();
        hull.share_out(&all, 0);
        let mut next = 0;
        while next < hull.faces.len() {
            match hull.faces[next].above.first() {
                Some(_) if hull.faces[next].alive => hull.grow(next)?,
                _ => next += 1,
            }
        }
        Some(hull)
    }

    fn height(&self, face: usize, p: usize) -> f64 {
        self.faces[face].normal.dot(self.points[p]) - self.faces[face].offset
    }

    fn add(&mut self, corners: [usize; 3], across: [usize; 3]) -> Option<()> {
        let [a, b, c] = corners.map(|i| self.points[i]);
        let normal = (b - a).cross(c - a).try_normalize()?;
        let offset = normal.dot((a + b + c) / 3.0);
        self.faces.push(Face { corners, across, normal, offset, above: Vec::new(), alive: true });
        Some(())
    }

    /// Gives points to the face, of those from `first` on, that they are farthest above. The others are inside.
    fn share_out(&mut self, points: &[usize], first: usize) {
        for &p in points {
            let heights = (first..self.faces.len()).map(|face| (face, self.height(face, p)));
            let farthest = heights.max_by(|a, b| a.1.total_cmp(&b.1));
            if let Some((face, _)) = farthest.filter(|(_, height)| *height > ON_FACE) {
                self.faces[face].above.push(p);
            }
        }
    }

    /// Takes in the farthest point above a face.
    fn grow(&mut self, face: usize) -> Option<()> {
        let above = self.faces[face].above.iter().copied();
        let p = above.max_by(|a, b| self.height(face, *a).total_cmp(&self.height(face, *b)))?;
        // All faces that the point sees, from this one outwards, and the edges behind which they end.
        let (mut open, mut rim, mut free) = (vec![face], Vec::new(), Vec::new());
        self.faces[face].alive = false;
        while let Some(seen) = open.pop() {
            free.append(&mut self.faces[seen].above);
            let Face { corners, across, .. } = self.faces[seen];
            for (i, neighbour) in across.into_iter().enumerate() {
                if !self.faces[neighbour].alive {
                    continue;
                }
                if self.height(neighbour, p) > ON_FACE {
                    self.faces[neighbour].alive = false;
                    open.push(neighbour);
                } else {
                    rim.push((corners[i], corners[(i + 1) % 3], neighbour));
                }
            }
        }
        let first = self.faces.len();
        let from: HashMap<usize, usize> =
            rim.iter().zip(first..).map(|((a, _, _), face)| (*a, face)).collect();
        let to: HashMap<usize, usize> = rim.iter().zip(first..).map(|((_, b, _), face)| (*b, face)).collect();
        if from.len() != rim.len() || to.len() != rim.len() || rim.len() < 3 {
            return None;
        }
        for (number, (a, b, neighbour)) in rim.into_iter().enumerate() {
            self.add([a, b, p], [neighbour, *from.get(&b)?, *to.get(&a)?])?;
            let other = &mut self.faces[neighbour];
            let edge = (0..3).find(|i| other.corners[*i] == b && other.corners[(*i + 1) % 3] == a)?;
            other.across[edge] = first + number;
        }
        free.retain(|other| *other != p);
        self.share_out(&free, first);
        Some(())
    }

    fn holds(&self, points: &[DVec3]) -> bool {
        let faces = || self.faces.iter().filter(|face| face.alive);
        faces().count().saturating_mul(points.len()) <= MOST_CHECKS
            && points.iter().all(|p| faces().all(|face| face.normal.dot(*p) - face.offset <= MOST_OUT))
    }

    fn corners(&self) -> Vec<usize> {
        let mut corners: Vec<usize> =
            self.faces.iter().filter(|face| face.alive).flat_map(|face| face.corners).collect();
        corners.sort_unstable();
        corners.dedup();
        corners
    }
}

/// Four points that span a volume, the fourth below the first three.
fn first_four(points: &[DVec3]) -> Option<[usize; 4]> {
    let farthest = |from: &dyn Fn(DVec3) -> f64| {
        (0..points.len()).max_by(|a, b| from(points[*a]).total_cmp(&from(points[*b])))
    };
    let a = farthest(&|p| -p.x)?;
    let b = farthest(&|p| p.distance_squared(points[a]))?;
    let along = (points[b] - points[a]).try_normalize()?;
    let c = farthest(&|p| (p - points[a]).cross(along).length_squared())?;
    let normal = (points[b] - points[a]).cross(points[c] - points[a]).try_normalize()?;
    let d = farthest(&|p| normal.dot(p - points[a]).abs())?;
    let height = normal.dot(points[d] - points[a]);
    if height.abs() <= 1e-4 {
        return None;
    }
    Some(if height < 0.0 { [a, b, c, d] } else { [b, a, c, d] })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// How far points stick out of the hull of `corners`, in the directions of a ball.
    fn sticks_out(points: &[Vec3], corners: &[Vec3]) -> f64 {
        let reach =
            |of: &[Vec3], way: DVec3| of.iter().map(|p| p.as_dvec3().dot(way)).fold(f64::MIN, f64::max);
        let ways = (0..400).map(|i| {
            let (z, turn) = (1.0 - (2 * i + 1) as f64 / 400.0, 2.399_963_2 * i as f64);
            DVec3::new((1.0 - z * z).sqrt() * turn.cos(), (1.0 - z * z).sqrt() * turn.sin(), z)
        });
        ways.map(|way| reach(points, way) - reach(corners, way)).fold(0.0, f64::max)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(300))]

        #[test]
        fn the_hull_holds_all_points(
            points in prop::collection::vec((-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0), 0..120),
            steps in 1u32..20, flat in 0u8..4, squeeze in -6i32..3,
        ) {
            // On a coarse grid most points lie on common planes, lines and places.
            let snap = |x: f32| if flat > 0 { (x * steps as f32).round() / steps as f32 } else { x };
            let tilt = glam::Quat::from_rotation_x(0.3 * f32::from(flat));
            let scale = Vec3::new(1.0, 10f32.powi(squeeze), 1.0);
            let points: Vec<Vec3> = points.iter().map(|(x, y, z)| tilt * Vec3::new(snap(*x), snap(*y), snap(*z)) * scale).collect();
            let corners = hull_points(points.iter().copied());
            prop_assert!(corners.iter().all(|c| points.contains(c)));
            let reach = points.iter().map(|p| p.length()).fold(0.0, f32::max);
            prop_assert!(points.is_empty() || sticks_out(&points, &corners) <= 2e-6 * f64::from(reach));
        }
    }

    #[test]
    fn inner_points_are_left_out_and_a_missing_corner_is_seen() {
        let grid = |n: i32| {
            (-n..=n).flat_map(move |x| {
                (-n..=n).flat_map(move |y| (-n..=n).map(move |z| Vec3::new(x as f32, y as f32, z as f32)))
            })
        };
        let corners = hull_points(grid(6));
        // Of points on a face of the grid some may count as corners, but none from within.
        assert!(corners.len() < 200 && corners.iter().all(|p| p.abs().max_element() == 6.0), "{corners:?}");
        let tip = Vec3::splat(6.0);
        let others: Vec<Vec3> = corners.iter().copied().filter(|p| *p != tip).collect();
        assert!(others.len() < corners.len() && sticks_out(&grid(6).collect::<Vec<_>>(), &others) > 0.1);
        for name in ["builtin:torus", "builtin:knots"] {
            let scene = crate::load(name).expect("a built-in");
            for mesh in &scene.meshes {
                let corners = hull_points(mesh.positions.iter().copied());
                assert!(sticks_out(&mesh.positions, &corners) <= 2e-6 * f64::from(mesh.bounds.radius()));
            }
        }
    }

    #[test]
    fn what_has_no_hull_is_handed_back() {
        let flat = [
            Vec3::ZERO,
            Vec3::X,
            Vec3::Y,
            Vec3::X + Vec3::Y,
            Vec3::splat(0.25) * Vec3::new(1.0, 1.0, 0.0),
            Vec3::X,
        ];
        assert_eq!(hull_points(flat.into_iter()).len(), 5);
        assert_eq!(hull_points([Vec3::NAN, Vec3::ONE, Vec3::ONE].into_iter()), [Vec3::ONE]);
        assert!(hull_points(std::iter::empty()).is_empty());
        let line = (0..50).map(|i| Vec3::splat(i as f32));
        assert_eq!(hull_points(line).len(), 50);
        let huge = flat.map(|p| p * 3e38).into_iter().chain([Vec3::Z * -3e38]);
        assert!([5, 6].contains(&hull_points(huge).len()), "a pyramid, and a point of its base");
    }
}
