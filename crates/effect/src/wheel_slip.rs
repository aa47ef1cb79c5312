//! Wheels that turn faster than the ground when they pull.
//!
//! s = k F / (m g cos θ),   v_w = v / (1 − s)        F the force at the wheels, negative when they brake
//!
//! Source: initial slope of the pull-slip curve; Wong, *Theory of Ground Vehicles* (2008), section 1.4, slip by ASABE S296.
//! Holds below about 15 % of slip. Leaves out the motion resistance that grows with slip.
//! Fingerprint: wheel speed over ground speed rises with the force at the wheels; force times the difference of speeds is missing
//! from the power balance, and nothing from the balance of forces.

use crate::rolling_resistance::load_n;
use headland_plugin::{Action, Bound, Card, Effect, Plugin, Situation, parameter};
use serde::Deserialize;

/// Slip in proportion to pull.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WheelSlip {
    coefficient: f64,
}

impl Plugin for WheelSlip {
    const CARD: Card = Card {
        name: "wheel_slip",
        about: "wheels that turn faster than the ground when they pull",
        equation: "s = k F / (m g cos θ), v_w = v / (1 − s)",
        source: "initial slope of the pull-slip curve; Wong, Theory of Ground Vehicles (2008), section 1.4; slip by ASABE S296",
        validity: "below about 15 % of slip; all wheels driven; leaves out resistance that grows with slip",
        parameters: &[parameter("coefficient", "1", "slip for a pull as great as the weight, k")
            .must_be(Bound::NotNegative)
            .usually(0.02, 1.0)],
    };
}

impl Effect for WheelSlip {
    fn act(&self, at: &Situation, _: &[f64], _: &mut [f64]) -> Action {
        Action { slip_per_n: self.coefficient / load_n(at), ..Action::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{act, at_10_m_s, build, same};

    /// 4 kN of 20 kN at k = 0.5: a slip of a tenth.
    #[test]
    fn a_fifth_of_the_weight_slips_by_a_tenth() {
        assert!(same(act::<WheelSlip>("(coefficient: 0.5)", &at_10_m_s()).slip_per_n * 4000.0, 0.1));
    }

    #[test]
    fn a_coefficient_has_to_be_given() {
        assert!(build::<WheelSlip>("()").is_err());
    }
}
