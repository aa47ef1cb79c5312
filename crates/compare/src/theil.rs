//! Theil's inequality: an error between 0 and 1, and what it is made of.
//!
//! U₁ = √mean(e²) / (√mean(y²) + √mean(ŷ²))
//! mean(e²) = (mean ŷ - mean y)² + (s_ŷ - s_y)² + 2 (1 - r) s_ŷ s_y
//!
//! with y measured, ŷ modelled, e = ŷ - y, s the standard deviations of the population and r their correlation.
//! The first share is a wrong level, the second a wrong size of the swings, the third what neither explains.
//!
//! Source: Theil, *Economic Forecasts and Policy* (1958), section 2.5.

use crate::statistics::{covariance, mean, mean_square, variance};

/// Theil's U₁ and the shares of the mean squared error; the shares sum to one, or are all zero where there is no error.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Theil {
    /// Inequality, 0 (equal) to 1.
    pub u1: f64,
    /// Share of a wrong mean.
    pub bias_share: f64,
    /// Share of a wrong standard deviation.
    pub variance_share: f64,
    /// Share of imperfect correlation.
    pub covariance_share: f64,
}

/// Theil's inequality of two signals of one length; NaN of no samples.
pub fn theil(measured: &[f64], modelled: &[f64]) -> Theil {
    let errors: Vec<f64> =
        modelled.iter().zip(measured).map(|(modelled, measured)| modelled - measured).collect();
    let mse = mean_square(&errors);
    if mse == 0.0 {
        return Theil { u1: 0.0, bias_share: 0.0, variance_share: 0.0, covariance_share: 0.0 };
    }
    let (s_y, s_m) = (variance(measured).sqrt(), variance(modelled).sqrt());
    Theil {
        u1: mse.sqrt() / (mean_square(measured).sqrt() + mean_square(modelled).sqrt()),
        bias_share: mean(&errors).powi(2) / mse,
        variance_share: (s_m - s_y).powi(2) / mse,
        covariance_share: 2.0 * (s_m * s_y - covariance(measured, modelled)) / mse,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// y = 1, 2, 3, 4 and ŷ = 1, 2, 3, 6: mean e² = 1, mean y² = 7.5, mean ŷ² = 12.5, so
    /// U₁ = 1 / (2.738613 + 3.535534) = 0.159384. Bias 0.5² = 0.25. s = √1.25 and √3.5: (1.870829 - 1.118034)² = 0.566700.
    /// Covariance 2: 2 (√4.375 - 2) = 0.183300. The shares sum to 1.
    #[test]
    fn four_samples_are_worked_by_hand() {
        let theil = theil(&[1.0, 2.0, 3.0, 4.0], &[1.0, 2.0, 3.0, 6.0]);
        assert!((theil.u1 - 0.159_384).abs() < 1e-6, "{theil:?}");
        assert!((theil.bias_share - 0.25).abs() < 1e-15);
        assert!((theil.variance_share - 0.566_700).abs() < 1e-6);
        assert!((theil.covariance_share - 0.183_300).abs() < 1e-6);
    }

    #[test]
    fn equal_signals_have_no_inequality_and_opposite_ones_all_of_it() {
        let y = [1.0, -2.0, 3.0];
        assert_eq!(theil(&y, &y).u1, 0.0);
        let opposite = theil(&y, &[-1.0, 2.0, -3.0]);
        assert!((opposite.u1 - 1.0).abs() < 1e-15);
    }

    #[test]
    fn an_offset_is_all_bias_and_a_factor_about_the_mean_all_variance() {
        let offset = theil(&[1.0, 2.0, 3.0], &[2.0, 3.0, 4.0]);
        assert!((offset.bias_share - 1.0).abs() < 1e-12);
        let swing = theil(&[1.0, 2.0, 3.0], &[0.0, 2.0, 4.0]);
        assert!((swing.variance_share - 1.0).abs() < 1e-12);
    }

    proptest! {
        #[test]
        fn the_shares_sum_to_one(pairs in prop::collection::vec((-1e3..1e3_f64, -1e3..1e3_f64), 3..50)) {
            let (y, m): (Vec<f64>, Vec<f64>) = pairs.into_iter().unzip();
            let theil = theil(&y, &m);
            prop_assert!((theil.bias_share + theil.variance_share + theil.covariance_share - 1.0).abs() < 1e-9);
            prop_assert!((0.0..=1.0 + 1e-12).contains(&theil.u1));
        }
    }
}
