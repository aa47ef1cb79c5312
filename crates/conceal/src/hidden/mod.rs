//! The causes that are hidden in a case, and what they do to the plant.

mod draw;
mod listed;
mod told;
mod unlisted;

pub use draw::{Setting, ask, draw, listed_of, pair_of, unlisted_for, unlisted_of};
pub use listed::{Law, Spell};
pub use unlisted::Unlisted;

/// The plant at one instant, as a hidden cause sees it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Now {
    /// Time since the log began [s]; negative before.
    pub time_s: f64,
    /// Place on the ground [m]: another lane lies far away.
    pub position_m: f64,
    /// Place along the lane [m].
    pub lane_position_m: f64,
    /// Whether the lane is driven from its end.
    pub reversed: bool,
    /// Index of the run.
    pub run: usize,
    /// How many runs drove this lane before.
    pub passes_before: f64,
    /// Speed over ground [m/s].
    pub speed_m_s: f64,
    /// Speed against the air, squared, with its sign [m²/s²].
    pub air_speed_2: f64,
    /// Wind that the scenario knows of: towards north and towards east, and negative [m/s].
    pub known_wind_m_s: [f64; 2],
    /// Acceleration [m/s²].
    pub acceleration_m_s2: f64,
    /// Direction of travel [rad].
    pub heading_rad: f64,
    /// Curvature in the direction of travel [1/m].
    pub curvature_per_m: f64,
    /// Mass on the wheels, hidden mass not included [kg].
    pub mass_kg: f64,
    /// Acceleration of gravity [m/s²].
    pub gravity_m_s2: f64,
    /// Resistance of the ground over load, hidden parts not included.
    pub ground_share: f64,
    /// Drag area [m²].
    pub drag_area_m2: f64,
    /// Density of the air [kg/m³].
    pub air_density_kg_m3: f64,
    /// Temperature of the air [°C].
    pub air_c: f64,
    /// Force at the driven wheels as it is measured [N].
    pub drive_n: f64,
    /// Whether it is in neutral.
    pub coasting: bool,
    /// Current of the battery [A].
    pub current_a: f64,
    /// Force at the wheels that the driver wants [N].
    pub asked_n: f64,
    /// What friction brakes add, because the drive may not brake as much [N].
    pub overflow_n: f64,
    /// What the engine could not give of what was asked [N].
    pub lacking_n: f64,
    /// Speed of the engine [rad/s].
    pub engine_rad_s: f64,
    /// Power of the fuel for each watt at the crankshaft; 0 without an engine.
    pub fuel_per_shaft: f64,
    /// Power at the crankshaft for each watt of electric consumers.
    pub shaft_per_electric: f64,
    /// What the cause itself remembers.
    pub memory: f64,
}

/// What a hidden cause does.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Push {
    /// Force on the body, forward [N].
    pub forward_n: f64,
    /// Mass that is carried [kg].
    pub mass_kg: f64,
    /// Mass that only turns [kg].
    pub turning_kg: f64,
    /// Sine of a slope, uphill in the direction of travel.
    pub sin_slope: f64,
    /// Creep of the wheels for a pull as great as the load.
    pub creep: f64,
    /// Power taken from the battery [W].
    pub power_w: f64,
    /// Resistance of the battery [Ω].
    pub resistance_ohm: f64,
    /// Friction at the crankshaft [N m].
    pub engine_n_m: f64,
    /// Whether the service brakes are on.
    pub braked: bool,
}

impl Push {
    /// Both together.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            forward_n: self.forward_n + other.forward_n,
            mass_kg: self.mass_kg + other.mass_kg,
            turning_kg: self.turning_kg + other.turning_kg,
            sin_slope: self.sin_slope + other.sin_slope,
            creep: self.creep + other.creep,
            power_w: self.power_w + other.power_w,
            resistance_ohm: self.resistance_ohm + other.resistance_ohm,
            engine_n_m: self.engine_n_m + other.engine_n_m,
            braked: self.braked || other.braked,
        }
    }
}

/// A parameter of a hidden cause, as the truth tells it.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Told {
    /// Its name.
    pub name: String,
    /// Its value, in its unit.
    pub value: f64,
    /// Its unit.
    pub unit: String,
}

pub(crate) fn parameter(name: &str, value: f64, unit: &str) -> Told {
    Told { name: name.to_owned(), value, unit: unit.to_owned() }
}
