//! Physics that a scenario adds to the bare vehicle, one effect at a time.

use crate::{Situation, State};
use std::fmt::Debug;

/// What an effect does; zero where it does nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Action {
    /// Force on the vehicle, forward [N], whether it moves or not.
    pub force_n: f64,
    /// Force against the motion [N], 0 or more; it holds a vehicle at rest and never moves it.
    pub resistance_n: f64,
    /// Mass that is added to inertia and weight [kg].
    pub mass_kg: f64,
    /// Mass that is added to inertia alone [kg].
    pub rotating_mass_kg: f64,
    /// Electric power that is taken beside the drive [W].
    pub auxiliary_power_w: f64,
    /// Mechanical power that is taken from the engine or motor [W].
    pub shaft_power_w: f64,
}

/// One piece of physics.
pub trait Effect: Debug + Send + Sync {
    /// What it remembers.
    fn states(&self) -> Vec<State> {
        Vec::new()
    }

    /// What it does at this instant, and how its states change (`rates`, one for each state, per second).
    fn act(&self, at: &Situation, states: &[f64], rates: &mut [f64]) -> Action;
}
