//! What a cause does at the size that was found, which is not always in proportion to it.

use crate::balances::balance::change;
use crate::balances::gram::Column;
use crate::causes::catalogue::{Cause, Form};
use crate::causes::trial::{Trial, for_run, mute, tried_on};
use crate::runs::recorded::Recorded;
use crate::runs::said::Said;
use crate::{Case, DiagnoseError, Kind, System};

/// A term smaller than this share of its usual size is as good as nothing: its column is made with this much.
const SMALLEST: f64 = 0.02;

/// Whether a cause is what its effect does with some values.
pub fn by_values(form: Form) -> bool {
    matches!(form, Form::Parameters | Form::Law)
}

/// A column for each term of a trial, made step by step: with the values found their sum is what the whole cause does, exactly.
/// `values` are in the order of the cause's terms. None where its effect refuses them.
pub fn signatures(
    case: &Case,
    system: &System,
    trial: &Trial,
    values: &[f64],
) -> Result<Option<Vec<Column>>, DiagnoseError> {
    let cause = &case.causes[trial.cause];
    let kinds: Vec<Kind> =
        system.kinds.iter().copied().filter(|kind| tried_on(cause, *kind, system)).collect();
    let mut at: Vec<f64> =
        cause.terms.iter().zip(values).map(|(term, value)| if term.linear { 0.0 } else { *value }).collect();
    let mut columns = Vec::new();
    let mut before: Option<Vec<Said>> = None;
    for term in &trial.terms {
        let smallest = SMALLEST * cause.terms[*term].scale;
        let value = values[*term];
        at[*term] = if value.abs() > smallest { value } else { smallest };
        let after = match say(case, cause, &at, &kinds) {
            Ok(after) => after,
            Err(DiagnoseError::Interrupted) => return Err(DiagnoseError::Interrupted),
            Err(_) => return Ok(None),
        };
        let earlier = before.as_deref().unwrap_or(&case.nominal);
        columns.push(system.column(|kind| {
            if !kinds.contains(&kind) {
                return vec![Vec::new(); case.runs.len()];
            }
            let of_run = |(run, (before, after)): (&Recorded, (&Said, &Said))| {
                change(kind, run, before, after).iter().map(|one| -one / at[*term]).collect()
            };
            let mut samples: Vec<Vec<f64>> =
                case.runs.iter().zip(earlier.iter().zip(&after)).map(of_run).collect();
            mute(cause, kind, system, &mut samples);
            samples
        }));
        before = Some(after);
    }
    Ok(Some(columns))
}

fn say(case: &Case, cause: &Cause, values: &[f64], kinds: &[Kind]) -> Result<Vec<Said>, DiagnoseError> {
    let text = |run: &Recorded| for_run(&cause.written(values), cause, run);
    case.said_with(&text, &case.study.priors(), kinds)
}
