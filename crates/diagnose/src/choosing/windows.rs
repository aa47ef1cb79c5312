//! Windows between the points of their grid: what sets in and ends at the same times of every run.
//!
//! A grid of eighths begins and ends seconds beside what is there, and beside a force that steps in and out each edge leaves more than any
//! other cause that is free to follow it; so a window is moved to where it belongs before causes are compared. What sets in above a speed
//! is as well: runs that are driven alike show the one as the other.

use crate::balances::balance::System;
use crate::causes::trial::{Pool, Trial, add_trial};
use crate::choosing::search::{Found, LEAST_GAIN};
use crate::choosing::sharpen::{How, judge, likeliest, moved};
use crate::choosing::state::{Part, State};
use crate::{Case, DiagnoseError};

/// Adds the likeliest window of each cause that has one, and the likeliest ramp, as it is by itself.
pub fn windows(case: &Case, system: &System, pool: &mut Pool) -> Result<(), DiagnoseError> {
    let state = State { case, system, pool, fit: &case.fit };
    let Some(first) = state.settle(&[], &system.noises(&system.residual, &case.fit)) else { return Ok(()) };
    let noises = state.quiet(&first);
    let likely =
        |state: &State, trial: &Trial| state.likely(&[Part { trial: trial.clone(), spread: None }], &noises);
    let nothing = state.likely(&[], &noises).unwrap_or(f64::INFINITY);
    let mut best: Vec<(usize, Vec<f64>, f64)> = Vec::new();
    let moves = |trial: &&Trial| {
        let cause = &case.causes[trial.cause];
        cause.window().is_some() || cause.ramp().is_some()
    };
    for trial in pool.trials.iter().filter(moves) {
        let Some(gain) = likely(&state, trial) else { continue };
        match best.iter_mut().find(|one| one.0 == trial.cause) {
            Some(one) if one.2 >= gain => {}
            Some(one) => (one.1, one.2) = (trial.shape.clone(), gain),
            None => best.push((trial.cause, trial.shape.clone(), gain)),
        }
    }
    for (cause, start, _) in best.into_iter().filter(|one| one.2 > nothing + LEAST_GAIN) {
        let at = |shape: &[f64]| likeliest(case, system, pool, (cause, shape), likely);
        let shape = moved(case, (cause, &start), at)?;
        if shape != start {
            add_trial(case, system, pool, cause, &shape)?;
        }
    }
    Ok(())
}

/// Adds a trial of a window that takes its time to set in and to end, where that makes the recordings more likely than chance would.
/// Whether there was any.
pub fn soften(
    case: &Case,
    system: &System,
    pool: &mut Pool,
    found: &Found,
    (cause, shape): (usize, &[f64]),
) -> Result<bool, DiagnoseError> {
    /// Where it is by now, at the noise that neighbouring rows show.
    const HOW: How = How::Quietly;
    /// From what a lever does to what a hydraulic hitch does when it lets down slowly [s].
    const RAMPS_S: [f64; 3] = [0.5, 1.5, 4.0];
    let Some(soft) = case.causes[cause].softened(&case.causes) else { return Ok(false) };
    let at_once = judge(case, system, pool, found, HOW, cause)(shape)?;
    let mut judged = judge(case, system, pool, found, HOW, soft);
    let mut best = (at_once + LEAST_GAIN, None);
    for ramp_s in RAMPS_S {
        let shape: Vec<f64> = shape.iter().copied().chain([ramp_s]).collect();
        let gain = judged(&shape)?;
        if gain > best.0 {
            best = (gain, Some(shape));
        }
    }
    let Some(shape) = best.1 else { return Ok(false) };
    let shape = moved(case, (soft, &shape), judged)?;
    add_trial(case, system, pool, soft, &shape)?;
    Ok(true)
}
