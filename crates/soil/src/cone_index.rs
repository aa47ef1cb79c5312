//! The strength of a soil as a cone finds it: measured, or from how wet it is.
//!
//! ln CI = a₁ + a₂ ln w        CI in psi, w gravimetric moisture in per cent
//!
//! Source: the soil strength curves by class of the Unified Soil Classification System in Frankenstein and Koenig, *Fast
//! All-season Soil STrength (FASST)*, U.S. Army ERDC/CRREL SR-04-1 (2004); coefficients at second hand, those of fat clay
//! left out because they were not legible. Holds for natural, not tilled, fine-grained and mixed soils; sands without
//! fines hardly follow their moisture.

use crate::soil_map::Origin;
use headland_plugin::{Place, Refusal};
use headland_raster::{Picture, Raster};
use serde::Deserialize;
use std::path::Path;

/// How a card tells of a [`Moist`].
pub const MOIST: &str = "(soil_type: SM | SC | ML | CL | OL | MH, moisture, map)";
/// What a card says of it.
pub const MOIST_ABOUT: &str = "or instead of the cone index: class of the Unified Soil Classification System and gravimetric \
                               moisture (0.05 to 0.6), ln CI = a₁ + a₂ ln w after Frankenstein and Koenig, FASST (2004); \
                               `map: (file, cell_m, black, white, origin)` may say the moisture where it knows it, \
                               evenly between its samples; black and white, as the distance of pixels, are of a picture";

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
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Moist {
    soil_type: SoilType,
    /// Where no map says another.
    moisture: f64,
    #[serde(default)]
    map: Option<MoistureMap>,
}

/// Moistures over the map.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct MoistureMap {
    file: String,
    #[serde(default)]
    cell_m: Option<f64>,
    #[serde(default)]
    black: Option<f64>,
    #[serde(default)]
    white: Option<f64>,
    #[serde(default)]
    origin: Option<Origin>,
}

/// How firm a soil is.
#[derive(Clone, Debug)]
pub enum Strength {
    /// Everywhere alike: cone index [Pa].
    Even(f64),
    /// By the moisture of a map, and by one moisture where the map knows none.
    Mapped(SoilType, f64, Box<Raster>),
}

impl Default for Strength {
    fn default() -> Self {
        Self::Even(f64::NAN)
    }
}

impl Strength {
    /// Cone index at a place [Pa].
    pub fn at_pa(&self, place: &Place) -> f64 {
        match self {
            Self::Even(cone_index_pa) => *cone_index_pa,
            Self::Mapped(soil_type, moisture, map) => {
                soil_type.cone_index_pa(map.even(place.east_m, place.north_m).unwrap_or(*moisture))
            }
        }
    }
}

/// Moistures that the curves were made for, from air-dry to liquid.
const DRIEST: f64 = 0.05;
const WETTEST: f64 = 0.6;
const PA_PER_PSI: f64 = 6_894.757;

impl SoilType {
    /// Cone index at a moisture [Pa].
    fn cone_index_pa(self, moisture: f64) -> f64 {
        let (a1, a2) = match self {
            Self::SM => (8.749, -1.195),
            Self::SC => (9.056, -1.357),
            Self::ML => (10.225, -1.565),
            Self::CL => (10.998, -1.848),
            Self::OL => (10.977, -1.754),
            Self::MH => (12.321, -2.044),
        };
        f64::exp(a1 + a2 * (100.0 * moisture).ln()) * PA_PER_PSI
    }
}

fn refuse(parameter: &str, found: String, expected: String) -> Refusal {
    Refusal { parameter: parameter.to_owned(), found, expected }
}

impl MoistureMap {
    fn read(&self, folder: &Path) -> Result<Raster, Refusal> {
        let picture = match (self.cell_m, self.black, self.white) {
            (Some(cell_m), Some(black), Some(white)) => Some(Picture { cell_m, range: Some((black, white)) }),
            (None, None, None) => None,
            _ => {
                let expected = "`cell_m`, `black` and `white` for a picture, none of them for another file";
                return Err(refuse("moist.map", "given in part".to_owned(), expected.to_owned()));
            }
        };
        let within =
            |refusal: Refusal| Refusal { parameter: format!("moist.map.{}", refusal.parameter), ..refusal };
        let mut raster = headland_raster::read(folder, &self.file, picture.as_ref()).map_err(within)?;
        if let Some(Origin { east_m, north_m }) = self.origin {
            raster = raster.from_origin(east_m, north_m);
        }
        let odd =
            raster.values().iter().position(|value| !value.is_nan() && !(DRIEST..=WETTEST).contains(value));
        if let Some(at) = odd {
            let [east_m, north_m] = raster.place_m(at % raster.columns(), at / raster.columns());
            let value = raster.values()[at];
            let found = format!("`{}` with {value} at {east_m} m east and {north_m} m north", self.file);
            return Err(refuse("moist.map.file", found, format!("moistures of {DRIEST} to {WETTEST}")));
        }
        Ok(raster)
    }
}

/// The strength that parameters give, one way or the other.
///
/// # Errors
/// [`Refusal`] where both ways are given or none, or a moisture that no curve has.
pub fn settled(
    cone_index_pa: Option<f64>,
    moist: Option<&Moist>,
    folder: &Path,
) -> Result<Strength, Refusal> {
    match (cone_index_pa, moist) {
        (Some(cone_index_pa), None) => Ok(Strength::Even(cone_index_pa)),
        (None, Some(moist)) if (DRIEST..=WETTEST).contains(&moist.moisture) => match &moist.map {
            None => Ok(Strength::Even(moist.soil_type.cone_index_pa(moist.moisture))),
            Some(map) => Ok(Strength::Mapped(moist.soil_type, moist.moisture, Box::new(map.read(folder)?))),
        },
        (None, Some(moist)) => {
            Err(refuse("moist.moisture", moist.moisture.to_string(), format!("{DRIEST} to {WETTEST}")))
        }
        (Some(_), Some(_)) => {
            Err(refuse("moist", "given beside `cone_index_pa`".to_owned(), "one of the two".to_owned()))
        }
        (None, None) => Err(refuse("cone_index_pa", "not given".to_owned(), "it, or `moist`".to_owned())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moist(soil_type: SoilType, moisture: f64) -> Moist {
        Moist { soil_type, moisture, map: None }
    }

    fn even_pa(cone_index_pa: Option<f64>, moist: Option<&Moist>) -> Result<f64, String> {
        settled(cone_index_pa, moist, Path::new(""))
            .map(|strength| strength.at_pa(&Place::default()))
            .map_err(|refusal| refusal.to_string())
    }

    /// Silty sand at 20 %: e^(8.749 − 1.195 · 2.99573) = e^5.16910 = 175.76 psi = 1211.8 kPa, by hand.
    #[test]
    fn silty_sand_at_twenty_per_cent() {
        let found = even_pa(None, Some(&moist(SoilType::SM, 0.2))).unwrap();
        assert!((found / 1.2118e6 - 1.0).abs() < 1e-4);
    }

    #[test]
    fn every_class_softens_with_water_and_clays_faster_than_sands() {
        let at = |soil_type: SoilType, moisture| soil_type.cone_index_pa(moisture);
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
        let odd = moist(SoilType::CL, 20.0);
        assert!(even_pa(None, None).unwrap_err().contains("it, or `moist`"));
        assert!(even_pa(Some(1e6), Some(&odd)).unwrap_err().contains("one of the two"));
        assert_eq!(even_pa(None, Some(&odd)).unwrap_err(), "`moist.moisture` is 20, expected 0.05 to 0.6");
        assert_eq!(even_pa(Some(1e6), None), Ok(1e6));
    }

    /// Dry in the west, 0.2, and wet 20 m east of it, 0.4: 0.25 after a quarter of the way.
    #[test]
    fn a_map_says_the_moisture_where_it_knows_it() {
        let folder = tempfile::tempdir().unwrap();
        let read = |row: &str| {
            let text = format!(
                "ncols 2
nrows 2
xllcenter 0
yllcenter 0
cellsize 20
{row}
{row}
"
            );
            std::fs::write(folder.path().join("wet.asc"), text).unwrap();
            let moist: Moist = ron::Options::default()
                .with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME)
                .from_str(r#"(soil_type: CL, moisture: 0.3, map: (file: "wet.asc"))"#)
                .unwrap();
            settled(None, Some(&moist), folder.path())
        };
        let strength = read("0.2 0.4").unwrap();
        let at = |east_m: f64| strength.at_pa(&Place { east_m, ..Place::default() });
        for (east_m, moisture) in [(0.0, 0.2), (5.0, 0.25), (20.0, 0.4), (21.0, 0.3), (-1.0, 0.3)] {
            let wanted = SoilType::CL.cone_index_pa(moisture);
            assert!((at(east_m) / wanted - 1.0).abs() < 1e-12, "{east_m}");
        }
        let refused = read("0.2 40").unwrap_err().to_string();
        assert!(refused.contains("`wet.asc` with 40 at 20 m east and 0 m north"), "{refused}");
    }
}
