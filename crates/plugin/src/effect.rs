//! Physics that a scenario adds to the bare vehicle, one effect at a time.

use crate::{Situation, State};
use std::fmt::Debug;

/// What an effect does; zero where it does nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Action {
    /// Force on the vehicle, forward [N], whether it moves or not.
    pub force_n: f64,
    /// Force against the motion [N]; it holds a vehicle at rest and never moves it. Negative where the model resists too
    /// much: the resistances together are never less than 0.
    pub resistance_n: f64,
    /// Mass that is added to inertia and weight [kg].
    pub mass_kg: f64,
    /// Mass that is added to inertia alone [kg].
    pub rotating_mass_kg: f64,
    /// Electric power that is taken beside the drive [W].
    pub auxiliary_power_w: f64,
    /// Mechanical power that is taken from the engine or motor [W].
    pub shaft_power_w: f64,
    /// Drag area that is added to the body [m²]: `force_n` holds its drag, other effects learn of it from their situation.
    pub drag_area_m2: f64,
    /// Share of the force at the wheels, driving or braking, that is lost against the motion before it reaches the ground.
    pub loss_share: f64,
    /// As `loss_share`, lost before the place where the force at the wheels is told: what drives has to give so much more.
    pub upstream_share: f64,
    /// Force against the motion that is lost before that place [N].
    pub upstream_n: f64,
    /// Slip whatever the force: the wheels turn as if the speed were v / (1 − s).
    pub slip: f64,
    /// Slip for each newton at the wheels [1/N], more where they drive and less where they brake.
    pub slip_per_n: f64,
    /// What is added to that for each newton at the wheels, driving or braking [1/N²]: slip that grows faster than the pull.
    pub slip_per_n2: f64,
    /// Friction torque at the engine, beside its own [N m].
    pub engine_friction_n_m: f64,
    /// Resistance of the battery, beside its own [Ω].
    pub battery_resistance_ohm: f64,
}

impl Action {
    /// Slip for each newton at the wheels, where so many act there [1/N].
    pub fn slip_per_n_at(&self, force_n: f64) -> f64 {
        self.slip_per_n + self.slip_per_n2 * force_n.abs()
    }

    /// Slip of wheels that drive with a force, in the direction of the motion [N]; negative where they brake.
    pub fn slip_at(&self, driving_n: f64) -> f64 {
        self.slip + self.slip_per_n_at(driving_n) * driving_n
    }
}

/// One piece of physics.
pub trait Effect: Debug + Send + Sync {
    /// What it remembers.
    fn states(&self) -> Vec<State> {
        Vec::new()
    }

    /// What it does at this instant, and how its states change (`rates`, one for each state, per second).
    ///
    /// Where some effect adds mass or drag area, all are asked again with the sums in `at`; so mass and drag area that
    /// an effect adds must not depend on them. The force at the wheels is not known yet, but to an effect that follows it.
    fn act(&self, at: &Situation, states: &[f64], rates: &mut [f64]) -> Action;

    /// Whether its powers hang on `at.acceleration_m_s2`: it is asked once more then, when forces have made it.
    fn follows_acceleration(&self) -> bool {
        false
    }

    /// Whether its forces do, as those of an overrun brake: it is asked again and again then, until the acceleration that the forces
    /// make is the one that it was told. Such an effect follows the acceleration as well.
    fn moved_by_acceleration(&self) -> bool {
        false
    }

    /// Whether what it takes of the force of the drive hangs on that force, `at.tractive_force_n`: it is asked again and again then,
    /// until the two agree.
    fn follows_drive(&self) -> bool {
        false
    }

    /// Sets what it remembers anew between two steps, as a switch does; whether anything changed. It is asked once at the begin,
    /// before anything moves.
    fn decide(&self, at: &Situation, states: &mut [f64]) -> bool {
        let _ = (at, states);
        false
    }

    /// Least and greatest force at the wheels [N] that it allows the driveline. A recorded force is beyond its reach, and
    /// so is the force that drove a recorded motion; of that, what it does not allow in braking is left to the brakes.
    fn limits_n(&self, at: &Situation, states: &[f64]) -> (f64, f64) {
        let _ = (at, states);
        (f64::NEG_INFINITY, f64::INFINITY)
    }

    /// How states change that follow the force that is wanted at the wheels, `at.tractive_force_n`; asked after `act`.
    fn follow(&self, at: &Situation, states: &[f64], rates: &mut [f64]) {
        let _ = (at, states, rates);
    }
}
