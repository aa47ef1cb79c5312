//! A mass that is other than the scenario says.
//!
//! m = m₀ + Δm        in inertia, in the load on the ground and on slopes
//!
//! Source: Newton's second law.
//! Constant over a run. The constant part of a road load goes with the mass as well.
//! Fingerprint: a mismatch in proportion to acceleration plus g times slope and rolling resistance. While coasting on level
//! ground it cannot be told: force and inertia grow together.

use headland_plugin::{Action, Card, Effect, Plugin, Situation, parameter};
use serde::Deserialize;

/// A constant error of the mass.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mass {
    extra_mass_kg: f64,
}

impl Plugin for Mass {
    const CARD: Card = Card {
        name: "mass",
        about: "a mass that is other than stated, all along the run",
        equation: "m = m₀ + Δm",
        source: "Newton's second law",
        validity: "a mass that rides with the vehicle and rests on its wheels",
        parameters: &[
            parameter("extra_mass_kg", "kg", "beside the mass stated, Δm").usually(-5000.0, 30_000.0)
        ],
    };
}

impl Effect for Mass {
    fn act(&self, _: &Situation, _: &[f64], _: &mut [f64]) -> Action {
        Action { mass_kg: self.extra_mass_kg, ..Action::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{act, at_10_m_s, build};

    #[test]
    fn it_adds_to_the_mass_and_to_nothing_else() {
        let action = act::<Mass>("(extra_mass_kg: 160.0)", &at_10_m_s());
        assert_eq!(action, Action { mass_kg: 160.0, ..Action::default() });
    }

    #[test]
    fn a_mass_has_to_be_given() {
        assert!(build::<Mass>("()").is_err());
    }
}
