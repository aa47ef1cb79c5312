//! Drag of tyres that turn the vehicle.
//!
//! F = (m v² κ)² / C        C the cornering stiffness of all tyres together, κ the curvature of the path
//!
//! Source: Mitschke and Wallentowitz, *Dynamik der Kraftfahrzeuge* (2014), resistance of cornering: the side force F_y at the
//! slip angle α = F_y / C has the part F_y α against the motion.
//! Holds for small slip angles. Leaves out scrub of locked axles at walking pace.
//! Fingerprint: a drag in turns only, the same to the left and to the right, with the fourth power of speed.

use headland_plugin::{Action, Bound, Card, Effect, Plugin, Situation, parameter};
use serde::Deserialize;

/// Side force at a slip angle.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CorneringDrag {
    cornering_stiffness_n_per_rad: f64,
}

impl Plugin for CorneringDrag {
    const CARD: Card = Card {
        name: "cornering_drag",
        about: "drag of tyres that turn the vehicle",
        equation: "F = (m v² κ)² / C",
        source: "Mitschke and Wallentowitz, Dynamik der Kraftfahrzeuge (2014), resistance of cornering",
        validity: "small slip angles; leaves out scrub at walking pace",
        parameters: &[parameter(
            "cornering_stiffness_n_per_rad",
            "N/rad",
            "side force per slip angle, all tyres together, C",
        )
        .must_be(Bound::Positive)
        .usually(2e4, 3e6)],
    };
}

impl Effect for CorneringDrag {
    fn act(&self, at: &Situation, _: &[f64], _: &mut [f64]) -> Action {
        let side_n = at.mass_kg * at.speed_m_s * at.speed_m_s * at.place.curvature_per_m;
        Action { resistance_n: side_n * side_n / self.cornering_stiffness_n_per_rad, ..Action::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{act, at_10_m_s, build, same};

    const STIFFNESS: &str = "(cornering_stiffness_n_per_rad: 160000.0)";

    /// 2000 kg · 100 m²/s² / 50 m = 4 kN to the side, 16e6 / 160e3 = 100 N against the motion.
    #[test]
    fn a_turn_of_50_m_by_hand_either_way() {
        let mut at = at_10_m_s();
        for curvature in [0.02, -0.02] {
            at.place.curvature_per_m = curvature;
            assert!(same(act::<CorneringDrag>(STIFFNESS, &at).resistance_n, 100.0));
        }
    }

    #[test]
    fn straight_ahead_there_is_none() {
        assert_eq!(act::<CorneringDrag>(STIFFNESS, &at_10_m_s()).resistance_n, 0.0);
    }

    #[test]
    fn a_stiffness_has_to_be_given() {
        assert!(build::<CorneringDrag>("()").is_err());
    }
}
