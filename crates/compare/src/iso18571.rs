//! An ISO 18571-style rating: corridor, phase, magnitude and slope of two evenly sampled signals, each 0 to 1.
//!
//! With T measured, C modelled, N samples and t = max |T|:
//!
//! Z   = mean of 1 where |C - T| ≤ 0.05 t, 0 where |C - T| > 0.5 t, else ((0.5 t - |C - T|) / (0.45 t))²
//! E_P = (0.2 N - n) / (0.2 N)     n: the shift of at most 0.2 N samples with the highest correlation
//! E_M = (0.5 - ε) / 0.5           ε = Σ|C - T| / Σ|T| along the time-warped path of the shifted signals
//! E_S = (2 - ε') / 2              ε' = Σ|C' - T'| / Σ|T'| of their derivatives, smoothed over nine samples
//! R   = 0.4 Z + 0.2 (E_P + E_M + E_S)
//!
//! Source of the equations and constants: ISO/TS 18571 as implemented by the public package `objective_rating_metrics`
//! (and its rewrite, github.com/yeonsoo-p/ISO18571); the grades are those in common use with it. The standard was not at
//! hand, it asks for signals at 10 kHz and was made for crash pulses; hence *-style*. Two choices are ours: correlations
//! within 1e-9 count as equal, so that the smaller shift wins (of equal ones, the later model); and ties between warping
//! paths go to the diagonal.

use crate::{align::Aligned, align::evenly, dtw::warping_path, statistics::correlation};

/// Half width of the inner corridor, as a share of the largest measured absolute value.
pub const INNER_CORRIDOR: f64 = 0.05;
/// Half width of the outer corridor, as a share of the largest measured absolute value.
pub const OUTER_CORRIDOR: f64 = 0.5;
/// Largest shift, as a share of the length.
pub const LARGEST_SHIFT: f64 = 0.2;
/// Half width of the warping window, as a share of the length that is left after the shift.
pub const WARPING_WINDOW: f64 = 0.1;
/// Relative error of magnitude that rates 0.
pub const MAGNITUDE_LIMIT: f64 = 0.5;
/// Relative error of slope that rates 0.
pub const SLOPE_LIMIT: f64 = 2.0;
/// Samples on either side that the smoothing of the slope takes in.
const SMOOTHING: usize = 4;
/// Fewest samples that can be rated: the smoothing has to fit into what a shift leaves.
pub const FEWEST: usize = 20;
/// Most samples that a recording is rated at; a longer one is thinned evenly.
pub const MOST: usize = 1000;

/// What a rating amounts to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Grade {
    /// Up to 0.58.
    Poor,
    /// Above 0.58.
    Fair,
    /// Above 0.80.
    Good,
    /// Above 0.94.
    Excellent,
}

impl Grade {
    /// The grade of an overall rating.
    pub fn of(overall: f64) -> Self {
        match overall {
            rating if rating > 0.94 => Self::Excellent,
            rating if rating > 0.80 => Self::Good,
            rating if rating > 0.58 => Self::Fair,
            _ => Self::Poor,
        }
    }
}

/// The rating and its parts, each 0 (worst) to 1.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct IsoRating {
    /// Z.
    pub corridor: f64,
    /// `E_P`.
    pub phase: f64,
    /// `E_M`.
    pub magnitude: f64,
    /// `E_S`.
    pub slope: f64,
    /// R.
    pub overall: f64,
    /// What R amounts to.
    pub grade: Grade,
    /// The shift that was found, as a share of the length; positive where the model is late.
    pub shift: f64,
}

/// Rates a model against evenly spaced measured samples.
///
/// `None` where the lengths differ, there are fewer than [`FEWEST`] samples, one is not finite, or the measured signal is
/// constant: what is nothing but zero slope has nothing to be rated against.
pub fn iso18571(measured: &[f64], modelled: &[f64]) -> Option<IsoRating> {
    let n = measured.len();
    let usable = n == modelled.len() && n >= FEWEST && measured.iter().chain(modelled).all(|v| v.is_finite());
    if !usable || measured.iter().all(|value| *value == measured[0]) {
        return None;
    }
    let corridor = corridor(measured, modelled);
    let late = best_shift(measured, modelled);
    let shift = late.unsigned_abs();
    let (t, c) = if late >= 0 {
        (&measured[..n - shift], &modelled[shift..])
    } else {
        (&measured[shift..], &modelled[..n - shift])
    };
    let phase = (1.0 - shift as f64 / (LARGEST_SHIFT * n as f64)).max(0.0);
    let magnitude = magnitude(t, c);
    let slope = rated(relative_difference(&slopes(t), &slopes(c)), SLOPE_LIMIT);
    let overall = 0.4 * corridor + 0.2 * (phase + magnitude + slope);
    let shift = late as f64 / n as f64;
    Some(IsoRating { corridor, phase, magnitude, slope, overall, grade: Grade::of(overall), shift })
}

/// Rates aligned pairs, resampled evenly to at most [`MOST`] samples.
pub(crate) fn rate_pairs(aligned: &Aligned) -> Option<IsoRating> {
    let (measured, modelled, _) = evenly(aligned, aligned.time_s.len().min(MOST))?;
    iso18571(&measured, &modelled)
}

fn corridor(t: &[f64], c: &[f64]) -> f64 {
    let largest = t.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    let (a, b) = (INNER_CORRIDOR * largest, OUTER_CORRIDOR * largest);
    let rate = |distance: f64| if distance <= a { 1.0 } else { ((b - distance).max(0.0) / (b - a)).powi(2) };
    t.iter().zip(c).map(|(t, c)| rate((c - t).abs())).sum::<f64>() / t.len() as f64
}

/// Samples by which the model is late, at the highest correlation of what overlaps.
fn best_shift(t: &[f64], c: &[f64]) -> isize {
    let n = t.len();
    let most = crate::statistics::floor_index(LARGEST_SHIFT * n as f64);
    let (mut best, mut at) = (correlation(t, c).unwrap_or(f64::NEG_INFINITY), 0);
    for shift in 1..=most {
        let late = correlation(&t[..n - shift], &c[shift..]);
        let early = correlation(&t[shift..], &c[..n - shift]);
        for (found, signed) in [(late, shift.cast_signed()), (early, -shift.cast_signed())] {
            if let Some(found) = found
                && found > best + 1e-9
            {
                (best, at) = (found, signed);
            }
        }
    }
    at
}

fn magnitude(t: &[f64], c: &[f64]) -> f64 {
    // The window counts the sample itself.
    let window = crate::statistics::floor_index((WARPING_WINDOW * t.len() as f64).ceil()).saturating_sub(1);
    let (t, c): (Vec<f64>, Vec<f64>) = warping_path(t, c, window).iter().map(|(i, j)| (t[*i], c[*j])).unzip();
    rated(relative_difference(&t, &c), MAGNITUDE_LIMIT)
}

/// Σ|C - T| / Σ|T|; infinite or zero where T is zero throughout.
fn relative_difference(t: &[f64], c: &[f64]) -> f64 {
    let difference: f64 = t.iter().zip(c).map(|(t, c)| (c - t).abs()).sum();
    if difference == 0.0 { 0.0 } else { difference / t.iter().map(|t| t.abs()).sum::<f64>() }
}

fn rated(error: f64, limit: f64) -> f64 {
    ((limit - error) / limit).max(0.0)
}

/// Differences per sample, central and one-sided at the ends, then the mean over nine samples, over fewer near the ends.
fn slopes(values: &[f64]) -> Vec<f64> {
    let last = values.len() - 1;
    let raw: Vec<f64> = (0..=last)
        .map(|at| {
            let (left, right) = (at.saturating_sub(1), (at + 1).min(last));
            (values[right] - values[left]) / (right - left) as f64
        })
        .collect();
    (0..=last)
        .map(|at| {
            let reach = SMOOTHING.min(at).min(last - at);
            raw[at - reach..=at + reach].iter().sum::<f64>() / (2 * reach + 1) as f64
        })
        .collect()
}

#[cfg(test)]
#[path = "iso18571_tests.rs"]
mod tests;
