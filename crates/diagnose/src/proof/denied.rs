//! What takes the place of a cause that runs held out deny: one that explains the fitted runs as well, and that those held out do not
//! deny because they do not show it. Drag in neutral is a level of rolling resistance where all fitted runs coast, and no drag of the
//! run that was driven.

use crate::causes::catalogue::{Class, Form};
use crate::causes::trial::{Pool, Trial};
use crate::choosing::search::{Found, Rival};
use crate::choosing::state::{Part, Stand, State};
use crate::proof::prove::Measure;
use crate::proof::proven::{Proven, RISES};
use crate::single_runs::events::Event;
use crate::{Case, DiagnoseError, System};

/// What was found with a rival in the place of one cause, the likeliest that the telling runs held out do not deny.
pub fn instead(
    case: &Case,
    system: &System,
    pool: &mut Pool,
    best: &Proven,
    place: usize,
    (events, by, telling): (&[Event], &Measure, &[bool]),
) -> Result<Option<Proven>, DiagnoseError> {
    /// A rival needs so many times what the best of all trials brings by chance: it is chosen after the fact.
    const SURELY: f64 = 2.0;
    let columns = &best.found.stand.parts[place].trial.columns;
    let Some(own) = best.found.accepted.iter().find(|one| one.trial.columns == *columns) else {
        return Ok(None);
    };
    let mut rivals: Vec<&Rival> =
        own.rivals.iter().filter(|rival| rival.gain > SURELY * own.by_chance).collect();
    rivals.sort_by(|one, other| other.gain.total_cmp(&one.gain));
    let causes: Vec<usize> = rivals.into_iter().map(|rival| rival.cause).collect();
    for cause in causes {
        let Some(found) = with(case, system, pool, &best.found, (place, cause)) else { continue };
        let other = Proven::of(case, system, pool, found, events, Some(by))?;
        let stays = other.refined.causes.iter().any(|cured| cured.cause.id == case.causes[cause].id);
        let denied = other.worsened_in(telling).is_none_or(|ratio| ratio > 1.0 + RISES) && !is_near(&other);
        if stays && !denied && other.withheld.is_none() {
            return Ok(Some(other));
        }
    }
    Ok(None)
}

/// Whether runs held out are as near to what was measured as its noise: what was calibrated beside a cause makes them a little better or
/// worse.
fn is_near(one: &Proven) -> bool {
    const NEAR: f64 = 2.0;
    one.proof.held_out.is_some_and(|errors| errors.after < NEAR * one.proof.noise)
}

/// What was found with a cause of the world that all runs have in common in the place of another, in its likeliest shape.
fn with(
    case: &Case,
    system: &System,
    pool: &Pool,
    found: &Found,
    (place, cause): (usize, usize),
) -> Option<Found> {
    let listed = &case.causes[cause];
    if listed.class != Class::Physics || listed.form != Form::Parameters || listed.law.is_some() {
        return None;
    }
    let state = State { case, system, pool, fit: &case.fit };
    let settled = |trial: &Trial| -> Option<Stand> {
        let mut parts = found.stand.parts.clone();
        parts[place] = Part { trial: trial.clone(), spread: None };
        let stand = state.settle(&parts, &found.stand.noises)?;
        (!state.impossible(&stand.parts, &stand.estimate)).then_some(stand)
    };
    let stands = pool.trials.iter().filter(|trial| trial.cause == cause).filter_map(settled);
    let stand = stands.max_by(|one, other| one.score.total_cmp(&other.score))?;
    let mut unproven = found.unproven.clone();
    unproven.push(found.stand.parts[place].trial.cause);
    Some(state.found(stand, found.first.clone(), (found.tried.clone(), unproven), found.needed))
}
