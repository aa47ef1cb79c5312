//! Along what the rows of a balance are looked over.

use super::{Left, Over};
use crate::Case;
use crate::balances::rows::Row;
use crate::runs::recorded::Recorded;
use headland_calibrate::statistics::{quantile_of_sorted, sorted};

/// Cells into which the time of a run is sorted, at most.
const MOMENTS: usize = 120;
/// Cells into which positions are sorted.
const PLACES: usize = 40;
/// Cells into which speeds and temperatures are sorted, with as many rows each.
const LEVELS: usize = 16;
/// Temperatures that are looked over.
const TEMPERATURES: [&str; 2] = ["air_temperature_c", "oil_temperature_c"];

/// One thing to look along.
pub struct Axis {
    pub over: Over,
    pub run: Option<String>,
    pub path: Option<String>,
    pub channel: Option<String>,
    /// Edges of the cells: one more than there are cells.
    pub edges: Vec<f64>,
    /// Whether the rows of a run are looked at.
    pub runs: Vec<bool>,
}

/// Everything that a balance can be looked over along.
pub fn axes(case: &Case, left: &Left) -> Vec<Axis> {
    let count = case.runs.len();
    let present = |run: usize| left.chunks.iter().any(|(chunk, _)| chunk.run == run);
    let only =
        |test: &dyn Fn(usize) -> bool| (0..count).map(|run| present(run) && test(run)).collect::<Vec<_>>();
    let axis = |over: Over, edges: Vec<f64>, runs: Vec<bool>| Axis {
        over,
        run: None,
        path: None,
        channel: None,
        edges,
        runs,
    };
    let mut all = Vec::new();
    for run in (0..count).filter(|run| present(*run)) {
        let id = case.runs[run].measured.id.clone();
        let runs = only(&|one| one == run);
        let times = values(case, left, &runs, &|_, row| row.time_s);
        let edges = even(&times, MOMENTS.min(times.len()));
        all.push(Axis { run: Some(id), ..axis(Over::Time, edges, runs) });
    }
    let paths = case.runs.iter().map(|drive| drive.path + 1).max().unwrap_or(0);
    for path in 0..paths {
        let runs = only(&|run| case.fit[run] && case.runs[run].path == path);
        let edges = even(&values(case, left, &runs, &|drive, row| row.mean(&drive.position_m)), PLACES);
        let run = runs.iter().position(|used| *used);
        let name = case.paths.get(path).cloned().flatten();
        // A path that one run drove alone is that run's.
        let alone = if name.is_none() { run.map(|run| case.runs[run].measured.id.clone()) } else { None };
        all.push(Axis { path: name, run: alone, ..axis(Over::Position, edges, runs) });
    }
    let fitted = only(&|run| case.fit[run]);
    let speeds = values(case, left, &fitted, &|drive, row| row.mean(&drive.motion.value));
    all.push(axis(Over::Speed, filled(&speeds, LEVELS), fitted.clone()));
    let reversed = |wanted: bool| (0..count).any(|run| fitted[run] && way(&case.runs[run]) == wanted);
    if reversed(true) && reversed(false) {
        all.push(axis(Over::Direction, vec![-0.5, 0.5, 1.5], fitted.clone()));
    }
    for channel in TEMPERATURES {
        let seen = values(case, left, &fitted, &|drive, row| temperature(drive, row, channel));
        let edges = filled(&seen, LEVELS);
        all.push(Axis {
            channel: Some(channel.to_owned()),
            ..axis(Over::Temperature, edges, fitted.clone())
        });
    }
    // Two cells at least: one alone is no place.
    all.into_iter().filter(|axis| axis.edges.len() > 2).collect()
}

/// Whether a run goes against its path.
pub fn way(drive: &Recorded) -> bool {
    drive.measured.how.reversed_from_m.is_some()
}

pub fn temperature(drive: &Recorded, row: &Row, channel: &str) -> f64 {
    drive.measured.trace.get(channel).map_or(f64::NAN, |values| row.mean(values))
}

fn values(case: &Case, left: &Left, runs: &[bool], of: &dyn Fn(&Recorded, &Row) -> f64) -> Vec<f64> {
    let chunks = left.chunks.iter().filter(|(chunk, _)| runs[chunk.run]);
    let all = chunks.flat_map(|(chunk, _)| chunk.rows.iter().map(|row| of(&case.runs[chunk.run], row)));
    sorted(&all.filter(|value| value.is_finite()).collect::<Vec<_>>())
}

/// Edges of cells of the same width.
fn even(sorted: &[f64], cells: usize) -> Vec<f64> {
    let (Some(low), Some(high)) = (sorted.first(), sorted.last()) else { return Vec::new() };
    if high - low < 1e-6 {
        return Vec::new();
    }
    (0..=cells).map(|edge| low + (high - low) * edge as f64 / cells as f64).collect()
}

/// Edges of cells with as many values.
fn filled(sorted: &[f64], cells: usize) -> Vec<f64> {
    if sorted.is_empty() {
        return Vec::new();
    }
    let mut edges: Vec<f64> =
        (0..=cells).map(|edge| quantile_of_sorted(sorted, edge as f64 / cells as f64)).collect();
    edges.dedup_by(|one, other| (*one - *other).abs() < 1e-6);
    edges
}
