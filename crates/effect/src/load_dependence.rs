//! Rolling resistance that is not in proportion to the load.
//!
//! F = c W ((W / W₀)^(β − 1) − 1)        W = m g cos θ, W₀ = m₀ g
//!
//! Source: load exponent of the truck simulation VECTO (β = 0.9) and of SAE J2452 for roads; Bekker, *Introduction to
//! Terrain-Vehicle Systems* (1969) has β above 1 on soft ground.
//! At the reference mass it does nothing.
//! Fingerprint: the coefficient of rolling resistance steps with ballast and payload.

use crate::rolling_resistance::load_n;
use headland_plugin::{Action, Bound, Card, Effect, Plugin, Situation, parameter};
use serde::Deserialize;

/// A power law of the load.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LoadDependence {
    coefficient: f64,
    exponent: f64,
    reference_mass_kg: f64,
}

impl Plugin for LoadDependence {
    const CARD: Card = Card {
        name: "load_dependence",
        about: "rolling resistance that is not in proportion to the load",
        equation: "F = c W ((W / W₀)^(β − 1) − 1)",
        source: "load exponent of VECTO and of SAE J2452; Bekker, Introduction to Terrain-Vehicle Systems (1969)",
        validity: "loads within a factor of two of the reference",
        parameters: &[
            parameter("coefficient", "1", "resistance per load at the reference mass, c")
                .must_be(Bound::NotNegative)
                .usually(0.005, 0.3),
            parameter("exponent", "1", "of the load, 1 for a resistance in proportion to it, β")
                .must_be(Bound::Positive)
                .usually(0.7, 1.6),
            parameter("reference_mass_kg", "kg", "mass at which the ground model holds, m₀")
                .must_be(Bound::Positive)
                .usually(100.0, 60_000.0),
        ],
    };
}

impl Effect for LoadDependence {
    fn act(&self, at: &Situation, _: &[f64], _: &mut [f64]) -> Action {
        let load = load_n(at);
        let share = load / (self.reference_mass_kg * at.gravity_m_s2);
        let change = share.powf(self.exponent - 1.0) - 1.0;
        Action { resistance_n: self.coefficient * load * change, ..Action::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{act, at_10_m_s, build, same};

    /// Four times the reference load, β = 1.5: 0.05 · 20 kN · (4^0.5 − 1) = 1 kN.
    #[test]
    fn four_times_the_load_on_soft_ground_by_hand() {
        let law = "(coefficient: 0.05, exponent: 1.5, reference_mass_kg: 500.0)";
        assert!(same(act::<LoadDependence>(law, &at_10_m_s()).resistance_n, 1000.0));
    }

    #[test]
    fn at_the_reference_mass_it_does_nothing() {
        let law = "(coefficient: 0.05, exponent: 0.9, reference_mass_kg: 2000.0)";
        assert_eq!(act::<LoadDependence>(law, &at_10_m_s()).resistance_n, 0.0);
    }

    #[test]
    fn a_law_without_reference_is_refused() {
        assert!(build::<LoadDependence>("(coefficient: 0.05, exponent: 0.9)").is_err());
    }
}
