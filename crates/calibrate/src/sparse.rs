//! Channels that come less often than the log has rows: loggers of different rates, joined row by row, leave cells empty, or
//! repeat a value until the next one comes, which makes it late by half the time between them.
//! Between two values such a channel is what lies between them, and that is said. So are short gaps in what changes slowly
//! around the vehicle, without which no run could be driven.

use headland_recording::{renewals, spacing};
use headland_trace::{Origin, Trace, TraceError};
use std::collections::BTreeMap;

/// A channel of a run that was filled.
#[derive(Clone, Debug, PartialEq)]
pub struct Sparse {
    channel: String,
    /// It comes every so many rows; none where it lacks a few.
    every: Option<usize>,
}

/// Channels that are on or off, or go around: nothing lies between.
pub const SWITCHES: [&str; 4] = ["coasting", "brake", "heading_rad", "wind_direction_rad"];
/// Channels whose steps are told by themselves: a charge is counted in them, and a run has the rows in which its speed is new.
const STEPS: [&str; 2] = ["speed_m_s", "state_of_charge"];
/// What surrounds the vehicle, or is done with it, and changes slowly: a run is driven by it.
pub const AROUND: [&str; 15] = [
    "curvature_per_m",
    "air_temperature_c",
    "oil_temperature_c",
    "tyre_pressure_pa",
    "heading_rad",
    "wind_speed_m_s",
    "wind_direction_rad",
    "grade",
    "payload_kg",
    "drawbar_force_n",
    "coasting",
    "brake",
    "auxiliary_power_w",
    "pto_power_w",
    "hydraulic_power_w",
];
/// A gap of what changes slowly within which it is known well enough [s].
const SHORT_S: f64 = 3.0;

/// A run whose channels were filled.
pub struct Filled {
    /// The run.
    pub trace: Trace,
    /// What was filled.
    pub sparse: Vec<Sparse>,
    /// Samples at which it is not known what a run was driven by; empty where there are none. The run goes on there, and
    /// nothing is told by them.
    pub unknown: Vec<bool>,
}

/// A run whose sparse channels, those of them that are wanted, hold a value in every row between their first and their last one.
///
/// # Errors
/// [`TraceError`]: a bug.
pub fn filled(trace: &Trace, wanted: impl Fn(&str) -> bool) -> Result<Filled, TraceError> {
    let mut found = Vec::new();
    let mut unknown = vec![false; trace.len()];
    let mut made = Trace::new(trace.time_s().to_vec())?;
    for channel in trace.channels() {
        if !wanted(&channel.name) {
            made.push(channel.name.clone(), channel.values.clone(), channel.origin)?;
            continue;
        }
        let known: Vec<usize> =
            (0..channel.values.len()).filter(|row| channel.values[*row].is_finite()).collect();
        let every = spacing(&known);
        let switch = SWITCHES.contains(&channel.name.as_str());
        let held = every.is_none() && !switch && !STEPS.contains(&channel.name.as_str());
        if let Some(new) = held.then(|| renewals(&channel.values)).flatten() {
            let every = (channel.values.len() + new.len() / 2) / new.len();
            let near = |from: usize, to: usize| to - from <= every + 1;
            let values = between(trace.time_s(), &channel.values, &new, &near, false);
            found.push(Sparse { channel: channel.name.clone(), every: Some(every) });
            made.push(channel.name.clone(), values, channel.origin)?;
            continue;
        }
        let slow = AROUND.contains(&channel.name.as_str()) && known.len() < channel.values.len();
        if known.is_empty() || every.is_none() && !slow {
            made.push(channel.name.clone(), channel.values.clone(), channel.origin)?;
            continue;
        }
        let time_s = trace.time_s();
        let around = AROUND.contains(&channel.name.as_str());
        let near = |from: usize, to: usize| match every {
            Some(every) => to - from <= every + 1,
            None => time_s[to] - time_s[from] <= SHORT_S,
        };
        let mut values = between(time_s, &channel.values, &known, &near, switch);
        if around {
            // What is left are gaps that are too long: a run has to be driven by something there.
            for (unknown, _) in unknown.iter_mut().zip(&values).filter(|(_, value)| !value.is_finite()) {
                *unknown = true;
            }
            values = between(time_s, &values, &known, &|_, _| true, switch);
        }
        if values.iter().zip(&channel.values).any(|(filled, own)| filled.is_finite() && !own.is_finite()) {
            found.push(Sparse { channel: channel.name.clone(), every });
        }
        made.push(channel.name.clone(), values, Origin::Measured)?;
    }
    if !unknown.contains(&true) {
        unknown.clear();
    }
    Ok(Filled { trace: made, sparse: found, unknown })
}

/// Values between those that are known where these lie near each other, and beyond the first and the last.
fn between(
    time_s: &[f64],
    values: &[f64],
    known: &[usize],
    near: &dyn Fn(usize, usize) -> bool,
    switch: bool,
) -> Vec<f64> {
    let mut all = values.to_vec();
    for pair in known.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        if !near(from, to) {
            continue;
        }
        for row in from + 1..to {
            let share = (time_s[row] - time_s[from]) / (time_s[to] - time_s[from]);
            all[row] = if switch { values[from] } else { values[from] + share * (values[to] - values[from]) };
        }
    }
    if let (Some(&first), Some(&last)) = (known.first(), known.last()) {
        if near(0, first) {
            all[..first].fill(values[first]);
        }
        if near(last, values.len() - 1) {
            all[last..].fill(values[last]);
        }
    }
    all
}

/// What is said of them.
pub fn told(sparse: &[Sparse]) -> Vec<String> {
    let mut runs: BTreeMap<(&str, Option<usize>), usize> = BTreeMap::new();
    for one in sparse {
        *runs.entry((&one.channel, one.every)).or_default() += 1;
    }
    let one = |((channel, every), count): ((&str, Option<usize>), usize)| {
        let runs = if count == 1 { "one run".to_owned() } else { format!("{count} runs") };
        match every {
            Some(every) => format!(
                "`{channel}` has a new value in one row of {every} in {runs}; between two values it is taken as what lies \
                 between."
            ),
            None => format!(
                "`{channel}` lacks values in {runs}; gaps are taken as what lies between their ends, and where they are longer \
                 than {SHORT_S} s nothing is told by them."
            ),
        }
    };
    runs.into_iter().map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(value: impl Fn(usize) -> f64) -> Trace {
        let mut trace = Trace::new((0..100).map(|row| 0.1 * f64::from(row)).collect()).unwrap();
        trace.push("tractive_force_n", (0..100).map(value).collect(), Origin::Measured).unwrap();
        trace
    }

    #[test]
    fn every_second_value_is_filled_with_what_lies_between_and_told() {
        let Filled { trace: made, sparse, .. } =
            filled(&with(|row| if row.is_multiple_of(2) { row as f64 } else { f64::NAN }), |_| true).unwrap();
        let values = made.get("tractive_force_n").unwrap();
        assert!((0..99).all(|row| (values[row] - row as f64).abs() < 1e-9) && values[99] == 98.0);
        assert_eq!(sparse, [Sparse { channel: "tractive_force_n".to_owned(), every: Some(2) }]);
        assert!(told(&sparse)[0].contains("one row of 2 in one run"));
    }

    /// A bus gives a force ten times a second, and the log repeats it.
    #[test]
    fn a_value_that_is_repeated_until_the_next_one_comes_is_no_late_one() {
        let law = |row: usize| 50.0 * row as f64;
        let Filled { trace: made, sparse, .. } = filled(&with(|row| law(row - row % 3)), |_| true).unwrap();
        let values = made.get("tractive_force_n").unwrap();
        assert!((0..97).all(|row| (values[row] - law(row)).abs() < 1e-9), "{values:?}");
        assert_eq!(sparse, [Sparse { channel: "tractive_force_n".to_owned(), every: Some(3) }]);
        // A force that changes when it likes has no rate.
        let Filled { sparse, .. } = filled(&with(|row| (row as f64).sqrt().floor()), |_| true).unwrap();
        assert!(sparse.is_empty());
    }

    #[test]
    fn a_gap_stays_a_gap() {
        let gap = |row: usize| if (40..60).contains(&row) { f64::NAN } else { 1.0 };
        let Filled { trace: made, sparse, .. } = filled(&with(gap), |_| true).unwrap();
        assert!(sparse.is_empty() && made.get("tractive_force_n").unwrap()[50].is_nan());
        let thin =
            |row: usize| if row.is_multiple_of(2) && !(40..60).contains(&row) { 1.0 } else { f64::NAN };
        let Filled { trace: made, sparse, .. } = filled(&with(thin), |_| true).unwrap();
        let values = made.get("tractive_force_n").unwrap();
        assert!(sparse.len() == 1 && values[50].is_nan() && values[31] == 1.0);
    }

    #[test]
    fn what_a_run_is_driven_by_goes_on_through_a_gap_and_tells_nothing_there() {
        let mut trace = with(|_| 1.0);
        let gap = |row: i32| (20..30).contains(&row) || (40..80).contains(&row);
        let grade = (0..100).map(|row| if gap(row) { f64::NAN } else { f64::from(row) }).collect();
        trace.push("grade", grade, Origin::Measured).unwrap();
        let filled = filled(&trace, |_| true).unwrap();
        assert!((0..100).all(|row| (filled.trace.get("grade").unwrap()[row] - row as f64).abs() < 1e-9));
        assert!((0..100).all(|row| filled.unknown[row] == (40..80).contains(&row)));
        assert!(told(&filled.sparse)[0].contains("`grade` lacks values in one run"));
    }
}
