//! Quantiles, and draws that depend on a seed and on nothing else.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

/// Quantile of sorted values, linear between order statistics (Hyndman & Fan 1996, definition 7); NaN where empty.
pub fn quantile_of_sorted(sorted: &[f64], share: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let place = share.clamp(0.0, 1.0) * last as f64;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 <= place <= last")]
    let below = (place.floor() as usize).min(last);
    let above = (below + 1).min(last);
    sorted[below] + (place - below as f64) * (sorted[above] - sorted[below])
}

/// The values in ascending order.
pub fn sorted(values: &[f64]) -> Vec<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted
}

/// From the median of magnitudes to a standard deviation, for a normal distribution: 1/Φ⁻¹(¾).
pub const NORMAL_OF_MEDIAN: f64 = 1.4826;

/// Median; NaN where empty.
pub fn median(values: &[f64]) -> f64 {
    quantile_of_sorted(&sorted(values), 0.5)
}

/// Weighted median: the value at which half of the weight is reached, the mean of two values where it is reached
/// between them; NaN where there is no weight.
pub fn weighted_median(values_and_weights: &[(f64, f64)]) -> f64 {
    let mut ordered = values_and_weights.to_vec();
    ordered.sort_by(|left, right| left.0.total_cmp(&right.0));
    let half = 0.5 * ordered.iter().map(|(_, weight)| weight).sum::<f64>();
    let mut below = 0.0;
    for (index, (value, weight)) in ordered.iter().enumerate() {
        below += weight;
        if (below - half).abs() <= 1e-12 * half {
            let next = ordered[index + 1..].iter().find(|(_, weight)| *weight > 0.0);
            return next.map_or(*value, |next| 0.5 * (value + next.0));
        }
        if below > half {
            return *value;
        }
    }
    f64::NAN
}

/// Mean; NaN where empty.
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Standard deviation with n − 1; NaN for fewer than two values.
pub fn standard_deviation(values: &[f64]) -> f64 {
    if values.len() < 2 {
        return f64::NAN;
    }
    let mean = mean(values);
    (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (values.len() - 1) as f64).sqrt()
}

/// Quantile of Student's t; the normal quantile from a million degrees on, where they differ by less than 1e-5, and
/// NaN below half a degree, where the inversion has no end.
pub fn student_quantile(share: f64, degrees: f64) -> f64 {
    if degrees >= 1e6 {
        return Normal::standard().inverse_cdf(share);
    }
    if degrees.is_nan() || degrees < 0.5 {
        return f64::NAN;
    }
    StudentsT::new(0.0, 1.0, degrees).map_or(f64::NAN, |student| student.inverse_cdf(share))
}

/// A stream of draws, fixed by a seed and a stream number: replicates drawn in parallel each take their own number,
/// so that the result does not depend on which thread drew first.
pub struct Draws(ChaCha8Rng);

impl Draws {
    /// The draws of this seed and stream.
    pub fn new(seed: u64, stream: u64) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(stream);
        Self(generator)
    }

    /// Uniform in the open interval (0, 1).
    pub fn uniform(&mut self) -> f64 {
        ((self.0.next_u64() >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    /// Standard normal, by inversion.
    pub fn normal(&mut self) -> f64 {
        Normal::standard().inverse_cdf(self.uniform())
    }

    /// One of 0 .. count; 0 where `count` is 0.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "below count")]
    pub fn index(&mut self, count: usize) -> usize {
        ((self.uniform() * count as f64) as usize).min(count.saturating_sub(1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_linear_between_order_statistics() {
        let values = [1.0, 2.0, 4.0, 8.0];
        assert_eq!(quantile_of_sorted(&values, 0.0), 1.0);
        assert_eq!(quantile_of_sorted(&values, 0.5), 3.0);
        assert_eq!(quantile_of_sorted(&values, 0.25), 1.75);
        assert_eq!(quantile_of_sorted(&values, 1.0), 8.0);
        assert!(quantile_of_sorted(&[], 0.5).is_nan());
    }

    #[test]
    fn the_weighted_median_follows_the_weight() {
        assert_eq!(weighted_median(&[(3.0, 1.0), (1.0, 1.0), (2.0, 1.0)]), 2.0);
        assert_eq!(weighted_median(&[(3.0, 5.0), (1.0, 1.0), (2.0, 1.0)]), 3.0);
        assert_eq!(weighted_median(&[(1.0, 1.0), (2.0, 1.0)]), 1.5);
        assert!(weighted_median(&[]).is_nan());
    }

    /// Tables of Student's t: 2.262 at nine degrees, 2.306 at eight.
    #[test]
    fn student_quantiles_are_those_of_the_tables() {
        assert!((student_quantile(0.975, 9.0) - 2.262).abs() < 5e-4);
        assert!((student_quantile(0.975, 8.0) - 2.306).abs() < 5e-4);
        assert!((student_quantile(0.975, f64::INFINITY) - 1.95996).abs() < 1e-5);
        assert!(student_quantile(0.975, 0.0).is_nan());
    }

    #[test]
    fn a_stream_repeats_and_another_differs() {
        let draw = |stream| Draws::new(7, stream).uniform();
        assert_eq!(draw(3).to_bits(), draw(3).to_bits());
        assert_ne!(draw(3).to_bits(), draw(4).to_bits());
    }

    #[test]
    fn normal_draws_have_the_moments_of_the_normal() {
        let mut draws = Draws::new(1, 0);
        let values: Vec<f64> = (0..20_000).map(|_| draws.normal()).collect();
        assert!(mean(&values).abs() < 0.03, "5 standard errors of the mean are 0.035");
        assert!((standard_deviation(&values) - 1.0).abs() < 0.025);
    }
}
