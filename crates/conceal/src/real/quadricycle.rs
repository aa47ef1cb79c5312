//! Renault Twizy: slopes of the T3 route, from the state of charge.

use super::pose::{diagnose, write};
use super::signal::{at, blocks, median, paired, short};
use super::table::Table;
use super::{Figure, Options, Row};
use crate::error::ConcealError;
use crate::score::correlation;
use std::fmt::Write;

const SET: &str = "twizy";
/// Energy is known in steps of 0.02 % of the charge: over shorter times it says little [s].
const BLOCK_S: f64 = 60.0;

pub fn rows(options: &Options) -> Result<Vec<Row>, ConcealError> {
    let scenario = write(options, SET, "scenario.ron", include_str!("poses/twizy.ron"))?;
    let recording = options.scenarios.join("recordings/twizy.ron");
    let said = diagnose(options, SET, &scenario, &recording, &[])?;
    let mut row = said.row(SET, "slope of the T3 route; all that is known of energy is the state of charge");
    let mut text = String::new();
    let mut all = Vec::new();
    let folder = options.recordings.join(SET);
    for run in said.effects.iter().filter(|run| run.id.starts_with("T3")) {
        let path = folder.join("truth").join(format!("{}.csv.gz", run.id));
        let hidden = Table::read(&path)?;
        let altitude_m = hidden.need(&path, "ALT")?;
        // Rows are one second apart, as those of the log that was given.
        let rows_s: Vec<f64> = (0..altitude_m.len()).map(|row| row as f64).collect();
        let Some((time_s, power)) = said.series(&run.id, &["grade_w", "grade_constant_w"]) else { continue };
        let start = time_s.first().copied().unwrap_or(0.0);
        let climbs = blocks(&time_s, BLOCK_S).into_iter().map(|block| {
            let height = |index: usize| at(&rows_s, &altitude_m, time_s[index] - start);
            (height(block.end - 1) - height(block.start), power[block].iter().sum())
        });
        let (climbed, told) = paired(climbs);
        let r = correlation(&climbed, &told);
        all.push(if r.is_finite() { r } else { 0.0 });
        let _ = writeln!(text, "- {}: correlation of climb in 60 s {}", run.id, short(r));
    }
    let named = said.found_or_first("grade");
    row.figures.push(Figure::goal(
        "grade is named, or first among the alternatives",
        if named { "yes" } else { "no" }.to_owned(),
        "yes",
        named,
    ));
    row.figures.push(Figure::told("median correlation of climb in 60 s, T3 trips", short(median(&all))));
    row.details = text;
    Ok(vec![row])
}
