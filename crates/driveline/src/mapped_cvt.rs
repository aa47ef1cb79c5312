//! An engine behind a continuously variable transmission whose ratio is known from a recording.
//!
//! ω    = map(v, F), linear between its points
//! P_in = F v / η + T_0 ω   driving,   F v η + T_0 ω   overrun
//!
//! Source: Renius, *Fundamentals of Tractor Design* (2020), chapter 5, for transmissions that are driven by a map of engine
//! speeds; Guzzella and Onder (2010) for the engine.
//!
//! Nothing is extrapolated: a speed or a force at which the map holds nothing ends the run with that reason. An engine speed
//! of 0 in the map stands for 'never seen'. In neutral the engine idles.

use crate::engine::{Circumstance, ENGINE, Engine, PATIENCE_S};
use crate::parts::{crossing, increasing, join, place, refuse};
use headland_plugin::{
    Bound, Card, Delivery, Demand, Driveline, Parameter, Plugin, Readings, Refusal, State, parameter,
};
use serde::Deserialize;
use std::path::Path;

const OWN: [Parameter; 10] = [
    parameter("speeds_m_s", "[m/s]", "speeds of the map, two or more, increasing, v")
        .must_be(Bound::NotNegative)
        .usually(0.0, 20.0),
    parameter("forces_n", "[N]", "forces at the wheels of the map, two or more, increasing, F")
        .must_be(Bound::Finite)
        .usually(-1.5e5, 3e5),
    parameter(
        "engine_speeds_rad_s",
        "[rad/s]",
        "one list for each speed, one engine speed for each force; 0 where it was never seen, ω",
    )
    .must_be(Bound::NotNegative)
    .usually(0.0, 300.0),
    parameter(
        "map",
        "(speeds_m_s, forces_n, engine_speeds_rad_s, covered_share)",
        "or instead the three, in a file of their own that `headland cvt-map` made",
    ),
    parameter("transmission_efficiency", "1", "engine to wheels, η")
        .must_be(Bound::Efficiency)
        .usually(0.7, 0.98),
    parameter("idle_torque_n_m", "N m", "that it takes without load, T_0")
        .must_be(Bound::NotNegative)
        .usually(0.0, 100.0),
    parameter("max_force_n", "N", "greatest force at the wheels, driving or braking")
        .must_be(Bound::Positive)
        .usually(1e3, 3e5),
    parameter("wheel_radius_m", "m", "rolling radius, for the ratio shown")
        .must_be(Bound::Positive)
        .usually(0.2, 1.2),
    parameter("rotating_mass_kg", "kg", "inertia of what turns with the wheels, as mass")
        .must_be(Bound::NotNegative)
        .usually(0.0, 3000.0),
    // A map is most often made of one drive; what it was is for people.
    parameter(
        "covered_share",
        "1",
        "share of the cells that were seen, as the tool that made the map found; 1 by hand",
    )
    .must_be(Bound::Within(0.0, 1.0))
    .usually(0.0, 1.0)
    .or(1.0),
];

const PARAMETERS: [Parameter; ENGINE.len() + OWN.len()] = join(&[&ENGINE, &OWN]);

/// An engine and a map of its speeds.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MappedCvt {
    engine: Engine,
    #[serde(default)]
    speeds_m_s: Vec<f64>,
    #[serde(default)]
    forces_n: Vec<f64>,
    #[serde(default)]
    engine_speeds_rad_s: Vec<Vec<f64>>,
    #[serde(default)]
    map: Option<Map>,
    transmission_efficiency: f64,
    idle_torque_n_m: f64,
    max_force_n: f64,
    wheel_radius_m: f64,
    rotating_mass_kg: f64,
    #[serde(default = "whole", rename = "covered_share")]
    _covered_share: f64,
}

/// A map in a file of its own, as `headland cvt-map` writes it.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "map")]
struct Map {
    speeds_m_s: Vec<f64>,
    forces_n: Vec<f64>,
    engine_speeds_rad_s: Vec<Vec<f64>>,
    #[serde(default = "whole", rename = "covered_share")]
    _covered_share: f64,
}

const fn whole() -> f64 {
    1.0
}

impl Plugin for MappedCvt {
    const CARD: Card = Card {
        name: "MappedCvt",
        about: "an engine behind a continuously variable transmission whose engine speed is a map of speed and force",
        equation: "ω = map(v, F); P_in = F v η^(∓1) + T_0 ω",
        source: "Renius, Fundamentals of Tractor Design (2020), chapter 5; Guzzella and Onder, Introduction to Modeling and \
                 Control of Internal Combustion Engine Systems (2010); usual values from memory",
        validity: "where the map was seen, and nowhere else, but at an engine speed that is kept or was recorded; quasi-steady",
        parameters: &PARAMETERS,
    };

    fn settle(&mut self, _: &Path) -> Result<(), Refusal> {
        self.engine.settle()?;
        let lists =
            !(self.speeds_m_s.is_empty() && self.forces_n.is_empty() && self.engine_speeds_rad_s.is_empty());
        match self.map.take() {
            Some(_) if lists => return Err(refuse("map", "given beside its lists", "one of the two")),
            Some(map) => {
                (self.speeds_m_s, self.forces_n) = (map.speeds_m_s, map.forces_n);
                self.engine_speeds_rad_s = map.engine_speeds_rad_s;
            }
            None if !lists => {
                let expected = "it, or `speeds_m_s`, `forces_n` and `engine_speeds_rad_s`";
                return Err(refuse("map", "not given", expected));
            }
            None => {}
        }
        increasing("speeds_m_s", &self.speeds_m_s, 2)?;
        increasing("forces_n", &self.forces_n, 2)?;
        let rows = &self.engine_speeds_rad_s;
        if rows.len() != self.speeds_m_s.len() || rows.iter().any(|row| row.len() != self.forces_n.len()) {
            let found =
                format!("{} lists of {:?}", rows.len(), rows.iter().map(Vec::len).collect::<Vec<_>>());
            let expected = format!("{} lists of {}", self.speeds_m_s.len(), self.forces_n.len());
            return Err(refuse("engine_speeds_rad_s", found, &expected));
        }
        let (idle, last) = (self.engine.idle_rad_s(), self.engine.last_rad_s());
        let turns = |speed: f64| speed == 0.0 || (speed >= idle && speed <= last);
        if let Some(speed) = rows.iter().flatten().find(|speed| !turns(**speed)) {
            let expected = format!("0, or {idle} to {last} as the engine can turn");
            return Err(refuse("engine_speeds_rad_s", speed, &expected));
        }
        Ok(())
    }
}

impl MappedCvt {
    /// Engine speed at a speed and a force, both in the direction of driving: the one that is kept by hand or was recorded, and else
    /// the map's; `None` where the map holds nothing.
    fn engine_rad_s(&self, speed: f64, force: f64, hand_rad_s: f64) -> Option<f64> {
        if hand_rad_s > 0.0 {
            return Some(hand_rad_s.clamp(self.engine.idle_rad_s(), self.engine.last_rad_s()));
        }
        let within = |grid: &[f64], value: f64| value >= grid[0] && value <= grid[grid.len() - 1];
        if !(within(&self.speeds_m_s, speed) && within(&self.forces_n, force)) {
            return None;
        }
        let ((row, along), (column, across)) = (place(&self.speeds_m_s, speed), place(&self.forces_n, force));
        let mut sum = 0.0;
        for (row, weight) in [(row, 1.0 - along), (row + 1, along)] {
            for (column, share) in [(column, 1.0 - across), (column + 1, across)] {
                let seen = self.engine_speeds_rad_s[row][column];
                let weight = weight * share;
                if weight > 0.0 && seen == 0.0 {
                    return None;
                }
                sum += weight * seen;
            }
        }
        Some(sum)
    }

    /// Power that the transmission takes.
    fn input_w(&self, speed: f64, force: f64, engine: f64) -> f64 {
        let (wheels, eta) = (force * speed, self.transmission_efficiency);
        let through = if wheels > 0.0 { wheels / eta } else { wheels * eta };
        through + self.idle_torque_n_m * engine
    }

    /// Force and engine speed in the direction of driving, with `others` taken from the shaft; `None` off the map.
    fn working(&self, demand: &Demand, at: &Circumstance, others: f64, way: f64) -> Option<(f64, f64)> {
        let (speed, wanted) = (demand.speed_m_s.abs(), demand.force_n * way);
        let wanted = wanted.clamp(-self.max_force_n, self.max_force_n);
        let engine = self.engine_rad_s(speed, wanted, at.hand_rad_s)?;
        let spare = |force: f64, engine: f64| {
            let power = self.input_w(speed, force, engine) + others + self.engine.accessories_w(engine);
            let full_load_w = self.engine.limit(at.boost) * self.engine.full_torque_n_m(engine) * engine;
            // A force that was recorded was there.
            let most = if demand.recorded { f64::INFINITY } else { full_load_w };
            let least = -self.engine.friction_w(engine, at.friction_n_m);
            (most - power, power - least)
        };
        let (above, below) = spare(wanted, engine);
        let short = |less: f64| {
            // Off the map on the way down nothing is known: the force falls to what is.
            let force = wanted - less;
            self.engine_rad_s(speed, force, at.hand_rad_s).map_or(1.0, |engine| {
                let (above, below) = spare(force, engine);
                if wanted > 0.0 { above } else { below }
            })
        };
        let force = if (wanted > 0.0 && above < 0.0) || (wanted < 0.0 && below < 0.0) {
            let far = wanted.abs();
            wanted - wanted.signum() * crossing(0.0, far, |less| short(less * wanted.signum()))
        } else {
            wanted
        };
        Some((force, self.engine_rad_s(speed, force, at.hand_rad_s)?))
    }
}

impl Driveline for MappedCvt {
    fn states(&self) -> Vec<State> {
        vec![
            State { name: "boost", initial: 0.0 },
            State { name: "fuel_m3", initial: 0.0 },
            State { name: "carbon_dioxide_kg", initial: 0.0 },
        ]
    }

    fn losses(&self) -> &'static [&'static str] {
        &["engine heat", "transmission", "accessories"]
    }

    fn source(&self) -> &'static str {
        "fuel"
    }

    fn rotating_mass_kg(&self, _: bool) -> f64 {
        self.rotating_mass_kg
    }

    fn deliver(&self, demand: &Demand, states: &[f64], rates: &mut [f64]) -> Delivery {
        let boost = states.first().copied().unwrap_or(0.0);
        let at = Circumstance {
            boost,
            friction_n_m: demand.engine_friction_n_m,
            hand_rad_s: demand.engine_speed_rad_s,
        };
        let alternator_w = self.engine.alternator_w(demand.auxiliary_power_w);
        let others = alternator_w + demand.shaft_power_w;
        let way = if demand.speed_m_s == 0.0 { demand.force_n.signum() } else { demand.speed_m_s.signum() };
        let known = if demand.coasting { None } else { self.working(demand, &at, others, way) };
        // Neutral, or off the map, where `exhausted` ends the run.
        let (force, engine) = known.unwrap_or((0.0, self.engine.speed_rad_s(others, &at)));
        let input_w = known
            .map_or(self.idle_torque_n_m * engine, |_| self.input_w(demand.speed_m_s.abs(), force, engine));
        let running = self.engine.run_at(engine, input_w + others, &at);
        if let [boost, volume, carbon] = rates {
            *boost = running.boost_per_s;
            (*volume, *carbon) = self.engine.burnt(running.fuel_w);
        }
        let force_n = force * way;
        let mut delivery = Delivery { force_n, source_power_w: running.fuel_w, ..Delivery::NOTHING };
        delivery.losses_w[0] = running.heat_w();
        delivery.losses_w[1] = input_w - force_n * demand.speed_m_s;
        delivery.losses_w[2] = running.accessories_w + alternator_w - demand.auxiliary_power_w;
        let wheel = demand.speed_m_s.abs() / self.wheel_radius_m;
        delivery.readings = Readings {
            engine_speed_rad_s: engine,
            engine_torque_n_m: running.torque_n_m(),
            fuel_rate_kg_s: running.fuel_w / self.engine.heating_value_j_kg(),
            cvt_ratio: if known.is_none() || wheel == 0.0 { f64::NAN } else { engine / wheel },
            ..Readings::NONE
        };
        delivery
    }

    fn patience_s(&self) -> f64 {
        PATIENCE_S
    }

    fn exhausted(&self, demand: &Demand, _: &Delivery, _: &[f64]) -> Option<String> {
        if demand.coasting {
            return None;
        }
        let way = if demand.speed_m_s == 0.0 { demand.force_n.signum() } else { demand.speed_m_s.signum() };
        let (speed, force) = (demand.speed_m_s.abs(), demand.force_n * way);
        let force = force.clamp(-self.max_force_n, self.max_force_n);
        self.engine_rad_s(speed, force, demand.engine_speed_rad_s).is_none().then(|| {
            format!(
                "the map of engine speeds holds nothing at {speed:.2} m/s and {force:.0} N, and is not extrapolated; it goes \
                 from {} to {} m/s and from {} to {} N",
                self.speeds_m_s[0],
                self.speeds_m_s[self.speeds_m_s.len() - 1],
                self.forces_n[0],
                self.forces_n[self.forces_n.len() - 1]
            )
        })
    }
}

#[cfg(test)]
#[path = "mapped_cvt_tests.rs"]
mod tests;
