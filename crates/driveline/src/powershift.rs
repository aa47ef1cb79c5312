//! An engine behind gears that are shifted under load.
//!
//! T_c = F r / (i η) + T_0    driving,   F r η / i + T_0   overrun; T_c at the clutch
//! ω_c = i v / r,   ω_e = max(ω_c, ω_launch) (1 + (s − 1) (1 − t / t_s)) while t < t_s after a shift
//! P_e = (T_c + J dω_e/dt) ω_e,   T_c (ω_e − ω_c) in the slipping clutch
//! dω_e/dt = max(ω_c, ω_launch) (1 − s) / t_s: what the shift changes; s = ω_e before it / max(ω_c, ω_launch) after it
//!
//! Source: Renius, *Fundamentals of Tractor Design* (2020), chapter 5; Guzzella and Onder (2010) for the engine.
//!
//! A gear is decided between two steps: the highest in which the engine turns at least at the least speed and gives what
//! is asked with the share λ of its torque; a shift down comes at once where it is needed, one up only after the least time
//! in gear. A shift passes from clutch to clutch without interruption, and its slip is a loss:
//! - up: the clutch of the new gear pulls, and takes the slower engine's kinetic energy. An engine that its own friction does not
//!   slow down in time pushes the vehicle through it.
//! - down: the clutch of the old gear still pulls (i is the old one) while the engine speeds itself up.
//!
//! While a clutch slips the engine does not brake the vehicle. In gear its inertia is a part of `rotating_mass_kg`. Dead time is
//! left out.

use crate::engine::{Circumstance, ENGINE, Engine, PATIENCE_S};
use crate::parts::{hold, increasing, join, refuse};
use headland_plugin::{
    Bound, Card, Delivery, Demand, Driveline, Parameter, Plugin, Readings, Refusal, State, parameter,
};
use serde::Deserialize;
use std::path::Path;

const OWN: [Parameter; 10] = [
    parameter(
        "ratios",
        "[1]",
        "engine speed over wheel speed, final drive included, from the highest gear down, i",
    )
    .must_be(Bound::Positive)
    .usually(2.0, 1500.0),
    parameter("gear_efficiency", "1", "clutch to wheels, η").must_be(Bound::Efficiency).usually(0.8, 0.99),
    parameter("idle_torque_n_m", "N m", "that the gears take at the clutch without load, T_0")
        .must_be(Bound::NotNegative)
        .usually(0.0, 100.0),
    parameter("least_speed_rad_s", "rad/s", "no gear is shifted up into below this")
        .must_be(Bound::Positive)
        .usually(80.0, 200.0),
    parameter("launch_speed_rad_s", "rad/s", "of the engine while the clutch slips at a start, ω_launch")
        .must_be(Bound::Positive)
        .usually(80.0, 200.0),
    parameter("shift_time_s", "s", "that a clutch slips in a shift, t_s")
        .must_be(Bound::Positive)
        .usually(0.1, 2.0),
    parameter(
        "engine_inertia_kg_m2",
        "kg m²",
        "of the engine with its flywheel, which a shift speeds up or slows down, J",
    )
    .must_be(Bound::NotNegative)
    .usually(0.2, 8.0),
    parameter("least_time_s", "s", "in a gear before the next shift up")
        .must_be(Bound::NotNegative)
        .usually(0.0, 10.0),
    parameter("wheel_radius_m", "m", "rolling radius, r").must_be(Bound::Positive).usually(0.2, 1.2),
    parameter("rotating_mass_kg", "kg", "inertia of what turns with the wheels, as mass")
        .must_be(Bound::NotNegative)
        .usually(0.0, 3000.0),
];

const PARAMETERS: [Parameter; ENGINE.len() + OWN.len()] = join(&[&ENGINE, &OWN]);

/// An engine and a gearbox that shifts under load.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Powershift {
    engine: Engine,
    ratios: Vec<f64>,
    gear_efficiency: f64,
    idle_torque_n_m: f64,
    least_speed_rad_s: f64,
    launch_speed_rad_s: f64,
    shift_time_s: f64,
    engine_inertia_kg_m2: f64,
    least_time_s: f64,
    wheel_radius_m: f64,
    rotating_mass_kg: f64,
}

impl Plugin for Powershift {
    const CARD: Card = Card {
        name: "Powershift",
        about: "an engine behind gears that are shifted under load, with a clutch that slips at the start and in shifts",
        equation: "T_c = F r η^(∓1) / i + T_0; ω_c = i v / r; P_e = (T_c + J dω_e/dt) ω_e; \
                   ω_e = max(ω_c, ω_launch) (1 + (s − 1) (1 − t / t_s)) after a shift by the step s",
        source: "Renius, Fundamentals of Tractor Design (2020), chapter 5; Guzzella and Onder, Introduction to Modeling and \
                 Control of Internal Combustion Engine Systems (2010); usual values from memory",
        validity: "quasi-steady; the engine's inertia counts in shifts; leaves out dead time",
        parameters: &PARAMETERS,
    };

    fn settle(&mut self, _: &Path) -> Result<(), Refusal> {
        self.engine.settle()?;
        hold(&OWN, &[("gear_efficiency", self.gear_efficiency), ("shift_time_s", self.shift_time_s)])?;
        let rising: Vec<f64> = self.ratios.iter().rev().copied().collect();
        increasing("ratios", &rising, 1).map_err(|refusal| Refusal {
            expected: "ratios above 0 that fall from gear to gear, slowest gear first".to_owned(),
            ..refusal
        })?;
        let (idle, last) = (self.engine.idle_rad_s(), self.engine.last_rad_s());
        for (name, speed) in
            [("least_speed_rad_s", self.least_speed_rad_s), ("launch_speed_rad_s", self.launch_speed_rad_s)]
        {
            if !(idle..last).contains(&speed) {
                return Err(refuse(name, speed, &format!("{idle} to below {last}, as the engine can turn")));
            }
        }
        Ok(())
    }
}

const BOOST: usize = 0;
const GEAR: usize = 1;
const SINCE: usize = 2;
const STEP: usize = 3;

/// How clutch and engine turn.
struct Turning {
    /// Ratio of the gear that pulls.
    ratio: f64,
    clutch: f64,
    engine: f64,
    /// What a shift does to the speed of the engine [rad/s²].
    spin_up: f64,
}

impl Powershift {
    fn ratio(&self, gear: f64) -> f64 {
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a state that `decide` set"
        )]
        let index = ((gear - 1.0).max(0.0) as usize).min(self.ratios.len() - 1);
        self.ratios[index]
    }

    fn turning(&self, speed: f64, states: &[f64]) -> Turning {
        let (gear, step) = (self.ratio(states[GEAR]), states[STEP]);
        let synchronous = gear * speed / self.wheel_radius_m;
        let left = (1.0 - states[SINCE] / self.shift_time_s).clamp(0.0, 1.0);
        let base = synchronous.max(self.launch_speed_rad_s);
        // In a shift down the clutch of the gear before pulls until the engine has come up to the new one.
        let ratio = if left > 0.0 && step < 1.0 { gear * step } else { gear };
        let clutch = ratio * speed / self.wheel_radius_m;
        let (engine, most) = (base * (1.0 + (step - 1.0) * left), self.engine.last_rad_s().max(synchronous));
        let shifts = left > 0.0 && engine <= most;
        let spin_up = if shifts { base * (1.0 - step) / self.shift_time_s } else { 0.0 };
        Turning { ratio, clutch, engine: engine.min(most), spin_up }
    }

    /// Torque at the clutch for a force in the direction of driving.
    fn clutch_n_m(&self, force: f64, ratio: f64) -> f64 {
        let (torque, eta) = (force * self.wheel_radius_m / ratio, self.gear_efficiency);
        self.idle_torque_n_m + if force >= 0.0 { torque / eta } else { torque * eta }
    }

    /// Force that a torque at the clutch makes.
    fn wheels_n(&self, clutch_n_m: f64, ratio: f64) -> f64 {
        let (torque, eta) = (clutch_n_m - self.idle_torque_n_m, self.gear_efficiency);
        torque * ratio / self.wheel_radius_m * if torque >= 0.0 { eta } else { 1.0 / eta }
    }

    /// Greatest torque at the clutch with the engine at a speed, beside what others take.
    fn most_n_m(&self, engine: f64, at: &Circumstance, others: f64) -> f64 {
        let full = self.engine.limit(at.boost) * self.engine.full_torque_n_m(engine);
        full - (self.engine.accessories_w(engine) + others) / engine
    }

    /// The gear for a demand: the highest that keeps the engine fast and strong enough.
    fn wanted(&self, demand: &Demand, states: &[f64], at: &Circumstance, others: f64) -> f64 {
        let speed = demand.speed_m_s.abs();
        let force = demand.force_n * if demand.speed_m_s < 0.0 { -1.0 } else { 1.0 };
        let fits = |gear: f64, least: f64| {
            let ratio = self.ratio(gear);
            let clutch = ratio * speed / self.wheel_radius_m;
            clutch >= least
                && clutch <= self.engine.last_rad_s()
                && (force <= 0.0
                    || self.clutch_n_m(force, ratio)
                        <= self.engine.load_share() * self.most_n_m(clutch, at, others))
        };
        let now = states[GEAR];
        let gears = self.ratios.len();
        let settled = states[SINCE] >= self.least_time_s;
        for index in (0..gears).rev() {
            let gear = (index + 1) as f64;
            if gear > now && settled && fits(gear, self.least_speed_rad_s) {
                return gear;
            }
            // The gear that is in is kept as long as it turns the engine above idle.
            if gear <= now && fits(gear, self.engine.idle_rad_s()) {
                return gear;
            }
        }
        // Nothing fits: the most pull, with an engine that is not overrun.
        let spun = |index: usize| self.ratios[index] * speed / self.wheel_radius_m > self.engine.last_rad_s();
        let lowest = (0..gears).find(|index| !spun(*index)).unwrap_or(gears - 1);
        let strongest = (lowest..gears).max_by(|one, two| {
            let pull = |index: usize| {
                let engine = (self.ratios[index] * speed / self.wheel_radius_m).max(self.launch_speed_rad_s);
                self.wheels_n(self.most_n_m(engine, at, others), self.ratios[index])
            };
            pull(*one).total_cmp(&pull(*two)).then(two.cmp(one))
        });
        (strongest.unwrap_or(lowest) + 1) as f64
    }

    fn circumstance(demand: &Demand, states: &[f64]) -> Circumstance {
        Circumstance { boost: states[BOOST], friction_n_m: demand.engine_friction_n_m, hand_rad_s: 0.0 }
    }
}

impl Driveline for Powershift {
    fn states(&self) -> Vec<State> {
        vec![
            State { name: "boost", initial: 0.0 },
            State { name: "gear", initial: 1.0 },
            State { name: "since_shift_s", initial: self.shift_time_s.max(self.least_time_s) },
            State { name: "shift_step", initial: 1.0 },
            State { name: "fuel_m3", initial: 0.0 },
            State { name: "carbon_dioxide_kg", initial: 0.0 },
        ]
    }

    fn losses(&self) -> &'static [&'static str] {
        &["engine heat", "transmission", "clutch", "accessories", "engine's inertia"]
    }

    fn source(&self) -> &'static str {
        "fuel"
    }

    fn rotating_mass_kg(&self, _: bool) -> f64 {
        self.rotating_mass_kg
    }

    fn deliver(&self, demand: &Demand, states: &[f64], rates: &mut [f64]) -> Delivery {
        let at = Self::circumstance(demand, states);
        let alternator = self.engine.alternator_w(demand.auxiliary_power_w);
        let others = alternator + demand.shaft_power_w;
        let way = if demand.speed_m_s == 0.0 { demand.force_n.signum() } else { demand.speed_m_s.signum() };
        let Turning { ratio, clutch, engine, spin_up } = self.turning(demand.speed_m_s.abs(), states);
        let (force, torque, stored_w, running) = if demand.coasting {
            (0.0, 0.0, 0.0, self.engine.run(others, &at))
        } else {
            let inertia = self.engine_inertia_kg_m2 * spin_up;
            let most = self.most_n_m(engine, &at, others) - inertia;
            let braking =
                self.engine.friction_w(engine, at.friction_n_m) + self.engine.accessories_w(engine) + others;
            let least_n = self.wheels_n(-braking / engine - inertia, ratio);
            // A clutch that slips cannot brake: the engine turns faster than it. It pushes where it has to slow down.
            let held = spin_up == 0.0 && engine <= clutch * (1.0 + 1e-9);
            let least_n = if held { least_n.min(0.0) } else { least_n.max(0.0) };
            let most_n = self.wheels_n(most, ratio).max(least_n).max(0.0);
            let force = (demand.force_n * way).clamp(least_n, most_n);
            let torque = self.clutch_n_m(force, ratio);
            let stored_w = inertia * engine;
            (force, torque, stored_w, self.engine.run_at(engine, torque * engine + stored_w + others, &at))
        };
        if let [boost, gear, since, step, volume, carbon] = rates {
            (*gear, *since, *step) = (0.0, 1.0, 0.0);
            *boost = running.boost_per_s;
            (*volume, *carbon) = self.engine.burnt(running.fuel_w);
        }
        let force_n = force * way;
        let mut delivery = Delivery { force_n, source_power_w: running.fuel_w, ..Delivery::NOTHING };
        delivery.losses_w[0] = running.heat_w();
        delivery.losses_w[1] = torque * clutch - force_n * demand.speed_m_s;
        delivery.losses_w[2] = torque * (engine - clutch);
        delivery.losses_w[3] = running.accessories_w + alternator - demand.auxiliary_power_w;
        delivery.losses_w[4] = stored_w;
        delivery.readings = Readings {
            engine_speed_rad_s: running.speed_rad_s,
            engine_torque_n_m: running.torque_n_m(),
            fuel_rate_kg_s: running.fuel_w / self.engine.heating_value_j_kg(),
            ..Readings::NONE
        };
        delivery
    }

    fn decide(&self, demand: &Demand, states: &mut [f64]) -> bool {
        if demand.coasting {
            return false;
        }
        let others = self.engine.alternator_w(demand.auxiliary_power_w) + demand.shaft_power_w;
        let gear = self.wanted(demand, states, &Self::circumstance(demand, states), others);
        if gear == states[GEAR] {
            return false;
        }
        let speed = demand.speed_m_s.abs();
        let before = self.turning(speed, states).engine;
        let synchronous = self.ratio(gear) * speed / self.wheel_radius_m;
        states[STEP] = before / synchronous.max(self.launch_speed_rad_s);
        states[GEAR] = gear;
        states[SINCE] = 0.0;
        true
    }

    fn patience_s(&self) -> f64 {
        PATIENCE_S
    }

    fn exhausted(&self, demand: &Demand, _: &Delivery, _: &[f64]) -> Option<String> {
        let slowest = self.ratios[self.ratios.len() - 1] * demand.speed_m_s.abs() / self.wheel_radius_m;
        (!demand.coasting && slowest > self.engine.last_rad_s()).then(|| {
            format!(
                "no gear is high enough for {:.2} m/s: in the highest the engine would turn at {slowest:.0} rad/s, and its \
                 full-load curve ends at {:.0} rad/s",
                demand.speed_m_s,
                self.engine.last_rad_s()
            )
        })
    }
}

#[cfg(test)]
#[path = "powershift_tests.rs"]
mod tests;
