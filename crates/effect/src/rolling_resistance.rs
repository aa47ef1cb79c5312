//! A level of rolling resistance that is other than the scenario says.
//!
//! F = Δc m g cos θ
//!
//! Source: Wong, *Theory of Ground Vehicles* (2008), section 1.3.
//! Negative where the scenario counts too much; the sum of all resistances is never negative.
//! Fingerprint: a constant force against the motion, proportional to the load, the same in both directions.

use headland_plugin::{Action, Card, Effect, Plugin, Situation, parameter};
use serde::Deserialize;

/// An error of the coefficient of rolling resistance.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RollingResistance {
    coefficient: f64,
}

impl Plugin for RollingResistance {
    const CARD: Card = Card {
        name: "rolling_resistance",
        about: "rolling resistance beside that of the ground model",
        equation: "F = Δc m g cos θ",
        source: "Wong, Theory of Ground Vehicles (2008), section 1.3",
        validity: "the same at every speed and place",
        parameters: &[parameter("coefficient", "1", "resistance per load, beside that of the ground, Δc")
            .usually(-0.1, 0.2)],
    };
}

/// Force between wheels and ground [N].
pub(crate) fn load_n(at: &Situation) -> f64 {
    at.mass_kg * at.gravity_m_s2 * at.place.cos_slope()
}

impl Effect for RollingResistance {
    fn act(&self, at: &Situation, _: &[f64], _: &mut [f64]) -> Action {
        Action { resistance_n: self.coefficient * load_n(at), ..Action::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{act, at_10_m_s, build, same};

    #[test]
    fn one_hundredth_of_20_kn_is_200_n_at_any_speed() {
        for speed_m_s in [0.0, 3.0, -3.0] {
            let at = Situation { speed_m_s, ..at_10_m_s() };
            assert!(same(act::<RollingResistance>("(coefficient: 0.01)", &at).resistance_n, 200.0));
        }
    }

    /// A slope of 3/5 presses with 4/5 of the weight.
    #[test]
    fn on_a_slope_the_load_is_less() {
        let mut at = at_10_m_s();
        at.place.sin_slope = 0.6;
        assert!(same(act::<RollingResistance>("(coefficient: 0.01)", &at).resistance_n, 160.0));
    }

    #[test]
    fn a_coefficient_has_to_be_given() {
        assert!(build::<RollingResistance>("()").is_err());
    }
}
