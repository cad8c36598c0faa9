//! Convex bodies cut by planes: what an eye sees of a box, what a light reaches of that.

use glam::{DVec3, DVec4};

/// A plane of which the inside is where `dot(plane, (p, 1)) >= 0`.
pub(super) type Plane = DVec4;

fn height(plane: &Plane, p: DVec3) -> f64 {
    plane.truncate().dot(p) + plane.w
}

/// A flat polygon's part inside a plane (Sutherland and Hodgman 1974).
fn cut(polygon: &[DVec3], plane: &Plane) -> Vec<DVec3> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (i, &b) in polygon.iter().enumerate() {
        let a = polygon[(i + polygon.len() - 1) % polygon.len()];
        let (ha, hb) = (height(plane, a), height(plane, b));
        if (ha < 0.0) != (hb < 0.0) {
            kept.push(a + (b - a) * (ha / (ha - hb)));
        }
        if hb >= 0.0 {
            kept.push(b);
        }
    }
    kept
}

/// How much of a box is inside of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Held {
    /// It is outside of one plane.
    Nothing,
    /// Some, or, beside an edge, none.
    Part,
    /// It is inside of all planes.
    All,
}

/// A convex body: its faces, and the planes that bound it.
#[derive(Clone, Debug)]
pub(super) struct Convex {
    faces: Vec<Vec<DVec3>>,
    planes: Vec<Plane>,
}

/// Corners of each face of a box whose corner `i` lies at the upper end of x, y, z where bits 0, 1, 2 of `i` are set.
const FACES: [[usize; 4]; 6] =
    [[0, 2, 6, 4], [1, 5, 7, 3], [0, 4, 5, 1], [2, 3, 7, 6], [0, 1, 3, 2], [4, 6, 7, 5]];

impl Convex {
    /// The body with the eight corners of a box or of a cut-off pyramid, in the order of `Aabb::corners`.
    ///
    /// Faces must be flat, and may be of no size: those of a flat box are.
    pub fn from_corners(corners: [DVec3; 8]) -> Self {
        let middle = corners.iter().sum::<DVec3>() / 8.0;
        let faces = FACES.map(|face| face.map(|i| corners[i]).to_vec());
        let planes = faces.iter().filter_map(|face| {
            let normal = (face[2] - face[0]).cross(face[3] - face[1]).try_normalize()?;
            let plane = normal.extend(-normal.dot(0.25 * face.iter().sum::<DVec3>()));
            Some(if height(&plane, middle) < 0.0 { -plane } else { plane })
        });
        Self { planes: planes.collect(), faces: faces.to_vec() }
    }

    /// Cuts off what lies outside a plane and closes the body there.
    pub fn cut(&mut self, plane: Plane) {
        let mut rim = Vec::new();
        for face in &mut self.faces {
            let kept = cut(face, &plane);
            // Corners that the cut made, or went through.
            rim.extend(kept.iter().copied().filter(|p| !face.contains(p) || height(&plane, *p) == 0.0));
            *face = kept;
        }
        self.faces.retain(|face| face.len() > 2);
        if rim.len() > 2 {
            let middle = rim.iter().sum::<DVec3>() / rim.len() as f64;
            let (u, v) = plane.truncate().normalize_or(DVec3::Z).any_orthonormal_pair();
            let turn = |p: &DVec3| (*p - middle).dot(v).atan2((*p - middle).dot(u));
            rim.sort_by(|a, b| turn(a).total_cmp(&turn(b)));
            self.faces.push(rim);
        }
        self.planes.push(plane);
    }

    /// Is nothing left?
    pub fn is_empty(&self) -> bool {
        self.faces.is_empty()
    }

    /// Where a box is, by planes alone. `corners` in the order of `Aabb::corners`.
    pub fn holds(&self, corners: &[DVec3; 8]) -> Held {
        let mut held = Held::All;
        for plane in &self.planes {
            let outside = corners.iter().filter(|p| height(plane, **p) < 0.0).count();
            match outside {
                0 => {}
                8 => return Held::Nothing,
                _ => held = Held::Part,
            }
        }
        held
    }

    /// The corners of what this body and a box have in common: each of them lies on a face of one inside the other.
    /// `corners` are the box's, in the order of `Aabb::corners`.
    pub fn common(&self, corners: [DVec3; 8]) -> Vec<DVec3> {
        match self.holds(&corners) {
            Held::Nothing => return Vec::new(),
            Held::All => return corners.to_vec(),
            Held::Part => {}
        }
        let other = Self::from_corners(corners);
        let mut common: Vec<DVec3> = other.faces.iter().flat_map(|f| within(f, &self.planes)).collect();
        // A flat box has no inside that a face of this body could cross without crossing one of the box's.
        if other.planes.len() == 6 {
            common.extend(self.faces.iter().flat_map(|f| within(f, &other.planes)));
        }
        common
    }

    /// The parts of a box's faces inside this body, each with its unit normal, which points out of the box. Faces of no
    /// size are left out.
    pub fn faces_of(&self, corners: [DVec3; 8]) -> Vec<(DVec3, Vec<DVec3>)> {
        let middle = corners.iter().sum::<DVec3>() / 8.0;
        let faces = FACES.iter().filter_map(|face| {
            let face = face.map(|i| corners[i]);
            let normal = (face[2] - face[0]).cross(face[3] - face[1]).try_normalize()?;
            let normal = if normal.dot(face[0] - middle) < 0.0 { -normal } else { normal };
            let seen = within(&face, &self.planes);
            (seen.len() > 2).then_some((normal, seen))
        });
        faces.collect()
    }
}

/// What several planes leave of a polygon.
fn within(face: &[DVec3], planes: &[Plane]) -> Vec<DVec3> {
    planes.iter().fold(face.to_vec(), |left, plane| if left.is_empty() { left } else { cut(&left, plane) })
}

/// The corners of the smallest convex polygon around points, counter-clockwise (Andrew 1979). Fewer than three when all
/// lie on a line or point.
pub(super) fn hull(points: &[glam::DVec2]) -> Vec<glam::DVec2> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    sorted.dedup();
    if sorted.len() < 3 {
        return sorted;
    }
    let chain = |points: &mut dyn Iterator<Item = glam::DVec2>| {
        let mut chain: Vec<glam::DVec2> = Vec::new();
        for p in points {
            while chain.len() > 1 {
                let (a, b) = (chain[chain.len() - 2], chain[chain.len() - 1]);
                if (b - a).perp_dot(p - b) > 0.0 {
                    break;
                }
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut all = chain(&mut sorted.iter().copied());
    all.extend(chain(&mut sorted.iter().rev().copied()));
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;
    use proptest::prelude::*;

    fn cube(center: DVec3, half: DVec3) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            let sign = |bit: usize| if i & bit == 0 { -1.0 } else { 1.0 };
            center + half * DVec3::new(sign(1), sign(2), sign(4))
        })
    }

    proptest! {
        #[test]
        fn the_common_part_holds_what_lies_in_both(
            at in (-1.5f64..1.5, -1.5f64..1.5, -1.5f64..1.5), half in (0.0f64..1.0, 0.1f64..1.0, 0.1f64..1.0),
            n in (-1.0f64..1.0, -1.0f64..1.0, -1.0f64..1.0), w in -0.8f64..0.8,
            t in prop::collection::vec((0.0f64..1.0, 0.0f64..1.0, 0.0f64..1.0), 64),
            way in (-1.0f64..1.0, -1.0f64..1.0, -1.0f64..1.0),
        ) {
            let mut body = Convex::from_corners(cube(DVec3::ZERO, DVec3::ONE));
            let plane = DVec3::from(n).normalize_or(DVec3::X).extend(w);
            body.cut(plane);
            let half = if half.0 < 0.2 { DVec3::new(0.0, half.1, half.2) } else { DVec3::from(half) };
            let corners = cube(DVec3::from(at), half);
            let common = body.common(corners);
            let along = |p: DVec3| p.dot(DVec3::from(way));
            let most = common.iter().map(|p| along(*p)).fold(f64::NEG_INFINITY, f64::max);
            for p in &common {
                prop_assert!(height(&plane, *p) > -1e-9 && p.abs().max_element() < 1.0 + 1e-9);
                prop_assert!(((*p - DVec3::from(at)).abs() - half).max_element() < 1e-9);
            }
            for t in t {
                let p = corners[0] + (corners[7] - corners[0]) * DVec3::from(t);
                if height(&plane, p) >= 0.0 && p.abs().max_element() <= 1.0 {
                    prop_assert!(along(p) <= most + 1e-9, "{p} of {corners:?}");
                }
            }
        }
    }

    #[test]
    fn a_body_that_is_cut_away_is_empty() {
        let mut body = Convex::from_corners(cube(DVec3::ZERO, DVec3::ONE));
        body.cut(DVec4::new(1.0, 0.0, 0.0, -0.5));
        assert!(!body.is_empty() && body.common(cube(DVec3::NEG_X, DVec3::splat(0.5))).is_empty());
        body.cut(DVec4::new(-1.0, 0.0, 0.0, 0.4));
        assert!(body.is_empty());
    }

    #[test]
    fn hulls() {
        let square = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE, DVec2::splat(0.5), DVec2::X];
        assert_eq!(hull(&square), [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y]);
        assert_eq!(hull(&[DVec2::ONE; 4]).len(), 1);
        assert!(hull(&[DVec2::ZERO, DVec2::ONE, DVec2::splat(2.0)]).len() < 3);
    }
}
