//! What keeps a diagnosis from being made.

use headland_calibrate::study::StudyError;
use headland_scenario::ScenarioError;
use headland_sim::ReplayError;

/// A diagnosis that cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum DiagnoseError {
    /// The scenario, or a recording that does not fit it.
    #[error(transparent)]
    Study(#[from] StudyError),
    /// A scenario that was tried on.
    #[error("{}", .0.told())]
    Scenario(#[from] ScenarioError),
    /// A run cannot be replayed.
    #[error("run `{run}`: {error}")]
    Replay {
        /// The run.
        run: String,
        /// Why.
        error: ReplayError,
    },
    /// No balance can be made of what was measured.
    #[error(
        "nothing can be concluded: no balance can be made of the channels {}; it would take tractive_force_n, a torque, \
         or coasting (motion; where nothing drove, `replay: (drive: Coast)` of the scenario says so), specific_force_m_s2 \
         (parity), wheel_speed_m_s (slip), battery_voltage_v and battery_current_a (battery), or fuel_rate_kg_s (fuel)",
        channels.join(", ")
    )]
    NoBalance {
        /// What was measured.
        channels: Vec<String>,
    },
    /// An identifier that names no cause.
    #[error("no cause is named `{id}`{}\n  known: {}", suggestion.map_or(String::new(), |name| format!("; did you mean `{name}`?")), known.join(", "))]
    UnknownCause {
        /// What was found.
        id: String,
        /// The nearest known one.
        suggestion: Option<&'static str>,
        /// All that are known.
        known: Vec<&'static str>,
    },
    /// A candidate of the scenario that cannot be tried.
    #[error(
        "candidate `{name}` cannot be tried: {why}; free is the amount of an `expression`, and of other effects the first number that is written, which the effect has to be in proportion to"
    )]
    Candidate {
        /// The effect.
        name: String,
        /// Why not.
        why: String,
    },
    /// A trace does not come together: a bug.
    #[error(transparent)]
    Trace(#[from] headland_trace::TraceError),
    /// The user interrupted.
    #[error("interrupted")]
    Interrupted,
}
