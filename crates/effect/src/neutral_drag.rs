//! Drag of a driveline that turns with the wheels in neutral.
//!
//! F = F₀ + F₁ |v|        only while coasting
//!
//! Source: Moskalik, *Using Transmission Data to Isolate Individual Losses in Coastdown Road Load Coefficients*, SAE 2020-01-1064:
//! output drag in neutral follows a polynomial of speed that coast-down coefficients contain.
//! Leaves out the temperature of the oil (see `driveline_temperature`).
//! Fingerprint: a drag that is there in neutral and gone as soon as the drive is engaged.

use headland_plugin::{Action, Bound, Card, Effect, Plugin, Situation, parameter};
use serde::Deserialize;

/// Coulomb and viscous drag in neutral.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NeutralDrag {
    force_n: f64,
    #[serde(default)]
    viscous_n_s_m: f64,
}

impl Plugin for NeutralDrag {
    const CARD: Card = Card {
        name: "neutral_drag",
        about: "drag of a driveline that turns with the wheels in neutral",
        equation: "F = F₀ + F₁ |v| while coasting",
        source: "Moskalik, SAE 2020-01-1064: output drag of transmissions in neutral",
        validity: "oil of one temperature",
        parameters: &[
            parameter("force_n", "N", "constant part at the wheels, F₀")
                .must_be(Bound::NotNegative)
                .usually(0.0, 2000.0),
            parameter("viscous_n_s_m", "N s/m", "part in proportion to speed, F₁")
                .must_be(Bound::NotNegative)
                .usually(0.0, 200.0)
                .or(0.0),
        ],
    };
}

impl Effect for NeutralDrag {
    fn act(&self, at: &Situation, _: &[f64], _: &mut [f64]) -> Action {
        let drag_n = self.force_n + self.viscous_n_s_m * at.speed_m_s.abs();
        Action { resistance_n: if at.coasting { drag_n } else { 0.0 }, ..Action::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{act, at_10_m_s, build, same};

    /// 300 + 40 · 10 = 700 N.
    #[test]
    fn it_drags_in_neutral_and_not_in_gear() {
        let coasting = Situation { coasting: true, ..at_10_m_s() };
        assert!(same(
            act::<NeutralDrag>("(force_n: 300.0, viscous_n_s_m: 40.0)", &coasting).resistance_n,
            700.0
        ));
        assert_eq!(act::<NeutralDrag>("(force_n: 300.0)", &at_10_m_s()).resistance_n, 0.0);
    }

    #[test]
    fn a_torque_is_refused_in_place_of_a_force() {
        assert!(build::<NeutralDrag>("(torque_n_m: 300.0)").is_err());
    }
}
