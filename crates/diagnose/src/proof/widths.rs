//! How well a shape is known: a threshold, a width, a time constant, in which a cause is not linear, or a constant of a law.
//!
//! By the curvature of ln p where the shape was found, everything linear free; and what is in proportion to the cause moves
//! with the shape, and so do the free parameters: their intervals are wider by as much.
//! Source: Bates and Watts, *Nonlinear Regression Analysis and Its Applications* (1988), section 6.1, here by differences.

use crate::causes::catalogue::{Cause, Form, LawText};
use crate::causes::trial::{Pool, Trial, add_trial, effect};
use crate::choosing::search::{Accepted, Found};
use crate::choosing::state::{Part, State};
use crate::{Case, DiagnoseError, System};

/// What is known of the parameters of an accepted cause beyond the linear estimate: standard deviations, term by term.
pub type Widths = Vec<f64>;

/// What is known of everything that was found beyond the linear estimate.
pub struct Beyond {
    /// Of every accepted cause.
    pub causes: Vec<Widths>,
    /// Of every free parameter, as standard deviations.
    pub free: Vec<f64>,
}

/// What everything linear comes to beside a part with another shape.
struct Weighed {
    /// ln p.
    score: f64,
    /// Values of the part.
    own: Vec<f64>,
    /// Values of the free parameters.
    free: Vec<f64>,
}

/// Factor by which a shape is moved.
const FACTOR: f64 = 1.05;
/// What sets in or ends at a time.
const EDGES: [&str; 2] = ["from_s", "to_s"];
/// Standard deviation of how late a logger shows a speed by its own filter [s]: receivers and filters of a bus delay by up to a tenth of a
/// second, and none says by how much.
pub const FILTER_SD_S: f64 = 0.04;
/// A shape of which the recordings say nothing is known by this share of itself: its grid is spaced like that.
const UNKNOWN: f64 = 0.5;

/// The widths of everything that was found; zero for what is linear and does not move with a shape.
pub fn widths(case: &Case, system: &System, pool: &mut Pool, found: &Found) -> Result<Beyond, DiagnoseError> {
    let mut beyond = Beyond { causes: Vec::new(), free: vec![0.0; case.study.parameters.len()] };
    for accepted in &found.accepted {
        let widths = of_one(case, system, pool, found, (accepted, &mut beyond.free))?;
        beyond.causes.push(widths);
    }
    Ok(beyond)
}

fn of_one(
    case: &Case,
    system: &System,
    pool: &mut Pool,
    found: &Found,
    (accepted, free): (&Accepted, &mut [f64]),
) -> Result<Widths, DiagnoseError> {
    let cause = &case.causes[accepted.trial.cause];
    let mut widths = vec![0.0; cause.terms.len()];
    let place = found.stand.parts.iter().position(|part| part.trial.columns == accepted.trial.columns);
    let Some(place) = place else { return Ok(widths) };
    if let Some(law) = &cause.law {
        of_law(case, system, pool, found, (place, law, free))?;
    }
    if cause.form != Form::Parameters {
        return Ok(widths);
    }
    let shapes: Vec<usize> = (0..cause.terms.len()).filter(|term| !cause.terms[*term].linear).collect();
    for (number, term) in shapes.into_iter().enumerate() {
        let value = accepted.trial.shape.get(number).copied().unwrap_or(0.0);
        if value == 0.0 || cause.terms[term].is_held() {
            continue;
        }
        let mut at = |factor: f64| -> Result<Option<Weighed>, DiagnoseError> {
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
        let curvature = (2.0 * middle.score - low.score - high.score) / (step * step);
        let share = if curvature > 0.0 { curvature.sqrt().recip().min(UNKNOWN) } else { UNKNOWN };
        widths[term] = share * value.abs();
        // What a filter delays began earlier than it shows.
        if EDGES.contains(&cause.terms[term].name) {
            widths[term] = widths[term].hypot(FILTER_SD_S);
        }
        for (column, linear) in accepted.trial.terms.iter().enumerate() {
            let moves = (high.own[column] - low.own[column]) / (2.0 * step);
            widths[*linear] = widths[*linear].hypot(share * moves);
        }
        widen(free, (&low, &high), share / (2.0 * step));
    }
    Ok(widths)
}

/// Widens what is known of the free parameters by as much of the way from one estimate to another.
fn widen(free: &mut [f64], (low, high): (&Weighed, &Weighed), share: f64) {
    for (width, (low, high)) in free.iter_mut().zip(low.free.iter().zip(&high.free)) {
        *width = width.hypot(share * (high - low));
    }
}

/// What the constants of a law leave open of the free parameters: each is moved by what its search knows of it.
fn of_law(
    case: &Case,
    system: &System,
    pool: &mut Pool,
    found: &Found,
    (place, law, free): (usize, &LawText, &mut [f64]),
) -> Result<(), DiagnoseError> {
    /// A constant is known to no less than so many times what its search says.
    const MOST: f64 = 3.0;
    let own = &found.stand.parts[place].trial;
    let cause = &case.causes[own.cause];
    let drawn = |law: LawText| {
        let cause = Cause { law: Some(law), ..cause.clone() };
        effect(case, system, &cause, 1.0, &|_| cause.written(&[1.0]))
    };
    let middle_column = drawn(law.clone())?;
    let Some(middle) = beside(case, system, pool, found, (place, own)) else { return Ok(()) };
    for (number, constant) in law.constants.iter().enumerate() {
        let Some(sd) = constant.sd.filter(|sd| sd.is_finite() && *sd > 0.0) else { continue };
        let mut at = |sign: f64| -> Result<Option<Weighed>, DiagnoseError> {
            let mut moved = law.clone();
            moved.constants[number].value += sign * sd;
            moved.constants_text = headland_symbolic::constants_text(&moved.constants);
            // As the search drew it, and by how much a run of it changes.
            let mut column = pool.columns[own.columns[0]].clone();
            for (own, (moved, middle)) in column.iter_mut().zip(drawn(moved)?.iter().zip(&middle_column)) {
                *own += moved - middle;
            }
            let (columns, trials) = (pool.columns.len(), pool.trials.len());
            pool.columns.push(column);
            pool.sd.push(pool.sd[own.columns[0]]);
            let trial = Trial { columns: vec![columns], ..own.clone() };
            let told = beside(case, system, pool, found, (place, &trial));
            pool.truncate(columns, trials);
            Ok(told)
        };
        let (Some(low), Some(high)) = (at(-1.0)?, at(1.0)?) else { continue };
        let curvature = 2.0 * middle.score - low.score - high.score;
        let share = if curvature > 0.0 { curvature.sqrt().recip().min(MOST) } else { MOST };
        widen(free, (&low, &high), 0.5 * share);
    }
    Ok(())
}

/// ln p and the values of a part with another shape, beside the other parts at the noise that was found.
fn weighed(
    case: &Case,
    system: &System,
    pool: &mut Pool,
    found: &Found,
    (place, shape): (usize, &[f64]),
) -> Result<Option<Weighed>, DiagnoseError> {
    let (columns, trials) = (pool.columns.len(), pool.trials.len());
    let own = &found.stand.parts[place].trial;
    add_trial(case, system, pool, own.cause, shape)?;
    let moved = pool.trials[trials..].iter().find(|trial| trial.terms == own.terms).cloned();
    let told = moved.and_then(|trial| beside(case, system, pool, found, (place, &trial)));
    pool.truncate(columns, trials);
    Ok(told)
}

/// ln p and the values of everything linear with another trial in the place of a part.
fn beside(
    case: &Case,
    system: &System,
    pool: &Pool,
    found: &Found,
    (place, trial): (usize, &Trial),
) -> Option<Weighed> {
    let state = State { case, system, pool, fit: &case.fit };
    let mut parts = found.stand.parts.clone();
    parts[place] = Part { trial: trial.clone(), spread: None };
    let (score, beta) = state.weighed(&parts, &found.noises.1)?;
    let used = state.columns(&parts);
    let value =
        |column: &usize| used.iter().position(|used| used == column).map_or(0.0, |position| beta[position]);
    let free = (0..case.study.parameters.len()).map(|column| value(&column)).collect();
    Some(Weighed { score, own: trial.columns.iter().map(value).collect(), free })
}
