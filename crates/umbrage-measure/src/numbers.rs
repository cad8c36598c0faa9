//! Numbers for programs: short, finite, and the middle of many.

use serde_json::{Map, Value};
use umbrage_render::umbrage::core::technique::Settings;

/// The shortest decimal that means the same number; never infinite, which JSON cannot say.
pub fn decimal(x: f32) -> f64 {
    let x = if x.is_nan() { 0.0 } else { x.clamp(f32::MIN, f32::MAX) };
    x.to_string().parse().unwrap_or(f64::from(x))
}

/// The middle of a list; the mean of the two in the middle of an even one. 0 of an empty one.
pub fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    match sorted.len() {
        0 => 0.0,
        n if n % 2 == 1 => sorted[n / 2],
        n => 0.5 * (sorted[n / 2 - 1] + sorted[n / 2]),
    }
}

/// Choices and parameters of a technique by name.
pub fn params(settings: &Settings) -> Map<String, Value> {
    let mut map = Map::new();
    for (key, row) in settings.method.rows() {
        map.insert(key.to_owned(), row.id.into());
    }
    for param in settings.params() {
        map.insert(param.name.to_owned(), settings.value(param.name).map(decimal).into());
    }
    map
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_finite() {
        assert_eq!(decimal(0.1).to_string(), "0.1");
        for odd in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            assert!(decimal(odd).is_finite());
        }
    }

    #[test]
    fn medians() {
        assert_eq!(
            [median(&[]), median(&[3.0]), median(&[3.0, 1.0, 2.0]), median(&[4.0, 1.0])],
            [0.0, 3.0, 2.0, 2.5]
        );
    }
}
