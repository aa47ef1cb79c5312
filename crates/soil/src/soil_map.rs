//! Ground that is not the same everywhere: a map of classes, each of which is a soil.
//!
//! soil(east, north) = soil of the class in whose cell the place lies, else `otherwise`
//!
//! Source: definition.
//!
//! Cells lie around the samples of the map. Off the map, and where it knows nothing, lies `otherwise`. At the border of two
//! cells the resistance changes at once.

use crate::mosaic::{Layout, Mosaic};
use headland_plugin::{Bound, Card, Place, Refusal, parameter};
use headland_raster::{Picture, Raster};
use serde::Deserialize;
use std::path::Path;

/// Soils by the classes of a map.
pub type SoilMap = Mosaic<ClassMap>;

/// A map of classes.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "SoilMap")]
pub struct ClassMap {
    file: String,
    #[serde(default)]
    cell_m: Option<f64>,
    #[serde(default)]
    origin: Option<Origin>,
    classes: Vec<Class>,
    otherwise: String,
    #[serde(skip)]
    raster: Option<Raster>,
}

/// The point of a file's own coordinates that is 0, 0 here.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Origin {
    pub east_m: f64,
    pub north_m: f64,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Class {
    value: f64,
    soil: String,
}

impl Layout for ClassMap {
    const CARD: Card = Card {
        name: "SoilMap",
        about: "soils by the classes of a map, named in `ground.soils`",
        equation: "soil(east, north) = soil of the class in whose cell the place lies, else `otherwise`",
        source: "definition",
        validity: "cells that are not smaller than the vehicle; terrains that know east and north",
        parameters: &[
            parameter(
                "file",
                "path",
                "relative to the scenario: an ASCII grid (.asc), a GeoTIFF (.tif), or a PNG whose grey or whose place in \
                 the palette is the class",
            ),
            parameter("cell_m", "m", "how far pixels are apart; with a picture, and only with one")
                .must_be(Bound::Positive)
                .usually(0.5, 100.0),
            parameter(
                "origin",
                "(east_m, north_m)",
                "the point of the file's own coordinates that is 0, 0 here; left out: theirs, the pixel in the south-west \
                 of a picture",
            ),
            parameter("classes", "[(value, soil)]", "the soil of each class that the map has"),
            parameter("otherwise", "(name of a soil)", "what lies off the map, and where it knows nothing"),
        ],
    };

    fn settle(&mut self, folder: &Path) -> Result<(), Refusal> {
        let picture = self.cell_m.map(|cell_m| Picture { cell_m, range: None });
        let mut raster = headland_raster::read(folder, &self.file, picture.as_ref())?;
        if let Some(Origin { east_m, north_m }) = self.origin {
            raster = raster.from_origin(east_m, north_m);
        }
        for (index, class) in self.classes.iter().enumerate() {
            if self.classes[..index].iter().any(|other| other.value == class.value) {
                return Err(Refusal {
                    parameter: format!("classes.{index}.value"),
                    found: format!("{} again", class.value),
                    expected: "each class once".to_owned(),
                });
            }
        }
        let known = |value: f64| self.classes.iter().any(|class| class.value == value);
        let unknown = raster.values().iter().position(|value| !value.is_nan() && !known(*value));
        if let Some(at) = unknown {
            let [east_m, north_m] = raster.place_m(at % raster.columns(), at / raster.columns());
            return Err(Refusal {
                parameter: "classes".to_owned(),
                found: format!(
                    "without the class {} at {east_m} m east and {north_m} m north of `{}`",
                    raster.values()[at],
                    self.file
                ),
                expected: "every class of the map".to_owned(),
            });
        }
        self.raster = Some(raster);
        Ok(())
    }

    fn names(&self) -> Vec<(String, &str)> {
        let mut names = vec![("otherwise".to_owned(), self.otherwise.as_str())];
        let classes = self.classes.iter().enumerate();
        names.extend(classes.map(|(index, class)| (format!("classes.{index}.soil"), class.soil.as_str())));
        names
    }

    fn which(&self, place: &Place) -> usize {
        let value = self.raster.as_ref().and_then(|raster| raster.nearest(place.east_m, place.north_m));
        let class = value.and_then(|value| self.classes.iter().position(|class| class.value == value));
        class.map_or(0, |class| class + 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Constant;
    use crate::testing::read;
    use headland_plugin::{Contact, Plugin, Soil};

    const GRID: &str =
        "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 10\nNODATA_value -1\n1 2 2\n1 1 -1\n";

    fn map(grid: &str, classes: &str) -> Result<SoilMap, String> {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("soils.asc"), grid).unwrap();
        let mut map: SoilMap =
            ron::from_str(&format!("(file: \"soils.asc\", classes: [{classes}], otherwise: \"edge\")"))
                .unwrap();
        map.settle(folder.path()).map_err(|refusal| refusal.to_string())?;
        Ok(map)
    }

    const CLASSES: &str = "(value: 1, soil: \"loam\"), (value: 2, soil: \"sand\")";

    fn soils() -> Vec<(String, Box<dyn Soil>)> {
        [("sand", 0.1), ("loam", 0.06), ("edge", 0.02)]
            .map(|(name, coefficient)| {
                let soil: Constant = read(&format!("(coefficient: {coefficient})"));
                (name.to_owned(), Box::new(soil) as Box<dyn Soil>)
            })
            .into()
    }

    #[test]
    fn a_place_has_the_soil_of_its_cell_and_off_the_map_that_of_the_rest() {
        let mut map = map(GRID, CLASSES).unwrap();
        map.adopt(soils()).unwrap();
        // The north-western cell, the one east of it, one whose class is not known, and one off the map.
        for (east_m, north_m, coefficient) in
            [(5.0, 15.0, 0.06), (12.0, 19.0, 0.1), (25.0, 5.0, 0.02), (-1.0, 5.0, 0.02)]
        {
            let place = Place { east_m, north_m, ..Place::default() };
            let contact = Contact { load_n: 1e5, speed_m_s: 1.0, position_m: 0.0 };
            let found = map.resistance_at_n(&contact, &place) / 1e5;
            assert!((found - coefficient).abs() < 1e-12, "{east_m} {north_m}: {found}");
        }
    }

    #[test]
    fn a_class_without_a_soil_or_with_two_and_a_soil_without_a_class_are_refused() {
        let missing = map(GRID, "(value: 1, soil: \"loam\")").unwrap_err();
        assert!(missing.contains("the class 2 at 15 m east and 15 m north of `soils.asc`"), "{missing}");
        let twice = map(GRID, &format!("{CLASSES}, (value: 2, soil: \"loam\")")).unwrap_err();
        assert!(twice.contains("`classes.2.value` is 2 again"), "{twice}");
        let mut unknown = map(GRID, CLASSES).unwrap();
        let refused = unknown.adopt(soils().split_off(1)).unwrap_err().to_string();
        assert!(refused.contains("`classes.1.soil` is \"sand\""), "{refused}");
        let mut more = soils();
        more.push(("bog".to_owned(), Box::new(read::<Constant>("(coefficient: 0.4)"))));
        assert!(unknown.adopt(more).unwrap_err().to_string().contains("\"bog\", which lies nowhere"));
    }
}
