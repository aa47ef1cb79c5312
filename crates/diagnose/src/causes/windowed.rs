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
    let (None, [_, _], Some([from_s, to_s])) = (&cause.own, shape, cause.window_s(shape)) else {
        return Ok(None);
    };
    let text = cause.written(&throughout(cause, term, step));
    let mut throughout = shown(case, system, cause, step, &|_| text.clone())?;
    for samples in throughout.iter_mut().map(|(_, samples)| samples) {
        for (samples, run) in samples.iter_mut().zip(&case.runs) {
            for (sample, time_s) in samples.iter_mut().zip(run.measured.trace.time_s()) {
                *sample *= f64::from(u8::from((from_s..to_s).contains(time_s)));
            }
        }
    }
    Ok(Some(case.column(system, &throughout)))
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
