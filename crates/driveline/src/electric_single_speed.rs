//! A battery, one motor and a fixed gear.
//!
//! F     = T i η_g / r driving, T i / (η_g r) braking         T at the motor shaft
//! P_e   = T ω / η driving, T ω η braking                     at the inverter's terminals; ω = i v / r
//! P_b   = P_e + P_standby + P_aux + P_shaft / η
//! I     = (U − √(U² − 4 R P_b)) / (2R),   dS/dt = −I / (3600 Q)
//! U     = U₀ + U₁ (S − ½)
//!
//! Source: Guzzella and Sciarretta, *Vehicle Propulsion Systems* (2013), sections 4.3 and 4.5 (internal-resistance model).
//!
//! Driving is T ω ≥ 0, so rest counts as driving. The motor has one limit of torque for driving, one for regeneration, and
//! one of power for both. The battery gives at most U² / 4R: the wheels get less then. Other consumers are always served;
//! what they take beyond U² / 4R is drawn without further loss. An empty battery drives no more, a full one takes nothing
//! back. In neutral the motor turns without torque. A shaft power is made by a second motor of the same efficiency.
//! Leaves out field weakening beyond the power limit, temperature, ageing, and friction brakes.

use headland_plugin::{
    Bound, Card, Delivery, Demand, Driveline, Plugin, Readings, Refusal, State, parameter,
};
use serde::Deserialize;
use std::path::Path;

const S_PER_H: f64 = 3600.0;

/// A battery-electric drive with one gear.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ElectricSingleSpeed {
    open_circuit_voltage_v: f64,
    #[serde(default)]
    open_circuit_rise_v: f64,
    resistance_ohm: f64,
    capacity_a_h: f64,
    initial_state_of_charge: f64,
    max_torque_n_m: f64,
    max_regeneration_torque_n_m: f64,
    max_power_w: f64,
    gear_ratio: f64,
    #[serde(default = "lossless")]
    gear_efficiency: f64,
    wheel_radius_m: f64,
    drive_efficiency: f64,
    standby_power_w: f64,
    rotating_mass_kg: f64,
}

const fn lossless() -> f64 {
    1.0
}

impl Plugin for ElectricSingleSpeed {
    const CARD: Card = Card {
        name: "ElectricSingleSpeed",
        about: "a battery with internal resistance, one motor with limits of torque and power, and a fixed gear",
        equation: "F = T i η_g^(±1) / r; P_b = T ω η^(∓1) + P_standby + P_aux; I = (U − √(U² − 4 R P_b)) / (2R); \
                   dS/dt = −I / (3600 Q); U = U₀ + U₁ (S − ½)",
        source: "Guzzella and Sciarretta, Vehicle Propulsion Systems (2013), sections 4.3 and 4.5; usual values from memory",
        validity: "quasi-steady; leaves out temperature, ageing, efficiency by load, and friction brakes",
        parameters: &[
            parameter("open_circuit_voltage_v", "V", "of the battery at half charge, U₀")
                .must_be(Bound::Positive)
                .usually(24.0, 900.0),
            parameter("open_circuit_rise_v", "V", "open-circuit voltage from empty to full, U₁")
                .must_be(Bound::NotNegative)
                .usually(0.0, 200.0)
                .or(0.0),
            parameter("resistance_ohm", "ohm", "of the battery, R")
                .must_be(Bound::NotNegative)
                .usually(0.0, 0.5),
            parameter("capacity_a_h", "A h", "of the battery, Q")
                .must_be(Bound::Positive)
                .usually(5.0, 1000.0),
            parameter("initial_state_of_charge", "1", "at the start of a run, S")
                .must_be(Bound::Within(0.0, 1.0))
                .usually(0.1, 1.0),
            parameter("max_torque_n_m", "N m", "of the motor, driving")
                .must_be(Bound::Positive)
                .usually(30.0, 3000.0),
            parameter("max_regeneration_torque_n_m", "N m", "of the motor, braking")
                .must_be(Bound::NotNegative)
                .usually(0.0, 3000.0),
            parameter("max_power_w", "W", "at the motor shaft, driving or braking")
                .must_be(Bound::Positive)
                .usually(5e3, 1e6),
            parameter("gear_ratio", "1", "motor speed over wheel speed, i")
                .must_be(Bound::Positive)
                .usually(1.0, 50.0),
            parameter("gear_efficiency", "1", "motor shaft to wheels, η_g")
                .must_be(Bound::Efficiency)
                .usually(0.9, 1.0)
                .or(1.0),
            parameter("wheel_radius_m", "m", "rolling radius, r").must_be(Bound::Positive).usually(0.2, 1.2),
            parameter(
                "drive_efficiency",
                "1",
                "inverter and motor (and the gear where `gear_efficiency` is 1), η",
            )
            .must_be(Bound::Efficiency)
            .usually(0.7, 0.98),
            parameter("standby_power_w", "W", "inverter and controllers, at all times")
                .must_be(Bound::NotNegative)
                .usually(0.0, 2000.0),
            parameter("rotating_mass_kg", "kg", "inertia of rotor, gear and wheels, as mass")
                .must_be(Bound::NotNegative)
                .usually(0.0, 1500.0),
        ],
    };

    fn settle(&mut self, _: &Path) -> Result<(), Refusal> {
        if self.open_circuit_rise_v >= 2.0 * self.open_circuit_voltage_v {
            return Err(Refusal {
                parameter: "open_circuit_rise_v".to_owned(),
                found: self.open_circuit_rise_v.to_string(),
                expected: "less than twice `open_circuit_voltage_v`, so that an empty battery has a voltage"
                    .to_owned(),
            });
        }
        Ok(())
    }
}

/// Battery current, and what the other consumers take beyond the most that the battery gives.
struct Battery {
    current_a: f64,
    loss_w: f64,
    beyond_w: f64,
}

impl ElectricSingleSpeed {
    fn open_circuit_v(&self, state_of_charge: f64) -> f64 {
        // Beyond empty and full the voltage stays: it must not fall to 0.
        self.open_circuit_voltage_v + self.open_circuit_rise_v * (state_of_charge.clamp(0.0, 1.0) - 0.5)
    }

    /// The most that the battery gives: U² / 4R.
    fn most_w(open_circuit_v: f64, resistance_ohm: f64) -> f64 {
        open_circuit_v * open_circuit_v / (4.0 * resistance_ohm)
    }

    fn battery(open_circuit_v: f64, resistance_ohm: f64, power_w: f64) -> Battery {
        let (u, r) = (open_circuit_v, resistance_ohm);
        let given = power_w.min(Self::most_w(u, r));
        // The lesser root of R I² − U I + P = 0, in the form that has no difference of like numbers and allows R = 0.
        let current_a = 2.0 * given / (u + (u * u - 4.0 * r * given).max(0.0).sqrt());
        Battery { current_a, loss_w: r * current_a * current_a, beyond_w: power_w - given }
    }

    /// Force at the wheels over torque of the motor, without the gear's efficiency.
    fn leverage_per_m(&self) -> f64 {
        self.gear_ratio / self.wheel_radius_m
    }

    /// The torque of those asked for that motor and battery can make; `spare` is what the battery has left for it.
    fn torque_n_m(&self, demand: &Demand, spare_w: f64, state_of_charge: f64) -> f64 {
        if demand.coasting {
            return 0.0;
        }
        let omega = self.leverage_per_m() * demand.speed_m_s;
        let drives = demand.force_n * omega >= 0.0;
        let gear = if drives { self.gear_efficiency } else { 1.0 / self.gear_efficiency };
        let wanted = demand.force_n / (self.leverage_per_m() * gear);
        let (most_n_m, most_w) = if drives {
            let charge = if state_of_charge > 0.0 { self.drive_efficiency * spare_w.max(0.0) } else { 0.0 };
            (self.max_torque_n_m, self.max_power_w.min(charge))
        } else if state_of_charge < 1.0 {
            (self.max_regeneration_torque_n_m, self.max_power_w)
        } else {
            (0.0, 0.0)
        };
        let torque = wanted.clamp(-most_n_m, most_n_m);
        if (torque * omega).abs() > most_w { (most_w / omega).abs().copysign(torque) } else { torque }
    }
}

impl Driveline for ElectricSingleSpeed {
    fn states(&self) -> Vec<State> {
        vec![State { name: "state_of_charge", initial: self.initial_state_of_charge }]
    }

    fn losses(&self) -> &'static [&'static str] {
        &["battery", "drive", "standby"]
    }

    fn source(&self) -> &'static str {
        "battery"
    }

    fn rotating_mass_kg(&self, _: bool) -> f64 {
        self.rotating_mass_kg
    }

    fn deliver(&self, demand: &Demand, states: &[f64], rates: &mut [f64]) -> Delivery {
        let charge = states.first().copied().unwrap_or(self.initial_state_of_charge);
        let (u, eta) = (self.open_circuit_v(charge), self.drive_efficiency);
        let shaft = demand.shaft_power_w / eta;
        let others = self.standby_power_w + demand.auxiliary_power_w + shaft;
        let r = (self.resistance_ohm + demand.battery_resistance_ohm).max(0.0);
        let torque = self.torque_n_m(demand, Self::most_w(u, r) - others, charge);
        let omega = self.leverage_per_m() * demand.speed_m_s;
        let mechanical = torque * omega;
        let electric = if mechanical >= 0.0 { mechanical / eta } else { mechanical * eta };
        let force_n = self.force_of_torque_n(torque, demand.speed_m_s).unwrap_or_default();
        let Battery { current_a, loss_w, beyond_w } = Self::battery(u, r, electric + others);
        let source_power_w = u * current_a + beyond_w;
        if let Some(rate) = rates.first_mut() {
            *rate = -source_power_w / (u * S_PER_H * self.capacity_a_h);
        }
        let mut delivery = Delivery { force_n, source_power_w, ..Delivery::NOTHING };
        delivery.losses_w[0] = loss_w;
        delivery.losses_w[1] = electric - force_n * demand.speed_m_s + (shaft - demand.shaft_power_w);
        delivery.losses_w[2] = self.standby_power_w;
        delivery.readings = Readings {
            motor_speed_rad_s: omega,
            motor_torque_n_m: torque,
            battery_voltage_v: u - r * current_a,
            battery_current_a: source_power_w / u,
            ..Readings::NONE
        };
        delivery
    }

    fn force_of_torque_n(&self, torque_n_m: f64, speed_m_s: f64) -> Option<f64> {
        let drives = torque_n_m * speed_m_s >= 0.0;
        let gear = if drives { self.gear_efficiency } else { 1.0 / self.gear_efficiency };
        Some(torque_n_m * self.leverage_per_m() * gear)
    }

    fn battery_capacity_j(&self) -> Option<f64> {
        Some(self.open_circuit_voltage_v * self.capacity_a_h * S_PER_H)
    }
}

#[cfg(test)]
#[path = "electric_single_speed_tests.rs"]
mod tests;
