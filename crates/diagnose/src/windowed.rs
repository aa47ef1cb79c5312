//! Causes that work between two times. Sample by sample such a cause does within its window what it would do there throughout,
//! and nothing outside, so that the model is driven with it once for all windows.

use crate::balance::System;
use crate::catalogue::Cause;
use crate::gram::Column;
use crate::trial::{Shown, shown};
use crate::{Case, DiagnoseError};
use std::sync::Arc;

/// A time that no recording reaches [s].
const NEVER_S: f64 = 1e12;

/// What causes with windows do throughout, per unit of each of their terms.
#[derive(Clone, Default)]
pub struct Throughout(Vec<((usize, usize), Arc<Shown>)>);

impl Throughout {
    /// What a term of a cause does to the rows in its window, per step of it; none where it has no window of its own.
    pub fn column(
        &mut self,
        (case, system): (&Case, &System),
        (number, term, step): (usize, usize, f64),
        shape: &[f64],
    ) -> Result<Option<Column>, DiagnoseError> {
        let cause = &case.causes[number];
        let (None, Some((from, to))) = (&cause.own, cause.window()) else { return Ok(None) };
        let held: Vec<usize> = (0..cause.terms.len()).filter(|place| !cause.terms[*place].linear).collect();
        let ([first, second], [one, other]) = (held.as_slice(), shape) else { return Ok(None) };
        let (from_s, to_s) = if (*first, *second) == (from, to) { (*one, *other) } else { (*other, *one) };
        let throughout = self.of(case, system, (number, term, step))?;
        Ok(Some(system.column(|kind| {
            let known = throughout.iter().find(|(own, _)| *own == kind);
            let mut samples = known.map_or_else(|| vec![Vec::new(); case.runs.len()], |(_, all)| all.clone());
            for (samples, run) in samples.iter_mut().zip(&case.runs) {
                for (sample, time_s) in samples.iter_mut().zip(run.measured.trace.time_s()) {
                    *sample *= f64::from(u8::from((from_s..to_s).contains(time_s)));
                }
            }
            samples
        })))
    }

    fn of(
        &mut self,
        case: &Case,
        system: &System,
        (number, term, step): (usize, usize, f64),
    ) -> Result<Arc<Shown>, DiagnoseError> {
        if let Some((_, known)) = self.0.iter().find(|(own, _)| *own == (number, term)) {
            return Ok(Arc::clone(known));
        }
        let cause = &case.causes[number];
        let text = cause.written(&throughout(cause, term, step));
        let found = Arc::new(shown(case, system, cause, step, &|_| text.clone())?);
        self.0.push(((number, term), Arc::clone(&found)));
        Ok(found)
    }
}

/// The values of a cause of which one term acts from ever to ever.
fn throughout(cause: &Cause, term: usize, step: f64) -> Vec<f64> {
    let value = |(place, one): (usize, &crate::catalogue::Term)| match one.name {
        "from_s" => -NEVER_S,
        "to_s" => NEVER_S,
        _ if place == term => step,
        _ => 0.0,
    };
    cause.terms.iter().enumerate().map(value).collect()
}
