//! Finds the physics that a scenario left out.
//!
//! From the ground up, every balance that the recorded channels allow is written in its weak form and its noise is
//! estimated. Causes are then tried on: each effect is put into the scenario, every run is driven with it, and what the
//! model says differently is a regressor beside the free parameters and their priors. A cause is accepted where the
//! evidence grows more than chance could make it grow; causes that explain as much are named beside it. What was
//! accepted is fitted again without linearising, written into the scenario, and shown on runs that were held out.

#![allow(clippy::result_large_err, reason = "a diagnosis fails once, not in a loop")]

mod balance;
mod case;
mod catalogue;
mod error;
mod events;
mod faults;
mod gram;
mod locate;
mod noise;
mod profile;
mod prove;
mod refine;
mod report;
mod rows;
mod search;
mod trial;
mod words;

pub use balance::Kind;
pub use case::{Options, Progress};
pub use error::DiagnoseError;
pub use report::{
    Calibrated, Diagnosed, Diagnosis, FindingKind, FindingReport, Fit, FitRuns, Interval, LeftOver,
    ParameterReport, Rival, Tried, Verdict,
};

pub(crate) use case::Case;

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
    let case = Case::new(scenario, recording, registry, options, progress)?;
    let (faults, sound) = faults::faults(&case.drives);
    let faults: Vec<faults::Fault> = faults.into_iter().filter(|fault| case.wanted(fault.id)).collect();
    let mut balances = case.balances(&sound);
    if balances.is_empty() {
        let channels = case.drives.iter().flat_map(|drive| drive.measured.trace.channels());
        let mut channels: Vec<String> = channels.map(|channel| channel.name.clone()).collect();
        channels.sort_unstable();
        channels.dedup();
        return Err(DiagnoseError::NoBalance { channels });
    }
    let mut pools = trial::pools(&case, &balances, &case.causes)?;
    let mut found = search_all(&case, &balances, &pools)?;
    if sharpen(&case, &balances, &mut pools, &found)? {
        found = search_all(&case, &balances, &pools)?;
    }
    let events = spells(&case, &mut balances, &mut pools, &mut found, &sound)?;
    let mut refined = refine::refine(&case, &balances, &pools, &found)?;
    let unproven = prove::unproven(&found, &refined);
    refined.causes.retain(|cured| !unproven.contains(&cured.cause.id));
    refine::spells(&case, &balances, &events, &mut refined);
    let proof = prove::prove(&case, &balances, &refined)?;
    report::report(&case, &balances, &found, &refined, &proof, &faults, &unproven)
}

fn search_all(
    case: &Case,
    balances: &[balance::Balance],
    pools: &[trial::Pool],
) -> Result<Vec<Option<search::Found>>, DiagnoseError> {
    let mut found = Vec::new();
    for (balance, pool) in balances.iter().zip(pools) {
        case.progress.step(balance.kind.name());
        if case.progress.interrupted() {
            return Err(DiagnoseError::Interrupted);
        }
        found.push(search::search(case, balance, pool, &case.causes, &case.banned()));
    }
    Ok(found)
}

/// Adds trials at the fitted values of non-linear parameters, of the best causes that have some: what lies between the
/// points of a grid must not be left for another cause to explain. Whether there was anything to add.
fn sharpen(
    case: &Case,
    balances: &[balance::Balance],
    pools: &mut [trial::Pool],
    found: &[Option<search::Found>],
) -> Result<bool, DiagnoseError> {
    /// So many causes of a balance get the chance.
    const MOST: usize = 3;
    /// Those that bring at least this share of what the best one brings.
    const CLOSE: f64 = 0.5;
    let mut added = false;
    for (index, found) in found.iter().enumerate() {
        let Some(found) = found else { continue };
        let (Some(first), Some(round)) = (found.accepted.first(), found.tried.first()) else { continue };
        let mut chosen: Vec<&str> = Vec::new();
        for (cause, shape, gain) in &round.causes {
            let id = case.causes[*cause].id;
            if shape.is_empty() || *gain < CLOSE * first.gain || chosen.len() == MOST || chosen.contains(&id)
            {
                continue;
            }
            let trial =
                pools[index].trials.iter().find(|trial| trial.cause == *cause && trial.shape == *shape);
            let Some(trial) = trial.cloned() else { continue };
            chosen.push(id);
            let tried = search::Accepted { trial, function: None, rivals: Vec::new(), ..first.clone() };
            let fitted = refine::shape(case, &balances[index], found, &tried)?;
            if fitted != *shape {
                trial::add_trial(case, balances, pools, *cause, &fitted)?;
                added = true;
            }
        }
    }
    Ok(added)
}

/// Spells in single runs are set aside, and what every run has in common is looked for once more without them.
fn spells(
    case: &Case,
    balances: &mut Vec<balance::Balance>,
    pools: &mut Vec<trial::Pool>,
    found: &mut Vec<Option<search::Found>>,
    sound: &[Vec<bool>],
) -> Result<Vec<events::Event>, DiagnoseError> {
    // A function of time can imitate spells; it is looked at without.
    let mut banned = case.banned();
    banned.push("payload_change");
    let mut events: Vec<events::Event> = Vec::new();
    for ((balance, pool), found) in balances.iter().zip(pools.iter()).zip(found.iter()) {
        let Some(found) = found else { continue };
        let timed = found.accepted.iter().any(|one| case.causes[one.trial.cause].id == "payload_change");
        let plain = if timed { search::search(case, balance, pool, &case.causes, &banned) } else { None };
        events.extend(events::events(case, balance, plain.as_ref().unwrap_or(found)));
    }
    if events.is_empty() || !case.wanted(events::name(&case.drives, &events)) {
        return Ok(Vec::new());
    }
    let mut usable = events::outside(&case.drives, &events, balance::block_s(&case.drives));
    for (usable, sound) in usable.iter_mut().zip(sound) {
        for (usable, sound) in usable.iter_mut().zip(sound) {
            *usable &= sound;
        }
    }
    *balances = case.balances(&usable);
    *pools = trial::pools(case, balances, &case.causes)?;
    *found = search_all(case, balances, pools)?;
    if sharpen(case, balances, pools, found)? {
        *found = search_all(case, balances, pools)?;
    }
    Ok(events)
}
