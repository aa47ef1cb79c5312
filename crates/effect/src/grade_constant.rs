//! A slope of the whole path that the scenario does not know.
//!
//! F = −m g (sin(atan(q₀ + q)) − sin(atan q₀))        q₀ the known grade
//!
//! Source: Newton's second law on an incline; Mitschke and Wallentowitz, *Dynamik der Kraftfahrzeuge* (2014), chapter A.
//! Positive uphill in the direction of the path; a run that is driven the other way goes downhill. Leaves out the cosine of the added slope in the load on the ground.
//! Fingerprint: a constant force, proportional to mass; runs in the other direction show it with the other sign.

use crate::grade::force_n;
use headland_plugin::{Action, Bound, Card, Effect, Plugin, Situation, parameter};
use serde::Deserialize;

/// One grade everywhere.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GradeConstant {
    grade: f64,
}

impl Plugin for GradeConstant {
    const CARD: Card = Card {
        name: "grade_constant",
        about: "a slope that is the same all along the path, added to the terrain's",
        equation: "F = −m g (sin(atan(q₀ + q)) − sin(atan q₀))",
        source: "Newton's second law on an incline; Mitschke and Wallentowitz, Dynamik der Kraftfahrzeuge (2014), chapter A",
        validity: "everywhere; leaves out what the added slope does to the load on the ground",
        parameters: &[parameter("grade", "1", "rise over horizontal distance, uphill positive, q")
            .must_be(Bound::Within(-1.0, 1.0))
            .usually(-0.3, 0.3)],
    };
}

impl Effect for GradeConstant {
    fn act(&self, at: &Situation, _: &[f64], _: &mut [f64]) -> Action {
        Action { force_n: force_n(at, self.grade), ..Action::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{act, at_10_m_s, build, same};

    #[test]
    fn three_quarters_uphill_hold_back_with_three_fifths_of_the_weight() {
        assert!(same(act::<GradeConstant>("(grade: 0.75)", &at_10_m_s()).force_n, -12e3));
        assert!(same(act::<GradeConstant>("(grade: -0.75)", &at_10_m_s()).force_n, 12e3));
    }

    #[test]
    fn no_grade_is_no_force_on_any_terrain() {
        let mut at = at_10_m_s();
        at.place.sin_slope = 0.1;
        assert!(act::<GradeConstant>("(grade: 0.0)", &at).force_n.abs() < 1e-9);
    }

    #[test]
    fn a_run_the_other_way_goes_downhill() {
        let at = Situation { reversed: true, ..at_10_m_s() };
        assert!(same(act::<GradeConstant>("(grade: 0.75)", &at).force_n, 12e3));
    }

    #[test]
    fn a_grade_has_to_be_given() {
        assert!(build::<GradeConstant>("()").is_err());
    }
}
