//! A vehicle on its ground, ready to be driven.

use crate::axles::Axles;
use headland_plugin::{Air, Driveline, Effect, Soil, State, Task, Terrain};

/// The body of the vehicle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vehicle {
    /// Mass that rests on the wheels [kg].
    pub mass_kg: f64,
    /// What wheels and axles add to inertia, Σ J i² / r² [kg]; the driveline adds its own.
    pub rotating_mass_kg: f64,
    /// What the air, and perhaps the road, does to it.
    pub resistance: Resistance,
    /// Greatest force of the ground on braked wheels over what rests on them, μ; infinite where only the soil limits it. A
    /// carriage knows the friction of its wheels itself.
    pub brake_friction: f64,
}

/// How the resistance of the vehicle is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Resistance {
    /// By its drag area; the soil model gives the rest.
    Drag {
        /// Drag coefficient times frontal area [m²].
        area_m2: f64,
    },
    /// By road-load coefficients F = f₀ + f₁ v + f₂ v², which hold the resistance of the road too.
    ///
    /// The quadratic term acts on the speed of the air and scales with its density.
    RoadLoad {
        /// Constant part [N].
        f0_n: f64,
        /// Part proportional to speed [N s/m].
        f1_n_s_m: f64,
        /// Part proportional to the square of speed [N s²/m²].
        f2_n_s2_m2: f64,
        /// Density of air at which they were found [kg/m³].
        air_density_kg_m3: f64,
    },
}

impl Resistance {
    /// Drag coefficient times frontal area, at the density of air at which it was found [m²].
    pub fn drag_area_m2(&self) -> f64 {
        match *self {
            Self::Drag { area_m2 } => area_m2,
            Self::RoadLoad { f2_n_s2_m2, air_density_kg_m3, .. } => 2.0 * f2_n_s2_m2 / air_density_kg_m3,
        }
    }
}

/// A plugin with the name that channels and the ledger call it by.
#[derive(Debug)]
pub struct Named<T: ?Sized> {
    /// Unique within the model.
    pub name: String,
    /// The plugin.
    pub plugin: Box<T>,
}

/// A vehicle on its ground.
#[derive(Debug)]
pub struct Model {
    /// The body.
    pub vehicle: Vehicle,
    /// Acceleration of gravity [m/s²].
    pub gravity_m_s2: f64,
    /// The air, where no recording says otherwise.
    pub air: Air,
    /// The path.
    pub terrain: Box<dyn Terrain>,
    /// What carries the vehicle; `None` where it rolls as a whole.
    pub axles: Option<Axles>,
    /// The ground's resistance; `None` where road-load coefficients hold it.
    pub soil: Option<Box<dyn Soil>>,
    /// From the store of energy to the wheels.
    pub driveline: Box<dyn Driveline>,
    /// Work.
    pub tasks: Vec<Named<dyn Task>>,
    /// Added physics.
    pub effects: Vec<Named<dyn Effect>>,
}

/// The state that drivelines with a battery call its charge.
const CHARGE: &str = "state_of_charge";

/// Where each plugin's states stand in the vector of all states.
#[derive(Debug)]
pub(crate) struct Layout {
    pub driveline: std::ops::Range<usize>,
    pub tasks: Vec<std::ops::Range<usize>>,
    pub effects: Vec<std::ops::Range<usize>>,
    /// The charge of the driveline's battery; `None` where it has none.
    pub charge: Option<usize>,
    /// What the driver remembers; `None` where the driver remembers nothing.
    pub driver: Option<usize>,
    /// Channel name and initial value of each state.
    pub states: Vec<(String, f64)>,
}

impl Model {
    /// Names of all states, as they stand in a trace.
    pub fn states(&self) -> Vec<String> {
        self.layout().states.into_iter().map(|(name, _)| name).collect()
    }

    pub(crate) fn layout(&self) -> Layout {
        let mut states = Vec::new();
        let mut claim = |prefix: &str, own: Vec<State>| {
            let first = states.len();
            states.extend(own.into_iter().map(|state| {
                let name = if prefix.is_empty() {
                    state.name.to_owned()
                } else {
                    format!("{prefix}_{}", state.name)
                };
                (name, state.initial)
            }));
            first..states.len()
        };
        let driveline = claim("", self.driveline.states());
        let tasks = self.tasks.iter().map(|task| claim(&task.name, task.plugin.states())).collect();
        let effects = self.effects.iter().map(|effect| claim(&effect.name, effect.plugin.states())).collect();
        let charge = states[driveline.clone()].iter().position(|(name, _)| name == CHARGE);
        Layout { driveline, tasks, effects, charge, driver: None, states }
    }
}
