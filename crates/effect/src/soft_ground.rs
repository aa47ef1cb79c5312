//! Patches of ground along the path that resist otherwise than the rest.
//!
//! F = Δc(s) m g cos θ        Δc constant between its edges, 0 outside
//!
//! Source: Wong, *Theory of Ground Vehicles* (2008), section 1.3, with a coefficient that is a map of the path.
//! Leaves out the rut that the vehicle leaves behind, and the length of the vehicle.
//! Fingerprint: a force fixed to places, against the motion in both directions (a slope turns its sign), and felt by an
//! accelerometer.

use crate::rolling_resistance::load_n;
use crate::series::{check_steps, step};
use headland_plugin::{Action, Card, Effect, Plugin, Refusal, Situation, parameter};
use serde::Deserialize;
use std::path::Path;

/// Rolling resistance by position.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SoftGround {
    positions_m: Vec<f64>,
    coefficients: Vec<f64>,
}

impl Plugin for SoftGround {
    const CARD: Card = Card {
        name: "soft_ground",
        about: "patches along the path that resist otherwise than the rest",
        equation: "F = Δc(s) m g cos θ",
        source: "Wong, Theory of Ground Vehicles (2008), section 1.3, with a coefficient for each stretch of the path",
        validity: "patches longer than the vehicle; leaves out ruts",
        parameters: &[
            parameter("positions_m", "[m]", "edges of the patches, increasing, s").usually(-1e4, 1e6),
            parameter(
                "coefficients",
                "[1]",
                "resistance per load beside that of the ground, one less than edges, Δc",
            )
            .usually(-0.1, 0.3),
        ],
    };

    fn settle(&mut self, _: &Path) -> Result<(), Refusal> {
        check_steps(("positions_m", &self.positions_m), ("coefficients", &self.coefficients))
    }
}

impl Effect for SoftGround {
    fn act(&self, at: &Situation, _: &[f64], _: &mut [f64]) -> Action {
        let coefficient = step(&self.positions_m, &self.coefficients, at.position_m);
        Action { resistance_n: coefficient * load_n(at), ..Action::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{act, at_10_m_s, build, same};

    const PATCH: &str = "(positions_m: [100.0, 130.0, 150.0], coefficients: [0.05, -0.01])";

    #[test]
    fn each_patch_resists_on_its_own_and_nothing_does_outside() {
        for (position_m, expected) in [(99.0, 0.0), (120.0, 1000.0), (130.0, -200.0), (150.0, 0.0)] {
            let at = Situation { position_m, ..at_10_m_s() };
            assert!(same(act::<SoftGround>(PATCH, &at).resistance_n, expected), "{position_m}");
        }
    }

    #[test]
    fn as_many_coefficients_as_edges_are_refused() {
        let message = build::<SoftGround>("(positions_m: [0.0, 1.0], coefficients: [0.1, 0.1])").unwrap_err();
        assert!(message.contains("`coefficients`") && message.contains("one less than edges"), "{message}");
    }
}
