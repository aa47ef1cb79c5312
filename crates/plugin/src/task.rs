//! What the vehicle works at.

use crate::{Situation, State};
use std::fmt::Debug;

/// What a task takes from the vehicle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Load {
    /// Pull at the hitch, backward [N], 0 or more.
    pub drawbar_force_n: f64,
    /// Power through the power take-off [W].
    pub pto_power_w: f64,
    /// Power through the remote hydraulics [W].
    pub hydraulic_power_w: f64,
}

/// Ploughing, seeding, spreading, hauling.
pub trait Task: Debug + Send + Sync {
    /// What it remembers.
    fn states(&self) -> Vec<State> {
        Vec::new()
    }

    /// The load at this instant, and how the states change (`rates`, one for each state, per second).
    fn load(&self, at: &Situation, states: &[f64], rates: &mut [f64]) -> Load;
}
