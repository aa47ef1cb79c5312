//! What the recordings by themselves do not ask for, and yet foresees runs that it never saw. Where a model is far off, what
//! it lacks passes for a force that wanders, and nothing seems to be missing; a set of causes that wanders as far says no
//! more about the runs that it was made of. Of a run that it was not made of it says all the more:
//! every fitted run is left out once and foreseen by the others. Runs that are held out have no part in the choice.

use crate::causes::trial::Pool;
use crate::choosing::search::{Found, worth};
use crate::choosing::state::{Stand, State};
use crate::proof::proven::Proven;
use crate::single_runs::events::Event;
use crate::soundness::faults::Fault;
use crate::{Case, DiagnoseError, System};

/// Error over the noise of the sensor above which something is missing, whatever the recordings ask for.
const LACKS: f64 = 6.0;
/// What foresees runs leaves less than this share of their mean squares in some balance, beyond those of neighbouring rows,
const FORESEEN: f64 = 0.3;
/// where these are not nearly all there is,
const LOUD: f64 = 1.2;
/// and none becomes worse than by rounding.
const WORSE: f64 = 1.01;
/// So many sets get the chance.
const MOST: usize = 4;

/// What was found; where that is nothing and leaves much, the set of causes with which the fitted runs foresee each other best.
pub fn foreseen(
    case: &Case,
    system: &System,
    pool: &mut Pool,
    proven: Proven,
    events: &[Event],
    faults: &[Fault],
) -> Result<Proven, DiagnoseError> {
    let nothing = proven.refined.causes.is_empty() && proven.withheld.is_none() && faults.is_empty();
    let (noise, left) = (proven.proof.noise, proven.proof.fitted.after);
    if !nothing || left.is_nan() || left <= LACKS * noise {
        return Ok(proven);
    }
    case.step("what foresees other runs")?;
    let state = State { case, system, pool, fit: &case.fit };
    let Some(set) = best(&state, &proven.found) else { return Ok(proven) };
    let other = Proven::of(case, system, pool, set, events, None)?;
    // Those that are held out may forbid it, as they may any claim.
    let forbidden = other.withheld.is_some() || other.is_worse_than(&proven);
    Ok(if forbidden { proven } else { other })
}

/// The set that foresees best, where it foresees far better than nothing.
fn best(state: &State, found: &Found) -> Option<Found> {
    let noises = &found.first.noises;
    let before = state.foretold(&[], noises)?;
    let mut sets = state.together(&found.stand, &[], false);
    sets.sort_by(|one, other| worth(other).total_cmp(&worth(one)));
    // What neighbouring rows differ by nobody foresees.
    let quiet: Vec<f64> = state.quiet(&found.first).each.iter().map(|noise| noise.sd().powi(2)).collect();
    let share = |stand: &Stand| -> Option<f64> {
        let after = state.foretold(&stand.parts, &stand.noises)?;
        let of = |((after, before), quiet): ((&f64, &f64), &f64)| {
            (*before > LOUD * quiet).then(|| (after - quiet).max(0.0) / (before - quiet))
        };
        let least = after.iter().zip(&before).zip(&quiet).filter_map(of).fold(f64::INFINITY, f64::min);
        let worse = after.iter().zip(&before).any(|(after, before)| *after > WORSE * before);
        (!worse && least < FORESEEN).then_some(least)
    };
    let shares = sets.into_iter().take(MOST).filter_map(|set| Some((share(&set)?, set)));
    let (_, stand) = shares.min_by(|one, other| one.0.total_cmp(&other.0))?;
    let told = (found.tried.clone(), found.unproven.clone());
    Some(state.found(stand, found.first.clone(), told, found.needed))
}
