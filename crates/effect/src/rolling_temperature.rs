//! Tyres that resist more while they are cold.
//!
//! F = (c_cold x + k (T₀ − T)) m g cos θ,   dx/dt = −x / τ while rolling, x(0) = 1        T the temperature of the air
//!
//! Source: structure of Mars and Luchini, *Tire Science and Technology* 27 (1999), heat balance of a rolling tyre, linearised
//! about its steady temperature; the steady part as the temperature correction of UN GTR 15, annex 4.
//! Without a known temperature the steady part is 0. Leaves out cooling at rest and the change of τ with speed.
//! Fingerprint: a resistance that fades over the first minutes of rolling whatever the place, and a level that rises as the
//! day gets colder.

use crate::rolling_resistance::load_n;
use headland_plugin::{Action, Bound, Card, Effect, Plugin, Situation, State, parameter};
use serde::Deserialize;

/// Warm-up of the tyres.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RollingTemperature {
    cold_coefficient: f64,
    time_constant_s: f64,
    #[serde(default)]
    coefficient_per_k: f64,
    #[serde(default = "reference_c")]
    reference_temperature_c: f64,
}

const fn reference_c() -> f64 {
    20.0
}

impl Plugin for RollingTemperature {
    const CARD: Card = Card {
        name: "rolling_temperature",
        about: "tyres that resist more while they are cold, and in the cold",
        equation: "F = (c_cold x + k (T₀ − T)) m g cos θ, dx/dt = −x/τ while rolling, x(0) = 1",
        source: "structure of Mars and Luchini, Tire Science and Technology 27 (1999); UN GTR 15, annex 4",
        validity: "one warm-up from the start of the run; leaves out cooling at rest",
        parameters: &[
            parameter("cold_coefficient", "1", "resistance per load that is lost by warming up, c_cold")
                .usually(-0.005, 0.03),
            parameter("time_constant_s", "s", "of the warm-up, τ")
                .must_be(Bound::Positive)
                .usually(300.0, 6000.0),
            parameter(
                "coefficient_per_k",
                "1/K",
                "resistance per load for each kelvin that the air is colder, k",
            )
            .usually(-1e-4, 1e-3)
            .or(0.0),
            parameter("reference_temperature_c", "°C", "of the air to which the ground model belongs, T₀")
                .usually(-10.0, 40.0)
                .or(reference_c()),
        ],
    };
}

impl Effect for RollingTemperature {
    fn states(&self) -> Vec<State> {
        vec![State { name: "cold_share", initial: 1.0 }]
    }

    fn act(&self, at: &Situation, states: &[f64], rates: &mut [f64]) -> Action {
        rates[0] = if at.speed_m_s == 0.0 { 0.0 } else { -states[0] / self.time_constant_s };
        let colder = self.reference_temperature_c - at.air.temperature_c;
        let steady = if colder.is_nan() { 0.0 } else { self.coefficient_per_k * colder };
        Action {
            resistance_n: (self.cold_coefficient * states[0] + steady) * load_n(at),
            ..Action::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{act, at_10_m_s, build, rates, same};

    const TYRES: &str = "(cold_coefficient: 0.004, time_constant_s: 800.0, coefficient_per_k: 0.0001)";

    /// (0.004 + 0.0001 · 15) · 20 kN = 110 N at 5 °C; 80 N where no one knows the temperature.
    #[test]
    fn the_start_on_a_cold_day_by_hand() {
        let mut at = at_10_m_s();
        assert!(same(act::<RollingTemperature>(TYRES, &at).resistance_n, 110.0));
        at.air.temperature_c = f64::NAN;
        assert!(same(act::<RollingTemperature>(TYRES, &at).resistance_n, 80.0));
    }

    #[test]
    fn it_warms_by_rolling_and_not_at_rest() {
        assert!(same(rates::<RollingTemperature>(TYRES, &at_10_m_s(), &[0.5])[0], -0.5 / 800.0));
        let resting = Situation { speed_m_s: 0.0, ..at_10_m_s() };
        assert_eq!(rates::<RollingTemperature>(TYRES, &resting, &[0.5])[0], 0.0);
    }

    #[test]
    fn a_warm_up_without_time_is_refused() {
        assert!(build::<RollingTemperature>("(cold_coefficient: 0.004)").is_err());
    }
}
