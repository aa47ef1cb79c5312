//! What a coast-down analysis is given.

use headland_trace::Trace;
use serde::{Deserialize, Serialize};

/// A constant that is known and not logged, with one standard deviation in the same unit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Constant {
    /// Value.
    pub value: f64,
    /// One standard deviation, 0 where it is exact.
    pub sd: f64,
}

impl Constant {
    /// A constant known exactly.
    pub const fn exact(value: f64) -> Self {
        Self { value, sd: 0.0 }
    }

    /// A constant with an uncertainty.
    pub const fn new(value: f64, sd: f64) -> Self {
        Self { value, sd }
    }
}

/// One run of a coast-down study.
///
/// The trace needs `speed_m_s`. It may hold `coasting` (1 in neutral), `brake` (1 braked), `grade` (in the direction of
/// travel), `heading_rad`, `wind_speed_m_s` and `wind_direction_rad`; what it does not hold is taken as level and calm.
#[derive(Clone, Debug, PartialEq)]
pub struct CoastRun {
    /// Name, unique in the study.
    pub id: String,
    /// The channels.
    pub trace: Trace,
    /// Runs that share a path drove the same ground; runs without one share a path of their own.
    pub path: Option<String>,
    /// Whether the path was driven from its end to its start.
    pub reversed: bool,
    /// Mass on the scales [kg].
    pub mass_kg: Constant,
    /// Σ J i²/r² of all that turns with the wheels [kg].
    pub rotating_mass_kg: Constant,
    /// Drag coefficient times frontal area [m²].
    pub drag_area_m2: Option<Constant>,
    /// Density of the air [kg/m³].
    pub air_density_kg_m3: Option<Constant>,
    /// Direction of travel, clockwise from north [rad], where the trace has no `heading_rad`.
    pub heading_rad: Option<f64>,
}

impl CoastRun {
    /// Mass that the force has to slow down [kg].
    pub fn effective_mass_kg(&self) -> f64 {
        self.mass_kg.value + self.rotating_mass_kg.value
    }
}

/// The unit of v in c_w (1 + v/100). The force at 30 km/h changes by up to 17 % with it, so it is always stated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum SpeedUnit {
    /// Kilometres an hour.
    #[serde(rename = "km/h")]
    KilometresPerHour,
    /// Miles an hour.
    #[serde(rename = "mph")]
    MilesPerHour,
    /// Metres a second.
    #[serde(rename = "m/s")]
    MetresPerSecond,
}

impl SpeedUnit {
    /// The three units that the law is found with.
    pub const ALL: [Self; 3] = [Self::KilometresPerHour, Self::MilesPerHour, Self::MetresPerSecond];

    /// A hundred of the unit [m/s].
    pub const fn hundred_m_s(self) -> f64 {
        match self {
            Self::KilometresPerHour => 100.0 / 3.6,
            Self::MilesPerHour => 44.704,
            Self::MetresPerSecond => 100.0,
        }
    }

    /// Its symbol.
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::KilometresPerHour => "km/h",
            Self::MilesPerHour => "mph",
            Self::MetresPerSecond => "m/s",
        }
    }
}

/// How a study is analysed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// Unit of v in c_w (1 + v/100); without it there is no c_w, only road loads.
    pub speed_law_unit: Option<SpeedUnit>,
    /// Samples slower than this are left out [m/s]: the last roll is Coulomb friction, sinkage and sensor floor.
    pub lowest_speed_m_s: f64,
    /// Left out after the clutch opens and before the end of the stretch [s].
    pub trim_s: f64,
    /// Width over which the two-stage method differentiates speed [s].
    pub difference_s: f64,
    /// Replicates of the bootstrap over runs.
    pub replicates: usize,
    /// Seed of the bootstrap.
    pub seed: u64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            speed_law_unit: None,
            lowest_speed_m_s: 0.5,
            trim_s: 0.5,
            difference_s: 0.2,
            replicates: 1999,
            seed: 1,
        }
    }
}
