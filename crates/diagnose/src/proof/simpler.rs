//! What was found without a cause that spoils the others.

use crate::balances::balance::Kind;
use crate::causes::trial::Pool;
use crate::choosing::state::State;
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
