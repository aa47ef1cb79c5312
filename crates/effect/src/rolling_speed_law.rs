//! Rolling resistance that changes with speed otherwise than the scenario says.
//!
//! F = (c₁ (v/v₀ − 1) + c₂ ((v/v₀)² − 1)) m g cos θ
//!
//! Source: SAE J2452 writes the resistance of a tyre as a + b v + c v²; here as a deviation from the value at v₀.
//! At v₀ it does nothing, so that the level belongs to `rolling_resistance` alone. Leaves out standing waves.
//! Fingerprint: a mismatch against the motion that changes its sign at v₀ and is the same in both directions; the linear
//! part looks like viscous drag, the quadratic like drag of the air.

use crate::rolling_resistance::load_n;
use headland_plugin::{Action, Bound, Card, Effect, Plugin, Situation, parameter};
use serde::Deserialize;

/// An error of the speed dependence.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RollingSpeedLaw {
    #[serde(default)]
    linear: f64,
    #[serde(default)]
    quadratic: f64,
    reference_speed_m_s: f64,
}

impl Plugin for RollingSpeedLaw {
    const CARD: Card = Card {
        name: "rolling_speed_law",
        about: "rolling resistance that depends on speed otherwise than stated",
        equation: "F = (c₁ (v/v₀ − 1) + c₂ ((v/v₀)² − 1)) m g cos θ",
        source: "SAE J2452, as a deviation from the resistance at a reference speed",
        validity: "below the speed of standing waves in the tyre",
        parameters: &[
            parameter("linear", "1", "change of the coefficient from rest to v₀, linear part, c₁")
                .usually(-0.05, 0.05)
                .or(0.0),
            parameter("quadratic", "1", "change of the coefficient from rest to v₀, quadratic part, c₂")
                .usually(-0.05, 0.05)
                .or(0.0),
            parameter("reference_speed_m_s", "m/s", "speed at which nothing changes, v₀")
                .must_be(Bound::Positive)
                .usually(1.0, 30.0),
        ],
    };
}

impl Effect for RollingSpeedLaw {
    fn act(&self, at: &Situation, _: &[f64], _: &mut [f64]) -> Action {
        let share = at.speed_m_s.abs() / self.reference_speed_m_s;
        let coefficient = self.linear * (share - 1.0) + self.quadratic * (share * share - 1.0);
        Action { resistance_n: coefficient * load_n(at), ..Action::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{act, at_10_m_s, build, same};

    const LAW: &str = "(linear: 0.01, quadratic: 0.002, reference_speed_m_s: 5.0)";

    /// At twice v₀: (0.01 · 1 + 0.002 · 3) · 20 kN = 320 N; at rest −(0.01 + 0.002) · 20 kN.
    #[test]
    fn twice_the_reference_speed_and_rest_by_hand() {
        assert!(same(act::<RollingSpeedLaw>(LAW, &at_10_m_s()).resistance_n, 320.0));
        let resting = Situation { speed_m_s: 0.0, ..at_10_m_s() };
        assert!(same(act::<RollingSpeedLaw>(LAW, &resting).resistance_n, -240.0));
    }

    #[test]
    fn at_the_reference_speed_it_does_nothing() {
        let at = Situation { speed_m_s: 5.0, ..at_10_m_s() };
        assert_eq!(act::<RollingSpeedLaw>(LAW, &at).resistance_n, 0.0);
    }

    #[test]
    fn a_law_without_reference_speed_is_refused() {
        assert!(build::<RollingSpeedLaw>("(linear: 0.01)").is_err());
    }
}
