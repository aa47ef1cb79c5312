//! A motor with a fixed gear, and a battery behind it.
//!
//! Rim force: T i / r less the gear's loss, which is a share of the greater of the two powers' torque. Terminal power:
//! motor power with the loss of inverter and motor as a share of the greater power. Current: U I − R I² = P.
//!
//! Source: internal-resistance model, Guzzella and Sciarretta, *Vehicle Propulsion Systems* (2013), section 4.5. The
//! current is found by iteration here, not by the root.

/// Constants of the drive.
#[derive(Clone, Debug, PartialEq)]
pub struct Electric {
    /// Open-circuit voltage at half charge [V].
    pub voltage_v: f64,
    /// Open-circuit voltage from empty to full [V].
    pub rise_v: f64,
    /// Resistance [Ω].
    pub resistance_ohm: f64,
    /// Capacity [A h].
    pub capacity_a_h: f64,
    /// Charge at the start, 0 to 1.
    pub charge: f64,
    /// Motor speed over wheel speed.
    pub gear_ratio: f64,
    /// Efficiency of the gear.
    pub gear_efficiency: f64,
    /// Rolling radius [m].
    pub radius_m: f64,
    /// Efficiency of inverter and motor.
    pub efficiency: f64,
    /// Power that electronics take at all times [W].
    pub standby_w: f64,
    /// Greatest torque, driving and braking [N m].
    pub most_torque_n_m: f64,
    /// Greatest power at the shaft [W].
    pub most_power_w: f64,
}

impl Electric {
    /// Force at the rim that a torque makes [N].
    pub fn rim_n(&self, torque_n_m: f64) -> f64 {
        let ideal = torque_n_m * self.gear_ratio / self.radius_m;
        if ideal >= 0.0 { ideal * self.gear_efficiency } else { ideal / self.gear_efficiency }
    }

    /// Torque for a force at the rim, within the limits [N m].
    pub fn torque_n_m(&self, rim_n: f64, rim_m_s: f64) -> f64 {
        let geared = if rim_n >= 0.0 { rim_n / self.gear_efficiency } else { rim_n * self.gear_efficiency };
        let turn = (rim_m_s * self.gear_ratio / self.radius_m).max(1.0);
        let most = self.most_torque_n_m.min(self.most_power_w / turn);
        (geared * self.radius_m / self.gear_ratio).clamp(-most, most)
    }

    /// Power at the terminals of the inverter [W].
    pub fn inverter_w(&self, torque_n_m: f64, motor_rad_s: f64) -> f64 {
        let shaft = torque_n_m * motor_rad_s;
        if shaft >= 0.0 { shaft / self.efficiency } else { shaft * self.efficiency }
    }

    /// Terminal voltage [V] and current [A] at a power [W], by fixed-point iteration from the last current.
    pub fn battery(&self, charge: f64, power_w: f64, extra_ohm: f64, last_a: f64) -> (f64, f64) {
        const ROUNDS: usize = 12;
        let open_v = self.voltage_v + self.rise_v * (charge - 0.5);
        let ohm = self.resistance_ohm + extra_ohm;
        let mut current_a = last_a;
        for _ in 0..ROUNDS {
            current_a = power_w / (open_v - ohm * current_a);
        }
        (open_v - ohm * current_a, current_a)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    pub(crate) fn drive() -> Electric {
        Electric {
            voltage_v: 360.0,
            rise_v: 50.0,
            resistance_ohm: 0.1,
            capacity_a_h: 60.0,
            charge: 0.5,
            gear_ratio: 10.0,
            gear_efficiency: 0.97,
            radius_m: 0.35,
            efficiency: 0.9,
            standby_w: 300.0,
            most_torque_n_m: 250.0,
            most_power_w: 1e5,
        }
    }

    /// 360 V, 0.1 Ω, 100 A: 350 V at the terminals, so 35 kW asks for 100 A.
    #[test]
    fn the_current_balances_the_power() {
        let (voltage, current) = drive().battery(0.5, 35_000.0, 0.0, 0.0);
        assert!((current - 100.0).abs() < 1e-6 && (voltage - 350.0).abs() < 1e-7, "{voltage} {current}");
    }

    #[test]
    fn torque_and_force_undo_each_other() {
        for rim_n in [-2000.0, -10.0, 0.0, 500.0, 4000.0] {
            let back = drive().rim_n(drive().torque_n_m(rim_n, 5.0));
            assert!((back - rim_n).abs() < 1e-9, "{rim_n} {back}");
        }
    }
}
