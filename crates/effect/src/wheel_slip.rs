//! Wheels that turn faster than the ground when they pull.
//!
//! s = (k + k₂ |μ|) μ,   μ = F / (m g cos θ),   v_w = v / (1 − s)        F the force at the wheels, negative when they brake
//!
//! Source: the pull-slip curve by its initial slope and how it bends; Wong, *Theory of Ground Vehicles* (2008), section 1.4, slip
//! by ASABE S296. A curve that comes near a greatest pull μ₀ as 1 − exp(−s / (k μ₀)) has k₂ = k / (2 μ₀) to second order.
//! Holds below about 15 % of slip, with k₂ to twice that. Leaves out the motion resistance that grows with slip.
//! Fingerprint: wheel speed over ground speed rises with the force at the wheels; force times the difference of speeds is missing
//! from the power balance, and nothing from the balance of forces.

use crate::rolling_resistance::load_n;
use headland_plugin::{Action, Bound, Card, Effect, Plugin, Situation, parameter};
use serde::Deserialize;

/// Slip that grows with pull.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WheelSlip {
    #[serde(default)]
    coefficient: f64,
    #[serde(default)]
    quadratic: f64,
}

impl Plugin for WheelSlip {
    const CARD: Card = Card {
        name: "wheel_slip",
        about: "wheels that turn faster than the ground when they pull",
        equation: "s = (k + k₂ |μ|) μ, μ = F / (m g cos θ), v_w = v / (1 − s)",
        source: "pull-slip curve to second order; Wong, Theory of Ground Vehicles (2008), section 1.4; slip by ASABE S296",
        validity: "below about 15 % of slip, with k₂ to twice that; all wheels driven; leaves out resistance that grows with slip",
        parameters: &[
            parameter("coefficient", "1", "slip for a pull as great as the load, by the initial slope, k")
                .must_be(Bound::NotNegative)
                .usually(0.02, 1.0)
                .or(0.0),
            parameter("quadratic", "1", "what is added to k where the pull is as great as the load, k₂")
                .must_be(Bound::NotNegative)
                .usually(0.0, 3.0)
                .or(0.0),
        ],
    };
}

impl Effect for WheelSlip {
    fn act(&self, at: &Situation, _: &[f64], _: &mut [f64]) -> Action {
        let load_n = load_n(at);
        Action {
            slip_per_n: self.coefficient / load_n,
            slip_per_n2: self.quadratic / (load_n * load_n),
            ..Action::default()
        }
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

    /// 4 kN of 20 kN at k = 0.5 and k₂ = 1: (0.5 + 0.2) · 0.2, and as much backwards where the wheels brake.
    #[test]
    fn slip_grows_faster_than_the_pull() {
        let action = act::<WheelSlip>("(coefficient: 0.5, quadratic: 1.0)", &at_10_m_s());
        for force_n in [4000.0, -4000.0] {
            assert!(same(action.slip_per_n_at(force_n) * force_n, 0.14 * force_n.signum()));
        }
    }

    /// 1 − exp(−s / (k μ₀)) of a greatest pull μ₀, to second order: what is left shrinks with the third power.
    #[test]
    fn a_curve_that_ends_at_a_greatest_pull_is_met_to_second_order() {
        let (slope, greatest) = (0.5, 0.8);
        let law = format!("(coefficient: {slope}, quadratic: {})", slope / (2.0 * greatest));
        let action = act::<WheelSlip>(&law, &at_10_m_s());
        let error = |pull: f64| {
            let exact = -slope * greatest * (1.0 - pull / greatest).ln();
            exact - action.slip_per_n_at(20e3 * pull) * 20e3 * pull
        };
        let order = (error(0.2) / error(0.1)).log2();
        assert!((2.9..3.4).contains(&order), "{order}");
    }

    #[test]
    fn what_it_does_not_know_is_refused() {
        assert!(build::<WheelSlip>("(coefficient: 0.4, square: 0.1)").is_err());
    }
}
