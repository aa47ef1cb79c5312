//! What is to be simulated, and how.

use crate::carriage::Carriage;
use crate::cycle::Running;
use crate::{Cycle, Model, Outcome};
use headland_trace::TraceError;

/// A model that is to be driven through a cycle.
pub struct Simulation<'a> {
    pub(crate) model: &'a Model,
    pub(crate) cycle: &'a Cycle,
    pub(crate) carriage: Option<Box<dyn Carriage + 'a>>,
    /// Between two rows of the trace [s]; 0 for one each step.
    pub(crate) record_s: f64,
    pub(crate) quasi_static: bool,
    pub(crate) stop: &'a dyn Fn() -> bool,
}

impl<'a> Simulation<'a> {
    /// By the longitudinal balance, with a row of the trace each step.
    pub fn new(model: &'a Model, cycle: &'a Cycle) -> Self {
        Self { model, cycle, carriage: None, record_s: 0.0, quasi_static: false, stop: &|| false }
    }

    /// Asks the model once a step, at the middle, wherever its motion is known beforehand: where a driver who knows the
    /// resistances follows a speed over time, and the drive can. A row of the trace is written at the middle of such a step where
    /// the last one is `record_s` [s] ago, and at the end of each phase.
    #[must_use]
    pub fn quasi_static(self, record_s: f64) -> Self {
        Self { quasi_static: true, record_s, ..self }
    }

    /// On a carriage that moves it; a row of the trace is written every `record_s` [s], and at the end of each phase.
    #[must_use]
    pub fn on(self, carriage: Box<dyn Carriage + 'a>, record_s: f64) -> Self {
        Self { carriage: Some(carriage), record_s, ..self }
    }

    /// Ends it as [`crate::End::Interrupted`] soon after `stop` says so. It is asked every few steps.
    #[must_use]
    pub fn unless(self, stop: &'a dyn Fn() -> bool) -> Self {
        Self { stop, ..self }
    }

    /// Drives it.
    ///
    /// # Errors
    /// [`TraceError`] where the steps do not make a trace, which would be a bug.
    pub fn run(self) -> Result<Outcome, TraceError> {
        Running::new(self).drive_all()
    }
}

/// Drives the model through the cycle.
///
/// # Errors
/// As [`Simulation::run`].
pub fn simulate(model: &Model, cycle: &Cycle) -> Result<Outcome, TraceError> {
    Simulation::new(model, cycle).run()
}
