//! The longitudinal simulation: one degree of freedom along a path, the forces and powers that act on it, and a ledger
//! that accounts for every joule.
//!
//! Three ways to drive it: a [`cycle`](simulate) of phases with a driver, coasting, and a [`replay`] of recorded inputs.
//! It knows no plugin by name and reads no file.

mod agreement;
#[cfg(test)]
mod axle_tests;
mod axles;
mod balance;
mod borne;
mod carriage;
mod cycle;
#[cfg(test)]
mod cycle_tests;
mod deciding;
mod demanded;
mod driving;
#[cfg(test)]
mod effect_tests;
mod ending;
mod hand;
mod ledger;
mod model;
#[cfg(test)]
mod physics_tests;
mod plan;
mod quasi_static;
#[cfg(test)]
mod quasi_static_tests;
mod recorder;
mod reference;
mod replay;
mod rolling;
mod root;
mod shaking;
mod simulation;
mod slope;
mod step;
mod traction;
mod upstream;
mod wheels;

pub use axles::{Axle, Axles};
pub use carriage::{AxleMotion, Carriage, Motion, Push, Stepped};
pub use demanded::demands;
pub use ledger::{Entry, Ledger};
pub use model::{Model, Named, Resistance, Vehicle};
pub use plan::{Cycle, Driven, EngineSpeed, Guard, Phase, Pi, Setting, Start, Until, speed_not_kept};
pub use replay::{Drive, Inputs, Replay, ReplayError, replay, replay_channels};
pub use simulation::{Simulation, simulate};
pub use slope::{LocalFit, chainage_from_m, local_fit, travelled};

use headland_trace::Trace;
use serde::Serialize;

/// What a simulation leaves behind.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Every step.
    pub trace: Trace,
    /// Where the energy came from and went.
    pub ledger: Ledger,
    /// How it ended.
    pub end: End,
    /// Steps that were integrated.
    pub steps: usize,
    /// The phases of a cycle as they were driven, in their order.
    pub phases: Vec<Driven>,
}

/// How a simulation ended.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum End {
    /// Every phase was driven to its end.
    Finished,
    /// It could not go on; what was simulated up to there is kept.
    Stopped {
        /// When [s].
        time_s: f64,
        /// Where along the path [m].
        position_m: f64,
        /// Why, in a sentence.
        reason: String,
    },
    /// The user stopped it; what was simulated up to there is kept.
    Interrupted {
        /// When [s].
        time_s: f64,
        /// Where along the path [m].
        position_m: f64,
    },
}
