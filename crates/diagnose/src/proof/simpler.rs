//! What was found without a cause that spoils the others, and a law without a term that spoils it.

use crate::balances::balance::Kind;
use crate::causes::trial::{Pool, Trial};
use crate::choosing::search::{Found, worth};
use crate::choosing::state::{Part, Stand, State};
use crate::proof::prove::Measure;
use crate::proof::proven::Proven;
use crate::proof::withdraw::lesser_set;
use crate::single_runs::events::Event;
use crate::{Case, DiagnoseError, System};

/// What was proven; without a cause beside which the others cannot be fitted as they are, where they foretell all runs far better
/// by themselves: a function lets what is not in proportion be told by its columns alone, which draw no wind of its strength.
pub fn simpler(
    case: &Case,
    system: &System,
    pool: &mut Pool,
    mut best: Proven,
    (events, by): (&[Event], &Measure),
) -> Result<Proven, DiagnoseError> {
    /// What leaves less than this is right, or nearly, in noises of the signal.
    const NEAR: f64 = 3.0;
    /// Share of the error that has to be left.
    const FAR_BETTER: f64 = 0.5;
    let far = |one: &Proven| one.proof.held_out.is_some_and(|errors| errors.after > NEAR * one.proof.noise);
    // What is driven forward shows all of them; no free parameter may have to say what a cause said.
    while by.kind == Kind::Motion && best.found.stand.parts.len() > 1 && far(&best) {
        let mut least: Option<Proven> = None;
        for place in 0..best.found.stand.parts.len() {
            let state = State { case, system, pool, fit: &case.fit };
            let unproven = best.found.unproven.clone();
            let Some(found) = lesser_set(&state, &best.found, place, unproven) else { continue };
            let lesser = Proven::of(case, system, pool, found, events, Some(by))?;
            let error = |one: &Proven| one.proof.held_out.map_or(f64::INFINITY, |errors| errors.after);
            let better = error(&lesser) < FAR_BETTER * error(&best)
                && !lesser.strains_more_than(&best, case)
                && lesser.proof.fitted.after < FAR_BETTER * best.proof.fitted.after;
            if better && least.as_ref().is_none_or(|least| error(&lesser) < error(least)) {
                least = Some(lesser);
            }
        }
        let Some(lesser) = least else { break };
        best = lesser;
    }
    Ok(best)
}

/// What was proven; with a law of fewer terms in the place of one, where that foretells the runs held out better and tells those that
/// were fitted no worse: rows that follow each other at once show a term that is nothing where all of them are added up.
pub fn shorter(
    case: &Case,
    system: &System,
    pool: &mut Pool,
    mut best: Proven,
    (events, by): (&[Event], &Measure),
) -> Result<Proven, DiagnoseError> {
    /// Share of the error that may be left.
    const BETTER: f64 = 0.95;
    for place in 0..best.found.stand.parts.len() {
        for found in with_fewer_terms(case, system, pool, &best.found, place) {
            let lesser = Proven::of(case, system, pool, found, events, Some(by))?;
            let errors = lesser.proof.held_out.zip(best.proof.held_out);
            let better = errors.is_some_and(|(own, other)| own.after < BETTER * other.after)
                && lesser.proof.fitted.after < best.proof.fitted.after
                && lesser.withheld.is_none()
                && !lesser.strains_more_than(&best, case);
            if better {
                best = lesser;
                break;
            }
        }
    }
    Ok(best)
}

/// What was found with another law in one place, of fewer terms and of nothing else than is in that one: the likeliest few of those that were
/// thought of.
fn with_fewer_terms(case: &Case, system: &System, pool: &Pool, found: &Found, place: usize) -> Vec<Found> {
    /// Every one is driven forward.
    const FEW: usize = 2;
    let part = &found.stand.parts[place];
    let cause = &case.causes[part.trial.cause];
    let Some(law) = &cause.law else { return Vec::new() };
    let is_less = |trial: &&Trial| {
        let other = &case.causes[trial.cause];
        other.balances == cause.balances
            && other.law.as_ref().is_some_and(|other| {
                other.role == law.role
                    && other.terms < law.terms
                    && other.depends_on.iter().all(|channel| law.depends_on.contains(channel))
            })
    };
    let state = State { case, system, pool, fit: &case.fit };
    let with = |trial: &Trial| {
        let mut parts = found.stand.parts.clone();
        parts[place] = Part { trial: trial.clone(), spread: None };
        let stand = state.settle(&parts, &found.stand.noises)?;
        (!state.impossible(&stand.parts, &stand.estimate)).then_some(stand)
    };
    let mut stands: Vec<_> = pool.trials.iter().filter(is_less).filter_map(with).collect();
    stands.sort_by(|one, other| worth(other).total_cmp(&worth(one)));
    let text = |stand: &Stand| case.causes[stand.parts[place].trial.cause].equation_text();
    // One that was found from several starts is the same each time.
    stands.dedup_by(|one, other| text(one) == text(other));
    let history = || (found.tried.clone(), found.unproven.clone());
    let told = |stand| state.found(stand, found.first.clone(), history(), found.needed);
    stands.into_iter().take(FEW).map(told).collect()
}
