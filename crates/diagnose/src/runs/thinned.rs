//! Logs that have more rows than their speed has values: a receiver that is slower than the log leaves cells empty, or its value
//! is repeated until the next one comes.
//!
//! What is repeated, or lies between two values, has their noise once more, and no model of noise that is new in every row is
//! right about it: differences of means would seem to know less of slow motion than they do. Such a run is brought to the
//! rows in which its speed is new. Channels that are faster are averaged there, with the hat between the rows beside.

use crate::DiagnoseError;
use headland_calibrate::sparse::SWITCHES;
use headland_recording::renewals;
use headland_trace::{Channel, Trace};

/// Fewer rows are no run.
const FEWEST: usize = 20;
/// A channel that is renewed within so many times the time that the speed takes is as fast.
const AS_FAST: f64 = 1.5;
/// A channel is coarse where this share of its rows repeats the one before: its steps are kept.
const REPEATED: f64 = 0.3;

/// A run in the rows in which a channel is new; none where it is new in each.
///
/// # Errors
/// Where a trace cannot be put together.
pub fn thinned(trace: &Trace, name: &str) -> Result<Option<Trace>, DiagnoseError> {
    let rows = trace.get(name).and_then(renewals).filter(|rows| rows.len() >= FEWEST);
    let Some(rows) = rows else { return Ok(None) };
    let mut made = Trace::new(rows.iter().map(|row| trace.time_s()[*row]).collect())?;
    for channel in trace.channels() {
        made.push(channel.name.clone(), values(trace.time_s(), channel, &rows), channel.origin)?;
    }
    Ok(Some(made))
}

/// A channel in some of its rows.
fn values(time_s: &[f64], channel: &Channel, rows: &[usize]) -> Vec<f64> {
    let own = &channel.values;
    let new = renewals(own);
    let fast = |new: &Vec<usize>| {
        own.len() as f64 / new.len() as f64 <= AS_FAST * own.len() as f64 / rows.len() as f64
    };
    let empty =
        new.as_ref().is_some_and(|new| own.iter().filter(|value| value.is_finite()).count() == new.len());
    let hat = |place: usize| {
        let beside = [place.saturating_sub(1), place, (place + 1).min(rows.len() - 1)];
        mean(time_s, own, beside.map(|place| rows[place]))
    };
    let of = |place: usize| -> f64 {
        let row = rows[place];
        match &new {
            _ if SWITCHES.contains(&channel.name.as_str()) => own[row],
            Some(new) if fast(new) => between(time_s, own, new, row),
            // What is slower than the speed comes where it comes.
            Some(_) if empty => hat(place),
            None if own[row].is_finite() && !is_coarse(own) => hat(place),
            _ => own[row],
        }
    };
    (0..rows.len()).map(of).collect()
}

/// Mean of the values that are known between the rows beside one, the nearer the more; NaN where there are none.
fn mean(time_s: &[f64], values: &[f64], [before, row, after]: [usize; 3]) -> f64 {
    let (mut sum, mut weight) = (0.0, 0.0);
    for index in (before..=after).filter(|index| values[*index].is_finite()) {
        let reach_s = time_s[if index < row { before } else { after }] - time_s[row];
        let own = if index == row { 1.0 } else { 1.0 - (time_s[index] - time_s[row]) / reach_s };
        (sum, weight) = (sum + own * values[index], weight + own);
    }
    if weight > 0.0 { sum / weight } else { f64::NAN }
}

/// What a channel that is new in some rows is in one, linear between them.
fn between(time_s: &[f64], values: &[f64], new: &[usize], row: usize) -> f64 {
    let right = new.partition_point(|one| *one < row);
    match (right.checked_sub(1).map(|left| new[left]), new.get(right)) {
        (_, Some(right)) if *right == row => values[row],
        (Some(left), Some(right)) => {
            let share = (time_s[row] - time_s[left]) / (time_s[*right] - time_s[left]);
            values[left] + share * (values[*right] - values[left])
        }
        _ => values[row],
    }
}

fn is_coarse(values: &[f64]) -> bool {
    let repeated = values.windows(2).filter(|pair| pair[0] == pair[1]).count();
    repeated as f64 > REPEATED * values.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use headland_trace::Origin;

    const SPEED: &str = "speed_m_s";

    fn log(speed: impl Fn(usize) -> f64, beside: &[(&str, &dyn Fn(usize) -> f64)]) -> Trace {
        let mut trace = Trace::new((0..400).map(|row| 0.02 * f64::from(row)).collect()).unwrap();
        trace.push(SPEED, (0..400).map(speed).collect(), Origin::Measured).unwrap();
        for (name, of) in beside {
            trace.push(*name, (0..400).map(of).collect(), Origin::Measured).unwrap();
        }
        trace
    }

    #[test]
    fn a_run_keeps_the_rows_in_which_its_speed_is_new_and_faster_channels_are_averaged() {
        let speed = |row: usize| (row - row % 5) as f64 * 0.01;
        let force = |row: usize| 100.0 * row as f64 + if row.is_multiple_of(2) { 1.0 } else { -1.0 };
        let place = |row: usize| if row.is_multiple_of(5) { row as f64 } else { f64::NAN };
        let slow = |row: usize| if row.is_multiple_of(50) { row as f64 } else { f64::NAN };
        let trace =
            log(speed, &[("tractive_force_n", &force), ("position_m", &place), ("air_temperature_c", &slow)]);
        let made = thinned(&trace, SPEED).unwrap().unwrap();
        assert_eq!(made.len(), 80);
        for row in 1..79 {
            assert!((made.time_s()[row] - 0.1 * row as f64).abs() < 1e-9);
            assert!((made.get(SPEED).unwrap()[row] - 0.05 * row as f64).abs() < 1e-9);
            assert!((made.get("position_m").unwrap()[row] - 5.0 * row as f64).abs() < 1e-9);
            let force = made.get("tractive_force_n").unwrap()[row];
            assert!((force - 500.0 * row as f64).abs() < 0.3, "{force} in row {row}");
        }
        let known = made.get("air_temperature_c").unwrap().iter().filter(|value| value.is_finite()).count();
        assert_eq!(known, 8);
    }

    #[test]
    fn a_run_whose_speed_is_new_in_every_row_stays_as_it_is() {
        assert!(thinned(&log(|row| (row as f64).sqrt(), &[]), SPEED).unwrap().is_none());
        assert!(thinned(&log(|row| (row as f64 * 0.02).round(), &[]), "wheel_speed_m_s").unwrap().is_none());
    }
}
