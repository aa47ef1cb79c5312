//! Oil in gears and axles that drags more while it is cold.
//!
//! F = (F₀ + F₁ |v|) x,   dx/dt = −x / τ while turning, x(0) = 1
//!
//! Source: falling viscosity of warming oil (Vogel's law), linearised into one time constant; magnitudes in Renius,
//! *Fundamentals of Tractor Design* (2020), chapter 5: churning two to three times as much at 0 °C as at 80 °C.
//! x is what is left of the cold excess. Leaves out cooling at rest.
//! Fingerprint: a drag that fades over the first quarter of an hour, in proportion to speed, engaged or in neutral.

use headland_plugin::{Action, Bound, Card, Effect, Plugin, Situation, State, parameter};
use serde::Deserialize;

/// Warm-up of the driveline's oil.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DrivelineTemperature {
    cold_force_n: f64,
    #[serde(default)]
    cold_viscous_n_s_m: f64,
    time_constant_s: f64,
}

impl Plugin for DrivelineTemperature {
    const CARD: Card = Card {
        name: "driveline_temperature",
        about: "oil in gears and axles that drags more while it is cold",
        equation: "F = (F₀ + F₁ |v|) x, dx/dt = −x/τ while turning, x(0) = 1",
        source: "falling viscosity of warming oil, linearised; Renius, Fundamentals of Tractor Design (2020), chapter 5",
        validity: "one warm-up from the start of the run; leaves out cooling at rest",
        parameters: &[
            parameter("cold_force_n", "N", "constant part of the cold excess at the wheels, F₀")
                .must_be(Bound::NotNegative)
                .usually(0.0, 2000.0),
            parameter("cold_viscous_n_s_m", "N s/m", "part in proportion to speed, F₁")
                .must_be(Bound::NotNegative)
                .usually(0.0, 300.0)
                .or(0.0),
            parameter("time_constant_s", "s", "of the warm-up, τ")
                .must_be(Bound::Positive)
                .usually(200.0, 3000.0),
        ],
    };
}

impl Effect for DrivelineTemperature {
    fn states(&self) -> Vec<State> {
        vec![State { name: "cold_share", initial: 1.0 }]
    }

    fn act(&self, at: &Situation, states: &[f64], rates: &mut [f64]) -> Action {
        rates[0] = if at.speed_m_s == 0.0 { 0.0 } else { -states[0] / self.time_constant_s };
        let cold_n = self.cold_force_n + self.cold_viscous_n_s_m * at.speed_m_s.abs();
        Action { resistance_n: cold_n * states[0], ..Action::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{at_10_m_s, build, rates, same};

    const OIL: &str = "(cold_force_n: 100.0, cold_viscous_n_s_m: 20.0, time_constant_s: 600.0)";

    /// (100 + 20 · 10) N · 0.25 = 75 N.
    #[test]
    fn a_quarter_of_the_cold_excess_by_hand() {
        let oil = build::<DrivelineTemperature>(OIL).unwrap();
        assert!(same(oil.act(&at_10_m_s(), &[0.25], &mut [0.0]).resistance_n, 75.0));
        assert_eq!(oil.states()[0].initial, 1.0);
    }

    #[test]
    fn it_warms_by_turning_and_not_at_rest() {
        assert!(same(rates::<DrivelineTemperature>(OIL, &at_10_m_s(), &[0.6])[0], -0.001));
        let resting = Situation { speed_m_s: 0.0, ..at_10_m_s() };
        assert_eq!(rates::<DrivelineTemperature>(OIL, &resting, &[0.6])[0], 0.0);
    }

    #[test]
    fn a_warm_up_without_time_is_refused() {
        assert!(build::<DrivelineTemperature>("(cold_force_n: 100.0)").is_err());
    }
}
