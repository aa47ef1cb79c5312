//! Ground that is not the same everywhere: soils in areas of the map.
//!
//! The soil at (east, north) is that of the first area which it lies in, else `otherwise`. A point lies in an area where a
//! line from it to the east crosses the border an odd number of times; borders belong to one side.
//!
//! Source: the even-odd rule; Shimrat, "Algorithm 112: position of point relative to polygon", Communications of the ACM 5
//! (1962), 434.
//!
//! The soils are those of `ground.soils`, by name. The wheels of an axle are on the soil below its middle, a vehicle without
//! axles on that below its centre of gravity. Where they cross a border the resistance changes at once.

use crate::mosaic::{Layout, Mosaic};
use headland_plugin::{Card, Place, Refusal, parameter};
use serde::Deserialize;
use std::path::Path;

/// Soils in areas of the map.
pub type Zones = Mosaic<Areas>;

/// Areas of the map.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Zones")]
pub struct Areas {
    otherwise: String,
    areas: Vec<Area>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Area {
    soil: String,
    corners: Vec<Corner>,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Corner {
    east_m: f64,
    north_m: f64,
}

impl Layout for Areas {
    const CARD: Card = Card {
        name: "Zones",
        about: "soils in areas of the map, named in `ground.soils`",
        equation: "soil(east, north) = soil of the first area around the place, else `otherwise`",
        source: "even-odd rule; Shimrat, Algorithm 112, Communications of the ACM 5 (1962), 434",
        validity: "areas that are large beside the vehicle; terrains that know east and north",
        parameters: &[
            parameter("otherwise", "(name of a soil)", "what lies outside of all areas"),
            parameter(
                "areas",
                "[(soil, corners: [(east_m, north_m)])]",
                "three corners or more each; the first area that holds a place counts",
            ),
        ],
    };

    fn settle(&mut self, _: &Path) -> Result<(), Refusal> {
        for (index, area) in self.areas.iter().enumerate() {
            let refuse = |found: String, expected: &str| Refusal {
                parameter: format!("areas.{index}.corners"),
                found,
                expected: expected.to_owned(),
            };
            if area.corners.len() < 3 {
                return Err(refuse(format!("{} corners", area.corners.len()), "three or more"));
            }
            for (corner, Corner { east_m, north_m }) in area.corners.iter().enumerate() {
                for (name, value) in [("east_m", east_m), ("north_m", north_m)] {
                    if !value.is_finite() {
                        let parameter = format!("areas.{index}.corners.{corner}.{name}");
                        return Err(Refusal { parameter, ..refuse(value.to_string(), "a finite number") });
                    }
                }
            }
            if area.size_m2() == 0.0 {
                return Err(refuse("corners in one line".to_owned(), "an area"));
            }
        }
        Ok(())
    }

    fn names(&self) -> Vec<(String, &str)> {
        let mut names = vec![("otherwise".to_owned(), self.otherwise.as_str())];
        let areas = self.areas.iter().enumerate();
        names.extend(areas.map(|(index, area)| (format!("areas.{index}.soil"), area.soil.as_str())));
        names
    }

    fn which(&self, place: &Place) -> usize {
        let area = self.areas.iter().position(|area| area.holds(place.east_m, place.north_m));
        area.map_or(0, |area| area + 1)
    }
}

impl Area {
    /// The shoelace formula.
    fn size_m2(&self) -> f64 {
        let next = self.corners.iter().cycle().skip(1);
        let twice: f64 =
            self.corners.iter().zip(next).map(|(a, b)| a.east_m * b.north_m - b.east_m * a.north_m).sum();
        0.5 * twice.abs()
    }

    fn holds(&self, east_m: f64, north_m: f64) -> bool {
        let next = self.corners.iter().cycle().skip(1);
        let crossings = self.corners.iter().zip(next).filter(|(a, b)| {
            let spans = (a.north_m > north_m) != (b.north_m > north_m);
            spans && {
                let share = (north_m - a.north_m) / (b.north_m - a.north_m);
                east_m < a.east_m + share * (b.east_m - a.east_m)
            }
        });
        crossings.count() % 2 == 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{ON, read};
    use crate::{Brixius, Constant};
    use headland_plugin::{Contact, Plugin, Soil, WheelContact};

    fn soil<S: Soil + Plugin>(text: &str) -> Box<dyn Soil> {
        Box::new(read::<S>(text))
    }

    fn soils() -> Vec<(String, Box<dyn Soil>)> {
        vec![
            ("field".to_owned(), soil::<Constant>("(coefficient: 0.08)")),
            ("road".to_owned(), soil::<Constant>("(coefficient: 0.02)")),
        ]
    }

    /// A road 10 m wide from south-west to north-east, and a triangle on top of its middle.
    fn map() -> Zones {
        let mut zones: Zones = ron::from_str(
            r#"(otherwise: "field", areas: [
                (soil: "field", corners: [(east_m: 45, north_m: 45), (east_m: 55, north_m: 45), (east_m: 50, north_m: 55)]),
                (soil: "road", corners: [(east_m: 0, north_m: 0), (east_m: 10, north_m: 0),
                                         (east_m: 110, north_m: 100), (east_m: 100, north_m: 100)]),
            ])"#,
        )
        .unwrap();
        zones.settle(Path::new("")).unwrap();
        zones
    }

    fn resistance_n(zones: &Zones, east_m: f64, north_m: f64) -> f64 {
        let place = Place { east_m, north_m, ..Place::default() };
        zones.resistance_at_n(&Contact { load_n: 1e5, speed_m_s: 1.0, position_m: 0.0 }, &place)
    }

    #[test]
    fn a_place_has_the_soil_of_the_first_area_around_it() {
        let mut zones = map();
        zones.adopt(soils()).unwrap();
        let table =
            [(25.0, 20.0, 2e3), (20.0, 25.0, 8e3), (50.0, 48.0, 8e3), (57.0, 50.0, 2e3), (-5.0, 0.0, 8e3)];
        for (east, north, expected) in table {
            assert!((resistance_n(&zones, east, north) - expected).abs() < 1e-9, "{east} {north}");
        }
        let called =
            |east_m, north_m| zones.called(&Place { east_m, north_m, ..Place::default() }).map(str::to_owned);
        assert_eq!([called(25.0, 20.0), called(20.0, 25.0)].map(Option::unwrap), ["road", "field"]);
        assert!(zones.layout.areas[0].size_m2() == 50.0 && zones.layout.areas[1].size_m2() == 1000.0);
    }

    #[test]
    fn wheels_find_what_lies_where_they_are() {
        let mut zones = map();
        let field = r"(cone_index_pa: 900e3, construction: Bias, pass_factor: 1.0)";
        let mut inner = soils();
        inner[0].1 = soil::<Brixius>(field);
        zones.adopt(inner).unwrap();
        assert!(zones.needs_axles());
        let at =
            |east_m: f64| WheelContact { place: Place { east_m, north_m: 20.0, ..Place::default() }, ..ON };
        assert!(zones.wheel(&at(25.0)).is_none());
        let (one, other) = (zones.wheel(&at(0.0)).unwrap(), soil::<Brixius>(field).wheel(&at(0.0)).unwrap());
        assert_eq!(one.gross_traction_n, other.gross_traction_n);
        assert_eq!(one.motion_resistance_n, other.motion_resistance_n);
    }

    #[test]
    fn areas_and_names_that_cannot_be_are_refused() {
        let mut zones = map();
        let refused = zones.adopt(soils().split_off(1)).unwrap_err().to_string();
        assert!(
            refused.contains("`otherwise` is \"field\"") && refused.ends_with("`ground.soils`: road"),
            "{refused}"
        );
        let mut more = soils();
        more.push(("bog".to_owned(), soil::<Constant>("(coefficient: 0.4)")));
        assert!(zones.adopt(more).unwrap_err().to_string().contains("\"bog\", which lies nowhere"));
        zones.layout.areas[1].corners.truncate(2);
        assert!(
            zones.settle(Path::new("")).unwrap_err().to_string().contains("`areas.1.corners` is 2 corners")
        );
        zones.layout.areas[1].corners = vec![Corner { east_m: 1.0, north_m: 1.0 }; 4];
        assert!(zones.settle(Path::new("")).unwrap_err().to_string().contains("in one line"));
    }
}
