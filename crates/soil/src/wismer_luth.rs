//! A tyre on soil of one cone index, by the wheel numeric of Wismer and Luth.
//!
//! C_n = CI b d / W                          wheel numeric
//! MR/W = 1.2/C_n + 0.04                     motion resistance
//! GT/W = 0.75 (1 − e^(−0.3 C_n s))          gross traction
//!
//! Source: Wismer and Luth, "Off-road traction prediction for wheeled vehicles", Transactions of the ASAE 17 (1974), 8-10,
//! 14; constants from memory.
//!
//! A braked wheel (s < 0) is not in the source: here its traction is the driven wheel's with the other sign. A wheel in
//! the rut of an earlier one finds the cone index times a factor, the same for every later pass.

use crate::cone_index::{MOIST, MOIST_ABOUT, Moist, Strength, settled};
use headland_plugin::{Bound, Card, Contact, Footing, Plugin, Refusal, Soil, WheelContact, parameter};
use serde::Deserialize;
use std::path::Path;

/// Tyres of one make on soil of one cone index.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WismerLuth {
    #[serde(default)]
    cone_index_pa: Option<f64>,
    #[serde(default)]
    moist: Option<Moist>,
    pass_factor: f64,
    #[serde(skip)]
    strength: Strength,
}

impl Plugin for WismerLuth {
    const CARD: Card = Card {
        name: "WismerLuth",
        about: "traction and motion resistance of farm tyres by cone index, without their deflection",
        equation: "C_n = CI b d/W; MR/W = 1.2/C_n + 0.04; GT/W = 0.75 (1 − e^(−0.3 C_n s))",
        source: "Wismer and Luth, Off-road traction prediction for wheeled vehicles, Transactions of the ASAE 17 (1974), \
                 8-10, 14; constants from memory",
        validity: "b/d about 0.3, deflection 20 % of the section height, cohesive-frictional soils that are not very firm; \
                   braked wheels by symmetry; needs a vehicle with axles",
        parameters: &[
            parameter("cone_index_pa", "Pa", "mean resistance to a cone over the top 150 mm, CI; or `moist`")
                .must_be(Bound::Positive)
                .usually(1e5, 4e6),
            parameter("moist", MOIST, MOIST_ABOUT),
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

impl Soil for WismerLuth {
    fn resistance_n(&self, _: &Contact) -> f64 {
        f64::NAN
    }

    fn wheel(&self, contact: &WheelContact) -> Option<Footing> {
        let (b, d) = (contact.tyre.width_m, contact.tyre.diameter_m);
        let (w, s) = (contact.load_n, contact.slip);
        let firmer = if contact.earlier_passes > 0 { self.pass_factor } else { 1.0 };
        let inverse = w / (firmer * self.strength.at_pa(&contact.place) * b * d);
        // Without load there is no traction, whatever the numeric.
        let grip = if w == 0.0 { 0.0 } else { 0.75 * (-(-0.3 * s.abs() / inverse).exp_m1()).copysign(s) };
        Some(Footing {
            gross_traction_n: w * grip,
            motion_resistance_n: w * (1.2 * inverse + 0.04),
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
    use crate::Brixius;
    use crate::testing::{LOAD_N, ON, XERION, read};
    use headland_plugin::Tyre;

    fn soil(cone_index_pa: f64) -> WismerLuth {
        let (cone_index_pa, strength) = (Some(cone_index_pa), Strength::Even(cone_index_pa));
        WismerLuth { cone_index_pa, moist: None, pass_factor: 1.5, strength }
    }

    /// Cone index at which the wheel of the tests has this numeric.
    fn of_numeric(numeric: f64) -> f64 {
        numeric * LOAD_N / (XERION.width_m * XERION.diameter_m)
    }

    /// C_n = 30, s = 0.2: 0.75 (1 − e^(−1.8)) = 0.62603 and 1.2/30 + 0.04 = 0.08, by hand.
    #[test]
    fn a_numeric_of_thirty_at_twenty_per_cent_of_slip() {
        let footing = soil(of_numeric(30.0)).wheel(&WheelContact { slip: 0.2, ..ON }).unwrap();
        assert!((footing.gross_traction_n / LOAD_N - 0.626_03).abs() < 1e-5);
        assert!((footing.motion_resistance_n / LOAD_N - 0.08).abs() < 1e-12);
        let braked = soil(of_numeric(30.0)).wheel(&WheelContact { slip: -0.2, ..ON }).unwrap();
        assert!((braked.gross_traction_n + footing.gross_traction_n).abs() < 1e-9);
    }

    #[test]
    fn without_slip_there_is_no_traction_and_without_load_nothing() {
        assert_eq!(soil(9e5).wheel(&ON).unwrap().gross_traction_n, 0.0);
        let unloaded = soil(9e5).wheel(&WheelContact { load_n: 0.0, slip: 0.0, ..ON }).unwrap();
        assert_eq!((unloaded.gross_traction_n, unloaded.motion_resistance_n), (0.0, 0.0));
    }

    #[test]
    fn in_a_rut_the_sinking_part_of_the_resistance_falls_by_the_factor() {
        let part = |earlier_passes: u32| {
            soil(9e5).wheel(&WheelContact { earlier_passes, ..ON }).unwrap().motion_resistance_n / LOAD_N
                - 0.04
        };
        assert!((part(1) * 1.5 / part(0) - 1.0).abs() < 1e-12);
    }

    /// Both were fitted to such tyres: b/d 0.3, deflection 20 % of the section height. Tractions agree to a seventh
    /// between 10 and 30 % of slip, resistances to a fifth; on softer ground they part.
    #[test]
    fn it_agrees_with_brixius_for_the_tyres_that_both_were_made_for() {
        let tyre = Tyre {
            width_m: 0.47,
            diameter_m: 0.47 / 0.3,
            section_height_m: 0.35,
            stiffness_n_per_m: Some(20_000.0 / (0.2 * 0.35)),
            ..XERION
        };
        for numeric in [30.0, 35.0, 40.0] {
            let cone_index_pa = numeric * 20_000.0 / (tyre.width_m * tyre.diameter_m);
            let text = format!("(cone_index_pa: {cone_index_pa}, construction: Bias, pass_factor: 1.0)");
            let brixius: Brixius = read(&text);
            for slip in [0.1, 0.2, 0.3] {
                let contact = WheelContact { tyre: &tyre, load_n: 20_000.0, slip, ..ON };
                let (one, other) =
                    (soil(cone_index_pa).wheel(&contact).unwrap(), brixius.wheel(&contact).unwrap());
                let traction = one.gross_traction_n / other.gross_traction_n;
                assert!((traction - 1.0).abs() < 1.0 / 7.0, "{numeric} {slip}: {traction}");
            }
            let contact = WheelContact { tyre: &tyre, load_n: 20_000.0, ..ON };
            let resistance = |soil: &dyn Soil| soil.wheel(&contact).unwrap().motion_resistance_n;
            let ratio = resistance(&soil(cone_index_pa)) / resistance(&brixius);
            assert!((ratio - 1.0).abs() < 0.2, "{numeric}: {ratio}");
        }
    }
}
