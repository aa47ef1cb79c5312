//! The errors of one channel, in numbers.

use crate::CompareError;
use crate::autocorrelation::{LjungBox, autocorrelation_lag1, effective_sample_size, ljung_box};
use crate::sprague_geers::{Russell, SpragueGeers, russell, sprague_geers};
use crate::statistics::{correlation, covariance, mean, mean_square, range, variance};
use crate::theil::{Theil, theil};

/// Most lags of the Ljung-Box test; fewer where a fifth of the pairs is fewer.
pub const LJUNG_BOX_LAGS: usize = 20;

/// The straight line through modelled over measured values, by least squares.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Regression {
    /// Modelled units per measured one; 1 is perfect.
    pub slope: f64,
    /// Modelled value where the measured one is zero [unit of the channel]; 0 is perfect.
    pub intercept: f64,
    /// Square of the correlation; zero where the model is constant.
    pub r_squared: f64,
}

/// Errors of a model, e = modelled - measured.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Metrics {
    /// Pairs that have both values.
    pub pairs: usize,
    /// Pairs that lack one and were passed over.
    pub passed_over: usize,
    /// Mean of e [unit of the channel].
    pub bias: f64,
    /// Standard error of the bias at the effective sample size of e: s / √n_eff [unit of the channel].
    pub bias_standard_error: f64,
    /// √mean(e²) [unit of the channel].
    pub rmse: f64,
    /// Mean of |e| [unit of the channel].
    pub mae: f64,
    /// Largest |e| [unit of the channel].
    pub max_error: f64,
    /// RMSE over the range (largest minus smallest) of the measured values; none where they are constant.
    pub nrmse_range: Option<f64>,
    /// RMSE over the absolute value of the measured mean; none where it is zero, or of a direction.
    pub nrmse_mean: Option<f64>,
    /// Modelled over measured; none where the measured values are constant.
    pub regression: Option<Regression>,
    /// Theil's inequality; none of a direction.
    pub theil: Option<Theil>,
    /// Sprague and Geers' errors; none of a direction, or where either signal is zero throughout and the other is not.
    pub sprague_geers: Option<SpragueGeers>,
    /// Russell's errors; none as above.
    pub russell: Option<Russell>,
    /// Autocorrelation of neighbouring e; none where e is constant.
    pub error_autocorrelation: Option<f64>,
    /// Independent samples that would say as much about the mean of e.
    pub effective_samples: f64,
    /// Whether e is white; none where it is constant or too short.
    pub ljung_box: Option<LjungBox>,
}

impl Metrics {
    /// Without what is relative to a zero that means something: a direction has none.
    #[must_use]
    pub(crate) fn of_direction(self) -> Self {
        Self { nrmse_mean: None, theil: None, sprague_geers: None, russell: None, ..self }
    }
}

/// The errors of a model at the times of the measurement; a pair that lacks a finite value is passed over and counted.
///
/// # Errors
/// [`CompareError::Length`] where the signals differ in length, [`CompareError::TooFew`] of fewer than two pairs.
pub fn metrics(measured: &[f64], modelled: &[f64]) -> Result<Metrics, CompareError> {
    if measured.len() != modelled.len() {
        return Err(CompareError::Length { measured: measured.len(), modelled: modelled.len() });
    }
    let (y, m): (Vec<f64>, Vec<f64>) = measured
        .iter()
        .zip(modelled)
        .filter(|(measured, modelled)| measured.is_finite() && modelled.is_finite())
        .map(|(measured, modelled)| (*measured, *modelled))
        .unzip();
    let pairs = y.len();
    if pairs < 2 {
        return Err(CompareError::TooFew { found: pairs, of: measured.len() });
    }
    let e: Vec<f64> = m.iter().zip(&y).map(|(m, y)| m - y).collect();
    let absolute: Vec<f64> = e.iter().map(|e| e.abs()).collect();
    let rmse = mean_square(&e).sqrt();
    let effective_samples = effective_sample_size(&e);
    let spread = range(&y).map_or(0.0, |(low, high)| high - low);
    let level = mean(&y).abs();
    Ok(Metrics {
        pairs,
        passed_over: measured.len() - pairs,
        bias: mean(&e),
        bias_standard_error: (variance(&e) / effective_samples).sqrt(),
        rmse,
        mae: mean(&absolute),
        max_error: absolute.iter().copied().fold(0.0, f64::max),
        nrmse_range: (spread > 0.0).then(|| rmse / spread),
        nrmse_mean: (level > 0.0).then(|| rmse / level),
        regression: regression(&y, &m),
        theil: Some(theil(&y, &m)),
        sprague_geers: Some(sprague_geers(&y, &m)).filter(|errors| errors.combined.is_finite()),
        russell: russell(&y, &m),
        error_autocorrelation: autocorrelation_lag1(&e),
        effective_samples,
        ljung_box: ljung_box(&e, LJUNG_BOX_LAGS.min(pairs / 5)),
    })
}

fn regression(y: &[f64], m: &[f64]) -> Option<Regression> {
    let spread = variance(y);
    (spread > 0.0).then(|| {
        let slope = covariance(y, m) / spread;
        let r_squared = correlation(y, m).map_or(0.0, |r| r * r);
        Regression { slope, intercept: mean(m) - slope * mean(y), r_squared }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// y = 1, 2, 3, 4 and ŷ = 1, 2, 3, 6: e = 0, 0, 0, 2. Bias 0.5, RMSE 1, MAE 0.5; range 3, mean 2.5. Covariance 2 over
    /// variance 1.25 is a slope of 1.6 through (2.5, 3): intercept -1; r² = 4 / (1.25 · 3.5) = 0.914286. e has the
    /// deviations -0.5, -0.5, -0.5, 1.5: ρ₁ = (0.25 + 0.25 - 0.75) / 3 = -1/12, which counts as no more than n = 4, and
    /// the variance 0.75: standard error √(0.75 / 4) = 0.433013.
    #[test]
    fn four_samples_are_worked_by_hand() {
        let found = metrics(&[1.0, 2.0, 3.0, 4.0], &[1.0, 2.0, 3.0, 6.0]).unwrap();
        assert_eq!((found.pairs, found.passed_over), (4, 0));
        assert_eq!((found.bias, found.rmse, found.mae, found.max_error), (0.5, 1.0, 0.5, 2.0));
        assert!((found.nrmse_range.unwrap() - 1.0 / 3.0).abs() < 1e-15);
        assert!((found.nrmse_mean.unwrap() - 0.4).abs() < 1e-15);
        let line = found.regression.unwrap();
        assert!((line.slope - 1.6).abs() < 1e-12 && (line.intercept + 1.0).abs() < 1e-12);
        assert!((line.r_squared - 0.914_286).abs() < 1e-6);
        assert!((found.error_autocorrelation.unwrap() + 1.0 / 12.0).abs() < 1e-12);
        assert!((found.bias_standard_error - 0.433_013).abs() < 1e-6);
        assert!((found.theil.unwrap().bias_share - 0.25).abs() < 1e-12);
        assert_eq!(found.ljung_box, None);
    }

    /// The sign is modelled minus measured: a model that is too low has a negative bias.
    #[test]
    fn a_model_that_is_too_low_has_a_negative_bias() {
        let found = metrics(&[5.0, 6.0], &[4.0, 5.0]).unwrap();
        assert_eq!((found.bias, found.mae), (-1.0, 1.0));
    }

    #[test]
    fn pairs_without_both_values_are_passed_over_and_counted() {
        let (nan, inf) = (f64::NAN, f64::INFINITY);
        let found = metrics(&[1.0, nan, 3.0, 4.0, 2.0], &[2.0, 2.0, nan, 5.0, inf]).unwrap();
        assert_eq!((found.pairs, found.passed_over, found.bias), (2, 3, 1.0));
        assert_eq!(metrics(&[1.0, nan], &[1.0, 1.0]), Err(CompareError::TooFew { found: 1, of: 2 }));
        assert_eq!(metrics(&[1.0], &[]), Err(CompareError::Length { measured: 1, modelled: 0 }));
    }

    /// e = 1, 2, 3, 4 has the variance 1.25 and counts as 2.4 samples: √(1.25 / 2.4) = 0.721688.
    #[test]
    fn errors_that_resemble_their_neighbours_leave_the_bias_less_certain() {
        let found = metrics(&[0.0; 4], &[1.0, 2.0, 3.0, 4.0]).unwrap();
        assert!((found.bias_standard_error - 0.721_688).abs() < 1e-6, "{found:?}");
    }

    #[test]
    fn whiteness_is_tested_over_a_fifth_of_the_pairs_up_to_twenty() {
        for (count, lags) in [(50_u32, 10), (500, 20)] {
            let model: Vec<f64> = (0..count).map(|step| f64::from(step * step % 17)).collect();
            let found = metrics(&vec![0.0; model.len()], &model).unwrap();
            assert_eq!(found.ljung_box.unwrap().lags, lags);
        }
    }

    #[test]
    fn what_is_relative_to_nothing_is_not_given() {
        let flat = metrics(&[0.0, 0.0], &[1.0, 2.0]).unwrap();
        assert_eq!((flat.nrmse_range, flat.nrmse_mean, flat.regression), (None, None, None));
        assert_eq!((flat.sprague_geers, flat.russell), (None, None));
        let stuck = metrics(&[1.0, 2.0], &[3.0, 3.0]).unwrap().regression.unwrap();
        assert_eq!((stuck.slope, stuck.intercept, stuck.r_squared), (0.0, 3.0, 0.0));
    }
}
