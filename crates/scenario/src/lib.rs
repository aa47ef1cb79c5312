//! Scenarios: RON files that are read, checked and assembled into models.
//!
//! [`Document`] resolves includes and quantities and keeps the place of every character; [`Scenario`] is what the
//! text says; [`Scenario::model`] asks a registry for the plugins. Every error names file, line and column.

#![allow(clippy::result_large_err, reason = "a scenario is refused once, not in a loop")]

mod assembled;
mod axles;
#[cfg(test)]
mod axles_tests;
mod body;
#[cfg(test)]
mod body_tests;
mod candidate;
mod cycle;
#[cfg(test)]
mod cycle_tests;
mod document;
mod error;
mod fault;
mod form;
mod form_about;
mod ground;
mod location;
mod piece;
mod plugins;
mod recorded_speed;
mod scenario;
#[cfg(test)]
mod scenario_tests;
mod schema;
mod trailer;
mod tree;
mod until;

pub use assembled::Piece;
pub use body::Fidelity;
pub use candidate::{Candidate, CandidateField};
pub use document::Document;
pub use error::{Location, ScenarioError};
pub use form::{Definition, Note, definitions};
pub use plugins::Remark;
pub use scenario::{AskedInputs, Free, ReplaySettings, RunSpec, Scenario};
pub use tree::{Field, Node, Shape};
