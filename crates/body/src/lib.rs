//! The rigid-body fidelity: a chassis on wheels over a surface.
//!
//! A [`Chassis`] says what a vehicle is beside its axles, tyres and masses; [`simulate`] drives it through the cycles of
//! `headland-sim`. Rapier integrates the chassis; wheels, tyres, shafts and steering are our own.
//!
//! World axes point east, north and up, those of the vehicle ahead, to the left and up.

#![allow(clippy::result_large_err, reason = "a vehicle is refused once, not in a loop")]

mod accounts;
mod chassis;
mod error;
mod ground;
mod hop;
mod hub;
mod pace;
mod rig;
mod spin;
mod standing;
mod steer;
#[cfg(test)]
mod tests;
mod track;
mod trailer;
mod wheel;
mod world;

pub use chassis::{AxleBody, Chassis, Differential, Payload, Steering, SteeringMode, Suspension};
pub use error::BodyError;
pub use hub::{Hub, TrailerHubs, hubs, trailer_hubs};
pub use trailer::{Trailer, TrailerAxle};

use headland_sim::{Cycle, Model, Outcome, Simulation};
use headland_trace::TraceError;
use rig::Rig;

/// Why a run as a rigid body makes no trace.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The vehicle cannot be put on its ground.
    #[error(transparent)]
    Body(#[from] BodyError),
    /// The steps do not make a trace, which would be a bug.
    #[error(transparent)]
    Trace(#[from] TraceError),
}

/// Drives the model through the cycle as a rigid body; a row of the trace is written every `record_s` [s].
///
/// # Errors
/// [`RunError`] where the vehicle cannot stand where it is to start, or the step is too long for it.
pub fn simulate(model: &Model, chassis: &Chassis, cycle: &Cycle, record_s: f64) -> Result<Outcome, RunError> {
    simulate_unless(model, chassis, cycle, record_s, &|| false)
}

/// As [`simulate`], and ends as [`headland_sim::End::Interrupted`] soon after `stop` says so.
///
/// # Errors
/// As [`simulate`].
pub fn simulate_unless(
    model: &Model,
    chassis: &Chassis,
    cycle: &Cycle,
    record_s: f64,
    stop: &dyn Fn() -> bool,
) -> Result<Outcome, RunError> {
    let rig = Rig::new(model, chassis, cycle.start, cycle.step_s)?;
    Ok(Simulation::new(model, cycle).on(Box::new(rig), record_s).unless(stop).run()?)
}

/// Whether a model can be driven as a rigid body through a cycle.
///
/// # Errors
/// [`BodyError`] as from [`simulate`], before anything moves.
pub fn check(model: &Model, chassis: &Chassis, cycle: &Cycle) -> Result<(), BodyError> {
    Rig::new(model, chassis, cycle.start, cycle.step_s).map(|_| ())
}
