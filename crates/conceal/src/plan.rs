//! Everything that a case is made of before it is driven.

use crate::course::Course;
use crate::plant::{Goal, Sample, Stop, Vehicle};
use crate::sensor::Sensor;
use crate::truth::Prior;

/// One channel of the logs.
#[derive(Clone, Copy, Debug)]
pub struct Channel {
    /// Its name, as the contract has it.
    pub name: &'static str,
    /// What is measured.
    pub pick: fn(&Sample) -> f64,
    /// How.
    pub sensor: Sensor,
    /// Decimals that are written.
    pub decimals: usize,
}

/// One run.
#[derive(Clone, Debug, PartialEq)]
pub struct RunPlan {
    /// Its name.
    pub id: String,
    /// Whether the lane is driven from its end.
    pub reversed: bool,
    /// Which lane.
    pub lane: usize,
    /// Where this lane begins on the ground [m].
    pub lane_m: f64,
    /// Whether it is kept from every fit.
    pub held_out: bool,
    /// Where it begins [m].
    pub position_m: f64,
    /// Speed at which it begins [m/s].
    pub speed_m_s: f64,
    /// Ballast that the recording states [kg].
    pub ballast_kg: f64,
    /// Temperature of the air [°C].
    pub air_c: f64,
    /// What the driver wants.
    pub goal: Goal,
    /// When it ends.
    pub stop: Stop,
}

/// The nominal scenario, and how far it may be wrong.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Nominal {
    /// Its parameters: true value, stated value, stated spread; those that are free are told as such.
    pub priors: Vec<Prior>,
    /// Text of the vehicle, with `{name}` where the nominal value of a parameter stands.
    pub vehicle: String,
    /// Text of the soil, likewise.
    pub soil: String,
    /// Half width of the local fit of speed [s].
    pub smoothing_s: f64,
}

/// A case before hidden causes are put in.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Name of the family.
    pub family: &'static str,
    /// What the recording is about.
    pub about: String,
    /// The vehicle as it is.
    pub vehicle: Vehicle,
    /// The lane.
    pub course: Course,
    /// The runs, in the order in which they were driven.
    pub runs: Vec<RunPlan>,
    /// The channels of the logs.
    pub channels: Vec<Channel>,
    /// Rows a second.
    pub rate_hz: f64,
    /// How far the time between two rows is off at most, as a share of it.
    pub uneven: f64,
    /// Wind that the anemometer shows, north and east of where it comes from [m/s].
    pub wind_m_s: [f64; 2],
    /// Whether the recording says which runs share a lane.
    pub paths_told: bool,
    /// Whether it says which runs are kept out.
    pub held_out_told: bool,
    /// Time that a run rolls before its log begins [s].
    pub before_s: f64,
    /// The scenario.
    pub nominal: Nominal,
}

impl Plan {
    /// Whether the logs have a channel.
    pub fn has(&self, name: &str) -> bool {
        self.channels.iter().any(|channel| channel.name == name)
    }

    /// Whether a force at the wheels can be had from the logs: measured, by a torque, or none while coasting.
    pub fn knows_force(&self) -> bool {
        ["tractive_force_n", "motor_torque_n_m", "coasting"].iter().any(|name| self.has(name))
    }

    /// The sensor of a channel.
    pub fn sensor(&self, name: &str) -> Option<&Sensor> {
        self.channels.iter().find(|channel| channel.name == name).map(|channel| &channel.sensor)
    }

    /// White noise of a channel after it was averaged over one second.
    pub fn second_noise(&self, name: &str) -> f64 {
        let Some(sensor) = self.sensor(name) else { return 0.0 };
        let rate = if sensor.hold_s > 0.0 { self.rate_hz.min(1.0 / sensor.hold_s) } else { self.rate_hz };
        let white = sensor.white.hypot(sensor.step / 12f64.sqrt());
        white / rate.sqrt()
    }

    /// Noise of the balance of forces at one second: slope of the noisy speed, and the noisy force [N].
    ///
    /// A straight line through n samples within T has a slope of standard deviation σ √12 / (T √n).
    pub fn force_noise_n(&self) -> f64 {
        let mass = self.vehicle.mass_kg + self.vehicle.turning_kg;
        let speed = 12f64.sqrt() * mass * self.second_noise("speed_m_s");
        let torque = match &self.vehicle.electric {
            Some(electric) => self.second_noise("motor_torque_n_m") * electric.gear_ratio / electric.radius_m,
            None => self.second_noise("tractive_force_n"),
        };
        speed.hypot(torque)
    }

    /// Noise of the balance of battery or fuel at one second [W].
    pub fn power_noise_w(&self) -> f64 {
        if let Some(engine) = &self.vehicle.engine {
            return engine.heat_j_kg * self.second_noise("fuel_rate_kg_s");
        }
        let Some(electric) = &self.vehicle.electric else { return 0.0 };
        let current = electric.voltage_v * self.second_noise("battery_current_a");
        let voltage = 30.0 * self.second_noise("battery_voltage_v");
        let torque = 400.0 * self.second_noise("motor_torque_n_m");
        current.hypot(voltage).hypot(torque)
    }
}
