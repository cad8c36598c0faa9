//! What moves in a picture though nothing of it should.

use super::{CHANGE, grey};
use crate::Surfaces;
use glam::{DVec3, Vec3};

/// One picture of a camera's path.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// What is seen.
    pub surfaces: &'a Surfaces,
    /// V*.
    pub truth: &'a [Vec3],
    /// The technique's answer.
    pub v: &'a [Vec3],
    /// Pixels that are judged.
    pub receivers: &'a [bool],
}

/// Mean change of V from each frame to the next, over the places of the scene that both see and for which V* is the same
/// in both; fractions of 1. `None` when there is no such place, as with less than two frames.
///
/// Each pixel's place is looked for in the next frame, and V there is blended from the four pixels around it; all four
/// must show the same surface and the same V*.
pub fn flicker(frames: &[Frame<'_>]) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0u64);
    for pair in frames.windows(2) {
        let [from, to] = pair else { continue };
        for (pixel, seen) in from.surfaces.seen.iter().enumerate() {
            let Some(seen) = seen.filter(|_| from.receivers[pixel]) else { continue };
            let Some(v) = v_at(to, seen.p_world, seen.normal_world, from.truth[pixel]) else { continue };
            sum += f64::from((grey(from.v[pixel]) - v).abs());
            count += 1;
        }
    }
    (count > 0).then(|| sum / count as f64)
}

/// V at a place of the scene, where `truth` is what it was.
fn v_at(frame: &Frame<'_>, p_world: DVec3, normal_world: Vec3, truth: Vec3) -> Option<f32> {
    let surfaces = frame.surfaces;
    let (x, y) = surfaces.pixel_of(p_world)?;
    let (x, y) = (x - 0.5, y - 0.5);
    let (left, top) = (x.floor(), y.floor());
    let inside = left >= 0.0
        && top >= 0.0
        && left + 1.0 < f64::from(surfaces.size.x)
        && top + 1.0 < f64::from(surfaces.size.y);
    if !inside {
        return None;
    }
    let (share_x, share_y) = ((x - left) as f32, (y - top) as f32);
    let mut v = 0.0;
    for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        let pixel = (top as usize + dy) * surfaces.size.x as usize + left as usize + dx;
        let seen = surfaces.seen[pixel].filter(|_| frame.receivers[pixel])?;
        // On the same plane, up to a pixel's width.
        let off_m = (seen.p_world - p_world).dot(normal_world.as_dvec3()).abs();
        let same = off_m < surfaces.pixel_m(&seen) && seen.normal_world.dot(normal_world) > 0.9;
        if !same || (frame.truth[pixel] - truth).abs().max_element() > CHANGE {
            return None;
        }
        let weight = |far: usize, share: f32| if far == 1 { share } else { 1.0 - share };
        v += grey(frame.v[pixel]) * weight(dx, share_x) * weight(dy, share_y);
    }
    Some(v)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Seen;
    use glam::UVec2;
    use umbrage_core::{Camera, Projection};

    const SIZE: UVec2 = UVec2::new(24, 16);

    /// The plane z = 0 from straight in front, a pixel a metre, moved to the right by `x`.
    fn looking_at_a_wall(x: f32) -> Surfaces {
        let camera = Camera {
            projection: Projection::Orthographic { half_height_m: 8.0 },
            ..Camera::look_at(Vec3::new(x, 0.0, 5.0), Vec3::new(x, 0.0, 0.0), 1.0, 0.1, 9.0)
        };
        let seen = (0..SIZE.x * SIZE.y).map(|i| {
            let p = glam::DVec2::new(f64::from(i % SIZE.x) - 11.5, 7.5 - f64::from(i / SIZE.x));
            let p_world = DVec3::new(p.x + f64::from(x), p.y, 0.0);
            Some(Seen { p_world, normal_world: Vec3::Z, slot: 0 })
        });
        Surfaces { size: SIZE, seen: seen.collect(), camera, rays: 0 }
    }

    /// A value for each metre of the wall.
    fn painted(surfaces: &Surfaces, of: impl Fn(f64) -> f32) -> Vec<Vec3> {
        surfaces.seen.iter().flatten().map(|seen| Vec3::splat(of(seen.p_world.x))).collect()
    }

    #[test]
    fn only_what_changes_on_the_wall_is_flicker() {
        let (here, there) = (looking_at_a_wall(0.0), looking_at_a_wall(3.0));
        let edge = |x: f64| if x < 2.0 { 1.0 } else { 0.0 };
        let all = vec![true; (SIZE.x * SIZE.y) as usize];
        let (truth_here, truth_there) = (painted(&here, edge), painted(&there, edge));
        let measured = |v_here: &[Vec3], v_there: &[Vec3]| {
            flicker(&[
                Frame { surfaces: &here, truth: &truth_here, v: v_here, receivers: &all },
                Frame { surfaces: &there, truth: &truth_there, v: v_there, receivers: &all },
            ])
        };
        assert_eq!(measured(&truth_here, &truth_there), Some(0.0));
        // Wrong, but the same wrong: no flicker.
        let wrong = |x: f64| edge(x + 4.0);
        assert_eq!(measured(&painted(&here, wrong), &painted(&there, wrong)), Some(0.0));
        // A tenth less everywhere in the second frame.
        let darker: Vec<Vec3> = truth_there.iter().map(|v| *v - 0.1).collect();
        let change = measured(&truth_here, &darker).expect("places that both see");
        assert!((change - 0.1).abs() < 1e-6, "{change}");
        assert_eq!(flicker(&[]), None);
    }

    #[test]
    fn where_the_truth_changes_nothing_is_said() {
        let (here, there) = (looking_at_a_wall(0.0), looking_at_a_wall(1.0));
        let all = vec![true; (SIZE.x * SIZE.y) as usize];
        let lit = painted(&here, |_| 1.0);
        let dark = painted(&there, |_| 0.0);
        let frames = [
            Frame { surfaces: &here, truth: &lit, v: &lit, receivers: &all },
            Frame { surfaces: &there, truth: &dark, v: &dark, receivers: &all },
        ];
        assert_eq!(flicker(&frames), None);
    }
}
