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
mod tests {
    use super::*;
    use std::f64::consts::{PI, TAU};

    /// A smooth bump of 40 samples between zeros, `late` samples after its place.
    fn bump(late: usize) -> Vec<f64> {
        let shape = |step: usize| (0.5 - 0.5 * (TAU * step as f64 / 40.0).cos()).powi(2);
        (0..200)
            .map(|at| if (80 + late..120 + late).contains(&at) { shape(at - 80 - late) } else { 0.0 })
            .collect()
    }

    /// T is 0 in the first half and 1 in the second, C 20 % larger. Half of the samples are 0.2 apart:
    /// Z = (1 + (0.3/0.45)²) / 2 = 0.722222. No shift. ε = 0.2, so E_M = 0.6; ε' = 0.2, so E_S = 0.9.
    /// R = 0.4 · 0.722222 + 0.2 (1 + 0.6 + 0.9) = 0.788889: fair.
    #[test]
    fn a_step_that_is_a_fifth_too_high_is_worked_by_hand() {
        let t: Vec<f64> = (0..100).map(|at| if at < 50 { 0.0 } else { 1.0 }).collect();
        let c: Vec<f64> = t.iter().map(|t| 1.2 * t).collect();
        let rating = iso18571(&t, &c).unwrap();
        assert!((rating.corridor - 0.722_222).abs() < 1e-6, "{rating:?}");
        assert_eq!((rating.phase, rating.shift), (1.0, 0.0));
        assert!((rating.magnitude - 0.6).abs() < 1e-12, "{rating:?}");
        assert!((rating.slope - 0.9).abs() < 1e-12, "{rating:?}");
        assert!((rating.overall - 0.788_889).abs() < 1e-6);
        assert_eq!(rating.grade, Grade::Fair);
    }

    /// Ten of 200 samples late: E_P = (40 - 10) / 40, and once shifted, the signals are equal.
    #[test]
    fn a_delay_costs_phase_and_corridor_alone() {
        let (t, c) = (bump(0), bump(10));
        let late = iso18571(&t, &c).unwrap();
        assert!((late.phase - 0.75).abs() < 1e-12);
        assert_eq!((late.magnitude, late.slope, late.shift), (1.0, 1.0, 0.05));
        assert!(late.corridor < 1.0);
        assert_eq!(iso18571(&c, &t).unwrap().shift, -0.05);
    }

    #[test]
    fn a_delay_of_more_than_a_fifth_is_no_longer_followed() {
        let rating = iso18571(&bump(0), &bump(70)).unwrap();
        assert!(rating.phase == 1.0 || rating.phase < 0.01, "{rating:?}");
        assert_eq!(rating.magnitude, 0.0);
    }

    /// A slowing vehicle with a wobble, and a growing swing; the model of the first is late, that of the second early.
    /// Expected: what `objective_rating_metrics` 1.3 (Python) gave for the same 400 samples: corridor, phase, magnitude,
    /// slope, overall.
    #[test]
    fn ratings_agree_with_an_independent_implementation() {
        let sampled = |signal: fn(f64) -> f64| (0..400).map(|k| signal(f64::from(k))).collect::<Vec<f64>>();
        let agrees = |t: &[f64], c: &[f64], expected: [f64; 5]| {
            let rating = iso18571(t, c).unwrap();
            let found = [rating.corridor, rating.phase, rating.magnitude, rating.slope, rating.overall];
            assert!(
                found.iter().zip(expected).all(|(found, e)| (found - e).abs() < 1e-9),
                "{found:?} {expected:?}"
            );
            rating
        };
        let late = agrees(
            &sampled(|k| 8.0 * (-k / 300.0).exp() + 0.5 * (k / 17.0).sin()),
            &sampled(|k| 8.4 * (-k / 260.0).exp() + 0.6 * ((k - 7.0) / 17.0).sin()),
            [0.993_153_861_569, 0.9125, 0.954_552_455_306, 0.910_234_887_7, 0.952_719_013_229],
        );
        assert_eq!((late.shift, late.grade), (7.0 / 400.0, Grade::Excellent));
        let early = agrees(
            &sampled(|k| (k / 25.0).sin() * (1.0 + k / 200.0)),
            &sampled(|k| 1.15 * ((k + 12.0) / 25.5).sin() * (1.0 + k / 230.0) - 0.1),
            [0.638_505_487_462, 0.9125, 0.958_865_638_241, 0.959_153_057_866, 0.821_505_934_206],
        );
        assert_eq!((early.shift, early.grade), (-7.0 / 400.0, Grade::Good));
    }

    /// The nine-sample mean of a straight line's slope is its slope, ends included.
    #[test]
    fn slopes_of_a_line_are_its_slope() {
        let line: Vec<f64> = (0..30).map(|at| 3.0 - 0.5 * f64::from(at)).collect();
        assert!(slopes(&line).iter().all(|slope| (slope + 0.5).abs() < 1e-12));
    }

    /// A unit step between samples 49 and 50: central differences of a half on both, so the smoothed slope is 1/18 where
    /// nine samples hold one of them and 1/9 where they hold both.
    #[test]
    fn a_step_is_smoothed_over_nine_samples() {
        let t: Vec<f64> = (0..100).map(|at| if at < 50 { 0.0 } else { 1.0 }).collect();
        let found = slopes(&t);
        for (at, expected) in
            [(44, 0.0), (45, 1.0 / 18.0), (46, 1.0 / 9.0), (53, 1.0 / 9.0), (54, 1.0 / 18.0), (55, 0.0)]
        {
            assert!((found[at] - expected).abs() < 1e-15, "{at}: {}", found[at]);
        }
    }

    #[test]
    fn equal_signals_are_excellent_and_opposite_ones_poor() {
        let t: Vec<f64> = (0..100).map(|at| (PI * f64::from(at) / 50.0).sin() + 0.2).collect();
        let same = iso18571(&t, &t).unwrap();
        assert_eq!((same.overall, same.grade), (1.0, Grade::Excellent));
        let opposite: Vec<f64> = t.iter().map(|t| -t).collect();
        assert_eq!(iso18571(&t, &opposite).unwrap().grade, Grade::Poor);
    }

    #[test]
    fn what_cannot_be_rated_is_not() {
        assert_eq!(iso18571(&[1.0; 50], &bump(0)[..50]), None);
        assert_eq!(iso18571(&bump(0), &bump(0)[1..]), None);
        assert_eq!(iso18571(&[0.0, 1.0, 2.0], &[0.0, 1.0, 2.0]), None);
        let mut holed = bump(0);
        holed[3] = f64::NAN;
        assert_eq!(iso18571(&bump(0), &holed), None);
    }
}
