//! A bicycle with a power meter: in one of two runs a rod added drag.

use super::pose::{diagnose, write};
use super::signal::{median, onto};
use super::table::Table;
use super::{Figure, Options, Row};
use crate::error::ConcealError;

const SET: &str = "compton_challenge";

pub fn rows(options: &Options) -> Result<Vec<Row>, ConcealError> {
    let scenario = write(options, SET, "scenario.ron", include_str!("poses/bicycle.ron"))?;
    let recording = write(options, SET, "recording.ron", include_str!("poses/bicycle_recording.ron"))?;
    let said = diagnose(options, SET, &scenario, &recording, &[])?;
    let mut row = said
        .row(SET, "in one of two runs a rod added 0.0066 to 0.0078 m² of drag area; which one is not said");
    let truth = |run: &str| -> Result<f64, ConcealError> {
        let path = options.recordings.join(SET).join(format!("truth/{run}_facts.csv"));
        let facts = Table::read(&path)?;
        let (Some(names), Some(values)) = (facts.text("quantity"), facts.numbers("recorded")) else {
            return Ok(f64::NAN);
        };
        Ok(names.iter().position(|name| name.starts_with("CdA")).map_or(f64::NAN, |row| values[row]))
    };
    let rod = truth("run_1")? - truth("run_5")?;
    let area = |run: &str| -> Option<f64> {
        /// Density that the scenario states [kg/m³].
        const DENSITY_KG_M3: f64 = 1.21;
        let legs =
            ["out", "back"].into_iter().flat_map(|way| (1..=3).map(move |leg| format!("{run}_{way}.{leg}")));
        let told = legs.filter_map(|leg| said.series(&leg, &["aerodynamic_drag_n"]));
        let (time_s, force): (Vec<f64>, Vec<f64>) =
            told.flat_map(|(time_s, force)| time_s.into_iter().zip(force)).unzip();
        if time_s.is_empty() {
            return None;
        }
        let path = options.recordings.join(SET).join(format!("given/{run}.csv"));
        let log = Table::read(&path).ok()?;
        let minutes: Vec<f64> = log.numbers("Minutes")?.iter().map(|minutes| 60.0 * minutes).collect();
        let speed: Vec<f64> = log.numbers("Speed")?.iter().map(|speed| speed / 3.6).collect();
        let speed = onto(&minutes, &speed, &time_s);
        let areas: Vec<f64> = force
            .iter()
            .zip(&speed)
            .filter(|(_, speed)| **speed > 5.0)
            .map(|(force, speed)| -2.0 * force / (DENSITY_KG_M3 * speed * speed))
            .collect();
        Some(median(&areas))
    };
    let told = area("run_1").zip(area("run_5")).map(|(one, five)| one - five);
    let close = told.is_some_and(|told| (told / rod - 1.0).abs() < 0.5);
    let named = said.findings().iter().any(|finding| finding.id == "aerodynamic_drag");
    row.figures.push(Figure::goal(
        "aerodynamic drag is named",
        if named { "yes" } else { "no" }.to_owned(),
        "yes",
        named,
    ));
    row.figures.push(Figure::goal(
        "drag area of run_1 beyond that of run_5, m²",
        told.map_or("not told".to_owned(), |told| format!("{told:.4}")),
        &format!("{rod:.4} within a half"),
        close,
    ));
    Ok(vec![row])
}
