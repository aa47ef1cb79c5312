//! Finds the physics that a scenario left out.
//!
//! Every balance that the recorded channels allow is written in its weak form, all of them side by side, and their noise
//! is estimated. Causes are then tried on: each effect is put into the scenario, every run is driven with it, and what
//! the model says differently is a regressor beside the free parameters and their priors. Sets of causes are grown while
//! the evidence grows more than chance could make it grow; causes that explain as much are named beside them. Faults of
//! sensors are taken out of the recordings before what is left is called physics. What was accepted is fitted again
//! without linearising, written into the scenario, and shown on runs that were held out.

#![allow(clippy::result_large_err, reason = "a diagnosis fails once, not in a loop")]

mod balances;
mod case;
mod causes;
mod choosing;
mod error;
mod experiment;
mod law;
mod line;
mod look;
mod outliers;
mod proof;
mod runs;
mod second;
mod single_runs;
mod so_far;
mod soundness;
mod together;
mod told;

pub use balances::balance::Kind;
pub use case::{Options, Progress, Silent};
pub use error::DiagnoseError;
pub use experiment::Experiment;
pub use together::{Together, together};
pub use told::map::{Mismatch, Over};
pub use told::report::{
    Calibrated, Diagnosed, Diagnosis, FindingKind, FindingReport, Fit, FitRuns, Interval, LeftOver,
    ParameterReport, RivalReport as Rival, Shown, Tried, Verdict,
};

pub(crate) use balances::balance::System;
pub(crate) use case::Case;

use causes::losses;
use choosing::foreseen;
use headland_plugin::Registry;
use headland_recording::Recording;
use headland_scenario::Scenario;
use law::unlisted;
use look::Look;
use proof::{proven, refine, withdraw};
use runs::{begun, late_power, overrun};
use single_runs::events::Event;
use single_runs::{brakes, regeneration, spells};
use soundness::{contradiction, engine_off, faults, unsourced};
use told::report;

/// Diagnoses a recording with a scenario.
///
/// # Errors
/// [`DiagnoseError`] where the two cannot be held together, or nothing that was measured makes a balance.
pub fn diagnose(
    scenario: &Scenario,
    recording: &Recording,
    registry: &Registry,
    options: &Options,
    progress: &dyn Progress,
) -> Result<Diagnosed, DiagnoseError> {
    let look = |options: &Options| diagnose_once(scenario, recording, registry, options, progress);
    let known = |name: &str| recording.runs.iter().any(|run| run.trace.get(name).is_some());
    second::opinion(look(options)?, options, known, look)
}

/// Brakes are looked for so many times more, once a delay was found.
const BRAKE_ROUNDS: usize = 2;

fn diagnose_once(
    scenario: &Scenario,
    recording: &Recording,
    registry: &Registry,
    options: &Options,
    progress: &dyn Progress,
) -> Result<Diagnosed, DiagnoseError> {
    let mut case = Case::new(scenario, recording, registry, options, progress)?;
    let (mut faults, mut sound) = faults::faults(&case.runs, &case.sensors);
    faults.extend(case.faulty_scale().as_ref().map(faults::scaled));
    faults.retain(|fault| case.wanted(fault.id));
    engine_off::leave_out(&mut case, &mut sound);
    overrun::leave_out(&case, &mut sound);
    if let Some(late) = begun::late(&case) {
        faults.extend(begun::set_right(&mut case, late, &mut sound)?);
    }
    for late in late_power::late(&case) {
        faults.push(late_power::set_right(&mut case, late, &mut sound)?);
    }
    unsourced::leave_out(&mut case)?;
    case.sound.clone_from(&sound);
    let against = contradiction::statements(&case, &sound);
    if !against.is_empty() {
        return report::inconclusive(&case, &sound, &against);
    }
    let logged = sound;
    let brakes =
        |case: &Case| if case.wanted("braking") { brakes::brakes(case, &logged) } else { Vec::new() };
    let mut braked = brakes(&case);
    let unbraked = |case: &Case, braked: &[Event]| {
        let mut sound = spells::outside(case, &logged, braked);
        regeneration::leave_out(case, braked, &mut sound);
        sound
    };
    let mut sound = unbraked(&case, &braked);
    let mut look = Look::at(&case, &sound)?;
    look.sensors_first(&mut case)?;
    // A force that comes late leaves what looks like brakes where it sets in, and a delay is found in rounds.
    for _ in 0..BRAKE_ROUNDS {
        let late = case.corrections.iter().any(|one| ["latency", "clock_drift"].contains(&one.id));
        let anew = if late && !braked.is_empty() { brakes(&case) } else { braked.clone() };
        if anew == braked {
            break;
        }
        braked = anew;
        sound = unbraked(&case, &braked);
        look.again(&mut case, &sound)?;
        look.sensors_first(&mut case)?;
    }
    look.sharpen(&case)?;
    let events = spells::spells(&mut case, &mut look, &sound, &braked)?;
    let (system, mut pool, found) = look.closer(&mut case)?;
    let listed = found.clone();
    let (found, law) = unlisted::unlisted(&mut case, &system, &mut pool, found)?;
    let law = law.map(|law| (found.clone(), law));
    let events = brakes::standing(&case, &refine::plain(&case, &pool, &found), &events, &braked)?;
    let proven = withdraw::proven(&case, &system, &mut pool, found, &events, &faults)?;
    let proven = withdraw::or_listed(&case, &system, &mut pool, (proven, listed), &events, &faults)?;
    let proven = withdraw::or_law(&case, &system, &mut pool, proven, law, &events, &faults)?;
    let proven = foreseen::foreseen(&case, &system, &mut pool, proven, &events, &faults)?;
    let proven::Proven { found, mut refined, withheld, proof } = proven;
    let next = experiment::propose(&case, &system, &pool, &found, &refined)?;
    refined.null_space.clone_from(&next.null_space);
    let remark = losses::remark(&case, &system, &pool, &found);
    let beside = report::Beside { faults: &faults, events: &events, withheld, next, remark };
    report::report(&case, &system, &found, &refined, &proof, &beside)
}
