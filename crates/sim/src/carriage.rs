//! What may move a vehicle in place of the longitudinal balance: a body on wheels, made elsewhere.
//!
//! A run with a carriage is driven by the same cycle, driver, driveline, tasks and effects. Once a step they are asked for
//! their forces at the motion that the carriage has ([`Push`]); the carriage makes the step and tells what became of the
//! work ([`Stepped`]).

use headland_plugin::Place;
use std::fmt::Debug;

/// What the models push a vehicle with during one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Push {
    /// Force of the driveline at the driven wheels, forward, less what effects take of it [N].
    pub drive_n: f64,
    /// The way that the vehicle goes or is to go, 1 or −1: a force of the driveline against it brakes, and turns no wheel back.
    pub way: f64,
    /// The most that the brakes hold the wheels with [N]; infinite where they are to stand.
    pub brake_n: f64,
    /// Force in the centre of gravity, forward, whether the vehicle moves or not: air and effects [N].
    pub free_n: f64,
    /// Force in the centre of gravity against the motion, which holds at rest [N].
    pub resistance_n: f64,
    /// Pull at the hitch against the motion, which holds at rest [N].
    pub drawbar_n: f64,
    /// Force at the hitch, forward, whether the vehicle moves or not [N].
    pub hitch_n: f64,
    /// Mass that rests on the wheels [kg].
    pub mass_kg: f64,
    /// Mass that is pulled on other wheels [kg].
    pub towed_kg: f64,
    /// Part of `mass_kg` that belongs to what is pulled: the vehicle carries it at the hitch [kg].
    pub coupled_kg: f64,
    /// Part of `drawbar_n` that what is pulled takes on its own wheels [N].
    pub towed_n: f64,
    /// What driveline and effects add to the inertia of the driven wheels [kg].
    pub turning_kg: f64,
}

/// What became of one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stepped {
    /// Way of the centre of gravity along the vehicle [m].
    pub forward_m: f64,
    /// Way of the hitch [m].
    pub hitch_m: f64,
    /// Way of the driven wheels, as they roll [m].
    pub driven_m: f64,
    /// How much of the resistances acted, and which way: 1 driving forward, −1 backward, in between about a rest.
    pub way: f64,
    /// What the ground took [J].
    pub soil_j: f64,
    /// What slip along the wheels took [J].
    pub slip_j: f64,
    /// Part of the pull at the hitch that acted on wheels of its own instead [N], and what it took there.
    pub towed_n: f64,
    /// What that took [J].
    pub towed_j: f64,
    /// Gain of potential energy [J].
    pub slope_j: f64,
    /// What the brakes took [J].
    pub brakes_j: f64,
    /// What came aboard or left with mass at speed [J].
    pub mass_j: f64,
}

/// How a carriage moves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Distance along the path [m].
    pub position_m: f64,
    /// Speed of the centre of gravity along the vehicle [m/s]; exactly 0 where it rests.
    pub speed_m_s: f64,
    /// Its acceleration over the last step [m/s²]; `None` before the first.
    pub acceleration_m_s2: Option<f64>,
    /// Speed at which the driven wheels roll [m/s].
    pub driven_m_s: f64,
    /// Where it is: the path's slope and curvature, its own heading and place on the map.
    pub place: Place,
    /// What the ground resists its wheels with [N].
    pub resistance_n: f64,
    /// Slip of the driven wheels.
    pub slip: f64,
}

/// What one axle does.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AxleMotion {
    /// Load of its wheels [N].
    pub load_n: f64,
    /// Mean slip of them.
    pub slip: f64,
    /// Gross traction: torque at them per rolling radius [N].
    pub traction_n: f64,
    /// What resists [N].
    pub resistance_n: f64,
    /// Mean depth of the ruts [m]; NaN where the soil does not know it.
    pub sinkage_m: f64,
}

/// What moves a vehicle.
pub trait Carriage: Debug {
    /// How it moves now.
    fn motion(&self) -> Motion;

    /// What an axle does, by its index.
    fn axle(&self, index: usize) -> AxleMotion;

    /// Makes a step; `None` where there is none to be made. Then it stands as it stood, and [`Carriage::trouble`] says why.
    fn advance(&mut self, push: &Push, step_s: f64) -> Option<Stepped>;

    /// Why it cannot go on.
    fn trouble(&self) -> Option<String>;

    /// Its kinetic energy, wheels and what turns with them included [J].
    fn kinetic_j(&self) -> f64;

    /// What it took beside what [`Stepped`] tells, by name [J].
    fn accounts(&self) -> Vec<(&'static str, f64)>;

    /// Names of the channels that it has beside those of every run.
    fn channels(&self) -> Vec<String>;

    /// A value for each of them.
    fn write(&self, row: &mut Vec<f64>);
}
