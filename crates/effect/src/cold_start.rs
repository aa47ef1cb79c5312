//! An engine that rubs more while it is cold.
//!
//! T_f = T_cold x + T_start y,   dx/dt = −x / τ,   dy/dt = −y / 15 s,   x(0) = y(0) = 1
//!
//! Source: engine friction by oil temperature, in Guzzella and Onder, *Introduction to Modeling and Control of Internal Combustion
//! Engine Systems* (2010), section 2.5, with one time constant of warm-up. What enrichment, fast idling and a cold catalyst take
//! besides lasts about as long as a catalyst takes to light off: Heywood, *Internal Combustion Engine Fundamentals* (2018), section
//! 11.6; it is written as a friction too, with a time constant of its own.
//! The engine runs from the start of the run on.
//! Fingerprint: fuel that is missing in proportion to engine speed and fades over the first minutes, at idle as under load.

use headland_plugin::{Action, Bound, Card, Effect, Plugin, Situation, State, parameter};
use serde::Deserialize;

/// Friction that fades as the engine warms up.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ColdStart {
    cold_torque_n_m: f64,
    time_constant_s: f64,
    #[serde(default)]
    start_torque_n_m: f64,
}

/// How long enrichment and a cold catalyst last [s].
const START_S: f64 = 15.0;

impl Plugin for ColdStart {
    const CARD: Card = Card {
        name: "cold_start",
        about: "an engine that rubs more while it is cold",
        equation: "T_f = T_cold x + T_start y, dx/dt = −x/τ, dy/dt = −y/15 s, x(0) = y(0) = 1",
        source: "engine friction by oil temperature; Guzzella and Onder, Introduction to Modeling and Control of Internal \
                 Combustion Engine Systems (2010), section 2.5",
        validity: "an engine that runs from the start of the run",
        parameters: &[
            parameter(
                "cold_torque_n_m",
                "N m",
                "friction beside the warm one at the start, at the crankshaft, T_cold",
            )
            .must_be(Bound::NotNegative)
            .usually(0.0, 300.0),
            parameter("time_constant_s", "s", "of the warm-up, τ")
                .must_be(Bound::Positive)
                .usually(60.0, 1500.0),
            parameter(
                "start_torque_n_m",
                "N m",
                "what enrichment and a cold catalyst take besides at the start, at the crankshaft, T_start",
            )
            .must_be(Bound::NotNegative)
            .usually(0.0, 500.0)
            .or(0.0),
        ],
    };
}

impl Effect for ColdStart {
    fn states(&self) -> Vec<State> {
        vec![State { name: "cold_share", initial: 1.0 }, State { name: "start_share", initial: 1.0 }]
    }

    fn act(&self, _: &Situation, states: &[f64], rates: &mut [f64]) -> Action {
        rates[0] = -states[0] / self.time_constant_s;
        rates[1] = -states[1] / START_S;
        let torque_n_m = self.cold_torque_n_m * states[0] + self.start_torque_n_m * states[1];
        Action { engine_friction_n_m: torque_n_m, ..Action::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{act, at_10_m_s, build, rates, same};

    const COLD: &str = "(cold_torque_n_m: 40.0, time_constant_s: 200.0)";

    #[test]
    fn all_of_it_at_the_start_and_less_by_the_second() {
        assert_eq!(act::<ColdStart>(COLD, &at_10_m_s()).engine_friction_n_m, 40.0);
        assert!(same(rates::<ColdStart>(COLD, &at_10_m_s(), &[0.5, 0.0])[0], -0.0025));
        let later = build::<ColdStart>(COLD).unwrap().act(&at_10_m_s(), &[0.5, 0.9], &mut [0.0, 0.0]);
        assert!(same(later.engine_friction_n_m, 20.0));
    }

    #[test]
    fn what_the_start_takes_fades_by_itself() {
        const START: &str = "(cold_torque_n_m: 40.0, time_constant_s: 200.0, start_torque_n_m: 90.0)";
        assert_eq!(act::<ColdStart>(START, &at_10_m_s()).engine_friction_n_m, 130.0);
        assert!(same(rates::<ColdStart>(START, &at_10_m_s(), &[0.5, 0.3])[1], -0.02));
        let later = build::<ColdStart>(START).unwrap().act(&at_10_m_s(), &[0.5, 0.1], &mut [0.0, 0.0]);
        assert!(same(later.engine_friction_n_m, 29.0));
    }

    #[test]
    fn a_warm_up_without_time_is_refused() {
        assert!(build::<ColdStart>("(cold_torque_n_m: 40.0)").is_err());
    }
}
