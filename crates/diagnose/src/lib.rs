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
    let balances = case.balances();
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
    let refined = refine::refine(&case, &balances, &pools, &found)?;
    let proof = prove::prove(&case, &balances, &refined)?;
    report::report(&case, &balances, &pools, &found, &refined, &proof)
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

/// Adds trials at the fitted values of non-linear parameters: what lies between the points of a grid must not be left
/// for another cause to explain. Whether there was anything to add.
fn sharpen(
    case: &Case,
    balances: &[balance::Balance],
    pools: &mut [trial::Pool],
    found: &[Option<search::Found>],
) -> Result<bool, DiagnoseError> {
    let mut added = false;
    for (index, found) in found.iter().enumerate() {
        let Some(found) = found else { continue };
        let Some(first) = found.accepted.first().filter(|one| !one.trial.shape.is_empty()) else { continue };
        let fitted = refine::shape(case, &balances[index], found, first)?;
        if fitted != first.trial.shape {
            trial::add_trial(case, balances, pools, first.trial.cause, &fitted)?;
            // A rival of the same kind gets the same chance.
            let names = |cause: usize| -> Vec<&str> {
                case.causes[cause].terms.iter().filter(|term| !term.linear).map(|term| term.name).collect()
            };
            for (rival, _, _) in &first.rivals {
                if names(*rival) == names(first.trial.cause) {
                    trial::add_trial(case, balances, pools, *rival, &fitted)?;
                }
            }
            added = true;
        }
    }
    Ok(added)
}
