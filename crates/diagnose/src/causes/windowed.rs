//! Causes that work between two times. Sample by sample such a cause does within its window what it would do there throughout,
//! and nothing outside, so that the model is driven with it once for all windows.

use crate::balances::balance::System;
use crate::balances::gram::Column;
use crate::causes::catalogue::{Cause, Term};
use crate::causes::trial::shown;
use crate::{Case, DiagnoseError};

/// A time that no recording reaches [s].
const NEVER_S: f64 = 1e12;

/// What a term of a cause does to the rows in its window, per step of it; none where it has no window of its own.
pub fn in_window(
    case: &Case,
    system: &System,
    cause: &Cause,
    (term, step): (usize, f64),
    shape: &[f64],
) -> Result<Option<Column>, DiagnoseError> {
    let ramp_s = cause.ramp_s(shape);
    let shaped = 2 + usize::from(ramp_s.is_some());
    let (None, Some(window_s)) = (&cause.own, cause.window_s(shape).filter(|_| shape.len() == shaped)) else {
        return Ok(None);
    };
    let text = cause.written(&throughout(cause, term, step));
    let mut throughout = shown(case, system, cause, step, &|_| text.clone())?;
    for samples in throughout.iter_mut().map(|(_, samples)| samples) {
        for (samples, run) in samples.iter_mut().zip(&case.runs) {
            let shares = shares(run.measured.trace.time_s(), window_s, ramp_s.unwrap_or(0.0));
            for (sample, share) in samples.iter_mut().zip(shares) {
                *sample *= share;
            }
        }
    }
    Ok(Some(case.column(system, &throughout)))
}

/// How much of what each sample stands for lies within a window, from half way to the sample before to half way to the next: what
/// begins between two samples leaves an impulse that either of them alone would miss by up to half of what it does in that time.
fn shares(time_s: &[f64], [from_s, to_s]: [f64; 2], ramp_s: f64) -> impl Iterator<Item = f64> {
    let between_s = |index: usize| 0.5 * (time_s[index] + time_s[index + 1]);
    let until_s = move |at_s: f64| ramped_s(at_s - from_s, ramp_s) - ramped_s(at_s - to_s, ramp_s);
    let of = move |index: usize| {
        let begins_s = index.checked_sub(1).map_or(time_s[index], between_s);
        let ends_s = if index + 1 < time_s.len() { between_s(index) } else { time_s[index] };
        let within_s = until_s(ends_s) - until_s(begins_s);
        if ends_s > begins_s { within_s / (ends_s - begins_s) } else { 0.0 }
    };
    (0..time_s.len()).map(of)
}

/// What goes straight from 0 to 1 within so long about nought, summed up until so long after that [s].
fn ramped_s(after_s: f64, ramp_s: f64) -> f64 {
    let half_s = 0.5 * ramp_s;
    if after_s.abs() < half_s { (after_s + half_s).powi(2) / (2.0 * ramp_s) } else { after_s.max(0.0) }
}

/// The values of a cause of which one term acts from ever to ever.
fn throughout(cause: &Cause, term: usize, step: f64) -> Vec<f64> {
    let value = |(place, one): (usize, &Term)| match one.name {
        "from_s" => -NEVER_S,
        "to_s" => NEVER_S,
        _ if place == term => step,
        _ => 0.0,
    };
    cause.terms.iter().enumerate().map(value).collect()
}

#[cfg(test)]
mod tests {
    use super::shares;

    /// Σ share × spacing is the length of the window, wherever it begins and ends between the samples and however long that takes.
    #[test]
    fn what_is_within_a_window_is_as_long_as_the_window() {
        const STEP_S: f64 = 0.5;
        let time_s: Vec<f64> = (0..40).map(|index| f64::from(index) * STEP_S).collect();
        for (from_s, to_s) in [(3.0, 9.0), (3.1, 9.2), (3.24, 9.49), (5.05, 5.15)] {
            for ramp_s in [0.0, 0.3, 4.0] {
                let length_s: f64 = shares(&time_s, [from_s, to_s], ramp_s).map(|share| share * STEP_S).sum();
                assert!((length_s - (to_s - from_s)).abs() < 1e-12, "{from_s} to {to_s}: {length_s}");
            }
        }
    }
}
