//! How far each pixel is from a place where the truth changes.

use super::CHANGE;
use glam::{UVec2, Vec3};

/// Farther than any picture is wide.
const NOWHERE: f64 = 1e15;

/// The distance from each pixel's centre to the nearest place where V* changes between two neighbours, pixels; infinite where
/// it changes nowhere. The place lies half-way between the two. Pixels that do not `count` have no V*.
pub fn distance_to_change(size: UVec2, truth: &[Vec3], counts: &[bool]) -> Vec<f32> {
    let (width, height) = (size.x as usize, size.y as usize);
    let differs =
        |a: usize, b: usize| counts[a] && counts[b] && (truth[a] - truth[b]).abs().max_element() > CHANGE;
    let mut squares = vec![NOWHERE; width * height];
    let mut mark = |a: usize, b: usize| {
        if differs(a, b) {
            squares[a] = 0.0;
            squares[b] = 0.0;
        }
    };
    for y in 0..height {
        for x in 0..width {
            let at = y * width + x;
            let (right, below) = (x + 1 < width, y + 1 < height);
            if right {
                mark(at, at + 1);
            }
            if below {
                mark(at, at + width);
            }
            if right && below {
                mark(at, at + width + 1);
                mark(at + 1, at + width);
            }
        }
    }
    for y in 0..height {
        lower_envelope(&mut squares, y * width, 1, width);
    }
    for x in 0..width {
        lower_envelope(&mut squares, x, width, height);
    }
    // To the nearest pixel beside a change, and half a pixel more to the change itself.
    squares.into_iter().map(|d| if d < NOWHERE { d.sqrt() as f32 + 0.5 } else { f32::INFINITY }).collect()
}

/// One dimension of the exact distance transform (Felzenszwalb and Huttenlocher 2012, "Distance Transforms of Sampled
/// Functions"): each value becomes the least of all parabolas that stand on the values of its line.
fn lower_envelope(values: &mut [f64], first: usize, step: usize, count: usize) {
    let f: Vec<f64> = (0..count).map(|i| values[first + i * step]).collect();
    // Parabolas of the envelope, and where each begins.
    let mut stands: Vec<usize> = Vec::with_capacity(count);
    let mut begins: Vec<f64> = Vec::with_capacity(count);
    for q in (0..count).filter(|q| f[*q] < NOWHERE) {
        let meets = |p: usize| {
            let (p_f, q_f) = (p as f64, q as f64);
            ((f[q] + q_f * q_f) - (f[p] + p_f * p_f)) / (2.0 * (q_f - p_f))
        };
        let mut begin = f64::NEG_INFINITY;
        while let Some(last) = stands.last() {
            begin = meets(*last);
            if begin > begins[begins.len() - 1] {
                break;
            }
            stands.pop();
            begins.pop();
            begin = f64::NEG_INFINITY;
        }
        stands.push(q);
        begins.push(begin);
    }
    let mut k = 0;
    for i in 0..count {
        while k + 1 < stands.len() && begins[k + 1] < i as f64 {
            k += 1;
        }
        if let Some(stand) = stands.get(k) {
            let across = i as f64 - *stand as f64;
            values[first + i * step] = across * across + f[*stand];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_those_to_the_nearest_change() {
        let size = UVec2::new(13, 9);
        // A pixel and a block that are dark, and one that does not count.
        let dark = |x: u32, y: u32| (x == 3 && y == 2) || (x >= 9 && y >= 6);
        let pixel = |i: u32| (i % size.x, i / size.x);
        let truth: Vec<Vec3> = (0..117)
            .map(pixel)
            .map(|(x, y)| if dark(x, y) || (x, y) == (0, 8) { Vec3::ZERO } else { Vec3::ONE })
            .collect();
        let counts: Vec<bool> = (0..117).map(pixel).map(|p| p != (0, 8)).collect();
        let found = distance_to_change(size, &truth, &counts);
        for (i, found) in found.iter().enumerate() {
            let (x, y) = pixel(i as u32);
            // Every pixel with a neighbour of the other kind.
            let beside = (0..117).map(pixel).filter(|(a, b)| {
                (0..117).map(pixel).any(|(c, d)| {
                    a.abs_diff(c) <= 1
                        && b.abs_diff(d) <= 1
                        && dark(*a, *b) != dark(c, d)
                        && (*a, *b) != (0, 8)
                        && (c, d) != (0, 8)
                })
            });
            let nearest = beside
                .map(|(a, b)| f64::from(a.abs_diff(x)).hypot(f64::from(b.abs_diff(y))))
                .fold(f64::INFINITY, f64::min);
            assert!((f64::from(*found) - nearest - 0.5).abs() < 1e-5, "{x} {y}: {found} {nearest}");
        }
    }

    #[test]
    fn without_a_change_there_is_no_distance() {
        let found = distance_to_change(UVec2::new(4, 3), &[Vec3::ONE; 12], &[true; 12]);
        assert!(found.iter().all(|d| *d == f32::INFINITY));
    }
}
