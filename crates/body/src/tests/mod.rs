//! Cross-checks: against the longitudinal fidelity, against formulas, against itself.

mod against_longitudinal;
mod backing;
mod ending;
mod hopping;
mod parts;
mod standing;
mod swinging;
mod towing;
mod turning;

use crate::{AxleBody, Chassis, Differential, Steering, SteeringMode, simulate};
use headland_plugin::{Air, Delivery, Demand, Driveline, Place, Plugin, Soil, Spot, Surface, Terrain, Tyre};
pub use towing::{Tow, hitched};

use headland_sim::{Axle, Axles, Cycle, Model, Outcome, Phase, Resistance, Start, Until, Vehicle};

pub const GRAVITY: f64 = 9.806_65;
pub const MASS_KG: f64 = 13_019.3;

pub const TYRE: Tyre = Tyre {
    width_m: 0.9,
    diameter_m: 2.045,
    section_height_m: 0.54,
    inflation_pa: 1.5e5,
    carcass_pa: 0.0,
    stiffness_n_per_m: None,
};

pub fn axle(position_m: f64) -> Axle {
    Axle { position_m, track_m: 2.1, wheels: 2, tyre: TYRE, lead: Some(1.0) }
}

/// A tractor of 13 t on four equal wheels, its centre of gravity nearer to the front axle.
pub fn axles() -> Axles {
    Axles::new(vec![axle(1.6), axle(-2.0)], 1.3, 0.7, 0.5).unwrap()
}

pub fn chassis() -> Chassis {
    let axle = AxleBody {
        damping_n_s_m: 6e3,
        friction: 0.8,
        side_friction: 0.8,
        slip_stiffness: 12.0,
        cornering_stiffness_per_rad: 6.0,
        relaxation_length_m: 0.7,
        differential: Differential::Locked,
        suspension: None,
    };
    Chassis {
        roll_inertia_kg_m2: 9_000.0,
        pitch_inertia_kg_m2: 32_000.0,
        yaw_inertia_kg_m2: 33_000.0,
        hitch_position_m: -3.2,
        payload: None,
        steering: Steering { mode: SteeringMode::Front, limit_rad: 0.6, rate_rad_s: 0.5, look_ahead_m: 5.0 },
        centre: Differential::Locked,
        axles: vec![axle; 2],
        trailer: None,
    }
}

pub fn terrain<T: Terrain + serde::de::DeserializeOwned + 'static>(ron: &str) -> Box<dyn Terrain> {
    Box::new(ron::from_str::<T>(ron).unwrap())
}

pub fn soil<T: Soil + Plugin>(ron: &str) -> Box<dyn Soil> {
    let options = ron::Options::default().with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME);
    let mut soil = options.from_str::<T>(ron).unwrap();
    soil.settle(std::path::Path::new("")).unwrap();
    Box::new(soil)
}

pub fn driveline<T: Driveline + serde::de::DeserializeOwned + 'static>(ron: &str) -> Box<dyn Driveline> {
    Box::new(ron::from_str::<T>(ron).unwrap())
}

pub fn model(terrain: Box<dyn Terrain>, soil: Box<dyn Soil>) -> Model {
    Model {
        vehicle: Vehicle {
            mass_kg: MASS_KG,
            rotating_mass_kg: 900.0,
            resistance: Resistance::Drag { area_m2: 6.0 },
            brake_friction: f64::INFINITY,
        },
        gravity_m_s2: GRAVITY,
        air: Air { density_kg_m3: 1.238, ..Air::default() },
        terrain,
        axles: Some(axles()),
        soil: Some(soil),
        driveline: driveline::<headland_driveline::Neutral>("()"),
        tasks: Vec::new(),
        effects: Vec::new(),
    }
}

pub fn cycle(speed_m_s: f64, phases: Vec<Phase>, step_s: f64) -> Cycle {
    Cycle {
        start: Start { position_m: 0.0, speed_m_s },
        phases,
        driver_gain_per_s: 1.0,
        step_s,
        longest_s: 1e3,
    }
}

pub fn coast_down() -> Vec<Phase> {
    vec![Phase::Coast { until: Until::Stopped }]
}

pub fn run(model: &Model, cycle: &Cycle) -> Outcome {
    simulate(model, &chassis(), cycle, 0.0).unwrap()
}

pub fn last(outcome: &Outcome, channel: &str) -> f64 {
    *outcome.trace.get(channel).unwrap_or_else(|| panic!("no channel {channel}")).last().unwrap()
}

pub fn channel<'a>(outcome: &'a Outcome, name: &str) -> &'a [f64] {
    outcome.trace.get(name).unwrap_or_else(|| panic!("no channel {name}"))
}

/// A driveline that gives what it is asked for, from a store that loses nothing.
#[derive(Debug)]
pub struct Ideal;

impl Driveline for Ideal {
    fn losses(&self) -> &'static [&'static str] {
        &[]
    }

    fn source(&self) -> &'static str {
        "store"
    }

    fn rotating_mass_kg(&self, _: bool) -> f64 {
        100.0
    }

    fn deliver(&self, demand: &Demand, _: &[f64], _: &mut [f64]) -> Delivery {
        let force_n = if demand.coasting { 0.0 } else { demand.force_n.max(0.0) };
        Delivery { force_n, source_power_w: force_n * demand.speed_m_s, ..Delivery::NOTHING }
    }
}

/// Level ground, and a circle to the right on it.
#[derive(Debug)]
pub struct Circle {
    pub radius_m: f64,
}

impl Surface for Circle {
    fn spot(&self, _: f64, _: f64) -> Option<Spot> {
        Some(Spot::default())
    }
}

impl Terrain for Circle {
    fn at(&self, position_m: f64) -> Place {
        let heading_rad = position_m / self.radius_m;
        Place {
            heading_rad,
            curvature_per_m: 1.0 / self.radius_m,
            east_m: self.radius_m * (1.0 - heading_rad.cos()),
            north_m: self.radius_m * heading_rad.sin(),
            ..Place::default()
        }
    }

    fn surface(&self) -> Option<&dyn Surface> {
        Some(self)
    }
}
