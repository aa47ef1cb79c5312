//! A hitch that lifts and lowers what hangs on it.
//!
//! dx/dt = ±1/T towards its end, slower within its last tenth        x: 0 in the ground, 1 lifted
//! P = m g h |dx/dt| / η        while it lifts; lowering takes nothing
//!
//! Source: definition: work of lifting. A tractor lifts some tonnes within 3 to 5 s and takes 40 to 60 kW for it (usual
//! values from memory). What the lifted mass gains in height is counted as taken; lowering does not give it back.

use headland_plugin::{Mode, Refusal};
use serde::Deserialize;

/// A hitch and what hangs on it.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Hitch {
    mass_kg: f64,
    height_m: f64,
    time_s: f64,
    efficiency: f64,
    working_share: f64,
    lifted_share: f64,
}

/// Within this share of its way the hitch slows down.
const SOFT_END: f64 = 0.1;

impl Hitch {
    /// Checks what it was read as.
    ///
    /// # Errors
    /// [`Refusal`] names the parameter.
    pub fn check(&self) -> Result<(), Refusal> {
        let refuse = |name: &str, found: f64, expected: &str| Refusal {
            parameter: format!("hitch.{name}"),
            found: found.to_string(),
            expected: expected.to_owned(),
        };
        for (name, value) in [("mass_kg", self.mass_kg), ("height_m", self.height_m)] {
            if !(value.is_finite() && value >= 0.0) {
                return Err(refuse(name, value, "0 or more"));
            }
        }
        if !(self.time_s > 0.0 && self.time_s.is_finite()) {
            return Err(refuse("time_s", self.time_s, "more than 0"));
        }
        if !(self.efficiency > 0.0 && self.efficiency <= 1.0) {
            return Err(refuse("efficiency", self.efficiency, "more than 0 and at most 1"));
        }
        for (name, share) in [("working_share", self.working_share), ("lifted_share", self.lifted_share)] {
            if !(0.0..=1.0).contains(&share) {
                return Err(refuse(name, share, "0 to 1"));
            }
        }
        Ok(())
    }

    /// How high it lifts [m].
    pub fn lift_m(&self) -> f64 {
        self.height_m
    }

    /// How fast it moves from where it is [1/s].
    pub fn rate(&self, mode: Mode, lifted: f64) -> f64 {
        let target = if mode == Mode::Work { 0.0 } else { 1.0 };
        ((target - lifted) / (SOFT_END * self.time_s)).clamp(-1.0 / self.time_s, 1.0 / self.time_s)
    }

    /// Hydraulic power of moving at a rate [W].
    pub fn power_w(&self, rate: f64, gravity_m_s2: f64) -> f64 {
        self.mass_kg * gravity_m_s2 * self.height_m * rate.max(0.0) / self.efficiency
    }

    /// Mass that the vehicle carries, and that the ground or other wheels carry [kg].
    pub fn masses_kg(&self, lifted: f64) -> (f64, f64) {
        let share = self.working_share + lifted * (self.lifted_share - self.working_share);
        (share * self.mass_kg, (1.0 - share) * self.mass_kg)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLOUGH: Hitch = Hitch {
        mass_kg: 1800.0,
        height_m: 0.8,
        time_s: 3.0,
        efficiency: 0.75,
        working_share: 0.2,
        lifted_share: 1.0,
    };

    /// 1800 kg · 10 m/s² · 0.8 m / 3 s / 0.75 = 6400 W.
    #[test]
    fn lifting_takes_power_and_lowering_takes_none() {
        let up = PLOUGH.rate(Mode::Rest, 0.5);
        assert!((PLOUGH.power_w(up, 10.0) - 6400.0).abs() < 1e-9);
        let down = PLOUGH.rate(Mode::Work, 0.5);
        assert_eq!((down, PLOUGH.power_w(down, 10.0)), (-up, 0.0));
        assert_eq!((PLOUGH.rate(Mode::Work, 0.0), PLOUGH.rate(Mode::Idle, 1.0)), (0.0, 0.0));
        assert!(PLOUGH.rate(Mode::Rest, 0.98) < up);
    }

    #[test]
    fn the_weight_moves_from_the_ground_to_the_vehicle() {
        assert_eq!(PLOUGH.masses_kg(0.0), (360.0, 1440.0));
        assert_eq!(PLOUGH.masses_kg(1.0), (1800.0, 0.0));
        let refused = Hitch { time_s: 0.0, ..PLOUGH }.check().unwrap_err();
        assert_eq!(refused.to_string(), "`hitch.time_s` is 0, expected more than 0");
    }
}
