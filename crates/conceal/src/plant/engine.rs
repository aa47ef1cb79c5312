//! A combustion engine that a controller keeps on a line of its map, behind a transmission without steps.
//!
//! T_i = T + T_f + T_hidden,  ṁ = T_i ω / (e H)          torque by combustion, and the fuel for it; none on overrun
//! dω/dt = (ω_line(P) − ω) / τ                          the controller of the ratio
//!
//! ω_line is where a share of the full-load torque gives the power asked; on overrun it is where friction takes it.
//! Source: Willans' line in torques, Heywood, *Internal Combustion Engine Fundamentals* (1988), section 13.2; a ratio
//! controller as one lag. The line is found by bisection; the full-load curve is two straight pieces.

use super::STEP_S;

/// Constants of engine and transmission.
#[derive(Clone, Debug, PartialEq)]
pub struct Engine {
    /// Efficiency of combustion, the slope of the Willans line.
    pub efficiency: f64,
    /// Friction torque [N m].
    pub friction_n_m: f64,
    /// Heating value [J/kg].
    pub heat_j_kg: f64,
    /// Speeds of the full-load curve [rad/s].
    pub speeds_rad_s: [f64; 3],
    /// Torques at them [N m].
    pub torques_n_m: [f64; 3],
    /// Share of the full-load torque on the line.
    pub load_share: f64,
    /// Efficiency from engine to wheels.
    pub transmission: f64,
    /// Power of fan and pumps [W].
    pub accessory_w: f64,
    /// Efficiency from shaft to electric consumers.
    pub alternator: f64,
    /// Lag of the speed [s].
    pub lag_s: f64,
}

/// What the engine does at one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Running {
    /// Speed [rad/s].
    pub speed_rad_s: f64,
    /// Torque at the crankshaft [N m].
    pub torque_n_m: f64,
    /// Fuel [kg/s].
    pub fuel_kg_s: f64,
}

impl Engine {
    fn full_load_n_m(&self, speed_rad_s: f64) -> f64 {
        let [low, middle, high] = self.speeds_rad_s;
        let [at_low, at_middle, at_high] = self.torques_n_m;
        if speed_rad_s < middle {
            at_low + (at_middle - at_low) * ((speed_rad_s - low) / (middle - low)).max(0.0)
        } else {
            at_middle + (at_high - at_middle) * ((speed_rad_s - middle) / (high - middle)).min(1.0)
        }
    }

    /// Greatest power that the line gives [W].
    pub fn most_w(&self) -> f64 {
        self.load_share * self.torques_n_m[2] * self.speeds_rad_s[2]
    }

    /// Speed at which the line gives a power [rad/s].
    pub fn line_rad_s(&self, power_w: f64, friction_n_m: f64) -> f64 {
        const HALVINGS: usize = 40;
        let [idle, _, top] = self.speeds_rad_s;
        if power_w < -friction_n_m * idle {
            return -power_w / friction_n_m;
        }
        let gives = |speed: f64| self.load_share * self.full_load_n_m(speed) * speed;
        if gives(idle) >= power_w {
            return idle;
        }
        let (mut low, mut high) = (idle, top);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if gives(middle) < power_w { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }

    /// Power at the crankshaft [W] for one at the rim and one of electric consumers.
    pub fn shaft_w(&self, rim_w: f64, electric_w: f64) -> f64 {
        let through = if rim_w > 0.0 { rim_w / self.transmission } else { rim_w * self.transmission };
        through + self.accessory_w + electric_w / self.alternator
    }

    /// Least and greatest force at the rim at a speed of it [N]: friction at top speed, and the line.
    pub fn rim_limits_n(&self, rim_m_s: f64) -> (f64, f64) {
        let at_m_s = rim_m_s.max(0.1);
        let braking_w = self.friction_n_m * self.speeds_rad_s[2] + self.accessory_w;
        let driving_w = (self.most_w() - self.accessory_w) * self.transmission;
        (-braking_w / self.transmission / at_m_s, driving_w / at_m_s)
    }

    /// One step at a power at the crankshaft [W] from a speed [rad/s], with hidden friction [N m].
    pub fn step(&self, power_w: f64, hidden_n_m: f64, speed_rad_s: f64) -> Running {
        let friction_n_m = self.friction_n_m + hidden_n_m;
        let wanted = self.line_rad_s(power_w, friction_n_m);
        let speed_rad_s = if speed_rad_s > 0.0 {
            speed_rad_s + (wanted - speed_rad_s) * (1.0 - (-STEP_S / self.lag_s).exp())
        } else {
            wanted
        };
        let torque_n_m = power_w / speed_rad_s;
        let burnt_n_m = (torque_n_m + friction_n_m).max(0.0);
        Running {
            speed_rad_s,
            torque_n_m,
            fuel_kg_s: burnt_n_m * speed_rad_s / (self.efficiency * self.heat_j_kg),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn engine() -> Engine {
        Engine {
            efficiency: 0.45,
            friction_n_m: 150.0,
            heat_j_kg: 42.8e6,
            speeds_rad_s: [80.0, 120.0, 220.0],
            torques_n_m: [600.0, 1000.0, 800.0],
            load_share: 0.9,
            transmission: 0.85,
            accessory_w: 5000.0,
            alternator: 0.6,
            lag_s: 0.1,
        }
    }

    /// At 170 rad/s full load is 900 N m, the line 810 N m: 137.7 kW. Fuel: (810 + 150) · 170 / (0.45 · 42.8 MJ/kg).
    #[test]
    fn on_its_line_it_burns_what_willans_says() {
        let power = 810.0 * 170.0;
        assert!((engine().line_rad_s(power, 150.0) - 170.0).abs() < 1e-6);
        let running = engine().step(power, 0.0, 170.0);
        assert!((running.torque_n_m - 810.0).abs() < 1e-6);
        assert!((running.fuel_kg_s - 960.0 * 170.0 / (0.45 * 42.8e6)).abs() < 1e-9);
        // 50 N m more friction: 50 · 170 W more, over 0.45.
        let rubbing = engine().step(power, 50.0, 170.0);
        assert!(((rubbing.fuel_kg_s - running.fuel_kg_s) * 0.45 * 42.8e6 - 8500.0).abs() < 1e-3);
    }

    #[test]
    fn overrun_burns_nothing_and_turns_until_friction_takes_it() {
        let running = engine().step(-30_000.0, 0.0, 0.0);
        assert!((running.speed_rad_s - 200.0).abs() < 1e-9);
        assert!(running.fuel_kg_s < 1e-12);
        assert!((engine().shaft_w(-10_000.0, 600.0) - (-8500.0 + 5000.0 + 1000.0)).abs() < 1e-9);
    }
}
