//! Heavy diesel truck: climbs, from fuel and speed alone.

use super::pose::diagnose;
use super::signal::{at, blocks, median, onto, paired, short, spread};
use super::table::Table;
use super::{Figure, Options, Row};
use crate::error::ConcealError;
use crate::score::correlation;
use std::fmt::Write;

const SET: &str = "class8_trucks";
/// Climbs are compared over so long [s].
const BLOCK_S: f64 = 60.0;
/// A segment whose climbs spread less in a block is not hilly [m].
const HILLY_M: f64 = 3.0;
/// Fewer blocks make no correlation.
const FEWEST: usize = 8;

pub fn rows(options: &Options) -> Result<Vec<Row>, ConcealError> {
    let scenario = options.scenarios.join("class8_truck.ron");
    let recording = options.scenarios.join("recordings/class8_trucks.ron");
    let said = diagnose(options, SET, &scenario, &recording, &[])?;
    let mut row = said.row(SET, "elevation: climbs from speed and fuel alone; the mass is not known either");
    let given = options.recordings.join(SET).join("given/veh002.csv.gz");
    let truth = options.recordings.join(SET).join("truth/veh002.csv.gz");
    let (seen, hidden) = (Table::read(&given)?, Table::read(&truth)?);
    let time_s = hidden.need(&truth, "row (1 s)")?;
    let elevation_m = hidden.need(&truth, "elevation (m)")?;
    let speed_time_s = seen.need(&given, "row (1 s)")?;
    let speed_m_s: Vec<f64> = seen.need(&given, "vel (mph)")?.iter().map(|speed| 0.447_04 * speed).collect();
    let mut text =
        "| segment | blocks of 60 s | spread of measured climb m | correlation |\n|---|---|---|---|\n"
            .to_owned();
    let mut hilly = Vec::new();
    let mut names: Vec<&str> = said.effects.iter().map(|run| run.id.as_str()).collect();
    names.sort_by_key(|name| name.rsplit('.').next().and_then(|number| number.parse::<usize>().ok()));
    for name in names {
        let Some((times, power)) = said.series(name, &["grade_w", "grade_constant_w"]) else {
            let _ = writeln!(text, "| {name} | - | - | not reconstructed |");
            continue;
        };
        // Power over weight is speed times slope, up to the efficiency, which a correlation does not know.
        let speed = onto(&speed_time_s, &speed_m_s, &times);
        let of_block = |block: std::ops::Range<usize>| {
            let climbed = at(&time_s, &elevation_m, times[block.end - 1])
                - at(&time_s, &elevation_m, times[block.start]);
            let jumped = (block.start..block.end - 1).any(|index| {
                (at(&time_s, &elevation_m, times[index + 1]) - at(&time_s, &elevation_m, times[index])).abs()
                    > 5.0
            });
            let stood = speed[block.clone()].iter().all(|speed| *speed < 1.0);
            if jumped || stood { (f64::NAN, f64::NAN) } else { (climbed, power[block].iter().sum()) }
        };
        let (climbed, told) = paired(blocks(&times, BLOCK_S).into_iter().map(of_block));
        let r = correlation(&climbed, &told);
        let counts = climbed.len() >= FEWEST && spread(&climbed) > HILLY_M;
        if counts {
            hilly.push(if r.is_finite() { r } else { 0.0 });
        }
        let r = if counts { short(r) } else { format!("({})", short(r)) };
        let _ = writeln!(text, "| {name} | {} | {} | {r} |", climbed.len(), short(spread(&climbed)));
    }
    let first = said.found_or_first("grade");
    let value = if said.found("grade") {
        "named"
    } else if first {
        "first alternative"
    } else {
        "no"
    };
    row.figures.push(Figure::goal(
        "grade is named, or first among the alternatives",
        value.to_owned(),
        "yes",
        first,
    ));
    let r = median(&hilly);
    row.figures.push(Figure::goal(
        &format!("median correlation of climb in 60 s on {} hilly segments", hilly.len()),
        short(r),
        "≥ 0.93",
        r >= 0.93,
    ));
    text.push_str("\nIn parentheses: fewer than 8 blocks, or climbs that spread less than 3 m.\n");
    row.details = text;
    Ok(vec![row])
}
