//! Finds the physics that a scenario left out.
//!
//! Every balance that the recorded channels allow is written in its weak form, all of them side by side, and their noise
//! is estimated. Causes are then tried on: each effect is put into the scenario, every run is driven with it, and what
//! the model says differently is a regressor beside the free parameters and their priors. Sets of causes are grown while
//! the evidence grows more than chance could make it grow; causes that explain as much are named beside them. Faults of
//! sensors are taken out of the recordings before what is left is called physics. What was accepted is fitted again
//! without linearising, written into the scenario, and shown on runs that were held out.

#![allow(clippy::result_large_err, reason = "a diagnosis fails once, not in a loop")]

mod balance;
mod band;
mod bend;
mod brakes;
mod case;
mod catalogue;
mod change_points;
mod contest;
mod contradiction;
mod crossval;
mod error;
mod events;
mod experiment;
mod faults;
mod gram;
mod jumps;
mod locate;
mod losses;
mod map;
mod noise;
mod own;
mod profile;
mod prove;
mod recorded;
mod refine;
mod report;
mod rows;
mod said;
mod search;
mod sensors;
mod sharpen;
mod so_far;
mod standin;
mod state;
mod straying;
mod student;
mod tails;
mod trial;
mod unlisted;
mod voltage;
mod widths;
mod withdraw;
mod words;

pub use balance::Kind;
pub use case::{Options, Progress};
pub use error::DiagnoseError;
pub use experiment::Experiment;
pub use map::{Mismatch, Over};
pub use report::{
    Calibrated, Diagnosed, Diagnosis, FindingKind, FindingReport, Fit, FitRuns, Interval, LeftOver,
    ParameterReport, RivalReport as Rival, Shown, Tried, Verdict,
};

pub(crate) use balance::System;
pub(crate) use case::Case;

use case::Correction;
use headland_plugin::Registry;
use headland_recording::Recording;
use headland_scenario::Scenario;

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
    let mut case = Case::new(scenario, recording, registry, options, progress)?;
    let (mut faults, sound) = faults::faults(&case.runs);
    faults.retain(|fault| case.wanted(fault.id));
    let against = contradiction::statements(&case, &sound);
    if !against.is_empty() {
        return report::inconclusive(&case, &sound, &against);
    }
    let braked = if case.wanted("braking") { brakes::brakes(&case, &sound) } else { Vec::new() };
    let sound = without(&case, &sound, &braked);
    let mut look = Look::at(&mut case, &sound)?;
    sensors_first(&mut case, &mut look, &sound)?;
    look.sharpen(&case)?;
    let events = spells(&mut case, &mut look, &sound, &braked)?;
    let Look { system, mut pool, found } = look;
    case.step("strange rows")?;
    let found = straying::straying(&case, &system, &pool, found);
    let found = unlisted::unlisted(&mut case, &system, &mut pool, found)?;
    let proven = withdraw::proven(&case, &system, &mut pool, found, &events)?;
    let withdraw::Proven { found, mut refined, withheld, proof } = proven;
    let next = experiment::propose(&case, &system, &pool, &found, &refined)?;
    refined.null_space.clone_from(&next.null_space);
    let beside = report::Beside { faults: &faults, events: &events, withheld, next };
    report::report(&case, &system, &found, &refined, &proof, &beside)
}

/// The rows, the regressors and what they tell.
struct Look {
    system: System,
    pool: trial::Pool,
    found: search::Found,
}

impl Look {
    /// Looks at samples that are `usable`, and again with what was found as part of the model.
    fn at(case: &mut Case, usable: &[Vec<bool>]) -> Result<Self, DiagnoseError> {
        const ROUNDS: usize = 2;
        let mut look = Self::once(case, usable)?;
        for _ in 0..ROUNDS {
            if !case.build_on(&look.pool, &look.found)? {
                break;
            }
            look = Self::once(case, usable)?;
        }
        Ok(look)
    }

    fn once(case: &Case, usable: &[Vec<bool>]) -> Result<Self, DiagnoseError> {
        let system = case.system(usable);
        if system.kinds.is_empty() {
            return Err(DiagnoseError::NoBalance { channels: case.channels() });
        }
        let pool = trial::pool(case, &system)?;
        let found = Self::search(case, &system, &pool)?;
        Ok(Self { system, pool, found })
    }

    fn search(case: &Case, system: &System, pool: &trial::Pool) -> Result<search::Found, DiagnoseError> {
        case.step("searching")?;
        search::search(case, system, pool)
            .ok_or_else(|| DiagnoseError::NoBalance { channels: case.channels() })
    }

    /// Searches once more with shapes between the points of the grids, and with causes as they are at their size.
    fn sharpen(&mut self, case: &Case) -> Result<(), DiagnoseError> {
        let finer = sharpen::sharpen(case, &self.system, &mut self.pool, &self.found)?;
        let bent = bend::bend(case, &self.system, &mut self.pool, &self.found)?;
        if finer || bent {
            self.found = Self::search(case, &self.system, &self.pool)?;
        }
        Ok(())
    }
}

/// Takes the faults of sensors that were found out of the recordings, and looks again, until nothing is left of them.
fn sensors_first(case: &mut Case, look: &mut Look, sound: &[Vec<bool>]) -> Result<(), DiagnoseError> {
    /// A fault that is not linear takes some rounds.
    const ROUNDS: usize = 6;
    /// A rest that is this share of the fault, or this share of its usual size, is none.
    const NEARLY: f64 = 0.05;
    for _ in 0..ROUNDS {
        let mut corrections = case.corrections.clone();
        let mut more = false;
        for correction in &mut corrections {
            let column = look.pool.corrected.iter().find(|(id, _)| *id == correction.id);
            let rest = column.map_or(0.0, |(_, column)| look.found.estimate.beta[*column]);
            let usual = case.causes[correction.accepted.trial.cause].terms[0].scale;
            more |= rest.abs() > NEARLY * correction.value.abs().max(usual);
            correction.value += rest;
        }
        for accepted in &look.found.accepted {
            let id = case.causes[accepted.trial.cause].id;
            let position = look.found.used.iter().position(|used| *used == accepted.trial.columns[0]);
            if let (true, Some(position)) =
                (["latency", "speed_scale", "force_scale"].contains(&id), position)
            {
                let value = look.found.estimate.beta[position];
                corrections.push(Correction { id, value, accepted: accepted.clone() });
                more = true;
            }
        }
        let small: Vec<&'static str> = corrections
            .iter()
            .filter(|correction| sensors::petty(case, correction.id, correction.value))
            .map(|correction| correction.id)
            .collect();
        if !more && small.is_empty() {
            return Ok(());
        }
        corrections.retain(|correction| !small.contains(&correction.id));
        case.petty.extend(small);
        case.correct(corrections)?;
        *look = Look::at(case, sound)?;
    }
    Ok(())
}

/// The samples that are usable and lie in no spell.
fn without(case: &Case, usable: &[Vec<bool>], events: &[events::Event]) -> Vec<Vec<bool>> {
    let mut outside = events::outside(&case.runs, events, balance::block_s(Kind::Motion, &case.runs));
    for (outside, usable) in outside.iter_mut().zip(usable) {
        for (outside, usable) in outside.iter_mut().zip(usable) {
            *outside &= usable;
        }
    }
    outside
}

/// Spells in single runs are set aside, and what every run has in common is looked for once more without them.
fn spells(
    case: &mut Case,
    look: &mut Look,
    sound: &[Vec<bool>],
    braked: &[events::Event],
) -> Result<Vec<events::Event>, DiagnoseError> {
    // A function of time can imitate spells; it is looked at without.
    let timed = |one: &search::Accepted| {
        let cause = &case.causes[one.trial.cause];
        cause.id == "payload_change" && cause.is_function()
    };
    let mut events = if look.found.accepted.iter().any(timed) {
        let plain = search::search_without(case, &look.system, &look.pool, &["payload_change"]);
        events::events(case, &look.system, plain.as_ref().unwrap_or(&look.found))
    } else {
        events::events(case, &look.system, &look.found)
    };
    if events.is_empty() || !case.wanted(events::name(&case.runs, &events)) {
        return Ok(braked.to_vec());
    }
    let usable = without(case, sound, &events);
    *look = Look::at(case, &usable)?;
    look.sharpen(case)?;
    events.extend_from_slice(braked);
    events.sort_by(|one, other| one.run.cmp(&other.run).then(one.from_s.total_cmp(&other.from_s)));
    Ok(events)
}
