//! How well a shape is known: a threshold, a width, a time constant, in which a cause is not linear.
//!
//! By the curvature of ln p where the shape was found, everything linear free; and what is in proportion to the cause moves
//! with the shape, so its interval is wider by as much.
//! Source: Bates and Watts, *Nonlinear Regression Analysis and Its Applications* (1988), section 6.1, here by differences.

use crate::catalogue::Form;
use crate::search::{Accepted, Found};
use crate::state::{Part, State};
use crate::trial::{Pool, add_trial};
use crate::{Case, DiagnoseError, System};

/// What is known of the parameters of an accepted cause beyond the linear estimate: standard deviations, term by term.
pub type Widths = Vec<f64>;

/// Factor by which a shape is moved.
const FACTOR: f64 = 1.05;
/// A shape of which the recordings say nothing is known by this share of itself: its grid is spaced like that.
const UNKNOWN: f64 = 0.5;

/// The widths of every accepted cause; zero for what is linear and does not move with a shape.
pub fn widths(
    case: &Case,
    system: &System,
    pool: &mut Pool,
    found: &Found,
) -> Result<Vec<Widths>, DiagnoseError> {
    found.accepted.iter().map(|accepted| of_one(case, system, pool, found, accepted)).collect()
}

fn of_one(
    case: &Case,
    system: &System,
    pool: &mut Pool,
    found: &Found,
    accepted: &Accepted,
) -> Result<Widths, DiagnoseError> {
    let cause = &case.causes[accepted.trial.cause];
    let mut widths = vec![0.0; cause.terms.len()];
    let place = found.stand.parts.iter().position(|part| part.trial.columns == accepted.trial.columns);
    let (Some(place), Form::Parameters) = (place, cause.form) else { return Ok(widths) };
    let shapes: Vec<usize> = (0..cause.terms.len()).filter(|term| !cause.terms[*term].linear).collect();
    for (number, term) in shapes.into_iter().enumerate() {
        let value = accepted.trial.shape.get(number).copied().unwrap_or(0.0);
        if value == 0.0 || cause.terms[term].low >= cause.terms[term].high {
            continue;
        }
        let mut at = |factor: f64| -> Result<Option<(f64, Vec<f64>)>, DiagnoseError> {
            let mut shape = accepted.trial.shape.clone();
            shape[number] *= factor;
            if !cause.possible(&shape) {
                return Ok(None);
            }
            weighed(case, system, pool, found, (place, &shape))
        };
        let (low, middle, high) = (at(1.0 / FACTOR)?, at(1.0)?, at(FACTOR)?);
        let (Some(low), Some(middle), Some(high)) = (low, middle, high) else {
            widths[term] = UNKNOWN * value.abs();
            continue;
        };
        let step = FACTOR.ln();
        let curvature = (2.0 * middle.0 - low.0 - high.0) / (step * step);
        let share = if curvature > 0.0 { curvature.sqrt().recip().min(UNKNOWN) } else { UNKNOWN };
        widths[term] = share * value.abs();
        for (column, linear) in accepted.trial.terms.iter().enumerate() {
            let moves = (high.1[column] - low.1[column]) / (2.0 * step);
            widths[*linear] = widths[*linear].hypot(share * moves);
        }
    }
    Ok(widths)
}

/// ln p and the values of a part with another shape, beside the other parts at the noise that was found.
fn weighed(
    case: &Case,
    system: &System,
    pool: &mut Pool,
    found: &Found,
    (place, shape): (usize, &[f64]),
) -> Result<Option<(f64, Vec<f64>)>, DiagnoseError> {
    let (columns, trials) = (pool.columns.len(), pool.trials.len());
    let own = &found.stand.parts[place].trial;
    add_trial(case, system, pool, own.cause, shape)?;
    let state = State { case, system, pool, fit: &case.fit };
    let moved = pool.trials[trials..].iter().find(|trial| trial.terms == own.terms);
    let told = moved.and_then(|trial| {
        let mut parts = found.stand.parts.clone();
        parts[place] = Part { trial: trial.clone(), spread: None };
        let (score, beta) = state.weighed(&parts, &found.noises.1)?;
        let used = state.columns(&parts);
        let value = |column: &usize| {
            used.iter().position(|used| used == column).map_or(0.0, |position| beta[position])
        };
        Some((score, trial.columns.iter().map(value).collect()))
    });
    pool.truncate(columns, trials);
    Ok(told)
}
