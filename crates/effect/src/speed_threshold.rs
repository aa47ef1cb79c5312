//! A drag that sets in above a speed.
//!
//! F = F₀ · min(1, max(0, (|v| − v₀) / w))
//!
//! Source: piecewise-linear (hinge) function; empirical: a retarder, a governor or a flap that engages at a speed.
//! Leaves out hysteresis.
//! Fingerprint: nothing below a speed, and a step or ramp above it, the same in both directions.

use headland_plugin::{Action, Bound, Card, Effect, Plugin, Situation, parameter};
use serde::Deserialize;

/// A ramp from a threshold to full force.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpeedThreshold {
    force_n: f64,
    threshold_m_s: f64,
    width_m_s: f64,
}

impl Plugin for SpeedThreshold {
    const CARD: Card = Card {
        name: "speed_threshold",
        about: "a drag that sets in above a speed",
        equation: "F = F₀ min(1, max(0, (|v| − v₀)/w))",
        source: "hinge function; empirical",
        validity: "engages and releases at the same speed",
        parameters: &[
            parameter("force_n", "N", "in full, F₀").must_be(Bound::NotNegative).usually(0.0, 20_000.0),
            parameter("threshold_m_s", "m/s", "speed at which it sets in, v₀")
                .must_be(Bound::NotNegative)
                .usually(0.5, 30.0),
            parameter("width_m_s", "m/s", "further speed over which it grows to its full force, w")
                .must_be(Bound::Positive)
                .usually(0.05, 20.0),
        ],
    };
}

impl Effect for SpeedThreshold {
    fn act(&self, at: &Situation, _: &[f64], _: &mut [f64]) -> Action {
        let share = ((at.speed_m_s.abs() - self.threshold_m_s) / self.width_m_s).clamp(0.0, 1.0);
        Action { resistance_n: self.force_n * share, ..Action::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{act, at_10_m_s, build, same};

    #[test]
    fn it_is_nothing_below_half_in_the_middle_and_full_above() {
        for (speed_m_s, expected) in [(8.0, 0.0), (9.0, 400.0), (-9.0, 400.0), (10.0, 800.0), (30.0, 800.0)] {
            let at = Situation { speed_m_s, ..at_10_m_s() };
            let action = act::<SpeedThreshold>("(force_n: 800.0, threshold_m_s: 8.0, width_m_s: 2.0)", &at);
            assert!(same(action.resistance_n, expected), "{speed_m_s}");
        }
    }

    #[test]
    fn a_threshold_has_to_be_given() {
        assert!(build::<SpeedThreshold>("(force_n: 800.0, width_m_s: 2.0)").is_err());
    }
}
