//! A tyre on soil of one cone index, by Brixius' mobility number.
//!
//! B_n = (CI b d / W) (1 + 5 δ/h) / (1 + 3 b/d)                              mobility number
//! MR/W = a/B_n + c + 0.5 s/√B_n                                             motion resistance
//! GT/W = 0.88 (1 − e^(−0.1 B_n)) (1 − e^(−k s)) + c                         gross traction
//! a = 1, c = 0.04, k = 7.5 for bias tyres;  a = 0.9, c = 0.0325, k = 9.5 for radial ones
//!
//! Source: Brixius, "Traction prediction equations for bias ply tires", ASAE paper 87-1622 (1987); ASABE D497, clause 3;
//! the radial constants after Zoz and Grisso, *Traction and Tractor Performance*, ASAE Distinguished Lecture 27 (2003).
//! All constants are from memory.
//!
//! A braked wheel (s < 0) is not in the source: here its traction is the driven wheel's with the other sign, and skid
//! does not add to the resistance, so that a wheel without torque resists as the source's towed one.
//! A wheel in the rut of an earlier one finds the cone index times a factor, the same for every later pass: ruts get
//! most of their firmness in the first.

use crate::cone_index::{MOIST, MOIST_ABOUT, Moist, Strength, settled};
use headland_plugin::{Bound, Card, Contact, Footing, Plugin, Refusal, Soil, WheelContact, parameter};
use serde::Deserialize;
use std::path::Path;

/// How the carcass of a tyre is laid.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
pub enum Construction {
    /// Plies across each other.
    Bias,
    /// Plies from bead to bead, and a belt.
    Radial,
}

/// Farm tyres on soil of one cone index.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Brixius {
    #[serde(default)]
    cone_index_pa: Option<f64>,
    #[serde(default)]
    moist: Option<Moist>,
    construction: Construction,
    pass_factor: f64,
    #[serde(skip)]
    strength: Strength,
}

impl Plugin for Brixius {
    const CARD: Card = Card {
        name: "Brixius",
        about: "traction and motion resistance of farm tyres by cone index (ASABE D497)",
        equation: "B_n = (CI b d/W)(1 + 5 δ/h)/(1 + 3 b/d); MR/W = a/B_n + c + 0.5 s/√B_n; \
                   GT/W = 0.88 (1 − e^(−0.1 B_n))(1 − e^(−k s)) + c; (a, c, k) = (1, 0.04, 7.5) bias, (0.9, 0.0325, 9.5) \
                   radial",
        source: "Brixius, Traction prediction equations for bias ply tires, ASAE 87-1622 (1987); ASABE D497, clause 3; \
                 Zoz and Grisso, Traction and Tractor Performance (2003), for radial tyres; constants from memory",
        validity: "b/d 0.1 to 0.7, deflection 10 to 30 % of the section height, W/(b d) 15 to 55 kPa, cohesive-frictional \
                   soils; braked wheels by symmetry; needs a vehicle with axles",
        parameters: &[
            parameter("cone_index_pa", "Pa", "mean resistance to a cone over the top 150 mm, CI; or `moist`")
                .must_be(Bound::Positive)
                .usually(1e5, 4e6),
            parameter("moist", MOIST, MOIST_ABOUT),
            parameter("construction", "(Bias | Radial)", "of the tyres"),
            parameter(
                "pass_factor",
                "1",
                "cone index in the rut of an earlier wheel, as a multiple; 1.3 to 2 from memory",
            )
            .must_be(Bound::Positive)
            .usually(1.0, 2.5),
        ],
    };

    fn settle(&mut self, folder: &Path) -> Result<(), Refusal> {
        self.strength = settled(self.cone_index_pa, self.moist.as_ref(), folder)?;
        Ok(())
    }
}

impl Construction {
    /// Share of 1/B_n in the resistance, resistance of the tyre itself, rate of the traction.
    fn constants(self) -> (f64, f64, f64) {
        match self {
            Self::Bias => (1.0, 0.04, 7.5),
            Self::Radial => (0.9, 0.0325, 9.5),
        }
    }
}

/// 1 / B_n of a wheel on soil of this cone index.
fn inverse_mobility(cone_index_pa: f64, contact: &WheelContact) -> f64 {
    let tyre = contact.tyre;
    let (b, d, h) = (tyre.width_m, tyre.diameter_m, tyre.section_height_m);
    let delta = tyre.deflection_m(contact.load_n);
    contact.load_n * (1.0 + 3.0 * b / d) / (cone_index_pa * b * d * (1.0 + 5.0 * delta / h))
}

impl Soil for Brixius {
    fn resistance_n(&self, _: &Contact) -> f64 {
        f64::NAN
    }

    fn wheel(&self, contact: &WheelContact) -> Option<Footing> {
        let (a, c, k) = self.construction.constants();
        let (w, s) = (contact.load_n, contact.slip);
        let firmer = if contact.earlier_passes > 0 { self.pass_factor } else { 1.0 };
        let inverse = inverse_mobility(firmer * self.strength.at_pa(&contact.place), contact);
        let grip = 0.88 * -(-0.1 / inverse).exp_m1() * (-(-k * s.abs()).exp_m1()).copysign(s);
        Some(Footing {
            gross_traction_n: w * (grip + c),
            motion_resistance_n: w * (a * inverse + c + 0.5 * s.max(0.0) * inverse.sqrt()),
            sinkage_m: f64::NAN,
        })
    }

    fn needs_axles(&self) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{LOAD_N, ON, XERION};
    use headland_plugin::Tyre;

    fn soil(cone_index_pa: f64, construction: Construction) -> Brixius {
        let (cone_index_pa, strength) = (Some(cone_index_pa), Strength::Even(cone_index_pa));
        Brixius { cone_index_pa, moist: None, construction, pass_factor: 1.5, strength }
    }

    fn ratios(soil: &Brixius, contact: &WheelContact) -> (f64, f64) {
        let footing = soil.wheel(contact).unwrap();
        (footing.gross_traction_n / contact.load_n, footing.motion_resistance_n / contact.load_n)
    }

    /// CI b d / W = 955 · 0.9 · 2.045 / 31.93 = 55.05; (1 + 0.4504) / (1 + 1.3203) = 0.6251; B_n = 34.41; 1/B_n = 0.02906.
    #[test]
    fn the_coefficient_of_the_coast_down_study_is_that_of_955_kpa() {
        let (_, resistance) = ratios(&soil(955e3, Construction::Bias), &ON);
        assert!((resistance - 0.06906).abs() < 2e-5, "{resistance}");
    }

    /// The tractor of the study over cone indices, computed elsewhere to three decimals.
    #[test]
    fn firmer_ground_resists_less_as_tabulated() {
        let table = [
            (300e3, 0.133),
            (450e3, 0.102),
            (700e3, 0.080),
            (900e3, 0.071),
            (1200e3, 0.063),
            (1800e3, 0.055),
        ];
        for (cone_index_pa, expected) in table {
            let (_, resistance) = ratios(&soil(cone_index_pa, Construction::Bias), &ON);
            assert!((resistance - expected).abs() < 1.1e-3, "{cone_index_pa}: {resistance}");
        }
        // With δ/h = 0.2 it takes 700 kPa for 0.069.
        let tyre = Tyre { stiffness_n_per_m: Some(LOAD_N / (0.2 * XERION.section_height_m)), ..XERION };
        let (_, resistance) = ratios(&soil(700e3, Construction::Bias), &WheelContact { tyre: &tyre, ..ON });
        assert!((resistance - 0.069).abs() < 6e-4, "{resistance}");
    }

    /// B_n = 40 by choice of the cone index, s = 0.1, by hand:
    /// bias   0.88 · 0.98168 · 0.52763 + 0.04 = 0.49581 and 0.025 + 0.04 + 0.05/6.3246 = 0.07291;
    /// radial 0.88 · 0.98168 · 0.61326 + 0.0325 = 0.56228 and 0.0225 + 0.0325 + 0.00791 = 0.06291.
    #[test]
    fn a_driven_wheel_at_ten_per_cent_of_slip() {
        let cone_index_pa = 40.0 * inverse_mobility(1.0, &ON);
        let contact = WheelContact { slip: 0.1, ..ON };
        let (gross, resistance) = ratios(&soil(cone_index_pa, Construction::Bias), &contact);
        assert!(
            (gross - 0.495_81).abs() < 2e-5 && (resistance - 0.072_906).abs() < 2e-6,
            "{gross} {resistance}"
        );
        let (gross, resistance) = ratios(&soil(cone_index_pa, Construction::Radial), &contact);
        assert!(
            (gross - 0.562_28).abs() < 2e-5 && (resistance - 0.062_906).abs() < 2e-6,
            "{gross} {resistance}"
        );
    }

    /// (1 − s) NT / GT rises to a peak between 5 and 15 % of slip and falls again; the softer the ground, the lower the
    /// peak and the more slip it takes.
    #[test]
    fn traction_efficiency_has_its_peak_at_moderate_slip() {
        let peak = |cone_index_pa: f64| {
            let soil = soil(cone_index_pa, Construction::Bias);
            let efficiency = |slip: f64| {
                let (gross, resistance) = ratios(&soil, &WheelContact { slip, ..ON });
                (1.0 - slip) * (gross - resistance) / gross
            };
            let curve: Vec<f64> = (1..60).map(|i| efficiency(f64::from(i) / 100.0)).collect();
            let top = (0..curve.len()).max_by(|a, b| curve[*a].total_cmp(&curve[*b])).unwrap();
            assert!(curve[..=top].is_sorted() && curve[top..].iter().rev().is_sorted(), "{curve:?}");
            ((top + 1) as f64 / 100.0, curve[top])
        };
        let (firm, tilled, soft) = (peak(1800e3), peak(900e3), peak(450e3));
        assert!(firm.0 <= tilled.0 && tilled.0 <= soft.0 && firm.1 > tilled.1 && tilled.1 > soft.1);
        assert!([firm, tilled, soft].iter().all(|(slip, _)| (0.05..0.2).contains(slip)), "{firm:?} {soft:?}");
        assert!((0.7..0.85).contains(&firm.1) && (0.5..0.75).contains(&soft.1), "{firm:?} {soft:?}");
    }

    #[test]
    fn ground_without_give_leaves_the_resistance_of_the_tyre_alone() {
        let (gross, resistance) = ratios(&soil(1e15, Construction::Bias), &ON);
        assert!((resistance - 0.04).abs() < 1e-7 && (gross - resistance).abs() < 1e-7);
        let unloaded = soil(9e5, Construction::Bias).wheel(&WheelContact { load_n: 0.0, ..ON }).unwrap();
        assert_eq!((unloaded.gross_traction_n, unloaded.motion_resistance_n), (0.0, 0.0));
    }

    #[test]
    fn a_braked_wheel_grips_as_a_driven_one_does_and_resists_as_a_towed_one() {
        let soil = soil(9e5, Construction::Bias);
        let grip = |slip: f64| ratios(&soil, &WheelContact { slip, ..ON });
        let ((forward, more), (backward, towed)) = (grip(0.2), grip(-0.2));
        assert!((forward - 0.04 + (backward - 0.04)).abs() < 1e-12);
        assert!(more > towed && (towed - grip(0.0).1).abs() < 1e-15);
    }

    #[test]
    fn the_second_wheel_of_a_rut_finds_it_firmer_and_the_third_as_the_second() {
        let soil = soil(9e5, Construction::Bias);
        let resistance = |earlier_passes: u32| ratios(&soil, &WheelContact { earlier_passes, ..ON }).1;
        // Only a/B_n falls, by the factor.
        assert!(((resistance(1) - 0.04) * 1.5 / (resistance(0) - 0.04) - 1.0).abs() < 1e-12);
        assert_eq!(resistance(1), resistance(2));
    }

    #[test]
    fn it_knows_no_vehicle_without_wheels_and_no_other_tyres() {
        let soil = soil(9e5, Construction::Bias);
        assert!(soil.needs_axles());
        assert!(soil.resistance_n(&Contact { load_n: 1e4, speed_m_s: 1.0, position_m: 0.0 }).is_nan());
        assert!(
            ron::from_str::<Brixius>("(cone_index_pa: 9e5, construction: Steel, pass_factor: 1)").is_err()
        );
        assert!(ron::from_str::<Brixius>("(construction: Radial)").is_err());
        let mut nothing: Brixius = ron::from_str("(construction: Radial, pass_factor: 1)").unwrap();
        assert_eq!(nothing.settle(Path::new("")).unwrap_err().parameter, "cone_index_pa");
        let wet = "(moist: Some((soil_type: CL, moisture: 0.3)), construction: Radial, pass_factor: 1)";
        let mut wet: Brixius = ron::from_str(wet).unwrap();
        wet.settle(Path::new("")).unwrap();
        // e^(10.998 − 1.848 · 3.4012) = 111.40 psi.
        let strength_pa = wet.strength.at_pa(&ON.place);
        assert!((strength_pa / 768.1e3 - 1.0).abs() < 2e-3, "{strength_pa}");
    }
}
