//! How much of a sample is news: autocorrelation, effective sample size, and the Ljung-Box test of a residual.
//!
//! Both take samples at even distances; of uneven ones they say what neighbours have in common, whatever their distance.

use crate::statistics::mean;
use statrs::function::gamma::gamma_ur;

/// Autocorrelation at a lag of `lag` samples: sum of (x_t - mean)(x_{t+lag} - mean) over the sum of (x_t - mean)².
///
/// `None` where the signal is constant, or not longer than the lag.
pub fn autocorrelation(values: &[f64], lag: usize) -> Option<f64> {
    if lag >= values.len() {
        return None;
    }
    let mean = mean(values);
    let spread: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    let shared: f64 =
        values.iter().zip(&values[lag..]).map(|(early, late)| (early - mean) * (late - mean)).sum();
    (spread > 0.0).then(|| shared / spread)
}

/// Autocorrelation of neighbours; `None` where the signal is constant or of one sample.
pub fn autocorrelation_lag1(values: &[f64]) -> Option<f64> {
    autocorrelation(values, 1)
}

/// The number of independent samples that say as much about the mean as these do: n (1 - ρ₁) / (1 + ρ₁).
///
/// Exact for a first-order autoregressive signal and a large n. Held between 2 and n: a negative ρ₁ is not taken as
/// evidence for more than n samples, and a signal that never changes counts as two.
pub fn effective_sample_size(values: &[f64]) -> f64 {
    match autocorrelation_lag1(values) {
        Some(rho) => effective_from(values.len() as f64, rho),
        None => 2.0,
    }
}

/// As [`effective_sample_size`], from n and the autocorrelation of neighbours.
pub fn effective_from(n: f64, rho: f64) -> f64 {
    (n * (1.0 - rho) / (1.0 + rho)).min(n).max(2.0)
}

/// Whether a residual is white.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct LjungBox {
    /// Q = n (n + 2) Σ ρ_k² / (n - k) over the lags k = 1 to `lags`.
    pub statistic: f64,
    /// Lags that were summed; the degrees of freedom of the χ² distribution.
    pub lags: usize,
    /// Probability of a statistic as large under white noise: a small one means that the residual holds structure.
    pub p_value: f64,
}

/// Ljung-Box test of the residual `e` over lags 1 to `lags`; `None` where it is constant, too short, or no lag is asked.
///
/// Source: Ljung and Box, *On a measure of lack of fit in time series models*, Biometrika 65 (1978).
pub fn ljung_box(e: &[f64], lags: usize) -> Option<LjungBox> {
    if lags == 0 {
        return None;
    }
    let n = e.len() as f64;
    let mut sum = 0.0;
    for lag in 1..=lags {
        sum += autocorrelation(e, lag)?.powi(2) / (n - lag as f64);
    }
    let statistic = n * (n + 2.0) * sum;
    // Upper tail of χ² with k degrees of freedom: the regularised upper incomplete gamma function Q(k/2, x/2).
    let p_value = if statistic > 0.0 { gamma_ur(lags as f64 / 2.0, statistic / 2.0) } else { 1.0 };
    Some(LjungBox { statistic, lags, p_value })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Deviations of 1, 2, 3, 4 are -1.5, -0.5, 0.5, 1.5: neighbours 0.75 - 0.25 + 0.75 = 1.25, squares 5, ρ₁ = 0.25.
    /// Then n_eff = 4 · 0.75 / 1.25 = 2.4.
    #[test]
    fn four_samples_of_a_ramp_count_as_two_and_a_half() {
        let values = [1.0, 2.0, 3.0, 4.0];
        assert_eq!(autocorrelation_lag1(&values), Some(0.25));
        assert!((effective_sample_size(&values) - 2.4).abs() < 1e-15);
    }

    /// At ρ₁ = 0.99: 0.01 / 1.99 = 1/199.
    #[test]
    fn at_a_correlation_of_099_only_one_sample_in_199_counts() {
        assert!((effective_from(19_900.0, 0.99) - 100.0).abs() < 1e-9);
    }

    #[test]
    fn the_effective_size_stays_between_two_and_the_number_of_samples() {
        assert_eq!(effective_from(10.0, -0.5), 10.0);
        assert_eq!(effective_from(100.0, 0.999), 2.0);
        assert_eq!(effective_sample_size(&[3.0; 50]), 2.0);
        assert_eq!(effective_sample_size(&[1.0, -1.0, 1.0, -1.0]), 4.0);
    }

    /// 1, 2, 3, 4 at one lag: Q = 4 · 6 · 0.25² / 3 = 0.5; P(χ²₁ > 0.5) = erfc(√0.25) = erfc(0.5) = 0.479500.
    #[test]
    fn ljung_box_of_one_lag_is_worked_by_hand() {
        let test = ljung_box(&[1.0, 2.0, 3.0, 4.0], 1).unwrap();
        assert!((test.statistic - 0.5).abs() < 1e-15);
        assert!((test.p_value - 0.479_500_1).abs() < 1e-7, "{}", test.p_value);
    }

    /// ρ₂ of the ramp is (-1.5 · 0.5 - 0.5 · 1.5) / 5 = -0.3: Q = 24 (0.0625/3 + 0.09/2) = 1.58, and the upper tail of
    /// χ² with two degrees of freedom is exp(-Q/2).
    #[test]
    fn ljung_box_of_two_lags_has_an_exponential_tail() {
        let test = ljung_box(&[1.0, 2.0, 3.0, 4.0], 2).unwrap();
        assert!((test.statistic - 1.58).abs() < 1e-14);
        assert!((test.p_value - (-0.79_f64).exp()).abs() < 1e-12);
    }

    #[test]
    fn ljung_box_tells_a_slow_drift_from_an_alternation_without_memory_of_the_level() {
        let drift: Vec<f64> = (0..200).map(|step| (f64::from(step) * 0.05).sin()).collect();
        assert!(ljung_box(&drift, 10).unwrap().p_value < 1e-6);
        assert_eq!(ljung_box(&[1.0; 20], 3), None);
        assert_eq!(ljung_box(&[1.0, 2.0], 2), None);
        assert_eq!(ljung_box(&[1.0, 2.0], 0), None);
    }
}
