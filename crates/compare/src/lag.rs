//! By how much a model is late: the shift in time with the highest correlation.

use crate::{align::Aligned, align::evenly, statistics::correlation};

/// Largest delay that is looked for (s).
pub const LARGEST_S: f64 = 10.0;
/// Largest delay that is looked for, as a share of the length.
const LARGEST_SHARE: f64 = 0.2;
/// Most samples that are shifted against each other; a longer recording is thinned evenly.
const MOST: usize = 10_000;

/// A delay, and what it would gain.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Lag {
    /// Positive where the model is late (s).
    pub lag_s: f64,
    /// Correlation once the delay is taken out.
    pub correlation: f64,
    /// Correlation as it is.
    pub correlation_without: f64,
    /// Whether the delay is the largest that was looked for, so that the true one may be larger.
    pub at_limit: bool,
}

/// The delay of a model, up to [`LARGEST_S`] or a fifth of the recording, refined between samples by the parabola through
/// the best correlation and its neighbours.
///
/// `None` where either signal is constant or there are fewer than ten pairs.
pub fn cross_correlation_lag(aligned: &Aligned) -> Option<Lag> {
    let (y, m, step_s) = evenly(aligned, aligned.time_s.len().min(MOST))?;
    if y.len() < 10 || step_s <= 0.0 {
        return None;
    }
    let n = y.len();
    let most = crate::statistics::floor_index((LARGEST_S / step_s).min(LARGEST_SHARE * n as f64)).max(1);
    let at = |late: isize| {
        let shift = late.unsigned_abs();
        let (y, m) = if late >= 0 { (&y[..n - shift], &m[shift..]) } else { (&y[shift..], &m[..n - shift]) };
        correlation(y, m)
    };
    let correlation_without = at(0)?;
    let (mut best, mut late) = (correlation_without, 0);
    for shift in 1..=most.cast_signed() {
        for signed in [shift, -shift] {
            if let Some(found) = at(signed)
                && found > best + 1e-9
            {
                (best, late) = (found, signed);
            }
        }
    }
    let at_limit = late.unsigned_abs() == most;
    let mut fraction = 0.0;
    if !at_limit && let (Some(before), Some(after)) = (at(late - 1), at(late + 1)) {
        let curvature = before - 2.0 * best + after;
        if curvature < -1e-12 {
            fraction = (0.5 * (before - after) / curvature).clamp(-0.5, 0.5);
        }
    }
    Some(Lag { lag_s: (late as f64 + fraction) * step_s, correlation: best, correlation_without, at_limit })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::align::Dropped;

    fn pulse(late_s: f64) -> Aligned {
        let time_s: Vec<f64> = (0..400).map(|step| 0.1 * f64::from(step)).collect();
        let bell = |at: f64| (-((at - 20.0) / 2.0_f64).powi(2)).exp();
        Aligned {
            measured: time_s.iter().map(|t| bell(*t)).collect(),
            modelled: time_s.iter().map(|t| 3.0 * bell(t - late_s) + 1.0).collect(),
            time_s,
            dropped: Dropped::default(),
        }
    }

    #[test]
    fn a_known_delay_is_found_between_samples_whatever_the_scale() {
        for late_s in [0.0, 0.5, -1.2, 0.53, -0.26] {
            let lag = cross_correlation_lag(&pulse(late_s)).unwrap();
            assert!((lag.lag_s - late_s).abs() < 2e-3, "{late_s}: {lag:?}");
            assert!(lag.correlation > 0.999 && !lag.at_limit);
        }
    }

    #[test]
    fn a_delay_beyond_the_search_is_said_to_be() {
        assert!(cross_correlation_lag(&pulse(9.5)).unwrap().at_limit);
        let mut flat = pulse(0.0);
        flat.modelled = vec![1.0; 400];
        assert_eq!(cross_correlation_lag(&flat), None);
    }
}
