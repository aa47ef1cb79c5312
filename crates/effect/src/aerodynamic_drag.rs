//! A drag area that is other than the scenario says.
//!
//! F = −½ ρ ΔA |v − w| (v − w)ₓ        ΔA the error of C_d A
//!
//! Source: drag equation; Hucho, *Aerodynamics of Road Vehicles* (1998), chapter 4.
//! Negative where the scenario counts too much. The same from every side.
//! Fingerprint: a mismatch with the square of the speed through the air.

use headland_plugin::{Action, Card, Effect, Plugin, Situation, parameter};
use serde::Deserialize;

/// An error of the drag area.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AerodynamicDrag {
    extra_area_m2: f64,
}

impl Plugin for AerodynamicDrag {
    const CARD: Card = Card {
        name: "aerodynamic_drag",
        about: "a drag area that is other than stated",
        equation: "F = −½ ρ ΔA |v − w| (v − w)ₓ",
        source: "drag equation; Hucho, Aerodynamics of Road Vehicles (1998), chapter 4",
        validity: "the same drag area from every side",
        parameters: &[parameter(
            "extra_area_m2",
            "m²",
            "drag coefficient times frontal area, beside that stated, ΔA",
        )
        .usually(-3.0, 10.0)],
    };
}

impl Effect for AerodynamicDrag {
    fn act(&self, at: &Situation, _: &[f64], _: &mut [f64]) -> Action {
        let area = self.extra_area_m2;
        Action {
            force_n: at.air.drag_n(area, at.speed_m_s, at.place.heading_rad),
            drag_area_m2: area,
            ..Action::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{act, at_10_m_s, build, same};

    /// ½ · 1.2 · 2 · 10² = 120 N, and nothing at rest in still air.
    #[test]
    fn two_square_metres_drag_with_120_n_at_10_m_s() {
        let (moving, resting) = (at_10_m_s(), Situation { speed_m_s: 0.0, ..at_10_m_s() });
        assert!(same(act::<AerodynamicDrag>("(extra_area_m2: 2.0)", &moving).force_n, -120.0));
        assert_eq!(act::<AerodynamicDrag>("(extra_area_m2: 2.0)", &resting).force_n, 0.0);
    }

    #[test]
    fn other_effects_learn_of_the_area() {
        assert_eq!(act::<AerodynamicDrag>("(extra_area_m2: -0.3)", &at_10_m_s()).drag_area_m2, -0.3);
    }

    #[test]
    fn a_coefficient_is_refused_in_place_of_an_area() {
        assert!(build::<AerodynamicDrag>("(coefficient: 0.3)").is_err());
    }
}
