//! What a slope across the path costs: tyres hold the vehicle on it by slip angles, and its wheels carry unlike loads.
//!
//! F = ((S − Y)² − Y²) / C = S (S − 2 Y) / C        S = m g sin φ, Y = m v² κ, C the cornering stiffness of all tyres together
//! s = k F_x tan² φ / N                             F_x the force at the wheels, N = m g √(1 − sin² θ − sin² φ)
//!
//! The right side is lower where φ counts positive, and κ turns to the right: tyres hold Y − S to the right. Of their drag
//! (Y − S)² / C the turn alone has Y² / C, which is `cornering_drag`; both effects with one C make the whole.
//! Where the wheels of an axle share its torque evenly, those with the load N (1 ± Δ) / 2, Δ = 2 h tan φ / b for a centre of gravity
//! at the height h over a track b, slip in the mean by k′ F_x / (N (1 − Δ²)): by k = k′ (2 h / b)² for each F_x tan² φ / N more.
//!
//! Source: Mitschke and Wallentowitz, *Dynamik der Kraftfahrzeuge* (2014), resistance of cornering, here for the side force of a slope;
//! moments about the footprints, and the initial slope of the pull-slip curve, Wong, *Theory of Ground Vehicles* (2008), section 1.4.
//! Holds for small slip angles and a load that moves by less than half. Leaves out that the ground carries cos φ of the weight
//! and resists so much less; and a chassis leans further than its ground, by a twentieth on tyres alone. So the stiffness that a
//! recording of the chassis shows is a tenth or two above that of the tyres.
//! Fingerprint: a drag with the square of the side slope, the same at all speeds and to both sides, and slip under pull with it.

use headland_plugin::{Action, Bound, Card, Effect, Plugin, Situation, parameter};
use serde::Deserialize;

/// Side force and unlike loads on a side slope.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SideSlope {
    cornering_stiffness_n_per_rad: f64,
    #[serde(default)]
    slip_coefficient: f64,
}

impl Plugin for SideSlope {
    const CARD: Card = Card {
        name: "side_slope",
        about: "slip angles and unlike loads of tyres that hold the vehicle on a side slope",
        equation: "F = S (S − 2 m v² κ) / C, S = m g sin φ; s = k F_x tan² φ / N",
        source: "Mitschke and Wallentowitz, Dynamik der Kraftfahrzeuge (2014), resistance of cornering; pull-slip curve: Wong, \
                 Theory of Ground Vehicles (2008), section 1.4",
        validity: "small slip angles, loads that move by less than half; leaves out the load that the ground loses, and what the \
                   chassis leans beyond its ground",
        parameters: &[
            parameter(
                "cornering_stiffness_n_per_rad",
                "N/rad",
                "side force per slip angle, all tyres together, C",
            )
            .must_be(Bound::Positive)
            .usually(2e4, 3e6),
            parameter(
                "slip_coefficient",
                "1",
                "slip for a pull as great as the load, on a side slope of 45°, beside that of the level, k",
            )
            .must_be(Bound::NotNegative)
            .usually(0.0, 2.0)
            .or(0.0),
        ],
    };
}

impl Effect for SideSlope {
    fn act(&self, at: &Situation, _: &[f64], _: &mut [f64]) -> Action {
        let weight_n = at.mass_kg * at.gravity_m_s2;
        let (c, k) = (self.cornering_stiffness_n_per_rad, self.slip_coefficient);
        let (along, across) = (at.place.sin_slope, at.place.sin_roll);
        let (s, y) = (weight_n * across, at.mass_kg * at.speed_m_s * at.speed_m_s * at.place.curvature_per_m);
        // cos² between the normal of the ground and the plumb line.
        let upright = 1.0 - along * along - across * across;
        Action {
            resistance_n: s * (s - 2.0 * y) / c,
            slip_per_n: k * across * across / (upright * upright.sqrt() * weight_n),
            ..Action::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::CorneringDrag;
    use crate::testing::{act, at_10_m_s, build, same};

    const STIFFNESS: &str = "(cornering_stiffness_n_per_rad: 160000.0)";

    /// 20 kN · 0.2 = 4 kN down the slope, 16e6 / 160e3 = 100 N against the motion, to either side.
    #[test]
    fn a_side_slope_of_a_fifth_by_hand_either_way() {
        let mut at = at_10_m_s();
        for across in [0.2, -0.2] {
            at.place.sin_roll = across;
            assert!(same(act::<SideSlope>(STIFFNESS, &at).resistance_n, 100.0));
        }
    }

    /// Straight along the slope the wheels hold 4 kN; in a turn of 50 m, which takes 4 kN, uphill twice that, downhill nothing.
    #[test]
    fn with_the_drag_of_the_turn_it_is_that_of_the_whole_side_force() {
        let mut at = at_10_m_s();
        at.place.sin_roll = 0.2;
        for (curvature, side_n) in [(0.0, 4000.0), (-0.02, 8000.0), (0.02, 0.0)] {
            at.place.curvature_per_m = curvature;
            let turn = act::<CorneringDrag>(STIFFNESS, &at).resistance_n;
            let whole = turn + act::<SideSlope>(STIFFNESS, &at).resistance_n;
            assert!((whole - side_n * side_n / 160e3).abs() < 1e-9, "{curvature}: {whole}");
        }
    }

    /// sin φ = 0.6 has tan² φ = 0.5625, and 16 kN of the 20 kN rest on the ground: 0.4 · 0.5625 · 4 kN / 16 kN.
    #[test]
    fn unlike_loads_slip_by_the_square_of_the_slope() {
        let mut at = at_10_m_s();
        at.place.sin_roll = 0.6;
        let law = "(cornering_stiffness_n_per_rad: 1e9, slip_coefficient: 0.4)";
        assert!(same(act::<SideSlope>(law, &at).slip_per_n * 4000.0, 0.056_25));
        // A path that climbs by 0.48 on it: cos² = 1 − 0.36 − 0.2304 = 0.64².
        at.place.sin_slope = 0.48;
        let expected = 0.4 * (0.36 / 0.4096) * 4000.0 / (0.64 * 20e3);
        assert!(same(act::<SideSlope>(law, &at).slip_per_n * 4000.0, expected));
    }

    #[test]
    fn on_ground_that_is_level_across_it_does_nothing_in_turns_neither() {
        let mut at = at_10_m_s();
        (at.place.curvature_per_m, at.place.sin_slope) = (0.02, 0.1);
        let law = "(cornering_stiffness_n_per_rad: 160000.0, slip_coefficient: 0.4)";
        assert_eq!(act::<SideSlope>(law, &at), Action::default());
    }

    #[test]
    fn a_stiffness_has_to_be_given() {
        assert!(build::<SideSlope>("()").is_err());
    }
}
