//! An engine behind an input-split hydrostatic-mechanical transmission with ranges.
//!
//! ω_out = a_j ω_e + b_j ω_m;  T_m = b_j T_out;  V_m Δp = T_m + T_f;  P_in = a_j T_out ω_e + T_p ω_p + T_spin ω_e
//! the engine turns as slowly as P_in allows, and at least as fast as the greatest ratio needs
//!
//! Source: Renius, *Fundamentals of Tractor Design* (2020), chapter 5; Wilson (1950) for the hydrostat; Guzzella and Onder
//! (2010) for the engine.
//!
//! The range is decided between two steps: it stays until it does not reach or another is much nearer to its node. Other
//! consumers are always served, beyond full load if need be. Leaves out inertia of the engine and the time and heat that a
//! change of ratio or range takes.

use crate::engine::{Circumstance, ENGINE, Engine, PATIENCE_S, Running};
use crate::hydromechanical::{Hydromechanical, TRANSMISSION};
use crate::parts::{crossing, join};
use headland_plugin::{Card, Delivery, Demand, Driveline, Parameter, Plugin, Readings, Refusal, State};
use serde::Deserialize;
use std::path::Path;

const PARAMETERS: [Parameter; ENGINE.len() + TRANSMISSION.len()] = join(&[&ENGINE, &TRANSMISSION]);

/// An engine and a power-split transmission.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HydromechanicalCvt {
    engine: Engine,
    transmission: Hydromechanical,
}

impl Plugin for HydromechanicalCvt {
    const CARD: Card = Card {
        name: "HydromechanicalCvt",
        about: "an engine behind an input-split hydrostatic-mechanical transmission with ranges, nodes and losses of the hydrostat",
        equation: "ω_out = a_j ω_e + b_j ω_m; T_m = b_j T_out; V_m Δp = T_m + T_f; ε V_p ω_p = V_m ω_m + C_s (V_m + V_p) Δp / μ; \
                   P_in = a_j T_out ω_e + T_p ω_p + T_spin ω_e + (1 − η_z) (|a_j T_out ω_e| + |b_j T_out ω_m|); \
                   T_f = C_d V μ |ω| + C_f V |Δp| + T_c; T_out = F r / (i_f η_a^(±1))",
        source: "Renius, Fundamentals of Tractor Design (2020), chapter 5; Wilson, Positive-Displacement Pumps and Fluid Motors \
                 (1950); Guzzella and Onder, Introduction to Modeling and Control of Internal Combustion Engine Systems (2010); \
                 usual values of engine and transmission from memory",
        validity: "quasi-steady; leaves out inertia of the engine, oil temperature, and time and heat of a change of range",
        parameters: &PARAMETERS,
    };

    fn settle(&mut self, _: &Path) -> Result<(), Refusal> {
        self.engine.settle()?;
        self.transmission.settle()
    }
}

const RANGE: usize = 1;
const SINCE: usize = 2;

/// A change of range takes 0.2 to 0.4 s; the next one has to wait for it.
const RANGE_TIME_S: f64 = 0.3;

/// Rounds in which the speed of the engine and what the transmission takes at it find each other.
const ROUNDS: usize = 3;

/// A first guess at the transmission, which the rounds forget.
const GUESSED_EFFICIENCY: f64 = 0.85;

/// What engine and transmission do for a force.
struct Working {
    speed_rad_s: f64,
    input_w: f64,
}

impl HydromechanicalCvt {
    fn working(
        &self,
        demand: &Demand,
        at: &Circumstance,
        range: f64,
        force_n: f64,
        others_w: f64,
    ) -> Working {
        let v = demand.speed_m_s.abs();
        let least = if demand.coasting { 0.0 } else { self.transmission.least_engine_rad_s(v) };
        let takes = |speed: f64| {
            if demand.coasting {
                self.transmission.neutral_w(speed)
            } else {
                self.transmission.through(range, v, force_n, speed).input_w
            }
        };
        let mut input_w = if demand.coasting { 0.0 } else { force_n * v / GUESSED_EFFICIENCY };
        let mut speed_rad_s = 0.0;
        for _ in 0..ROUNDS {
            speed_rad_s = self.engine.speed_rad_s(input_w + others_w, at).max(least);
            input_w = takes(speed_rad_s);
        }
        Working { speed_rad_s, input_w }
    }

    /// The most and the least that the engine gives beside its accessories, where the greatest ratio makes it turn fast.
    fn reach_w(&self, demand: &Demand, at: &Circumstance) -> (f64, f64) {
        let least = self.transmission.least_engine_rad_s(demand.speed_m_s.abs());
        (self.engine.most_from_w(least, at), self.engine.least_w(at))
    }

    /// The force of those asked for that engine and transmission can make.
    fn force_n(&self, demand: &Demand, at: &Circumstance, range: f64, others_w: f64) -> f64 {
        if demand.coasting {
            return 0.0;
        }
        let way = if demand.speed_m_s == 0.0 { demand.force_n.signum() } else { demand.speed_m_s.signum() };
        let wanted = demand.force_n * way;
        let slow = self.engine.idle_rad_s().max(self.transmission.least_engine_rad_s(demand.speed_m_s));
        let (drives, brakes) = self.transmission.most_force_n(range, demand.speed_m_s, slow);
        let wanted = wanted.clamp(-brakes, drives);
        let (most, least) = self.reach_w(demand, at);
        let needs = |force: f64| self.working(demand, at, range, force, others_w).input_w + others_w;
        let power = needs(wanted);
        let force = if wanted > 0.0 && power > most {
            crossing(0.0, wanted, |force| needs(force) - most)
        } else if wanted < 0.0 && power < least {
            wanted + crossing(0.0, -wanted, |less| needs(wanted + less) - least)
        } else {
            wanted
        };
        force * way
    }
}

impl Driveline for HydromechanicalCvt {
    fn states(&self) -> Vec<State> {
        vec![
            State { name: "boost", initial: 0.0 },
            State { name: "transmission_range", initial: 0.0 },
            State { name: "since_range_s", initial: RANGE_TIME_S },
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
        self.transmission.rotating_mass_kg
    }

    fn deliver(&self, demand: &Demand, states: &[f64], rates: &mut [f64]) -> Delivery {
        let (boost, range) =
            (states.first().copied().unwrap_or(0.0), states.get(RANGE).copied().unwrap_or(0.0));
        let at = Circumstance {
            boost,
            friction_n_m: demand.engine_friction_n_m,
            hand_rad_s: demand.engine_speed_rad_s,
        };
        let alternator = self.engine.alternator_w(demand.auxiliary_power_w);
        let others = alternator + demand.shaft_power_w;
        let force_n = self.force_n(demand, &at, range, others);
        let way = if demand.speed_m_s == 0.0 { force_n.signum() } else { demand.speed_m_s.signum() };
        let Working { speed_rad_s, input_w } = self.working(demand, &at, range, force_n * way, others);
        let running = self.engine.run_at(speed_rad_s, input_w + others, &at);
        self.answer(demand, force_n, input_w, alternator, &running, rates)
    }

    fn decide(&self, demand: &Demand, states: &mut [f64]) -> bool {
        if demand.coasting || states[SINCE] < RANGE_TIME_S {
            return false;
        }
        let engine = self.deliver(demand, states, &mut []).readings.engine_speed_rad_s;
        let range = self.transmission.choose(states[RANGE], demand.speed_m_s, engine);
        let changes = range != states[RANGE];
        if changes {
            (states[RANGE], states[SINCE]) = (range, 0.0);
        }
        changes
    }

    fn patience_s(&self) -> f64 {
        PATIENCE_S
    }

    fn exhausted(&self, demand: &Demand, _: &Delivery, _: &[f64]) -> Option<String> {
        let speed = self.transmission.least_engine_rad_s(demand.speed_m_s);
        (!demand.coasting && speed > self.engine.last_rad_s()).then(|| {
            format!(
                "the transmission has no ratio for {:.2} m/s: the engine would turn at {speed:.0} rad/s, and its full-load \
                 curve ends at {:.0} rad/s",
                demand.speed_m_s,
                self.engine.last_rad_s()
            )
        })
    }
}

impl HydromechanicalCvt {
    fn answer(
        &self,
        demand: &Demand,
        force_n: f64,
        input_w: f64,
        alternator_w: f64,
        running: &Running,
        rates: &mut [f64],
    ) -> Delivery {
        if let [boost, range, since, volume, carbon] = rates {
            (*range, *since) = (0.0, 1.0);
            *boost = running.boost_per_s;
            (*volume, *carbon) = self.engine.burnt(running.fuel_w);
        }
        let mut delivery = Delivery { force_n, source_power_w: running.fuel_w, ..Delivery::NOTHING };
        delivery.losses_w[0] = running.heat_w();
        delivery.losses_w[1] = input_w - force_n * demand.speed_m_s;
        delivery.losses_w[2] = running.accessories_w + alternator_w - demand.auxiliary_power_w;
        let ratio = self.transmission.ratio(running.speed_rad_s, demand.speed_m_s);
        delivery.readings = Readings {
            engine_speed_rad_s: running.speed_rad_s,
            engine_torque_n_m: running.torque_n_m(),
            fuel_rate_kg_s: running.fuel_w / self.engine.heating_value_j_kg(),
            cvt_ratio: if demand.coasting { f64::NAN } else { ratio },
            ..Readings::NONE
        };
        delivery
    }
}

#[cfg(test)]
#[path = "hydromechanical_cvt_tests.rs"]
mod tests;
