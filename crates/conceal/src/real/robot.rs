//! Husky field robot: what ground each run drove over, from its motor currents.

use super::pose::{diagnose, write};
use super::signal::short;
use super::table::Table;
use super::{Figure, Options, Row};
use crate::error::ConcealError;
use std::collections::BTreeMap;
use std::fmt::Write;

const SET: &str = "husky_farm";

pub fn rows(options: &Options) -> Result<Vec<Row>, ConcealError> {
    let scenario = write(options, SET, "scenario.ron", include_str!("poses/husky.ron"))?;
    let recording = write(options, SET, "recording.ron", include_str!("poses/husky_recording.ron"))?;
    let said = diagnose(options, SET, &scenario, &recording, &[])?;
    let mut row =
        said.row(SET, "surface of each of 18 runs: dirt road, concrete, unploughed or ploughed field");
    let path = options.recordings.join(SET).join("truth/surface.csv");
    let truth = Table::read(&path)?;
    let surfaces = truth.text("surface").unwrap_or_default();
    let mut groups: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    let columns = ["soft_ground_n", "rolling_resistance_n", "grade_n", "payload_change_n", "drawbar_load_n"];
    for (run, surface) in truth.text("run").unwrap_or_default().iter().zip(&surfaces) {
        if let Some((_, force)) = said.series(run, &columns) {
            let known: Vec<f64> = force.into_iter().filter(|force| force.is_finite()).collect();
            let mean = -known.iter().sum::<f64>() / known.len().max(1) as f64;
            groups.entry(surface).or_default().push(mean);
        }
    }
    let mut text =
        "| surface | runs | reconstructed resistance beyond the scenario N |\n|---|---|---|\n".to_owned();
    for (surface, values) in &groups {
        let list: Vec<String> = values.iter().map(|value| short(*value)).collect();
        let _ = writeln!(text, "| {surface} | {} | {} |", values.len(), list.join(", "));
    }
    // A coefficient of each run and softer ground along it are one thing where every run is on ground of its own.
    let soft = ["soft_ground", "rolling_resistance"].iter().any(|id| said.found_or_first(id));
    row.figures.push(Figure::goal("soil is named", if soft { "yes" } else { "no" }.to_owned(), "yes", soft));
    let share = explained(&groups);
    row.figures
        .push(Figure::told("share of the variance between runs that the surface explains", short(share)));
    let ploughed = groups.get("PLOUGHED").map(|values| values.iter().copied().fold(f64::INFINITY, f64::min));
    let others =
        groups.iter().filter(|(name, _)| **name != "PLOUGHED").flat_map(|(_, values)| values.iter().copied());
    let apart = ploughed.is_some_and(|least| least > others.fold(f64::NEG_INFINITY, f64::max));
    let told = if groups.is_empty() {
        "not reconstructed"
    } else if apart {
        "yes"
    } else {
        "no"
    };
    row.figures.push(Figure::goal(
        "every ploughed run lies above every other run",
        told.to_owned(),
        "yes",
        apart,
    ));
    row.details = text;
    Ok(vec![row])
}

/// Share of a variance that lies between groups.
fn explained(groups: &BTreeMap<&str, Vec<f64>>) -> f64 {
    let all: Vec<f64> = groups.values().flatten().copied().collect();
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let centre = mean(&all);
    let between: f64 =
        groups.values().map(|values| values.len() as f64 * (mean(values) - centre).powi(2)).sum();
    between / all.iter().map(|value| (value - centre).powi(2)).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_that_do_not_scatter_explain_all_and_equal_groups_nothing() {
        let told = |one: [f64; 2], two: [f64; 2]| {
            explained(&BTreeMap::from([("a", one.to_vec()), ("b", two.to_vec())]))
        };
        assert!((told([1.0, 1.0], [3.0, 3.0]) - 1.0).abs() < 1e-12);
        assert!(told([1.0, 3.0], [3.0, 1.0]).abs() < 1e-12);
    }
}
