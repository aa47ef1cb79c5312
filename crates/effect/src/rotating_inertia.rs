//! Inertia of rotating parts that the scenario leaves out.
//!
//! m_rot = Σ J i² / r²        added to inertia, not to weight
//!
//! Source: Mitschke and Wallentowitz, *Dynamik der Kraftfahrzeuge* (2014), chapter A.
//! Holds while the wheels roll with the ground. Negative where the scenario counts too much.
//! Fingerprint: a mismatch in proportion to acceleration, with the same sign whether it speeds up or slows down.

use headland_plugin::{Action, Card, Effect, Plugin, Situation, parameter};
use serde::Deserialize;

/// A mass that counts for inertia alone.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RotatingInertia {
    rotating_mass_kg: f64,
}

impl Plugin for RotatingInertia {
    const CARD: Card = Card {
        name: "rotating_inertia",
        about: "inertia of wheels, shafts and rotors that was left out",
        equation: "m_rot = Σ J i² / r²",
        source: "Mitschke and Wallentowitz, Dynamik der Kraftfahrzeuge (2014), chapter A",
        validity: "wheels that roll with the ground",
        parameters: &[parameter("rotating_mass_kg", "kg", "added to inertia, not to weight, m_rot")
            .usually(-1000.0, 5000.0)],
    };
}

impl Effect for RotatingInertia {
    fn act(&self, _: &Situation, _: &[f64], _: &mut [f64]) -> Action {
        Action { rotating_mass_kg: self.rotating_mass_kg, ..Action::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{act, at_10_m_s, build};

    #[test]
    fn it_adds_to_inertia_and_to_nothing_else() {
        let action = act::<RotatingInertia>("(rotating_mass_kg: 150.0)", &at_10_m_s());
        assert_eq!(action, Action { rotating_mass_kg: 150.0, ..Action::default() });
    }

    #[test]
    fn an_inertia_is_refused_in_place_of_a_mass() {
        assert!(build::<RotatingInertia>("(inertia_kg_m2: 150.0)").is_err());
    }
}
