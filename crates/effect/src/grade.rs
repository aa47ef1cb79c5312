//! A slope along the path that the scenario does not know.
//!
//! F = −m g (sin(atan(q₀ + q(s))) − sin(atan q₀))        q₀ the known grade, q(s) straight between its points
//!
//! Source: Newton's second law on an incline; Mitschke and Wallentowitz, *Dynamik der Kraftfahrzeuge* (2014), chapter A.
//! Beyond its ends the last grade goes on. Leaves out the cosine of the added slope in the load on the ground.
//! Fingerprint: a force that is the same at the same place on every run, proportional to mass whatever the speed; it
//! turns its sign with the direction of travel, and an accelerometer does not feel it.

use crate::series::{check_line, linear};
use headland_plugin::{Action, Bound, Card, Effect, Plugin, Refusal, Situation, parameter};
use serde::Deserialize;
use std::path::Path;

/// Grade by position.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Grade {
    positions_m: Vec<f64>,
    grades: Vec<f64>,
}

impl Plugin for Grade {
    const CARD: Card = Card {
        name: "grade",
        about: "a slope that changes along the path, added to the terrain's",
        equation: "F = −m g (sin(atan(q₀ + q(s))) − sin(atan q₀))",
        source: "Newton's second law on an incline; Mitschke and Wallentowitz, Dynamik der Kraftfahrzeuge (2014), chapter A",
        validity: "everywhere; leaves out what the added slope does to the load on the ground",
        parameters: &[
            parameter("positions_m", "[m]", "points along the path, increasing, s").usually(-1e4, 1e6),
            parameter("grades", "[1]", "rise over horizontal distance at each point, q")
                .must_be(Bound::Within(-1.0, 1.0))
                .usually(-0.3, 0.3),
        ],
    };

    fn settle(&mut self, _: &Path) -> Result<(), Refusal> {
        check_line(("positions_m", &self.positions_m), ("grades", &self.grades))
    }
}

/// Force of a grade that is added to the known one [N].
pub(crate) fn force_n(at: &Situation, added: f64) -> f64 {
    // Grades are written as the path is: seen from the other end, uphill is downhill.
    let grade = at.place.grade() + if at.reversed { -added } else { added };
    at.mass_kg * at.gravity_m_s2 * (at.place.sin_slope - grade / (1.0 + grade * grade).sqrt())
}

impl Effect for Grade {
    fn act(&self, at: &Situation, _: &[f64], _: &mut [f64]) -> Action {
        let added = linear(&self.positions_m, &self.grades, at.position_m);
        Action { force_n: force_n(at, added), ..Action::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{act, at_10_m_s, build, same};

    const PROFILE: &str = "(positions_m: [100.0, 140.0], grades: [0.0, 1.5])";

    /// Half way the grade is 3/4, of the triangle 3-4-5: 20 kN · 3/5.
    #[test]
    fn it_is_straight_between_its_points() {
        assert!(same(act::<Grade>(PROFILE, &at_10_m_s()).force_n, -12e3));
    }

    /// A known 3/4 and −3/4 added are level: what the terrain takes is given back.
    #[test]
    fn it_adds_to_the_known_grade_and_not_to_its_sine() {
        let mut at = at_10_m_s();
        at.place.sin_slope = 0.6;
        let level = act::<Grade>("(positions_m: [0.0], grades: [-0.75])", &at);
        assert!(same(level.force_n, 12e3));
    }

    #[test]
    fn uneven_lists_are_refused() {
        let message = build::<Grade>("(positions_m: [0.0, 1.0], grades: [0.1])").unwrap_err();
        assert!(message.contains("`grades` is 1 values beside 2 of `positions_m`"), "{message}");
        assert!(build::<Grade>("(positions_m: [], grades: [])").is_err());
    }
}
