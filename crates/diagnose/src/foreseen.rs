//! What the recordings by themselves do not ask for, and yet foresees runs that it never saw. Where a model is far off, what
//! it lacks passes for a force that wanders, and nothing seems to be missing; a set of causes that wanders as far says no
//! more about the runs that it was made of. Of those held out it says all the more.

use crate::events::Event;
use crate::faults::Fault;
use crate::search::worth;
use crate::state::{Stand, State};
use crate::trial::Pool;
use crate::withdraw::Proven;
use crate::{Case, DiagnoseError, System};

/// Error over the noise of the sensor above which something is missing, whatever the recordings ask for.
const LACKS: f64 = 8.0;
/// What foresees runs leaves less than this share of their error.
const FORESEEN: f64 = 0.4;
/// So many sets get the chance.
const MOST: usize = 4;

/// What was found; where that is nothing and leaves much, a set of causes with which runs held out are foreseen.
pub fn foreseen(
    case: &Case,
    system: &System,
    pool: &mut Pool,
    proven: Proven,
    events: &[Event],
    faults: &[Fault],
) -> Result<Proven, DiagnoseError> {
    let nothing = proven.refined.causes.is_empty() && proven.withheld.is_none() && faults.is_empty();
    let (noise, fitted) = (proven.proof.noise, proven.proof.fitted.after);
    let Some(left) = proven.proof.held_out.as_ref().map(|errors| errors.after).filter(|_| nothing) else {
        return Ok(proven);
    };
    if !(left > LACKS * noise && fitted > LACKS * noise) {
        return Ok(proven);
    }
    case.step("what foresees other runs")?;
    let found = &proven.found;
    let state = State { case, system, pool, fit: &case.fit };
    let mut sets = state.together(&found.stand, &[]);
    sets.sort_by(|one, other| worth(other).total_cmp(&worth(one)));
    let told = |stand: Stand| {
        let told = (found.tried.clone(), found.unproven.clone());
        state.found(stand, found.first.clone(), told, found.needed)
    };
    let sets: Vec<_> = sets.into_iter().take(MOST).map(told).collect();
    let mut best: Option<(f64, Proven)> = None;
    for found in sets {
        let other = Proven::of(case, system, pool, found, events, None)?;
        let after = other.proof.held_out.as_ref().map_or(f64::NAN, |errors| errors.after);
        let better = after < FORESEEN * left && best.as_ref().is_none_or(|(least, _)| after < *least);
        if better && other.withheld.is_none() {
            best = Some((after, other));
        }
    }
    Ok(best.map_or(proven, |(_, other)| other))
}
