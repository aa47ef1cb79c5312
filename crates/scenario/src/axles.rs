//! The axles of a vehicle: read, checked, refused with their place.

use crate::document::Document;
use crate::error::ScenarioError;
use crate::plugins::bounded;
use crate::schema::{Any, VehicleFile};
use headland_plugin::{Bound, Soil, Tyre};
use headland_sim::{Axle, Axles};
use serde::Deserialize;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "axle")]
pub struct AxleFile {
    pub position_m: f64,
    pub track_m: f64,
    pub wheels: u32,
    pub tyre: TyreFile,
    pub lead: Option<f64>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "tyre")]
pub struct TyreFile {
    #[allow(dead_code, reason = "for people")]
    pub name: Option<Any>,
    pub width_m: f64,
    pub diameter_m: f64,
    pub section_height_m: f64,
    pub inflation_pa: f64,
    pub carcass_pa: f64,
    pub stiffness_n_per_m: Option<f64>,
}

/// Bounds of the numbers of an axle, by the path from it.
pub const BOUNDS: [(&str, Bound); 3] = [
    ("position_m", Bound::Within(-50.0, 50.0)),
    ("track_m", Bound::Within(0.0, 20.0)),
    ("lead", Bound::Within(0.5, 2.0)),
];

/// Bounds of those of its tyre.
pub const TYRE_BOUNDS: [(&str, Bound); 6] = [
    ("tyre.width_m", Bound::Positive),
    ("tyre.diameter_m", Bound::Positive),
    ("tyre.section_height_m", Bound::Positive),
    ("tyre.inflation_pa", Bound::Positive),
    ("tyre.carcass_pa", Bound::NotNegative),
    ("tyre.stiffness_n_per_m", Bound::Positive),
];

/// Fields that a vehicle has with axles and only with them.
const WITH_AXLES: [&str; 3] = ["centre_of_gravity_height_m", "hitch_height_m", "slip_limit"];

/// The axles of a vehicle; `None` where it has none. They and the soil have to suit each other.
pub fn axles(
    document: &Document,
    vehicle: &VehicleFile,
    soil: Option<&dyn Soil>,
) -> Result<Option<Axles>, ScenarioError> {
    let refuse = |name: &str, found: &str, expected: &str, path: &str| ScenarioError::Value {
        name: name.to_owned(),
        found: found.to_owned(),
        expected: expected.to_owned(),
        at: document.location(document.find(path).map_or(0, |node| node.span.start)),
    };
    let axles = standing(document, vehicle)?;
    if axles.is_some() && soil.is_none() {
        let expected = "one of the two: road-load coefficients hold the resistance of all wheels";
        return Err(refuse("axles", "given beside `road_load`", expected, "vehicle.axles"));
    }
    if axles.is_none() && soil.is_some_and(Soil::needs_axles) {
        let expected = "a vehicle with `axles`: this soil speaks of single wheels";
        return Err(refuse("soil", "below a vehicle without `axles`", expected, "ground.soil"));
    }
    Ok(axles)
}

fn standing(document: &Document, vehicle: &VehicleFile) -> Result<Option<Axles>, ScenarioError> {
    let at = |path: &str| document.find(path).map_or(0, |node| node.span.start);
    let refuse = |name: &str, found: String, expected: &str, path: &str| ScenarioError::Value {
        name: name.to_owned(),
        found,
        expected: expected.to_owned(),
        at: document.location(at(path)),
    };
    let given = [vehicle.centre_of_gravity_height_m, vehicle.hitch_height_m, vehicle.slip_limit];
    let Some(list) = &vehicle.axles else {
        return match WITH_AXLES.iter().zip(given).find(|(_, value)| value.is_some()) {
            Some((name, _)) => {
                let found = "given to a vehicle without `axles`".to_owned();
                Err(refuse(name, found, "`axles` beside it", &format!("vehicle.{name}")))
            }
            None => Ok(None),
        };
    };
    let [Some(height_m), Some(hitch_m), Some(slip_limit)] = given else {
        let missing = WITH_AXLES.iter().zip(given).find(|(_, value)| value.is_none());
        return Err(ScenarioError::MissingField {
            field: missing.map_or("", |(name, _)| name).to_owned(),
            of: "`vehicle` with `axles`".to_owned(),
            at: document.location(at("vehicle")),
        });
    };
    for index in 0..list.len() {
        for (path, bound) in BOUNDS.into_iter().chain(TYRE_BOUNDS) {
            let whole = format!("vehicle.axles.{index}.{path}");
            if let (Some(node), Some(value)) = (document.find(&whole), document.number(&whole)) {
                let name = path.rsplit('.').next().unwrap_or(path);
                bounded(document, name, value, bound, node.span.start)?;
            }
        }
    }
    for (index, axle) in list.iter().enumerate() {
        if 2.0 * axle.tyre.section_height_m >= axle.tyre.diameter_m {
            let path = format!("vehicle.axles.{index}.tyre.section_height_m");
            let found = axle.tyre.section_height_m.to_string();
            return Err(refuse("section_height_m", found, "less than half of `diameter_m`", &path));
        }
    }
    let list = list.iter().map(axle).collect();
    Axles::new(list, height_m, hitch_m, slip_limit).map(Some).map_err(|refusal| {
        let path = format!("vehicle.{}", refusal.parameter);
        refuse(&refusal.parameter, refusal.found, &refusal.expected, &path)
    })
}

fn axle(file: &AxleFile) -> Axle {
    let AxleFile { position_m, track_m, wheels, tyre, lead } = file;
    Axle { position_m: *position_m, track_m: *track_m, wheels: *wheels, tyre: self::tyre(tyre), lead: *lead }
}

pub fn tyre(file: &TyreFile) -> Tyre {
    Tyre {
        width_m: file.width_m,
        diameter_m: file.diameter_m,
        section_height_m: file.section_height_m,
        inflation_pa: file.inflation_pa,
        carcass_pa: file.carcass_pa,
        stiffness_n_per_m: file.stiffness_n_per_m,
    }
}
