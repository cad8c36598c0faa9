//! Shares of false shadow and false light, and what of it no resolution explains.

use super::distance::distance_to_change;
use glam::{UVec2, Vec3};
use serde::Serialize;

/// No technique can place an edge better than this, pixels.
pub const LEAST_REACH_PX: f32 = 2.0;
/// A surface that is lit in truth and darker than this has acne.
const ACNE_BELOW: f32 = 0.95;
/// A surface that is in full shadow in truth and brighter than this leaks.
const LEAK_ABOVE: f32 = 0.05;

/// The truth of a picture, ready to judge answers.
#[derive(Clone, Debug)]
pub struct Judged {
    size: UVec2,
    truth: Vec<Vec3>,
    receivers: Vec<bool>,
    distance_px: Vec<f32>,
}

/// How wrong an answer is. Shares and errors are fractions of 1; lower is better.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Errors {
    /// Mean of max(0, V* - V) over receivers.
    pub false_shadow: f64,
    /// Mean of max(0, V - V*) over receivers.
    pub false_light: f64,
    /// Root of the mean square of V - V* over receivers.
    pub rmse: f64,
    /// Share of sure receivers with V* = 1 and V below 0.95.
    pub acne: f64,
    /// Share of sure receivers with V* = 0 and V above 0.05.
    pub leak: f64,
    /// Mean of |V - V*| in the edge band; 0 without one.
    pub edge: f64,
    /// The edge band's share of the receivers.
    pub band: f64,
    /// Receivers.
    pub receivers: usize,
    /// Receivers outside of the edge band.
    pub sure: usize,
    /// Sure receivers with acne.
    pub acne_pixels: usize,
    /// Sure receivers that leak.
    pub leak_pixels: usize,
    /// Receivers that would be wrong and sure, were there no edge within reach that the picture does not show; they count to
    /// the edge band.
    pub hidden_pixels: usize,
}

impl Errors {
    /// Means over several pictures; counts are sums.
    pub fn mean(all: &[Self]) -> Self {
        let mean = |of: fn(&Self) -> f64| all.iter().map(of).sum::<f64>() / all.len().max(1) as f64;
        let sum = |of: fn(&Self) -> usize| all.iter().map(of).sum();
        Self {
            false_shadow: mean(|e| e.false_shadow),
            false_light: mean(|e| e.false_light),
            rmse: mean(|e| e.rmse),
            acne: mean(|e| e.acne),
            leak: mean(|e| e.leak),
            edge: mean(|e| e.edge),
            band: mean(|e| e.band),
            receivers: sum(|e| e.receivers),
            sure: sum(|e| e.sure),
            acne_pixels: sum(|e| e.acne_pixels),
            leak_pixels: sum(|e| e.leak_pixels),
            hidden_pixels: sum(|e| e.hidden_pixels),
        }
    }
}

impl Judged {
    /// `truth` is V* for each pixel, `counts` where there is one (a surface of which the light's cone reaches both sides of
    /// an edge), `receivers` the pixels that are judged.
    pub fn new(size: UVec2, truth: Vec<Vec3>, counts: &[bool], receivers: Vec<bool>) -> Self {
        let distance_px = distance_to_change(size, &truth, counts);
        Self { size, truth, receivers, distance_px }
    }

    /// Pixels.
    pub fn size(&self) -> UVec2 {
        self.size
    }

    /// The truth.
    pub fn truth(&self) -> &[Vec3] {
        &self.truth
    }

    /// Which pixels are judged.
    pub fn receivers(&self) -> &[bool] {
        &self.receivers
    }

    /// Is a pixel a receiver that is farther than `reach_px` from any place where the truth changes?
    pub fn is_sure(&self, pixel: usize, reach_px: f32) -> bool {
        self.receivers[pixel] && self.distance_px[pixel] > reach_px.max(LEAST_REACH_PX)
    }

    /// The sure pixels that an answer has wrong: acne and leaks.
    pub fn wrong(&self, v: &[Vec3], reach_px: &[f32]) -> Vec<usize> {
        let is_wrong = |pixel: &usize| {
            self.is_sure(*pixel, reach_px[*pixel])
                && (self.has_acne(*pixel, v[*pixel]) || self.leaks(*pixel, v[*pixel]))
        };
        (0..self.truth.len()).filter(is_wrong).collect()
    }

    fn has_acne(&self, pixel: usize, v: Vec3) -> bool {
        self.truth[pixel].min_element() >= 1.0 && v.min_element() < ACNE_BELOW
    }

    fn leaks(&self, pixel: usize, v: Vec3) -> bool {
        self.truth[pixel].max_element() <= 0.0 && v.max_element() > LEAK_ABOVE
    }

    /// Compares an answer. `reach_px` says for each pixel what the technique cannot resolve there.
    pub fn errors(&self, v: &[Vec3], reach_px: &[f32]) -> Errors {
        let mut sum = Errors::default();
        let (mut squares, mut band, mut edge) = (0.0, 0usize, 0.0);
        for pixel in (0..self.truth.len()).filter(|pixel| self.receivers[*pixel]) {
            let truth = self.truth[pixel];
            // NaN is no visibility: it counts as the worst that it could be.
            let v = v[pixel].map(|x| if x.is_nan() { 1.0 } else { x });
            let difference = (v - truth).as_dvec3();
            let mean = |d: glam::DVec3| (d.x + d.y + d.z) / 3.0;
            sum.receivers += 1;
            sum.false_shadow += mean((-difference).max(glam::DVec3::ZERO));
            sum.false_light += mean(difference.max(glam::DVec3::ZERO));
            squares += mean(difference * difference);
            if !self.is_sure(pixel, reach_px[pixel]) {
                band += 1;
                edge += mean(difference.abs());
                continue;
            }
            sum.sure += 1;
            sum.acne_pixels += usize::from(self.has_acne(pixel, v));
            sum.leak_pixels += usize::from(self.leaks(pixel, v));
        }
        let share = |part: f64, whole: usize| if whole == 0 { 0.0 } else { part / whole as f64 };
        Errors {
            false_shadow: share(sum.false_shadow, sum.receivers),
            false_light: share(sum.false_light, sum.receivers),
            rmse: share(squares, sum.receivers).sqrt(),
            acne: share(sum.acne_pixels as f64, sum.sure),
            leak: share(sum.leak_pixels as f64, sum.sure),
            edge: share(edge, band),
            band: share(band as f64, sum.receivers),
            ..sum
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: UVec2 = UVec2::new(20, 10);

    /// Left half lit, right half in shadow; the last column is no receiver.
    fn half() -> Judged {
        let x = |i: usize| i % 20;
        let truth = (0..200).map(|i| if x(i) < 10 { Vec3::ONE } else { Vec3::ZERO }).collect();
        let receivers: Vec<bool> = (0..200).map(|i| x(i) != 19).collect();
        Judged::new(SIZE, truth, &[true; 200], receivers)
    }

    fn near(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-9
    }

    #[test]
    fn the_truth_has_no_error() {
        let judged = half();
        let errors = judged.errors(judged.truth(), &[0.0; 200]);
        assert_eq!((errors.receivers, errors.sure), (190, 190 - 40));
        let band = 40.0 / 190.0;
        assert_eq!(errors, Errors { receivers: 190, sure: 150, band, ..Errors::default() });
    }

    #[test]
    fn each_error_is_counted_where_it_belongs() {
        let judged = half();
        let mut v = judged.truth().to_vec();
        v[0] = Vec3::splat(0.5); // acne: lit in truth, far from the edge
        v[1] = Vec3::splat(0.96); // too small for acne, but false shadow
        v[18] = Vec3::splat(0.25); // leak
        v[19] = Vec3::ONE; // no receiver
        v[29] = Vec3::splat(0.2); // in the band: column 9 of the second row
        let errors = judged.errors(&v, &[0.0; 200]);
        assert!(
            near(errors.false_shadow, (0.5 + 0.04 + 0.8) / 190.0)
                || (errors.false_shadow - 1.34 / 190.0).abs() < 1e-7
        );
        assert!((errors.false_light - 0.25 / 190.0).abs() < 1e-7);
        let squares: f64 = 0.25 + 0.0016 + 0.0625 + 0.64;
        assert!((errors.rmse - (squares / 190.0).sqrt()).abs() < 1e-6);
        assert_eq!((errors.acne_pixels, errors.leak_pixels), (1, 1));
        assert!(near(errors.acne, 1.0 / 150.0) && near(errors.leak, 1.0 / 150.0));
        assert!((errors.edge - 0.8 / 40.0).abs() < 1e-7);
    }

    #[test]
    fn a_wider_reach_makes_more_pixels_unsure() {
        let judged = half();
        let mut v = judged.truth().to_vec();
        v[0] = Vec3::ZERO; // 9.5 pixels from the change
        assert_eq!(judged.errors(&v, &[9.0; 200]).acne_pixels, 1);
        let unsure = judged.errors(&v, &[9.5; 200]);
        assert_eq!((unsure.acne_pixels, unsure.sure), (0, 0));
        assert!(near(unsure.band, 1.0) && unsure.acne == 0.0);
    }

    #[test]
    fn colours_count_by_the_channel() {
        let truth = vec![Vec3::new(1.0, 0.0, 0.0); 200];
        let judged = Judged::new(SIZE, truth, &[true; 200], vec![true; 200]);
        let grey = judged.errors(&[Vec3::splat(0.5); 200], &[0.0; 200]);
        assert!(
            near(grey.false_shadow, 0.5 / 3.0) && near(grey.false_light, 1.0 / 3.0) && near(grey.rmse, 0.5)
        );
        // Neither fully lit nor fully dark: neither acne nor leak.
        assert_eq!((grey.acne_pixels, grey.leak_pixels), (0, 0));
    }

    #[test]
    fn means_are_of_shares_and_sums_of_counts() {
        let judged = half();
        let dark = vec![Vec3::ZERO; 200];
        let (right, wrong) = (judged.errors(judged.truth(), &[0.0; 200]), judged.errors(&dark, &[0.0; 200]));
        let mean = Errors::mean(&[right, wrong]);
        assert!(near(mean.acne, 0.5 * wrong.acne) && near(mean.rmse, 0.5 * wrong.rmse) && wrong.acne > 0.5);
        assert_eq!((mean.sure, mean.acne_pixels), (300, wrong.acne_pixels));
        assert_eq!(Errors::mean(&[]), Errors::default());
    }

    #[test]
    fn no_receiver_no_error_and_nan_is_the_worst() {
        let none = Judged::new(SIZE, vec![Vec3::ONE; 200], &[true; 200], vec![false; 200]);
        assert_eq!(none.errors(&[Vec3::ZERO; 200], &[0.0; 200]), Errors::default());
        let dark = Judged::new(SIZE, vec![Vec3::ZERO; 200], &[true; 200], vec![true; 200]);
        assert!(near(dark.errors(&[Vec3::NAN; 200], &[0.0; 200]).leak, 1.0));
    }
}
