//! Toyota Camry on a dynamometer: the first run starts cold.

use super::pose::{diagnose, write};
use super::signal::short;
use super::{Figure, Options, Row};
use crate::error::ConcealError;

const SET: &str = "camry_dyno";

pub fn rows(options: &Options) -> Result<Vec<Row>, ConcealError> {
    /// The first 505 s took 392.6 cm³ of petrol, their hot repeat 336.0 cm³.
    const EXTRA_CM3: f64 = 56.6;
    /// Petrol of US test fuel [kg/m³], and its lower heating value [J/kg].
    const DENSITY_KG_M3: f64 = 744.0;
    /// What the diagnosis turns fuel into watts with [J/kg]: that of diesel.
    const FUEL_J_KG: f64 = 42.8e6;
    let scenario = write(options, SET, "scenario.ron", include_str!("poses/camry.ron"))?;
    let said = diagnose(options, SET, &scenario, &options.scenarios.join("recordings/camry_dyno.ron"), &[])?;
    let mut row = said
        .row(SET, "the first run starts cold: its first 505 s take 16.8 % more fuel than their hot repeat");
    let named = said.found("cold_start");
    row.figures.push(Figure::goal(
        "a cold start is named, or first among the alternatives",
        if named { "named" } else { "no" }.to_owned(),
        "yes",
        said.found_or_first("cold_start"),
    ));
    let extra = said.series("61811011", &["cold_start_w"]).map(|(time_s, power)| {
        let first = time_s.windows(2).zip(&power).filter(|(pair, _)| pair[0] < 505.0);
        let joule: f64 =
            first.map(|(pair, power)| power * (pair[1] - pair[0])).filter(|energy| energy.is_finite()).sum();
        1e6 * joule / FUEL_J_KG / DENSITY_KG_M3
    });
    let close = extra.is_some_and(|extra| (extra / EXTRA_CM3 - 1.0).abs() < 0.25);
    row.figures.push(Figure::goal(
        "fuel that the cold start took in 505 s, cm³",
        extra.map_or("not told".to_owned(), short),
        "56.6 within a quarter",
        close,
    ));
    Ok(vec![row])
}
