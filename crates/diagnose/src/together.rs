//! Whether a scenario and a recording can be held together, before anything is looked for.

use crate::balances::balance::Kind;
use crate::{Case, DiagnoseError, Options, Silent};
use headland_plugin::Registry;
use headland_recording::Recording;
use headland_scenario::Scenario;

/// What a scenario and a recording make together.
#[derive(Clone, Debug)]
pub struct Together {
    /// The balances, from the ground up; where there are none the notes say what it would take.
    pub balances: Vec<Kind>,
    /// Runs that a diagnosis would fit.
    pub fitted: Vec<String>,
    /// Runs that it would hold out.
    pub held_out: Vec<String>,
    /// What was decided on the way, in sentences.
    pub notes: Vec<String>,
}

/// Drives the nominal model with a recording once, and says which balances the two make.
///
/// # Errors
/// [`DiagnoseError`] where the two cannot be held together.
pub fn together(
    scenario: &Scenario,
    recording: &Recording,
    registry: &Registry,
) -> Result<Together, DiagnoseError> {
    let options = Options::default();
    let case = Case::new(scenario, recording, registry, &options, &Silent)?;
    let mut notes = case.study.notes.clone();
    if case.kinds.is_empty() {
        notes.push(DiagnoseError::NoBalance { channels: case.channels() }.to_string());
    }
    let chosen = |fitted: bool| {
        let of = case.runs.iter().zip(&case.fit).filter(|(_, fit)| **fit == fitted);
        of.map(|(run, _)| run.measured.id.clone()).collect()
    };
    Ok(Together { fitted: chosen(true), held_out: chosen(false), notes, balances: case.kinds })
}
