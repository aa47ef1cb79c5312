//! From the store of energy to the wheels.

use crate::management::{Consequence, Management, Share};
use crate::{Refusal, State};
use std::fmt::Debug;

/// The most named losses that one driveline may have.
pub const MAX_LOSSES: usize = 8;

/// What is asked of a driveline.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Demand {
    /// Speed at which the wheels roll [m/s]: that over ground where they do not slip.
    pub speed_m_s: f64,
    /// Force wanted at the wheels, forward [N]; negative to slow down.
    pub force_n: f64,
    /// Whether it is in neutral.
    pub coasting: bool,
    /// Electric power that other consumers take [W].
    pub auxiliary_power_w: f64,
    /// Mechanical power that is taken from the engine or motor: power take-off and hydraulics [W].
    pub shaft_power_w: f64,
    /// Friction torque at the combustion engine, beside its own [N m]; nothing to a driveline without one.
    pub engine_friction_n_m: f64,
    /// Resistance of the battery, beside its own [Ω]; nothing to a driveline without one.
    pub battery_resistance_ohm: f64,
    /// Speed at which the driver keeps the engine by hand, as for the power take-off [rad/s]; 0 where the driveline chooses.
    pub engine_speed_rad_s: f64,
    /// Whether the force was recorded: then it was there, whatever the full load of a model's engine would have allowed at a
    /// speed that a sensor told.
    pub recorded: bool,
}

/// What was recorded of an engine, and of what takes its power beside the wheels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shaft {
    /// Torque at the crankshaft [N m].
    pub torque_n_m: f64,
    /// Its speed [rad/s].
    pub speed_rad_s: f64,
    /// Speed of the wheels' circumference [m/s].
    pub wheel_speed_m_s: f64,
    /// Electric power that other consumers take [W].
    pub auxiliary_power_w: f64,
    /// Mechanical power that is taken beside the wheels: power take-off and hydraulics [W].
    pub shaft_power_w: f64,
}

/// What a driveline shows on its instruments; NaN for those that it does not have.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs, reason = "the names are those of the channels")]
pub struct Readings {
    pub engine_speed_rad_s: f64,
    pub engine_torque_n_m: f64,
    pub fuel_rate_kg_s: f64,
    pub cvt_ratio: f64,
    pub motor_speed_rad_s: f64,
    pub motor_torque_n_m: f64,
    pub battery_voltage_v: f64,
    pub battery_current_a: f64,
}

impl Readings {
    /// No instrument at all.
    pub const NONE: Self = Self {
        engine_speed_rad_s: f64::NAN,
        engine_torque_n_m: f64::NAN,
        fuel_rate_kg_s: f64::NAN,
        cvt_ratio: f64::NAN,
        motor_speed_rad_s: f64::NAN,
        motor_torque_n_m: f64::NAN,
        battery_voltage_v: f64::NAN,
        battery_current_a: f64::NAN,
    };

    /// Channel name and value of each instrument.
    pub fn channels(&self) -> [(&'static str, f64); 8] {
        [
            ("engine_speed_rad_s", self.engine_speed_rad_s),
            ("engine_torque_n_m", self.engine_torque_n_m),
            ("fuel_rate_kg_s", self.fuel_rate_kg_s),
            ("cvt_ratio", self.cvt_ratio),
            ("motor_speed_rad_s", self.motor_speed_rad_s),
            ("motor_torque_n_m", self.motor_torque_n_m),
            ("battery_voltage_v", self.battery_voltage_v),
            ("battery_current_a", self.battery_current_a),
        ]
    }
}

/// What a driveline gives.
///
/// Its powers balance: `source_power_w = force_n · speed + Σ losses_w + auxiliary + shaft power`. Where there are two stores
/// the source is the fuel, and what the other one gains is an account among the losses, negative where it gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Delivery {
    /// Force at the wheels, forward [N]; it may fall short of what was asked.
    pub force_n: f64,
    /// Power drawn from the store: lower heating value of the fuel, or open-circuit power of the battery [W].
    pub source_power_w: f64,
    /// Power of each account that [`Driveline::losses`] names [W].
    pub losses_w: [f64; MAX_LOSSES],
    /// What its instruments show.
    pub readings: Readings,
}

impl Delivery {
    /// Nothing is given and nothing is drawn.
    pub const NOTHING: Self =
        Self { force_n: 0.0, source_power_w: 0.0, losses_w: [0.0; MAX_LOSSES], readings: Readings::NONE };
}

/// Engine, motors, gears and stores.
pub trait Driveline: Debug + Send + Sync {
    /// What it remembers.
    fn states(&self) -> Vec<State> {
        Vec::new()
    }

    /// Names of its losses, at most [`MAX_LOSSES`].
    fn losses(&self) -> &'static [&'static str];

    /// Name of its store of energy, for the ledger.
    fn source(&self) -> &'static str;

    /// Mass that its rotating parts add to the vehicle's inertia [kg].
    fn rotating_mass_kg(&self, coasting: bool) -> f64;

    /// Answers a demand, and says how its states change (`rates`, one for each state, per second).
    fn deliver(&self, demand: &Demand, states: &[f64], rates: &mut [f64]) -> Delivery;

    /// Changes what it decides rather than what flows: a gear, an engine that stops, the sharing of a power. Asked once
    /// between two steps, and perhaps again at the same instant; during a step nothing is decided. Says whether it
    /// changed any of its states.
    fn decide(&self, demand: &Demand, states: &mut [f64]) -> bool {
        let _ = (demand, states);
        false
    }

    /// Why the run cannot go on, as with an empty battery or a map that has an end: `delivery` is what it gave to
    /// `demand`. Asked once between two steps of those that remember anything. `None` where it goes on, though perhaps with
    /// less than was asked.
    fn exhausted(&self, demand: &Demand, delivery: &Delivery, states: &[f64]) -> Option<String> {
        let _ = (demand, delivery, states);
        None
    }

    /// How long it may give less than it will in the end [s]: boost that builds up, a shift. So long a driver who asks for
    /// more waits.
    fn patience_s(&self) -> f64 {
        0.0
    }

    /// Whether it can drive at all: what cannot only rolls.
    fn drives(&self) -> bool {
        true
    }

    /// Whether two stores have to be managed.
    fn needs_management(&self) -> bool {
        false
    }

    /// Takes the plugin that shares power between its stores.
    ///
    /// # Errors
    /// [`Refusal`] where there is nothing to share.
    fn adopt(&mut self, management: Box<dyn Management>) -> Result<(), Refusal> {
        Err(Refusal {
            parameter: "management".to_owned(),
            found: format!("{management:?}"),
            expected: "none: this driveline has no two stores to share power between".to_owned(),
        })
    }

    /// What sharing the power so would take from its stores; `None` where there is nothing to share.
    fn weigh(&self, demand: &Demand, states: &[f64], share: Share) -> Option<Consequence> {
        let _ = (demand, states, share);
        None
    }

    /// Force at the wheels [N] that a recorded torque of its engine or motor [N m] makes; `None` where it cannot tell.
    fn force_of_torque_n(&self, torque_n_m: f64, speed_m_s: f64) -> Option<f64> {
        let _ = (torque_n_m, speed_m_s);
        None
    }

    /// Force at the wheels [N] that a recorded power of its engine makes, whatever the ratio; `None` where it cannot tell.
    fn force_of_shaft_n(&self, shaft: &Shaft) -> Option<f64> {
        let _ = shaft;
        None
    }

    /// Energy that its battery nominally holds between empty and full [J]; `None` where there is no state of charge.
    fn battery_capacity_j(&self) -> Option<f64> {
        None
    }
}
