//! Intervals of shares, and correlation.

/// Share and its 95 % interval: E. B. Wilson, *Journal of the American Statistical Association* 22 (1927) 209.
pub fn wilson(hits: usize, trials: usize) -> (f64, f64, f64) {
    /// 97.5 % quantile of the normal distribution.
    const Z: f64 = 1.959_963_984_540_054;
    if trials == 0 {
        return (f64::NAN, 0.0, 1.0);
    }
    let (n, share) = (trials as f64, hits as f64 / trials as f64);
    let widened = 1.0 + Z * Z / n;
    let middle = (share + Z * Z / (2.0 * n)) / widened;
    let half = Z / widened * (share * (1.0 - share) / n + Z * Z / (4.0 * n * n)).sqrt();
    (share, (middle - half).max(0.0), (middle + half).min(1.0))
}

/// Pearson's correlation; NaN where one side does not vary.
pub fn correlation(left: &[f64], right: &[f64]) -> f64 {
    let n = left.len() as f64;
    let (mean_left, mean_right) = (left.iter().sum::<f64>() / n, right.iter().sum::<f64>() / n);
    let (mut both, mut of_left, mut of_right) = (0.0, 0.0, 0.0);
    for (l, r) in left.iter().zip(right) {
        let (l, r) = (l - mean_left, r - mean_right);
        both += l * r;
        of_left += l * l;
        of_right += r * r;
    }
    both / (of_left * of_right).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 9 of 10: 0.596 to 0.982 (by hand: centre (0.9 + 0.192)/1.384, half width 1.96/1.384 √(0.009 + 0.0096)).
    #[test]
    fn the_interval_of_nine_in_ten() {
        let (share, low, high) = wilson(9, 10);
        assert!((share - 0.9).abs() < 1e-12 && (low - 0.5958).abs() < 1e-3 && (high - 0.9821).abs() < 1e-3);
        assert!(wilson(0, 60).2 < 0.061 && wilson(0, 60).1 == 0.0);
    }

    #[test]
    fn a_line_correlates_fully_and_a_constant_not_at_all() {
        assert!((correlation(&[1.0, 2.0, 4.0], &[-1.0, -2.0, -4.0]) + 1.0).abs() < 1e-12);
        assert!((correlation(&[1.0, 2.0, 4.0], &[3.0, 5.0, 9.0]) - 1.0).abs() < 1e-12);
        assert!(correlation(&[1.0, 2.0], &[3.0, 3.0]).is_nan());
    }
}
