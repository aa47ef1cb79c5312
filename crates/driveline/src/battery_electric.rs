//! Battery electric: a battery or a supercapacitor, one motor, and gears.
//!
//! F = T i η^(±1) / r,   ω = i v / r,   P_b = T ω + losses + consumers + P_shaft / η_s
//! I = (U − √(U² − 4 R P)) / (2 R),   dS/dt = −I / (3600 Q)
//!
//! Source: Guzzella and Sciarretta, *Vehicle Propulsion Systems* (2013), sections 4.3 to 4.5; parts as in their own files.
//!
//! With several gears the lowest is taken that keeps the motor below its highest speed with a tenth to spare; it is decided
//! between two steps, and shifted without interruption. A shaft power is made by a second motor. Where the battery cannot,
//! the wheels get less; other consumers are always served. Empty, it ends the run.

use crate::motor::{Motor, machine};
use crate::parts::{crossing, hold, increasing, join};
use crate::store::{BATTERY, BatteryFile, SUPERCAPACITOR, Store, SupercapacitorFile};
use headland_plugin::{
    Bound, Card, Delivery, Demand, Driveline, Parameter, Plugin, Readings, Refusal, State, parameter,
};
use serde::Deserialize;
use std::path::Path;

const MOTOR: [Parameter; crate::motor::COUNT] = machine!("motor");
const OWN: [Parameter; 7] = [
    parameter("gear_ratios", "[1]", "motor speed over wheel speed, lowest gear first, i")
        .must_be(Bound::Positive)
        .usually(1.0, 200.0),
    parameter("gear_efficiency", "1", "motor to wheels, η").must_be(Bound::Efficiency).usually(0.85, 0.99),
    parameter("wheel_radius_m", "m", "rolling radius, r").must_be(Bound::Positive).usually(0.2, 1.2),
    parameter("rotating_mass_kg", "kg", "inertia of rotor, gears and wheels, as mass")
        .must_be(Bound::NotNegative)
        .usually(0.0, 5000.0),
    parameter("shaft_efficiency", "1", "battery to power take-off and hydraulics, η_s")
        .must_be(Bound::Efficiency)
        .usually(0.7, 0.97),
    parameter("standby_power_w", "W", "controllers, steering and cooling, at all times")
        .must_be(Bound::NotNegative)
        .usually(0.0, 1e4),
    parameter("converter_efficiency", "1", "battery to other consumers")
        .must_be(Bound::Efficiency)
        .usually(0.8, 0.99),
];
const COUNT: usize = MOTOR.len() + OWN.len() + BATTERY.len() + SUPERCAPACITOR.len();
const PARAMETERS: [Parameter; COUNT] = join(&[&MOTOR, &OWN, &BATTERY, &SUPERCAPACITOR]);

/// A battery, a motor and gears.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BatteryElectric {
    motor: Motor,
    gear_ratios: Vec<f64>,
    gear_efficiency: f64,
    wheel_radius_m: f64,
    rotating_mass_kg: f64,
    shaft_efficiency: f64,
    standby_power_w: f64,
    converter_efficiency: f64,
    battery: Option<BatteryFile>,
    supercapacitor: Option<SupercapacitorFile>,
    #[serde(skip)]
    store: Store,
}

impl Plugin for BatteryElectric {
    const CARD: Card = Card {
        name: "BatteryElectric",
        about: "a battery or a supercapacitor by its open-circuit voltage, a motor by its losses and its temperature, and gears",
        equation: "F = T i η^(±1) / r; ω = i v / r; P_b = T ω + k_c T² + k_i ω + k_w ω³ + k_0 + consumers + P_shaft / η_s; \
                   I = (U − √(U² − 4 R P)) / (2 R); dS/dt = −I / (3600 Q); C dθ/dt = losses − G (θ − θ_coolant)",
        source: "Guzzella and Sciarretta, Vehicle Propulsion Systems (2013), sections 4.3 to 4.5; usual values of machine, \
                 battery and gears from memory",
        validity: "quasi-steady; leaves out ageing and temperature of the battery, and what a change of gear takes",
        parameters: &PARAMETERS,
    };

    fn settle(&mut self, _: &Path) -> Result<(), Refusal> {
        self.motor.settle("motor", &MOTOR)?;
        let own = [
            ("gear_efficiency", self.gear_efficiency),
            ("wheel_radius_m", self.wheel_radius_m),
            ("shaft_efficiency", self.shaft_efficiency),
            ("converter_efficiency", self.converter_efficiency),
        ];
        hold(&OWN, &own)?;
        let rising: Vec<f64> = self.gear_ratios.iter().rev().copied().collect();
        increasing("gear_ratios", &rising, 1).map_err(|refusal| Refusal {
            expected: "ratios above 0 that fall from gear to gear, slowest gear first".to_owned(),
            ..refusal
        })?;
        self.store = Store::new(self.battery.as_ref(), self.supercapacitor.as_ref())?;
        Ok(())
    }
}

const CHARGE: usize = 0;
const MOTOR_C: usize = 1;
const GEAR: usize = 2;

/// A higher gear is taken above this share of the motor's highest speed, a lower one again where it would stay below the
/// other share.
const SHIFT_UP: f64 = 0.9;
const SHIFT_DOWN: f64 = 0.75;

/// Charge above the least at which a battery that falls short is called empty: a tenth of where its current begins to fall.
const EMPTY: f64 = 1e-3;

/// What motor and gears do for a force.
struct Working {
    torque: f64,
    speed: f64,
    loss_w: f64,
    electric_w: f64,
}

impl BatteryElectric {
    fn leverage_per_m(&self, gear: f64) -> f64 {
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a state that `decide` set"
        )]
        let index = ((gear - 1.0).max(0.0) as usize).min(self.gear_ratios.len() - 1);
        self.gear_ratios[index] / self.wheel_radius_m
    }

    fn working(&self, speed_m_s: f64, force: f64, gear: f64) -> Working {
        let leverage = self.leverage_per_m(gear);
        let share = if force >= 0.0 { 1.0 / self.gear_efficiency } else { self.gear_efficiency };
        let (torque, speed) = (force / leverage * share, leverage * speed_m_s);
        let loss_w = self.motor.loss_w(torque, speed);
        Working { torque, speed, loss_w, electric_w: torque * speed + loss_w }
    }

    fn others_w(&self, demand: &Demand) -> f64 {
        self.standby_power_w
            + demand.auxiliary_power_w / self.converter_efficiency
            + demand.shaft_power_w / self.shaft_efficiency
    }
}

impl Driveline for BatteryElectric {
    fn states(&self) -> Vec<State> {
        vec![
            State { name: "state_of_charge", initial: self.store.initial },
            State { name: "motor_temperature_c", initial: self.motor.coolant_c() },
            State { name: "gear", initial: 1.0 },
        ]
    }

    fn losses(&self) -> &'static [&'static str] {
        if self.supercapacitor.is_some() {
            &["supercapacitor", "motor", "transmission", "accessories"]
        } else {
            &["battery", "motor", "transmission", "accessories"]
        }
    }

    fn source(&self) -> &'static str {
        if self.supercapacitor.is_some() { "supercapacitor" } else { "battery" }
    }

    fn rotating_mass_kg(&self, _: bool) -> f64 {
        self.rotating_mass_kg
    }

    fn deliver(&self, demand: &Demand, states: &[f64], rates: &mut [f64]) -> Delivery {
        let (charge, gear) = (states[CHARGE], states[GEAR]);
        let (v, more) = (demand.speed_m_s.abs(), demand.battery_resistance_ohm);
        let way = if demand.speed_m_s == 0.0 { demand.force_n.signum() } else { demand.speed_m_s.signum() };
        let (out, into) = self.store.most_w(charge, more);
        let others = self.others_w(demand);
        let leverage = self.leverage_per_m(gear);
        let limit = self.motor.limit_n_m(leverage * v, states[MOTOR_C]) * leverage;
        let mut force = if demand.coasting { 0.0 } else { demand.force_n * way };
        force = force.clamp(-limit / self.gear_efficiency, limit * self.gear_efficiency);
        let electric = |force: f64| self.working(v, force, gear).electric_w + others;
        let mut working = self.working(v, force, gear);
        let power = working.electric_w + others;
        if force > 0.0 && power > out {
            force -= crossing(0.0, force, |less| out - electric(force - less));
            working = self.working(v, force, gear);
        } else if force < 0.0 && power < -into {
            force += crossing(0.0, -force, |less| electric(force + less) + into);
            working = self.working(v, force, gear);
        }
        let Working { torque, speed, loss_w, electric_w } = working;
        let drawn = self.store.draw(electric_w + others, charge, more);
        if let [charge, motor, gear] = rates {
            *charge = drawn.charge_per_s;
            *motor = self.motor.warming_k_s(loss_w, states[MOTOR_C]);
            *gear = 0.0;
        }
        let force_n = force * way;
        let mut delivery = Delivery { force_n, source_power_w: drawn.store_w, ..Delivery::NOTHING };
        delivery.losses_w[0] = drawn.loss_w;
        delivery.losses_w[1] = loss_w;
        delivery.losses_w[2] = torque * speed - force_n * demand.speed_m_s;
        delivery.losses_w[3] = others - demand.auxiliary_power_w - demand.shaft_power_w;
        delivery.readings = Readings {
            motor_speed_rad_s: speed * way,
            motor_torque_n_m: torque * way,
            battery_voltage_v: drawn.voltage_v,
            battery_current_a: drawn.current_a,
            ..Readings::NONE
        };
        delivery
    }

    fn decide(&self, demand: &Demand, states: &mut [f64]) -> bool {
        let turns = |gear: f64| self.leverage_per_m(gear) * demand.speed_m_s.abs() / self.motor.max_rad_s();
        let gear = states[GEAR];
        let next = if turns(gear) > SHIFT_UP && gear < self.gear_ratios.len() as f64 {
            gear + 1.0
        } else if gear > 1.0 && turns(gear - 1.0) < SHIFT_DOWN {
            gear - 1.0
        } else {
            gear
        };
        states[GEAR] = next;
        next != gear
    }

    fn exhausted(&self, demand: &Demand, delivery: &Delivery, states: &[f64]) -> Option<String> {
        let drives = demand.force_n * demand.speed_m_s >= 0.0 && !demand.coasting;
        let short = drives && delivery.force_n.abs() < demand.force_n.abs();
        (short && states[CHARGE] < self.store.window.0 + EMPTY).then(|| {
            format!(
                "the {} is empty: its charge is {:.3}, and it is used down to {}",
                self.source(),
                states[CHARGE],
                self.store.window.0
            )
        })
    }

    fn force_of_torque_n(&self, torque_n_m: f64, speed_m_s: f64) -> Option<f64> {
        if self.gear_ratios.len() > 1 {
            return None;
        }
        let drives = torque_n_m * speed_m_s >= 0.0;
        let share = if drives { self.gear_efficiency } else { 1.0 / self.gear_efficiency };
        Some(torque_n_m * self.leverage_per_m(1.0) * share)
    }

    fn battery_capacity_j(&self) -> Option<f64> {
        Some(self.store.energy_j(1.0))
    }
}

#[cfg(test)]
#[path = "battery_electric_tests.rs"]
mod tests;
