//! The inside of an input-split hydrostatic-mechanical transmission.
//!
//! ω_out = a_j ω_e + b_j ω_m               range j: planetaries add up the mechanical path and the hydrostatic motor
//! T_e  = a_j T_out,  T_m = b_j T_out      by virtual work; a mesh takes the share 1 − η_z of what goes through it
//! V_m Δp = T_m + T_f(ω_m, Δp)             T_f = C_d V μ |ω| + C_f V |Δp| + T_c against the rotation
//! ε V_p ω_p = V_m ω_m + C_s (V_m + V_p) Δp / μ,   T_p = ε V_p Δp + T_f(ω_p, Δp),   ω_p = i_p ω_e
//! P_in = a_j T_out ω_e + T_p ω_p + T_spin ω_e + mesh,   T_out = F r / (i_f η_a^(±1))
//!
//! Source: Renius, *Fundamentals of Tractor Design* (2020), chapter 5, for the power split; Wilson, *Positive-Displacement
//! Pumps and Fluid Motors* (1950), for the losses. The values of C_s, C_d and C_f that are usual here are from memory.
//!
//! At ε = 0 a range is at its node: all power goes through the gears. Below it power circulates. Displacements here are for
//! one radian. Friction changes its sign over a rad/s about standstill. A reverser makes backwards as forwards. Leaves out
//! temperature, the charge pump's own control, and what a change of range costs.

use crate::parts::{hold, refuse};
use headland_plugin::{Bound, Parameter, Refusal, parameter};
use serde::Deserialize;
use std::f64::consts::TAU;

/// How its parameters are told, as `transmission.` of a driveline.
pub(crate) const TRANSMISSION: [Parameter; 16] = [
    parameter(
        "transmission.ranges",
        "[(mechanical_ratio, hydrostatic_ratio)]",
        "speed of the output by speed of the engine and of the hydrostatic motor, slowest first, a and b",
    ),
    parameter("transmission.pump_ratio", "1", "pump speed over engine speed, i_p")
        .must_be(Bound::Positive)
        .usually(0.5, 2.5),
    parameter("transmission.pump_displacement_m3", "m³", "for a turn, at full stroke")
        .must_be(Bound::Positive)
        .usually(1e-5, 5e-4),
    parameter("transmission.motor_displacement_m3", "m³", "for a turn")
        .must_be(Bound::Positive)
        .usually(1e-5, 5e-4),
    parameter("transmission.max_pressure_pa", "Pa", "between the two sides, where the relief valves open")
        .must_be(Bound::Positive)
        .usually(1e7, 6e7),
    parameter("transmission.viscosity_pa_s", "Pa s", "of the oil, μ")
        .must_be(Bound::Positive)
        .usually(5e-3, 0.2),
    parameter("transmission.leakage", "1", "of pump and motor, C_s")
        .must_be(Bound::NotNegative)
        .usually(1e-10, 1e-8),
    parameter("transmission.viscous_drag", "1", "of pump and motor, C_d")
        .must_be(Bound::NotNegative)
        .usually(1e4, 1e6),
    parameter("transmission.friction", "1", "of pump and motor, C_f")
        .must_be(Bound::Within(0.0, 0.5))
        .usually(0.0, 0.06),
    parameter("transmission.dry_torque_n_m", "N m", "of pump and motor each, T_c")
        .must_be(Bound::NotNegative)
        .usually(0.0, 10.0)
        .or(0.0),
    parameter("transmission.mesh_efficiency", "1", "of the planetaries, by what goes through them, η_z")
        .must_be(Bound::Efficiency)
        .usually(0.95, 1.0),
    parameter(
        "transmission.spin_torque_n_m",
        "N m",
        "at the engine: charge pump, open clutches, splashing, T_spin",
    )
    .must_be(Bound::NotNegative)
    .usually(0.0, 80.0),
    parameter("transmission.final_ratio", "1", "output over wheels, i_f")
        .must_be(Bound::Positive)
        .usually(1.0, 60.0),
    parameter("transmission.axle_efficiency", "1", "output to wheels, η_a")
        .must_be(Bound::Efficiency)
        .usually(0.9, 1.0),
    parameter("transmission.wheel_radius_m", "m", "rolling radius, r")
        .must_be(Bound::Positive)
        .usually(0.2, 1.2),
    parameter("transmission.rotating_mass_kg", "kg", "inertia of what turns with the wheels, as mass")
        .must_be(Bound::NotNegative)
        .usually(0.0, 3000.0),
];

/// One range as scenarios write it.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Range {
    mechanical_ratio: f64,
    hydrostatic_ratio: f64,
}

/// The transmission.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "transmission")]
pub(crate) struct Hydromechanical {
    ranges: Vec<Range>,
    pump_ratio: f64,
    pump_displacement_m3: f64,
    motor_displacement_m3: f64,
    max_pressure_pa: f64,
    viscosity_pa_s: f64,
    leakage: f64,
    viscous_drag: f64,
    friction: f64,
    #[serde(default)]
    dry_torque_n_m: f64,
    mesh_efficiency: f64,
    spin_torque_n_m: f64,
    final_ratio: f64,
    axle_efficiency: f64,
    wheel_radius_m: f64,
    pub rotating_mass_kg: f64,
}

/// What goes through it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Through {
    /// Power at the shaft of the engine.
    pub input_w: f64,
    /// Stroke of the pump, −1 to 1.
    pub stroke: f64,
    /// Pressure between the sides of the hydrostat.
    pub pressure_pa: f64,
}

/// Speed over which friction changes its sign [rad/s].
const SIGN_SPEED_RAD_S: f64 = 1.0;

/// How much nearer to its node another range must be, as a share of the stroke, to be worth the change.
const WORTH_A_CHANGE: f64 = 0.3;

fn sign(speed: f64) -> f64 {
    speed / (speed * speed + SIGN_SPEED_RAD_S * SIGN_SPEED_RAD_S).sqrt()
}

impl Hydromechanical {
    /// Checks what is told of it.
    ///
    /// # Errors
    /// [`Refusal`] by the full name of the parameter.
    pub(crate) fn settle(&self) -> Result<(), Refusal> {
        let values = [
            ("pump_ratio", self.pump_ratio),
            ("pump_displacement_m3", self.pump_displacement_m3),
            ("motor_displacement_m3", self.motor_displacement_m3),
            ("max_pressure_pa", self.max_pressure_pa),
            ("viscosity_pa_s", self.viscosity_pa_s),
            ("leakage", self.leakage),
            ("viscous_drag", self.viscous_drag),
            ("friction", self.friction),
            ("dry_torque_n_m", self.dry_torque_n_m),
            ("mesh_efficiency", self.mesh_efficiency),
            ("spin_torque_n_m", self.spin_torque_n_m),
            ("final_ratio", self.final_ratio),
            ("axle_efficiency", self.axle_efficiency),
            ("wheel_radius_m", self.wheel_radius_m),
            ("rotating_mass_kg", self.rotating_mass_kg),
        ];
        hold(&TRANSMISSION, &values)?;
        let name = "transmission.ranges";
        let Some(first) = self.ranges.first() else {
            return Err(refuse(name, "no range", "one or more"));
        };
        for range in &self.ranges {
            let (a, b) = (range.mechanical_ratio, range.hydrostatic_ratio);
            if !(a.is_finite() && a >= 0.0 && b.is_finite() && b > 0.0) {
                return Err(refuse(
                    name,
                    format!("({a}, {b})"),
                    "a mechanical ratio of 0 or more and a hydrostatic one above",
                ));
            }
        }
        let (least, _) = self.ratios(first);
        if least > 0.0 {
            let expected = "a first range that reaches standstill: mechanical_ratio ≤ hydrostatic_ratio × greatest motor speed";
            return Err(refuse(name, format!("ratios from {least:.4} on in the first range"), expected));
        }
        for pair in self.ranges.windows(2) {
            let ((_, end), (begin, next)) = (self.ratios(&pair[0]), self.ratios(&pair[1]));
            if begin > end || next <= end {
                let found = format!("ratios up to {end:.4}, then {begin:.4} to {next:.4}");
                return Err(refuse(name, found, "ranges without a gap that go on rising"));
            }
        }
        Ok(())
    }

    /// Least and greatest ratio of output to engine speed in a range.
    fn ratios(&self, range: &Range) -> (f64, f64) {
        let span = range.hydrostatic_ratio * self.reach();
        (range.mechanical_ratio - span, range.mechanical_ratio + span)
    }

    /// Greatest motor speed over engine speed.
    fn reach(&self) -> f64 {
        self.pump_ratio * self.pump_displacement_m3 / self.motor_displacement_m3
    }

    fn range(&self, index: f64) -> &Range {
        let last = self.ranges.len() - 1;
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a state that `choose` set"
        )]
        let index = (index.max(0.0) as usize).min(last);
        &self.ranges[index]
    }

    fn output_rad_s(&self, speed_m_s: f64) -> f64 {
        self.final_ratio * speed_m_s.abs() / self.wheel_radius_m
    }

    /// Torque at the output that makes a force at the wheels, both forward.
    fn output_n_m(&self, force_n: f64) -> f64 {
        let torque = force_n * self.wheel_radius_m / self.final_ratio;
        if force_n >= 0.0 { torque / self.axle_efficiency } else { torque * self.axle_efficiency }
    }

    /// The slowest that the engine may turn for a speed: the greatest ratio there is.
    pub(crate) fn least_engine_rad_s(&self, speed_m_s: f64) -> f64 {
        let (_, most) = self.ratios(&self.ranges[self.ranges.len() - 1]);
        self.output_rad_s(speed_m_s) / most
    }

    /// Engine speed over wheel speed; NaN at rest.
    pub(crate) fn ratio(&self, engine_rad_s: f64, speed_m_s: f64) -> f64 {
        let wheel = speed_m_s.abs() / self.wheel_radius_m;
        if wheel > 0.0 { engine_rad_s / wheel } else { f64::NAN }
    }

    /// How far from its node a range stands, as a share of the stroke without leakage.
    fn stroke(&self, range: &Range, speed_m_s: f64, engine_rad_s: f64) -> f64 {
        let motor =
            (self.output_rad_s(speed_m_s) - range.mechanical_ratio * engine_rad_s) / range.hydrostatic_ratio;
        motor / (self.reach() * engine_rad_s)
    }

    /// The range to drive in: that of now as long as it reaches, unless another is much nearer to its node.
    pub(crate) fn choose(&self, now: f64, speed_m_s: f64, engine_rad_s: f64) -> f64 {
        if engine_rad_s <= 0.0 {
            return now;
        }
        let distance = |range: &Range| self.stroke(range, speed_m_s, engine_rad_s).abs();
        let here = distance(self.range(now));
        let mut best = (now, f64::INFINITY);
        for (index, range) in self.ranges.iter().enumerate() {
            if distance(range) < best.1 {
                best = (index as f64, distance(range));
            }
        }
        if here > 1.0 || best.1 < here - WORTH_A_CHANGE { best.0 } else { now }
    }

    /// Greatest force at the wheels that the pressure of a range allows, driving and braking.
    pub(crate) fn most_force_n(&self, range: f64, speed_m_s: f64, engine_rad_s: f64) -> (f64, f64) {
        let range = self.range(range);
        let displacement = self.motor_displacement_m3 / TAU;
        let motor =
            (self.output_rad_s(speed_m_s) - range.mechanical_ratio * engine_rad_s) / range.hydrostatic_ratio;
        let drag = self.viscous_drag * displacement * self.viscosity_pa_s * motor.abs() + self.dry_torque_n_m;
        let torque = (displacement * self.max_pressure_pa * (1.0 - self.friction) - drag).max(0.0);
        let force = torque / range.hydrostatic_ratio * self.final_ratio / self.wheel_radius_m;
        (force * self.axle_efficiency, force / self.axle_efficiency)
    }

    /// What goes through it at a speed and a force at the wheels, both counted in the direction of driving.
    pub(crate) fn through(&self, range: f64, speed_m_s: f64, force_n: f64, engine_rad_s: f64) -> Through {
        let Range { mechanical_ratio: a, hydrostatic_ratio: b } = *self.range(range);
        let (output, torque) = (self.output_rad_s(speed_m_s), self.output_n_m(force_n));
        let motor = (output - a * engine_rad_s) / b;
        let (v_m, v_p) = (self.motor_displacement_m3 / TAU, self.pump_displacement_m3 / TAU);
        let way = sign(motor);
        let drag = self.viscous_drag * v_m * self.viscosity_pa_s * motor.abs() + self.dry_torque_n_m;
        let wanted = b * torque + way * drag;
        let pressure_pa = wanted / (v_m * (1.0 - way * self.friction * wanted.signum()));
        let flow = v_m * motor + self.leakage * (v_m + v_p) * pressure_pa / self.viscosity_pa_s;
        let pump = self.pump_ratio * engine_rad_s;
        let pump_w = flow * pressure_pa + self.pump_drag_w(pump, pressure_pa);
        let (mechanical_w, hydrostatic_w) = (a * torque * engine_rad_s, b * torque * motor);
        let mesh_w = (1.0 - self.mesh_efficiency) * (mechanical_w.abs() + hydrostatic_w.abs());
        Through {
            input_w: mechanical_w + pump_w + mesh_w + self.spin_torque_n_m * engine_rad_s,
            stroke: if pump > 0.0 { flow / (v_p * pump) } else { 0.0 },
            pressure_pa,
        }
    }

    fn pump_drag_w(&self, pump_rad_s: f64, pressure_pa: f64) -> f64 {
        let v_p = self.pump_displacement_m3 / TAU;
        let drag = self.viscous_drag * v_p * self.viscosity_pa_s * pump_rad_s
            + self.friction * v_p * pressure_pa.abs()
            + self.dry_torque_n_m;
        drag * pump_rad_s
    }

    /// Power that it takes in neutral.
    pub(crate) fn neutral_w(&self, engine_rad_s: f64) -> f64 {
        self.spin_torque_n_m * engine_rad_s + self.pump_drag_w(self.pump_ratio * engine_rad_s, 0.0)
    }
}

#[cfg(test)]
#[path = "hydromechanical_tests.rs"]
pub(crate) mod tests;
