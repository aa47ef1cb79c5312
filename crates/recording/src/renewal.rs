//! How often a channel is really renewed: a bus or a receiver gives a value ten times a second, and a log that is faster
//! repeats it.

use headland_trace::Trace;

/// Fewer renewals tell nothing.
const FEWEST: usize = 20;
/// What comes less often than this is no channel at a lower rate [rows].
const LONGEST: usize = 50;
/// Values come regularly where this share of them comes after the usual number of rows.
const SPACED: f64 = 0.9;
/// A channel that is held has no more than this share of renewals that come too early: a coarse value that happens to come
/// several times is renewed at once as often as not.
const EARLY: f64 = 0.1;
/// A channel that stays as it is, and not at nought, for more than this many times what is usual between its renewals ...
const LONG: usize = 3;
/// ... in more than this share of its rows is coarse: what changes evenly takes its steps regularly, until it is held.
const MOSTLY: f64 = 0.1;
/// Fewer samples than this are few.
const FEW: usize = 5;
/// Renewals are regular where this share of them comes after the usual number of samples, or whole times that.
const REGULAR: f64 = 0.8;

/// Time from one renewal of a channel to the next [s]; the period of the log where it is not regularly held, or not there.
pub fn renewed_s(trace: &Trace, name: &str) -> f64 {
    let period_s = trace.period_s();
    let Some(values) = trace.get(name) else { return period_s };
    let changes: Vec<usize> = (1..values.len())
        .filter(|index| values[*index].is_finite() && values[*index] != values[index - 1])
        .collect();
    let held: Vec<usize> = changes.windows(2).map(|pair| pair[1] - pair[0]).collect();
    if held.len() < FEWEST {
        return period_s;
    }
    let (usual, count) = (usual(&held), held.len());
    // Rates that are no whole multiples of each other make one sample more or less. A value that happens to come twice is
    // held for twice as long; among few samples everything is about a multiple.
    let regular: Vec<usize> = held
        .into_iter()
        .filter(|held| {
            let over = held % usual;
            held.abs_diff(usual) <= 1 || usual >= FEW && *held > usual && (over <= 1 || over + 1 >= usual)
        })
        .collect();
    if usual < 2 || (regular.len() as f64) < REGULAR * count as f64 {
        return period_s;
    }
    let once: Vec<f64> =
        regular.iter().filter(|held| held.abs_diff(usual) <= 1).map(|held| *held as f64).collect();
    period_s * once.iter().sum::<f64>() / once.len().max(1) as f64
}

/// After how many rows a channel that is `known` in some of them regularly has its next value; none where that is every row,
/// or not regular.
pub fn spacing(known: &[usize]) -> Option<usize> {
    let steps: Vec<usize> = known.windows(2).map(|pair| pair[1] - pair[0]).collect();
    if steps.len() < FEWEST {
        return None;
    }
    let usual = usual(&steps);
    let regular = steps.iter().filter(|step| step.abs_diff(usual) <= usize::from(usual > 2)).count();
    ((2..=LONGEST).contains(&usual) && regular as f64 >= SPACED * steps.len() as f64).then_some(usual)
}

/// The rows in which a channel has a new value, where it regularly has none in most of them: cells are empty in between, or
/// repeat the one before. None where every row may be new.
#[must_use]
pub fn renewals(values: &[f64]) -> Option<Vec<usize>> {
    let known: Vec<usize> = (0..values.len()).filter(|row| values[*row].is_finite()).collect();
    if spacing(&known).is_some() {
        return Some(known);
    }
    let changed = |row: usize| row == 0 || values[row] != values[row - 1];
    let changes: Vec<usize> = known.into_iter().filter(|row| changed(*row)).collect();
    let steps: Vec<usize> = changes.windows(2).map(|pair| pair[1] - pair[0]).collect();
    if steps.len() < FEWEST {
        return None;
    }
    let usual = usual(&steps);
    let slack = usize::from(usual > 2);
    let share = |test: &dyn Fn(usize) -> bool| {
        steps.iter().filter(|step| test(**step)).count() as f64 / steps.len() as f64
    };
    let once = |step: usize| step.abs_diff(usual) <= slack;
    let early = |step: usize| step + slack < usual;
    if !(2..=LONGEST).contains(&usual) || share(&early) > EARLY || share(&once) < REGULAR {
        return None;
    }
    let moving = values.iter().filter(|value| value.is_finite() && **value != 0.0).count();
    let held = changes.windows(2).filter(|pair| values[pair[0]] != 0.0).map(|pair| pair[1] - pair[0]);
    let held: usize = held.filter(|step| *step > LONG * usual).sum();
    if held as f64 > MOSTLY * moving as f64 {
        return None;
    }
    let regular: Vec<usize> = steps.iter().copied().filter(|step| once(*step)).collect();
    let (rows, count) = (regular.iter().sum::<usize>(), regular.len());
    let mut all = Vec::new();
    for (place, from) in changes.iter().enumerate() {
        let to = changes.get(place + 1).copied().unwrap_or(values.len());
        // A log that begins while a value is held has it from before.
        if place > 0 || to - from + slack >= usual {
            all.push(*from);
        }
        // A value that came twice was renewed in between.
        let between = (1..).map(|times| from + (times * rows + count / 2) / count);
        all.extend(between.take_while(|row| row + usual / 2 < to));
    }
    Some(all)
}

fn usual(steps: &[usize]) -> usize {
    let mut sorted = steps.to_vec();
    sorted.sort_unstable();
    sorted[sorted.len() / 2]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(value: impl Fn(usize) -> f64) -> f64 {
        let mut trace = Trace::new((0..500).map(|index| 0.02 * f64::from(index)).collect()).unwrap();
        trace.push("speed_m_s", (0..500).map(value).collect(), headland_trace::Origin::Measured).unwrap();
        renewed_s(&trace, "speed_m_s")
    }

    /// A speed in steps of 1 km/h, of a vehicle that speeds up evenly, holds its speed and slows down evenly.
    #[test]
    fn a_coarse_channel_that_changes_evenly_is_not_renewed_slowly() {
        let speed = |row: usize| match row {
            0..200 => 0.08 * row as f64,
            200..500 => 16.0,
            _ => 16.0 - 0.08 * (row - 500) as f64,
        };
        let values: Vec<f64> = (0..700).map(|row| (3.6 * speed(row)).round() / 3.6).collect();
        assert_eq!(renewals(&values), None);
        // The same vehicle, by a receiver that gives a value in one row of three.
        let slow: Vec<f64> =
            (0..700).map(|row| speed(row - row % 3) + 0.01 * ((row / 3) as f64).sin()).collect();
        assert_eq!(renewals(&slow).map(|rows| rows.len()), Some(234));
    }

    #[test]
    fn a_value_that_is_held_for_five_samples_is_renewed_ten_times_a_second() {
        assert!((of(|index| ((index / 5) as f64).sin()) - 0.1).abs() < 1e-9);
        // 15 Hz in a log of 50 Hz: three or four samples.
        assert!((of(|index| (index as f64 * 0.3).floor().sin()) - 1.0 / 15.0).abs() < 2e-3);
    }

    #[test]
    fn a_coarse_value_is_not_held_and_a_fine_one_is_renewed_every_time() {
        assert!((of(|index| (0.3 * (0.02 * index as f64).powi(2)).round()) - 0.02).abs() < 1e-9);
        assert!((of(|index| (index as f64).sqrt()) - 0.02).abs() < 1e-9);
    }

    #[test]
    fn rows_with_a_new_value_are_those_that_are_not_empty_or_repeated() {
        let value = |index: usize| (index as f64).sin();
        let empty: Vec<f64> = (0..200).map(|row| if row % 2 == 1 { value(row) } else { f64::NAN }).collect();
        assert_eq!(renewals(&empty), Some((0..100).map(|count| 2 * count + 1).collect()));
        // Every fifth row is new; the log begins two rows after one, and one value comes twice.
        let held: Vec<f64> = (2..202).map(|row| value(if row / 5 == 20 { 19 } else { row / 5 })).collect();
        assert_eq!(renewals(&held), Some((1..=40).map(|count| 5 * count - 2).collect()));
    }

    #[test]
    fn a_channel_that_is_coarse_or_new_in_every_row_is_not_held() {
        let coarse = |width: f64| {
            (0..400).map(|row| (width * (0.7 * f64::from(row)).sin()).round()).collect::<Vec<f64>>()
        };
        assert_eq!(renewals(&coarse(1.2)), None);
        assert_eq!(renewals(&coarse(3.0)), None);
        assert_eq!(renewals(&(0..100).map(|row| f64::from(row).sqrt()).collect::<Vec<f64>>()), None);
        assert_eq!(renewals(&[1.0; 300]), None);
    }
}
