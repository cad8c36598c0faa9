//! Vertices at one place are one vertex.

use glam::Vec3;
use std::collections::HashMap;

/// For each vertex the first one at its place: the same bits, but -0 is 0.
///
/// Cost: one look into a hash table for each vertex.
pub fn weld(positions: &[Vec3]) -> Vec<u32> {
    let mut first_at: HashMap<[u32; 3], u32> = HashMap::with_capacity(positions.len());
    // Adding zero makes -0 and 0 the same bits. No index names a vertex that 32 bits do not count.
    (0..=u32::MAX)
        .zip(positions)
        .map(|(i, p)| *first_at.entry((*p + 0.0).to_array().map(f32::to_bits)).or_insert(i))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn minus_zero_is_zero_and_the_first_stands_for_all() {
        let places = [Vec3::X, Vec3::ZERO, Vec3::new(-0.0, 0.0, -0.0), Vec3::X, Vec3::splat(f32::NAN)];
        assert_eq!(weld(&places), [0, 1, 1, 0, 4]);
        assert!(weld(&[]).is_empty());
    }
}
