//! An electric machine with its inverter: losses by torque and speed, limits, and a winding that warms up.
//!
//! P_el = T ω + k_c T² + k_i |ω| + k_w |ω|³ + k_0        driving and braking alike; or T ω + a map of the loss by ω and T
//! |T|  ≤ min(T_max, P_max / |ω|) d(θ),   nothing beyond ω_max
//! C dθ/dt = P_el − T ω − G (θ − θ_coolant),   d falls from 1 at θ₁ to 0 at θ₂
//!
//! Source: Guzzella and Sciarretta, *Vehicle Propulsion Systems* (2013), section 4.4 (copper, iron and windage losses); one
//! thermal node. Coefficients of a machine of 100 kW that are usual here are from memory.
//!
//! The map is straight between its nodes and is never left: it has to reach as far as the machine does.

use crate::parts::{hold, increasing, place, refuse, tapered};
use headland_plugin::{Bound, Refusal};
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
            parameter(
                concat!($of, ".copper_w_per_n2_m2"),
                "W/N²/m²",
                "loss by the square of torque, k_c; all four losses, or `loss_map`",
            )
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
            parameter(
                concat!($of, ".loss_map"),
                "(speeds_rad_s, torques_n_m, losses_w)",
                "losses by speed and torque instead, one list for each speed",
            ),
            parameter(
                concat!($of, ".loss_map.speeds_rad_s"),
                "[rad/s]",
                "speeds of the map, from 0 to the highest speed or beyond, either way round alike",
            )
            .must_be(Bound::NotNegative)
            .usually(0.0, 2500.0),
            parameter(
                concat!($of, ".loss_map.torques_n_m"),
                "[N m]",
                "torques of the map, to the greatest or beyond; from 0 where braking loses as driving, else from its negative",
            )
            .must_be(Bound::Finite)
            .usually(-5000.0, 5000.0),
            parameter(
                concat!($of, ".loss_map.losses_w"),
                "[W]",
                "one list for each speed, one loss for each torque",
            )
            .must_be(Bound::NotNegative)
            .usually(0.0, 2e5),
        ]
    };
}
pub(crate) use machine;

/// Number of parameters that a machine is told by.
pub(crate) const COUNT: usize = 16;

/// Losses by speed and torque.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct LossMap {
    speeds_rad_s: Vec<f64>,
    torques_n_m: Vec<f64>,
    losses_w: Vec<Vec<f64>>,
}

/// An electric machine.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "motor")]
pub(crate) struct Motor {
    max_torque_n_m: f64,
    max_power_w: f64,
    max_speed_rad_s: f64,
    copper_w_per_n2_m2: Option<f64>,
    iron_torque_n_m: Option<f64>,
    windage_n_m_s2: Option<f64>,
    constant_loss_w: Option<f64>,
    heat_capacity_j_k: f64,
    cooling_w_k: f64,
    coolant_temperature_c: f64,
    derating_from_c: f64,
    derating_to_c: f64,
    loss_map: Option<LossMap>,
}

/// The share of the highest speed over which the torque falls to nothing, so that the limit has no step.
const SPEED_TAPER: f64 = 0.02;

/// Stands for a loss that is not told where bounds are checked [any unit]: what every bound allows.
const ANY_LOSS: f64 = 1.0;

impl LossMap {
    #[inline(never)]
    fn loss_w(&self, speed: f64, torque: f64) -> f64 {
        let torque = if self.torques_n_m[0] < 0.0 { torque } else { torque.abs() };
        let (row, along) = place(&self.speeds_rad_s, speed);
        let (column, across) = place(&self.torques_n_m, torque);
        let of = |row: &[f64]| row[column] + across * (row[column + 1] - row[column]);
        let (one, two) = (of(&self.losses_w[row]), of(&self.losses_w[row + 1]));
        one + along * (two - one)
    }
}

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
            ("copper_w_per_n2_m2", self.copper_w_per_n2_m2.unwrap_or(ANY_LOSS)),
            ("iron_torque_n_m", self.iron_torque_n_m.unwrap_or(ANY_LOSS)),
            ("windage_n_m_s2", self.windage_n_m_s2.unwrap_or(ANY_LOSS)),
            ("constant_loss_w", self.constant_loss_w.unwrap_or(ANY_LOSS)),
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
        let told = [self.copper_w_per_n2_m2, self.iron_torque_n_m, self.windage_n_m_s2, self.constant_loss_w];
        match (&self.loss_map, told.iter().flatten().count()) {
            (Some(map), 0) => self.check_map(map, name),
            (None, count) if count == told.len() => Ok(()),
            (Some(_), _) => {
                let found = "given beside other losses";
                Err(refuse(format!("{name}.loss_map"), found, "one of the two"))
            }
            (None, count) => {
                let expected = "`copper_w_per_n2_m2`, `iron_torque_n_m`, `windage_n_m_s2` and `constant_loss_w`, or a `loss_map`";
                Err(refuse(name, format!("told by {count} losses"), expected))
            }
        }
    }

    fn check_map(&self, map: &LossMap, name: &str) -> Result<(), Refusal> {
        let of = |field: &str| format!("{name}.loss_map.{field}");
        let (speeds, torques) = (&map.speeds_rad_s, &map.torques_n_m);
        increasing(&of("speeds_rad_s"), speeds, 2)?;
        increasing(&of("torques_n_m"), torques, 2)?;
        let (first, last) = (speeds[0], speeds[speeds.len() - 1]);
        if first != 0.0 || last < self.max_speed_rad_s {
            let expected = format!("from 0 to {} at least: nothing is extrapolated", self.max_speed_rad_s);
            return Err(refuse(of("speeds_rad_s"), format!("{first} to {last}"), &expected));
        }
        let (least, most) = (torques[0], torques[torques.len() - 1]);
        if !(least == 0.0 || least <= -self.max_torque_n_m) || most < self.max_torque_n_m {
            let greatest = self.max_torque_n_m;
            let expected = format!("from 0 or -{greatest} to {greatest} at least: nothing is extrapolated");
            return Err(refuse(of("torques_n_m"), format!("{least} to {most}"), &expected));
        }
        if map.losses_w.len() != speeds.len() || map.losses_w.iter().any(|row| row.len() != torques.len()) {
            let found = format!(
                "{} lists of {:?} losses",
                map.losses_w.len(),
                map.losses_w.iter().map(Vec::len).collect::<Vec<_>>()
            );
            let expected = format!("{} lists of {} losses", speeds.len(), torques.len());
            return Err(refuse(of("losses_w"), found, &expected));
        }
        match map.losses_w.iter().flatten().find(|loss| !Bound::NotNegative.holds(**loss)) {
            Some(loss) => Err(refuse(of("losses_w"), loss, "0 or more")),
            None => Ok(()),
        }
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
    #[inline]
    pub(crate) fn loss_w(&self, torque_n_m: f64, speed_rad_s: f64) -> f64 {
        let speed = speed_rad_s.abs();
        if let Some(map) = &self.loss_map {
            let braking = if speed_rad_s < 0.0 { -torque_n_m } else { torque_n_m };
            return map.loss_w(speed, braking);
        }
        let of = |coefficient: Option<f64>| coefficient.unwrap_or(0.0);
        of(self.copper_w_per_n2_m2) * torque_n_m * torque_n_m
            + of(self.iron_torque_n_m) * speed
            + of(self.windage_n_m_s2) * speed * speed * speed
            + of(self.constant_loss_w)
    }

    /// Greatest torque, driving or braking, at a speed and a temperature.
    #[inline]
    pub(crate) fn limit_n_m(&self, speed_rad_s: f64, temperature_c: f64) -> f64 {
        let speed = speed_rad_s.abs();
        let torque = if speed * self.max_torque_n_m > self.max_power_w {
            self.max_power_w / speed
        } else {
            self.max_torque_n_m
        };
        let cool = tapered(self.derating_to_c - temperature_c, self.derating_to_c - self.derating_from_c);
        torque * cool * tapered(self.max_speed_rad_s - speed, SPEED_TAPER * self.max_speed_rad_s)
    }

    /// How its temperature changes.
    pub(crate) fn warming_k_s(&self, loss_w: f64, temperature_c: f64) -> f64 {
        (loss_w - self.cooling_w_k * (temperature_c - self.coolant_temperature_c)) / self.heat_capacity_j_k
    }
}

#[cfg(test)]
#[path = "motor_tests.rs"]
pub(crate) mod tests;
