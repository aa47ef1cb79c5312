//! Families of cases: which vehicle, which runs, which channels.

mod coast;
mod design;
mod electric;
mod fuel;
mod transport;

use crate::dice::Dice;
use crate::plan::{Channel, Plan};
use crate::plant::Sample;
use crate::sensor::Sensor;
use crate::truth::Prior;
pub use design::Design;

/// A family.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Family {
    /// A heavy tractor on soft ground: coast-downs and driven runs both ways on one lane.
    Coast,
    /// A tractor on the road: accelerations with the tractive force measured.
    Transport,
    /// An electric car: motor torque and battery.
    Electric,
    /// A tractor with its engine and fuel logged.
    Fuel,
}

/// What a hidden cause needs of the recording, so that it can show at all.
#[derive(Clone, Debug, Default, PartialEq)]
#[allow(clippy::struct_excessive_bools, reason = "a list of wishes, each yes or no")]
pub struct Needs {
    /// Places along the lane.
    pub position: bool,
    /// Directions of travel.
    pub heading: bool,
    /// An accelerometer.
    pub accelerometer: bool,
    /// Speed of the wheels.
    pub wheel_speed: bool,
    /// Bends, and their curvature.
    pub bends: bool,
    /// Runs with ballast.
    pub ballast: bool,
    /// Runs on warm and cold days.
    pub temperatures: bool,
    /// A brake switch.
    pub brake: bool,
    /// The same ground in every run.
    pub one_lane: bool,
    /// No wind that an anemometer shows.
    pub calm: bool,
    /// Force at the wheels.
    pub force: bool,
    /// Ends of the paths of parameters that the scenario states as they are.
    pub certain: Vec<&'static str>,
    /// Whether every parameter is stated as it is: to test the plant against the model.
    pub exact: bool,
}

impl Family {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Coast, Self::Transport, Self::Electric, Self::Fuel];

    /// As the truth has it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Coast => "coast",
            Self::Transport => "transport",
            Self::Electric => "electric",
            Self::Fuel => "fuel",
        }
    }

    /// Draws a case of it.
    pub fn plan(self, needs: &Needs, dice: &mut Dice) -> Plan {
        match self {
            Self::Coast => coast::plan(needs, dice),
            Self::Transport => transport::plan(needs, dice),
            Self::Electric => electric::plan(needs, dice),
            Self::Fuel => fuel::plan(needs, dice),
        }
    }
}

/// A parameter of the scenario: free with this chance, and then wrong by its spread.
fn prior(
    path: &str,
    truth: f64,
    sd: f64,
    bounds: (f64, f64),
    chance_free: f64,
    needs: &Needs,
    dice: &mut Dice,
) -> Prior {
    /// Nobody states a spread and is wrong by more than this many of it.
    const MOST_SD: f64 = 1.8;
    let (free, error) = (dice.chance(chance_free), dice.normal_within(MOST_SD));
    let certain = needs.certain.iter().any(|end| path.ends_with(end));
    let free = free && !certain && !needs.exact;
    let nominal = if free { (truth + sd * error).clamp(bounds.0, bounds.1) } else { truth };
    // A maker's figure has four digits or so.
    let nominal = if free { rounded(nominal) } else { nominal };
    Prior { path: path.to_owned(), truth, nominal, sd: rounded(sd), bounds, free }
}

/// Four digits.
fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

/// Noise that all channels of a logger share.
struct Logger {
    lag_s: f64,
    hold_s: f64,
}

impl Logger {
    /// A sensor of this logger; its drift lasts 20 s.
    fn sensor(&self, white: f64, drift: f64, step: f64) -> Sensor {
        Sensor { lag_s: self.lag_s, hold_s: self.hold_s, step, white, drift, drift_s: 20.0 }
    }
}

fn channel(name: &'static str, pick: fn(&Sample) -> f64, sensor: Sensor, decimals: usize) -> Channel {
    Channel { name, pick, sensor, decimals }
}

/// An anemometer beside the lane, a value a second: 0.3 m/s and 3°, resolutions of a cup and a vane.
fn anemometer(channels: &mut Vec<Channel>) {
    let cup = Sensor { lag_s: 1.0, hold_s: 1.0, step: 0.1, white: 0.3, ..Sensor::default() };
    let vane = Sensor { step: 0.017, white: 0.05, ..cup };
    channels.push(channel("wind_speed_m_s", |sample| sample.wind_m_s, cup, 2));
    channels.push(channel("wind_direction_rad", |sample| sample.wind_from_rad, vane, 3));
}

fn flag(name: &'static str, pick: fn(&Sample) -> f64) -> Channel {
    channel(name, pick, Sensor::default(), 0)
}

/// A plan of speeds: ramps between random speeds, held for a while.
fn ramps(
    dice: &mut Dice,
    first_m_s: f64,
    speeds: (f64, f64),
    accelerations: (f64, f64),
    holds_s: (f64, f64),
    duration_s: f64,
) -> Vec<(f64, f64)> {
    let (mut time, mut speed) = (dice.within(1.0, 3.0), first_m_s);
    let mut points = vec![(0.0, speed), (time, speed)];
    while time < duration_s {
        let wanted = dice.within(speeds.0, speeds.1);
        if (wanted - speed).abs() < 0.1 * (speeds.1 - speeds.0) {
            continue;
        }
        time += (wanted - speed).abs() / dice.within(accelerations.0, accelerations.1);
        points.push((time, wanted));
        time += dice.within(holds_s.0, holds_s.1);
        points.push((time, wanted));
        speed = wanted;
    }
    points
}
