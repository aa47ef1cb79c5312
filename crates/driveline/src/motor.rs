//! An electric machine with its inverter: losses by torque and speed, limits, and a winding that warms up.
//!
//! P_el = T ω + k_c T² + k_i |ω| + k_w |ω|³ + k_0        driving and braking alike
//! |T|  ≤ min(T_max, P_max / |ω|) d(θ),   nothing beyond ω_max
//! C dθ/dt = P_el − T ω − G (θ − θ_coolant),   d falls from 1 at θ₁ to 0 at θ₂
//!
//! Source: Guzzella and Sciarretta, *Vehicle Propulsion Systems* (2013), section 4.4 (copper, iron and windage losses); one
//! thermal node. Coefficients of a machine of 100 kW that are usual here are from memory.

use crate::parts::{hold, refuse};
use headland_plugin::Refusal;
use serde::Deserialize;

/// How a machine's parameters are told.
macro_rules! machine {
    ($of:literal) => {
        [
            parameter(concat!($of, ".max_torque_n_m"), "N m", "for a short time, T_max")
                .must_be(Bound::Positive)
                .usually(20.0, 5000.0),
            parameter(concat!($of, ".max_power_w"), "W", "at the shaft, for a short time, P_max")
                .must_be(Bound::Positive)
                .usually(5e3, 1e6),
            parameter(concat!($of, ".max_speed_rad_s"), "rad/s", "highest speed, ω_max")
                .must_be(Bound::Positive)
                .usually(200.0, 2000.0),
            parameter(concat!($of, ".copper_w_per_n2_m2"), "W/N²/m²", "loss by the square of torque, k_c")
                .must_be(Bound::Positive)
                .usually(1e-4, 1.0),
            parameter(concat!($of, ".iron_torque_n_m"), "N m", "loss by speed, k_i")
                .must_be(Bound::NotNegative)
                .usually(0.0, 20.0),
            parameter(concat!($of, ".windage_n_m_s2"), "N m s²", "loss by the cube of speed, k_w")
                .must_be(Bound::NotNegative)
                .usually(0.0, 1e-4),
            parameter(concat!($of, ".constant_loss_w"), "W", "at all times that it is switched on, k_0")
                .must_be(Bound::NotNegative)
                .usually(0.0, 2e3),
            parameter(concat!($of, ".heat_capacity_j_k"), "J/K", "of the winding and the iron about it, C")
                .must_be(Bound::Positive)
                .usually(1e3, 1e6),
            parameter(concat!($of, ".cooling_w_k"), "W/K", "from the winding to the coolant, G")
                .must_be(Bound::Positive)
                .usually(5.0, 2000.0),
            parameter(
                concat!($of, ".coolant_temperature_c"),
                "°C",
                "of the coolant, and at the start of a run",
            )
            .must_be(Bound::Within(-40.0, 120.0))
            .usually(-20.0, 90.0),
            parameter(concat!($of, ".derating_from_c"), "°C", "torque falls from this temperature, θ₁")
                .must_be(Bound::Finite)
                .usually(80.0, 180.0),
            parameter(concat!($of, ".derating_to_c"), "°C", "to nothing at this, θ₂")
                .must_be(Bound::Finite)
                .usually(100.0, 220.0),
        ]
    };
}
pub(crate) use machine;

/// An electric machine.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "motor")]
pub(crate) struct Motor {
    max_torque_n_m: f64,
    max_power_w: f64,
    max_speed_rad_s: f64,
    copper_w_per_n2_m2: f64,
    iron_torque_n_m: f64,
    windage_n_m_s2: f64,
    constant_loss_w: f64,
    heat_capacity_j_k: f64,
    cooling_w_k: f64,
    coolant_temperature_c: f64,
    derating_from_c: f64,
    derating_to_c: f64,
}

/// The share of the highest speed over which the torque falls to nothing, so that the limit has no step.
const SPEED_TAPER: f64 = 0.02;

impl Motor {
    /// Checks what is told of it as `name`.
    ///
    /// # Errors
    /// [`Refusal`] by the full name of the parameter.
    pub(crate) fn settle(&self, name: &str, card: &[headland_plugin::Parameter]) -> Result<(), Refusal> {
        let of: Vec<_> =
            card.iter().filter(|one| one.name.starts_with(&format!("{name}."))).copied().collect();
        let values = [
            ("max_torque_n_m", self.max_torque_n_m),
            ("max_power_w", self.max_power_w),
            ("max_speed_rad_s", self.max_speed_rad_s),
            ("copper_w_per_n2_m2", self.copper_w_per_n2_m2),
            ("iron_torque_n_m", self.iron_torque_n_m),
            ("windage_n_m_s2", self.windage_n_m_s2),
            ("constant_loss_w", self.constant_loss_w),
            ("heat_capacity_j_k", self.heat_capacity_j_k),
            ("cooling_w_k", self.cooling_w_k),
            ("coolant_temperature_c", self.coolant_temperature_c),
            ("derating_from_c", self.derating_from_c),
            ("derating_to_c", self.derating_to_c),
        ];
        hold(&of, &values)?;
        if self.derating_to_c <= self.derating_from_c || self.derating_from_c <= self.coolant_temperature_c {
            let found = format!("{} to {} °C", self.derating_from_c, self.derating_to_c);
            let expected = format!("rising, from above {} °C of the coolant", self.coolant_temperature_c);
            return Err(refuse(format!("{name}.derating_to_c"), found, &expected));
        }
        Ok(())
    }

    pub(crate) fn coolant_c(&self) -> f64 {
        self.coolant_temperature_c
    }

    pub(crate) fn max_rad_s(&self) -> f64 {
        self.max_speed_rad_s
    }

    /// The lowest speed at which it gives a power, cold.
    pub(crate) fn lowest_rad_s(&self, power_w: f64) -> f64 {
        power_w.abs().min(self.max_power_w) / self.max_torque_n_m
    }

    /// Loss at a torque and a speed.
    pub(crate) fn loss_w(&self, torque_n_m: f64, speed_rad_s: f64) -> f64 {
        self.copper_w_per_n2_m2 * torque_n_m * torque_n_m + self.idle_w(speed_rad_s)
    }

    fn idle_w(&self, speed_rad_s: f64) -> f64 {
        let speed = speed_rad_s.abs();
        self.iron_torque_n_m * speed + self.windage_n_m_s2 * speed * speed * speed + self.constant_loss_w
    }

    /// Greatest torque, driving or braking, at a speed and a temperature.
    pub(crate) fn limit_n_m(&self, speed_rad_s: f64, temperature_c: f64) -> f64 {
        let speed = speed_rad_s.abs();
        let torque = if speed * self.max_torque_n_m > self.max_power_w {
            self.max_power_w / speed
        } else {
            self.max_torque_n_m
        };
        let cool = (self.derating_to_c - temperature_c) / (self.derating_to_c - self.derating_from_c);
        let slow = (self.max_speed_rad_s - speed) / (SPEED_TAPER * self.max_speed_rad_s);
        torque * cool.clamp(0.0, 1.0) * slow.clamp(0.0, 1.0)
    }

    /// How its temperature changes.
    pub(crate) fn warming_k_s(&self, loss_w: f64, temperature_c: f64) -> f64 {
        (loss_w - self.cooling_w_k * (temperature_c - self.coolant_temperature_c)) / self.heat_capacity_j_k
    }
}

#[cfg(test)]
#[path = "motor_tests.rs"]
pub(crate) mod tests;
