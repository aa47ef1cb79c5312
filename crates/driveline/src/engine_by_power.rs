//! A combustion engine that is known by its efficiency over power alone, behind a transmission of one efficiency.
//!
//! P_f = max(P / η(P / P_max), P_idle)
//! P   = F v / η_t + P_acc + P_el / η_alt + P_shaft     driving
//! P   =             P_acc + P_el / η_alt + P_shaft     at rest, in neutral, and where the wheels push
//!
//! Source: Guzzella and Sciarretta, *Vehicle Propulsion Systems* (2013), section 3.1 (efficiency maps, reduced to the best
//! efficiency at each power); the form in which libraries of vehicles and generator sets are published.
//!
//! η is straight between its points. The engine turns as it likes: there are no speeds and no torques. Wheels that push find
//! a freewheel: nothing is braked by the engine, and the service brakes take it all. Consumers are always served, beyond full
//! power if need be at the efficiency of full power. Leaves out friction in overrun, boost and shifts.

use crate::parts::{hold, increasing, refuse};
use headland_plugin::{
    Bound, Card, Delivery, Demand, Driveline, Parameter, Plugin, Readings, Refusal, Shaft, parameter,
};
use serde::Deserialize;
use std::path::Path;

const PARAMETERS: [Parameter; 9] = [
    parameter("max_power_w", "W", "greatest power at the shaft, P_max")
        .must_be(Bound::Positive)
        .usually(1e4, 1e6),
    parameter("efficiency", "[(load, efficiency)]", "by power as a share of the greatest, from 0 to 1, η"),
    parameter("idle_fuel_power_w", "W", "least power of the fuel, lower heating value, P_idle")
        .must_be(Bound::NotNegative)
        .usually(0.0, 6e4),
    parameter("lower_heating_value_j_kg", "J/kg", "of the fuel").must_be(Bound::Positive).usually(2.6e7, 5e7),
    parameter("transmission_efficiency", "1", "engine to wheels, η_t")
        .must_be(Bound::Efficiency)
        .usually(0.7, 0.98),
    parameter("max_force_n", "N", "greatest force at the wheels").must_be(Bound::Positive).usually(1e3, 3e5),
    parameter("accessory_power_w", "W", "fan, pumps and compressor, at all times, P_acc")
        .must_be(Bound::NotNegative)
        .usually(0.0, 3e4),
    parameter("alternator_efficiency", "1", "shaft to electric consumers, η_alt")
        .must_be(Bound::Efficiency)
        .usually(0.5, 1.0),
    parameter("rotating_mass_kg", "kg", "inertia of what turns with the wheels, as mass")
        .must_be(Bound::NotNegative)
        .usually(0.0, 3000.0),
];

/// A point of the efficiency as scenarios write it.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Point {
    load: f64,
    efficiency: f64,
}

/// An engine by its efficiency over power.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EngineByPower {
    max_power_w: f64,
    efficiency: Vec<Point>,
    idle_fuel_power_w: f64,
    lower_heating_value_j_kg: f64,
    transmission_efficiency: f64,
    max_force_n: f64,
    accessory_power_w: f64,
    alternator_efficiency: f64,
    rotating_mass_kg: f64,
    #[serde(skip)]
    loads: Vec<f64>,
    /// Of the efficiency, from each load to the next one.
    #[serde(skip)]
    slopes: Vec<f64>,
}

impl Plugin for EngineByPower {
    const CARD: Card = Card {
        name: "EngineByPower",
        about: "an engine by its efficiency over power, behind a transmission of one efficiency that does not push back",
        equation: "P_f = max(P / η(P / P_max), P_idle); P = F v / η_t + P_acc + P_el / η_alt + P_shaft, without F v where it is \
                   negative",
        source: "Guzzella and Sciarretta, Vehicle Propulsion Systems (2013), section 3.1; usual values from memory",
        validity: "quasi-steady; knows no speeds and no torques; leaves out overrun, boost and shifts",
        parameters: &PARAMETERS,
    };

    fn settle(&mut self, _: &Path) -> Result<(), Refusal> {
        hold(&PARAMETERS, &[("max_power_w", self.max_power_w)])?;
        self.loads = self.efficiency.iter().map(|point| point.load).collect();
        increasing("efficiency", &self.loads, 2)?;
        let (first, last) = (self.loads[0], self.loads[self.loads.len() - 1]);
        if first != 0.0 || last != 1.0 {
            return Err(refuse("efficiency", format!("loads from {first} to {last}"), "from 0 to 1"));
        }
        let slope = |[one, two]: &[Point; 2]| (two.efficiency - one.efficiency) / (two.load - one.load);
        self.slopes = self.efficiency.array_windows().map(slope).collect();
        match self.efficiency.iter().find(|point| !Bound::Efficiency.holds(point.efficiency)) {
            Some(point) => Err(refuse("efficiency", point.efficiency, &Bound::Efficiency.in_words())),
            None => Ok(()),
        }
    }
}

impl EngineByPower {
    fn fuel_w(&self, power_w: f64) -> f64 {
        // Beyond full power its efficiency stays.
        let load = (power_w / self.max_power_w).clamp(0.0, 1.0);
        // Counting has no branch to be foreseen, and the points are few.
        let passed = self.loads.iter().map(|point| usize::from(*point <= load)).sum::<usize>();
        let index = passed.saturating_sub(1).min(self.slopes.len() - 1);
        let efficiency = self.efficiency[index].efficiency + self.slopes[index] * (load - self.loads[index]);
        (power_w / efficiency).max(self.idle_fuel_power_w)
    }

    fn others_w(&self, auxiliary_w: f64, shaft_w: f64) -> f64 {
        self.accessory_power_w + auxiliary_w / self.alternator_efficiency + shaft_w
    }
}

impl Driveline for EngineByPower {
    fn losses(&self) -> &'static [&'static str] {
        &["engine heat", "transmission", "accessories"]
    }

    fn source(&self) -> &'static str {
        "fuel"
    }

    fn rotating_mass_kg(&self, _: bool) -> f64 {
        self.rotating_mass_kg
    }

    fn deliver(&self, demand: &Demand, _: &[f64], _: &mut [f64]) -> Delivery {
        let others = self.others_w(demand.auxiliary_power_w, demand.shaft_power_w);
        let (v, eta) = (demand.speed_m_s, self.transmission_efficiency);
        let mut force_n = 0.0;
        if !demand.coasting && demand.force_n * v >= 0.0 {
            force_n = demand.force_n.clamp(-self.max_force_n, self.max_force_n);
            let most = eta * (self.max_power_w - others).max(0.0);
            if force_n * v > most {
                force_n = most / v;
            }
        }
        let wheels = force_n * v;
        let through = wheels / eta;
        let power = through + others;
        let fuel_w = self.fuel_w(power);
        let mut delivery = Delivery { force_n, source_power_w: fuel_w, ..Delivery::NOTHING };
        delivery.losses_w[0] = fuel_w - power;
        delivery.losses_w[1] = through - wheels;
        delivery.losses_w[2] = others - demand.auxiliary_power_w - demand.shaft_power_w;
        delivery.readings =
            Readings { fuel_rate_kg_s: fuel_w / self.lower_heating_value_j_kg, ..Readings::NONE };
        delivery
    }

    fn force_of_shaft_n(&self, shaft: &Shaft) -> Option<f64> {
        let others = self.others_w(shaft.auxiliary_power_w, shaft.shaft_power_w);
        let power = (shaft.torque_n_m * shaft.speed_rad_s - others).max(0.0);
        let force = power * self.transmission_efficiency / shaft.wheel_speed_m_s;
        (force.abs() <= self.max_force_n).then_some(force)
    }
}

#[cfg(test)]
#[path = "engine_by_power_tests.rs"]
mod tests;
