//! Means, moments and quantiles of plain samples.
//!
//! Moments are of the population (divided by n, not n - 1): the decomposition of a mean squared error needs them so.

/// Mean; NaN of no samples.
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Mean of the squares [square of the unit].
pub fn mean_square(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64
}

/// Covariance of two signals of one length, of the population: mean of (a - mean a)(b - mean b).
pub fn covariance(a: &[f64], b: &[f64]) -> f64 {
    let (mean_a, mean_b) = (mean(a), mean(b));
    a.iter().zip(b).map(|(a, b)| (a - mean_a) * (b - mean_b)).sum::<f64>() / a.len() as f64
}

/// Variance of the population.
pub fn variance(values: &[f64]) -> f64 {
    covariance(values, values)
}

/// Pearson's correlation, -1 to 1; `None` where either signal is constant or there are fewer than two samples.
pub fn correlation(a: &[f64], b: &[f64]) -> Option<f64> {
    let scale = (variance(a) * variance(b)).sqrt();
    (scale > 0.0).then(|| (covariance(a, b) / scale).clamp(-1.0, 1.0))
}

/// Smallest and largest value; `None` of no samples.
pub fn range(values: &[f64]) -> Option<(f64, f64)> {
    let first = *values.first()?;
    Some(values.iter().fold((first, first), |(low, high), value| (low.min(*value), high.max(*value))))
}

/// The quantile at `probability` (0 to 1), linear between order statistics: at rank h = (n - 1) p from zero.
///
/// `None` of no samples, or where the probability is outside 0 to 1. NaN is passed over.
///
/// Source: Hyndman and Fan, *Sample quantiles in statistical packages*, The American Statistician 50 (1996),
/// definition 7.
pub fn quantile(values: &[f64], probability: f64) -> Option<f64> {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|value| !value.is_nan()).collect();
    sorted.sort_by(f64::total_cmp);
    quantile_of_sorted(&sorted, probability)
}

/// As [`quantile`], of samples that are sorted and free of NaN.
pub fn quantile_of_sorted(sorted: &[f64], probability: f64) -> Option<f64> {
    if sorted.is_empty() || !(0.0..=1.0).contains(&probability) {
        return None;
    }
    let rank = (sorted.len() - 1) as f64 * probability;
    let below = floor_index(rank);
    let above = (below + 1).min(sorted.len() - 1);
    let share = rank - below as f64;
    Some(if share == 0.0 { sorted[below] } else { sorted[below] + share * (sorted[above] - sorted[below]) })
}

/// Whole part of a number that is known to be an index.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "an index: not negative, far below 2^53"
)]
pub(crate) fn floor_index(value: f64) -> usize {
    value.floor() as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of 1, 2, 3, 4 at p = 0.25 the rank is 3 · 0.25 = 0.75, so 1 + 0.75 · (2 - 1) = 1.75; the median is 2.5.
    #[test]
    fn quantiles_are_linear_between_order_statistics() {
        let values = [4.0, 1.0, f64::NAN, 3.0, 2.0];
        assert_eq!(quantile(&values, 0.25), Some(1.75));
        assert_eq!(quantile(&values, 0.5), Some(2.5));
        assert_eq!(quantile(&values, 0.0), Some(1.0));
        assert_eq!(quantile(&values, 1.0), Some(4.0));
    }

    #[test]
    fn a_quantile_of_nothing_or_outside_zero_to_one_is_none() {
        assert_eq!(quantile(&[], 0.5), None);
        assert_eq!(quantile(&[f64::NAN], 0.5), None);
        assert_eq!(quantile(&[1.0], 1.1), None);
        assert_eq!(quantile(&[1.0], f64::NAN), None);
    }

    /// 1, 2, 3, 4 against 1, 2, 3, 6: the products of the deviations are 3, 0.5, 0 and 4.5, their mean 2; the variances
    /// are 5/4 and 14/4.
    #[test]
    fn moments_are_of_the_population() {
        let (a, b) = ([1.0, 2.0, 3.0, 4.0], [1.0, 2.0, 3.0, 6.0]);
        assert_eq!(covariance(&a, &b), 2.0);
        assert_eq!((variance(&a), variance(&b)), (1.25, 3.5));
        let expected = 2.0 / (1.25_f64 * 3.5).sqrt();
        assert!((correlation(&a, &b).unwrap() - expected).abs() < 1e-15);
        assert_eq!(correlation(&a, &[1.0; 4]), None);
    }

    #[test]
    fn a_range_holds_the_extremes() {
        assert_eq!(range(&[2.0, -1.0, 5.0]), Some((-1.0, 5.0)));
        assert_eq!(range(&[]), None);
    }
}
