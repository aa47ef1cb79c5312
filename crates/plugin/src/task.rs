//! What the vehicle works at.

use crate::{Situation, State};
use std::fmt::Debug;

/// What a task takes from the vehicle, and what it brings along.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Load {
    /// Pull at the hitch, backward [N], 0 or more; it holds a vehicle at rest and never moves it.
    pub drawbar_force_n: f64,
    /// Force on the vehicle, forward [N], whether it moves or not: the air on what is pulled.
    pub force_n: f64,
    /// Power through the power take-off [W].
    pub pto_power_w: f64,
    /// Power through the hydraulics, the losses on the way included [W].
    pub hydraulic_power_w: f64,
    /// Mass that is carried by the vehicle's own wheels [kg]: it adds to inertia, to slope and to what the ground resists.
    pub mass_kg: f64,
    /// Mass that is carried by other wheels, or by the ground [kg]: it adds to inertia and to slope alone.
    pub towed_mass_kg: f64,
}

/// What a task is told to do in a phase of a cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// It works: in the ground, driven, spreading, gathering.
    #[default]
    Work,
    /// It runs without working: lifted, its shaft turning.
    Idle,
    /// It is carried or pulled along, and does nothing.
    Rest,
    /// It is being filled.
    Fill,
    /// It is being emptied.
    Empty,
}

/// What of a task hangs on the hitch and works there, as pictures show it; nothing else asks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Implement {
    /// Working width [m].
    pub width_m: f64,
    /// How deep its tools work [m], 0 where they touch the ground and nothing says more; `None` where it has none in the ground.
    pub depth_m: Option<f64>,
    /// Number of its tools, where that is known.
    pub tools: Option<f64>,
    /// How high it is lifted [m]; `None` where nothing says so.
    pub lift_m: Option<f64>,
}

/// Ploughing, seeding, spreading, hauling.
pub trait Task: Debug + Send + Sync {
    /// What it remembers. A state named `payload_kg` is what it carries, one named `area_m2` what it has worked, and one named
    /// `lifted` how far it is lifted, from 0 at work to 1.
    fn states(&self) -> Vec<State> {
        Vec::new()
    }

    /// The load at this instant while it works, and how the states change (`rates`, one for each state, per second).
    ///
    /// `at.mass_kg` is the vehicle's own mass: what tasks and effects add is not known yet.
    fn load(&self, at: &Situation, states: &[f64], rates: &mut [f64]) -> Load;

    /// As [`Task::load`], in any mode. A task that does not say otherwise is not there where it does not work.
    fn load_in(&self, mode: Mode, at: &Situation, states: &[f64], rates: &mut [f64]) -> Load {
        if mode == Mode::Work {
            return self.load(at, states, rates);
        }
        rates.fill(0.0);
        Load::default()
    }

    /// What hangs on the hitch; it works where `lifted` is 0 or, without that state, where `area_m2` grows.
    fn implement(&self) -> Option<Implement> {
        None
    }

    /// Why it cannot do what it is told, as spreading from an empty tank: the run ends. Asked once a step.
    fn trouble(&self, mode: Mode, at: &Situation, states: &[f64]) -> Option<String> {
        let _ = (mode, at, states);
        None
    }
}
