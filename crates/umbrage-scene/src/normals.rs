//! Normals for files that have none.

use crate::obj::newell;
use glam::{DVec3, Vec3};
use std::collections::HashMap;

/// Faces that meet at a sharper angle than this keep their edge: a cylinder's side stays round, its rim stays sharp.
const CREASE_RAD: f64 = std::f64::consts::PI / 3.0;

/// With more faces than this at one point they are compared with a few of them, not each with each.
const CROWD: usize = 64;

/// Bits of the position, and the smoothing group.
type Place = ([u32; 3], u32);

/// A normal for each corner, from the faces that share its place and smoothing group, weighted by their angle there.
///
/// `corners` holds the positions of all faces one after the other, `arities` how many each has, `groups` which faces
/// are smooth with each other (`None`: with no other).
pub(crate) fn smooth(corners: &[Vec3], arities: &[u32], groups: &[Option<u32>]) -> Vec<Vec3> {
    let mut faces = Vec::with_capacity(arities.len());
    // Corners by place and group; each is (face, corner, angle).
    let mut places: HashMap<Place, Vec<(usize, usize, f64)>> = HashMap::new();
    let mut normals = vec![Vec3::ZERO; corners.len()];
    let mut start = 0;
    for (face, (&arity, group)) in arities.iter().zip(groups).enumerate() {
        let points = &corners[start..start + arity as usize];
        let normal = newell(points).try_normalize().unwrap_or(DVec3::ZERO);
        faces.push(normal);
        for i in 0..points.len() {
            match group {
                Some(group) => {
                    let place = (points[i] + Vec3::ZERO).to_array().map(f32::to_bits);
                    places.entry((place, *group)).or_default().push((face, start + i, angle_at(points, i)));
                }
                None => normals[start + i] = unit(normal),
            }
        }
        start += arity as usize;
    }
    for meeting in places.into_values() {
        if meeting.len() <= CROWD {
            smooth_few(&meeting, &faces, &mut normals);
        } else {
            smooth_many(&meeting, &faces, &mut normals);
        }
    }
    normals
}

fn smooth_few(meeting: &[(usize, usize, f64)], faces: &[DVec3], normals: &mut [Vec3]) {
    let limit = CREASE_RAD.cos();
    for &(face, corner, _) in meeting {
        let own = faces[face];
        let sum: DVec3 =
            meeting.iter().filter(|m| faces[m.0].dot(own) >= limit).map(|m| faces[m.0] * m.2).sum();
        normals[corner] = sum.try_normalize().map_or_else(|| unit(own), |n| n.as_vec3());
    }
}

/// Each face joins the first bundle whose first face it is smooth with. No more than some twenty bundles fit on a sphere.
fn smooth_many(meeting: &[(usize, usize, f64)], faces: &[DVec3], normals: &mut [Vec3]) {
    let limit = CREASE_RAD.cos();
    let mut bundles: Vec<(DVec3, DVec3)> = Vec::new();
    let member: Vec<usize> = meeting
        .iter()
        .map(|&(face, _, angle)| {
            let normal = faces[face];
            let bundle = bundles.iter().position(|b| b.0.dot(normal) >= limit || b.0 == normal);
            let bundle = bundle.unwrap_or_else(|| {
                bundles.push((normal, DVec3::ZERO));
                bundles.len() - 1
            });
            bundles[bundle].1 += normal * angle;
            bundle
        })
        .collect();
    for (&(face, corner, _), bundle) in meeting.iter().zip(member) {
        normals[corner] =
            bundles[bundle].1.try_normalize().map_or_else(|| unit(faces[face]), |n| n.as_vec3());
    }
}

fn angle_at(points: &[Vec3], i: usize) -> f64 {
    let n = points.len();
    let here = points[i].as_dvec3();
    let before = points[(i + n - 1) % n].as_dvec3() - here;
    let after = points[(i + 1) % n].as_dvec3() - here;
    // A corner without an angle still is a part of its face.
    let angle = before.angle_between(after);
    if angle.is_nan() { 1e-4 } else { angle.max(1e-4) }
}

/// A face without area has no normal; any unit vector does for what is not seen.
fn unit(normal: DVec3) -> Vec3 {
    normal.try_normalize().map_or(Vec3::Y, |n| n.as_vec3())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two squares that meet along Z at `angle` degrees between their normals.
    fn hinge(angle: f32) -> Vec<Vec3> {
        let (sin, cos) = angle.to_radians().sin_cos();
        let down = Vec3::new(cos, -sin, 0.0);
        let z = Vec3::Z;
        vec![-Vec3::X, -Vec3::X + z, z, Vec3::ZERO, Vec3::ZERO, z, down + z, down]
    }

    #[test]
    fn blunt_edges_are_smooth_and_sharp_ones_stay() {
        for (angle, smoothed) in [(10.0, true), (55.0, true), (65.0, false), (120.0, false)] {
            let normals = smooth(&hinge(angle), &[4, 4], &[Some(0), Some(0)]);
            assert_eq!(normals[2].distance(normals[5]) < 1e-5, smoothed, "{angle}");
            assert!(normals[0].distance(Vec3::Y) < 1e-6, "corners away from the edge keep the face's normal");
        }
    }

    #[test]
    fn groups_and_off_are_honoured() {
        for groups in [[Some(1), Some(2)], [None, None], [None, Some(0)]] {
            let normals = smooth(&hinge(20.0), &[4, 4], &groups);
            assert!(normals[2].distance(normals[5]) > 0.3, "{groups:?}");
        }
    }

    #[test]
    fn a_crowd_at_one_point_is_smooth_too_and_quick() {
        let count = 100_000;
        let rim = |i: usize| {
            let angle = std::f32::consts::TAU * i as f32 / count as f32;
            Vec3::new(angle.cos(), 0.0, -angle.sin())
        };
        let tip = Vec3::Y * 0.3;
        let corners: Vec<Vec3> = (0..count).flat_map(|i| [tip, rim(i), rim(i + 1)]).collect();
        let normals = smooth(&corners, &vec![3; count], &vec![Some(0); count]);
        assert!(normals[0].distance(Vec3::Y) < 1e-3, "{}", normals[0]);
        assert!(normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-5));
    }

    #[test]
    fn faces_without_area_get_a_unit_normal() {
        let normals = smooth(&[Vec3::ONE; 6], &[3, 3], &[Some(0), None]);
        assert!(normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-6));
    }
}
