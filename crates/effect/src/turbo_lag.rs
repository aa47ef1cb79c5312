//! An engine that has to wait for its turbocharger.
//!
//! F v ≤ P_na + x,   dx/dt = (max(0, F_wanted v − P_na) − x) / τ,   x(0) = 0
//!
//! Source: first-order lag of charge pressure behind demand; Guzzella and Onder, *Introduction to Modeling and Control of Internal
//! Combustion Engine Systems* (2010), section 2.6, linearised.
//! P_na is the power at the wheels that needs no boost, x the power that boost gives. Limits what a driver asks for:
//! what was recorded, as force or as motion, came about.
//! Fingerprint: for a second after a step of load the vehicle falls behind what the driver asks, then catches up.

use headland_plugin::{Action, Bound, Card, Effect, Plugin, Situation, State, parameter};
use serde::Deserialize;

/// Boost that follows demand with a lag.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TurboLag {
    time_constant_s: f64,
    unboosted_power_w: f64,
}

impl Plugin for TurboLag {
    const CARD: Card = Card {
        name: "turbo_lag",
        about: "an engine that has to wait for its turbocharger",
        equation: "F v ≤ P_na + x, dx/dt = (max(0, F_wanted v − P_na) − x)/τ, x(0) = 0",
        source: "first-order lag of charge pressure; Guzzella and Onder, Introduction to Modeling and Control of Internal \
                 Combustion Engine Systems (2010), section 2.6, linearised",
        validity: "limits what a driver asks for, not a recorded force or motion; leaves out the fuel that smoke limits save",
        parameters: &[
            parameter("time_constant_s", "s", "of the charge pressure, τ")
                .must_be(Bound::Positive)
                .usually(0.2, 4.0),
            parameter("unboosted_power_w", "W", "at the wheels without boost, P_na")
                .must_be(Bound::Positive)
                .usually(1e4, 3e5),
        ],
    };
}

impl Effect for TurboLag {
    fn states(&self) -> Vec<State> {
        vec![State { name: "boost_power_w", initial: 0.0 }]
    }

    fn act(&self, _: &Situation, _: &[f64], _: &mut [f64]) -> Action {
        Action::default()
    }

    fn limits_n(&self, at: &Situation, states: &[f64]) -> (f64, f64) {
        let most_w = self.unboosted_power_w + states[0];
        if at.speed_m_s > 0.0 {
            (f64::NEG_INFINITY, most_w / at.speed_m_s)
        } else {
            (f64::NEG_INFINITY, f64::INFINITY)
        }
    }

    fn follow(&self, at: &Situation, states: &[f64], rates: &mut [f64]) {
        let wanted_w = (at.tractive_force_n * at.speed_m_s - self.unboosted_power_w).max(0.0);
        rates[0] = (wanted_w - states[0]) / self.time_constant_s;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{at_10_m_s, build, rates, same};

    const TURBO: &str = "(time_constant_s: 0.5, unboosted_power_w: 60000.0)";

    /// (60 + 20) kW at 10 m/s are 8 kN; wanted 10 kN need 40 kW of boost, so it grows with (40 − 20) / 0.5 kW/s.
    #[test]
    fn half_boosted_by_hand() {
        let at = Situation { tractive_force_n: 1e4, ..at_10_m_s() };
        let turbo = build::<TurboLag>(TURBO).unwrap();
        assert!(same(turbo.limits_n(&at, &[2e4]).1, 8000.0));
        assert!(same(rates::<TurboLag>(TURBO, &at, &[2e4])[0], 4e4));
    }

    #[test]
    fn at_rest_and_in_braking_it_limits_nothing_and_boost_decays() {
        let resting = Situation { speed_m_s: 0.0, ..at_10_m_s() };
        assert_eq!(build::<TurboLag>(TURBO).unwrap().limits_n(&resting, &[0.0]).1, f64::INFINITY);
        let braking = Situation { tractive_force_n: -5e3, ..at_10_m_s() };
        assert!(same(rates::<TurboLag>(TURBO, &braking, &[1e4])[0], -2e4));
    }

    #[test]
    fn a_time_constant_has_to_be_given() {
        assert!(build::<TurboLag>("(unboosted_power_w: 60000.0)").is_err());
    }
}
