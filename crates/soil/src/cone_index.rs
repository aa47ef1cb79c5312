//! The strength of a soil as a cone finds it: measured, or from how wet it is.
//!
//! ln CI = a₁ + a₂ ln w        CI in psi, w gravimetric moisture in per cent
//!
//! Source: the soil strength curves by class of the Unified Soil Classification System in Frankenstein and Koenig, *Fast
//! All-season Soil STrength (FASST)*, U.S. Army ERDC/CRREL SR-04-1 (2004); coefficients at second hand, those of fat clay
//! left out because they were not legible. Holds for natural, not tilled, fine-grained and mixed soils; sands without
//! fines hardly follow their moisture.

use headland_plugin::Refusal;
use serde::Deserialize;

/// How a card tells of a [`Moist`].
pub const MOIST: &str = "(soil_type: SM | SC | ML | CL | OL | MH, moisture)";
/// What a card says of it.
pub const MOIST_ABOUT: &str = "or instead of the cone index: class of the Unified Soil Classification System and gravimetric \
                               moisture (0.05 to 0.6), ln CI = a₁ + a₂ ln w after Frankenstein and Koenig, FASST (2004)";

/// Classes of the Unified Soil Classification System.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
pub enum SoilType {
    /// Silty sand.
    SM,
    /// Clayey sand.
    SC,
    /// Silt.
    ML,
    /// Lean clay.
    CL,
    /// Organic silt.
    OL,
    /// Elastic silt.
    MH,
}

/// A soil that is as firm as its moisture lets it be.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Moist {
    soil_type: SoilType,
    moisture: f64,
}

/// Moistures that the curves were made for, from air-dry to liquid.
const DRIEST: f64 = 0.05;
const WETTEST: f64 = 0.6;
const PA_PER_PSI: f64 = 6_894.757;

impl Moist {
    /// Cone index [Pa].
    fn cone_index_pa(&self) -> f64 {
        let (a1, a2) = match self.soil_type {
            SoilType::SM => (8.749, -1.195),
            SoilType::SC => (9.056, -1.357),
            SoilType::ML => (10.225, -1.565),
            SoilType::CL => (10.998, -1.848),
            SoilType::OL => (10.977, -1.754),
            SoilType::MH => (12.321, -2.044),
        };
        f64::exp(a1 + a2 * (100.0 * self.moisture).ln()) * PA_PER_PSI
    }
}

/// The cone index that parameters give, one way or the other [Pa].
///
/// # Errors
/// [`Refusal`] where both ways are given or none, or a moisture that no curve has.
pub fn settled_pa(cone_index_pa: Option<f64>, moist: Option<Moist>) -> Result<f64, Refusal> {
    let refuse = |parameter: &str, found: String, expected: String| {
        Err(Refusal { parameter: parameter.to_owned(), found, expected })
    };
    match (cone_index_pa, moist) {
        (Some(cone_index_pa), None) => Ok(cone_index_pa),
        (None, Some(moist)) if (DRIEST..=WETTEST).contains(&moist.moisture) => Ok(moist.cone_index_pa()),
        (None, Some(moist)) => {
            refuse("moist.moisture", moist.moisture.to_string(), format!("{DRIEST} to {WETTEST}"))
        }
        (Some(_), Some(_)) => {
            refuse("moist", "given beside `cone_index_pa`".to_owned(), "one of the two".to_owned())
        }
        (None, None) => refuse("cone_index_pa", "not given".to_owned(), "it, or `moist`".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Silty sand at 20 %: e^(8.749 − 1.195 · 2.99573) = e^5.16910 = 175.76 psi = 1211.8 kPa, by hand.
    #[test]
    fn silty_sand_at_twenty_per_cent() {
        let moist = Moist { soil_type: SoilType::SM, moisture: 0.2 };
        assert!((settled_pa(None, Some(moist)).unwrap() / 1.2118e6 - 1.0).abs() < 1e-4);
    }

    #[test]
    fn every_class_softens_with_water_and_clays_faster_than_sands() {
        let at = |soil_type, moisture| Moist { soil_type, moisture }.cone_index_pa();
        for soil_type in [SoilType::SM, SoilType::SC, SoilType::ML, SoilType::CL, SoilType::OL, SoilType::MH]
        {
            assert!(at(soil_type, 0.15) > at(soil_type, 0.3));
        }
        assert!(
            at(SoilType::CL, 0.15) / at(SoilType::CL, 0.3) > at(SoilType::SM, 0.15) / at(SoilType::SM, 0.3)
        );
    }

    #[test]
    fn one_way_to_say_it_is_asked_for_and_no_more() {
        let moist = Moist { soil_type: SoilType::CL, moisture: 20.0 };
        assert!(settled_pa(None, None).unwrap_err().to_string().contains("it, or `moist`"));
        assert!(settled_pa(Some(1e6), Some(moist)).unwrap_err().to_string().contains("one of the two"));
        let refused = settled_pa(None, Some(moist)).unwrap_err().to_string();
        assert_eq!(refused, "`moist.moisture` is 20, expected 0.05 to 0.6");
        assert_eq!(settled_pa(Some(1e6), None), Ok(1e6));
    }
}
