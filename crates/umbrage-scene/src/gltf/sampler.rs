//! Keys of an animation and what lies between them: the specification's appendix C, in 64 bits.

use glam::DQuat;

/// How values pass from one key to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Interpolation {
    /// In a straight line, or for rotations along the shortest arc.
    Linear,
    /// Each key holds until the next.
    Step,
    /// Hermite splines; each key has a tangent before and one behind its value.
    CubicSpline,
}

impl Interpolation {
    /// As the file writes it.
    pub(super) fn of(name: &str) -> Option<Self> {
        match name {
            "LINEAR" => Some(Self::Linear),
            "STEP" => Some(Self::Step),
            "CUBICSPLINE" => Some(Self::CubicSpline),
            _ => None,
        }
    }

    /// Values stored for each key.
    fn stored(self) -> usize {
        if self == Self::CubicSpline { 3 } else { 1 }
    }
}

/// Keys whose numbers fit together: there is one at least, and their times do not fall.
#[derive(Debug)]
pub(super) struct Keys {
    /// Seconds.
    times: Vec<f32>,
    /// Of each key `width` numbers, or three times as many for splines: tangent before, value, tangent behind.
    values: Vec<f32>,
    /// Numbers of a value.
    width: usize,
    interpolation: Interpolation,
    /// Values are quaternions.
    rotation: bool,
}

impl Keys {
    /// Checks that they fit together.
    ///
    /// # Errors
    /// What does not.
    pub(super) fn new(
        times: Vec<f32>,
        values: Vec<f32>,
        width: usize,
        interpolation: Interpolation,
        rotation: bool,
    ) -> Result<Self, String> {
        if times.is_empty() {
            return Err("it has no keys".into());
        }
        if let Some(key) = times.iter().position(|time| !time.is_finite()) {
            return Err(format!("the time of key {key} is not finite"));
        }
        // Two keys at one time are against the specification too, but mean a jump and nothing else.
        if let Some(key) = times.windows(2).position(|pair| pair[1] < pair[0]) {
            let (next, at, before) = (key + 1, times[key + 1], times[key]);
            return Err(format!("key {next} is at {at} s, before key {key} at {before} s"));
        }
        let need = times.len().saturating_mul(width).saturating_mul(interpolation.stored());
        if values.len() != need {
            let (keys, have) = (times.len(), values.len());
            return Err(format!("its {keys} keys need {need} numbers and have {have}"));
        }
        Ok(Self { times, values, width, interpolation, rotation })
    }

    /// Time of the last key, seconds.
    pub(super) fn end_s(&self) -> f32 {
        self.times.last().copied().unwrap_or_default()
    }

    /// The value at a time; before the first key that of the first, after the last that of the last.
    pub(super) fn at(&self, time_s: f64) -> Vec<f32> {
        let passed = self.times.partition_point(|key| f64::from(*key) <= time_s);
        let wide = match (passed.checked_sub(1), passed < self.times.len()) {
            (None, _) => self.value(0),
            (Some(key), false) => self.value(key),
            (Some(key), true) => self.between(key, time_s),
        };
        wide.into_iter().map(|x| x as f32).collect()
    }

    /// Between a key and the next, whose time is later.
    fn between(&self, key: usize, time_s: f64) -> Vec<f64> {
        let [from_s, to_s] = [key, key + 1].map(|key| f64::from(self.times[key]));
        let length_s = to_s - from_s;
        let share = (time_s - from_s) / length_s;
        let (from, to) = (self.value(key), self.value(key + 1));
        match self.interpolation {
            Interpolation::Step => from,
            Interpolation::Linear if self.rotation => slerp(&from, &to, share),
            Interpolation::Linear => {
                std::iter::zip(from, to).map(|(from, to)| from * (1.0 - share) + to * share).collect()
            }
            Interpolation::CubicSpline => {
                let (leaving, arriving) = (self.part(key, 2), self.part(key + 1, 0));
                let [t, t2, t3] = [1, 2, 3].map(|power| share.powi(power));
                let weights = [
                    2.0 * t3 - 3.0 * t2 + 1.0,
                    length_s * (t3 - 2.0 * t2 + t),
                    3.0 * t2 - 2.0 * t3,
                    length_s * (t3 - t2),
                ];
                let parts = [&from, &leaving, &to, &arriving];
                (0..self.width).map(|i| std::iter::zip(parts, weights).map(|(p, w)| p[i] * w).sum()).collect()
            }
        }
    }

    /// What a key holds.
    fn value(&self, key: usize) -> Vec<f64> {
        self.part(key, self.interpolation.stored() / 2)
    }

    /// One of the values stored for a key.
    fn part(&self, key: usize, part: usize) -> Vec<f64> {
        let start = (key * self.interpolation.stored() + part) * self.width;
        self.values[start..start + self.width].iter().map(|x| f64::from(*x)).collect()
    }
}

/// Along the shorter arc between two rotations, at even speed.
fn slerp(from: &[f64], to: &[f64], share: f64) -> Vec<f64> {
    // Exporters round; a quaternion without length turns nothing.
    let unit = |q: &[f64]| {
        let q = DQuat::from_slice(q);
        if q.length_squared() > 0.0 { q.normalize() } else { DQuat::IDENTITY }
    };
    unit(from).slerp(unit(to), share).to_array().to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;
    use Interpolation::{CubicSpline, Linear, Step};

    fn line(times: &[f32], values: &[f32], interpolation: Interpolation) -> Keys {
        Keys::new(times.to_vec(), values.to_vec(), 1, interpolation, false).unwrap()
    }

    #[test]
    fn lines_and_steps_hold_at_both_ends() {
        let keys = line(&[1.0, 2.0, 4.0], &[10.0, 20.0, 0.0], Linear);
        for (time, value) in [(0.0, 10.0), (1.0, 10.0), (1.5, 15.0), (2.0, 20.0), (3.0, 10.0), (9.0, 0.0)] {
            assert_eq!(keys.at(time), [value], "{time}");
        }
        let keys = line(&[1.0, 2.0, 4.0], &[10.0, 20.0, 0.0], Step);
        for (time, value) in [(0.0, 10.0), (1.999, 10.0), (2.0, 20.0), (3.999, 20.0), (4.0, 0.0), (9.0, 0.0)]
        {
            assert_eq!(keys.at(time), [value], "{time}");
        }
    }

    #[test]
    fn a_spline_through_the_keys_of_a_cubic_is_that_cubic() {
        // x^3 from 1 to 3: a cubic is its own Hermite spline when the tangents are its slopes, 3 x^2.
        let keys = line(&[1.0, 3.0], &[9.0, 1.0, 3.0, 27.0, 27.0, 9.0], CubicSpline);
        for x in [1.0_f64, 1.25, 2.0, 2.9, 3.0] {
            assert!((f64::from(keys.at(x)[0]) - x.powi(3)).abs() < 1e-5, "{x}: {:?}", keys.at(x));
        }
        assert_eq!((keys.at(0.0), keys.at(5.0)), (vec![1.0], vec![27.0]), "tangents end with the keys");
    }

    #[test]
    fn rotations_take_the_shorter_arc_at_even_speed() {
        let half = std::f32::consts::FRAC_1_SQRT_2;
        // A quarter turn about z, its end written with the other sign: the same rotation, the longer way round.
        let values = vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, -half, -half];
        let keys = Keys::new(vec![0.0, 1.0], values, 4, Linear, true).unwrap();
        for share in [0.25_f64, 0.5, 0.75] {
            let [x, y, z, w] = keys.at(share)[..] else { panic!("four numbers") };
            let turned = 2.0 * f64::from(z).atan2(f64::from(w)).to_degrees();
            assert!((turned - 90.0 * share).abs() < 1e-4 && x == 0.0 && y == 0.0, "{share}: {turned}");
        }
        let none = Keys::new(vec![0.0, 1.0], vec![0.0; 8], 4, Linear, true).unwrap();
        assert_eq!(none.at(0.5), [0.0, 0.0, 0.0, 1.0]);
    }

    #[test]
    fn two_keys_at_one_time_are_a_jump() {
        let keys = line(&[0.0, 1.0, 1.0, 2.0], &[0.0, 1.0, 5.0, 6.0], Linear);
        assert_eq!([0.5, 1.0, 1.5].map(|time| keys.at(time)[0]), [0.5, 5.0, 5.5]);
    }

    #[test]
    fn keys_that_do_not_fit_together_are_refused() {
        for (times, values, kind, word) in [
            (vec![], vec![], Linear, "no keys"),
            (vec![0.0, f32::NAN], vec![0.0; 2], Linear, "time of key 1"),
            (vec![f32::INFINITY], vec![0.0], Linear, "time of key 0"),
            (vec![0.0, 2.0, 1.0], vec![0.0; 3], Step, "key 2 is at 1 s, before key 1 at 2 s"),
            (vec![0.0, 1.0], vec![0.0; 3], Linear, "need 2 numbers and have 3"),
            (vec![0.0, 1.0], vec![0.0; 2], CubicSpline, "need 6 numbers and have 2"),
        ] {
            let message = Keys::new(times, values, 1, kind, false).unwrap_err();
            assert!(message.contains(word), "{word}: {message}");
        }
    }
}
