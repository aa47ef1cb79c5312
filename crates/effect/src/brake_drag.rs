//! Brakes that drag though nobody brakes.
//!
//! F = F₀        against the motion, at all times
//!
//! Source: Coulomb friction of pads or discs that stay in contact; Breuer and Bill, *Bremsenhandbuch* (2017), residual torque.
//! Leaves out knock-back, and the decline as the brake warms up.
//! Fingerprint: a constant force against the motion that does not grow with the load; in a single run it cannot be told from
//! rolling resistance.

use headland_plugin::{Action, Bound, Card, Effect, Plugin, Situation, parameter};
use serde::Deserialize;

/// Residual torque of the brakes as a force at the wheels.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BrakeDrag {
    force_n: f64,
}

impl Plugin for BrakeDrag {
    const CARD: Card = Card {
        name: "brake_drag",
        about: "brakes that drag though nobody brakes",
        equation: "F = F₀",
        source: "Coulomb friction; Breuer and Bill, Bremsenhandbuch (2017), residual torque",
        validity: "constant contact; leaves out knock-back and warming",
        parameters: &[parameter("force_n", "N", "at the wheels, F₀")
            .must_be(Bound::NotNegative)
            .usually(0.0, 2000.0)],
    };
}

impl Effect for BrakeDrag {
    fn act(&self, _: &Situation, _: &[f64], _: &mut [f64]) -> Action {
        Action { resistance_n: self.force_n, ..Action::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{act, at_10_m_s, build};

    #[test]
    fn it_neither_knows_speed_nor_load() {
        for (speed_m_s, mass_kg) in [(0.0, 2000.0), (10.0, 500.0), (-4.0, 1e4)] {
            let at = Situation { speed_m_s, mass_kg, ..at_10_m_s() };
            let action = act::<BrakeDrag>("(force_n: 150.0)", &at);
            assert_eq!(action, Action { resistance_n: 150.0, ..Action::default() });
        }
    }

    #[test]
    fn a_force_has_to_be_given() {
        assert!(build::<BrakeDrag>("()").is_err());
    }
}
