//! An engine that rubs more while it is cold.
//!
//! T_f = T_cold x,   dx/dt = −x / τ,   x(0) = 1
//!
//! Source: engine friction by oil temperature, in Guzzella and Onder, *Introduction to Modeling and Control of Internal Combustion
//! Engine Systems* (2010), section 2.5, with one time constant of warm-up.
//! The engine runs from the start of the run on. Leaves out enrichment and catalyst heating.
//! Fingerprint: fuel that is missing in proportion to engine speed and fades over the first minutes, at idle as under load.

use headland_plugin::{Action, Bound, Card, Effect, Plugin, Situation, State, parameter};
use serde::Deserialize;

/// Friction that fades as the engine warms up.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ColdStart {
    cold_torque_n_m: f64,
    time_constant_s: f64,
}

impl Plugin for ColdStart {
    const CARD: Card = Card {
        name: "cold_start",
        about: "an engine that rubs more while it is cold",
        equation: "T_f = T_cold x, dx/dt = −x/τ, x(0) = 1",
        source: "engine friction by oil temperature; Guzzella and Onder, Introduction to Modeling and Control of Internal \
                 Combustion Engine Systems (2010), section 2.5",
        validity: "an engine that runs from the start of the run; leaves out enrichment",
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
        ],
    };
}

impl Effect for ColdStart {
    fn states(&self) -> Vec<State> {
        vec![State { name: "cold_share", initial: 1.0 }]
    }

    fn act(&self, _: &Situation, states: &[f64], rates: &mut [f64]) -> Action {
        rates[0] = -states[0] / self.time_constant_s;
        Action { engine_friction_n_m: self.cold_torque_n_m * states[0], ..Action::default() }
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
        assert!(same(rates::<ColdStart>(COLD, &at_10_m_s(), &[0.5])[0], -0.0025));
        assert!(same(
            build::<ColdStart>(COLD).unwrap().act(&at_10_m_s(), &[0.5], &mut [0.0]).engine_friction_n_m,
            20.0
        ));
    }

    #[test]
    fn a_warm_up_without_time_is_refused() {
        assert!(build::<ColdStart>("(cold_torque_n_m: 40.0)").is_err());
    }
}
