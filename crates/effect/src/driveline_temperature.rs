//! Oil in gears and axles that drags more while it is cold.
//!
//! F = (F₀ + F₁ |v|) x,   dx/dt = −x / τ while turning, x(0) = 1
//! F = (F₀ + F₁ |v|) e^((T₀ − T)/ΔT),                            T the temperature of the oil, where that is told
//!
//! Source: falling viscosity of warming oil (Vogel's law), linearised into one time constant, or as Reynolds has it with the
//! temperature (*Philosophical Transactions* 177 (1886)); magnitudes in Renius, *Fundamentals of Tractor Design* (2020),
//! chapter 5: churning two to three times as much at 0 °C as at 80 °C.
//! x is what is left of the cold excess. Leaves out cooling at rest; by temperature, there is no excess where none is told.
//! Fingerprint: a drag that fades over the first quarter of an hour, in proportion to speed, engaged or in neutral; or one that
//! follows the temperature of the oil, however often that rises and falls.

use crate::series::refuse;
use headland_plugin::{Action, Bound, Card, Effect, Plugin, Refusal, Situation, State, parameter};
use serde::Deserialize;
use std::path::Path;

/// Warm-up of the driveline's oil.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DrivelineTemperature {
    cold_force_n: f64,
    #[serde(default)]
    cold_viscous_n_s_m: f64,
    #[serde(default = "never")]
    time_constant_s: f64,
    #[serde(default = "never")]
    temperature_scale_k: f64,
    #[serde(default = "reference_c")]
    reference_temperature_c: f64,
}

const fn never() -> f64 {
    f64::INFINITY
}

const fn reference_c() -> f64 {
    20.0
}

impl Plugin for DrivelineTemperature {
    const CARD: Card = Card {
        name: "driveline_temperature",
        about: "oil in gears and axles that drags more while it is cold",
        equation: "F = (F₀ + F₁ |v|) x, dx/dt = −x/τ while turning, x(0) = 1; or x = e^((T₀ − T)/ΔT) by the oil's temperature",
        source: "falling viscosity of warming oil, linearised; Renius, Fundamentals of Tractor Design (2020), chapter 5; \
                 Reynolds, Philosophical Transactions 177 (1886)",
        validity: "one warm-up from the start of the run; leaves out cooling at rest",
        parameters: &[
            parameter("cold_force_n", "N", "constant part of the cold excess at the wheels, F₀")
                .must_be(Bound::NotNegative)
                .usually(0.0, 2000.0),
            parameter("cold_viscous_n_s_m", "N s/m", "part in proportion to speed, F₁")
                .must_be(Bound::NotNegative)
                .usually(0.0, 300.0)
                .or(0.0),
            parameter("time_constant_s", "s", "of the warm-up, τ; where it goes by time")
                .must_be(Bound::Positive)
                .usually(200.0, 3000.0)
                .or(never()),
            parameter(
                "temperature_scale_k",
                "K",
                "warming by which the excess falls to 1/e, ΔT; where it goes by the oil",
            )
            .must_be(Bound::Positive)
            .usually(10.0, 80.0)
            .or(never()),
            parameter("reference_temperature_c", "°C", "of the oil at which the excess is as stated, T₀")
                .usually(-20.0, 60.0)
                .or(reference_c()),
        ],
    };

    fn settle(&mut self, _: &Path) -> Result<(), Refusal> {
        if self.time_constant_s.is_finite() || self.temperature_scale_k.is_finite() {
            Ok(())
        } else {
            Err(refuse("time_constant_s", "missing", "this or `temperature_scale_k`"))
        }
    }
}

impl Effect for DrivelineTemperature {
    fn states(&self) -> Vec<State> {
        vec![State { name: "cold_share", initial: 1.0 }]
    }

    fn act(&self, at: &Situation, states: &[f64], rates: &mut [f64]) -> Action {
        rates[0] = if at.speed_m_s == 0.0 { 0.0 } else { -states[0] / self.time_constant_s };
        let cold_n = self.cold_force_n + self.cold_viscous_n_s_m * at.speed_m_s.abs();
        let colder = at.oil_temperature_c.map(|oil_c| self.reference_temperature_c - oil_c);
        let by_oil = match colder {
            _ if self.temperature_scale_k.is_infinite() => 1.0,
            Some(colder) => (colder / self.temperature_scale_k).exp(),
            None => 0.0,
        };
        Action { resistance_n: cold_n * states[0] * by_oil, ..Action::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{act, at_10_m_s, build, rates, same};

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

    /// (100 + 20 · 10) N · e^((20 − 80)/30) = 300 N / e²; nothing where no one knows the oil.
    #[test]
    fn it_follows_the_temperature_of_the_oil() {
        let oil = "(cold_force_n: 100.0, cold_viscous_n_s_m: 20.0, temperature_scale_k: 30.0)";
        let at = |oil_temperature_c| Situation { oil_temperature_c, ..at_10_m_s() };
        assert!(same(
            act::<DrivelineTemperature>(oil, &at(Some(80.0))).resistance_n,
            300.0 * (-2.0_f64).exp()
        ));
        assert_eq!(act::<DrivelineTemperature>(oil, &at(None)).resistance_n, 0.0);
        assert_eq!(rates::<DrivelineTemperature>(oil, &at(Some(80.0)), &[1.0])[0], 0.0);
    }

    #[test]
    fn a_warm_up_by_neither_time_nor_oil_is_refused() {
        let message = build::<DrivelineTemperature>("(cold_force_n: 100.0)").unwrap_err();
        assert!(
            message.contains("`time_constant_s`") && message.contains("`temperature_scale_k`"),
            "{message}"
        );
    }
}
